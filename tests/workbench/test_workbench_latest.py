"""Work in a thread of its own: the last of a kind is done, what it replaces is not."""

import threading

from symhyb.workbench.latest import Latest


def test_only_the_last_of_a_kind_that_waits_is_done() -> None:
    numerics, held, done = Latest(), threading.Event(), []
    begun, ended = threading.Event(), threading.Event()

    def first() -> None:
        begun.set()
        held.wait(10)

    numerics.ask("slow", first)
    assert begun.wait(10)
    for value in range(5):
        numerics.ask("run", lambda value=value: done.append(value))  # type: ignore[misc]
    numerics.ask("left out", lambda: done.append(-1))
    numerics.forget(lambda kind: kind == "left out")
    numerics.ask("end", ended.set)
    held.set()
    assert ended.wait(10)
    assert done == [4]
