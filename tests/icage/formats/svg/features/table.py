"""Small drawings, one for each feature of structure, shapes, paint and style.

Each is drawn on a page of 100 by 100 and has the area that a browser paints, worked out by hand,
or the words with which it is refused. ``rsvg``: whether librsvg draws it as a browser does.
"""

# ruff: noqa: E501 - a row a feature

from __future__ import annotations

import math
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


VISIBLE, INLINE = 'visibility="visible"', 'display="inline"'
CLIP = '<clipPath id="c"{}>{}</clipPath>'
HALF = '<rect width="30" height="100"/>'
PI = math.pi

SHAPES = [
    same("rect", R),
    Feature("rect rounded", '<rect x="10" y="10" width="60" height="40" rx="10" ry="5"/>',
            2400 - (4 - PI) * 50, (10, 10, 70, 50)),
    Feature("rect rx only", '<rect x="10" y="10" width="60" height="40" rx="10"/>',
            2400 - (4 - PI) * 100, (10, 10, 70, 50)),
    Feature("rect ry only", '<rect x="10" y="10" width="60" height="40" ry="10"/>',
            2400 - (4 - PI) * 100, (10, 10, 70, 50)),
    Feature("rect radii too large", '<rect x="10" y="10" width="60" height="40" rx="90" ry="90"/>',
            PI * 30 * 20, (10, 10, 70, 50)),
    Feature("rect radius of zero", '<rect x="10" y="10" width="60" height="40" rx="0" ry="9"/>',
            2400, (10, 10, 70, 50)),
    Feature("rect in percent", '<rect x="10%" y="5%" width="50%" height="25%" rx="5%"/>',
            1250 - (4 - PI) * 25, (10, 5, 60, 30)),
    same("rect without width", R + '<rect y="60" height="30"/>'),
    refused("rect negative width", R + '<rect width="-4" height="9"/>', "width='-4'"),
    Feature("circle", '<circle cx="50" cy="40" r="30"/>', PI * 900, (20, 10, 80, 70)),
    Feature("circle in percent", '<circle cx="50%" cy="50%" r="20%"/>', PI * 400),
    same("circle without r", R + '<circle cx="80" cy="80"/>'),
    Feature("ellipse", '<ellipse cx="50" cy="40" rx="30" ry="10"/>', PI * 300, (20, 30, 80, 50)),
    Feature("ellipse rx only", '<ellipse cx="50" cy="40" rx="30"/>', PI * 900),
    Feature("polygon", '<polygon points="10,10 90,10 90,90"/>', 3200, (10, 10, 90, 90)),
    Feature("polyline is filled", '<polyline points="10 10 90 10, 90,90"/>', 3200),
    refused("polygon odd", '<polygon points="10,10 90,10 90"/>', "malformed points"),
    same("line fills nothing", R + '<line x1="0" y1="60" x2="90" y2="99"/>'),
    Feature("path lines", '<path d="M10 10H90V60H10Z"/>', 4000, (10, 10, 90, 60)),
    Feature("path relative", '<path d="m10 10h80v50h-80z m10 60 h20 v10 h-20"/>', 4200),
    Feature("path implied lines", '<path d="M10 10 90 10 90 60 10 60m0 10 20 0 0 20-20 0"/>', 4400),
    Feature("path compact numbers", '<path d="M10.4.4L90.4.4l0,3e1-80 0"/>', 2400),
    Feature("path after z", '<path d="M10 10h20v20h-20z l40 30 v-30 z"/>', 400 + 600 - 2 * 150),
    Feature("path cubic", '<path d="M10 10C10 60 90 60 90 10"/>', 2400, (10, 10, 90, 47.5)),
    Feature("path smooth cubic", '<path d="M10 50C10 20 50 20 50 50S90 80 90 50"/>', 2 * 0.6 * 40 * 30),
    Feature("path smooth without one", '<path d="M10 10S90 60 90 10"/>', 0.3 * 80 * 50),
    Feature("path quadratic", '<path d="M10 10Q50 90 90 10"/>', 2 / 3 * 80 * 40),
    Feature("path smooth quadratic", '<path d="M10 50Q30 10 50 50T90 50"/>', 2 * 2 / 3 * 40 * 20),
    Feature("path T after C", '<path d="M10 50 C10 10 50 10 50 50 T90 50 V90 H10Z"/>',
            80 * 40 + 0.6 * 40 * 40),
    Feature("path arc", '<path d="M20 50A30 30 0 0 1 80 50z"/>', PI * 450, (20, 20, 80, 50)),
    Feature("path arc large", '<path d="M50 20A30 30 0 1 0 80 50z"/>',
            PI * 900 * 0.75 + 450, (20, 20, 80, 80)),
    Feature("path arc flags together", '<path d="M20 50a30 30 0 0160 0z"/>', PI * 450),
    Feature("path arc rotated", '<path d="M30 50A40 20 90 0 1 70 50z"/>', PI * 400),
    Feature("path arc too small", '<path d="M20 50A1 1 0 0 1 80 50z"/>', PI * 450),
    Feature("path arc without radius", '<path d="M20 20A0 9 0 0 1 80 20V80z"/>', 1800),
    refused("path error", '<path d="M10 10 L90 10 90 90 Lx"/>', "malformed d=.*at character 22"),
    refused("path without move", '<path d="L90 10 90 90"/>', "malformed d=.*at character 1"),
    refused("path number missing", '<path d="M10 10 h9 v"/>', "malformed d=.*at its end"),
    refused("path flag", '<path d="M20 50A1 1 0 2 1 80 50z"/>', "malformed d="),
    same("path none", R + '<path d="none"/><path/>'),
    Feature("d of css", styled("path{d:path('M10 10H90V60H10Z')}", '<path d="M0 0h1v1z"/>'), 4000,
            rsvg=False),
]  # fmt: skip

