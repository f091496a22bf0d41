"""One thread for all numerics of the workbench: what is asked last of a kind is done, what it
replaces is not."""

import threading
from collections.abc import Callable, Hashable


class Latest:
    """Work done one after the other in a thread of its own, which ends with the process. A work of
    the same ``kind`` that has not begun is replaced: of a slider that is moved only the last place
    is simulated."""

    def __init__(self) -> None:
        self._waiting: dict[Hashable, Callable[[], None]] = {}
        self._changed = threading.Condition()
        threading.Thread(target=self._run, daemon=True, name="numerics").start()

    def ask(self, kind: Hashable, work: Callable[[], None]) -> None:
        """Do ``work`` when what was asked before is done; it must not raise."""
        with self._changed:
            self._waiting[kind] = work
            self._changed.notify()

    def forget(self, kinds: Callable[[Hashable], bool]) -> None:
        """Leave out what has not begun of these kinds."""
        with self._changed:
            for kind in [one for one in self._waiting if kinds(one)]:
                del self._waiting[kind]

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._waiting:
                    self._changed.wait()
                kind = next(iter(self._waiting))
                work = self._waiting.pop(kind)
            work()
