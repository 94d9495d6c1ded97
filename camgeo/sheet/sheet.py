"""The whole sheet of one disc: its parts and their places."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.errors import GeometryError, SceneError
from camgeo.formats.drawing import DrawingSpec, SheetName
from camgeo.product.product import Product
from camgeo.sheet import course, dimensions, front, notes
from camgeo.sheet.frame import (
    BLOCK_HEIGHT,
    BLOCK_WIDTH,
    LEFT,
    MARGIN,
    SIZES,
    block_place,
    frame,
    title_block,
)
from camgeo.sheet.marks import Chain, Diameter, Distance, Mark, Sheet, View
from camgeo.sheet.scales import scale_of, scales, spelled
from camgeo.sheet.symbols import edges, texture
from camgeo.sheet.views import (
    Drawn,
    drawn_of,
    flank_marks,
    frame_level,
    front_view,
    section_view,
)
from camgeo.sheet.words import WORDS
from camgeo.units import MM_PER

ASIDE: Final = 22.0
"""Left of the front view, for its height [mm]."""

BETWEEN: Final = 26.0
"""Between front view and section, with the zero mark [mm]."""

ABOVE: Final = 20.0
"""Above the views: letters of the cutting plane, title of the section, a tolerance frame [mm]."""

BELOW: Final = 22.0
"""Below the views: dimensions, letters of the cutting plane [mm]."""

DIAGRAM: Final[dict[SheetName, float]] = {"A3": 48.0, "A4": 36.0}
"""Height of the motion diagram [mm]."""


@dataclass(frozen=True, slots=True)
class Region:
    """A rectangle of the sheet by two corners [mm]."""

    low: complex
    high: complex

    @property
    def size(self) -> complex:
        """Width and height."""
        return self.high - self.low


def sheet_of(product: Product, tolerance: float) -> Sheet:
    """The sheet of a disc, whose edges lie within `tolerance` [mm].

    Raises
    ------
    SceneError
        With the key of `[drawing]` that is at fault, if not all of it fits on the sheet.
    """
    try:
        return _sheet_of(product, tolerance)
    except GeometryError as error:
        if not error.key.startswith("drawing."):
            raise
        scene = product.scene
        fault = scene.stated.scene.fault(tuple(error.key.split(".")), error.message)
        fault = fault if fault.value else replace(fault, value=error.value)
        raise SceneError([fault], scene.source.file) from error


def _sheet_of(product: Product, tolerance: float) -> Sheet:
    spec, whole = product.scene.drawing, is_in_one_piece(product)
    if product.is_pair:  # the sheets of its discs have their curves
        spec = replace(spec, step=0, motion=False, scale="")
    size = SIZES[spec.sheet]
    regions, marks = _texts(product, spec, tolerance)
    drawn = drawn_of(product, tolerance)
    scale = _scale(drawn, regions, spec)
    views = _views(drawn, regions, float(scale), product, spec)
    corner = complex(size.width - MARGIN - BLOCK_WIDTH, MARGIN)
    count = len(product.judgement.cams) + whole
    numbered = (count if product.is_pair else product.position + 1, count)
    marks += frame(size)
    marks += title_block(corner, spec, spelled(scale), product.unit, numbered)
    if spec.edges:
        marks += edges(corner + block_place("edges"), spec.edges)
    if spec.surface:
        marks += texture(corner + block_place("surface"), spec.surface, 2.0)
    comma = spec.language == "de"
    dashed = tuple(front.in_dashes(marks, 1.0))
    return Sheet(size.width, size.height, float(scale), product.unit, comma, views, dashed)


def is_in_one_piece(product: Product) -> bool:
    """Whether the disc is one piece with another."""
    part = product.scene.part
    return part is not None and part.pair is not None


def _texts(product: Product, spec: DrawingSpec, tolerance: float) -> tuple[Region, list[Mark]]:
    """The region left for the views, and the marks of notes, table and diagram."""
    size, words = SIZES[spec.sheet], WORDS[spec.language]
    low = complex(LEFT, MARGIN)
    high = complex(size.width - MARGIN, size.height - MARGIN)
    wide = spec.sheet == "A3"
    column = complex(high.real - BLOCK_WIDTH, low.imag + BLOCK_HEIGHT)
    width = BLOCK_WIDTH - 4.0
    comma = spec.language == "de"

    def written(value: float, decimals: int) -> str:
        text = f"{value + 0.0:.{decimals}f}"
        text = text.removeprefix("-") if float(text) == 0.0 else text
        return text.replace(".", ",") if comma else text

    def length(value: float) -> str:
        decimals = 4 if product.unit == "mm" else 5
        text = written(value / MM_PER[product.unit], decimals).rstrip("0")
        return text.rstrip(".,")

    lines = notes.lines_of(notes.notes_of(product, spec, tolerance, length), width)
    top = column + complex(2.0, notes.height_of(lines) + 2.0)
    marks = notes.marks_of(lines, words.notes, top, width)
    left = Region(low, complex(column.real, high.imag)) if wide else Region(low, high)
    floor = top.imag + 2.0
    if spec.step:
        table = course.table_of(product, words, spec.step, written, centre=wide)
        groups = 2 if wide else 3
        needed = table.height(groups)
        if not wide and len(table.rows) > 36:
            raise GeometryError(
                'must be at least 10 on a sheet A4, for the table to fit; or sheet = "A3"',
                key="drawing.step", value=f"{spec.step}",
            )  # fmt: skip
        upper = high.imag - 2.0 if wide else floor + needed
        marks += course.table_marks(table, words.table, complex(column.real + 2.0, upper), width,
                                    groups)  # fmt: skip
        floor += needed
    bottom = low.imag + 5.0 if wide else floor
    if spec.has_motion:
        corner = complex(low.real + 3.0, bottom)
        across = left.size.real - 6.0
        room = complex(across, DIAGRAM[spec.sheet])
        marks += course.diagram(product, words, corner, room, written)
        bottom += room.imag
    return Region(complex(low.real, bottom), left.high), marks


def _needed(drawn: Drawn, scale: float, spec: DrawingSpec) -> complex:
    """Width and height that the views need at a scale [mm of paper]."""
    low, high = drawn.box
    above = ABOVE + (
        dimensions.STEP * len(dimensions.heights(drawn.shape, drawn.unit, scale))
        if drawn.cut
        else 0.0
    )
    if spec.flank_tolerance is not None or spec.flank_surface:
        above = max(above, frame_level(drawn, scale) - high.imag * scale + 14.0)
    size = (high - low) * scale + complex(_aside(drawn, scale, spec), above + BELOW)
    return size + _section_width(drawn, scale)


def _aside(drawn: Drawn, scale: float, spec: DrawingSpec) -> float:
    """Width left of the front view [mm of paper]: its height, and the frame of its flank."""
    end = min((_left_of(mark) for mark in flank_marks(drawn, scale, spec)), default=0.0)
    return max(ASIDE, (drawn.box[0].real - end) * scale + 3.0)


def _left_of(mark: Mark) -> float:
    """The leftmost x of a mark of lines; of others 0 [mm]."""
    return float(np.min(mark.vertices.real)) if isinstance(mark, Chain) else 0.0


def _section_width(drawn: Drawn, scale: float) -> float:
    """Width of the section with what is beside it [mm of paper]."""
    if not drawn.cut:
        return 18.0
    rounds = [each for each in dimensions.turned(drawn.shape) if dimensions.in_section(each)]
    beside = dimensions.STEP * (len(rounds) + 0.8)
    return BETWEEN + drawn.shape.part.thickness * scale + beside


def _scale(drawn: Drawn, region: Region, spec: DrawingSpec) -> Fraction:
    room = region.size
    fitting = []
    for scale in scales():
        needed = _needed(drawn, float(scale), spec)
        if needed.real <= room.real and needed.imag <= room.imag:
            fitting.append(scale)
    if not spec.scale:
        if not fitting:
            message = "leaves no room for the views; leave out table or diagram, or take A3"
            raise GeometryError(message, key="drawing.sheet", value=spec.sheet)
        return fitting[0]
    asked = scale_of(spec.scale)
    if asked not in fitting:
        found = f'at most "{spelled(fitting[0])}"' if fitting else "no scale"
        raise GeometryError(
            f"does not fit on the sheet: {found} does", key="drawing.scale", value=spec.scale
        )
    return asked


def _views(
    drawn: Drawn, region: Region, scale: float, product: Product, spec: DrawingSpec
) -> tuple[View, ...]:
    """The front view and, of a part with thickness, the section to its right."""
    low, high = drawn.box
    spare = region.size - _needed(drawn, scale, spec)
    aside = _aside(drawn, scale, spec)
    place = region.low + complex(aside + 0.5 * spare.real, BELOW + 0.5 * spare.imag) - low * scale
    views = [View(place, tuple(front_view(drawn, scale, product, spec)))]
    if drawn.cut:
        beside = place + high.real * scale + BETWEEN
        views.append(View(beside, tuple(section_view(drawn, scale, product, spec))))
    return tuple(views)


def measured(sheet: Sheet) -> tuple[Distance | Diameter, ...]:
    """All dimensions of a sheet."""
    return tuple(
        mark for view in sheet.views for mark in view.marks if isinstance(mark, Distance | Diameter)
    )