STRUCTURE = [
    same("group", f"<g><g>{R}</g></g>"),
    same("a", f'<a xlink:href="http://x.invalid/">{R}</a>'),
    same("defs", R + f"<defs>{COVER}</defs>"),
    same("symbol alone", R + f'<symbol id="s">{COVER}</symbol>'),
    same("unknown name space", R + f'<o:g xmlns:o="urn:o">{COVER}</o:g>'),
    refused("unknown element", R + f"<shape>{COVER}</shape>", "<shape> is not supported"),
    same("title and metadata", f"<title>x</title><desc>{COVER}</desc><metadata>{COVER}</metadata>{R}"),
    same("use", '<defs><rect id="r" width="40" height="30"/></defs><use href="#r" x="10" y="20"/>'),
    same("use xlink", '<defs><rect id="r" width="40" height="30"/></defs>'
         '<use xlink:href="#r" x="10" y="20"/>'),
    Feature("use transformed", '<defs><rect id="r" width="20" height="10"/></defs>'
            '<use href="#r" x="5" y="10" transform="scale(2)"/>', 800, (10, 20, 50, 40)),
    Feature("use of a use", '<defs><rect id="r" width="20" height="10"/><use id="u" href="#r" x="9"/>'
            '</defs><use href="#u" y="50"/>', 200, (9, 50, 29, 60)),
    Feature("use of a group", f'<g id="g">{R}</g><use href="#g" x="40" y="40"/>', 2400),
    Feature("use gives its paint", '<defs><rect id="r" width="40" height="30"/></defs>'
            '<use href="#r"/><use href="#r" fill="none" y="50"/>', 1200, (0, 0, 40, 30)),
    same("use of what is hidden", '<rect id="r" display="none" width="99" height="99"/>'
         f'<use href="#r"/>{R}'),
    refused("use of nothing", R + '<use href="#none"/>', "'#none', which the file does not have"),
    refused("use of a file", R + '<use href="a.svg#b"/>', "only this file's own"),
    refused("use of itself", '<g id="g"><use href="#g"/></g>', "refers to itself"),
    Feature("symbol with view box", '<symbol id="s" viewBox="0 0 10 10"><rect width="10" height="5"/>'
            '</symbol><use href="#s" x="10" y="20" width="60" height="60"/>', 1800, (10, 20, 70, 50)),
    Feature("symbol of full size", '<symbol id="s" viewBox="0 0 10 10"><rect width="10" height="5"/>'
            '</symbol><use href="#s"/>', 5000, (0, 0, 100, 50)),
    Feature("symbol cuts", '<symbol id="s"><rect width="80" height="80"/></symbol>'
            '<use href="#s" width="30" height="50"/>', 1500, (0, 0, 30, 50), rsvg=False),
    Feature("symbol overflow", '<symbol id="s" style="overflow:visible"><rect width="80" height="80"/>'
            '</symbol><use href="#s" width="30" height="50"/>', 6400),
    Feature("use of an svg", '<defs><svg id="s" x="5" y="5" width="20" height="20" viewBox="0 0 10 10"><rect width="10" height="5"/></svg></defs><use href="#s" x="10" y="10" width="60" height="60"/>', 1800, (15, 15, 75, 45), rsvg=False),
    refused("symbol of a size", '<symbol id="s" width="9" viewBox="0 0 9 9"><rect width="9" '
            'height="9"/></symbol><use href="#s"/>', "not supported on a symbol"),
    Feature("nested svg", '<svg x="10" y="20" width="50" height="50"><rect width="90" height="20"/>'
            "</svg>", 1000, (10, 20, 60, 40)),
    Feature("nested svg overflow", '<svg x="10" y="20" width="50" height="50" overflow="visible">'
            '<rect width="90" height="20"/></svg>', 1800, (10, 20, 100, 40)),
    Feature("nested svg view box", '<svg x="10" y="20" width="50" height="80" viewBox="0 0 10 10">'
            '<rect width="10" height="10"/></svg>', 2500, (10, 35, 60, 85)),
    Feature("nested svg percent", '<svg x="10%" width="50%" height="50%"><rect width="50%" '
            'height="100%"/></svg>', 1250, (10, 0, 35, 50)),
    Feature("nested svg without size", '<svg x="20"><rect width="100%" height="10"/></svg>', 1000,
            (20, 0, 120, 10)),
    Feature("aspect none", '<svg width="80" height="40" viewBox="0 0 10 10" '
            'preserveAspectRatio="none"><rect width="5" height="10"/></svg>', 1600, (0, 0, 40, 40)),
    Feature("aspect xMaxYMin meet", '<svg width="80" height="40" viewBox="0 0 10 10" '
            'preserveAspectRatio="xMaxYMin meet"><rect width="5" height="10"/></svg>', 800,
            (40, 0, 60, 40)),
    Feature("aspect slice", '<svg width="80" height="40" viewBox="0 0 10 10" '
            'preserveAspectRatio="xMinYMin slice"><rect width="5" height="10"/></svg>', 1600,
            (0, 0, 40, 40)),
    refused("aspect unknown", '<svg viewBox="0 0 9 9" preserveAspectRatio="middle">'
            f"{R}</svg>", "preserveAspectRatio='middle'"),
    refused("view box of three", '<svg viewBox="0 0 9">' + R + "</svg>", "viewBox='0 0 9'"),
    same("switch", f'<switch><g requiredExtensions="urn:x">{COVER}</g>{R}{COVER}</switch>'),
    same("switch language", f'<switch><g systemLanguage="fr,de">{COVER}</g><g systemLanguage="pl, en">'
         f"{R}</g>{COVER}</switch>"),
    same("switch language of a country", f'<switch><g systemLanguage="en-GB">{R}</g>{COVER}</switch>',
         rsvg=False),
    same("condition outside a switch", f'{R}<g requiredExtensions="urn:x">{COVER}</g>',
         rsvg=False),
    same("text is left out", R + '<text x="60" y="90" fill="none">caption</text>'),
    same("image is left out", R + '<image width="9" height="9" href="a.png"/>'),
    refused("animation", '<rect width="9" height="9"><animate attributeName="width" to="99" dur="1s"/>'
            "</rect>", "<animate> animates <rect>"),
    refused("animated group", '<g><animateTransform attributeName="transform" to="9"/>' + R + "</g>",
            "<animateTransform>"),
    Feature("root without a size", R, 1200, R_BOX, root='viewBox="0 0 100 100"'),
    Feature("root of one side", R, 1200, R_BOX, root='width="100" viewBox="0 0 100 100"'),
    Feature("root aspect", '<rect width="10" height="10"/>', 2500, (25, 0, 75, 50),
            root='width="100" height="50" viewBox="0 0 10 10"'),
    Feature("root aspect none", '<rect width="10" height="10"/>', 5000, (0, 0, 100, 50),
            root='width="100" height="50" viewBox="0 0 10 10" preserveAspectRatio="none"'),
    refused("root of no size", R, "width='0'", root='width="0" height="9"'),
    refused("root size unknown", R, "width='4 furlong'", root='width="4 furlong" height="9"'),
]  # fmt: skip

