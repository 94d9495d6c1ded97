"""The cuts of the operations that a scene states."""

from __future__ import annotations

from dataclasses import replace

from camgeo.errors import GeometryError
from camgeo.part.part import Wall
from camgeo.toolpath.bench import SAME, Bench, bore_of, flank_curve
from camgeo.toolpath.cut import ContourCut, Cut
from camgeo.toolpath.making import (
    clear_area,
    depths_of,
    drill_at,
    finish_along,
    rough_around,
    slot_between,
)
from camgeo.toolpath.milling import (
    BORE,
    CHAMFER,
    DRILLING,
    FACE,
    FINISH,
    ROUGH,
    SLOT,
    OperationSpec,
)
from camgeo.toolpath.stock import ROUND
from camgeo.toolpath.tool import CHAMFER_MILL, DRILL, END_MILL, Tool

KIND_OF_TOOL = {DRILLING: DRILL, CHAMFER: CHAMFER_MILL}
"""What kinds of operations need; the others need an end mill."""


def stated_cuts(bench: Bench) -> list[Cut]:
    """The cuts of the scene's operations, in their order.

    Raises
    ------
    GeometryError
        With the key of the operation, if its tool cannot do it.
    """
    tools = {tool.number: tool for tool in bench.milling.tools}
    found: list[Cut] = []
    finished: set[str] = set()
    along: dict[str, ContourCut] = {}
    for k, spec in enumerate(bench.milling.operations):
        key = f"operation[{k + 1}]"
        tool = spec.run(tools[spec.tool])
        needed = KIND_OF_TOOL.get(spec.kind, END_MILL)
        if tool.kind != needed:
            message = f'"{spec.kind}" needs a tool of kind "{needed}", not "{tool.kind}"'
            raise GeometryError(message, f"{key}.tool", f"{spec.tool}")
        cut = _Stated(bench, spec, tool, key, along, finished).cut()
        name = spec.name or cut.name
        if name in (each.name for each in found):
            raise GeometryError("each operation needs its own name", f"{key}.name", name)
        note = "; ".join(text for text in (spec.note, cut.note) if text)
        found.append(replace(cut, name=name, climb=spec.climb, stop=spec.stop, note=note))
        if spec.kind == FACE:
            finished.add(FACE)
        if isinstance(cut, ContourCut):
            along[cut.right] = cut
    return found


