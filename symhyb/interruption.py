"""An interruption (Ctrl-C, or the signal that ends a process) ends the command line tidily.

Python delivers it as :class:`KeyboardInterrupt` at whatever instruction is running. In compiled
code (a kernel of numba, the import of an extension) it comes out as another error, ``SystemError``
or ``ImportError``; so what ended the work is asked of the signal, not of the error alone.
"""

import signal
from types import FrameType

_received: list[int] = []


class Interruption(KeyboardInterrupt):
    """What a signal to end raises.

    ``python -m`` ends by SIGINT, whatever status the program asks for, once a ``KeyboardInterrupt``
    has left an ``exec`` (one that builds a dataclass on import, say), but not for a subclass of it.
    """


def listen() -> None:
    """Let SIGINT and SIGTERM raise `Interruption`; `is_interruption` knows of them.

    SIGINT that the process was started to ignore stays ignored.
    """
    _received.clear()
    signal.signal(signal.SIGTERM, _receive)
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _receive)


def is_interruption(error: BaseException) -> bool:
    """Whether ``error`` came of a signal to end, whatever it is called."""
    return isinstance(error, KeyboardInterrupt) or bool(_received)


def _receive(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    raise Interruption
