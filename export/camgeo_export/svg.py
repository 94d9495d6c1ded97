"""SVG at true size: the part's boundaries as closed paths of lines and arcs, one unit 1 mm.

Width and height state millimetres and the view box the same numbers, so programs that convert 96
pixels to an inch take no part in it. Y points down in SVG; numbers are mirrored, nothing is
transformed. One group for each layer of `camgeo_export.reading`, hairlines without fill.
"""

from __future__ import annotations

import math
from typing import Final
from xml.sax.saxutils import escape

import numpy as np

from camgeo.design.product import Product, title_of
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.part.boundaries import largest_radius
from camgeo.part.part import written_contour
from camgeo.reading import SVG_PIECES
from camgeo.scene.formats.format import CUT_SVG
from camgeo.units import counted
from camgeo_export.reading import CUT, deviation, layered
from camgeo_export.svg_reader import SvgDrawing, drawing_of

WIDEST: Final = 0.5 * math.pi
"""Widest arc [rad]: an arc is given by its ends and its radius, from which the centre of one near
half a turn cannot be found."""

DECIMALS: Final = 15
"""At which what is 0 except for rounding is 0; far below any tolerance."""

MARGIN: Final = 1.0
"""Around the part [mm]."""

HAIRLINE: Final = "0.01"
"""Width of the lines [mm], which laser cutters take as a cut."""

THROUGH, NOT_THROUGH = "#ff0000", "#0000ff"
"""Colours of what is cut through, and of what is not."""


class CutSvgWriter:
    """Writes the part as an SVG at true size."""

    format = CUT_SVG

    def write(self, product: Product, tolerance: float) -> Written:
        """The drawing in mm, whatever the unit of the scene; all of it within `tolerance` [mm]."""
        effort = product.drawn.effort
        layers: dict[str, list[Contour]] = {
            name: [
                written_contour(each, "arcs", effort, tolerance, WIDEST).contour
                for each in boundaries
            ]
            for name, boundaries in layered(product).items()
        }
        curves = [contour for contours in layers.values() for contour in contours]
        pieces = sum(map(len, curves))
        if pieces > SVG_PIECES:
            found = f"the drawing would have {counted(pieces, 'piece')}"
            raise FileError(
                f"{found}; at most {SVG_PIECES:,} are allowed in a drawing that is read; a larger"
                " tolerance needs fewer"
            )
        side = math.ceil(max(map(largest_radius, curves)) + MARGIN)
        size = f'width="{2 * side}mm" height="{2 * side}mm"'
        box = f'viewBox="{-side} {-side} {2 * side} {2 * side}"'
        made = f"camgeo {product.version}; scene {product.scene_hash}"
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" version="1.1" {size} {box}>',
            f"<title>{escape(title_of(product))}</title>",
            f"<desc>{made}; tolerance {tolerance!r} mm</desc>",
        ]
        for name, contours in layers.items():
            colour = THROUGH if name == CUT else NOT_THROUGH
            lines.append(f'<g id="{name}" fill="none" stroke="{colour}" stroke-width="{HAIRLINE}">')
            lines += [f'<path d="{path_of(contour)}"/>' for contour in contours]
            lines.append("</g>")
        arcs = sum(contour.arc_count for contour in curves)
        facts: dict[str, int | float | str] = {
            "boundaries": len(curves), "arcs": arcs, "lines": pieces - arcs,
        }  # fmt: skip
        return Written("\n".join([*lines, "</svg>", ""]).encode(), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the drawing back and measure it against the exact curves [mm]."""
        return measure(product, data)


def path_of(contour: Contour) -> str:
    """The data of a path, in millimetres, y downward."""
    pieces = zip(
        contour.ends.tolist(), contour.sweeps.tolist(), contour.radii.tolist(), strict=True
    )
    first = complex(contour.vertices[0])
    words = [f"M{_point(first)}"]
    for end, sweep, radius in pieces:
        if sweep:
            turn = 0 if sweep > 0.0 else 1  # counter-clockwise is against growing angles here
            size = _number(radius)
            words.append(f"A{size} {size} 0 0 {turn} {_point(end)}")
        else:
            words.append(f"L{_point(end)}")
    return " ".join([*words, "Z"])


def _point(point: complex) -> str:
    return f"{_number(point.real)} {_number(-point.imag)}"


def _number(value: float) -> str:
    """The shortest decimal that reads back the same, without an exponent."""
    rounded = round(value, DECIMALS) + 0.0  # + 0.0 turns -0.0 into 0.0
    return np.format_float_positional(rounded, trim="-")


WRITER = CutSvgWriter()


# -- measure --------------------------------------------------------------------------------------
# An SVG drawing read back and compared with the exact curves.


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm] of all that is drawn.

    Raises FileError if the drawing is incomplete, foreign or not at true size.
    """
    drawing = drawing_of(data)
    layers = layered(product)
    check_contents(drawing, tuple(layers))
    return max(
        deviation(drawing.layers.get(name, ()), boundaries) for name, boundaries in layers.items()
    )


def check_contents(drawing: SvgDrawing, layers: tuple[str, ...]) -> None:
    """Raise FileError unless the drawing has these layers alone, one unit to the millimetre."""
    if drawing.scale != 1.0:
        raise FileError(f"a unit of the drawing is {drawing.scale:g} mm, not 1 mm")
    foreign = [name for name in drawing.layers if name not in layers]
    if foreign:
        raise FileError(f"a contour in the group {foreign[0][:40]!r} is not part of the drawing")
