"""What tests of single kernels share."""

from __future__ import annotations

import pytest

from icage.kernels import compiled


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels run as plain Python: a kernel that is only called by others has no machine code."""
    monkeypatch.setattr(compiled._process, "never", True)
