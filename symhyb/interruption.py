"""An interruption (Ctrl-C, or the signal that ends a process) ends the command line tidily.

Python delivers it as :class:`KeyboardInterrupt` at whatever instruction is running. In compiled
code (a kernel of numba, the import of an extension) it comes out as another error, ``SystemError``
or ``ImportError``; so what ended the work is asked of the signal, not of the error alone.
"""

import signal
from types import FrameType

_received: list[int] = []


def listen() -> None:
    """Let SIGINT and SIGTERM raise ``KeyboardInterrupt``; `is_interruption` knows of them.

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
    signal.default_int_handler(number, frame)
