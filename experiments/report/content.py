"""What a report says, before it is a page: an answer, and sections of tables and pictures.

All text here is plain: whatever a name holds, ``page_html`` shows it as text.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, TypeAlias

from experiments.io.intervals import CONFIDENCE, rate_upper, wilson
from experiments.study.report.names import percent

MOST_ROWS: Final = 1000
"""Rows of a table on a page; whoever wants more has the file that they are from."""

MOST_FAILURES: Final = 200
"""Failures that are listed one by one."""

Kind: TypeAlias = Literal["text", "number", "command"]


@dataclass(frozen=True, slots=True)
class Cell:
    """A text, and the number by which it is sorted if it has one."""

    text: str
    key: float | None = None


@dataclass(frozen=True, slots=True)
class Column:
    """The head of a column."""

    name: str
    kind: Kind = "text"


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under heads; ``beside`` is what holds of every row: settings, seeds, kinds of interval.

    ``left_off`` is how many rows there are besides.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    beside: str = ""
    left_off: int = 0
    more_in: str = "the document"

    @classmethod
    def cut(
        cls, title: str, columns: Sequence[Column], rows: Sequence[tuple[Cell, ...]], beside: str,
        more_in: str,
    ) -> Table:  # fmt: skip
        """A table of at most ``MOST_ROWS`` of the rows."""
        kept = tuple(rows[:MOST_ROWS])
        return cls(title, tuple(columns), kept, beside, len(rows) - len(kept), more_in)


@dataclass(frozen=True, slots=True)
class Bar:
    """A row of a chart: a value with its interval; ``high`` None: open upwards."""

    name: str
    low: float
    value: float | None
    high: float | None
    words: str


@dataclass(frozen=True, slots=True)
class Line:
    """A vertical line of a chart with its name."""

    at: float
    name: str


@dataclass(frozen=True, slots=True)
class Chart:
    """Values with intervals, one below another, on one axis in ``unit``."""

    title: str
    unit: str
    bars: tuple[Bar, ...]
    lines: tuple[Line, ...] = ()
    ends: tuple[float, float] | None = None
    left_off: int = 0


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of a file; ``media`` is its media type."""

    title: str
    media: str
    data: bytes
    words: str


@dataclass(frozen=True, slots=True)
class Film:
    """A video: its bytes, or None where the page only links to it, and what is said of that."""

    name: str
    link: str
    data: bytes | None
    words: str


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph."""

    text: str


@dataclass(frozen=True, slots=True)
class Command:
    """A line for a shell, and what it does."""

    line: str
    words: str


Part: TypeAlias = Table | Chart | Picture | Film | Words | Command


@dataclass(frozen=True, slots=True)
class Section:
    """A heading and what stands below it."""

    title: str
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """A page: ``held`` None where nothing was checked, as in a study."""

    title: str
    kind: str
    held: bool | None
    answer: str
    facts: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...] = field(default=())


def number_cell(value: float | None, digits: int = 4, unit: str = "") -> Cell:
    """A number, or a dash."""
    if value is None:
        return Cell("-")
    return Cell(f"{value + 0.0:.{digits}g}{unit and f' {unit}'}", value)


def count_cell(value: int) -> Cell:
    """A count."""
    return Cell(str(value), float(value))


def rate_cells(successes: int, trials: int) -> tuple[Cell, Cell]:
    """A rate and Wilson's interval; dashes without trials."""
    if not trials:
        return Cell("-"), Cell("-")
    low, high = wilson(successes, trials)
    rate = successes / trials
    return Cell(percent(rate), rate), Cell(f"{percent(low)} to {percent(high)}", low)


RATES: Final = (Column("rate", "number"), Column("95 % (Wilson)", "number"))
"""Heads of ``rate_cells``."""


def upper_cell(successes: int, trials: int) -> Cell:
    """The exact one-sided bound on a rate that should be small."""
    if not trials:
        return Cell("-")
    high = rate_upper(successes, trials)
    return Cell(f"below {percent(high)}", high)


UPPER: Final = Column(f"{CONFIDENCE:.0%} (Clopper-Pearson)".replace("%", " %"), "number")
"""Head of ``upper_cell``."""


def rate_bar(name: str, successes: int, trials: int) -> Bar:
    """A row of a chart of rates, [%]."""
    low, high = wilson(successes, trials)
    rate = successes / trials if trials else None
    words = f"{successes} of {trials}"
    value = None if rate is None else 100.0 * rate
    return Bar(name, 100.0 * low, value, 100.0 * high, words)


def versions_words(versions: dict[str, str]) -> str:
    """All versions in a line."""
    return ", ".join(f"{name} {version}" for name, version in versions.items())
