"""Drawings as shops make them, with ezdxf, read back against the shape that each is known to show.

The shape is a stadium with a round bore: the points 5 mm from a segment, and 2 mm from a point.
These distances are the independent answer.
"""

from __future__ import annotations

import math
import random
import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from ezdxf.layouts.base import BaseLayout
from ezdxf.math import ConstructionArc, Matrix44, rational_bspline_from_arc

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import LengthUnit
from camgeo_export.dxf.reader import NEAR, READER
from tests.export.test_foreign_contours import GAP, along, drawn

Way = Callable[[BaseLayout], object]

HALF, RADIUS, BORE = 10.0, 5.0, 2.0
AREA = 4.0 * HALF * RADIUS + math.pi * RADIUS**2


def from_stadium(z: ComplexArray) -> FloatArray:
    """Signed distances [mm]."""
    return np.abs(z - np.clip(z.real, -HALF, HALF)) - RADIUS


def right(space: BaseLayout, **attributes: object) -> None:
    space.add_arc((HALF, 0.0), RADIUS, -90.0, 90.0, dxfattribs=attributes)


def left(space: BaseLayout, **attributes: object) -> None:
    space.add_arc((-HALF, 0.0), RADIUS, 90.0, 270.0, dxfattribs=attributes)


def top(space: BaseLayout, **attributes: object) -> None:
    space.add_line((HALF, RADIUS), (-HALF, RADIUS), dxfattribs=attributes)


def bottom(space: BaseLayout, **attributes: object) -> None:
    space.add_line((HALF, -RADIUS), (-HALF, -RADIUS), dxfattribs=attributes)


def bore(space: BaseLayout, **attributes: object) -> None:
    space.add_circle((0.0, 0.0), BORE, dxfattribs=attributes)


def stadium(space: BaseLayout, **attributes: object) -> None:
    for each in (bottom, right, left, top):
        each(space, **attributes)


def plate(space: BaseLayout, **attributes: object) -> None:
    stadium(space, **attributes)
    bore(space, **attributes)


def besides(extra: Way) -> Way:
    """The plate, and something else."""

    def draw(space: BaseLayout) -> None:
        plate(space)
        extra(space)

    return draw


def lines(*ends: tuple[float, float, float, float]) -> Way:
    return besides(lambda space: [space.add_line(each[:2], each[2:]) for each in ends])


def comb(space: BaseLayout) -> None:
    for k in range(40):
        space.add_line((k, 20.0), (k + 1.0, 20.0))
        space.add_line((k, 20.0), (k, 21.0))


def bridge(space: BaseLayout) -> None:
    """A line from the bore, of two arcs, to a corner of the outline."""
    stadium(space)
    space.add_arc((0, 0), BORE, 0, 180)
    space.add_arc((0, 0), BORE, 180, 360)
    space.add_line((BORE, 0.0), (HALF, RADIUS))


def hidden(name: str, **state: bool) -> Way:
    """A frame on a layer that is not shown."""

    def draw(space: BaseLayout) -> None:
        plate(space)
        layer = (
            space.doc.layers.get(name) if name in space.doc.layers else space.doc.layers.add(name)
        )
        if state.get("off"):
            layer.off()
        if state.get("frozen"):
            layer.freeze()
        space.add_circle((0.0, 0.0), 4.0, dxfattribs={"layer": name.swapcase()})
        space.add_line((-HALF, RADIUS), (HALF, -RADIUS), dxfattribs={"layer": name})

    return draw


def paper(space: BaseLayout) -> None:
    plate(space)
    space.doc.paperspace().add_circle((0.0, 0.0), 30.0)


def on_cut(space: BaseLayout) -> None:
    """The layer of what is cut, in lower case as some programs write it, and a frame."""
    plate(space, layer="cut")
    space.add_lwpolyline([(-90, -90), (90, -90), (90, 90), (-90, 90)], close=True)


def rational(degree: int) -> Way:
    """The ends as rational splines, of a higher degree if asked for."""

    def draw(space: BaseLayout) -> None:
        bottom(space)
        top(space)
        bore(space)
        for x, start in ((HALF, -90.0), (-HALF, 90.0)):
            arc = ConstructionArc((x, 0.0), RADIUS, start, start + 180.0)
            curve = rational_bspline_from_arc((x, 0.0), RADIUS, arc.start_angle, arc.end_angle)
            curve = curve.degree_elevation(degree - 2) if degree > 2 else curve
            space.add_spline().apply_construction_tool(curve)

    return draw


