"""The default sequence of cuts for a part."""

from __future__ import annotations

from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.outline.envelope import Envelope
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Part, Wall
from camgeo.toolpath.cut import ContourCut, passes
from camgeo.toolpath.tool import Tool

SAME = 2.0**-48
"""Radii that differ by less, relative to them, are equal: the rounding of a sum of two lengths."""


def cuts_of(part: Part, tool: Tool, pass_depth: float | None) -> tuple[ContourCut, ...]:
    """The bore first, as it is cut while the blank is whole; then outline or groove.

    The rim is that of the blank. `pass_depth` [mm] is the largest depth of a pass; None for a
    single pass.

    Raises
    ------
    GeometryError
        With the key of the scene, if the cutter does not fit or a height is missing.
    """
    part.require_heights()
    walls = {wall.boundary.name: wall for wall in part.walls}
    cuts: list[ContourCut] = []
    if "bore" in walls:
        cuts.append(_bore(walls["bore"], tool, pass_depth))
    if "outline" in walls:
        cuts.append(_profile(walls["outline"], tool, pass_depth, tool.radius))
    else:
        cuts += _groove(walls["inner flank"], walls["outer flank"], tool, pass_depth)
    return tuple(cuts)


def _profile(
    wall: Wall, tool: Tool, pass_depth: float | None, room: float, note: str = ""
) -> ContourCut:
    """Along a wall from its upper edge to its lower one, with the material on the right."""
    boundary = wall.boundary
    depths = passes(wall.z1, wall.z0, pass_depth)
    path = boundary.offset(tool.radius)
    name = boundary.name
    return ContourCut(
        name=name,
        strategy="profile",
        tool=tool,
        top=wall.z1,
        depths=depths,
        centre=path,
        right=name,
        room=room,
        note=note,
    )


def _bore(wall: Wall, tool: Tool, pass_depth: float | None) -> ContourCut:
    """Around the inside of the bore; an end mill cannot cut a keyway."""
    bore = wall.boundary
    assert isinstance(bore, ExactBoundary)  # as every bore is
    room = bore.round_radius - tool.radius
    if room <= 0.0:
        raise GeometryError(
            f"the cutter must be smaller than the bore, {2.0 * bore.round_radius:g} mm",
            key="output.gcode.tool_diameter",
            value=f"{tool.diameter:g}",
        )
    note = "the keyway is left to be broached" if bore.core is not None else ""
    return _profile(wall, tool, pass_depth, room / 2.0, note)


def _groove(inner: Wall, outer: Wall, tool: Tool, pass_depth: float | None) -> list[ContourCut]:
    """One round of a cutter as wide as the groove on the pitch curve, or one along each flank.

    Where a flank is trimmed, the roller sweeps more than two rounds along the remaining flanks
    clear; there only a cutter as wide as the groove is sure to clear it.
    """
    flanks = inner.boundary, outer.boundary
    paths = [flank.path for flank in flanks if isinstance(flank, CurveBoundary)]
    curve = paths[-1].stretches[0].curve
    pitch, half = curve.pitch, curve.distance
    like = "the roller" if half == pitch.follower.roller_radius else "the groove"
    side = half - tool.radius
    if abs(side) <= SAME * half:
        path = Path(Envelope(WorkingCurve(pitch, 0.0)).elements)
        centre = CurveBoundary("path of the cutter along the groove", hole=True, path=path)
        depths = passes(outer.z1, outer.z0, pass_depth)
        slot = ContourCut(
            name="groove",
            strategy="slot",
            tool=tool,
            top=outer.z1,
            depths=depths,
            centre=centre,
            right=outer.boundary.name,
            left=inner.boundary.name,
        )
        return [slot]
    if side < 0.0 or tool.diameter < half:
        raise GeometryError(
            f"the cutter of a groove must be no larger than {like}, and at least half as large,"
            f" so that two rounds clear it: from {half:g} to {2.0 * half:g} mm",
            key="output.gcode.tool_diameter",
            value=f"{tool.diameter:g}",
        )
    if not all(path.is_whole for path in paths):
        raise GeometryError(
            f"a flank of the groove is trimmed or has a corner: only a cutter like {like},"
            f" {2.0 * half:g} mm, clears all that the roller passes over",
            key="output.gcode.tool_diameter",
            value=f"{tool.diameter:g}",
        )
    return [_profile(wall, tool, pass_depth, side / 2.0) for wall in (outer, inner)]
