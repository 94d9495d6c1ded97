"""A planned toolpath as a simulation judges it: its runs, and the setup that it starts from."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Boundary, Part
from camgeo.toolpath.course import course_of
from camgeo.toolpath.cut import AreaCut, ContourCut
from camgeo.toolpath.holding import FIXTURE, Holding, Obstacle
from camgeo.toolpath.moves import Point, Toolpath
from camgeo.toolpath.simulation import Run, Setup
from camgeo.toolpath.stages import Body
from camgeo.toolpath.stock import Stock
from camgeo.toolpath.tool import DRILL, END_MILL

RIM: Final = 1.0
"""Width [mm] of the strip along the outline of a blank by which waste is taken to be held."""

UNKNOWN: Final = 2.0
"""Diameters of the cutter by which a blank of unknown outline reaches beyond the course."""


def runs_of(toolpath: Toolpath) -> tuple[Run, ...]:
    """The operations as they run one after the other."""
    found = []
    at: Point | None = None
    for operation in toolpath.operations:
        tool = operation.tool
        shank = None
        if tool.shank_diameter is not None and tool.flute_length is not None:
            shank = (0.5 * tool.shank_diameter, tool.flute_length)
        found.append(
            Run(
                operation.name,
                operation.moves,
                tool.radius,
                0.0 if tool.kind == END_MILL else tool.tip_length,
                tool.plunges or tool.kind == DRILL,
                shank,
                tuple(_body(each) for each in operation.cut.obstacles),
                at,
            )
        )
        at = operation.travel[-1].end
    return tuple(found)


def setup_of(
    toolpath: Toolpath, part: Part, stock: Stock, holding: Holding | None, tolerance: float
) -> Setup:
    """What the program starts from, and the part that must come of it, within `tolerance` [mm].

    A bore with a keyway counts as round: a round cutter leaves the keyway to be broached. Without
    a holding nothing is said of pieces that come loose.
    """
    bodies = tuple(
        Body(
            layer.name,
            layer.z0,
            layer.z1,
            tuple(_contour(each, tolerance) for each in layer.boundaries),
        )
        for layer in part.layers
    )
    low, high = part.layers[0].z0, part.layers[-1].z1
    outline, rim = _blank(toolpath, part, stock, tolerance)
    blank = [outline]
    if stock.bore is not None:
        blank.append(Contour.circle(0.5 * stock.bore))
    joined = [low] if stock.bottom > 0.0 else []
    held = None
    lowest = None
    if holding is not None:
        held = [rim, *(_clamped(each.obstacle) for each in holding.clamps)]
        if holding.kind == FIXTURE:
            held.append(bodies[0].contours)
        if holding.tabs is not None:
            joined.append(low + holding.tabs.height)
        if holding.skin is not None:
            joined.append(low + holding.skin)
        lowest = low - max(holding.through, 0.0)
    return Setup(
        tuple(blank),
        high + stock.top,
        low - stock.bottom,
        bodies,
        None if held is None else tuple(held),
        lowest,
        max(joined, default=None),
    )


def _contour(boundary: Boundary, tolerance: float) -> Contour:
    core = boundary.core if isinstance(boundary, ExactBoundary) else None
    return boundary.arcs(tolerance, "fast").contour if core is None else core


def _body(obstacle: Obstacle) -> Body:
    contour = obstacle.outline.arcs(RIM, "fast").contour
    return Body(obstacle.name, -np.inf, obstacle.top, (contour,))


def _clamped(obstacle: Obstacle) -> tuple[Contour, ...]:
    return _body(obstacle).contours


def _blank(
    toolpath: Toolpath, part: Part, stock: Stock, tolerance: float
) -> tuple[Contour, tuple[Contour, ...]]:
    """The outline of the blank, and the strip along it.

    Where it is not known it is the outermost boundary of the part, if nothing cuts that one, else
    a square around all.
    """
    if stock.diameter is not None:
        radius = 0.5 * stock.diameter
        outline = Contour.circle(radius, stock.centre)
        inner = Contour.circle(max(radius - RIM, 0.5 * radius), stock.centre)
        return outline, (outline, inner)
    if stock.length is not None and stock.width is not None:
        corner, centre = 0.5 * complex(stock.length, stock.width), stock.centre
    elif part.boundaries[0].name not in _produced(toolpath):
        outline = _contour(part.boundaries[0], tolerance)
        share = 1.0 - RIM / float(np.max(np.abs(outline.vertices)))
        inner = Contour(share * outline.vertices, outline.sweeps, share * outline.centres)
        return outline, (outline, inner)
    else:
        ends = [complex(x, y) for x, y, _ in _places(toolpath)]
        reach = max(abs(complex(max(abs(p.real), abs(p.imag)))) for p in ends or [0j])
        wide = UNKNOWN * max((each.tool.diameter for each in toolpath.operations), default=0.0)
        corner, centre = (reach + wide) * (1.0 + 1.0j), 0j
    outline = _rectangle(corner, centre)
    return outline, (outline, _rectangle(corner - RIM * (1.0 + 1.0j), centre))


def _produced(toolpath: Toolpath) -> set[str]:
    """Names of the boundaries that the program cuts."""
    found: set[str] = set()
    for operation in toolpath.operations:
        cut = operation.cut
        if isinstance(cut, ContourCut):
            found |= {cut.right, cut.left}
        elif isinstance(cut, AreaCut):
            found |= {wall.name for wall in cut.walls}
    return found


def _places(toolpath: Toolpath) -> list[Point]:
    """Ends of all feed moves."""
    found: list[Point] = []
    for operation in toolpath.operations:
        course = course_of(operation.moves)
        found += [(end.real, end.imag, 0.0) for end in course.ends.tolist()]
    return found


def _rectangle(corner: complex, centre: complex) -> Contour:
    corners = np.array([-corner, corner.conjugate(), corner, -corner.conjugate()])
    return Contour.polygon(centre + corners)