def round_ellipses(space: BaseLayout) -> None:
    bottom(space)
    top(space)
    space.add_ellipse((0, 0), (0.0, BORE), 1.0)
    space.add_ellipse((HALF, 0), (RADIUS, 0.0), 1.0, -0.5 * math.pi, 0.5 * math.pi)
    space.add_ellipse((-HALF, 0), (0.0, -RADIUS), 1.0, math.pi, 2.0 * math.pi)


def straight_splines(space: BaseLayout) -> None:
    """The lines as a spline of degree 1, and as one through points."""
    right(space)
    left(space)
    bore(space)
    space.add_open_spline([(HALF, RADIUS), (1.0, RADIUS), (-HALF, RADIUS)], degree=1)
    space.add_spline([(-HALF, -RADIUS), (3.0, -RADIUS), (HALF, -RADIUS)])


def heavy(flags: int, kinds: tuple[int, ...]) -> Way:
    """A POLYLINE with bulges that is marked as fitted, some of its vertices being of the frame."""

    def draw(space: BaseLayout) -> None:
        bore(space)
        corners = CORNERS.copy()
        for kind in kinds:
            corners.insert(2, (99.0, float(kind), 0.0))
        drawn = space.add_polyline2d(corners, format="xyb", close=True)
        drawn.dxf.flags |= flags
        for vertex in drawn.vertices:
            if vertex.dxf.location.x == 99.0:
                vertex.dxf.flags = int(vertex.dxf.location.y)

    return draw


def block(draw: Way, insert: Way) -> Way:
    """Something as a block."""

    def drawn(space: BaseLayout) -> None:
        draw(space.doc.blocks.new("Plate", base_point=(3.0, 4.0)))
        insert(space)

    return drawn


DOWN = {"extrusion": (0.0, 0.0, -1.0)}
"""Of what is drawn from below."""


def turned_back(space: BaseLayout) -> None:
    """The block was drawn turned, scaled and away from its place."""
    space.add_blockref(
        "PLATE", (3.0 + 12.0, 4.0 + 5.0), {"rotation": -30.0, "xscale": 0.5, "yscale": 0.5}
    )


def turned_plate(space: BaseLayout) -> None:
    there = Matrix44.translate(-15.0, -9.0, 0.0) @ Matrix44.z_rotate(math.radians(30.0))
    plate(space)
    for entity in space:
        entity.transform(there @ Matrix44.scale(2.0) @ Matrix44.translate(3.0, 4.0, 0.0))


def nested(space: BaseLayout) -> None:
    plate(space.doc.blocks.new("inner"))
    space.doc.blocks.new("outer").add_blockref("INNER", (7.0, 8.0), {"xscale": -1.0})
    space.add_blockref("Outer", (7.0, -8.0), {"xscale": -1.0})


def rows(space: BaseLayout) -> None:
    """The line of the top and that of the bottom as an array of one."""
    bottom(space.doc.blocks.new("side"))
    grid = {"row_count": 2, "row_spacing": 2.0 * RADIUS, "column_count": 1}
    space.add_blockref("side", (0.0, 0.0), grid)
    right(space)
    left(space)
    bore(space)


def layer_of_insert(space: BaseLayout) -> None:
    """Entities on layer 0 of a block lie on that of the insertion."""
    plate(space.doc.blocks.new("part"))
    space.doc.layers.add("HID").freeze()
    space.add_blockref("part", (0, 0), {"layer": "cut"})
    space.add_blockref("part", (5, 0), {"layer": "hid"})
    space.add_blockref("part", (90, 0), {"layer": "OTHER"})


def squashed(space: BaseLayout) -> None:
    """Circles in a block that is stretched threefold along y, squashed as ellipses there."""
    inner = space.doc.blocks.new("squashed")
    third = 1.0 / 3.0
    inner.add_line((HALF, RADIUS * third), (-HALF, RADIUS * third))
    inner.add_line((HALF, -RADIUS * third), (-HALF, -RADIUS * third))
    inner.add_ellipse((0, 0), (BORE, 0.0), third)
    inner.add_ellipse((HALF, 0), (RADIUS, 0.0), third, -0.5 * math.pi, 0.5 * math.pi)
    inner.add_ellipse((-HALF, 0), (RADIUS, 0.0), third, 0.5 * math.pi, 1.5 * math.pi)
    space.add_blockref("squashed", (0, 0), {"yscale": 3.0})


