"""The cuts of the operations that a scene states."""

from __future__ import annotations

import math
from dataclasses import replace

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import least_distance
from camgeo.milling.bench import (
    COARSE,
    SAME,
    Bench,
    as_wide,
    clear_area,
    clear_around,
    clear_outside,
    drill_all,
    engraving_cut,
    exact_boundary,
    finish_along,
    flank_curve,
    groove_slot,
    letter_walls,
    loops_along,
    pass_depths,
    rough_around,
    rough_outside,
    tightest,
    unfit_for_engraving,
)
from camgeo.milling.cut import AreaCut, ContourCut, Cut
from camgeo.milling.milling import (
    CHAMFER_MILL,
    COMPUTED,
    DRILL,
    END_MILL,
    Kind,
    OperationSpec,
    Roughing,
    Tool,
)
from camgeo.milling.strategies import NARROWEST
from camgeo.milling.track import Track
from camgeo.part.part import Boundary, Wall

BELOW = 0.1
"""How far the point of a chamfer mill runs beside the wall, as a share of the chamfer's size."""

HOLE_NAME, MARK_NAME = "bore", "mark"
"""Names of the boundaries that are drilled and engraved if the operation names none."""

FLANKS = ("inner flank", "outer flank")

KIND_OF_TOOL = {Kind.DRILL: DRILL, Kind.CHAMFER: CHAMFER_MILL}
"""Kinds of tools that kinds of operations need; the others need an end mill."""


def stated_cuts(bench: Bench) -> list[Cut]:
    """The cuts of the scene's operations, in their order.

    Raises
    ------
    GeometryError
        With the key of the operation, if its tool cannot do it.
    """
    tools = {tool.number: tool for tool in bench.milling.tools}
    cuts: list[Cut] = []
    faced = False
    for k, spec in enumerate(bench.milling.operations):
        key = f"operation[{k + 1}]"
        tool = spec.run(tools[spec.tool])
        needed = KIND_OF_TOOL.get(Kind(spec.kind), END_MILL)
        if tool.kind != needed:
            raise GeometryError(
                f'"{spec.kind}" needs a tool of kind "{needed}", not "{tool.kind}"',
                f"{key}.tool",
                f"{spec.tool}",
            )
        cut = _StatedOperation(bench, spec, tool, key, tuple(cuts), faced=faced).cut()
        name = spec.name or cut.name
        if name in (earlier.name for earlier in cuts):
            raise GeometryError("each operation needs its own name", f"{key}.name", name)
        note = "; ".join(text for text in (spec.note, cut.note) if text)
        cuts.append(replace(cut, name=name, climb=spec.climb, stop=spec.stop, note=note))
        faced = faced or spec.kind == Kind.FACE
    return cuts


