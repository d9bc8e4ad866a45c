"""The whole description of a study: one typed value, from a TOML file or from options."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Final, get_args

from experiments.io.parsed_file import parsed_file
from experiments.study.inputs.distributions import LARGEST, Distribution, Kind
from experiments.study.inputs.fields import HELP
from experiments.study.inputs.fit_to_case import check_fits
from experiments.study.inputs.read_variable import check_range, read_variable
from experiments.study.inputs.variables import VARIABLES, input_of, is_placement
from icage.case import Case
from icage.errors import InputError

STARTS: Final = ("guaranteed", "cage", "nominal")
PLACES: Final = ("best",)
SAMPLING: Final = ("random", "sobol", "saltelli")
UNCAGED: Final = ("close", "skip")

MOST_TRIALS: Final = 10_000_000
_LARGEST_FILE: Final = 1_000_000


class ConfigError(InputError):
    """A study's description has an unknown field or a value that is not allowed."""


@dataclass(frozen=True, slots=True)
class StudyConfig:
    """What a study runs. Nothing else changes its numbers but the versions of what computes.

    ``experiments.study.inputs.fields.HELP`` says what each field means. ``vary`` holds a
    distribution per variable of ``experiments.study.inputs.variables``; those not named keep their
    nominal value.
    """

    case: str
    grasp: int = 1
    trials: int = 1000
    seed: int = 0
    starts: str = "guaranteed"
    nominal: tuple[float, float, float, float] | None = None
    place: str | None = None
    sampling: str = "random"
    uncaged: str = "close"
    until_half_width: float | None = None
    position_tolerance: float = 5e-3
    angle_tolerance: float = 0.02
    max_time: float = 5.0
    time_step: float = 1e-3
    vary: dict[str, Distribution] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _whole("trials", self.trials, 1, MOST_TRIALS)
        _whole("grasp", self.grasp, 1, 1000)
        _whole("seed", self.seed, 0, 2**63 - 1)
        _one_of("starts", self.starts, STARTS)
        _one_of("sampling", self.sampling, SAMPLING)
        _one_of("uncaged", self.uncaged, UNCAGED)
        _between("position_tolerance", self.position_tolerance, 0.0, 0.5)
        _between("angle_tolerance", self.angle_tolerance, 0.0, math.pi)
        _between("max_time", self.max_time, 0.0, 1000.0)
        _between("time_step", self.time_step, 0.0, 0.02)
        if self.until_half_width is not None:
            _between("until_half_width", self.until_half_width, 0.0, 0.5)
            if self.sampling != "random":
                raise ConfigError(
                    f"until_half_width with sampling = {self.sampling!r}: its design is made for "
                    "all trials; random is needed"
                )
        if self.place is not None:
            _one_of("place", self.place, PLACES)
            if self.nominal is not None:
                raise ConfigError("place and nominal both say where the hand is meant to stand")
        if self.nominal is not None and not self.nominal[3] > 0.0:
            raise ConfigError(f"nominal: sigma is {self.nominal[3]:g}; above 0 is needed")
        drawn = self.starts != "nominal" or self.noisy
        varied = drawn or any(d.varies for d in self.vary.values())
        if self.sampling == "saltelli" and not varied:
            raise ConfigError("sampling = 'saltelli' needs at least one variable that varies")
        grids = [name for name, d in self.vary.items() if d.kind == "grid"]
        if self.sampling == "saltelli" and grids:
            raise ConfigError(
                f"vary.{grids[0]}: a grid has no place in sampling = 'saltelli'; use a range"
            )

    def distribution(self, name: str) -> Distribution:
        """Of any variable, its nominal value if the study does not name it."""
        return self.vary.get(name) or Distribution("fixed", (VARIABLES[name].nominal,))

    @property
    def rough(self) -> bool:
        """Whether any trial may have friction between fingers and object."""
        return self.distribution(input_of("world", "friction").name).high > 0.0

    @property
    def noisy(self) -> bool:
        """Whether any trial may have noise on its outline."""
        return self.distribution(input_of("shape", "noise").name).high > 0.0

    def document(self) -> dict[str, Any]:
        """As kept in ``study.json``: lengths in the case's unit, angles in [rad]."""
        plain = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "vary"}
        plain["nominal"] = None if self.nominal is None else list(self.nominal)
        vary = {
            name: {"kind": d.kind, "parameters": list(d.parameters)}
            for name, d in self.vary.items()
        }
        return {**plain, "vary": vary}


FIELDS: Final = tuple(HELP)

_MEANT: Final = ("nominal", "place")
"""Fields that say where the hand is meant to stand."""