def stretched_arcs(space: BaseLayout) -> None:
    """The same bore of two arcs, twice stretched: back to a circle."""
    inner = space.doc.blocks.new("bore")
    inner.add_arc((0, 0), BORE, 10, 190)
    inner.add_arc((0, 0), BORE, 190, 10)
    space.doc.blocks.new("flat").add_blockref("bore", (0, 0), {"yscale": 0.25})
    space.add_blockref("flat", (0, 0), {"yscale": 4.0})
    stadium(space)


def shuffled(space: BaseLayout) -> None:
    """The outline in 64 pieces in any order and any direction, with the gaps of four decimals."""
    pieces = []
    corners = [complex(-HALF + 20.0 * k / 32, -RADIUS) for k in range(33)]
    pieces += list(pairwise(corners))
    pieces += [(-a, -b) for a, b in pieces]
    draw = random.Random(5)
    draw.shuffle(pieces)
    for a, b in pieces:
        first, last = (a, b) if draw.random() < 0.5 else (b, a)
        ends = [(round(z.real, 4) + 1e-4 * draw.random(), z.imag) for z in (first, last)]
        space.add_line(*ends)
    right(space)
    left(space)
    bore(space)


CORNERS = [(-HALF, -RADIUS, 0.0), (HALF, -RADIUS, 1.0), (HALF, RADIUS, 0.0), (-HALF, RADIUS, 1.0)]


def mirrored(space: BaseLayout) -> None:
    """Drawn from below."""
    space.add_lwpolyline(CORNERS, format="xyb", close=True, dxfattribs=DOWN)
    space.add_circle((0.0, 0.0), BORE, dxfattribs=DOWN)


def annotated(space: BaseLayout) -> None:
    space.add_text("DRAWN BY")
    space.add_mtext("not to scale")
    space.add_point((0.0, 0.0))
    space.add_linear_dim((0, 9), (-HALF, RADIUS), (HALF, RADIUS)).render()
    space.add_hatch().paths.add_polyline_path([(-9, -4), (9, -4), (9, 4)], is_closed=True)
    space.add_solid([(0, 0), (1, 0), (0, 1)])


@dataclass(frozen=True)
class Case:
    """A way to draw the plate.

    Attributes
    ----------
    draw : it.
    note : what is told of the rest; "" for nothing.
    within : of the shape [mm].
    layer : asked for.
    version : of the format.
    """

    draw: Way
    note: str = ""
    within: float = 1e-12
    layer: str | None = None
    version: str = "R2010"


LEFT = r"left out: [A-Z]+ in line \d+"
LOOSE, BRANCH = f"{LEFT} has a loose end at", f"{LEFT} meets more than one other piece at"
TWICE = f"{LEFT} is drawn a second time at"

