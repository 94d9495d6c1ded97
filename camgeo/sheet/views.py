"""The views on a sheet: the front view and the section, with dimensions and symbols."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.formats.drawing import DrawingSpec
from camgeo.product.product import Product
from camgeo.sheet import dimensions, front
from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import (
    Chain,
    Diameter,
    Distance,
    Filled,
    Label,
    Mark,
    Round,
    arc,
    arrow,
    line,
)
from camgeo.sheet.placing import box_of, cleared
from camgeo.sheet.section import section
from camgeo.sheet.shape import SHARE, Shape, extreme, shape_of
from camgeo.sheet.symbols import datum, frame_width, texture, tolerance_frame
from camgeo.units import MM_PER, LengthUnit

LETTER: Final = 5.0
"""Of the cutting plane [mm]."""

FRAME_ANGLE: Final = math.radians(120.0)
"""Polar angle of the place on the flank that the tolerance frame points at."""

ASIDE_ANGLE: Final = math.radians(145.0)
"""The same beside the datum of a keyway."""

SLANTED: Final = math.radians(-60.0)
"""Direction of the line of a diameter in the front view."""

CROWDED: Final = 30.0
"""Radius of a part [mm of paper] below which dimensions of a keyway reach beyond it."""

CLEAR: Final = 24.0
"""Least radius of the arrow in the sense of rotation [mm of paper]."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """What the views are made of.

    Attributes
    ----------
    shape : the part.
    pitch : the pitch curve; None if it is the outline.
    base_radius : of the base circle [mm]; None for a pair in one piece, which has two.
    cut : the marks of the section; empty without thickness.
    unit : of the dimensions.
    """

    shape: Shape
    pitch: Contour | None
    base_radius: float | None
    cut: tuple[Mark, ...]
    unit: LengthUnit

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that the front view shows [mm]."""
        contours = [edge.contour for edge in self.shape.edges]
        if self.base_radius is not None:
            contours.append(Contour.circle(self.base_radius))
        if self.pitch is not None:
            contours.append(self.pitch)
        left, right, low, high = (extreme(contours, way) for way in (-1.0, 1.0, -1j, 1j))
        return complex(left.real, low.imag), complex(right.real, high.imag)


def drawn_of(product: Product, tolerance: float) -> Drawn:
    """What the views of a disc are made of, its curves within `tolerance` [mm]."""
    drawn = product.drawn
    shape = shape_of(drawn.part, tolerance, drawn.effort)
    cut = tuple(section(shape)) if shape.has_heights else ()
    if product.is_pair:
        return Drawn(shape, None, None, cut, product.unit)
    pitch = None
    if drawn.has_pitch_curve:
        pitch = drawn.pitch_contour(SHARE * tolerance).contour
    return Drawn(shape, pitch, drawn.base_radius, cut, product.unit)


def front_view(drawn: Drawn, scale: float, product: Product, spec: DrawingSpec) -> list[Mark]:
    """The part from above, its origin in the cam axis."""
    shape, unit = drawn.shape, product.unit
    low, high = drawn.box
    marks: list[Mark] = []
    if drawn.pitch is not None:
        marks += front.dashed(drawn.pitch, scale, "PITCH_CURVE", front.DASH_DOT)
    if drawn.base_radius is not None:
        marks.append(Round(0j, drawn.base_radius, "BASE_CIRCLE"))
    marks += _cross(low, high, scale)
    marks += front.hole_centres(shape, scale)
    marks += front.outlines(shape)
    marks += dimensions.overall(shape, (low, high), unit, scale)
    for each in dimensions.turned(shape):
        marks += dimensions.of_flat(each.edge, unit, scale)
        if each.keyway is not None:
            marks += dimensions.of_keyway(each.keyway, spec, unit, scale)
            if spec.flank_tolerance is not None:
                corner, way = each.keyway.datum
                end = corner + each.keyway.outward * dimensions.BEYOND / scale
                marks += _moved(datum(0j, way, "B"), end, scale)
        if not drawn.cut or not dimensions.in_section(each):
            text = dimensions.fit(each, spec)
            marks.append(Diameter(0j, each.radius, SLANTED, text, dimensions.EXACT[unit]))
            if spec.flank_tolerance is not None and each.edge.boundary.name == "bore":
                shelf = cmath.rect(each.radius + dimensions.OUTSIDE / scale, SLANTED)
                marks += _moved(datum(0j, -1j, "A"), shelf - 1j * dimensions.SHELF / scale, scale)
    marks += dimensions.of_holes(shape, unit)
    marks += _zero_mark(drawn, scale)
    marks += _sense(drawn, product.cam.rotation, scale)
    if drawn.cut:
        marks += _plane(low, high, scale)
    marks += flank_marks(drawn, scale, spec)
    return _cleared(marks, scale, unit)


