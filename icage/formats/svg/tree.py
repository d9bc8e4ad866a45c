"""The part of an SVG file that can be drawn, read without trusting it.

Before svgelements sees a drawing it is parsed here with entities refused, the nesting and the
number of elements bounded (``use`` counted as often as it is drawn), and everything that paints
no fill taken out.
"""

from __future__ import annotations

import re
from typing import Any, Final
from xml.etree.ElementTree import Element, TreeBuilder, tostring
from xml.parsers import expat

from icage.errors import FormatError

MAX_BYTES: Final = 10_000_000
"""Largest drawing read; the largest tool drawings met have some hundred kilobytes."""

MAX_DEPTH: Final = 100
MAX_ELEMENTS: Final = 20_000
"""Elements drawn, counting what ``use`` repeats."""

_SVG: Final = "http://www.w3.org/2000/svg"
_XLINK_HREF: Final = "{http://www.w3.org/1999/xlink}href"
_SHAPES: Final = {"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"}
_DRAWN: Final = _SHAPES | {"svg", "g", "a", "switch", "defs", "use", "symbol", "style"}
_LENGTH: Final = re.compile(r"[\d.eE+-]+\s*(mm|cm|in|pt|pc|q)", re.IGNORECASE)
_CUTTING: Final = ("clip-path", "mask")


def drawable(content: bytes) -> tuple[bytes, str | None]:
    """The SVG document reduced to shapes, groups and what positions them.

    Also the unit in which it says how large it is (of its width, else of its height: mm, cm, in,
    pt, pc, q), None if it says so in pixels or not at all.

    Raises
    ------
    FormatError:
        Not XML, not SVG, entities, too deep or too many, clipped or masked shapes, external links.
    """
    root = _parse(content)
    if _local(root.tag) != "svg":
        raise FormatError(f"the root element is <{_local(root.tag) or root.tag}>, not <svg>")
    _reduce(root)
    _bound_uses(root)
    sizes = (root.get("width", ""), root.get("height", ""))
    stated = (_LENGTH.fullmatch(size.strip()) for size in sizes)
    return tostring(root), next((size[1].lower() for size in stated if size), None)


def _parse(content: bytes) -> Element:
    builder = TreeBuilder()
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    depth = count = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > MAX_DEPTH or count > MAX_ELEMENTS:
            raise FormatError(
                f"more than {MAX_DEPTH} nested or {MAX_ELEMENTS} elements "
                f"(line {parser.CurrentLineNumber})"
            )
        builder.start(_clark(tag), {_clark(key): value for key, value in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_clark(tag))

    def refuse(*_: Any) -> None:
        raise FormatError(
            f"XML entities are not allowed (line {parser.CurrentLineNumber}); "
            "save the drawing as plain SVG"
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse
    parser.SkippedEntityHandler = refuse
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise FormatError(
            f"not an SVG file: {expat.ErrorString(error.code)}, "
            f"line {error.lineno} column {error.offset + 1}"
        ) from error
    except (ValueError, LookupError) as error:
        raise FormatError(f"not an SVG file: {error}") from error
    return builder.close()


def _clark(name: str) -> str:
    return "{" + name if "}" in name else name


def _local(tag: str) -> str:
    """Name of an SVG element, empty for one of another namespace."""
    space, _, name = tag.rpartition("}")
    return name if space in ("", "{" + _SVG) else ""


def _reduce(element: Element) -> None:
    """Take out what draws nothing; refuse what would cut a shape."""
    for key in _CUTTING:
        styled = re.search(rf"(?:^|;)\s*{key}\s*:\s*([^;]*)", element.get("style", ""))
        value = styled[1] if styled else element.get(key, "none")
        if value.strip() not in ("", "none"):
            raise FormatError(
                f"<{_local(element.tag)}> has a {key}, which is not supported; "
                "cut the path in the drawing program"
            )
    for child in list(element):
        name = _local(child.tag)
        if name not in _DRAWN:
            element.remove(child)
            continue
        if name == "symbol":
            if child.get("viewBox"):
                raise FormatError("<symbol> with a viewBox is not supported; use <g> in <defs>")
            holder = Element(f"{{{_SVG}}}defs")
            element.insert(list(element).index(child), holder)
            element.remove(child)
            child.tag = f"{{{_SVG}}}g"
            holder.append(child)
        _reduce(child)


def _bound_uses(root: Element) -> None:
    """Refuse ``use`` that is circular, external, or repeats more than ``MAX_ELEMENTS``."""
    by_id = {element.get("id"): element for element in root.iter() if element.get("id")}
    counted: dict[int, int] = {}
    open_: set[int] = set()

    def drawn(element: Element) -> int:
        key = id(element)
        if key in counted:
            return counted[key]
        if key in open_ or len(open_) > 4 * MAX_DEPTH:
            raise FormatError("<use> refers to itself or is nested too deeply")
        open_.add(key)
        total = 1 + sum(drawn(child) for child in element)
        if _local(element.tag) == "use":
            total += _used(element)
        open_.discard(key)
        if total > MAX_ELEMENTS:
            raise FormatError(f"<use> repeats more than {MAX_ELEMENTS} elements")
        counted[key] = total
        return total

    def _used(element: Element) -> int:
        href = element.get("href") or element.get(_XLINK_HREF) or ""
        if not href.startswith("#"):
            raise FormatError(f"<use> refers to {href!r:.60}; only this file's own #id is allowed")
        if href[1:] not in by_id:
            raise FormatError(f"<use> refers to {href!r:.60}, which the file does not have")
        return drawn(by_id[href[1:]])

    drawn(root)
