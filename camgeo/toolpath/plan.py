"""The milling program of a part: operations in depth passes, leads, safe heights."""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.arcs.fast import fit_arcs
from camgeo.contour.arcs.fewest import fewest_arcs
from camgeo.contour.contour import Contour
from camgeo.contour.fit import Effort
from camgeo.contour.simple import require_simple
from camgeo.errors import GeometryError, UndercutError
from camgeo.toolpath.leads import Lead, quarter_circle_lead, start_tangent, started
from camgeo.toolpath.moves import ArcFeed, Feed, Move, Operation, Rapid, Toolpath
from camgeo.toolpath.paths import CutterPath
from camgeo.toolpath.spec import GcodeSpec

HALF_TURN = math.pi
"""No arc of a program exceeds half a turn: the rules of controllers grow strict beyond it."""


def plan_toolpath(
    paths: tuple[CutterPath, ...], spec: GcodeSpec, tolerance: float, effort: Effort = "fewest"
) -> Toolpath:
    """The whole program; its arcs lie within `tolerance` [mm] of the exact cutter paths.

    Cut so that the cutter climbs (spindle clockwise): clockwise round the outside of material,
    counter-clockwise round the inside of a hole.
    """
    return Toolpath(
        tool_number=spec.tool_number,
        tool_diameter=spec.tool_diameter,
        spindle_speed=spec.spindle_speed,
        safe_height=spec.safe_height,
        operations=tuple(_operation(path, spec, tolerance, effort) for path in paths),
    )


def path_contour(path: CutterPath, tolerance: float, effort: Effort = "fewest") -> Contour:
    """The cutter's closed path as lines and arcs within `tolerance` [mm], counter-clockwise.

    Raises
    ------
    GeometryError
        With key "output.gcode.tool_diameter", if the cutter does not reach the whole flank.
    """
    if path.path is None:
        assert path.circle is not None  # a path is one or the other
        return path.circle
    try:
        fit = fit_arcs if effort == "fast" else fewest_arcs
        contour = fit(path.path, tolerance).contour
        require_simple(contour, f"path of the cutter along the {path.name}")
    except UndercutError as error:
        raise GeometryError(
            f"the cutter is too large for the {path.name}: a concave part of it bends more tightly"
            f" than the cutter ({error.message})",
            key="output.gcode.tool_diameter",
        ) from None
    return contour


def _operation(path: CutterPath, spec: GcodeSpec, tolerance: float, effort: Effort) -> Operation:
    contour = path_contour(path, tolerance, effort)
    if path.free_side > 0:
        contour = contour.reversed()
    longest = int(np.argmax(contour.lengths))
    contour = started(contour, longest).split(HALF_TURN)
    lead = _lead(path, contour)
    depths = _depths(path.depth, spec.pass_depth)
    moves: list[Move] = []
    first = lead.start if lead else complex(contour.vertices[0])
    above = Rapid((first.real, first.imag, spec.safe_height))
    for z in depths:
        if lead is not None or not moves:
            moves.append(above)
        moves.append(Feed((first.real, first.imag, z), spec.plunge_feed))
        moves += _round(contour, lead, z, spec.feed)
        if lead is not None or z == depths[-1]:
            x, y, _ = moves[-1].end
            moves.append(Rapid((x, y, spec.safe_height)))
    return Operation(path.name, depths, tuple(moves), path.note)


def _lead(path: CutterPath, contour: Contour) -> Lead | None:
    if path.free_side == 0:
        return None
    point, tangent = complex(contour.vertices[0]), start_tangent(contour)
    # Travelled clockwise the outside is on the left, counter-clockwise the inside is.
    side = 1j * tangent
    return quarter_circle_lead(contour, point, tangent, side, path.room)


def _round(contour: Contour, lead: Lead | None, z: float, feed: float) -> list[Move]:
    """Lead-in, once round, lead-out at one depth."""
    start = complex(contour.vertices[0])
    moves: list[Move] = []
    if lead:
        centre = (lead.centre.real, lead.centre.imag)
        moves.append(ArcFeed((start.real, start.imag, z), centre, lead.ccw, feed))
    for end, sweep, middle in zip(contour.ends, contour.sweeps, contour.centres, strict=True):
        point = (float(end.real), float(end.imag), z)
        if sweep == 0.0:
            moves.append(Feed(point, feed))
        else:
            about = (float(middle.real), float(middle.imag))
            moves.append(ArcFeed(point, about, bool(sweep > 0.0), feed))
    if lead:
        moves.append(ArcFeed((lead.end.real, lead.end.imag, z), centre, lead.ccw, feed))
    return moves


def _depths(depth: float, pass_depth: float | None) -> tuple[float, ...]:
    """Equal passes of at most `pass_depth`, the last at full depth exactly."""
    count = 1 if pass_depth is None else max(1, math.ceil(depth / pass_depth * (1.0 - 1e-12)))
    return (*(-depth * (k + 1) / count for k in range(count - 1)), -depth)
