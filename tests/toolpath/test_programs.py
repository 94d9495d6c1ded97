"""Whole programs of small scenes: what they leave of the blank, how they run, and all that is said.

What is left is counted at points beside the walls, with no area and no chord: a point is gone if
the cutter has passed over it, low enough.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

from camgeo.milling.cut import ContourCut
from camgeo.milling.milling import CHAMFER_MILL
from camgeo.milling.moves import Operation
from camgeo.part.part import Part, Wall
from tests.kept import compare_documents
from tests.toolpath.cutting import Step, steps_of
from tests.toolpath.programs import NAMES, TOLERANCE, document, milled, toolpath


@pytest.mark.parametrize("name", NAMES)
def test_all_that_is_said_of_a_program_is_as_kept(name: str) -> None:
    """Cuts, moves, findings, times, depths, places: as they were found and looked at before."""
    compare_documents(f"toolpath/programs/{name}", document(name))


@cache
def steps(name: str) -> list[tuple[Operation, list[Step]]]:
    """The feed moves of the operations of a program."""
    return [(each, steps_of(each.moves)) for each in toolpath(name).operations]


def radii_at(operation: Operation, over: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """(n,) radius of the cutter [mm] at heights over its tip."""
    tool = operation.tool
    if tool.tip_angle is not None:
        return np.minimum(tool.radius, over * math.tan(0.5 * tool.tip_angle))
    corner = tool.corner_radius
    short = np.maximum(corner - over, 0.0)
    return np.asarray(tool.radius - corner + np.sqrt(np.maximum(corner**2 - short**2, 0.0)))


def beside(wall: Wall, off: float, count: int = 60) -> np.ndarray[Any, Any]:
    """(n,) places in the waste beside a wall, or in the part where `off` [mm] is below 0, evenly
    along it.
    """
    places = wall.boundary.offset(off).arcs(0.005, "fast").contour.points(1e-3)
    closed = np.append(places, places[:1])
    along = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(closed)))))
    even = np.linspace(0.0, along[-1], count, endpoint=False)
    return np.asarray(
        np.interp(even, along, closed.real) + 1j * np.interp(even, along, closed.imag)
    )


def gone(
    name: str, places: np.ndarray[Any, Any], z: float, *, surely: bool = True
) -> np.ndarray[Any, Any]:
    """(n,) whether the material at places is gone at the height z [mm]: surely, by moves that are
    all as low, or perhaps, by any that get there.
    """
    found = np.zeros(len(places), dtype=bool)
    for operation, own in steps(name):
        start, end, centre = (np.array([getattr(each, key) for each in own])
                              for key in ("start", "end", "centre"))  # fmt: skip
        sweep, way = (np.array([getattr(each, key) for each in own]) for key in ("sweep", "way"))
        ends = np.array([(each.high, each.low) for each in own])
        low = np.where((way > 0.0) & surely, np.max(ends, axis=1), np.min(ends, axis=1))
        at = places[:, None]
        apart = np.minimum(np.abs(at - start), np.abs(at - end))
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = np.mod(np.angle((at - centre) / (start - centre)) * np.sign(sweep), 2 * np.pi)
            seen = (at - start) * np.conj(end - start) / way
        off = np.abs(np.abs(at - centre) - np.abs(start - centre))
        bent, straight = sweep != 0.0, (sweep == 0.0) & (way > 0.0)
        apart = np.where(bent & (ahead <= np.abs(sweep)), off, apart)
        beside = straight & (seen.real >= 0.0) & (seen.real <= way)
        apart = np.where(beside, np.abs(seen.imag), apart)
        over = (apart < radii_at(operation, z - low)) & (low <= z)
        found |= np.any(over, axis=1)
    return found


def finished(name: str, part: Part) -> Iterator[tuple[Wall, float]]:
    """The walls that a program leaves as they are to be, and down to where [mm]."""
    for wall in part.walls:
        bottoms = [
            cut.bottom for cut in milled(name).cuts
            if wall.boundary.name in cut.produced and not cut.allowance
            and cut.tool.kind != CHAMFER_MILL and isinstance(cut, ContourCut)
        ]  # fmt: skip
        if bottoms:
            yield wall, max(wall.z0, min(bottoms))


@pytest.mark.parametrize("name", NAMES)
def test_the_part_is_left_and_nothing_beside_it(name: str) -> None:
    """A twentieth of a millimetre beside the walls, near both ends of each and in its middle."""
    part = milled(name).part
    checked = 0
    for wall, bottom in finished(name, part):
        cut = next(each for each in reversed(milled(name).contour_cuts)
                   if wall.boundary.name in each.produced)  # fmt: skip
        low = bottom if cut.tabs is None else cut.bottom + cut.tabs.height
        for z in (low + 0.05, 0.5 * (bottom + wall.z1), wall.z1 - 0.55):
            assert np.all(gone(name, beside(wall, 0.05), z)), (wall.boundary.name, z)
            perhaps = gone(name, beside(wall, -0.05), z, surely=False)
            assert not np.any(perhaps), (wall.boundary.name, z)
            checked += 1
        if cut.tabs is not None:  # each is as wide as stated at its top, and wider below it
            length = wall.boundary.arcs(0.01, "fast").contour.length
            left = ~gone(name, beside(wall, 0.05, 600), low - 0.05, surely=False)
            width = float(np.mean(left)) * length / cut.tabs.count
            assert cut.tabs.width <= width < cut.tabs.width + cut.tool.diameter
            assert not np.all(~gone(name, beside(wall, 0.05), bottom + 0.05))
    assert checked or name in ("engraved", "a second side, faced free")


@pytest.mark.parametrize("name", NAMES)
def test_the_contact_runs_at_the_feed(name: str) -> None:
    """On level rounds along walls: the side of the wall by places of it, not by a rule."""
    part = {wall.boundary.name: wall.boundary for wall in milled(name).part.walls}
    for operation, own in steps(name):
        cut = operation.cut
        # Neither between two walls, nor along an edge.
        if not isinstance(cut, ContourCut) or cut.left or not cut.right:
            continue
        wall = part[cut.right].arcs(TOLERANCE, "fast").contour.points(TOLERANCE)
        for each in (step for step in own if step.high == step.low and step.way):
            radius = each.radius if each.sweep else math.inf
            around = (each.sweep > 0.0) == cut.climb and radius < math.inf
            share = radius / (radius + cut.contact_radius) if around else 1.0
            assert each.feed == pytest.approx(cut.tool.feed * share, rel=1e-9)
            middle = each.centre + (each.start - each.centre) * np.exp(0.5j * each.sweep)
            near = wall[int(np.argmin(np.abs(wall - middle)))]
            off = abs(abs(near - middle) - cut.tool.radius)
            if each.sweep and off < 3.0 * TOLERANCE and radius > 1.0:
                assert (abs(near - each.centre) > radius) == around
