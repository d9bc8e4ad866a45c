"""``python3 -m tests``: everything CI checks, from a bare checkout.

Makes ``.venv`` (only Python and pip are needed), then format, lint, types, import contracts and
last pytest with the doctests, whose closing line is the last line printed. The exit code is
non-zero if any of them failed.

    python3 -m tests                  all of it
    python3 -m tests --fast           without the tests marked slow
    python3 -m tests --lowest --fast  only pytest, with the declared lower bounds installed
    python3 -m tests --newest --fast  only pytest, by the newest Python here that has all wheels
    python3 -m tests --here           in the environment of this Python
    python3 -m tests --fast tests/sim any further argument goes to pytest
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

from experiments.environment import ROOT, environment
from tests.newer_python import newer_pythons

CHECKS = {
    "format": ["ruff", "format", "--check", "."],
    "lint": ["ruff", "check", "."],
    "types": ["pyright"],
    "imports": ["lint-imports"],
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m tests", description="run all checks")
    parser.add_argument("--fast", action="store_true", help="leave out the tests marked slow")
    parser.add_argument("--lowest", action="store_true", help="pytest at the lower bounds only")
    parser.add_argument("--newest", action="store_true", help="pytest by the newest Python only")
    parser.add_argument("--workers", type=int, default=2, help="processes of pytest")
    parser.add_argument("--here", action="store_true", help="use this Python's environment")
    options, further = parser.parse_known_args()
    # hundreds of processes load the same modules, which pip has left as text
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if options.here:
        python = Path(sys.executable)
    elif options.lowest:
        python = environment(".venv-lowest", "[test]", lowest=True)
    elif options.newest:
        found = newest_environment()
        if found is None:
            return 0
        python = found
    else:
        python = environment(".venv", "[dev]")
    only_tests = options.lowest or options.newest
    if only_tests:
        # numba's files are named by Python's version and not by numba's: those of tests that run
        # beside each other would be written over and over
        os.environ.setdefault("NUMBA_CACHE_DIR", str(python.parent.parent / "kernels"))
    compiling = None if only_tests or further else compile_kernels(python)
    failed = [] if only_tests else [name for name in CHECKS if not check(name, python)]
    if compiling is not None:
        compiling.wait()  # what failed here fails again in the tests, and says why
    if failed:
        print(f"== failed so far: {', '.join(failed)}", flush=True)
    fast = ["-m", "not slow"] if options.fast else []
    workers = str(options.workers)
    command = [str(python), "-m", "pytest", "-q", "-n", workers, "--dist", "worksteal"]
    tested = subprocess.run([*command, *fast, *further], check=False, cwd=ROOT)
    return tested.returncode or int(bool(failed))


def newest_environment() -> Path | None:
    """An environment of the newest Python on this machine for which everything has wheels."""
    for python in newer_pythons():
        try:
            made = environment(".venv-newest", "[test]", by=python)
        except subprocess.CalledProcessError:
            print(f"== {python} has not all wheels: an older one is tried", flush=True)
            continue
        print(f"== newest Python: {python}", flush=True)
        return made
    mine = ".".join(map(str, sys.version_info[:2]))
    print(f"== newest Python: none newer than {mine} here, nothing more is tested", flush=True)
    return None


def compile_kernels(python: Path) -> subprocess.Popen[bytes]:
    """Compile in the background, while other checks run: both workers of pytest would do it."""
    return subprocess.Popen(
        [str(python), "-m", "icage.compile_kernels"],
        cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


def check(name: str, python: Path) -> bool:
    """Run one tool of the environment; its output only where it fails."""
    tool, *arguments = CHECKS[name]
    if tool == "pyright":
        arguments += ["--pythonpath", str(python)]
    started = time.perf_counter()
    path = os.pathsep.join([str(python.parent), os.environ.get("PATH", "")])
    done = subprocess.run(
        [str(python.parent / tool), *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env={**os.environ, "PATH": path},
    )
    result = "ok" if done.returncode == 0 else "FAILED"
    print(f"== {name}: {result} ({time.perf_counter() - started:.0f} s)", flush=True)
    if done.returncode:
        print(done.stdout + done.stderr, flush=True)
    return done.returncode == 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except subprocess.CalledProcessError as error:
        sys.exit(f"the environment could not be made (pip exit {error.returncode})")
    except KeyboardInterrupt:
        sys.exit(130)
