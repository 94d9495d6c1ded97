"""The sequence of cuts for a scene that states none, and how work is held in any sequence.

First what is cut while the blank is whole and stiff: its face, hub, bore and holes, the groove;
then what cuts the part free. Each wall is roughed in passes, and finished at full depth with a
round more.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.milling.bench import (
    BORE,
    COARSE,
    SAME,
    Bench,
    as_wide,
    clear_area,
    clear_around,
    coarse,
    drill_all,
    engraving_cut,
    exact_boundary,
    finish_along,
    flank_curve,
    groove_slot,
    is_open,
    letter_walls,
    rough_around,
    rough_outside,
    unfit_for_engraving,
)
from camgeo.milling.cut import AreaCut, ContourCut, Cut
from camgeo.milling.judged import unmade_names
from camgeo.milling.milling import (
    CLAMPS,
    COMPUTED,
    DRILL,
    FIXTURE,
    SCREWS,
    Clamp,
    Heights,
    MillingSpec,
    Obstacle,
    Tool,
    ToolError,
)
from camgeo.milling.polygons import Area
from camgeo.milling.simulation import LOOSE_CORE
from camgeo.milling.stated import stated_cuts
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Part, Wall
from camgeo.part.spec import text_name

Step = Cut | Finding
"""A cut, or a finding on the sequence."""


def planned_steps(bench: Bench) -> Iterator[Step]:
    """The cuts in their order, and the findings on them.

    Raises
    ------
    GeometryError
        With the key of the scene, if no tool fits a cut.
    """
    finished = bench.milling.finished_walls
    walls = {name: wall for name, wall in bench.walls.items() if name not in finished}
    if bench.milling.turned:  # other walls are reached from the first side, or from neither
        walls = {name: wall for name, wall in walls.items() if is_open(bench.part, wall)}
    yield from _face(bench)
    for wall in bench.bosses:
        if wall.boundary.name in walls:
            yield from _boss(bench, wall)
    if BORE in walls:
        yield from _bore(bench, walls[BORE])
    yield from _holes(bench, walls)
    yield from _texts(bench, walls)
    if {"inner flank", "outer flank"} <= walls.keys():
        yield from _groove(bench, walls["inner flank"], walls["outer flank"])
    if "rim" in walls:
        yield from _rim(bench, walls["rim"])
    if "outline" in walls:
        yield from _around(bench, walls["outline"])


def _face(bench: Bench) -> Iterator[Step]:
    """Facing down to the upper face of the part, if the blank is higher."""
    top = bench.milling.stock.top
    if not top:
        return
    if bench.milling.stock.outline is None:
        raise GeometryError(
            "the outline of a blank that is to be faced must be known", "stock.length"
        )
    tool = bench.choose("upper face", lambda tool: bench.too_short(tool, 0.0, top))
    yield clear_area(bench, "face", "face", tool, top, 0.0, ())


def _boss(bench: Bench, wall: Wall) -> Iterator[Step]:
    """A boss on the disc: everything around it is cleared down to the disc, then it is finished."""
    tool = bench.choose(wall.boundary.name, bench.unfit(wall, top=wall.z1))
    allowance = bench.allowance(tool, wall)
    yield clear_around(bench, wall, tool, wall.z1, allowance)
    room = bench.room_outside(tool, bench.compensation)
    yield finish_along(bench, wall, tool, wall.z1, room, rest=allowance)


def _holes(bench: Bench, walls: Collection[str]) -> Iterator[Step]:
    """Holes beside the bore, by a drill of their diameter, and marks, by an end mill of their
    width; those without such a tool are left out.
    """
    # Holes of one size and mouth are drilled in one operation.
    through: dict[tuple[float, float], dict[str, complex]] = {}
    for wall in (hole for hole in bench.holes if hole.boundary.name in walls):
        boundary = exact_boundary(wall)
        if bench.pierces(wall):
            size = boundary.round_radius, bench.mouth(wall)
            through.setdefault(size, {})[boundary.name] = complex(boundary.exact.centres[0])
            continue
        width = 2.0 * float(np.max(boundary.exact.radii))
        tool = next(
            (
                candidate
                for candidate in bench.milling.tools
                if not unfit_for_engraving(bench, candidate, (wall,))
            ),
            None,
        )
        if tool is not None:
            yield engraving_cut(bench, (wall,), tool, wall.z1)
            continue
        text = f"{boundary.name}: left out, no flat end mill of {width:g} mm fits it"
        yield Finding(f"{boundary.name}-left-out", "ok", text)
    for (radius, top), holes in through.items():
        bottom = bench.bottom(bench.walls[next(iter(holes))])
        names = ", ".join(holes)
        drill = next(
            (candidate for candidate in bench.milling.tools if _drills(candidate, 2.0 * radius)),
            None,
        )
        if drill is not None and not bench.too_short(drill, bottom, top):
            yield drill_all(f"drill {names}", drill, top, bottom, holes)
            continue
        text = f"left out, no drill of {2.0 * radius:g} mm reaches through"
        yield Finding("holes-left-out", "ok", f"{names}: {text}")


def _texts(bench: Bench, walls: Collection[str]) -> Iterator[Step]:
    """Engraving of each text by the first end mill that fits into its strokes; a text without one
    is left out.
    """
    for text in sorted(set(map(text_name, walls)) - {""}):
        letters = letter_walls(bench, text)
        reasons = {
            candidate: unfit_for_engraving(bench, candidate, letters)
            or (
                ""
                if candidate.stepover and candidate.stepdown
                else "it states no stepover or no stepdown"
            )
            for candidate in bench.milling.tools
        }
        tool = next((candidate for candidate, reason in reasons.items() if not reason), None)
        if tool is not None:
            yield engraving_cut(bench, letters, tool, letters[0].z1)
            continue
        why = "; ".join(
            f"tool {candidate.number}: {reason}" for candidate, reason in reasons.items()
        )
        yield Finding(f"{text.replace(' ', '-')}-left-out", "ok", f"{text}: left out, {why}")


def _bore(bench: Bench, wall: Wall) -> Iterator[Step]:
    """The bore: drilled or opened from inside; left out if the blank has it or it is not round."""
    bore, stock = exact_boundary(wall), bench.milling.stock
    if not bore.is_round:
        text = "bore: left out, it is not round; it is to be cut otherwise"
        yield Finding("bore-left-out", "ok", text)
        return
    diameter, there = 2.0 * bore.round_radius, stock.bore or 0.0
    keyway = "the keyway is left to be broached" if bore.core is not None else ""
    if there == diameter:
        text = f"bore: the blank has it, {diameter:g} mm; it is not milled"
        yield Finding("bore-left-out", "ok", f"{text}; {keyway}" if keyway else text)
        return
    drill = next(
        (candidate for candidate in bench.milling.tools if _drills(candidate, diameter)), None
    )
    if drill is not None and not bench.too_short(drill, bench.bottom(wall)):
        middle = complex(bore.exact.centres[0])
        yield drill_all("bore", drill, 0.0, bench.bottom(wall), {"bore": middle})
        return
    tool = bench.choose("bore", bench.unfit(wall))
    allowance = bench.allowance(tool, wall)
    # A lead may go half way from the path of the cutter to the middle.
    room = 0.5 * (bore.round_radius - tool.radius)
    if core(diameter - 2.0 * allowance, tool.diameter) > there:
        bottom = bench.bottom(wall)
        yield clear_area(bench, "rough bore", "bore", tool, 0.0, bottom, (bore,), allowance)
    else:
        yield rough_around(bench, wall, tool, 0.0, allowance)
    yield finish_along(bench, wall, tool, 0.0, room, rest=allowance, note=keyway)


def core(bore: float, diameter: float) -> float:
    """Diameter [mm] of the core that one round of a cutter of `diameter` [mm] leaves inside `bore`
    [mm]; 0 if it leaves none.
    """
    return max(0.0, bore - 2.0 * diameter)


def _drills(tool: Tool, diameter: float) -> bool:
    return tool.kind == DRILL and as_wide(tool, 0.5 * diameter)


def _groove(bench: Bench, inner: Wall, outer: Wall) -> Iterator[Step]:
    """The groove: one round of a cutter as wide, or roughing and a finish along each flank."""
    curve = flank_curve(outer)
    half = curve.distance
    paths = [
        wall.boundary.path for wall in (inner, outer) if isinstance(wall.boundary, CurveBoundary)
    ]
    like = "the roller" if half == curve.pitch.follower.roller_radius else "the groove"
    bottom, top = bench.bottom(outer), outer.z1

    def unfit(tool: Tool) -> str:
        """Why a cutter does not fit the groove; where a flank is trimmed, the roller passes over
        more than rounds along the flanks clear.
        """
        if as_wide(tool, half):
            return "" if tool.stepdown else "it states no stepdown"
        if tool.radius > half or tool.diameter < half:
            return (
                f"the cutter of a groove must be no larger than {like}, and at least half as"
                f" large, so that two rounds clear it: from {half:g} to {2.0 * half:g} mm"
            )
        if not all(path.is_whole for path in paths):
            return (
                f"a flank of the groove is trimmed or has a corner: only a cutter like {like},"
                f" {2.0 * half:g} mm, clears all that the roller passes over"
            )
        return (
            bench.too_large(tool, inner.boundary)
            or bench.too_large(tool, outer.boundary)
            or bench.too_short(tool, bottom, top)
        )

    tool = bench.choose("groove", unfit)
    if as_wide(tool, half):
        yield groove_slot(bench, inner, outer, tool, top)
        return
    # The allowance is at most half of the width that the cutter leaves free on one side.
    side = half - tool.radius
    walls = [(wall, min(bench.allowance(tool, wall), 0.5 * side)) for wall in (outer, inner)]
    for wall, allowance in walls:
        yield rough_around(bench, wall, tool, top, allowance)
    for wall, allowance in walls:
        yield finish_along(bench, wall, tool, top, 0.5 * side, rest=allowance)


def _rim(bench: Bench, wall: Wall) -> Iterator[Step]:
    """The rim: not milled unless the blank is known to be larger."""
    stock, rim = bench.milling.stock, exact_boundary(wall)
    diameter = 2.0 * rim.round_radius
    same = stock.diameter is not None and stock.diameter == diameter and not stock.centre
    if stock.outline is None or same:
        text = f"rim: it is that of the blank, {diameter:g} mm in diameter, and not milled"
        yield Finding("rim-left-out", "ok", text)
        return
    yield from _around(bench, wall)


def _around(bench: Bench, wall: Wall) -> Iterator[Step]:
    """A wall that cuts the part free: roughed from the blank, then finished."""
    tool = bench.choose(wall.boundary.name, bench.unfit(wall, top=wall.z1))
    allowance = bench.allowance(tool, wall)
    rough = rough_outside(bench, wall, tool, wall.z1, allowance)
    yield rough
    if isinstance(rough, AreaCut):
        room = bench.room_outside(tool, bench.compensation)
    else:  # in a slot as wide as the cutter they begin where it runs
        room = rough.allowance + rough.slack
    yield finish_along(bench, wall, tool, wall.z1, room, rest=allowance)


# -- holding --------------------------------------------------------------------------------------
# How the blank is held while it is cut: clamps that come and go, tabs, and what drops loose.


LARGEST: Final = 1e5
"""Distance from the cam axis to which work may reach, and radius of a tool [mm]: a hundred metres,
beyond any machine. On it chords within the fineness of a simulation, 1e-3 mm, are some 20,000 a
turn, so that verdicts never rest on coarser ones."""


def guard_cuts(bench: Bench, cuts: list[Cut], heights: Heights) -> list[Cut]:
    """The cuts with the clamps that they must clear, the stops at which clamps are moved, and tabs.

    Raises
    ------
    GeometryError
        With the key of the scene, if a clamp stands where something is cut, traverses do not
        clear it or the blank, or nothing holds what is cut free.
    """
    holding = bench.milling.holding
    _clears_the_blank(bench, heights)
    if holding is None:
        freed = [cut for cut in cuts if _is_through(bench, cut)]
        if freed:
            raise GeometryError(
                f"is missing: {freed[0].name} cuts through, and nothing holds what it cuts free",
                "holding",
            )
        return list(cuts)
    names = [cut.name for cut in cuts]
    for clamp in holding.clamps:
        for key in ("since", "until"):
            name = getattr(clamp, key)
            if name and name not in names:
                known = ", ".join(f'"{known_name}"' for known_name in names)
                raise GeometryError(
                    f"there is no such operation; there are {known}",
                    f"holding.{clamp.what}.{key}",
                    f'"{name}"',
                )
        if clamp.height >= heights.clearance:
            raise GeometryError(
                f"must be above the {clamp.obstacle.name}, {clamp.height:g} mm high",
                "output.gcode.clearance_height", f"{heights.clearance:g}",
            )  # fmt: skip
    guarded_cuts = []
    for k, cut in enumerate(cuts):
        there = [clamp for clamp in holding.clamps if _is_there(clamp, k, names)]
        stops = [cut.stop, *_clamp_instructions(holding.clamps, cut.name)]
        guarded_cut = replace(
            cut,
            obstacles=tuple(clamp.obstacle for clamp in there),
            stop="; ".join(text for text in stops if text),
        )
        for obstacle in guarded_cut.obstacles:
            _clears(guarded_cut, obstacle)
        if isinstance(guarded_cut, AreaCut | ContourCut) and _frees(bench, guarded_cut):
            if holding.kind in (CLAMPS, SCREWS):
                _holds(bench, guarded_cut, there)
            if holding.tabs is not None and isinstance(guarded_cut, ContourCut):
                # Stated above the lower face of the part; in a cut above its last depth, which may
                # lie below that face.
                height = holding.tabs.height + bench.lower_face - guarded_cut.bottom
                guarded_cut = replace(guarded_cut, tabs=replace(holding.tabs, height=height))
        guarded_cuts.append(guarded_cut)
    return guarded_cuts


def require_room(bench: Bench) -> None:
    """Check that the blank contains the part, and that tabs or a skin are thinner than the part.

    Raises
    ------
    GeometryError
        With the key of the scene.
    """
    milling, layers = bench.milling, bench.part.layers
    holding, thickness = milling.holding, layers[-1].z1 - layers[0].z0
    heights = {} if holding is None else {"thickness": holding.skin}
    if holding is not None and holding.tabs is not None:
        heights["height"] = holding.tabs.height
    for key, height in heights.items():
        if height is not None and height >= thickness:
            raise GeometryError(
                f"must be less than the thickness of the part, {thickness:g} mm",
                f"holding.{key}",
                f"{height:g}",
            )
    if (bore := milling.stock.bore) is not None:
        around = [
            boundary
            for boundary in bench.part.boundaries
            if boundary.hole and boundary.nearest() > 0.0
        ]
        what = "the bore of the part" if around else "the width of the part"
        free = 2.0 * min(boundary.nearest() for boundary in around or [bench.part.outermost])
        if bore > free * (1.0 + SAME):
            raise GeometryError(f"must be at most {what}, {free:g} mm", "stock.bore", f"{bore:g}")
    if milling.stock.outline is None:
        return
    blank = coarse(milling.stock.outline)
    for boundary in bench.part.boundaries:
        if not boundary.hole:
            corners = shapely.points(shapely.get_coordinates(coarse(boundary)))
            lacking = float(max(shapely.distance(corners, blank)))
            if lacking > 2.0 * COARSE:
                raise GeometryError(
                    f"the blank is too small: {lacking:.3g} mm are missing at one side of the part",
                    "stock",
                )


def require_size(bench: Bench) -> None:
    """Check that part, blank and tools are no larger than programs are made and simulated for.

    Raises
    ------
    GeometryError
        With the key of the scene.
    """
    milling = bench.milling
    for tool in milling.tools:
        for field, wide in (
            ("diameter", tool.diameter),
            ("shank_diameter", tool.shank_diameter or 0.0),
        ):
            if wide > 2.0 * LARGEST:
                raise ToolError(
                    f"must be at most {2.0 * LARGEST:g} mm for a milling program", tool, field
                )
    around = [boundary for boundary in bench.part.boundaries if not boundary.hole]
    blank = milling.stock.outline
    for what, key, boundaries in (
        ("part", "output.gcode", around),
        ("blank", "stock", [] if blank is None else [blank]),
    ):
        reach = max((boundary.farthest()[0] for boundary in boundaries), default=0.0)
        if reach > LARGEST:
            raise GeometryError(
                f"the {what} reaches {reach:.3g} mm from the cam axis; milling programs are made"
                f" and simulated for up to {LARGEST:g} mm",
                key,
            )


def holding_findings(bench: Bench, cuts: Iterable[Cut]) -> Iterator[Finding]:
    """Findings on what the holding leaves to be done by hand, or to be watched."""
    holding = bench.milling.holding
    if holding is None:
        return
    freed = [cut for cut in cuts if _frees(bench, cut)]
    for cut in freed:
        wall = bench.walls.get(cut.right) if isinstance(cut, ContourCut) else None
        if wall is None or cut.allowance:
            continue
        flank = isinstance(wall.boundary, CurveBoundary)
        if holding.tabs is not None and flank:
            yield Finding(
                "tabs-on-a-flank", "warning",
                f"{cut.name}: {holding.tabs.count} tabs of {holding.tabs.width:g} mm, up to"
                f" {holding.tabs.height:g} mm above the lower face, stand on a flank of the cam and"
                " are to be dressed to its shape",
            )  # fmt: skip
        if wall.boundary.hole and holding.kind == FIXTURE:
            yield Finding(
                LOOSE_CORE, "warning",
                f"{cut.name}: the core inside it is cut free in one piece; the fixture must hold it"
                " as well as the part",
            )  # fmt: skip
    if holding.skin is not None and freed:
        text = f"a skin of {holding.skin:g} mm is left below the part, to be removed by hand"
        yield Finding("onion-skin", "warning", text)


def _is_cut_free(bench: Bench, cuts: Iterable[Cut]) -> bool:
    """Whether nothing of the blank hangs on the part when these cuts are done."""
    holding = bench.milling.holding
    through = 0.0 if holding is None else holding.through
    hangs = holding is not None and (holding.tabs is not None or holding.skin is not None)
    below = bench.milling.stock.bottom > through
    return not (hangs or below) and any(_frees(bench, cut) for cut in cuts)


def _clears_the_blank(bench: Bench, heights: Heights) -> None:
    top = bench.milling.stock.top
    for key, height in (("clearance", heights.clearance), ("retract", heights.retract)):
        if height <= top:
            raise GeometryError(
                f"must be above the blank, {top:g} mm", f"output.gcode.{key}_height", f"{height:g}"
            )


def _is_through(bench: Bench, cut: Cut) -> bool:
    """Whether a cut reaches the lower face of the part, or the skin that is left on it."""
    holding = bench.milling.holding
    skin = 0.0 if holding is None else holding.skin or 0.0
    return cut.bottom <= bench.lower_face + skin


def _frees(bench: Bench, cut: Cut) -> bool:
    """Whether a cut separates part and waste; inside a bore it leaves chips only."""
    if not _is_through(bench, cut):
        return False
    if isinstance(cut, AreaCut):
        return any(not wall.hole for wall in cut.walls)
    return isinstance(cut, ContourCut) and cut.right != "bore"


def _is_there(clamp: Clamp, index: int, names: list[str]) -> bool:
    """Whether a clamp is set during the operation number `index`."""
    since = names.index(clamp.since) if clamp.since else 0
    until = names.index(clamp.until) if clamp.until else len(names)
    # A clamp that is set after it has been taken away is there at the beginning and at the end.
    return since <= index < until if since < until else index >= since or index < until


def _clamp_instructions(clamps: tuple[Clamp, ...], name: str) -> Iterator[str]:
    """Instructions for the operator before the operation `name`: clamps to set come first, so that
    the work is held all the time.
    """
    for key, verb in (("since", "set"), ("until", "take away")):
        yield from (
            f"{verb} the {clamp.obstacle.name}" for clamp in clamps if getattr(clamp, key) == name
        )


def _clears(cut: Cut, obstacle: Obstacle) -> None:
    """Check that the cutter clears the obstacle; GeometryError with key "holding" if not."""
    body = coarse(obstacle.outline)
    touches = False
    if isinstance(cut, ContourCut):
        ring = shapely.boundary(coarse(cut.centre))
        touches = float(shapely.distance(ring, body)) <= cut.tool.radius + 2.0 * COARSE
    elif isinstance(cut, AreaCut):
        area = _area(cut)
        touches = area is not None and bool(shapely.intersects(area, body))
    if touches:
        raise GeometryError(
            f"{cut.name} with tool {cut.tool.number} runs into the {obstacle.name}; move it, or"
            " take it away before that operation",
            "holding",
        )


def _area(cut: AreaCut) -> Area | None:
    """The material that an area cut removes, as a polygon."""
    area = None if cut.stock is None else coarse(cut.stock)
    for wall in cut.walls:
        inside = coarse(wall)
        if wall.hole:
            area = inside if area is None else area.intersection(inside)
        elif area is not None:
            area = area.difference(inside)
    return area


def _holds(bench: Bench, cut: AreaCut | ContourCut, there: Iterable[Clamp]) -> None:
    """Check that a clamp or screw stands on the part when the cut frees it; GeometryError with key
    "holding" if none does.
    """
    walls = cut.walls if isinstance(cut, AreaCut) else (bench.walls[cut.right].boundary,)
    part = [coarse(wall) for wall in walls]
    for clamp in there:
        foot = coarse(clamp.obstacle.outline)
        inside = all(
            shapely.intersects(area, foot) != wall.hole
            for area, wall in zip(part, walls, strict=True)
        )
        if inside:
            return
    raise GeometryError(
        f"{cut.name} cuts the part free while no clamp or screw stands on it", "holding"
    )


# -- sequence -------------------------------------------------------------------------------------
# The cuts of a part, planned or stated, with how it is held.


SEQUENCE: Final = "sequence"
"""Name of the finding that lists a planned sequence."""


@dataclass(frozen=True, slots=True)
class CutSequence:
    """The cuts of a part.

    Attributes
    ----------
    cuts : in their order.
    findings : on the sequence; each cut has notes of its own besides.
    is_cut_free : whether nothing of the blank hangs on the part when they are done.
    """

    cuts: tuple[Cut, ...]
    findings: tuple[Finding, ...]
    is_cut_free: bool


def plan_sequence(
    part: Part, milling: MillingSpec, heights: Heights, compensation: str = COMPUTED
) -> CutSequence:
    """The cuts of a part from its blank.

    Parameters
    ----------
    part : with its highest face at height 0.
    compensation : of finishes that do not state theirs.

    Raises
    ------
    GeometryError
        With the key of the scene, if a tool does not fit, something is missing or too large, a
        clamp is in the way, or what is cut free is not held.
    """
    part.require_heights()
    if part.layers[0] not in part.disc and milling.second is None and not milling.turned:
        raise GeometryError(
            "a hub on the lower face is milled from there: state [second_side]",
            key="part.hub.side",
            value=part.layers[0].name,
        )
    bench = Bench(part, milling, compensation)
    require_size(bench)
    require_room(bench)
    findings: list[Finding] = []
    if milling.operations:
        cuts = stated_cuts(bench)
        # A second side may make what the first does not.
        left = [] if milling.second else [
            name for name in unmade_names(part, cuts) if name not in milling.finished_walls
        ]  # fmt: skip
        if left:
            named = dict.fromkeys(text_name(name) or name for name in left)
            findings.append(
                Finding("left-out", "warning", f"no operation makes {', '.join(named)}")
            )
    else:
        steps = list(planned_steps(bench))
        cuts = [step for step in steps if isinstance(step, Cut)]
        findings = [step for step in steps if isinstance(step, Finding)]
        if milling.turned and not cuts:
            raise GeometryError(
                "nothing is to be milled: the blank is not lower than the part, and the first side"
                " leaves no wall that is open on the lower face; state its operations",
                "second_side",
            )
        listed = ", ".join(f"{cut.name} (tool {cut.tool.number})" for cut in cuts)
        listed = listed or "nothing to mill"
        findings.insert(0, Finding(SEQUENCE, "ok", f"planned: {listed}"))
    if milling.turned:  # the machine runs the mirror image, see `camgeo.milling.milling`
        cuts = [replace(cut, climb=not cut.climb) for cut in cuts]
    cuts = guard_cuts(bench, cuts, heights)
    findings += holding_findings(bench, cuts)
    if milling.earlier:
        sentence = (
            "the tool is stated by earlier keys of [output.gcode], which are still read; [[tool]]"
            " states more"
        )
        findings.append(Finding("earlier-keys", "warning", sentence))
    return CutSequence(tuple(cuts), tuple(findings), _is_cut_free(bench, cuts))
