"""The program as a picture: the path of each tool over blank and part, one panel per operation."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, Literal

import numpy as np

from camgeo.design.product import Product, product_sides
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.milling.judged import Side, simulation_setup, toolpath_runs
from camgeo.milling.milling import mirrored_all
from camgeo.milling.moves import Course, Operation, Rapid, Stop, Toolpath, alike, feed_course
from camgeo.milling.plan import Cutting
from camgeo.numeric.arrays import ComplexArray, taken
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
    LINE,
    Area,
    Axis,
    Box,
    Entry,
    Figure,
    Fill,
    Frame,
    Legend,
    Line,
    Mark,
    Panel,
    Size,
    Style,
    Text,
    grid,
    over,
    plane,
)
from camgeo.units import MM_PER, LengthUnit

TOLERANCE: Final = 0.01
"""Tolerance of the paths [mm]: far below the width of a printed line."""

SIDE: Final = 3.8
"""Width and height [inch] of one panel, without its margins."""

MARGINS: Final = (0.65, 0.2, 0.35, 0.95)

GAPS: Final = (0.2, 0.2)

BLANK: Final = Fill("#f3efe6", "#8a7a55", 0.8, (4.0, 2.0))
PART: Final = Fill("#d5dce4", LINE, 0.8)
CLAMP: Final = Fill("#e3b7a0", "#8a4b2f", 0.8)

STYLES: Final[dict[Kind, Style]] = {
    "cut": Style(LINE, 0.9),
    "air": Style("#3c9a5f", 0.9, (3.0, 1.2)),
    "entry": Style(LIMIT, 1.6),
    "rapid": Style(AUXILIARY, 0.7, (1.0, 2.0)),
}

NAMES: Final[dict[Kind, str]] = {
    "cut": "cut",
    "air": "feed in air",
    "entry": "entry",
    "rapid": "traverse",
}

PLUNGE: Final = Style(LIMIT, 0.0, marker="v", size=4.5, face=LIMIT)

REACH: Final = 1.0
"""How far the picture reaches beyond the tool path, in diameters of the cutter."""


def figure(product: Product, size: Size | None = None) -> Figure:
    """The programs of `product` in its unit, seen from above as the work lies.

    Programs of a second side follow those of the first one.

    Raises
    ------
    GeometryError
        With the key of the scene, if it states no program.
    """
    if not product.scene.states_milling:
        raise GeometryError("names no tool: there is no program to draw", key="tool")
    operations = [
        operation for side in product_sides(product) for operation in _operation_views(side)
    ]
    columns = min(2, max(1, len(operations)))
    rows = max(1, math.ceil(len(operations) / columns))
    left, right, top, bottom = MARGINS
    default_size = (
        left + right + SIDE * (columns + GAPS[1] * (columns - 1)),
        top + bottom + SIDE * (rows + GAPS[0] * (rows - 1)),
    )
    size = default_size if size is None else size
    panels = tuple(
        _panel(operation, frame, product.unit)
        for operation, frame in zip(
            operations, grid(size, MARGINS, rows, columns, GAPS), strict=False
        )
    )
    plots = [operation.plot for operation in operations]
    kinds = [kind for kind in KINDS if any(plot.length(kind) > 0.0 for plot in plots)]
    entries = [Entry("blank", BLANK), Entry("part", PART)]
    if any(plot.operation.cut.obstacles for plot in plots):
        entries.append(Entry("clamp or screw", CLAMP))
    entries += [Entry(NAMES[kind], STYLES[kind]) for kind in kinds]
    legend = Legend(tuple(entries), "lower center", (0.5, 0.01), columns=len(entries))
    return Figure(size, panels, legend=legend)


@dataclass(frozen=True, slots=True, eq=False)
class _OperationView:
    """One operation of a side, with what is drawn behind it.

    Attributes
    ----------
    plot : its traces, in the part's coordinates [mm].
    ground : blank, and layers of the part from below, as the work lies, in the unit of the picture.
    seen : function from points of the part [mm] to the picture, as the work lies, in its unit.
    turned : whether the operation is on the second side.
    """

    plot: OperationPlot
    ground: tuple[Area, ...]
    seen: Callable[[ComplexArray], ComplexArray]
    turned: bool


def _operation_views(side: Product) -> Iterator[_OperationView]:
    """The operations of one side, in order."""
    milled = side.milled
    toolpath, spec, scale = milled.toolpath(TOLERANCE), milled.spec, 1.0 / MM_PER[side.unit]
    assert spec is not None  # for there is a program
    setup = simulation_setup(
        Side(milled.part, spec, milled.cuts, toolpath_runs(toolpath)), TOLERANCE
    )

    def seen(points: ComplexArray) -> ComplexArray:
        return mirrored_all(points, spec.turned) * scale

    blank = [seen(contour.points(TOLERANCE)) for contour in setup.blank]
    layers = [[seen(contour.points(TOLERANCE)) for contour in body.contours] for body in setup.part]
    ground = (_ground(blank, BLANK), *(_ground(rings, PART) for rings in _distinct(layers)))
    for plot in plot_operations(toolpath, setup.blank, setup.top, TOLERANCE):
        yield _OperationView(plot, ground, seen, bool(spec.turned))


def _panel(view: _OperationView, frame: Frame, unit: LengthUnit) -> Panel:
    """The panel of one operation, with room around the path for the reach of the cutter."""
    plot, scale = view.plot, 1.0 / MM_PER[unit]
    marks: list[Mark] = list(view.ground)
    for obstacle in plot.operation.cut.obstacles:
        ring = view.seen(obstacle.outline.arcs(TOLERANCE).contour.points(TOLERANCE))
        marks.append(Area((plane(ring),), CLAMP, layer=1.0))
    point_arrays = []
    for kind in KINDS:
        for trace in plot.traces:
            points = view.seen(trace.points)
            if trace.kind == kind:
                point_arrays.append(points)
                # A move along Z is a point in the plane: only a plunge is marked.
                still = bool(np.all(points == points[0]))
                style = PLUNGE if still else STYLES[kind]
                if not still or kind == "entry":
                    marks.append(Line(plane(points), style, layer=2.0 + 0.1 * KINDS.index(kind)))
    all_points = np.concatenate(point_arrays)
    middle = complex(
        0.5 * (np.max(all_points.real) + np.min(all_points.real)),
        0.5 * (np.max(all_points.imag) + np.min(all_points.imag)),
    )
    reach = REACH * plot.operation.tool.diameter * scale
    half = 0.5 * float(max(np.ptp(all_points.real), np.ptp(all_points.imag))) + reach
    marks.append(Line(over([0.0], [0.0]), Style("black", 0.0, marker="+"), layer=4.0))
    tool = plot.operation.tool
    lowest = min(move.end[2] for move in plot.operation.travel) * scale
    note = f"T{tool.number}, diameter {tool.diameter * scale:g} {unit}\ndown to Z {lowest:g}"
    behind = Box(0.2, 0.8)
    marks.append(Text(note, (0.02, 0.98), 7.5, of="panel", up="top", box=behind, layer=5.0))
    return Panel(
        frame,
        Axis((middle.real - half, middle.real + half), f"X [{unit}]"),
        Axis((middle.imag - half, middle.imag + half), f"Y [{unit}]"),
        tuple(marks),
        f"second side: {plot.operation.name}" if view.turned else plot.operation.name,
        title_size=10.0,
        equal=True,
    )


def _distinct(layers: list[list[ComplexArray]]) -> list[list[ComplexArray]]:
    """Layers without those that have the same rings as another one."""
    by_shape = {b"".join(ring.tobytes() for ring in rings): rings for rings in layers}
    return list(by_shape.values())


def _ground(rings: list[ComplexArray], fill: Fill) -> Area:
    """The area between rings, the largest around the others."""
    outer, *holes = sorted(rings, key=lambda ring: -float(np.ptp(ring.real)))
    return Area((plane(outer), *(plane(hole[::-1]) for hole in holes)), fill, layer=0.5)


# -- backplot -------------------------------------------------------------------------------------
# The tool path of a program as traces of points, one for each stretch in which the cutter does the
# same: for pictures.


Kind = Literal["cut", "air", "entry", "rapid"]

KINDS: Final[tuple[Kind, ...]] = ("rapid", "air", "cut", "entry")

JUDGED: Final = (0.01, 0.5, 0.99)
"""Shares of a piece at which the cutter is probed: if it is in air at all of them, the piece is."""


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """One stretch of the tool path in the plane.

    Attributes
    ----------
    kind : "rapid"; "entry" where the tip goes down at feed; "air" where the cutter is in no
        material; else "cut".
    points : complex [mm], at least two; two equal ones for a move along Z.
    """

    kind: Kind
    points: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class OperationPlot:
    """An operation with its traces, in order."""

    operation: Operation
    traces: tuple[Trace, ...]

    def length(self, kind: Kind) -> float:
        """Length [mm] in the plane of all traces of a kind."""
        point_arrays = (trace.points for trace in self.traces if trace.kind == kind)
        return float(sum(np.sum(np.abs(np.diff(points))) for points in point_arrays))


def plot_operations(
    toolpath: Toolpath, blank: Sequence[Contour], top: float, fineness: float
) -> tuple[OperationPlot, ...]:
    """The operations of a toolpath with their traces.

    Parameters
    ----------
    blank : contours of the blank; points inside an odd number of them are in material.
    top : Z of the blank's upper face [mm].
    fineness : largest deviation of chords [mm].
    """
    plots = []
    cleared: list[tuple[Course, float]] = []
    for operation in toolpath.operations:
        course = feed_course(operation.moves)
        radius = operation.tool.radius
        cutting = Cutting(course, radius, tuple(blank), top, tuple(cleared))
        traces = [*_feeds(cutting, fineness), *_rapids(operation)]
        plots.append(OperationPlot(operation, tuple(traces)))
        cleared.append(operation.swept)
    return tuple(plots)


def _feeds(cutting: Cutting, fineness: float) -> Iterator[Trace]:
    """Traces of feed moves; adjacent moves of one kind that join are one trace."""
    course = cutting.course
    first = alike(course)
    known: dict[int, Kind] = {}
    kinds: list[Kind] = []
    for piece in range(len(course)):
        if course.to_z[piece] < course.from_z[piece]:
            kinds.append("entry")
            continue
        # Further rounds coincide with the first one in the plane; if any of them cuts, the first
        # one does, so it decides for all.
        same = int(first[piece])
        if same not in known:
            known[same] = _kind(cutting, piece)
        kinds.append(known[same])
    gaps = np.concatenate(([0], np.cumsum(course.starts[1:] != course.ends[:-1]))).astype(int)
    keys = list(zip(kinds, gaps.tolist(), strict=False))
    for (kind, _), group in groupby(range(len(course)), key=lambda piece: keys[piece]):
        chain = taken(course, list(group))
        yield Trace(kind, np.concatenate((chain.starts[:1], chain.chords(fineness)[1])))


def _kind(cutting: Cutting, piece: int) -> Kind:
    if cutting.course.lengths[piece] == 0.0:
        return "air"
    return "cut" if any(cutting.angle(piece, share) for share in JUDGED) else "air"


def _rapids(operation: Operation) -> Iterator[Trace]:
    """Rapid moves in the plane; those along Z alone are no lines there."""
    position = None
    for move in operation.moves:
        if isinstance(move, Stop):
            continue
        end = complex(move.end[0], move.end[1])
        if isinstance(move, Rapid) and position is not None and position != end:
            yield Trace("rapid", np.array([position, end]))
        position = end