TRANSFORMS = [
    Feature("translate", f'<g transform="translate(20 -10)">{R}</g>', 1200, (30, 10, 70, 40)),
    Feature("translate one", f'<g transform="translate(20)">{R}</g>', 1200, (30, 20, 70, 50)),
    Feature("scale", '<rect width="40" height="20" transform="scale(2,.5)"/>', 800, (0, 0, 80, 10)),
    Feature("rotate", '<g transform="rotate(90)"><rect y="-40" width="20" height="30"/></g>', 600,
            (10, 0, 40, 20)),
    Feature("rotate about", f'<g transform="rotate(90,50,50)">{R}</g>', 1200, (50, 10, 80, 50)),
    Feature("skewX", '<rect width="40" height="40" transform="skewX(40)"/>', 1600,
            (0, 0, 40 + 40 * math.tan(math.radians(40)), 40)),
    Feature("skewY", '<rect width="40" height="40" transform="skewY(40)"/>', 1600,
            (0, 0, 40, 40 + 40 * math.tan(math.radians(40)))),
    Feature("matrix", '<rect width="10" height="10" transform="matrix(2 1 -1 2 30 10)"/>', 500,
            (20, 10, 50, 40)),
    Feature("transform list", '<rect width="10" height="10" transform="translate(10,10),scale(2) '
            'rotate(90)translate(0-10)"/>', 400, (10, 10, 30, 30)),
    Feature("transform of css", styled("g{transform:translate(20px,10px) rotate(90deg)}",
            '<g><rect y="-40" width="20" height="30"/></g>'), 600, (30, 10, 60, 30)),
    Feature("css over attribute", '<rect width="9" height="9" transform="scale(9)" '
            'style="transform:translateX(50px)"/>', 81, (50, 0, 59, 9), rsvg=False),
    Feature("transform origin", '<g transform="rotate(90)" transform-origin="50 50">'
            f"{R}</g>", 1200, (50, 10, 80, 50), rsvg=False),
    Feature("transform origin in words", '<g style="transform:scale(.5);transform-origin:right top">'
            '<rect width="100" height="100"/></g>', 2500, (50, 0, 100, 50), rsvg=False),
    refused("transform origin without unit", '<rect width="9" height="9" style="transform:scale(.5);transform-origin:9 9"/>', "transform-origin='9', which has no unit"),
    refused("css angle without unit", '<rect width="9" height="9" style="transform:rotate(45)"/>',
            "malformed transform"),
    refused("transform of space", '<rect width="9" height="9" style="transform:rotateX(4deg)"/>',
            "malformed transform"),
    refused("transform unknown", '<rect width="9" height="9" transform="turn(45)"/>',
            "malformed transform='turn"),
    refused("transform box", '<rect width="9" height="9" style="transform:rotate(9deg);'
            'transform-box:fill-box"/>', "transform-box='fill-box'"),
    refused("single transforms", '<rect width="9" height="9" style="rotate:9deg"/>', "rotate='9deg'"),
    same("scale of zero", R + '<rect width="100" height="100" transform="scale(0)"/>'),
    Feature("transform on a clip path", CLIP.format(' transform="translate(20)"', HALF)
            + '<rect width="100" height="40" clip-path="url(#c)"/>', 1200, (20, 0, 50, 40)),
]  # fmt: skip

