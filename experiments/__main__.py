"""``python3 -m experiments COMMAND ...`` from a checkout: ``icage COMMAND ...``, installed first.

On a machine with only Python and pip this makes ``.venv``, installs the pinned versions into it
and runs the command there; in an environment that has icage it runs the command at once.
"""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution

from experiments.environment import environment, run_in


def _installed() -> bool:
    try:
        distribution("icage")
    except PackageNotFoundError:
        return False
    return True


if __name__ == "__main__":
    if _installed():
        from experiments.cli import main

        sys.exit(main())
    try:
        sys.exit(run_in(environment(".venv"), "-m", "experiments", *sys.argv[1:]))
    except subprocess.CalledProcessError as error:
        sys.exit(f"icage: error: the environment could not be made (pip exit {error.returncode})")
    except KeyboardInterrupt:
        sys.exit(130)
