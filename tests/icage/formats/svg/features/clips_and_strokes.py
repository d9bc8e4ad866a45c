"""Features of clip paths and of strokes."""

# ruff: noqa: E501 - a row a feature

from __future__ import annotations

import math

from tests.icage.formats.svg.features.feature import (
    Feature,
    R,
    drawn,
    more,
    refused,
    same,
    styled,
)

CLIP = '<clipPath id="c"{}>{}</clipPath>'
HALF = '<rect width="30" height="100"/>'
PI = math.pi

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