CASES = {
    "nothing else": Case(plate),
    "R12": Case(plate, version="R12"),
    "loose line at a corner": Case(lines((HALF, RADIUS, 30, 5)), rf"1 piece {LOOSE} \(30, 5\) mm$"),
    "loose line away": Case(lines((40, 40, 50, 50)), f"1 piece {LOOSE}"),
    "centre lines": Case(lines((-30, 0, 30, 0), (0, -30, 0, 30)), f"2 pieces {LOOSE}"),
    "lines that cross the outline": Case(lines((-9, -9, 9, 9), (0, 9, 1, -9)), f"2 pieces {LOOSE}"),
    "cross in the bore": Case(lines((-1, 0, 1, 0), (0, -1, 0, 1)), f"2 pieces {LOOSE}"),
    "chord": Case(lines((HALF, RADIUS, HALF, -RADIUS)), f"1 piece {BRANCH}"),
    "two chords": Case(
        lines((HALF, RADIUS, HALF, -RADIUS), (-HALF, RADIUS, -HALF, -RADIUS)), f"2 pieces {BRANCH}"
    ),
    "star of lines": Case(
        lines(*((0, 0, x, y) for x in (-HALF, HALF) for y in (-RADIUS, RADIUS))),
        f"4 pieces {BRANCH}",
    ),
    "bridge to the bore": Case(bridge, f"1 piece {BRANCH}"),
    "leader": Case(besides(lambda s: s.add_lwpolyline([(0, 9), (3, 20), (9, 20)])), "1 piece"),
    "tick along the outline": Case(lines((HALF, RADIUS, 12, RADIUS)), f"1 piece {LOOSE}"),
    "tree of lines": Case(besides(comb), f"80 pieces {LOOSE}"),
    "line of no length": Case(lines((HALF, RADIUS, HALF, RADIUS))),
    "line twice": Case(besides(top), f"1 piece {TWICE}"),
    "line three times": Case(
        besides(lambda s: [each(s) for each in (top, top)]), f"2 pieces {TWICE}"
    ),
    "line twice, reversed": Case(lines((-HALF, RADIUS, HALF, RADIUS)), f"1 piece {TWICE}"),
    "arc twice, mirrored": Case(
        besides(lambda s: s.add_arc((HALF, 0), RADIUS, -90, 90, dxfattribs=DOWN)),
        f"1 piece {TWICE}",
    ),
    "all twice": Case(besides(plate), f"5 pieces {TWICE}"),
    "bore as circle and polyline": Case(
        besides(lambda s: s.add_lwpolyline([(0, 2, 1), (0, -2, 1)], format="xyb", close=True)),
        "1 piece left out: LWPOLYLINE in line .* second time",
    ),
    "line over part of a line": Case(lines((HALF, RADIUS, 0, RADIUS)), f"1 piece {LOOSE}"),
    "layer off": Case(hidden("Constr", off=True), "2 entities not read .* on layer Constr$"),
    "layer frozen": Case(hidden("CONSTR", frozen=True), "2 entities not read .* on layer CONSTR$"),
    "Defpoints": Case(hidden("Defpoints"), "2 entities not read .* on layer Defpoints$"),
    "invisible": Case(
        besides(lambda s: s.add_circle((0, 0), 4.0, dxfattribs={"invisible": 1})),
        "1 entity not read .* on layer 0$",
    ),
    "paper space": Case(paper),
    "layer cut": Case(on_cut),
    "layer by any case": Case(on_cut, layer="Cut"),
    "rational arcs": Case(rational(2), "2 SPLINE followed by cubics within 1e-07 mm", NEAR),
    "rational arcs of degree 4": Case(rational(4), "2 SPLINE followed by cubics", NEAR),
    "round ellipses": Case(round_ellipses),
    "straight splines": Case(straight_splines, "1 SPLINE followed by cubics"),
    "fitted polyline": Case(heavy(2, ())),
    "splined polyline": Case(heavy(4, (16, 17))),
    "block": Case(block(plate, lambda s: s.add_blockref("PLATE", (3, 4)))),
    "block, turned, scaled": Case(block(turned_plate, turned_back)),
    "blocks in blocks, mirrored": Case(nested),
    "block in rows": Case(rows),
    "layer of the insertion": Case(layer_of_insert, "on layer HID$", layer="CUT"),
    "stretched ellipses": Case(squashed),
    "stretched arcs": Case(stretched_arcs),
    "shuffled pieces with gaps": Case(shuffled, within=1.1e-4),
    "mirrored": Case(mirrored),
    "annotated": Case(besides(annotated), "not read: .*HATCH"),
    "unknown block": Case(
        besides(lambda s: s.add_blockref("GONE", (0, 0))),
        r"line \d+: INSERT inserts a block that is not there: 'GONE'; left out",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_plate_is_read_however_it_is_drawn(name: str) -> None:
    case = CASES[name]
    data = drawn(case.draw, case.version)
    unit: LengthUnit | None = "mm" if case.version == "R12" else None
    found = READER.read(data, "a.dxf", layer=case.layer, unit=unit, gap=GAP)
    big, small = found.contours
    assert np.max(np.abs(from_stadium(along(big)))) <= case.within + 1e-8 * (case.within == NEAR)
    assert np.max(np.abs(np.abs(along(small)) - BORE)) <= 1e-12
    assert big.area == pytest.approx(AREA, abs=40.0 * case.within + 1e-10)
    assert small.area == pytest.approx(math.pi * BORE**2, rel=1e-12)
    assert (found.followed == NEAR) == ("followed by" in case.note)
    told = "\n".join(found.notes)
    if case.note:
        assert re.search(case.note, told), told
    else:
        assert told == ""
