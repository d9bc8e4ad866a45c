"""Exit codes beyond input errors, and a help that does not make anybody wait."""

from __future__ import annotations

import argparse
import errno
import os
import pkgutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import experiments.commands
from experiments import cli
from models import CASES
from tests.experiments.commands.runner import here

CASE = str(CASES / "L_best.json")
ICAGE = [sys.executable, "-m", "experiments.cli"]
HEAVY = {"numpy", "scipy", "shapely", "numba", "mujoco", "matplotlib", "PIL", "pyarrow", "tqdm"}


COMMANDS = [
    module.name.replace("_", "-") for module in pkgutil.iter_modules(experiments.commands.__path__)
]


def loaded_by(*arguments: str) -> set[str]:
    """Modules that a command has loaded when it ends."""
    script = (
        "import sys\nfrom experiments.cli import main\n"
        "try:\n    code = main(sys.argv[1:])\nexcept SystemExit as end:\n    code = end.code\n"
        "print(*sorted(sys.modules), file=sys.stderr)\nsys.exit(code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True
    )
    assert done.returncode == 0
    return set(done.stderr.split())


@pytest.mark.parametrize("command", [[], *([name] for name in COMMANDS)], ids=" ".join)
def test_help_loads_nothing_heavy(command: list[str]):
    assert not HEAVY & loaded_by(*command, "--help")


def test_a_small_plan_is_made_of_little():
    """It is interpreted: no numba, and of all else only what a plan is made of."""
    wanted = {"numpy", "shapely"}
    loaded = loaded_by("plan", str(CASES / "pliers_best.json"))
    assert wanted <= loaded
    assert not (HEAVY | {"llvmlite", "tinycss2", "cssselect2", "tyro", "trimesh"}) - wanted & loaded
    assert not {name for name in loaded if name.startswith("icage.contact_space")}


@pytest.mark.slow
def test_a_plan_draws_and_moves_nothing():
    """Nor for disc fingers, whose kernels are compiled and whose true curve scipy follows."""
    loaded = loaded_by("plan", "pliers")
    assert not HEAVY - {"numpy", "shapely", "numba", "scipy"} & loaded


def test_help_names_every_command():
    done = subprocess.run([*ICAGE, "--help"], capture_output=True, text=True, check=True)
    for module in pkgutil.iter_modules(experiments.commands.__path__):
        assert module.name.replace("_", "-") in done.stdout.split()


def test_every_command_has_help(capsys: Any):
    for module in pkgutil.iter_modules(experiments.commands.__path__):
        name = module.name.replace("_", "-")
        result = here(capsys, name, "--help")
        assert result.code == 0
        assert result.out.startswith(f"usage: icage {name}")


def test_the_version(capsys: Any):
    assert here(capsys, "--version").out.startswith("icage 0.")


def raising(error: BaseException) -> Any:
    def run(_: argparse.Namespace) -> int:
        raise error

    return run


def test_our_own_fault_is_exit_1_with_one_line(monkeypatch: Any, capsys: Any):
    monkeypatch.setattr("experiments.commands.plan.run", raising(ZeroDivisionError("x\ny")))
    result = here(capsys, "plan", CASE)
    assert (result.code, result.out) == (1, "")
    assert result.err.count("\n") == 1
    assert "ZeroDivisionError: x y" in result.err
    assert "ICAGE_DEBUG=1" in result.err


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError(), "not enough memory"),
        (OSError(errno.ENOMEM, "Cannot allocate memory"), "not enough memory"),
        (OSError(errno.ENOSPC, "No space left", "a.json"), "a.json cannot be written: No space"),
        (OSError(errno.EMFILE, "Too many open files", "a"), "too many files are open"),
        (PermissionError(errno.EACCES, "Permission denied", "a.json"), "'a.json': Permission"),
        (shapely.GEOSException("TopologyException: side location"), "gave up on this object: Topo"),
        (np.linalg.LinAlgError("Singular matrix"), "gave up on this object: Singular matrix"),
    ],
)  # fmt: skip
def test_what_gives_out_beneath_us_is_exit_2_with_one_line(
    error: Exception, words: str, monkeypatch: Any, capsys: Any
):
    monkeypatch.setattr("experiments.commands.plan.run", raising(error))
    assert words in here(capsys, "plan", CASE).error_line()


