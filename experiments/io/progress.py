"""Progress on standard error, for anything that takes more than two seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import NoReturn

from experiments.io.one_line import printable, unguarded


@contextmanager
def _bars(delay: float, one: bool) -> Generator[Callable[[str, int, int, str], None]]:
    """A callback (stage, done, total, words) that drives a bar per stage, of which ``one`` stands.

    Nothing is seen in the first ``delay`` seconds, [s], nor where no terminal is.
    """
    from tqdm import tqdm

    bars: dict[str, tqdm[NoReturn]] = {}

    def close() -> None:
        for bar in bars.values():
            bar.close()

    def report(stage: str, done: int, total: int, words: str) -> None:
        if stage not in bars:
            if one:
                close()
            bars[stage] = tqdm(
                total=total,
                desc=printable(stage),
                delay=delay,
                leave=False,
                disable=None,
                file=unguarded(sys.stderr),
            )
        if words:
            bars[stage].set_postfix_str(words, refresh=False)
        bars[stage].update(done - bars[stage].n)

    try:
        yield report
    finally:
        close()


@contextmanager
def stage_bar() -> Generator[Callable[[str, int, int], None]]:
    """A callback (stage, done, total) that drives one bar per stage; silent when not a terminal."""
    with _bars(2.0, one=False) as report:
        yield lambda stage, done, total: report(stage, done, total, "")


_EVERY = 5.0
"""[s] Between two plain lines."""


@contextmanager
def search_bar() -> Generator[Callable[[str, int, int, float | None], None]]:
    """A callback (stage, done, total, best so far) for a search that may be stopped.

    One bar per stage on a terminal, else a plain line every five seconds.
    """
    if sys.stderr.isatty():
        with _bars(0.0, one=True) as report:
            yield lambda stage, done, total, best: report(
                stage, done, total, "" if best is None else f"best {best:.4f}, Ctrl-C keeps it"
            )
        return
    said = time.monotonic()

    def in_lines(stage: str, done: int, total: int, best: float | None) -> None:
        nonlocal said
        if time.monotonic() - said >= _EVERY:
            said = time.monotonic()
            so_far = "nothing yet" if best is None else f"best so far {best:.4f}"
            print(f"icage: {stage}: {done} of {total}, {so_far}", file=sys.stderr, flush=True)

    yield in_lines
