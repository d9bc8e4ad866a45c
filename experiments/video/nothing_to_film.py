"""What a scene was to show did not happen."""

from __future__ import annotations

from icage.errors import IcageError


class NothingToFilmError(IcageError):
    """An attack that escapes was wanted, and none did; or a grasp, and the closing missed it."""
