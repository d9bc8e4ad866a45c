"""Progress on standard error, for anything that takes more than two seconds."""

from __future__ import annotations

import sys
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
