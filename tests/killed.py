"""A process that dies while it writes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

_KILLED = """
import os, signal, sys
from pathlib import Path
from icage.staging import staging
with staging(Path(sys.argv[1])) as place:
    (place.new / "film.mp4").write_text("half")
    {then}
    os.kill(os.getpid(), signal.SIGKILL)
"""


def killed(folder: Path, then: str = "") -> None:
    """A process that writes and dies there."""
    code = _KILLED.format(then=then)
    assert subprocess.run([sys.executable, "-c", code, str(folder)], check=False).returncode == -9