def _cleared(marks: list[Mark], scale: float, unit: LengthUnit) -> list[Mark]:
    """The marks of a view with thin lines kept off the texts of its dimensions."""
    boxes = [box_of(mark, scale, unit) for mark in marks if isinstance(mark, Distance)]
    layers = ("CENTRE", "PITCH_CURVE", "BASE_CIRCLE")
    return list(cleared(front.in_dashes(marks, scale), boxes, layers, scale))


def _moved(marks: Sequence[Mark], at: complex, scale: float) -> list[Mark]:
    """Marks of paper as marks of a view, their origin at the place `at` of the part [mm]."""
    found: list[Mark] = []
    for mark in marks:
        if isinstance(mark, Chain):
            found.append(replace(mark, vertices=at + mark.vertices / scale))
        elif isinstance(mark, Round):
            found.append(replace(mark, centre=at + mark.centre / scale, radius=mark.radius / scale))
        elif isinstance(mark, Label):
            found.append(replace(mark, at=at + mark.at / scale))
        elif isinstance(mark, Filled):
            found.append(replace(mark, corners=tuple(at + each / scale for each in mark.corners)))
    return found


def _cross(low: complex, high: complex, scale: float) -> list[Mark]:
    """Centre lines through the cam axis, beyond all that is shown."""
    far = front.BEYOND / scale
    return [
        line(complex(low.real - far, 0.0), complex(high.real + far, 0.0), "CENTRE"),
        line(complex(0.0, low.imag - far), complex(0.0, high.imag + far), "CENTRE"),
    ]


def _reach(drawn: Drawn, first: float, last: float) -> float:
    """Largest distance from the cam axis of what is shown between two polar angles [mm]."""
    contours = [edge.contour for edge in drawn.shape.edges]
    contours += [] if drawn.pitch is None else [drawn.pitch]
    points = np.concatenate([each.points(0.001 * drawn.shape.size) for each in contours])
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    near = np.abs(np.angle(points * cmath.exp(-1j * middle))) <= half + 0.02
    return max(float(np.max(np.abs(points[near]), initial=0.0)), drawn.base_radius or 0.0)


def _zero_mark(drawn: Drawn, scale: float) -> list[Mark]:
    """A wide stroke at cam angle 0, outside of all."""
    start = _reach(drawn, -0.03, 0.03) + 6.0 / scale
    text = Label("0°", complex(start, 1.5 / scale), 2.5, layer="SYMBOL")
    return [line(complex(start), complex(start + 8.0 / scale), "EDGES"), text]


def _sense(drawn: Drawn, rotation: int, scale: float) -> list[Mark]:
    """An arrow in the sense of rotation, around the lower right of the view; on the left of a small
    one, for the width of a keyway stands on the right.
    """
    first, last = math.radians(-62.0), math.radians(-36.0)
    if drawn.shape.size * scale < CROWDED:
        first, last = -math.pi - last, -math.pi - first
    radius = max(_reach(drawn, first, last) + 5.0 / scale, CLEAR / scale)
    start, end = (first, last) if rotation > 0 else (last, first)
    begin, tip = cmath.rect(radius, start), cmath.rect(radius, end)
    way = 1j * rotation * tip / radius
    turned = way * cmath.exp(-1j * rotation * 1.5 / (radius * scale))  # a chord of the arc
    head = _moved([arrow(0j, turned, size=4.0)], tip, scale)
    return [arc(0j, begin, end - start, "EDGES"), *head]


def _plane(low: complex, high: complex, scale: float) -> list[Mark]:
    """The ends of the cutting plane A-A, with arrows in the direction of sight."""
    marks: list[Mark] = []
    for y, way in ((low.imag, -1.0), (high.imag, 1.0)):
        start = complex(0.0, y + way * 5.5 / scale)
        marks.append(line(start, start + 6j * way / scale, "SECTION"))
        end = start + 6j * way / scale
        tail = end - 9.0 / scale
        marks.append(line(tail, end, "SYMBOL"))
        marks += _moved([arrow(0j, 1.0 + 0j, size=4.0)], end - 0.2 / scale, scale)
        at = tail + 1.2j / scale
        marks.append(Label("A", at, LETTER, layer="SYMBOL"))
    return marks


