"""An SVG file as a tree of elements, read without trusting it. [docs/formats.md, SVG]"""

from __future__ import annotations

from typing import Any, Final
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from icage.errors import FormatError

MAX_DEPTH: Final = 100
MAX_ELEMENTS: Final = 20_000
"""Elements of the file; also those that are drawn, counting what ``use`` repeats."""

_SVG: Final = "{http://www.w3.org/2000/svg}"
_XLINK_HREF: Final = "{http://www.w3.org/1999/xlink}href"
_GZIP: Final = b"\x1f\x8b"
_SHOWN: Final = 60


def parse(content: bytes) -> Element:
    """The root element.

    Raises
    ------
    FormatError:
        Not XML, not SVG, compressed, with entities or an external style sheet, too deep, too many.
    """
    if content.startswith(_GZIP):
        raise FormatError("the drawing is compressed (svgz); unpack it with gunzip first")
    root = _tree(content)
    if local_name(root) != "svg":
        raise FormatError(f"the root element is <{local_name(root) or root.tag}>, not <svg>")
    return root


def _tree(content: bytes) -> Element:
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

    def instruction(target: str, _: str) -> None:
        if target == "xml-stylesheet":
            raise FormatError("an external style sheet (xml-stylesheet) is not supported")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse
    parser.SkippedEntityHandler = refuse
    parser.ProcessingInstructionHandler = instruction
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


def local_name(element: Element) -> str:
    """Name of an SVG element, empty for one of another namespace.

    >>> local_name(Element("{http://www.w3.org/2000/svg}path")), local_name(Element("{other}path"))
    ('path', '')
    """
    tag = element.tag
    if tag.startswith(_SVG):
        return tag[len(_SVG) :]
    return "" if tag.startswith("{") else tag


def reference(element: Element) -> str | None:
    """What ``href``, or else ``xlink:href``, says."""
    href = element.get("href")
    return (href if href is not None else element.get(_XLINK_HREF) or "").strip() or None


def quoted(text: str) -> str:
    """A text of the file for a message: in quotes, one line, not too long."""
    return repr(text if len(text) <= _SHOWN else text[:_SHOWN] + "...")


def refused(
    element: Element, name: str, value: str, why: str = "is not understood", kind: str = ""
) -> FormatError:
    """The error that says which attribute or property of which element cannot be used.

    >>> str(refused(Element("rect"), "rx", "1 ell"))
    "<rect> has rx='1 ell', which is not understood"
    """
    a_kind = f"a {kind}" if kind else ""
    return FormatError(f"<{local_name(element)}> has {a_kind}{name}={quoted(value)}, which {why}")
