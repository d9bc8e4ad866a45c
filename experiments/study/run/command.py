"""The command that runs a study again; its numbers are as short as the same bits allow."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.variables import DEGREE, PERCENT, VARIABLES, is_placement


def command_line(document: Mapping[str, Any]) -> str:
    """The command for the study of a document, whatever it was given by."""
    config, default = document["config"], StudyConfig(case="").document()
    words = ["icage", "study", config["case"]]
    if any(is_placement(name) for name in config["vary"]):
        del default["starts"]  # it would be nominal
    for name, value in config.items():
        if name in ("case", "vary") or value is None or value == default.get(name):
            continue
        words += _option(name, value)
    for name, one in config["vary"].items():
        words += ["--vary", f"{name}={_distribution(name, one, document.get('diameter'))}"]
    return " ".join(shlex.quote(word) for word in [*words, "--out", "DIR"])


def _option(name: str, value: Any) -> list[str]:
    option = f"--{name.replace('_', '-')}"
    if isinstance(value, (list, tuple)):
        text = ",".join(shortest(float(one)) for one in value)
    else:
        text = shortest(value) if isinstance(value, float) else str(value)
    return [f"{option}={text}"] if text.startswith("-") else [option, text]


def _distribution(name: str, one: Mapping[str, Any], diameter: float | None) -> str:
    """As a user would write it: VALUE and LOW:HIGH have no word before them."""
    numbers = [min(_forms(name, float(value), diameter), key=len) for value in one["parameters"]]
    if one["kind"] == "grid":
        return "grid:" + ",".join(numbers)
    word = [] if one["kind"] in ("fixed", "uniform") else [one["kind"]]
    return ":".join([*word, *numbers])


def _forms(name: str, value: float, diameter: float | None) -> Iterator[str]:
    """Ways to write a value of a variable, each read as exactly this value; angles say the unit."""
    measure = VARIABLES[name].measure
    if measure == "angle":
        yield from _as_multiple(value, (DEGREE,), "deg")
        yield f"{shortest(value)}rad"
        return
    yield shortest(value)
    if measure == "length" and diameter is not None:
        yield from _as_multiple(value, (PERCENT, diameter), "%")


def _as_multiple(value: float, factors: tuple[float, ...], unit: str) -> Iterator[str]:
    """The shortest number that, times the factors in their order, is exactly ``value``; if any."""
    for text in _rounded(value / math.prod(factors)):
        if math.prod(factors, start=float(text)) == value:
            yield f"{text}{unit}"
            return


def shortest(value: float) -> str:
    """The shortest text that is read as this number.

    >>> shortest(20.0), shortest(0.1), shortest(1.0 / 3.0), shortest(-1e-9)
    ('20', '0.1', '0.3333333333333333', '-1e-09')
    """
    return next(text for text in _rounded(value) if float(text) == value)


def _rounded(value: float) -> Iterator[str]:
    """A number in more and more digits; whole ones without an exponent."""
    for digits in range(1, 18):
        text = f"{value:.{digits}g}"
        near = float(text)
        yield f"{near:.0f}" if near.is_integer() and abs(near) < 1e6 else text
