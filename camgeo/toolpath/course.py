"""The course of a cutter in the plane: lines and arcs of its centre, and what lies near them.

Exact to the rounding of a few operations: no piece is replaced by chords.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.contour.contour import Contour, lengths_of, radii_of
from camgeo.contour.spline import Arc
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    frozen,
    joined,
    taken,
)
from camgeo.toolpath.machining_time import arc_sweep
from camgeo.toolpath.moves import ArcFeed, Move, Point, Rapid, Stop

HALF_TURN: Final = np.pi
"""No piece turns by more, so that the circle around its chord holds it."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """Pieces in the order in which they are run; each begins anywhere.

    Attributes
    ----------
    starts, ends : (n,) complex [mm]; equal where the cutter moves along Z alone.
    sweeps : (n,) [rad], positive counter-clockwise, at most half a turn; 0 for lines.
    centres : (n,) complex [mm]; 0 for lines.
    from_z, to_z : (n,) Z of the tip [mm] at both ends of each piece, with a constant slope between.
    moves : (n,) index of the move that it is part of.
    """

    starts: ComplexArray
    ends: ComplexArray
    sweeps: FloatArray
    centres: ComplexArray
    from_z: FloatArray
    to_z: FloatArray
    moves: IntArray

    def __post_init__(self) -> None:
        for name in ("starts", "ends", "centres"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.complex128))
        for name in ("sweeps", "from_z", "to_z"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.float64))
        object.__setattr__(self, "moves", frozen(self.moves, np.intp))

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def highest(self) -> FloatArray:
        """(n,) largest Z of the tip [mm] on each piece."""
        return np.maximum(self.from_z, self.to_z)

    @property
    def lowest(self) -> FloatArray:
        """(n,) least Z of the tip [mm] on each piece."""
        return np.minimum(self.from_z, self.to_z)

    @property
    def cleared(self) -> FloatArray:
        """(n,) Z [mm] down to which all of a piece has been run: that of its higher end, and of a
        move along Z that of its lower one.
        """
        upright = (self.starts == self.ends) & (self.sweeps == 0.0)
        return np.where(upright, self.lowest, self.highest)

    @property
    def radii(self) -> FloatArray:
        """(n,) [mm] of arcs; 0 for lines."""
        return radii_of(self.starts, self.sweeps, self.centres)

    @property
    def lengths(self) -> FloatArray:
        """(n,) [mm] in the plane."""
        return lengths_of(self.starts, self.ends, self.sweeps, self.radii)

    def at(self, piece: int, share: float) -> tuple[complex, complex]:
        """Place [mm] and direction, a unit vector, at a share of a piece's length."""
        start, sweep = complex(self.starts[piece]), float(self.sweeps[piece])
        if sweep == 0.0:
            along = complex(self.ends[piece]) - start
            return start + share * along, along / abs(along)
        centre = complex(self.centres[piece])
        arm = (start - centre) * np.exp(1j * sweep * share)
        return complex(centre + arm), complex(1j * np.sign(sweep) * arm / abs(arm))


def below(course: Course, z: float) -> Course:
    """The parts of the pieces on which the tip is not above `z` [mm]."""
    course = taken(course, course.lowest <= z)
    if np.all(course.highest <= z):
        return course
    rise = course.to_z - course.from_z
    share = np.divide(z - course.from_z, rise, out=np.ones(len(course)), where=rise != 0.0)
    share = np.clip(share, 0.0, 1.0)
    first = np.where(course.from_z > z, share, 0.0)
    last = np.where(course.to_z > z, share, 1.0)
    return Course(
        _at(course, first),
        _at(course, last),
        course.sweeps * (last - first),
        course.centres,
        np.minimum(course.from_z, z),
        np.minimum(course.to_z, z),
        course.moves,
    )


def _at(course: Course, shares: FloatArray) -> ComplexArray:
    """(n,) places [mm] at a share of each piece; its own ends at 0 and 1."""
    along = course.starts + (course.ends - course.starts) * shares
    turned = course.centres + (course.starts - course.centres) * np.exp(1j * course.sweeps * shares)
    found = np.where(course.sweeps != 0.0, turned, along)
    found = np.where(shares == 0.0, course.starts, found)
    places: ComplexArray = np.where(shares == 1.0, course.ends, found)
    return places


def course_of(moves: Iterable[Move | Stop], at: Point | None = None) -> Course:
    """The course of the feed moves; traverses cut nothing and are left out.

    Parameters
    ----------
    at : where the cutter stands before; None if the first move is a traverse.
    """
    rows: list[tuple[complex, complex, float, complex, float, float, int]] = []
    for number, move in enumerate(moves):
        if isinstance(move, Stop):
            continue
        end = complex(move.end[0], move.end[1])
        if at is not None and not isinstance(move, Rapid):
            start = complex(at[0], at[1])
            if isinstance(move, ArcFeed):
                centre = complex(*move.centre)
                sweep = arc_sweep(start - centre, end - centre, ccw=move.ccw)
                arcs = Arc(start, end, sweep, centre).split(HALF_TURN)
                heights = np.linspace(at[2], move.end[2], len(arcs) + 1).tolist()
                for arc, high, low in zip(arcs, heights, heights[1:], strict=False):
                    rows.append((arc.start, arc.end, arc.sweep, arc.centre, high, low, number))
            else:
                rows.append((start, end, 0.0, 0j, at[2], move.end[2], number))
        at = move.end
    places = np.array([row[:4] for row in rows], dtype=np.complex128).reshape(-1, 4)
    levels = np.array([row[4:6] for row in rows], dtype=np.float64).reshape(-1, 2)
    return Course(
        places[:, 0],
        places[:, 1],
        places[:, 2].real,
        places[:, 3],
        levels[:, 0],
        levels[:, 1],
        np.array([row[6] for row in rows], dtype=np.intp),
    )


