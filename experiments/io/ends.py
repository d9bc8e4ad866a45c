"""A process that is asked to end does so as after Ctrl-C: nothing half written, nothing left."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Final

_NAMES: Final = ("SIGTERM", "SIGHUP")
"""What ``kill``, a batch system and a closed terminal send."""


@dataclass(slots=True)
class Asked:
    """Which signal asked this process to end, if any did; ``interrupted``: Ctrl-C came, too."""

    number: int = 0
    interrupted: bool = False

    @property
    def code(self) -> int:
        """Exit code as a shell would name it: 128 and the signal's number; 0 if none came."""
        return 128 + self.number if self.number else 0


@contextmanager
def asked_to_end() -> Generator[Asked]:
    """Within the block the first such signal is a ``KeyboardInterrupt``; others let it tidy up.

    Ctrl-C is one every time, as ever; that it came is noted, because some libraries make another
    error of it.

    A signal that whoever started this process ignores (``nohup``) or handles stays theirs.
    """
    asked = Asked()
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return

    def interrupt(number: int, _frame: FrameType | None) -> None:
        if not asked.number:
            asked.number = number
            raise KeyboardInterrupt

    def note(number: int, frame: FrameType | None) -> None:
        asked.interrupted = True
        signal.default_int_handler(number, frame)

    found = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    mine = [number for number in found if signal.getsignal(number) is signal.SIG_DFL]
    for number in mine:
        signal.signal(number, interrupt)
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if usual:
        signal.signal(signal.SIGINT, note)
    try:
        yield asked
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)
        if usual:
            signal.signal(signal.SIGINT, signal.default_int_handler)
