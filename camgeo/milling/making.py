"""Cuts made of a part's walls, a tool and heights."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.envelope import Envelope
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.milling.bench import COARSE, SAME, Bench, as_wide, bore_of, flank_curve, is_open
from camgeo.milling.cut import (
    MOST_SLACK,
    AreaCut,
    ContourCut,
    Cut,
    LetterCut,
    LineCut,
    PointCut,
    slack_of,
)
from camgeo.milling.milling import END_MILL, Tool, ToolError
from camgeo.milling.strategies.marks import unfit_for_letters
from camgeo.numeric.checked import positive
from camgeo.part.boundaries import CurveBoundary, ExactBoundary, largest_radius
from camgeo.part.part import Boundary, Wall
from camgeo.part.spec import text_of

MOST_PASSES: Final = 1_000
"""Of one cut; a pass thinner than a thousandth of a part is a typing error."""

BESIDE: Final = 1.25
"""Diameters of the widest cutter that are cleared beside the disc: a slot, and an allowance."""


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
    if framed or bench.milling.stock.diameter is None or wall.boundary.hole:
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
    from camgeo.milling.strategies.clear import spirals  # few outlines of blanks are known

    name, bottom = f"rough {wall.boundary.name}", bench.bottom(wall)
    made = clear_area(bench, name, "rough", tool, top, bottom, (wall.boundary,), allowance)
    return made if spirals(made, wall.boundary, MOST_SLACK) else None


def clear_around(bench: Bench, wall: Wall, tool: Tool, top: float, allowance: float) -> AreaCut:
    """Around what stands on the disc, down to the face that it stands on: all of a blank whose
    outline is known, else as far as cutters go that lay the disc free.
    """
    name, bottom = f"rough {wall.boundary.name}", bench.bottom(wall)
    strategy, walls = "rough", [wall.boundary]
    if bench.milling.stock.outline is None:
        disc = bench.part.outermost.arcs(COARSE, "fast")
        widest = max(each.diameter for each in bench.milling.tools if each.kind == END_MILL)
        radius = largest_radius(disc.contour) + disc.deviation + BESIDE * widest
        edge = ExactBoundary("edge of what is cleared", hole=True, exact=Contour.circle(radius))
        strategy, walls = "moat", [wall.boundary, edge]
    return clear_area(bench, name, strategy, tool, top, bottom, tuple(walls), allowance)


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


LOOPS: Final = 0.5


LARGEST_LOOPS: Final = 0.9
"""Radius of the loops of a trochoidal slot, as a share of that within which the cutter is flat:
usually, and at most, so that no core is left in them.
"""


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


def drill_all(
    name: str, tool: Tool, top: float, bottom: float, holes: Mapping[str, complex]
) -> PointCut:
    """Straight down in each of the `holes`, places [mm] by the names of their boundaries."""
    depths = passes(top, bottom - tool.tip_length, tool.stepdown)
    places = tuple(holes.values())
    return PointCut(
        name=name, strategy="drill", tool=tool, top=top, depths=depths, points=places,
        holes=tuple(holes),
    )  # fmt: skip


def no_engraver(bench: Bench, tool: Tool, walls: Sequence[Wall]) -> str:
    """Why a tool does not make a mark in one pass, or the letters of a text; empty if it does."""
    wall = walls[0]
    if text_of(wall.boundary.name):
        reason = "" if is_open(bench.part, wall) else "they are not open on this face"
        reason = reason or unfit_for_letters(tool, [each.boundary for each in walls])
        return reason or bench.too_short(tool, bench.bottom(wall), wall.z1)
    width = 2.0 * float(np.max(bore_of(wall).exact.radii))
    if tool.kind != END_MILL or tool.corner_radius:
        return "a mark is cut with a flat end mill"
    if not as_wide(tool, 0.5 * width):
        return f"it is not as wide as the {wall.boundary.name}, {width:g} mm"
    if bore_of(wall).is_round and not tool.plunges:
        return "a dot takes a tool that plunges"
    return bench.too_short(tool, bench.bottom(wall), wall.z1)


def engraved(bench: Bench, walls: Sequence[Wall], tool: Tool, top: float) -> Cut:
    """A mark as wide as the tool, a slot along its middle line or a dot; or letters of a text."""
    wall = walls[0]
    if text := text_of(wall.boundary.name):
        return LetterCut(
            name=f"engrave {text}", strategy="letters", tool=tool, top=top,
            depths=depths_of(tool, top, bench.bottom(wall)), stepover=stepover_of(tool),
            walls=tuple(each.boundary for each in walls),
            note=f"corners keep the radius of the cutter, {tool.radius:g} mm",
        )  # fmt: skip
    boundary = bore_of(wall)
    ends = ends_of(boundary)
    assert ends is not None  # as of every mark
    name, bottom = f"engrave {boundary.name}", bench.bottom(wall)
    if ends[0] == ends[1]:
        made = drill_all(name, tool, top, bottom, {boundary.name: ends[0]})
        return replace(made, depths=(bottom,))
    return LineCut(
        name=name, strategy="engrave", tool=tool, top=top, depths=depths_of(tool, top, bottom),
        start=ends[0], end=ends[1], slot=boundary.name,
    )  # fmt: skip


def ends_of(boundary: ExactBoundary) -> tuple[complex, complex] | None:
    """The ends of the middle line of a slot with round ends [mm], of a circle twice its middle.

    None of any other boundary.
    """
    contour = boundary.exact
    bent = contour.sweeps != 0.0
    middles = np.unique(contour.centres[bent])
    radii = contour.radii[bent]
    if not len(middles) or len(middles) > 2 or np.ptp(radii) > SAME * radii[0]:
        return None
    if np.ptp(np.abs(contour.sweeps[bent])) or len(radii) != 2:
        return None
    return complex(middles[0]), complex(middles[-1])


def passes(top: float, bottom: float, largest: float | None) -> tuple[float, ...]:
    """Z of equal passes of at most `largest` [mm], the last at `bottom` exactly; one if None.

    Raises
    ------
    GeometryError
        With key "tool.stepdown", if that makes more than `MOST_PASSES`.
    """
    depth = positive("part", top - bottom, "mm")
    count = 1
    if largest is not None:
        share = depth / positive("tool.stepdown", largest, "mm") * (1.0 - 1e-12)
        if share > MOST_PASSES:
            message = f"must be at least {depth / MOST_PASSES:.3g} mm: no more passes than that"
            raise GeometryError(message, "tool.stepdown", f"{largest:g}")
        count = max(1, math.ceil(share))
    return (*(top - depth * (k + 1) / count for k in range(count - 1)), bottom)


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
