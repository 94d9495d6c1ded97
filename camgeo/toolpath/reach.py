"""How much material stands before and beside a cutter: against its stepdown and its edges.

Every feed move is judged at its end and in its middle, in front of the cutter and on both sides:
there the material reaches from the tip up to what moves before it have left, exactly. In front of a
cutter it stands as deep as the cutter digs a slot.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from camgeo.contour.pieces import Pieces
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, joined, taken
from camgeo.toolpath.course import Course, course_of
from camgeo.toolpath.moves import Point
from camgeo.toolpath.plane.crossings import inside
from camgeo.toolpath.setup import Run, Setup

SHARES: Final = (0.5, 1.0)
"""Of each piece, where the cutter is judged."""

RIM: Final = 1e-3
"""Share of the radius by which the places looked at lie inside the cutter ahead, and outside on its
sides; what lies twice that inside those that came by before counts as cleared."""

SIDES: Final = np.array([1.0 - RIM, -1j * (1.0 + RIM), 1j * (1.0 + RIM)])
"""Places that are looked at, in radii, seen in the direction of the cutter."""

BATCH: Final = 64
"""Places that are compared with the courses at once."""


@dataclass(frozen=True, slots=True)
class Depth:
    """The deepest material at a cutter in one run.

    Attributes
    ----------
    run, move : numbers of the run, and of the move in it.
    ahead : depth of the slot that the cutter digs [mm].
    beside : height of the material above the tip, ahead or on a side [mm].
    place : of the tip.
    """

    run: int
    move: int
    ahead: float
    beside: float
    place: Point


def depths(setup: Setup, runs: Sequence[Run]) -> Iterator[Depth]:
    """What stands at the cutter in each feed move that is not straight up or down."""
    courses = [course_of(run.moves, run.start) for run in runs]
    if not any(len(each) for each in courses):
        return
    whole = joined(courses)
    owners = np.concatenate([np.full(len(each), k) for k, each in enumerate(courses)])
    radii = np.array([run.radius for run in runs])[owners]
    standing = _standing(setup)
    moving = np.flatnonzero(whole.lengths > 0.0)
    for first in range(0, len(moving), BATCH):
        yield from _of_pieces(
            moving[first : first + BATCH], whole, owners, radii, standing
        )  # fmt: skip


def _standing(setup: Setup) -> Callable[[ComplexArray], FloatArray]:
    """Up to which Z [mm] material reaches at places (n,) at first; -infinite beside it."""
    if setup.before is None:
        blank = Pieces.around(setup.blank)
        return lambda places: np.where(inside(blank, places), setup.top, -np.inf)
    slabs = setup.before.slabs

    def left(places: ComplexArray) -> FloatArray:
        found = np.full(len(places), -np.inf)
        for slab in slabs:  # from the lowest
            found[shapely.contains_xy(slab.material, places.real, places.imag)] = slab.z1
        return found

    return left


def _of_pieces(
    pieces: np.ndarray[tuple[int], np.dtype[np.intp]],
    whole: Course,
    owners: np.ndarray[tuple[int], np.dtype[np.intp]],
    radii: FloatArray,
    standing: Callable[[ComplexArray], FloatArray],
) -> Iterator[Depth]:
    """Of some pieces of the course, in their order."""
    numbers = np.repeat(pieces, len(SHARES))
    shares = np.tile(SHARES, len(pieces))
    some = taken(whole, numbers)
    places, tips = some.at(shares), some.from_z + shares * (some.to_z - some.from_z)
    rims = radii[numbers] * some.tangents(places)
    looked = (places[:, None] + rims[:, None] * SIDES).ravel()
    order = np.repeat(numbers, len(SIDES))
    tops = standing(looked)
    near = _near(whole, looked, radii)
    cleared = _cleared(whole, near, looked, order, radii)
    found = np.minimum(tops, cleared).reshape(-1, len(SIDES)) - tips[:, None]
    for k, piece in enumerate(numbers.tolist()):
        at = (float(places[k].real), float(places[k].imag), float(tips[k]))
        ahead, beside = max(0.0, float(found[k, 0])), max(0.0, float(np.max(found[k])))
        yield Depth(int(owners[piece]), int(whole.moves[piece]), ahead, beside, at)


def _near(whole: Course, places: ComplexArray, radii: FloatArray) -> BoolArray:
    """(n,) which pieces may come within their radius of one of `places`."""
    middle = 0.5 * (whole.starts + whole.ends)
    half = 0.5 * np.abs(whole.ends - whole.starts)
    centre = complex(np.mean(places))
    wide = float(np.max(np.abs(places - centre)))
    found: BoolArray = np.abs(middle - centre) <= half + radii + wide
    return found


def _cleared(
    whole: Course,
    near: BoolArray,
    places: ComplexArray,
    order: np.ndarray[tuple[int], np.dtype[np.intp]],
    radii: FloatArray,
) -> FloatArray:
    """(k,) lowest Z [mm] of a tip that passed over each place before; infinite if none did."""
    picked = np.flatnonzero(near)
    some = taken(whole, picked)
    over = some.apart(places[:, None]) < (1.0 - 2.0 * RIM) * radii[picked]
    over &= picked[None, :] < order[:, None]
    found: FloatArray = np.min(np.where(over, some.lowest[None, :], np.inf), axis=1, initial=np.inf)
    return found
