"""Cuts made of a part's walls, a tool and heights."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from camgeo.curve.working_curve import WorkingCurve
from camgeo.outline.envelope import Envelope
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Boundary, Wall
from camgeo.toolpath.bench import Bench, flank_curve
from camgeo.toolpath.cut import MOST_SLACK, AreaCut, ContourCut, PointCut, passes, slack_of
from camgeo.toolpath.stock import ROUND
from camgeo.toolpath.tool import Tool, ToolError

LOOPS: Final = 0.5
LARGEST_LOOPS: Final = 0.9
"""Radius of the loops of a trochoidal slot, as a share of that within which the cutter is flat:
usually, and at most, so that no core is left in them.
"""


def rough_around(bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float) -> ContourCut:
    """Around a wall in passes, in full material: the cutter enters along its path."""
    boundary, slack = wall.boundary, slack_of(allowance)
    return ContourCut(
        name=f"rough {boundary.name}",
        strategy="slot",
        tool=tool,
        top=top,
        depths=depths_of(tool, top, bench.bottom(wall)),
        allowance=allowance,
        centre=boundary.offset(tool.radius + allowance + slack),
        right=boundary.name,
        slack=slack,
    )


def rough_outside(
    bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float
) -> AreaCut | ContourCut:
    """Around a wall that cuts the part free: from a round blank all beside it is cleared; from a
    plate, where no spiral leads there, and where tabs need a frame to hold on to, a slot is cut.
    """
    holding = bench.milling.holding
    framed = holding is not None and holding.tabs is not None
    if framed or bench.milling.stock.shape != ROUND or wall.boundary.hole:
        return rough_around(bench, wall, tool, top, allowance)
    cleared = clear_outside(bench, wall, tool, top, allowance)
    if cleared is not None:
        return cleared
    note = "no spiral clears its hollows: a slot leaves the waste in one piece"
    return replace(rough_around(bench, wall, tool, top, allowance), note=note)


def clear_outside(
    bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float
) -> AreaCut | None:
    """All between a wall and the known outline of the blank; None if no spiral leads there."""
    from camgeo.toolpath.strategies.outside import spirals  # few outlines of blanks are known

    name, bottom = f"rough {wall.boundary.name}", bench.bottom(wall)
    made = clear_area(bench, name, "rough", tool, top, bottom, (wall.boundary,), allowance)
    return made if spirals(made, wall.boundary, MOST_SLACK) else None


def loops_along(
    bench: Bench, wall: Wall, other: Wall | None, tool: Tool, top: float, allowance: float
) -> AreaCut:
    """Along a wall by loops, in a slot wider than the cutter by `LOOPS`.

    `other` is the flank across a groove: the slot is as wide as that, less both allowances, if
    loops make it at once.
    """
    boundary, bottom = wall.boundary, bench.bottom(wall)
    flat = tool.radius - tool.corner_radius
    slot, walls = 2.0 * (tool.radius + LOOPS * flat), [boundary]
    if other is not None:
        groove = 2.0 * (abs(flank_curve(wall).distance) - allowance)
        if groove <= 2.0 * (tool.radius + LARGEST_LOOPS * flat):
            slot, walls = groove, [boundary, other.boundary]
    return AreaCut(
        name=f"rough {boundary.name}",
        strategy="trochoid",
        tool=tool,
        top=top,
        depths=depths_of(tool, top, bottom),
        allowance=allowance,
        walls=tuple(walls),
        stepover=stepover_of(tool),
        slot=slot,
    )


def finish_along(
    bench: Bench,
    wall: Wall,
    tool: Tool,
    top: float,
    room: float,
    *,
    rest: float = 0.0,
    depths: tuple[float, ...] = (),
    cleared: bool = True,
    springs: int = 1,
    compensation: str = "",
    note: str = "",
) -> ContourCut:
    """Along a roughed wall at full depth, or at `depths`; what is beside it is cleared."""
    boundary = wall.boundary
    return ContourCut(
        name=boundary.name,
        strategy="profile",
        tool=tool,
        top=top,
        depths=depths or (bench.bottom(wall),),
        centre=boundary.offset(tool.radius),
        right=boundary.name,
        room=room,
        rest=rest,
        cleared=cleared,
        springs=springs,
        compensation=compensation or bench.compensation,
        note=note,
    )


def slot_between(bench: Bench, inner: Wall, outer: Wall, tool: Tool, top: float) -> ContourCut:
    """Between both flanks, with a cutter as wide as the groove."""
    pitch = flank_curve(outer).pitch
    path = Path(Envelope(WorkingCurve(pitch, 0.0)).elements)
    return ContourCut(
        name="groove",
        strategy="slot",
        tool=tool,
        top=top,
        depths=depths_of(tool, top, bench.bottom(outer)),
        centre=CurveBoundary("path of the cutter along the groove", hole=True, path=path),
        right=outer.boundary.name,
        left=inner.boundary.name,
    )


def clear_area(
    bench: Bench,
    name: str,
    strategy: str,
    tool: Tool,
    top: float,
    bottom: float,
    walls: tuple[Boundary, ...],
    allowance: float = 0.0,
) -> AreaCut:
    """All between walls and, unless a hole encloses it, the outline of the blank."""
    stock = bench.milling.stock
    inside = any(wall.hole for wall in walls)
    has_hole = stock.bore is not None and (inside or not walls)
    return AreaCut(
        name=name,
        strategy=strategy,
        tool=tool,
        top=top,
        depths=depths_of(tool, top, bottom),
        allowance=allowance,
        walls=walls,
        stock=None if inside else stock.outline,
        cleared=(stock.hole,) if has_hole else (),
        stepover=stepover_of(tool),
    )


def drill_at(name: str, tool: Tool, top: float, bottom: float, place: complex) -> PointCut:
    """Straight down, in pecks of the tool's stepdown if it states one."""
    depths = passes(top, bottom - tool.tip_length, tool.stepdown)
    return PointCut(name=name, strategy="drill", tool=tool, top=top, depths=depths, points=(place,))


def depths_of(tool: Tool, top: float, bottom: float) -> tuple[float, ...]:
    """Z of equal passes [mm]; raises ToolError without a stepdown."""
    if tool.stepdown is None:
        message = f"tool {tool.number} states no stepdown to cut {top - bottom:g} mm deep"
        raise ToolError(message, tool, "stepdown")
    return passes(top, bottom, tool.stepdown)


def stepover_of(tool: Tool) -> float:
    """Between neighbouring paths [mm]; raises ToolError if it is not stated."""
    if tool.stepover is None:
        message = f"tool {tool.number} states no stepover to clear an area; none is invented"
        raise ToolError(message, tool, "stepover")
    return tool.stepover
