"""The inputs of a study as lists to read: ``icage study --variables``, and the page of formats."""

from __future__ import annotations

from collections.abc import Iterator

from experiments.study.inputs.variables import GROUPS, PAIRS, VARIABLES, own_unit


def listing() -> list[str]:
    """All variables, a line each, for ``icage study --variables``."""
    lines: list[str] = []
    for group in GROUPS:
        lines.append(f"{group}:")
        for one in (v for v in VARIABLES.values() if v.group == group):
            unit = own_unit(one, "length")
            allowed = f"nominal {one.written_nominal}, allowed {one.written_range}"
            lines.append(f"  {one.name:<16} [{unit}] {one.help} ({allowed})")
    pairs = (f"{pair} = {', '.join(names)}" for pair, names in PAIRS.items())
    lines.append(f"pairs: {', '.join(pairs)}")
    lines.append("a distribution is VALUE, LOW:HIGH, normal:SD, normal:MEAN:SD,")
    lines.append("truncated:MEAN:SD:LOW:HIGH, grid:A,B,C or grid:LOW:HIGH:COUNT; numbers may carry")
    lines.append("mm, cm, m (or % of the diameter), deg, rad, % (of 1). normal is for what may be")
    lines.append("negative: its mean and four standard deviations must lie in the range")
    return lines


def markdown() -> Iterator[str]:
    """All variables as the table of ``docs/formats.md``."""
    yield "| input | group | unit | nominal | allowed | what it is | own model |"
    yield "|---|---|---|---|---|---|---|"
    for one in VARIABLES.values():
        unit = own_unit(one, "length")
        own = "yes" if one.geometry else "no"
        yield (
            f"| `{one.name}` | {one.group} | {unit} | {one.written_nominal} | {one.written_range} "
            f"| {one.help} | {own} |"
        )
