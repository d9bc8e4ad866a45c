"""Tables of trials as the type checker sees them: pyarrow tells it nothing of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from icage.arrays import AnyArray


class Column(Protocol):
    """A column of a table, or an array that becomes one: what is used of them here."""

    def to_pylist(self) -> list[Any]:
        """Its values, None where there is none."""
        ...

    def to_numpy(self, zero_copy_only: bool = ...) -> AnyArray:
        """Its values (n,), NaN where there is none."""
        ...


class Schema(Protocol):
    """Names of the columns, and what the file says of itself."""

    @property
    def metadata(self) -> Mapping[bytes, bytes] | None:
        """Words kept with the table."""
        ...

    def equals(self, other: Any) -> bool:
        """Whether names and types are the same."""
        ...

    def get_field_index(self, name: str) -> int:
        """The place of a column, -1 if there is none."""
        ...


class Table(Protocol):
    """A ``pyarrow.Table``: what is used of it here."""

    @property
    def num_rows(self) -> int:
        """Rows in it."""
        ...

    @property
    def column_names(self) -> list[str]:
        """In their order."""
        ...

    @property
    def schema(self) -> Schema:
        """Its description."""
        ...

    def __getitem__(self, key: str) -> Column: ...

    def slice(self, offset: int = ..., length: int | None = ...) -> Table:
        """Some rows, not copied."""
        ...

    def to_pylist(self) -> list[dict[str, Any]]:
        """A dictionary per row."""
        ...

    def replace_schema_metadata(self, metadata: Mapping[Any, Any] | None = ...) -> Table:
        """The same rows with other words kept with them."""
        ...

    def set_column(self, i: int, field_: str, column: Column) -> Table:
        """The table with another column in place ``i``."""
        ...

    def unify_dictionaries(self) -> Table:
        """The table whose pieces share the words of each column."""
        ...
