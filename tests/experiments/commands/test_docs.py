"""What the README and the page of formats show works as shown."""

from __future__ import annotations

import contextlib
import io
import json
import pkgutil
import re
from pathlib import Path

import experiments.commands
from experiments.environment import ROOT
from icage.formats.case_json import parse_case
from icage.planner import plan

README = (ROOT / "README.md").read_text(encoding="utf-8")
FORMATS = (ROOT / "docs/formats.md").read_text(encoding="utf-8")


def test_the_case_of_the_formats_page_is_a_cage():
    (example,) = re.findall(r"```json\n(.*?)```", FORMATS, re.DOTALL)
    case = parse_case(json.loads(example), Path())
    assert plan(case.outline, case.contacts, case.finger_radius).status == "cage"


def test_the_python_of_the_readme_runs():
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(example, {})
    cage, trials = out.getvalue().splitlines()
    assert cage.startswith("<Cage pliers/1_best: sigma 50.4419 <")
    assert cage.endswith(" target")
    assert trials == "20"


def test_every_command_shown_exists_and_every_command_is_shown():
    modules = pkgutil.iter_modules(experiments.commands.__path__)
    commands = {module.name.replace("_", "-") for module in modules}
    assert set(re.findall(r"^## `icage ([\w-]+)", FORMATS, re.MULTILINE)) >= commands
    assert set(re.findall(r"^    icage ([\w-]+)", README, re.MULTILINE)) <= commands


def test_links_of_the_readme_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert target.startswith("https://") or (ROOT / target).exists(), target
