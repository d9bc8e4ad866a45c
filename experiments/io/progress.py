"""Progress on standard error, for anything that takes more than two seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import NoReturn


@contextmanager
def stage_bar() -> Generator[Callable[[str, int, int], None]]:
    """A callback (stage, done, total) that drives one bar per stage; silent when not a terminal."""
    from tqdm import tqdm

    bars: dict[str, tqdm[NoReturn]] = {}

    def report(stage: str, done: int, total: int) -> None:
        if stage not in bars:
            bars[stage] = tqdm(
                total=total, desc=stage, delay=2.0, leave=False, disable=None, file=sys.stderr
            )
        bars[stage].update(done - bars[stage].n)

    try:
        yield report
    finally:
        for bar in bars.values():
            bar.close()


_EVERY = 5.0
"""[s] Between two plain lines."""


@contextmanager
def search_bar() -> Generator[Callable[[str, int, int, float | None], None]]:
    """A callback (stage, done, total, best so far) for a search that may be stopped.

    One bar per stage on a terminal, else a plain line every five seconds.
    """
    if sys.stderr.isatty():
        from tqdm import tqdm

        bars: dict[str, tqdm[NoReturn]] = {}

        def on_bar(stage: str, done: int, total: int, best: float | None) -> None:
            if stage not in bars:
                for bar in bars.values():
                    bar.close()
                bars[stage] = tqdm(total=total, desc=stage, leave=False, file=sys.stderr)
            if best is not None:
                bars[stage].set_postfix_str(f"best {best:.4f}, Ctrl-C keeps it", refresh=False)
            bars[stage].update(done - bars[stage].n)

        try:
            yield on_bar
        finally:
            for bar in bars.values():
                bar.close()
        return
    said = time.monotonic()

    def in_lines(stage: str, done: int, total: int, best: float | None) -> None:
        nonlocal said
        if time.monotonic() - said >= _EVERY:
            said = time.monotonic()
            so_far = "nothing yet" if best is None else f"best so far {best:.4f}"
            print(f"icage: {stage}: {done} of {total}, {so_far}", file=sys.stderr, flush=True)

    yield in_lines