PAINT = [
    same("fill none", BIG.format("none") + R),
    same("fill transparent", BIG.format("transparent") + R),
    same("fill hex of no alpha", BIG.format("#f000") + BIG.format("#ff000000") + R),
    same("fill rgba", BIG.format("rgba(1,2,3,0)") + BIG.format("hsla(0,0%,0%,0%)") + R),
    Feature("fill rgb with a slash", BIG.format("rgb(0 0 0 / 50%)"), 10000),
    refused("fill unknown", BIG.format("reddish"), "fill='reddish'"),
    refused("fill mixed", BIG.format("color-mix(in srgb, red, blue)"), "fill='color-mix"),
    same("fill inherited", f'<g fill="none">{BIG.format("inherit")}</g>{R}'),
    same("fill of a group", f'<g fill="none"><rect width="100" height="100"/></g>{R}'),
    Feature("fill initial", '<g fill="none"><rect width="50" height="20" style="fill:initial"/></g>',
            1000, rsvg=False),
    same("current colour", f'<g color="rgba(0,0,0,0)">{BIG.format("currentColor")}</g>{R}'),
    Feature("current colour is seen", BIG.format("currentcolor"), 10000),
    same("opacity of zero", f'<g opacity="0">{COVER}</g>{R}'),
    same("opacity in percent", f'<g style="opacity:0%">{COVER}</g>{R}'),
    same("fill opacity", f'<g fill-opacity="0">{COVER}</g>{R}'),
    Feature("half seen", '<rect width="50" height="20" opacity=".6" fill-opacity="90%"/>', 1000),
    same("hidden", f'<g visibility="hidden">{COVER}</g>{R}'),
    same("visible in hidden", f'<g visibility="hidden">{more(R, VISIBLE)}'
         "</g>"),
    same("display none", f'<g display="none">{more(R, INLINE)}</g>{R}'),
    Feature("fill rule nonzero", '<path d="M10 10h60v60h-60z M20 20h40v40h-40z"/>', 3600),
    Feature("fill rule evenodd", '<path fill-rule="evenodd" d="M10 10h60v60h-60z M20 20h40v40h-40z"/>',
            2000),
    Feature("fill rule inherited", '<g style="fill-rule:evenodd"><path d="M10 10h60v60h-60z M20 20h40v'
            '40h-40z"/></g>', 2000),
    Feature("hole by direction", '<path d="M10 10h60v60h-60z M20 20v40h40v-40z"/>', 2000),
    Feature("gradient", '<linearGradient id="g"><stop stop-color="red"/></linearGradient>'
            '<rect width="50" height="20" fill="url(#g)"/>', 1000),
    same("gradient without stops", f'<linearGradient id="g"/>{BIG.format("url(#g)")}{R}'),
    same("gradient of no alpha", '<radialGradient id="g"><stop stop-opacity="0"/><stop offset="1" '
         f'style="stop-color:transparent"/></radialGradient>{BIG.format("url(#g)")}{R}'),
    Feature("gradient by template", '<linearGradient id="a"><stop/></linearGradient><linearGradient '
            'id="g" xlink:href="#a"/><rect width="50" height="20" fill="url(#g)"/>', 1000),
    Feature("pattern", '<pattern id="p" width="5" height="5" patternUnits="userSpaceOnUse"><rect '
            'width="5" height="5"/></pattern><rect width="50" height="20" fill="url(#p)"/>', 1000),
    same("missing paint", BIG.format("url(#none)") + R),
    Feature("missing paint with another", '<rect width="50" height="20" fill="url(#none) red"/>', 1000),
    refused("paint of a file", BIG.format("url(a.svg#g)"), "fill='a.svg#g'"),
    refused("paint of a mesh", f'<meshgradient id="g"/>{BIG.format("url(#g)")}', "<meshgradient>"),
    refused("context fill", BIG.format("context-fill"), "fill='context-fill'"),
    refused("mask", f'<mask id="m"/><g mask="url(#m)">{R}</g>', "mask="),
    refused("filter", f'<filter id="f"/><g filter="url(#f)">{R}</g>', "filter="),
    same("mask on what is hidden", f'<g display="none" mask="url(#m)">{R}</g>{R}'),
    refused("marker", '<marker id="m"><path d="M0 0h9v9"/></marker><path d="M0 0h9v9z" '
            'marker-start="url(#m)"/>', "marker-start="),
    same("stroke alone", R + '<path d="M0 60h90v30z" fill="none" stroke="red"/>', rsvg=False),
]  # fmt: skip