class _Stated:
    """One operation to be made a cut."""

    def __init__(
        self,
        bench: Bench,
        spec: OperationSpec,
        tool: Tool,
        key: str,
        along: dict[str, ContourCut],
        finished: set[str],
    ) -> None:
        self.bench = bench
        self.spec = spec
        self.tool = tool
        self.key = key
        # The latest cut along each wall.
        self.along = along
        # Z of the upper face of the material.
        self.top = 0.0 if FACE in finished else bench.milling.stock.top

    def cut(self) -> Cut:
        """The cut; GeometryError with the operation's key if the tool cannot make it."""
        kinds = {FACE: self._face, DRILLING: self._drill, BORE: self._bore, SLOT: self._slot}
        if self.spec.kind in kinds:
            return kinds[self.spec.kind]()
        wall = self._wall(self.spec.boundary)
        if self.spec.kind == ROUGH:
            return self._rough(wall)
        if self.spec.kind == FINISH:
            return self._finish(wall)
        return self._chamfer(wall)

    def _wall(self, name: str) -> Wall:
        walls = self.bench.walls
        if name not in walls:
            known = ", ".join(f'"{each}"' for each in walls)
            message = f"the part has no such wall; it has {known}"
            raise GeometryError(message, f"{self.key}.boundary", f'"{name}"')
        return walls[name]

    def _require(self, reason: str) -> None:
        if reason:
            raise GeometryError(reason, f"{self.key}.tool", f"{self.tool.number}")

    def _face(self) -> Cut:
        if not self.top or self.bench.milling.stock.outline is None:
            message = "there is nothing to face: the blank is not higher than the part"
            if self.top:
                message = "the outline of a blank that is to be faced must be known"
            raise GeometryError(message, f"{self.key}.kind", '"face"')
        self._require(self.bench.too_short(self.tool, 0.0, self.top))
        return clear_area(self.bench, "face", "face", self.tool, self.top, 0.0, ())

    def _drill(self) -> Cut:
        wall = self._wall("bore")
        place = complex(bore_of(wall).exact.centres[0])
        if self.tool.radius > bore_of(wall).round_radius * (1.0 + SAME):
            self._require("it is larger than the bore")
        bottom = self.bench.bottom(wall)
        self._require(self.bench.too_short(self.tool, bottom, self.top))
        return drill_at("drill bore", self.tool, self.top, bottom, place)

    def _bore(self) -> Cut:
        wall = self._wall("bore")
        self._require(self.bench.unfit(wall, top=self.top)(self.tool))
        walls = (wall.boundary,)
        bottom, allowance = self.bench.bottom(wall), self.spec.allowance
        return clear_area(
            self.bench, "rough bore", "bore", self.tool, self.top, bottom, walls, allowance
        )

    def _rough(self, wall: Wall) -> Cut:
        boundary, bench, tool = wall.boundary, self.bench, self.tool
        self._require(bench.unfit(wall, top=self.top)(tool))
        # The inner flank of a groove bounds an island, which no blank surrounds.
        outermost = not boundary.hole and not boundary.name.endswith("flank")
        if bench.milling.stock.shape == ROUND and outermost:
            walls, name = (boundary,), f"rough {boundary.name}"
            bottom, allowance = bench.bottom(wall), self.spec.allowance
            return clear_area(bench, name, "rough", tool, self.top, bottom, walls, allowance)
        return rough_around(bench, wall, tool, self.top, self.spec.allowance)

    def _finish(self, wall: Wall) -> Cut:
        """At full depth if the wall is roughed that deep, else in passes that enter on the path."""
        boundary, bench, tool = wall.boundary, self.bench, self.tool
        self._require(bench.unfit(wall, top=self.top)(tool))
        bottom = bench.bottom(wall)
        roughed = self.along.get(boundary.name)
        cleared = self._is_laid_free(wall) or (roughed is not None and roughed.bottom <= bottom)
        room = self._room(wall) if cleared else 0.0
        cleared = cleared and room >= 0.0  # else it needs a slot wider than there is
        depths = (bottom,) if cleared else depths_of(tool, self.top, bottom)
        made = finish_along(
            bench,
            wall,
            tool,
            self.top,
            max(0.0, room),
            depths=depths,
            cleared=cleared,
            springs=self.spec.springs,
        )
        if not cleared:
            return replace(made, strategy="slot")
        if not self.spec.allowance:
            return made
        centre = boundary.offset(tool.radius + self.spec.allowance)
        return replace(made, centre=centre, allowance=self.spec.allowance)

    def _is_laid_free(self, wall: Wall) -> bool:
        """Whether an operation before it has cleared the area next to the wall."""
        kinds = (BORE, ROUGH) if wall.boundary.hole else (ROUGH,)
        before = self.bench.milling.operations[: int(self.key[10:-1]) - 1]
        return any(
            each.kind in kinds and (each.boundary or "bore") == wall.boundary.name
            for each in before
        )

    def _room(self, wall: Wall) -> float:
        """For leads [mm]: what roughing has left beside the path, negative if the cutter is wider
        than its slot.
        """
        boundary, tool = wall.boundary, self.tool
        if boundary.name == "bore":
            return 0.5 * (bore_of(wall).round_radius - tool.radius)
        if boundary.name.endswith("flank"):
            return 0.5 * max(0.0, abs(flank_curve(wall).distance) - tool.radius)
        if self.bench.milling.stock.shape == ROUND and not boundary.hole:
            return tool.radius
        roughed = self.along[boundary.name]
        wider = roughed.tool.diameter - tool.diameter
        return roughed.allowance - self.spec.allowance + wider

    def _slot(self) -> Cut:
        inner, outer = self._wall("inner flank"), self._wall("outer flank")
        half = flank_curve(outer).distance
        if abs(self.tool.radius - half) > SAME * half:
            width = 2.0 * half
            self._require(f"it is not as wide as the groove, {width:g} mm: rough and finish it")
        self._require(self.bench.too_short(self.tool, self.bench.bottom(outer), self.top))
        return slot_between(self.bench, inner, outer, self.tool, self.top)

    def _chamfer(self, wall: Wall) -> Cut:
        """The upper edge: a pointed cutter runs with its point beside and below the edge."""
        size, tool = self.spec.size, self.tool
        assert size is not None  # which the rules of the scene require
        assert tool.tip_angle is not None
        if wall.z1 != 0.0:
            raise GeometryError("its upper edge is not on the upper face", f"{self.key}.boundary")
        # Its flank touches the lower edge of the chamfer a tenth of the size above the point.
        depth = size * 1.1 * tool.tip_length / tool.radius
        beside = 0.1 * size
        if size + beside > tool.radius:
            self._require(f"its radius, {tool.radius:g} mm, does not cover {size:g} mm")
        return ContourCut(
            name=f"chamfer {wall.boundary.name}",
            strategy="profile",
            tool=tool,
            top=0.0,
            depths=(-depth,),
            centre=wall.boundary.offset(beside),
            room=beside,
            cleared=False,
        )
