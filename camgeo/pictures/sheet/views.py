"""The views on a sheet: the front view and the section, with dimensions and symbols."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.geometry.contour.contour import Contour
from camgeo.part.part import WRITTEN_SHARE
from camgeo.pictures.sheet import front
from camgeo.pictures.sheet import section as dimensions
from camgeo.pictures.sheet.marks import (
    CELL,
    Label,
    Mark,
    Round,
    arc,
    arrow,
    frame_width,
    line,
    moved,
    texture,
    tolerance_frame,
    width_of,
)
from camgeo.pictures.sheet.placing import AXES, CLEAR, Options, cleared, ink_of, settled
from camgeo.pictures.sheet.section import Bench, section
from camgeo.pictures.sheet.shape import Shape, bevelled, edges_above, extreme, shape_of
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.units import MM_PER, LengthUnit

LETTER: Final = 5.0
"""Of the cutting plane [mm]."""

LEAST_RADIUS: Final = 24.0
"""Least radius of the arrow in the sense of rotation [mm of paper]."""

ALL_AROUND: Final = 1.5
"""Radius of the circle that extends a tolerance to all of a closed flank [mm of paper]."""

ARROW_SPAN: Final = math.radians(13.0)
"""Half of what it spans."""

TITLE: Final = 5.0
"""From the upper edge of the section to its title, beside the letter of its plane [mm of paper]."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """What the views are made of.

    Attributes
    ----------
    shape : the part.
    pitch : the pitch curve; None if it is the outline.
    base_radius : of the base circle [mm]; None if it is not drawn: a pair in one piece has two.
    cut : the marks of the section, with sharp edges; empty without thickness.
    unit : of the dimensions.
    edges : of chamfers that are seen from above.
    """

    shape: Shape
    pitch: Contour | None
    base_radius: float | None
    cut: tuple[Mark, ...]
    unit: LengthUnit
    edges: tuple[Mark, ...] = ()

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

    @property
    def alone(self) -> Drawn:
        """The part without pitch curve and base circle."""
        return replace(self, pitch=None, base_radius=None)


def drawn_of(product: Product, tolerance: float) -> Drawn:
    """What the views of a disc are made of, its curves within `tolerance` [mm]."""
    drawn = product.drawn
    shape = shape_of(drawn.part, tolerance, drawn.effort)
    cut = tuple(section(shape)) if shape.has_heights else ()
    edges = tuple(edges_above(shape, tolerance, drawn.effort))
    if product.is_pair:
        return Drawn(shape, None, None, cut, product.unit, edges)
    pitch = None
    if drawn.has_pitch_curve:
        pitch = drawn.pitch_contour(WRITTEN_SHARE * tolerance).contour
    return Drawn(shape, pitch, drawn.base_radius, cut, product.unit, edges)


def front_view(drawn: Drawn, scale: float, product: Product, spec: DrawingSpec) -> list[Mark]:
    """The part from above, its origin in the cam axis."""
    shape, unit = drawn.shape, product.unit
    low, high = drawn.box
    reach = max(abs(complex(x, y)) for x in (low.real, high.real) for y in (low.imag, high.imag))
    bench = Bench(spec, unit, scale, reach)
    fixed: list[Mark] = []
    if drawn.pitch is not None:
        fixed += front.dashed(drawn.pitch, scale, "PITCH_CURVE", front.DASH_DOT)
    if drawn.base_radius is not None:
        fixed.append(Round(0j, drawn.base_radius, "BASE_CIRCLE"))
    fixed += _cross(low, high, scale)
    fixed += front.hole_centres(shape, scale)
    fixed += front.outlines(shape)
    fixed += drawn.edges
    if drawn.cut:
        fixed += _plane(low, high, scale)
    requests: list[Options] = []
    rounds = dimensions.turned(shape)
    for each in rounds:
        if each.keyway is not None:
            requests.append(dimensions.keyway_width(each.keyway, bench))
            requests.append(dimensions.keyway_depth(each.keyway, bench))
    requests += [dimensions.of_flat(each.edge, bench) for each in rounds]
    requests += [dimensions.of_round(each, bench) for each in rounds
                 if not drawn.cut or not dimensions.in_section(each)]  # fmt: skip
    requests += dimensions.of_holes(shape, bench)
    requests.append(_zero_mark(drawn, scale))
    requests += dimensions.overall(shape, (low, high), bench)
    requests += [_flank(drawn, scale, spec), _sense(drawn, product.cam.rotation, scale)]
    return _cleared(settled(requests, fixed, scale, unit), scale, unit)


def _cleared(marks: list[Mark], scale: float, unit: LengthUnit) -> list[Mark]:
    """The marks of a view with thin lines kept off its texts and frames."""
    ink = ink_of(marks, scale, unit)
    rooms = (ink.texts.around(CLEAR), ink.frames)
    return list(cleared(front.in_dashes(marks, scale), rooms, tuple(AXES), scale))


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


def _zero_mark(drawn: Drawn, scale: float) -> Options:
    """A wide stroke at cam angle 0, outside of all."""
    nearest = _reach(drawn, -0.03, 0.03) + 4.5 / scale
    for farther in range(0, 40, 2):
        start = nearest + farther / scale
        text = Label("0°", complex(start, 1.5 / scale), 2.5, layer="SYMBOL")
        yield 0.1 * farther, [line(complex(start), complex(start + 6.0 / scale), "EDGES"), text]


def _sense(drawn: Drawn, rotation: int, scale: float) -> Options:
    """An arrow in the sense of rotation around the view, on the lower right if there is room."""
    for number, middle in enumerate(np.radians([-49.0, -131.0, 49.0, 131.0, -30.0, 30.0])):
        first, last = middle - ARROW_SPAN, middle + ARROW_SPAN
        start, end = (first, last) if rotation > 0 else (last, first)
        least = max(_reach(drawn, first, last) + 5.0 / scale, LEAST_RADIUS / scale)
        for farther in range(0, 40, 4):
            radius = least + farther / scale
            begin, tip = cmath.rect(radius, start), cmath.rect(radius, end)
            way = 1j * rotation * tip / radius
            chord = way * cmath.exp(-1j * rotation * 1.5 / (radius * scale))
            head = moved([arrow(0j, chord, size=4.0)], tip, scale)
            yield 0.5 * number + 0.1 * farther, [arc(0j, begin, end - start, "EDGES"), *head]


def _plane(low: complex, high: complex, scale: float) -> list[Mark]:
    """The ends of the cutting plane A-A, with arrows in the direction of sight."""
    marks: list[Mark] = []
    for y, way in ((low.imag, -1.0), (high.imag, 1.0)):
        start = complex(0.0, y + way * (front.BEYOND + 0.5) / scale)
        end = start + 5j * way / scale
        marks.append(line(start, end, "SECTION"))
        tail = end - 9.0 / scale
        marks.append(line(tail, end, "SYMBOL"))
        marks += moved([arrow(0j, 1.0 + 0j, size=4.0)], end - 0.2 / scale, scale)
        at = tail - complex(1.0, (0.5 + 0.5 * way) * LETTER - 0.5 * way) / scale
        marks.append(Label("A", at, LETTER, "right", "SYMBOL"))
    return marks


def _flank(drawn: Drawn, scale: float, spec: DrawingSpec) -> Options:
    """The profile tolerance and the texture of the flanks, with a leader from above the view."""
    if spec.flank_tolerance is None and not spec.flank_surface:
        return
    points = _flank_edge(drawn).points(0.0005 * drawn.shape.size)
    above = drawn.box[1].imag + 4.0 / scale
    stated = {sense: _stated(drawn, sense, spec) for sense in (-1.0, 1.0)}
    for number, degrees in enumerate((120, 130, 110, 140, 150, 100, 70, 60, 50)):
        way = cmath.rect(1.0, math.radians(degrees))
        at = complex(points[np.argmin(np.abs(np.angle(points / way)))])
        head = moved([arrow(0j, -way, size=3.0)], at, scale)
        for higher in range(0, 60, 4):
            level = above + higher / scale
            knee = at + way * max((level - at.imag) / way.imag, 4.0 / scale)
            leader = line(at + 1.0 / scale * way, knee, "SYMBOL")
            own = moved(stated[math.copysign(1.0, way.real)], knee, scale)
            yield 0.3 * number + 0.1 * higher, [*head, leader, *own]


def _stated(drawn: Drawn, sense: float, spec: DrawingSpec) -> list[Mark]:
    """What the leader states, on the left or on the right of its end [mm of paper]."""
    shelf = sense * 4.0
    marks: list[Mark] = [line(0j, complex(shelf), "SYMBOL")]
    wide, flanks = 0.0, sum(edge.is_flank for edge in drawn.shape.edges)
    if spec.flank_tolerance is not None:
        value = f"{spec.flank_tolerance / MM_PER[drawn.unit]:.6f}"
        value = value.rstrip("0").rstrip(".")
        value = value.replace(".", ",") if spec.language == "de" else value
        names = ["A", "B"][: _datums(drawn)]
        wide = frame_width(value, names)
        corner = complex(shelf + min(sense * wide, 0.0), -0.5 * CELL)
        marks += tolerance_frame(corner, value, names)
        marks.append(Round(0j, ALL_AROUND, "SYMBOL"))
        if flanks > 1:
            marks.append(Label(f"{flanks}x", corner + 1j * (CELL + 1.0), 3.5, layer="SYMBOL"))
    if spec.flank_surface:
        size = width_of(spec.flank_surface, 2.5) + 6.0
        left = -max(size, 0.6 * wide) if sense < 0.0 else 9.0
        marks += texture(
            complex(shelf + left, 0.5 * CELL if wide else 0.0), spec.flank_surface, 2.5
        )
    return marks


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
    thick = shape.part.thickness
    bench = Bench(spec, unit, scale, shape.size)
    far = front.BEYOND / scale
    fixed: list[Mark] = [line(complex(-far), complex(thick + far), "CENTRE")]
    fixed += bevelled(drawn.cut, shape)
    fixed += dimensions.hole_centres(shape, scale)
    requests = [*dimensions.heights(shape, drawn.cut, drawn.box, bench),
                *dimensions.diameters(dimensions.turned(shape), thick, bench)]  # fmt: skip
    marks = settled(requests, fixed, scale, unit)
    top = ink_of(marks, scale, unit).extent[1].imag
    title = complex(0.5 * thick, max(top + 4.0, drawn.box[1].imag * scale + TITLE) / scale)
    marks.append(Label("A-A", title, LETTER, "centre", "SYMBOL"))
    return _cleared(marks, scale, unit)