def boundary_of(contours: Iterable[Contour]) -> Course:
    """The pieces of closed contours, at no height."""
    pieces = [each.split(HALF_TURN) for each in contours]
    empty = np.zeros(0, dtype=np.complex128)
    none = Contour(empty, empty.real, empty)
    whole = joined([none, *pieces])
    zero = np.zeros(len(whole))
    return Course(
        whole.vertices,
        np.concatenate([none.vertices, *(each.ends for each in pieces)]),
        whole.sweeps,
        whole.centres,
        zero,
        zero,
        zero.astype(int),
    )


def near(course: Course, place: complex, reach: float) -> BoolArray:
    """(n,) whether a piece may come closer than `reach` [mm] to `place`."""
    middle = 0.5 * (course.starts + course.ends)
    half = 0.5 * np.abs(course.ends - course.starts)
    found: BoolArray = np.abs(middle - place) < half + reach
    return found


def distances(course: Course, places: ComplexArray) -> FloatArray:
    """(k, n) distances [mm] of `places` (k,) from the pieces."""
    q = places[:, None]
    along = course.ends - course.starts
    square = np.abs(along) ** 2
    to_start = q - course.starts
    share = np.real(to_start * np.conj(along)) / np.where(square > 0.0, square, 1.0)
    from_line = np.abs(to_start - np.clip(share, 0.0, 1.0) * along)
    arcs = course.sweeps != 0.0
    if not np.any(arcs):
        return from_line
    arms = course.starts - course.centres
    out = q - course.centres
    turn = np.angle(out * np.conj(arms)) * np.sign(course.sweeps)
    turn = np.where(turn < 0.0, turn + 2.0 * np.pi, turn)
    ends = np.minimum(np.abs(to_start), np.abs(q - course.ends))
    beside = np.abs(np.abs(out) - np.abs(arms))
    from_arc = np.where(turn <= np.abs(course.sweeps), beside, ends)
    return np.where(arcs, from_arc, from_line)


def inside(boundary: Course, places: ComplexArray) -> BoolArray:
    """(k,) whether `places` (k,) lie within an odd number of the closed contours of `boundary`."""
    q = places[:, None]
    start, end = boundary.starts - q, boundary.ends - q
    up = start.imag <= 0.0
    crosses = up != (end.imag <= 0.0)
    along = boundary.ends - boundary.starts
    side = start.real * end.imag - start.imag * end.real  # > 0 where q lies left of the chord
    # On the chord itself as if q lay a little higher, as for the ends of the chord.
    side = np.where(side != 0.0, side, np.where(along.real != 0.0, along.real, -along.imag))
    odd = crosses & (np.where(up, side, -side) > 0.0)
    arcs = boundary.sweeps != 0.0
    if np.any(arcs):
        # Between chord and arc the arc has q on the other side.
        within = np.abs(q - boundary.centres) < np.abs(boundary.starts - boundary.centres)
        beyond = side * np.sign(boundary.sweeps) < 0.0
        odd ^= arcs & within & beyond
    found: BoolArray = np.sum(odd, axis=1) % 2 == 1
    return found


def crossings(course: Course, place: complex, radius: float, distance: float) -> FloatArray:
    """(m,) angles [rad] at which the circle around `place` may meet what is `distance` away.

    All angles at which the distance of a point of the circle from the pieces passes `distance` are
    among them; others are too.
    """
    arcs = course.sweeps != 0.0
    found = []
    lines = ~arcs & (course.starts != course.ends)
    if np.any(lines):
        along = course.ends[lines] - course.starts[lines]
        normal = 1j * along / np.abs(along)
        height = np.real((course.starts[lines] - place) * np.conj(normal))
        for side in (-distance, distance):
            found += _pairs(np.angle(normal), (height + side) / radius)
    circles: list[tuple[ComplexArray, FloatArray]] = []
    if distance > 0.0:
        both = np.concatenate((course.starts, course.ends))
        circles.append((both, np.full(len(both), distance)))
    if np.any(arcs):
        arms = np.abs(course.starts[arcs] - course.centres[arcs])
        for side in (-distance, distance):
            circles.append((course.centres[arcs], np.abs(arms + side)))
    for centres, radii in circles:
        away = np.abs(centres - place)
        cosine = (away**2 + radius**2 - radii**2) / np.where(
            away > 0.0, 2.0 * away * radius, np.nan
        )
        found += _pairs(np.angle(centres - place), cosine)
    return np.concatenate(found) if found else np.zeros(0)


def _pairs(middle: FloatArray, cosine: FloatArray) -> list[FloatArray]:
    """Both angles around `middle` with that cosine, where there are any."""
    real = np.abs(cosine) <= 1.0
    half = np.arccos(cosine[real])
    return [middle[real] - half, middle[real] + half]
