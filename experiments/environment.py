"""Make the project's own environment with nothing but Python and pip.

Some systems refuse pip outside a virtual environment and some ship ``venv`` without its copy of
pip; both are met here. Standard library only: this runs before anything is installed.
"""

from __future__ import annotations

import hashlib
import os
import re
import signal
import subprocess
import sys
import tomllib
import venv
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
"""The checkout: where pyproject.toml and constraints.txt are."""

_STAMP = "icage-installed"


def environment(
    name: str, extras: str = "", *, lowest: bool = False, by: Path | None = None
) -> Path:
    """Python of the environment ``ROOT/name``, made or brought up to date first.

    Parameters
    ----------
    name:
        Folder of the environment, inside the checkout.
    extras:
        Extras of the project to install, e.g. ``"[dev]"``.
    lowest:
        Install the lower bounds pyproject.toml declares instead of the pinned versions.
    by:
        The Python that it is of, if not this one; then nothing is built, only wheels are taken.

    Raises
    ------
    subprocess.CalledProcessError:
        It cannot be made, or what is needed cannot be installed.
    """
    folder = ROOT / name
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    constraints = folder / "lower-bounds.txt" if lowest else ROOT / "constraints.txt"
    wanted = lower_bounds() if lowest else constraints.read_text(encoding="utf-8")
    state = wanted + (ROOT / "pyproject.toml").read_text(encoding="utf-8") + str(by or "")
    digest = hashlib.sha256(state.encode()).hexdigest()
    stamp = folder / _STAMP
    made_of, had = _read_stamp(stamp)
    if python.exists() and made_of == digest and extras in ("", had):
        return python
    extras = extras or had  # whoever needs less is served by more, and takes nothing away
    print(f"icage: preparing the environment {name}", file=sys.stderr, flush=True)
    if by is not None:  # made anew: it may be of another Python
        subprocess.run([str(by), "-m", "venv", "--clear", str(folder)], check=True)
    elif not python.exists():
        _create(folder)
    stamp.unlink(missing_ok=True)
    if lowest:
        constraints.write_text(wanted, encoding="utf-8")
    # a third of pip's time goes into bytecode, of which a fifth is ever imported: Python makes that
    target = ["--no-compile", "-c", str(constraints), "-e", f"{ROOT}{extras}"]
    if by is not None:
        target.append("--only-binary=:all:")
    subprocess.run([*_pip(python), "install", "--quiet", *target], check=True, cwd=ROOT)
    stamp.write_text(f"{digest} {extras}", encoding="utf-8")
    return python


def run_in(python: Path, *arguments: str) -> int:
    """Run Python with these arguments and return its exit code, as if it were this process.

    On an interrupt, which a terminal sends to both, the child is left to tidy up (a second one
    ends it): subprocess.run would kill it a quarter of a second later. Other signals that ask this
    process to end are handed on.
    """
    child = subprocess.Popen([str(python), *arguments])
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, lambda asked, _: child.send_signal(asked))
    try:
        code = child.wait()
        return code if code >= 0 else 128 - code
    except KeyboardInterrupt:
        with suppress(KeyboardInterrupt):
            child.wait()
        return 130
    finally:
        child.kill()  # does nothing to one that has ended


def lower_bounds() -> str:
    """The lower bound of every direct dependency and test tool, as a constraints file."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        project = tomllib.load(file)["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["test"]]
    bounds = [re.fullmatch(r"([\w.-]+)>=([\d.]+)(,.*)?", entry) for entry in needed]
    return "".join(f"{bound[1]}=={bound[2]}\n" for bound in bounds if bound)


def _read_stamp(stamp: Path) -> tuple[str, str]:
    """What the environment was made of (a digest), and with which extras; empty if unknown."""
    if not stamp.exists():
        return "", ""
    digest, _, extras = stamp.read_text(encoding="utf-8").partition(" ")
    return digest, extras


def _create(folder: Path) -> None:
    """A virtual environment; without pip in it where this Python has no copy to give."""
    try:
        venv.create(folder, with_pip=True)
    except subprocess.CalledProcessError:
        venv.create(folder, with_pip=False)


def _pip(python: Path) -> list[str]:
    """The environment's own pip or, where it has none, this Python's pip aimed at it."""
    own = [str(python), "-m", "pip"]
    found = subprocess.run([*own, "--version"], capture_output=True, check=False)
    if found.returncode == 0:
        return own
    return [sys.executable, "-m", "pip", "--python", str(python)]
