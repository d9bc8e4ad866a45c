"""Which layers of a DXF drawing count."""

from __future__ import annotations

from typing import Any, Final

from icage.errors import FormatError

_SHOWN: Final = 20
"""Names told at most."""

DEFPOINTS: Final = "defpoints"
"""The layer of dimension points, which CAD programs never plot."""


class Layers:
    """The layers that are read: those asked for, else all that are neither off nor frozen.

    Raises
    ------
    FormatError:
        A layer that is asked for is not there, or is frozen or off.
    """

    def __init__(self, document: Any, asked: tuple[str, ...] | None) -> None:
        table = {str(layer.dxf.name).lower(): layer for layer in document.layers}
        self._frozen = {name for name, layer in table.items() if layer.is_frozen()}
        self._off = {name for name, layer in table.items() if layer.is_off()}
        self._asked = None if asked is None else {name.lower() for name in asked}
        self.passed: set[str] = set()
        """Layers that hold entities and are not read."""
        known = {str(layer.dxf.name): None for layer in document.layers}
        for name in _used(document):
            if name.lower() not in table:
                known[name] = None
        for name in asked or ():
            if name.lower() not in {one.lower() for one in known}:
                shown = ", ".join(repr(one) for one in list(known)[:_SHOWN])
                more = ", ..." if len(known) > _SHOWN else ""
                raise FormatError(f"there is no layer {name!r}; the drawing has {shown}{more}")
            if name.lower() in self._frozen | self._off:
                state = "frozen" if name.lower() in self._frozen else "off"
                raise FormatError(f"the layer {name!r} is {state}: switch it on in the drawing")

    def frozen(self, name: str) -> bool:
        """Whether a layer hides even what is inserted on it."""
        return name.lower() in self._frozen

    def counts(self, name: str) -> bool:
        """Whether what is on a layer is read."""
        key = name.lower()
        if self._asked is not None:
            counts = key in self._asked
        else:
            counts = key not in self._frozen and key not in self._off and key != DEFPOINTS
        if not counts:
            self.passed.add(name)
        return counts


def layer_of(entity: Any) -> str:
    """The layer that an entity names; "0" if it names none."""
    return str(property_of(entity, "layer", 8, "0"))


def property_of(entity: Any, name: str, code: int, default: Any) -> Any:
    """A property that every entity may have, of kinds that ezdxf keeps as bare tags, too."""
    if entity.dxf.is_supported(name):
        return entity.dxf.get(name, default)
    for tags in getattr(getattr(entity, "xtags", None), "subclasses", ()):
        for tag in tags:
            if tag.code == code:
                return tag.value
    return default


def _used(document: Any) -> list[str]:
    """Layers that entities name; a file may use them without a table of layers."""
    spaces = [document.modelspace(), *document.blocks]
    return list(dict.fromkeys(layer_of(entity) for space in spaces for entity in space))
