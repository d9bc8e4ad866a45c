"""What tests of single kernels share."""

from __future__ import annotations

import pytest

from icage.kernels import compiled


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels run as plain Python: a kernel that only others call has no machine code of its own,
    and what stands in for a part of one is not seen by machine code."""
    monkeypatch.setattr(compiled._process, "never", True)
    for kernel in compiled._kernels:
        if kernel.machine is not None:
            monkeypatch.setattr(kernel, "machine", None)
