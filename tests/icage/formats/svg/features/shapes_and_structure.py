"""Features of shapes, of what holds them together, and of transforms."""

# ruff: noqa: E501 - a row a feature

from __future__ import annotations

import math

from tests.icage.formats.svg.features.feature import (
    COVER,
    R_BOX,
    Feature,
    R,
    refused,
    same,
    styled,
)

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