def flank_marks(drawn: Drawn, scale: float, spec: DrawingSpec) -> list[Mark]:
    """The profile tolerance and the texture of the flanks, with a leader from the upper left."""
    if spec.flank_tolerance is None and not spec.flank_surface:
        return []
    edge = _flank_edge(drawn)
    raised = frame_level(drawn, scale) > drawn.box[1].imag * scale + 4.0
    way = cmath.rect(1.0, ASIDE_ANGLE if raised else FRAME_ANGLE)
    points = edge.points(0.0005 * drawn.shape.size)
    at = complex(points[np.argmin(np.abs(np.angle(points / way)))])
    level = frame_level(drawn, scale) / scale
    length = max((level - at.imag) / way.imag, 4.0 / scale)
    knee = at + way * length
    shelf = knee - 4.0 / scale
    marks = _moved([arrow(0j, -way, size=3.0)], at, scale)
    marks += [line(at + 1.0 / scale * way, knee, "SYMBOL"), line(knee, shelf, "SYMBOL")]
    left = 0.0
    if spec.flank_tolerance is not None:
        value = f"{spec.flank_tolerance / MM_PER[drawn.unit]:.6f}"
        value = value.rstrip("0").rstrip(".")
        value = value.replace(".", ",") if spec.language == "de" else value
        names = ["A", "B"][: _datums(drawn)]
        left = frame_width(value, names)
        corner = complex(-left, -3.5)
        marks += _moved(tolerance_frame(corner, value, names), shelf, scale)
    if spec.flank_surface:
        wide = width_of(spec.flank_surface, 2.5) + 6.0
        above = complex(-max(wide, 0.6 * left), 3.5 if left else 0.0)
        marks += _moved(texture(above, spec.flank_surface, 2.5), shelf, scale)
    return marks


def frame_level(drawn: Drawn, scale: float) -> float:
    """Height of the middle of the flank's frame over the cam axis [mm of paper]: above all that is
    shown, and above the datum of a keyway that points up.
    """
    level = drawn.box[1].imag * scale + 4.0
    for each in dimensions.turned(drawn.shape):
        if each.keyway is not None and each.keyway.outward.imag > 0.0:
            up = each.keyway.outward * (each.keyway.bottom * scale + dimensions.BEYOND)
            level = max(level, up.imag + 9.0)
    return level


def _flank_edge(drawn: Drawn) -> Contour:
    """The flank, of a groove the inner one."""
    flanks = (edge for edge in drawn.shape.edges if edge.is_flank)
    return next(flanks, drawn.shape.outermost).contour


def _datums(drawn: Drawn) -> int:
    """How many datums the part has: its bore, and its keyway."""
    bores = [each for each in dimensions.turned(drawn.shape) if each.edge.boundary.hole
             and each.edge.boundary.name == "bore"]  # fmt: skip
    return 0 if not bores else 2 if bores[0].keyway is not None else 1


def section_view(drawn: Drawn, scale: float, product: Product, spec: DrawingSpec) -> list[Mark]:
    """The section, its origin where the cam axis meets the lowest face."""
    shape, unit = drawn.shape, product.unit
    low, high = drawn.box
    thick = shape.part.thickness
    far = front.BEYOND / scale
    marks: list[Mark] = [line(complex(-far), complex(thick + far), "CENTRE"), *drawn.cut]
    rounds = dimensions.turned(shape)
    marks += dimensions.of_diameters(rounds, thick, spec, unit, scale)
    marks += dimensions.of_heights(shape, list(drawn.cut), (low, high), unit, scale)
    # the texts of diameters may stand up to here on the right
    middle = min(0.5 * thick, thick - 6.0 / scale)
    title = complex(
        middle,
        high.imag + (13.0 + dimensions.STEP * len(dimensions.heights(shape, unit, scale))) / scale,
    )
    marks.append(Label("A-A", title, LETTER, "centre", "SYMBOL"))
    if spec.flank_tolerance is not None:
        for number, each in enumerate(r for r in rounds if dimensions.in_section(r)):
            if each.edge.boundary.name == "bore":
                foot = complex(thick + dimensions.STEP * (number + 1) / scale, -each.radius)
                marks += _moved(datum(0j, -1j, "A"), foot, scale)
    return _cleared(marks, scale, unit)