class _StatedOperation:
    """One stated operation, to be turned into a cut after the `previous_cuts`."""

    def __init__(
        self,
        bench: Bench,
        spec: OperationSpec,
        tool: Tool,
        key: str,
        previous_cuts: tuple[Cut, ...],
        *,
        faced: bool,
    ) -> None:
        self.bench = bench
        self.spec = spec
        self.tool = tool
        self.key = key
        self.previous_cuts = previous_cuts
        # Z of the upper face of the material.
        self.top = 0.0 if faced else bench.milling.stock.top

    def cut(self) -> Cut:
        """The cut; GeometryError with the operation's key if the tool cannot make it."""
        return {
            Kind.FACE: self._face,
            Kind.DRILL: self._drill,
            Kind.BORE: self._bore,
            Kind.ROUGH: self._rough,
            Kind.FINISH: self._finish,
            Kind.SLOT: self._slot,
            Kind.CHAMFER: self._chamfer,
            Kind.ENGRAVE: self._engrave,
        }[Kind(self.spec.kind)]()

    def _wall(self, name: str) -> Wall:
        wall, depth = self.bench.wall(name, f"{self.key}.boundary"), self.spec.depth
        return wall if depth is None else replace(wall, z0=max(wall.z0, wall.z1 - depth))

    def _require(self, reason: str) -> None:
        if reason:
            raise GeometryError(reason, f"{self.key}.tool", f"{self.tool.number}")

    def _require_reach(self, wall: Wall) -> None:
        """GeometryError unless the tool reaches all of the wall, its allowance left on it."""
        self._require(self.bench.unfit(wall, top=self._top(wall))(self.tool))
        allowance, radius = self.spec.allowance, self.tool.radius
        if not allowance:
            return
        place = tightest(wall.boundary)
        most, reason = math.inf, ""
        if place is not None:
            most, reason = place.radius - radius, place.sentence
        if wall.boundary.name in FLANKS:
            across = 2.0 * (abs(flank_curve(wall).distance) - radius)
            if across < most:
                most, reason = across, "more would cut into the flank across the groove"
        if allowance >= most:
            raise GeometryError(
                f"must be less than {most:.4g} mm with tool {self.tool.number}: {reason}",
                f"{self.key}.allowance",
                f"{allowance:g}",
            )

    def _face(self) -> Cut:
        if not self.top or self.bench.milling.stock.outline is None:
            message = (
                "there is nothing to face: the blank ends at the"
                f" {self.bench.milling.top_face} face"
            )
            if self.top:
                message = "the outline of a blank that is to be faced must be known"
            raise GeometryError(message, f"{self.key}.kind", '"face"')
        self._require(self.bench.too_short(self.tool, 0.0, self.top))
        return clear_area(self.bench, "face", "face", self.tool, self.top, 0.0, ())

    def _drill(self) -> Cut:
        """The bore, or holes of one size through the part."""
        walls = self._holes(self.spec.boundary or HOLE_NAME)
        for wall in walls:
            if self.tool.radius > exact_boundary(wall).round_radius * (1.0 + SAME):
                self._require(f"it is larger than the {wall.boundary.name}")
        bottom, top = self.bench.bottom(walls[0]), self._top(walls[0])
        self._require(self.bench.too_short(self.tool, bottom, top))
        places = {
            wall.boundary.name: complex(exact_boundary(wall).exact.centres[0]) for wall in walls
        }
        return drill_all(f"drill {', '.join(places)}", self.tool, top, bottom, places)

    def _holes(self, name: str) -> list[Wall]:
        """The walls of the hole of that name, or of all holes that have the name and a number."""
        numbered = [
            wall
            for wall_name, wall in self.bench.walls.items()
            if wall_name.rpartition(" ")[0] == name and wall in self.bench.holes
        ]
        holes = numbered or [self._wall(name)]
        if any(not wall.boundary.hole or not self.bench.pierces(wall) for wall in holes):
            raise GeometryError("is not a through hole", f"{self.key}.boundary", f'"{name}"')
        return holes

    def _engrave(self) -> Cut:
        name = self.spec.boundary or MARK_NAME
        letters = letter_walls(self.bench, name)
        walls = letters or (self._wall(name),)
        if not letters and (walls[0] not in self.bench.holes or self.bench.pierces(walls[0])):
            raise GeometryError("is neither a mark nor a text", f"{self.key}.boundary", f'"{name}"')
        self._require(unfit_for_engraving(self.bench, self.tool, walls))
        return engraving_cut(self.bench, walls, self.tool, self._top(walls[0]))

    def _top(self, wall: Wall) -> float:
        """Z [mm] of the upper face of the material over a wall: the upper end of the wall itself,
        if the boss beside it has been cleared down to there before.
        """
        bosses = {boss.boundary.name for boss in self.bench.bosses}
        laid_free = any(
            bosses & set(cut.produced) and isinstance(cut, AreaCut) and cut.bottom <= wall.z1
            for cut in self.previous_cuts
        )
        return wall.z1 if laid_free else self.top

    def _bore(self) -> Cut:
        wall = self._wall("bore")
        self._require_reach(wall)
        walls = (wall.boundary,)
        bottom, allowance = self.bench.bottom(wall), self.spec.allowance
        return clear_area(
            self.bench, "rough bore", "bore", self.tool, self.top, bottom, walls, allowance
        )

    def _rough(self) -> Cut:
        wall, bench, tool = self._wall(self.spec.boundary), self.bench, self.tool
        boundary = wall.boundary
        self._require_reach(wall)
        if wall in bench.bosses:
            if self.spec.strategy not in ("", Roughing.SPIRAL):
                raise GeometryError(
                    "does not suit a boss, around which everything is cleared",
                    f"{self.key}.strategy",
                    f'"{self.spec.strategy}"',
                )
            return clear_around(bench, wall, tool, self.top, self.spec.allowance)
        # The inner flank of a groove bounds an island, which no blank surrounds.
        outermost = not boundary.hole and not boundary.name.endswith("flank")
        if self.spec.strategy == Roughing.TROCHOIDAL:
            return self._loops(wall)
        if self.spec.strategy == Roughing.SPIRAL:
            return self._cleared(wall, outermost=outermost)
        ramp = self.spec.strategy == Roughing.RAMP or not outermost
        make = rough_around if ramp else rough_outside
        return make(bench, wall, tool, self._top(wall), self.spec.allowance)

    def _cleared(self, wall: Wall, *, outermost: bool) -> Cut:
        key, value = f"{self.key}.strategy", f'"{Roughing.SPIRAL}"'
        if not outermost or self.bench.milling.stock.outline is None:
            raise GeometryError(
                "needs a wall around the part, and a blank whose outline is stated", key, value
            )
        cut = clear_outside(self.bench, wall, self.tool, self._top(wall), self.spec.allowance)
        if cut is None:
            raise GeometryError(
                "is not possible: rays from the cam axis meet the cutter's path or the edge of the"
                " blank more than once",
                key,
                value,
            )
        return cut

    def _loops(self, wall: Wall) -> Cut:
        bench, holding = self.bench, self.bench.milling.holding
        if holding is not None and holding.tabs is not None and bench.is_through(wall):
            raise GeometryError(
                f'cannot leave tabs: state "{Roughing.RAMP}", or another holding',
                f"{self.key}.strategy",
                f'"{Roughing.TROCHOIDAL}"',
            )
        other = None
        if wall.boundary.name in FLANKS:
            (other,) = (self._wall(name) for name in FLANKS if name != wall.boundary.name)
        return loops_along(bench, wall, other, self.tool, self._top(wall), self.spec.allowance)

    def _finish(self) -> Cut:
        """At full depth if the wall is roughed that deep, else in passes that enter on the path."""
        wall, bench, tool = self._wall(self.spec.boundary), self.bench, self.tool
        self._require_reach(wall)
        bottom = bench.bottom(wall)
        room = self._room(wall, bottom)
        cleared = room is not None
        top = self._top(wall)
        cut = finish_along(
            bench,
            wall,
            tool,
            top,
            room or 0.0,
            rest=self._rest(wall, bottom) if cleared else 0.0,
            depths=(bottom,) if cleared else pass_depths(tool, top, bottom),
            cleared=cleared,
            springs=self.spec.springs,
            compensation=self.compensation,
        )
        if self.compensation != COMPUTED and not (cleared and room):
            raise GeometryError(
                'needs room for leads beside a wall that is roughed before; "computed" does not',
                *self._compensation_source,
            )
        if not cleared:
            return replace(cut, strategy="slot")
        if not self.spec.allowance:
            return cut
        centre = wall.boundary.offset(tool.radius + self.spec.allowance)
        return replace(cut, centre=centre, allowance=self.spec.allowance)

    def _room(self, wall: Wall, bottom: float) -> float | None:
        """Room for leads [mm]: the distance beside the path to which earlier operations have
        cleared everything down to `bottom`; None if they have not.
        """
        name, tool = wall.boundary.name, self.tool
        deep = [cut for cut in self.previous_cuts if cut.bottom <= bottom]
        areas = [cut for cut in deep if isinstance(cut, AreaCut) and name in cut.produced]
        if any(not cut.slot for cut in areas):
            if name == "bore":
                return 0.5 * (exact_boundary(wall).round_radius - tool.radius)
            return self.bench.room_outside(tool, self.compensation)
        slots = {cut.right: cut for cut in deep if isinstance(cut, ContourCut)}
        if name not in slots:
            return max((self._room_in_loops(cut) for cut in areas), default=None) or None
        if name in FLANKS:  # cutters at least half as wide, along both flanks, clear the groove
            half = abs(flank_curve(wall).distance)
            if all(flank in slots and slots[flank].tool.diameter >= half for flank in FLANKS):
                return 0.5 * max(0.0, half - tool.radius)
        # The slot is as wide as its cutter, and begins at its allowance, or a slack beside it.
        wider = 2.0 * (slots[name].tool.radius - tool.radius)
        spare = slots[name].allowance + slots[name].slack - self.spec.allowance
        return max(0.0, spare + wider) if wider >= 0.0 else None

    def _rest(self, wall: Wall, bottom: float) -> float:
        """Thickness [mm] of what earlier operations down to `bottom` have left beside the path."""
        name = wall.boundary.name
        left = [
            cut.allowance
            for cut in self.previous_cuts
            if cut.bottom <= bottom
            and (
                (isinstance(cut, AreaCut) and name in cut.produced)
                or (isinstance(cut, ContourCut) and cut.right == name)
            )
        ]
        return max(0.0, min(left, default=0.0) - self.spec.allowance)

    def _room_in_loops(self, cut: AreaCut) -> float:
        """Room for leads [mm] in a trochoidal slot; loops begin slightly beside the allowance."""
        wider = 2.0 * (cut.tool.radius - self.tool.radius)
        room = cut.allowance - self.spec.allowance + wider + NARROWEST * cut.tool.radius
        return room if wider >= 0.0 else 0.0

    @property
    def compensation(self) -> str:
        """The compensation of the operation, or else that of all finishes."""
        return self.spec.compensation or self.bench.compensation

    @property
    def _compensation_source(self) -> tuple[str, str]:
        """Key and value in the scene that state the compensation."""
        if self.spec.compensation is None:
            return "output.gcode.compensation", f'"{self.bench.compensation}"'
        return f"{self.key}.compensation", f'"{self.spec.compensation}"'

    def _slot(self) -> Cut:
        inner, outer = self._wall("inner flank"), self._wall("outer flank")
        half = flank_curve(outer).distance
        if not as_wide(self.tool, half):
            width = 2.0 * half
            self._require(f"it is not as wide as the groove, {width:g} mm: rough and finish it")
        top = self._top(outer)
        self._require(self.bench.too_short(self.tool, self.bench.bottom(outer), top))
        return groove_slot(self.bench, inner, outer, self.tool, top)

    def _chamfer(self) -> Cut:
        """A chamfer along the upper edge: a pointed cutter runs with its point beside the wall and
        below the chamfer.
        """
        wall, size, tool, face = (
            self._wall(self.spec.boundary),
            self.spec.size,
            self.tool,
            self.bench.milling.top_face,
        )
        assert size is not None  # which the rules of the scene require
        if wall.z1 != 0.0:
            raise GeometryError(
                f"its {face} edge is not on the {face} face", f"{self.key}.boundary"
            )
        if self.top:
            raise GeometryError(
                f"the {face} face is not there yet: an operation must face it before",
                f"{self.key}.kind",
                '"chamfer"',
            )
        # The point runs `BELOW` of the size beside the wall, so that its flank, not the point, cuts
        # the lower edge of the chamfer; the upper edge is then at the radius `reach` of the cone.
        reach = (1.0 + BELOW) * size
        depth, offset = reach * tool.tip_length / tool.radius, BELOW * size
        if reach > tool.radius:
            self._require(
                f"its radius, {tool.radius:g} mm, is too small for a chamfer of {size:g} mm"
            )
        if wall.z0 >= -depth:
            self._require(f"its point, {depth:.4g} mm deep, reaches the floor at Z {wall.z0:g} mm")
        self._require(self.bench.too_short(tool, -depth))
        centre = wall.boundary.offset(offset)
        for name, other in self.bench.walls.items():
            if other.z1 == 0.0 and name != wall.boundary.name:
                self._require_distance(centre, other.boundary, reach)
        return ContourCut(
            name=f"chamfer {wall.boundary.name}",
            strategy="slot",
            tool=tool,
            top=0.0,
            depths=(-depth,),
            centre=centre,
            contact=reach,
            edge=wall.boundary.name,
            width=size,
            springs=self.spec.springs,
            note=f"{size:g} mm wide on the face",
        )

    def _require_distance(self, centre: Boundary, other: Boundary, reach: float) -> None:
        """GeometryError with key "size", if the cone comes to the edge of another wall."""
        tracks = [
            Track.around(boundary.arcs(COARSE, "fast").contour) for boundary in (centre, other)
        ]
        distance = least_distance(*tracks)
        if distance < reach + 2.0 * COARSE:
            raise GeometryError(
                f"the cutter would reach the {other.name}, {distance:.3g} mm from its point",
                f"{self.key}.size",
                f"{self.spec.size:g}",
            )