def test_memory_that_cannot_be_had_is_exit_2():
    """As the system refuses it, and not by an exception of ours."""
    program = (
        "import sys, experiments.commands.plan as plan\n"
        "from experiments.cli import main\n"
        "plan.run = lambda args: bytearray(10**12) and 0\n"
        f"sys.exit(main(['plan', {CASE!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "icage: error: there is not enough memory for this\n"


WARNS = (
    "import sys, warnings, experiments.commands.plan as plan\n"
    "from experiments.cli import main\n"
    "import numpy as np\n"
    "def run(args):\n"
    "    warnings.warn('of a library', DeprecationWarning)\n"
    "    return int(np.float64(1e300) * np.float64(1e300) < 1.0)\n"
    "plan.run = run\n"
    f"sys.exit(main(['plan', {CASE!r}]))"
)


@pytest.mark.parametrize("shown", [False, True])
def test_warnings_of_libraries_are_seen_by_who_asks_for_them(shown: bool):
    options = ["-W", "always"] if shown else []
    done = subprocess.run([sys.executable, *options, "-c", WARNS], capture_output=True, text=True)
    assert done.returncode == 0
    assert ("overflow encountered" in done.stderr) == shown
    assert ("of a library" in done.stderr) == shown
    assert shown or done.stderr == ""


def test_an_interrupt_inside_a_compiled_function_is_one(monkeypatch: Any, capsys: Any):
    error = SystemError("<built-in function> returned a result with an exception set")
    error.__cause__ = SystemError("another compiled function between")
    error.__cause__.__context__ = KeyboardInterrupt()
    monkeypatch.setattr("experiments.commands.plan.run", raising(error))
    result = here(capsys, "plan", CASE)
    assert (result.code, result.out, result.err) == (130, "", "icage: error: interrupted\n")


def test_a_traceback_for_those_who_ask(monkeypatch: Any):
    monkeypatch.setattr("experiments.commands.plan.run", raising(ZeroDivisionError()))
    monkeypatch.setenv("ICAGE_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        cli.main(["plan", CASE])


def wait_until_idle(pid: int) -> None:
    """Until a process has used no processor time for a second; at most a minute."""
    stat = Path(f"/proc/{pid}/stat")
    if not stat.exists():
        time.sleep(3.0)
        return
    last = -1
    for _ in range(60):
        time.sleep(1.0)
        used = sum(map(int, stat.read_text().rpartition(")")[2].split()[11:13]))
        if used == last:
            return
        last = used


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize(
    ("sent", "code", "word"),
    [("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "terminated"), ("SIGHUP", 129, "terminated")],
)
def test_an_end_that_is_asked_for_is_an_interrupt_without_a_traceback(
    sent: str, code: int, word: str
):
    command = subprocess.Popen(
        [*ICAGE, "query", CASE, "-"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # whoever starts tests in the background of a shell has interrupts ignored by inheritance
        preexec_fn=lambda: signal.signal(getattr(signal, sent), signal.SIG_DFL),
    )
    wait_until_idle(command.pid)  # it waits for its placements
    command.send_signal(getattr(signal, sent))
    out, err = command.communicate(timeout=60)
    assert (command.returncode, out, err) == (code, "", f"icage: error: {word}\n")


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_signal_that_somebody_handles_stays_theirs(monkeypatch: Any, capsys: Any):
    heard: list[int] = []

    def asks(_: Any) -> int:
        os.kill(os.getpid(), signal.SIGTERM)
        return 0

    monkeypatch.setattr("experiments.commands.plan.run", asks)
    before = signal.signal(signal.SIGTERM, lambda number, _: heard.append(number))
    try:
        assert here(capsys, "plan", CASE).code == 0
    finally:
        signal.signal(signal.SIGTERM, before)
    assert heard == [signal.SIGTERM]
    assert here(capsys, "plan", CASE).code == 143
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX pipes")
def test_a_reader_that_goes_away_is_no_drama():
    command = subprocess.Popen(
        [*ICAGE, "plan", CASE, "--json", "-"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert command.stdout is not None
    assert command.stderr is not None
    command.stdout.close()
    err = command.stderr.read()
    assert command.wait(timeout=60) == 1
    assert err == ""


def test_an_outline_becomes_a_case_file(tmp_path: Path, capsys: Any):
    from icage.formats.case_json import read_object
    from models import outline_path

    file = tmp_path / "saw.json"
    drawing = str(outline_path("saw").parent / "saw.svg")
    options = ["--width", "450", "--tolerance", "1.5", "--unit", "mm", "--json", str(file)]
    result = here(capsys, "outline", drawing, *options)
    assert result.code == 0
    assert result.out.startswith("saw: 53 vertices")
    made, shipped = read_object(file), read_object(outline_path("saw"))
    assert made.outline.vertices == pytest.approx(shipped.outline.vertices, abs=1e-9)
    assert made.unit == shipped.unit == "mm"


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX streams")
@pytest.mark.parametrize("further", [[], ["--json", "-"]])
def test_a_closed_standard_output_is_no_drama(further: list[str]):
    command = 'exec "$@" >&-'
    done = subprocess.run(
        ["sh", "-c", command, "sh", *ICAGE, "plan", CASE, *further], stderr=subprocess.PIPE
    )
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX streams")
def test_nothing_meant_for_a_closed_standard_error_lands_on_standard_output():
    done = subprocess.run(
        ["sh", "-c", 'exec "$@" 2>&-', "sh", *ICAGE, "plan", "none.json"], stdout=subprocess.PIPE
    )
    assert (done.returncode, done.stdout) == (2, b"")


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="needs /dev/full")
def test_a_full_standard_output_is_exit_2():
    """As a stream that is open already: nothing here may name the device as a file to write."""
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*ICAGE, "plan", CASE, "--json", "-"], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 2
    assert done.stderr == "icage: error: the answer cannot be written: No space left on device\n"


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs /proc")
@pytest.mark.parametrize(
    "arguments", [("plan", "--json", "/proc/x.json"), ("replay", "--out", "/proc/x")]
)
def test_a_place_that_takes_no_file(arguments: tuple[str, ...], capsys: Any):
    command, *option = arguments
    assert "cannot be written" in here(capsys, command, CASE, *option).error_line()


def test_an_interrupt_in_an_import_that_runs_text_has_its_code(tmp_path: Path) -> None:
    """Python would end by the signal itself, with another code than is promised."""
    (tmp_path / "started.py").write_text(
        "import sys\nimport experiments.cli as cli\n"
        "cli.parser = lambda: exec('raise KeyboardInterrupt')\nsys.exit(cli.main([]))\n"
    )
    root = Path(cli.__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-m", "started"], cwd=tmp_path, capture_output=True, check=False,
        env={**os.environ, "PYTHONPATH": str(root)}, timeout=120,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (130, b"icage: error: interrupted\n")


@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_that_a_library_makes_another_error_of_is_the_end(
    sent: signal.Signals, code: int, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def importing() -> None:
        try:
            os.kill(os.getpid(), sent)
            time.sleep(5.0)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None

    monkeypatch.setattr(cli, "parser", importing)
    kept = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored behind a shell
    try:
        result = here(capsys, "plan", CASE)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, kept)
    assert (result.code, result.err.count("our fault")) == (code, 0)