STYLE = [
    same("class", styled(".a{fill:none}", more(COVER, 'class="b a"') + R)),
    same("class is not an attribute's match", styled(".A{fill:none}", more(R, 'class="a"'))),
    same("id", styled("#a{fill:none}", more(COVER, 'id="a"') + R)),
    same("tag", styled("circle{fill:none}", '<circle r="90"/>' + R)),
    same("star", styled("*{fill:none} rect{fill:red}", '<circle r="90"/>' + R)),
    same("descendant", styled("g circle{fill:none}", f'<g><g><circle r="90"/></g></g>{R}')),
    same("child", styled("g>circle{fill:none}", f'<g><circle r="90"/></g>{R}')),
    same("no child", styled("g>rect{fill:none}", f"<g><a>{R}</a></g>")),
    same("sibling", styled("circle+circle{fill:none}", f'<circle r="0"/><circle r="90"/>{R}')),
    same("later sibling", styled("a~circle{fill:none}", f'<a/><g/><circle r="90"/>{R}')),
    same("attribute", styled('[r="90"]{fill:none}', f'<circle r="90"/>{R}')),
    same("attribute begins", styled("[id^=gho]{fill:none}", f'<circle id="ghost" r="90"/>{R}')),
    same("first child", styled("circle:first-child{fill:none}", f'<g><circle r="90"/>{R}</g>')),
    same("not", styled("rect:not(.a){fill:none}", COVER + more(R, 'class="a"'))),
    same("list of selectors", styled("g, circle{fill:none}", f'<circle r="90"/>{R}')),
    same("hover never", styled("rect:hover{fill:none}", R)),
    refused("selector unknown", styled("rect:strange{fill:none}", R), "selector 'rect:strange'"),
    same("later rule wins", styled("circle{fill:red}circle{fill:none}", f'<circle r="90"/>{R}')),
    same("specific rule wins", styled(".a{fill:none}circle{fill:red}",
         f'<circle class="a" r="90"/>{R}')),
    same("rule over attribute", styled("circle{fill:none}", f'<circle fill="red" r="90"/>{R}')),
    same("style over rule", styled("#a{fill:red}", f'<circle id="a" style="fill:none" r="90"/>{R}')),
    same("important", styled(".a{fill:none !important}",
         f'<circle class="a" style="fill:red" r="90"/>{R}')),
    same("important in style", styled(".a{fill:red !important}",
         f'<circle class="a" style="fill:none!important" r="90"/>{R}')),
    same("style after the shape", f'<circle r="90"/>{R}<style>circle{{fill:none}}</style>'),
    same("style in cdata", f'<circle r="90"/>{R}<style type="text/css"><![CDATA[ /* c */ '
         "g > a, circle { fill : none ; } ]]></style>"),
    same("two styles in one", f'<circle style="fill:red;fill:none" r="90"/>{R}'),
    same("display of a rule", styled(".a{display:none}", f'<g class="a">{COVER}</g>{R}')),
    same("rule for what use repeats", styled("#g circle{fill:none}",
         f'<defs><g id="g"><circle r="90"/></g></defs><use href="#g"/>{R}')),
    same("media screen", styled("@media screen{circle{fill:none}}", f'<circle r="90"/>{R}'),
         rsvg=False),
    same("media print", styled("@media print{rect{fill:none}}", R)),
    same("media of dark screens", styled("@media (prefers-color-scheme:dark){rect{fill:none}}", R)),
    refused("media width", styled("@media (min-width:9px){rect{fill:none}}", R), "media query"),
    refused("import", styled("@import url(a.css);", R), "@import url"),
    refused("supports", styled("@supports (fill:red){rect{fill:none}}", R), "@supports"),
    refused("nested rules", styled("g{rect{fill:none}}", R), "inside a style rule"),
    same("fonts and keyframes", styled("@font-face{font-family:a}@keyframes a{from{fill:red}}", R)),
    refused("css animation", styled("rect{animation:a 1s}", R), "animation='a 1s'"),
    refused("variables", styled("rect{--a:none;fill:var(--a)}", R), "fill='var"),
    Feature("geometry of css", styled("rect{x:10px;width:40px;height:30px}",
            '<rect y="20" width="5" height="5"/>'), 1200, R_BOX),
    refused("geometry without unit", styled("rect{width:40}", R), "width='40', which has no unit"),
    Feature("em", '<g font-size="10"><rect width="4em" height="20" style="font-size:5px"/></g>', 400),
    Feature("em of em", '<g font-size="10px"><g style="font-size:2em"><rect width="2em" height="10"/>'
            "</g></g>", 400),
    Feature("rem", '<g font-size="3"><rect width="4rem" height="10"/></g>', 400,
            root=PAGE + ' font-size="10"', rsvg=False),
    Feature("units", '<rect width="10mm" height="1in"/>', 960 / 25.4 * 96, (0, 0, 960 / 25.4, 96)),
    Feature("points and picas", '<rect width="60pt" height="3pc"/>', 80 * 48, (0, 0, 80, 48)),
    Feature("cm and q", '<rect width="1cm" height="40Q"/>', (96 / 2.54) ** 2, rsvg=False),
    refused("unit of the font", '<rect width="9ex" height="9"/>', "depends on the font"),
    refused("unit of the window", '<rect width="9vw" height="9"/>', "depends on the window"),
    refused("unit unknown", '<rect width="9ell" height="9"/>', "width='9ell'"),
    refused("calc", '<rect style="width:calc(9px + 1px)" height="9"/>', "width='calc"),
]  # fmt: skip

