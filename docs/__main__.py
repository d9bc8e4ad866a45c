"""``python3 -m docs``: the documents as a site, in ``out/docs/index.html``.

Makes ``.venv-docs`` first (only Python and pip are needed). A warning is an error: no page without
a way to it, no link or citation that leads nowhere. Nothing is fetched while it is built.

    python3 -m docs           in an environment of its own
    python3 -m docs --here    in the environment of this Python, which has ``icage[docs]``
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from experiments.environment import ROOT, environment


def main() -> int:
    """Make the site, and say where its first page is."""
    parser = argparse.ArgumentParser(prog="python3 -m docs", description="make the site")
    parser.add_argument("--here", action="store_true", help="use this Python's environment")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "docs", help="folder")
    options = parser.parse_args()
    python = sys.executable if options.here else environment(".venv-docs", "[docs]")
    strict = ["-n", "-W", "--keep-going"]
    command = ["-m", "sphinx", "-q", *strict, "-c", "docs", ".", str(options.out.resolve())]
    done = subprocess.run([str(python), *command], check=False, cwd=ROOT)
    if done.returncode == 0:
        print(options.out / "index.html")
    return done.returncode


if __name__ == "__main__":
    try:
        sys.exit(main())
    except subprocess.CalledProcessError as error:
        sys.exit(f"the environment could not be made (pip exit {error.returncode})")
    except KeyboardInterrupt:
        sys.exit(130)
