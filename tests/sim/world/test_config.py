"""What a configuration refuses: each of its fields, of a kind that the engine does not take."""

from __future__ import annotations

from dataclasses import fields

import pytest

from icage.errors import InputError
from sim.world.config import SimConfig


@pytest.mark.parametrize("name", [field.name for field in fields(SimConfig)])
@pytest.mark.parametrize("value", ["much", None, [1.0, 2.0], float("nan")])
def test_no_field_takes_what_is_no_number(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"SimConfig.{name}"):
        SimConfig(**{name: value})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("solver_iterations", 50.0),
        ("still_steps", 0),
        ("solimp", ([0.9999], 0.99999, 1e-4, 0.5, 2.0)),
        ("solimp", (0.9, 0.99)),
    ],
)
def test_counts_are_whole_and_solimp_is_five_numbers(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"SimConfig.{name}"):
        SimConfig(**{name: value})  # type: ignore[arg-type]