CLIPS = [
    Feature("clip path", CLIP.format("", HALF) + more(R, 'clip-path="url(#c)"'), 600,
            (10, 20, 30, 50)),
    Feature("clip on a group", CLIP.format("", HALF) + f'<g clip-path="url(#c)">{R}</g>', 600),
    Feature("clip by a rule", CLIP.format("", HALF) + styled("g{clip-path:url(#c)}", f"<g>{R}</g>"), 600),
    Feature("clip follows a transform", CLIP.format("", HALF)
            + f'<g clip-path="url(#c)" transform="translate(10)">{R}</g>', 600, (20, 20, 40, 50)),
    Feature("clip by the box", CLIP.format(' clipPathUnits="objectBoundingBox"',
            '<rect width=".25" height="1"/>') + f'<g clip-path="url(#c)">{R}</g>', 300,
            (10, 20, 20, 50)),
    Feature("clip by the box of a group", CLIP.format(' clipPathUnits="objectBoundingBox"',
            '<rect width=".5" height="1"/>') + f'<g clip-path="url(#c)">{R}'
            '<circle cx="80" cy="35" r="10" opacity="0"/></g>', 1200),
    Feature("clip of two", CLIP.format("", '<rect width="20" height="100"/><rect x="40" width="60" '
            'height="100"/>') + f'<g clip-path="url(#c)">{R}</g>', 600),
    Feature("clip rule", CLIP.format("", '<path clip-rule="evenodd" d="M0 0h90v90h-90zM20 30h20v10h-20z"'
            "/>") + f'<g clip-path="url(#c)">{R}</g>', 1000),
    Feature("clip rule is not the fill's", CLIP.format("", '<path fill-rule="evenodd" d="M0 0h90v90h-90z'
            'M20 30h20v10h-20z"/>') + f'<g clip-path="url(#c)">{R}</g>', 1200),
    Feature("clip with use", '<defs><rect id="h" width="30" height="100"/></defs>'
            + CLIP.format("", '<use href="#h" x="5"/>') + f'<g clip-path="url(#c)">{R}</g>', 750),
    Feature("clip of a clip path", '<clipPath id="d"><rect y="30" width="99" height="10"/></clipPath>'
            + CLIP.format(' clip-path="url(#d)"', HALF) + f'<g clip-path="url(#c)">{R}</g>', 200,
            rsvg=False),
    Feature("clip of a child", '<clipPath id="d"><rect y="30" width="99" height="10"/></clipPath>'
            + CLIP.format("", more(HALF, 'clip-path="url(#d)"')
            + '<rect x="40" width="5" height="99"/>') + f'<g clip-path="url(#c)">{R}</g>', 350, rsvg=False),
    Feature("clips inside one another", CLIP.format("", HALF) + '<clipPath id="d"><rect y="30" '
            f'width="99" height="10"/></clipPath><g clip-path="url(#c)"><g clip-path="url(#d)">{R}'
            "</g></g>", 200),
    Feature("clip by what is not seen", CLIP.format("", more(HALF, 'fill="none" opacity="0"'))
            + f'<g clip-path="url(#c)">{R}</g>', 600),
    Feature("clip of a hidden child", CLIP.format("", HALF + '<rect visibility="hidden" width="99" '
            'height="99"/><rect display="none" width="99" height="99"/>')
            + f'<g clip-path="url(#c)">{R}</g>', 600),
    same("empty clip", '<clipPath id="c"/><rect width="99" height="99" clip-path="url(#c)"/>' + R),
    Feature("clip of a use", CLIP.format("", HALF) + '<defs><rect id="r" width="40" height="30"/></defs>'
            '<use href="#r" x="10" y="20" clip-path="url(#c)"/>', 900, (10, 20, 40, 50)),
    Feature("clip rule inherited", '<g clip-rule="evenodd">' + CLIP.format("", '<path d="M0 0h90v90h-90zM20 30h20v10h-20z"/>') + f'</g><g clip-path="url(#c)">{R}</g>', 1000),
    refused("clip by a box that is moved", CLIP.format(' clipPathUnits="objectBoundingBox" transform="scale(.5)"', HALF) + f'<g clip-path="url(#c)">{R}</g>', "transform='scale"),
    refused("clip of text", CLIP.format("", '<text y="9">a</text>') + f'<g clip-path="url(#c)">{R}</g>',
            "<text>"),
    refused("clip with a group", CLIP.format("", f"<g>{HALF}</g>") + f'<g clip-path="url(#c)">{R}</g>',
            "<g> in it"),
    refused("clip missing", f'<g clip-path="url(#c)">{R}</g>', "clip-path='#c'"),
    refused("clip of itself", CLIP.format(' clip-path="url(#c)"', HALF) + f'<g clip-path="url(#c)">{R}'
            "</g>", "refers to itself"),
    refused("clip by a shape of css", f'<g style="clip-path:circle(9px)">{R}</g>', "clip-path='circle"),
]  # fmt: skip