def read_toml(path: Path) -> dict[str, Any]:
    """The table of a study's TOML file, unknown fields refused.

    Raises
    ------
    ConfigError:
        It cannot be read, is no TOML, or has a field that no study has.
    """
    table: dict[str, Any] = parsed_file(path, tomllib.loads, "TOML", _LARGEST_FILE, ConfigError)
    for name in table:
        if name not in FIELDS:
            raise ConfigError(
                f"{str(path)!r}: no such field {name!r}; allowed are {', '.join(FIELDS)}"
            )
    if not isinstance(table.get("vary", {}), dict):
        raise ConfigError(f"{str(path)!r}: vary must be a table: variable = distribution")
    return table


def study_config(table: Mapping[str, Any], case: Case) -> StudyConfig:
    """A checked config from what a user gave; the case's unit and size convert its lengths.

    Raises
    ------
    ConfigError, VariableError, MisfitError:
        Names the field, what was found and what is allowed.
    """
    given = dict(table)
    vary: dict[str, Distribution] = {}
    for name, value in given.pop("vary", {}).items():
        read = read_variable(name, value, case.unit, case.outline.diameter)
        twice = sorted(set(read) & set(vary))
        if twice:
            raise ConfigError(f"vary.{name}: {twice[0]} is given twice")
        vary.update(read)
    for name, value in given.items():
        given[name] = _typed(name, value)
    if not given.get("starts"):
        moved = any(is_placement(name) for name in vary)
        meant = moved or any(given.get(name) is not None for name in _MEANT)
        given["starts"] = "nominal" if meant else "guaranteed"
    for name in _MEANT:
        if given.get(name) is not None and given["starts"] != "nominal":
            raise ConfigError(f"{name} is given, but starts = {given['starts']!r}")
    config = StudyConfig(vary=vary, **given)
    check_fits(vary, config.nominal, case)
    return config


_LATER: Final = ("place",)
"""Fields that the first documents do not have; None by default."""


def config_of(document: Mapping[str, Any], case: Case) -> StudyConfig:
    """The config that ``StudyConfig.document`` has written, checked like one that a user gives.

    Raises
    ------
    ConfigError, VariableError, MisfitError:
        A field is missing, unknown, or its value is not allowed.
    """
    names = {one.name for one in fields(StudyConfig)}
    # documents from before there was such a field mean its default
    document = {**dict.fromkeys(_LATER), **document}
    for name in sorted({*document, *names}):
        if name not in document or name not in names:
            raise ConfigError(
                f"config has {'no' if name in names else 'an unknown'} field {name!r}"
            )
    vary: dict[str, Distribution] = {}
    for name, one in document["vary"].items():
        if name not in VARIABLES:
            raise ConfigError(f"config.vary: there is no variable {name!r}")
        if one["kind"] not in get_args(Kind):
            raise ConfigError(f"config.vary.{name}: there is no distribution {one['kind']!r}")
        if not isinstance(one["parameters"], list) or not all(map(_is_number, one["parameters"])):
            raise ConfigError(f"config.vary.{name}: finite numbers are needed")
        vary[name] = Distribution(one["kind"], tuple(map(float, one["parameters"])))
        check_range(VARIABLES[name], vary[name], case.unit, case.outline.diameter)
    given = {k: _typed(k, value) for k, value in document.items() if k != "vary"}
    config = StudyConfig(vary=vary, **given)
    if config.nominal is not None and config.starts != "nominal":
        raise ConfigError(f"nominal is given, but starts = {config.starts!r}")
    check_fits(vary, config.nominal, case)
    return config


def _typed(name: str, value: Any) -> Any:
    """Whole numbers where they are asked for, floats where floats are."""
    if name in ("trials", "seed", "grasp"):
        if isinstance(value, bool) or not isinstance(value, int):
            raise ConfigError(f"{name} is {value!r}; a whole number is needed")
        return value
    if name == "place" and value is None:
        return None
    if name in ("case", "starts", "place", "sampling", "uncaged"):
        if not isinstance(value, str):
            raise ConfigError(f"{name} is {value!r}; a word is needed")
        return value
    if name == "nominal":
        good = isinstance(value, (list, tuple)) and len(value) == 4
        if value is not None and not (good and all(_is_number(v) for v in value)):
            raise ConfigError(f"nominal is {value!r}; four finite numbers are needed")
        return None if value is None else tuple(float(v) for v in value)
    if value is not None and not _is_number(value):
        raise ConfigError(f"{name} is {value!r}; a finite number is needed")
    return None if value is None else float(value)


def _is_number(value: Any) -> bool:
    plain = isinstance(value, (int, float)) and not isinstance(value, bool)
    return plain and abs(value) <= LARGEST


def _whole(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high:
        raise ConfigError(f"{name} is {value}; {low} to {high} is allowed")


def _between(name: str, value: float, low: float, high: float) -> None:
    if not low < value <= high:
        raise ConfigError(f"{name} is {value:g}; more than {low:g}, up to {high:g}, is allowed")


def _one_of(name: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ConfigError(f"{name} is {value!r}; {', '.join(allowed)} are allowed")
