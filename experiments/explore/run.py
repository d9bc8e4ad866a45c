"""From a case to its page: plan, list what else holds the object, write one file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiments.explore.document import explore_document
from experiments.explore.page_html import page_html
from experiments.io.one_line import one_line
from icage.case import Case
from icage.cells.query_tables import query_tables
from icage.formats.plan_json import plan_summary
from icage.formats.whole_files import whole_file
from icage.friction.levels import JamTolerance, friction_levels
from icage.planner import plan


@dataclass(frozen=True, slots=True)
class Page:
    """What was written: ``size`` bytes, with so many cells ``outside`` the cage that hold."""

    size: int
    outside: int


def write_page(case: Case, path: Path, mus: Sequence[float] = ()) -> Page:
    """Write the page of a case with a grasp, whole or not at all.

    ``mus`` are coefficients of friction for its slider, sorted there.

    Raises
    ------
    InputError:
        Friction of disc fingers; an outline too large for a page.
    OutputError:
        The file cannot be written.
    """
    cage = plan(case)
    tolerance = JamTolerance()
    friction = friction_levels(cage, sorted(set(mus)), tolerance) if mus else ()
    tables = query_tables(cage, os.cpu_count() or 1)
    document = explore_document(cage, tables, case.name, case.unit, friction, tolerance)
    lines = plan_summary(cage, case.name, case.unit, exact_fit=True)
    summary = "\n".join(map(one_line, lines))
    content = page_html(document, summary).encode("utf-8")
    with whole_file(path) as part:
        part.write_bytes(content)
    return Page(len(content), len(tables.outside))