PEN = 'fill="none" stroke="red" stroke-width="8"'
BOX = f'<rect x="20" y="20" width="40" height="30" {PEN}/>'
STROKE = f'<path d="M10 50h60" {PEN}/>'
BOX_AREA = 48 * 38 - 32 * 22

STROKES = [
    drawn("stroke", BOX, BOX_AREA),
    drawn("stroke and fill", more('<rect x="20" y="20" width="40" height="30"/>', 'stroke="red" stroke-width="8"'), 48 * 38),
    drawn("stroke of a closed path", f'<path d="M20 20h40v30h-40z" {PEN}/>', BOX_AREA),
    drawn("stroke closed twice", f'<path d="M20 20h40v30h-40v-30z" {PEN}/>', BOX_AREA),
    drawn("stroke of an open path", f'<path d="M20 20h40v30h-40v-30" {PEN}/>', BOX_AREA - 16),
    drawn("stroke of a line", f'<line x1="10" y1="50" x2="70" y2="50" {PEN}/>', 480),
    drawn("stroke of a circle", f'<circle cx="50" cy="50" r="30" {PEN}/>', PI * (34**2 - 26**2)),
    drawn("cap butt", STROKE, 480),
    drawn("cap square", more(STROKE, 'stroke-linecap="square"'), 544),
    drawn("cap round", more(STROKE, 'style="stroke-linecap:round"'), 480 + PI * 16),
    drawn("cap of a dot", f'<path d="M50 50h0" stroke-linecap="round" {PEN}/>', PI * 16),
    drawn("join round", more(BOX, 'stroke-linejoin="round"'), BOX_AREA - (4 - PI) * 16),
    drawn("join bevel", more(BOX, 'stroke-linejoin="bevel"'), BOX_AREA - 4 * 8),
    drawn("mitre limit", more(BOX, 'stroke-miterlimit="1.4"'), BOX_AREA - 4 * 8),
    drawn("mitre within its limit", more(BOX, 'stroke-miterlimit="1.42"'), BOX_AREA),
    drawn("stroke width in percent", '<path d="M10 50h60" fill="none" stroke="red" stroke-width="8%"/>', 480),
    drawn("stroke width in em", '<g style="font-size:4px;stroke-width:2em"><path d="M10 50h60" fill="none" stroke="red"/></g>', 480),
    drawn("stroke scaled", f'<g transform="scale(.5) rotate(20)">{BOX}</g>', BOX_AREA / 4),
    drawn("stroke clipped", CLIP.format("", '<rect width="40" height="100"/>') + more(STROKE, 'clip-path="url(#c)"'), 240),
    drawn("stroke opacity", f'{STROKE}<g stroke-opacity="0">{BOX}</g>', 480),
    drawn("stroke none", f'{STROKE}<rect width="90" height="90" fill="none" stroke="none"/>', 480),
    drawn("stroke width of zero", f'{STROKE}<rect width="90" height="90" fill="none" stroke="red" stroke-width="0"/>', 480),
    drawn("dashes of zero", more(STROKE, 'stroke-dasharray="0 0"'), 480),
    same("stroke of dashes is ignored", R + more(STROKE, 'stroke-dasharray="4"'), rsvg=False),
    refused("dashes drawn", more(STROKE, 'stroke-dasharray="4"'), "stroke-dasharray='4'", strokes="drawn"),
    refused("stroke stretched", f'<g transform="scale(2 1)">{STROKE}</g>', "stretched", strokes="drawn"),
    refused("stroke that does not scale", more(STROKE, 'vector-effect="non-scaling-stroke"'), "vector-effect=", strokes="drawn"),
    refused("join arcs", more(STROKE, 'stroke-linejoin="arcs"'), "stroke-linejoin='arcs'", strokes="drawn"),
    drawn("width of null", '<g stroke-width="8"><path d="M10 50h60" fill="none" stroke="red" stroke-width="null" stroke-dasharray="null"/></g>', 480),
    same("width of no stroke", more(R, 'stroke-width="var(--w)"')),
    refused("stroke unknown", '<path d="M10 50h60" fill="none" stroke="reddish"/>', "stroke='reddish'"),
    refused("negative stroke", '<path d="M10 50h60" stroke="red" stroke-width="-1"/>', "stroke-width='-1'"),
]  # fmt: skip

FEATURES = [*STROKES, *SHAPES, *STRUCTURE, *TRANSFORMS, *PAINT, *STYLE, *CLIPS]
