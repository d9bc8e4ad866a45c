"""All figures of a case, one file each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path

import matplotlib

from experiments.figures.paper import FIGURES
from experiments.figures.paper.page import SETTINGS, save
from experiments.figures.paper.study import Study
from icage.case import Case
from icage.errors import OutputError


def write_figures(
    case: Case, names: Sequence[str], out: Path, kind: str
) -> Iterator[tuple[Path, str]]:
    """Draw the named figures into ``out`` (made if missing), file and what it shows one by one.

    Raises
    ------
    InputError:
        The contacts are no immobilizing grasp, or nothing can be written into ``out``.
    """
    study = Study.of(case)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{str(out)!r} cannot be made: {error.strerror}") from error
    for name in names:
        with matplotlib.rc_context(SETTINGS):
            figure, note = import_module(f"experiments.figures.paper.{name}").draw(study)
            path = out / f"{name}.{kind}"
            save(figure, path)
        yield path, "; ".join(part for part in (FIGURES[name], note, study.about) if part)
