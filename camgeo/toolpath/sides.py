"""A job of one side or two, simulated: the second side starts from what the first one has left.

Each side is judged in coordinates in which its tools come from above (`camgeo.toolpath.turning`);
what is handed on is turned over, slab by slab. What the part must be in the end is asked after the
last side alone, of the material that both have left.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import shapely

from camgeo.contour.contour import Contour
from camgeo.part.part import Part, Wall
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.holding import FIXTURE, Holding
from camgeo.toolpath.judged import setup_of
from camgeo.toolpath.left import TOUCHING, pieces
from camgeo.toolpath.milling import MillingSpec
from camgeo.toolpath.setup import Before, Run, Setup
from camgeo.toolpath.simulation import Simulation, corners_of, simulate
from camgeo.toolpath.stages import Flaw, Slab
from camgeo.toolpath.sweep import NOTHING, Area
from camgeo.toolpath.turning import mirrored
from camgeo.toolpath.verdict import FINENESS, finished_by, finished_down_to, lowest_of


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One setup of a job: what is to be made, and what its tools do.

    Attributes
    ----------
    part, milling : as tools from above see them.
    cuts : that are planned.
    runs : what is run.
    density : of the material [t/mm^3]; None if it is not stated.
    """

    part: Part
    milling: MillingSpec
    cuts: tuple[Cut, ...]
    runs: tuple[Run, ...]
    density: float | None = None

    @property
    def lowest(self) -> float:
        """Z of the part's lower face [mm]."""
        return self.part.layers[0].z0


@dataclass(frozen=True, slots=True, eq=False)
class Done:
    """A side that is simulated."""

    side: Side
    setup: Setup
    simulation: Simulation


def setups_of(sides: Sequence[Side], of: int) -> tuple[Setup, ...]:
    """What each side, the first ones `of` a job, starts from but for the material that is left, and
    what must come of it.
    """
    found: list[Setup] = []
    for k, side in enumerate(sides):
        part, milling = side.part, side.milling
        stock, holding = milling.stock, milling.holding
        others = [cut for other in sides if other is not side for cut in other.cuts]
        setup = setup_of(side.cuts, side.runs, part, stock, holding, FINENESS, others)
        if k:
            setup = _second(setup, side, sides[k - 1], found[k - 1])
        found.append(
            replace(
                setup,
                final=k == of - 1,
                density=side.density,
                unfinished=tuple(_unfinished(sides)),
            )
        )
    return tuple(found)


def simulated(sides: Sequence[Side], *, allowed: float, level: float, of: int) -> tuple[Done, ...]:
    """Each of the first sides `of` a job, as `simulate` judges it, from what the one before it has
    left.
    """
    done: list[Done] = []
    for side, setup in zip(sides, setups_of(sides, of), strict=True):
        own = replace(setup, before=_turned(done[-1])) if done else setup
        found = simulate(own, side.runs, allowed=allowed, level=level)
        done.append(Done(side, own, found))
    return tuple(done)


def settled(done: Sequence[Done]) -> tuple[tuple[Flaw, ...], ...]:
    """The flaws of each side, as its work lies."""
    return tuple(tuple(_seen(flaw, each.side) for flaw in each.simulation.flaws) for each in done)


def _unfinished(sides: Sequence[Side]) -> Iterator[Contour]:
    """The walls that stated operations leave unfinished: what they leave there is to be watched."""
    if not any(side.milling.operations for side in sides):
        return
    for wall in sides[0].part.walls:
        if not is_finished(wall, sides):
            yield wall.boundary.arcs(FINENESS, "fast").contour


def is_finished(wall: Wall, sides: Sequence[Side]) -> bool:
    """Whether one side leaves all of a wall as it is to be, or two that meet on it."""
    first, name = sides[0], wall.boundary.name
    down = finished_down_to(first.cuts, name)
    if down <= lowest_of(wall, first.milling.holding):
        return True
    if len(sides) == 1:
        return False
    second, low = sides[1], first.lowest
    turned = replace(wall, z0=low - wall.z1, z1=low - wall.z0)
    below = finished_down_to(second.cuts, name)
    return below <= lowest_of(turned, second.milling.holding) or down <= low - below


def _seen(flaw: Flaw, side: Side) -> Flaw:
    """The same with its place as the work lies."""
    x, y, z = flaw.place
    place = mirrored(complex(x, y), side.milling.turned)
    return replace(flaw, place=(place.real, place.imag, z))


def _second(setup: Setup, side: Side, first: Side, before: Setup) -> Setup:
    """The setup of a second side, whose blank is what the first one has left.

    A fixture holds the part alone. What the first side has left hanging may stay, unless a wall is
    finished that frees the part.
    """
    holding = side.milling.holding
    own, hanging = _left_on(holding), _left_on(first.milling.holding)
    if any(_frees(cut, side) for cut in side.cuts):
        hanging = None
    held = setup.held
    if holding is not None and holding.kind == FIXTURE:
        held = tuple(body.contours for body in setup.part)
    chamfers = (replace(each, turned=first.lowest) for each in before.chamfers)
    return replace(
        setup,
        held=held,
        joined=None if own is None else side.lowest + own,
        hanging=None if hanging is None else -hanging,
        chamfers=(*setup.chamfers, *chamfers),
    )


def _left_on(holding: Holding | None) -> float | None:
    """Height [mm] of what a holding leaves on the part: tabs, a skin; None for nothing."""
    if holding is None or holding.tabs is None:
        return None if holding is None else holding.skin
    return holding.tabs.height


def _frees(cut: Cut, side: Side) -> bool:
    """Whether a cut of the second side finishes a wall around the part."""
    around = {wall.boundary.name for wall in side.part.walls if not wall.boundary.hole}
    return bool(around & set(finished_by(cut)))


def _turned(done: Done) -> Before:
    """What a side has left of the piece with the part in it, seen from the other side."""
    low, simulation = done.side.lowest, done.simulation
    slabs = simulation.stages[-1].slabs if simulation.stages else ()
    kept = _with_the_part(slabs, simulation.part)
    corners = corners_of(done.setup, done.side.runs)
    return Before(
        tuple(Slab(low - each.z1, low - each.z0, each.material) for each in reversed(kept)),
        tuple((low - z1, low - z0) for z0, z1 in corners),
    )


def _with_the_part(slabs: Sequence[Slab], part: Sequence[Area]) -> tuple[Slab, ...]:
    """The material without pieces that are apart from the part: they are taken away."""
    found = pieces(slabs)
    away = [piece for piece in found if piece.shared(part) <= TOUCHING]
    if not away:
        return tuple(slabs)
    gone: dict[int, list[Area]] = {}
    for piece in away:
        for k, area in piece.areas:
            gone.setdefault(k, []).append(area)
    return tuple(
        slab.without(shapely.union_all(gone[k]) if k in gone else NOTHING)
        for k, slab in enumerate(slabs)
    )
