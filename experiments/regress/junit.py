"""The result as JUnit XML, which every CI system reads: a test case per case."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from typing import Any

from experiments.io.one_line import printable


def junit(rows: Sequence[Mapping[str, Any]], seconds: Sequence[float]) -> str:
    """A document; ``seconds`` of each case."""
    bad = sum(1 for row in rows if row["failures"])
    suite = ET.Element(
        "testsuite",
        name="icage regress",
        tests=str(len(rows)),
        failures=str(bad),
        errors="0",
        time=f"{sum(seconds):.1f}",
    )
    for row, spent in zip(rows, seconds, strict=True):
        case = ET.SubElement(
            suite,
            "testcase",
            classname="icage.regress",
            name=printable(row["case"]),
            time=f"{spent:.1f}",
        )
        if row["failures"]:
            failure = ET.SubElement(case, "failure", message=printable(row["failures"][0]))
            failure.text = "\n".join(map(printable, row["failures"]))
    ET.indent(suite)
    return ET.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"
