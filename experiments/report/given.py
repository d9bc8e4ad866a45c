"""A document of ours, taken apart as anybody's: every value is looked at before it is believed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from experiments.io.own_files import DamagedError
from icage.formats.json_text import describe

Kind = TypeVar("Kind")


@dataclass(frozen=True, slots=True)
class Given:
    """A JSON object and where it is from; each method takes one value out, or says what is wrong.

    >>> one = Given({"trials": 4, "unit": "mm", "worst": None}, "run 1")
    >>> one.count("trials"), one.text("unit"), one.maybe_number("worst")
    (4, 'mm', None)
    >>> one.count("unit")
    Traceback (most recent call last):
    ...
    experiments.io.own_files.DamagedError: run 1: unit is "mm"; a count is needed
    """

    values: Mapping[str, Any]
    where: str

    def has(self, key: str) -> bool:
        """Whether there is such a key with anything but null."""
        return self.values.get(key) is not None

    def text(self, key: str) -> str:
        """A string."""
        return self._of(key, str, "a string")

    def maybe_text(self, key: str) -> str | None:
        """A string, or None where there is none."""
        return self.text(key) if self.has(key) else None

    def flag(self, key: str) -> bool:
        """True or false."""
        return self._of(key, bool, "true or false")

    def number(self, key: str) -> float:
        """A finite number."""
        value = self.values.get(key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._wrong(key, "a number")
        try:
            number = float(value)
        except OverflowError as error:
            raise self._wrong(key, "a finite number") from error
        if not math.isfinite(number):
            raise self._wrong(key, "a finite number")
        return number

    def positive(self, key: str) -> float:
        """A finite number above zero: something is divided by it."""
        if not self.number(key) > 0.0:
            raise self._wrong(key, "a number above 0")
        return self.number(key)

    def maybe_number(self, key: str) -> float | None:
        """A finite number, or None where there is none."""
        return self.number(key) if self.has(key) else None

    def count(self, key: str) -> int:
        """A whole number, 0 or more."""
        value = self.values.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**63:
            raise self._wrong(key, "a count")
        return value

    def part(self, key: str) -> Given:
        """An object."""
        return Given(self._of(key, dict, "an object"), f"{self.where}, {key}")

    def maybe_part(self, key: str) -> Given | None:
        """An object, or None where there is none."""
        return self.part(key) if self.has(key) else None

    def parts(self, key: str) -> list[Given]:
        """A list of objects."""
        found: list[Given] = []
        for k, value in enumerate(self._list(key), 1):
            if not isinstance(value, dict):
                raise self._wrong(key, "a list of objects")
            found.append(Given(cast(dict[str, Any], value), f"{self.where}, {key} {k}"))
        return found

    def texts(self, key: str) -> list[str]:
        """A list of strings."""
        found = self._list(key)
        if not all(isinstance(value, str) for value in found):
            raise self._wrong(key, "a list of strings")
        return cast(list[str], found)

    def numbers(self, key: str, count: int) -> list[float]:
        """So many finite numbers."""
        found = self._list(key)
        if len(found) != count:
            raise self._wrong(key, f"a list of {count} numbers")
        inside = Given(dict(enumerate(found)), f"{self.where}, {key}")  # pyright: ignore
        return [inside.number(k) for k in range(count)]  # pyright: ignore[reportArgumentType]

    def counts(self, keys: tuple[str, ...], total: str) -> dict[str, int]:
        """Counts that add up to another."""
        found = {key: self.count(key) for key in keys}
        if sum(found.values()) != self.count(total):
            raise DamagedError(f"{self.where}: the counts do not add up to {total}")
        return found

    def share(self, key: str, total: str) -> tuple[int, int]:
        """A count and the one that it is a part of."""
        found, whole = self.count(key), self.count(total)
        if found > whole:
            raise DamagedError(f"{self.where}: {key} is {found}, of {whole} {total}")
        return found, whole

    def _list(self, key: str) -> list[Any]:
        return self._of(key, list, "a list")

    def _of(self, key: str, kind: type[Kind], words: str) -> Kind:
        value = self.values.get(key)
        if not isinstance(value, kind):
            raise self._wrong(key, words)
        return value

    def _wrong(self, key: str, wanted: str) -> DamagedError:
        if key not in self.values:
            return DamagedError(f"{self.where} has no {key}; {wanted} is needed")
        return DamagedError(
            f"{self.where}: {key} is {describe(self.values[key])}; {wanted} is needed"
        )
