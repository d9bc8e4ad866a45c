"""A small drawing for one feature, and the words that many of them share.

Each is drawn on a page of 100 by 100 and has the area that a browser paints, worked out by hand,
or the words with which it is refused. ``rsvg``: whether librsvg draws it as a browser does.
"""

from __future__ import annotations

from dataclasses import dataclass

from icage.formats.drawings.reading import Strokes

PAGE = 'width="100" height="100" viewBox="0 0 100 100"'
BIG = '<rect width="100" height="100" fill="{}"/>'
COVER = BIG.format("red")


@dataclass(frozen=True)
class Feature:
    name: str
    body: str
    area: float = 0.0
    box: tuple[float, float, float, float] | None = None
    root: str = PAGE
    rsvg: bool = True
    refused: str = ""
    strokes: Strokes = "ignore"

    @property
    def text(self) -> str:
        return (
            '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
            'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
            f"{self.root}>{self.body}</svg>"
        )


R = '<rect x="10" y="20" width="40" height="30"/>'
"""Area 1200, box 10, 20, 50, 50."""
R_BOX = (10, 20, 50, 50)


def same(name: str, body: str, **more: bool | str) -> Feature:
    """Something that leaves ``R`` as it is."""
    return Feature(name, body, 1200, R_BOX, **more)  # type: ignore[arg-type]


def refused(
    name: str, body: str, words: str, root: str = PAGE, strokes: Strokes = "ignore"
) -> Feature:
    return Feature(name, body, refused=words, root=root, strokes=strokes)


def drawn(name: str, body: str, area: float, **further: bool) -> Feature:
    """A feature of strokes, whose drawn width counts."""
    return Feature(name, body, area, strokes="drawn", **further)  # type: ignore[arg-type]


def styled(css: str, body: str) -> str:
    return f"<style>{css}</style>{body}"


def more(element: str, attributes: str) -> str:
    """An empty element with further attributes."""
    return element.replace("/>", f" {attributes}/>")
