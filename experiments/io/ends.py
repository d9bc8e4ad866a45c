"""A process that is asked to end does so as after Ctrl-C: nothing half written, nothing left."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Final

_NAMES: Final = ("SIGTERM", "SIGHUP")
"""What ``kill``, a batch system and a closed terminal send."""

_AGAIN: Final = 0.02
"""[s] After which a signal that was lost comes again."""


@dataclass(slots=True)
class Asked:
    """Which signal asked this process to end, if any did; ``interrupted``: Ctrl-C came, too.

    ``lost``: it was raised where nothing can be raised, and comes again.
    """

    number: int = 0
    interrupted: bool = False
    lost: bool = False

    @property
    def code(self) -> int:
        """Exit code as a shell would name it: 128 and the signal's number; 0 if none came."""
        return 128 + self.number if self.number else 0


def _send_to_main_thread(number: signal.Signals) -> None:
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, number)  # ends a wait, too
    else:
        _thread.interrupt_main(number)


@contextmanager
def asked_to_end() -> Generator[Asked]:
    """Within the block the first such signal is a ``KeyboardInterrupt``; others let it tidy up.

    Ctrl-C is one every time, as ever; that it came is noted, because some libraries make another
    error of it.

    One that comes while the callback of a weak reference or a ``__del__`` runs (imports have them
    by the thousand) Python would tell of and forget: it comes again as soon as that has returned.

    A signal that whoever started this process ignores (``nohup``) or handles stays theirs.
    """
    asked = Asked()
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return

    def interrupt(number: int, _frame: FrameType | None) -> None:
        if not asked.number or asked.lost:
            asked.number, asked.lost = number, False
            raise KeyboardInterrupt

    def note(number: int, frame: FrameType | None) -> None:
        asked.interrupted = True
        signal.default_int_handler(number, frame)

    usual_hook = sys.unraisablehook

    def come_again(unraisable: sys.UnraisableHookArgs) -> None:
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            asked.lost = bool(asked.number)
            number = signal.Signals(asked.number or signal.SIGINT)
            # from elsewhere and a little later: raised here it would be lost as well
            again = threading.Timer(_AGAIN, _send_to_main_thread, (number,))
            again.daemon = True
            again.start()
        else:
            usual_hook(unraisable)

    found = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    mine = [number for number in found if signal.getsignal(number) is signal.SIG_DFL]
    for number in mine:
        signal.signal(number, interrupt)
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if usual:
        signal.signal(signal.SIGINT, note)
    sys.unraisablehook = come_again
    try:
        yield asked
    finally:
        sys.unraisablehook = usual_hook
        for number in mine:
            signal.signal(number, signal.SIG_DFL)
        if usual:
            signal.signal(signal.SIGINT, signal.default_int_handler)
