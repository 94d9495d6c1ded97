"""The sequence of cuts for a scene that states none.

First what is cut while the blank is whole and stiff: its face, hub, bore and holes, the groove;
then what cuts the part free. Each wall is roughed in passes, and finished at full depth with a
round more.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.milling.bench import BORE, Bench, as_wide, bore_of, flank_curve, is_open, letters_of
from camgeo.milling.cut import AreaCut, Cut, core
from camgeo.milling.guard import guarded, require_room, require_size, told_of_holding
from camgeo.milling.judged import left_out
from camgeo.milling.making import (
    clear_area,
    clear_around,
    drill_all,
    drill_at,
    engraved,
    finish_along,
    no_engraver,
    rough_around,
    rough_outside,
    slot_between,
)
from camgeo.milling.milling import MillingSpec
from camgeo.milling.moves import Heights
from camgeo.milling.stated import stated_cuts
from camgeo.milling.tool import COMPUTED, DRILL, Tool
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import Part, Wall
from camgeo.part.spec import text_of

Step = Cut | Finding
"""A cut, or something to be told."""


def planned_steps(bench: Bench) -> Iterator[Step]:
    """The cuts in their order, and what is told of them.

    Raises
    ------
    GeometryError
        With the key of the scene, if no tool can do what is to be done.
    """
    done = bench.milling.done
    walls = {name: each for name, each in bench.walls.items() if name not in done}
    if bench.milling.turned:  # the first side reaches the others, or nothing does
        walls = {name: each for name, each in walls.items() if is_open(bench.part, each)}
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
    """Down to the upper face of the part, where the blank is higher."""
    top = bench.milling.stock.top
    if not top:
        return
    if bench.milling.stock.outline is None:
        key = "stock.length"
        raise GeometryError("the outline of a blank that is to be faced must be known", key)
    tool = bench.choose("upper face", lambda tool: bench.too_short(tool, 0.0, top))
    yield clear_area(bench, "face", "face", tool, top, 0.0, ())


def _boss(bench: Bench, wall: Wall) -> Iterator[Step]:
    """What stands on the disc: cleared around down to its face, then finished."""
    tool = bench.choose(wall.boundary.name, bench.unfit(wall, top=wall.z1))
    allowance = bench.allowance(tool, wall)
    yield clear_around(bench, wall, tool, wall.z1, allowance)
    room = bench.room_outside(tool, bench.compensation)
    yield finish_along(bench, wall, tool, wall.z1, room, rest=allowance)


def _holes(bench: Bench, walls: Collection[str]) -> Iterator[Step]:
    """Holes beside the bore by a drill of their diameter, marks by an end mill of their width; they
    are left out where there is none.
    """
    through: dict[tuple[float, float], dict[str, complex]] = {}
    for wall in (each for each in bench.holes if each.boundary.name in walls):
        boundary = bore_of(wall)
        if bench.pierces(wall):
            size = boundary.round_radius, bench.mouth(wall)
            through.setdefault(size, {})[boundary.name] = complex(boundary.exact.centres[0])
            continue
        width = 2.0 * float(np.max(boundary.exact.radii))
        tool = next(
            (each for each in bench.milling.tools if not no_engraver(bench, each, (wall,))), None
        )
        if tool is not None:
            yield engraved(bench, (wall,), tool, wall.z1)
            continue
        text = f"{boundary.name}: left out, no flat end mill of {width:g} mm fits it"
        yield told(f"{boundary.name}-left-out", text)
    for (radius, top), holes in through.items():
        bottom = bench.bottom(bench.walls[next(iter(holes))])
        names = ", ".join(holes)
        drill = next((each for each in bench.milling.tools if _drills(each, 2.0 * radius)), None)
        if drill is not None and not bench.too_short(drill, bottom, top):
            yield drill_all(f"drill {names}", drill, top, bottom, holes)
            continue
        text = f"left out, no drill of {2.0 * radius:g} mm reaches through"
        yield told("holes-left-out", f"{names}: {text}")


def _texts(bench: Bench, walls: Collection[str]) -> Iterator[Step]:
    """Texts by the first end mill that fits into their strokes; they are left out without one."""
    for text in sorted(set(map(text_of, walls)) - {""}):
        letters = letters_of(bench, text)
        reasons = {
            each: no_engraver(bench, each, letters)
            or ("" if each.stepover and each.stepdown else "it states no stepover or no stepdown")
            for each in bench.milling.tools
        }
        tool = next((each for each, reason in reasons.items() if not reason), None)
        if tool is not None:
            yield engraved(bench, letters, tool, letters[0].z1)
            continue
        why = "; ".join(f"tool {each.number}: {reason}" for each, reason in reasons.items())
        yield told(f"{text.replace(' ', '-')}-left-out", f"{text}: left out, {why}")


def _bore(bench: Bench, wall: Wall) -> Iterator[Step]:
    """Opened from inside; left out where the blank has it, or a round cutter cannot make it."""
    bore, stock = bore_of(wall), bench.milling.stock
    if not bore.is_round:
        text = "bore: left out, it is not round; it is to be cut otherwise"
        yield told("bore-left-out", text)
        return
    diameter, there = 2.0 * bore.round_radius, stock.bore or 0.0
    keyway = "the keyway is left to be broached" if bore.core is not None else ""
    if there == diameter:
        text = f"bore: the blank has it, {diameter:g} mm; it is not milled"
        yield told("bore-left-out", f"{text}; {keyway}" if keyway else text)
        return
    drill = next((each for each in bench.milling.tools if _drills(each, diameter)), None)
    if drill is not None and not bench.too_short(drill, bench.bottom(wall)):
        yield drill_at("bore", drill, 0.0, bench.bottom(wall), complex(bore.exact.centres[0]))
        return
    tool = bench.choose("bore", bench.unfit(wall))
    allowance = bench.allowance(tool, wall)
    room = 0.5 * (bore.round_radius - tool.radius)
    if core(diameter - 2.0 * allowance, tool.diameter) > there:
        bottom = bench.bottom(wall)
        yield clear_area(bench, "rough bore", "bore", tool, 0.0, bottom, (bore,), allowance)
    else:
        yield rough_around(bench, wall, tool, 0.0, allowance)
    yield finish_along(bench, wall, tool, 0.0, room, rest=allowance, note=keyway)


def _drills(tool: Tool, diameter: float) -> bool:
    return tool.kind == DRILL and as_wide(tool, 0.5 * diameter)


def _groove(bench: Bench, inner: Wall, outer: Wall) -> Iterator[Step]:
    """One round of a cutter as wide, or roughed inside and finished along each flank."""
    curve = flank_curve(outer)
    half = curve.distance
    paths = [
        wall.boundary.path for wall in (inner, outer) if isinstance(wall.boundary, CurveBoundary)
    ]
    like = "the roller" if half == curve.pitch.follower.roller_radius else "the groove"
    bottom, top = bench.bottom(outer), outer.z1

    def unfit(tool: Tool) -> str:
        """Where a flank is trimmed, the roller sweeps more than rounds along the flanks clear."""
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
        yield slot_between(bench, inner, outer, tool, top)
        return
    side = half - tool.radius
    walls = [(wall, min(bench.allowance(tool, wall), 0.5 * side)) for wall in (outer, inner)]
    for wall, allowance in walls:
        yield rough_around(bench, wall, tool, top, allowance)
    for wall, allowance in walls:
        yield finish_along(bench, wall, tool, top, 0.5 * side, rest=allowance)


def _rim(bench: Bench, wall: Wall) -> Iterator[Step]:
    """The rim is that of the blank, unless the blank is known to be larger."""
    stock, rim = bench.milling.stock, bore_of(wall)
    diameter = 2.0 * rim.round_radius
    same = stock.diameter is not None and stock.diameter == diameter and not stock.centre
    if stock.outline is None or same:
        text = f"rim: it is that of the blank, {diameter:g} mm in diameter, and not milled"
        yield told("rim-left-out", text)
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


def told(name: str, sentence: str) -> Finding:
    """Something worth knowing of the sequence."""
    return Finding(name, "ok", sentence)


# -- sequence -------------------------------------------------------------------------------------
# The cuts of a part, planned or stated, with how it is held.


SEQUENCE: Final = "sequence"
"""Name of the finding that lists a planned sequence."""


@dataclass(frozen=True, slots=True)
class Sequence:
    """The cuts of a part.

    Attributes
    ----------
    cuts : in their order.
    findings : what is told of them, beside the notes that each has of its own.
    """

    cuts: tuple[Cut, ...]
    findings: tuple[Finding, ...]


def sequence_of(
    part: Part, milling: MillingSpec, heights: Heights, compensation: str = COMPUTED
) -> Sequence:
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
        message = "a hub on the lower face is milled from there: state [second_side]"
        raise GeometryError(message, key="part.hub.side", value=part.layers[0].name)
    bench = Bench(part, milling, compensation)
    require_size(bench)
    require_room(bench)
    findings: list[Finding] = []
    if milling.operations:
        cuts = stated_cuts(bench)
        # A second side may make what the first does not.
        left = [] if milling.second else [
            name for name in left_out(part, cuts) if name not in milling.done
        ]  # fmt: skip
        if left:
            named = dict.fromkeys(text_of(name) or name for name in left)
            sentence = f"no operation makes {', '.join(named)}"
            findings.append(Finding("left-out", "warning", sentence))
    else:
        steps = list(planned_steps(bench))
        cuts = [step for step in steps if isinstance(step, Cut)]
        findings = [step for step in steps if isinstance(step, Finding)]
        if milling.turned and not cuts:
            message = (
                "nothing is to be milled: the blank is not lower than the part, and the first side"
                " leaves no wall that is open on the lower face; state its operations"
            )
            raise GeometryError(message, "second_side")
        findings.insert(0, told(SEQUENCE, f"planned: {_listed(cuts)}"))
    if milling.turned:  # the machine runs the mirror image, see `camgeo.milling.holding`
        cuts = [replace(cut, climb=not cut.climb) for cut in cuts]
    cuts = guarded(bench, cuts, heights)
    findings += told_of_holding(bench, cuts)
    if milling.earlier:
        sentence = (
            "the tool is stated by earlier keys of [output.gcode], which are still read; [[tool]]"
            " states more"
        )
        findings.append(Finding("earlier-keys", "warning", sentence))
    return Sequence(tuple(cuts), tuple(findings))


def _listed(cuts: list[Cut]) -> str:
    return ", ".join(f"{cut.name} (tool {cut.tool.number})" for cut in cuts) or "nothing to mill"
