"""The curve on which the roller centre runs when the roller is pressed against lines and arcs.

It is the contour's parallel at the roller radius: a line gives a line, an arc a concentric arc, a
corner the arc of the roller radius about it. Nothing is trimmed: where the contour turns in, or is
too narrow for the roller, the parallel crosses itself, and the follower's place decides (see
`camgeo.outline.replay_lift`). Each of its points is a roller radius from some point of the
contour, so none can represent a place that the roller does not reach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.follower_path import Bows, FollowerPath
from camgeo.mechanism.lift_jet import lift_jet
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, grouped, joined
from camgeo.units import TURN

MOST_TURN = math.pi / 4.0
"""Largest sweep of a cut arc [rad]: the parameter of a bow is infinite at half a turn."""

POINT = 1e-12
"""An arc whose parallel has less than this fraction of its radius is a point of the roller path."""

SHARP = 0.75 * math.pi
"""A vertex at which the contour turns by more [rad] is a spike or a slot's end."""

BACKWARDS = TURN - 1e-6
"""A branch that seems to cover nearly the whole turn covers none: its ends differ by rounding, the
wrong way round. No branch covers more than a turn less the eighth by which arcs are cut."""


class LinesAndArcs(Protocol):
    """A closed contour as of `camgeo.contour.contour.Contour`, run counter-clockwise [mm, rad]."""

    @property
    def vertices(self) -> ComplexArray: ...

    @property
    def ends(self) -> ComplexArray: ...

    @property
    def sweeps(self) -> FloatArray: ...

    @property
    def centres(self) -> ComplexArray: ...

    @property
    def area(self) -> float: ...


@dataclass(frozen=True, slots=True, eq=False)
class Parallel:
    """Pieces of a parallel of a contour, each a line or an arc.

    Attributes
    ----------
    bows : (m,) on which the pieces lie, known at their starts.
    lengths : (m,) parameters of the ends on the bows [mm]; negative where the piece runs back.
    ends : (m,) complex [mm], its ends.
    elements : (m,) numbers of the contour's pieces; -1 - k of those about vertex k.
    corners : (m,) [rad] turn of the contour at the vertex that a piece goes about; a full turn for
        all other pieces.
    """

    bows: Bows
    lengths: FloatArray
    ends: ComplexArray
    elements: IntArray
    corners: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Branches:
    """Stretches of lines and arcs that each cross the follower's path once at each cam angle.

    Attributes
    ----------
    bows : (m,) on which they lie.
    facing : (m,) +1 where the bow's normal has a part outward along the follower's path, else -1.
    lows, highs : (m,) cam angles [rad] in [0, 2 pi) between which they lie; high < low where a
        branch reaches across cam angle 0. Equal angles cover nothing.
    elements, corners : (m,), as of `Parallel`.
    """

    bows: Bows
    facing: FloatArray
    lows: FloatArray
    highs: FloatArray
    elements: IntArray
    corners: FloatArray

    def jet(
        self, path: FollowerPath, phi: FloatArray, index: IntArray, order: Literal[0, 2, 3]
    ) -> FloatArray:
        """(order + 1, n) lift with derivatives [mm or rad per rad^k] where the path at `phi` (n,)
        [rad] meets the branches `index` (n,).
        """
        bows = self.bows.take(index)
        q = path.meet(phi, bows, self.facing[index])
        if order:
            return lift_jet(path, phi, q, bows)[: order + 1]
        lift: FloatArray = path.outward * (q - path.start)
        return lift[np.newaxis]


def parallel(contour: LinesAndArcs, distance: float) -> Parallel:
    """The parallel of `contour` at `distance` [mm], positive to its right-hand side.

    Between pieces that meet at an angle the arc about the vertex, run backwards where the contour
    turns in; none at distance 0, where a knife edge goes from piece to piece.

    Raises
    ------
    GeometryError
        If the contour has no extent or does not run counter-clockwise.
    """
    starts, ends = contour.vertices, contour.ends
    used = np.flatnonzero((starts != ends) | (contour.sweeps != 0.0))
    if not len(used) or not contour.area > 0.0:
        raise GeometryError("the contour must enclose an area and run counter-clockwise")
    starts, ends = starts[used], ends[used]
    sweeps, centres = contour.sweeps[used], contour.centres[used]
    arc, sense = sweeps != 0.0, np.sign(sweeps)
    chords = ends - starts
    first = _unit(np.where(arc, sense * (starts - centres), -1j * chords))
    last = np.where(arc, _unit(np.where(arc, sense * (ends - centres), 1.0)), first)
    curvatures = np.where(arc, sense / np.where(arc, np.abs(starts - centres), 1.0), 0.0)
    share = 1.0 + curvatures * distance
    kept = np.flatnonzero(np.abs(share) > POINT)
    pieces = cut(
        starts[kept] + distance * first[kept],
        ends[kept] + distance * last[kept],
        first[kept],
        curvatures[kept] / share[kept],
        sweeps[kept],
        np.where(arc, 0.0, np.abs(chords))[kept],
        used[kept],
    )
    if distance == 0.0:
        return pieces
    following = np.roll(first, -1)
    turns = np.angle(following * last.conj())
    # Of a spike the sign of the turn is rounding, and beside a cusp of two arcs they may cross:
    # all places about such a vertex.
    sharp = np.abs(turns) > SHARP
    turns = np.where(sharp, TURN, turns)
    corners = cut(
        ends + distance * last,
        ends + distance * np.where(sharp, last, following),
        last,
        np.full(len(ends), 1.0 / distance),
        turns,
        np.zeros(len(ends)),
        -1 - np.roll(used, -1),
    )
    return joined([pieces, corners])


def circles(centres: ComplexArray, radius: float) -> Parallel:
    """Whole circles of `radius` [mm], negative for an inward normal, about `centres`."""
    number = np.arange(len(centres))
    starts = centres + radius
    zero = np.zeros(len(centres))
    normals = np.ones(len(centres), dtype=np.complex128)
    return cut(starts, starts, normals, zero + 1.0 / radius, zero + TURN, zero, -1 - number)


def branches(pieces: Parallel, path: FollowerPath) -> Branches:
    """Cut `pieces` where the follower's path is tangent to them, and where its reach ends.

    Parts beyond the reach are omitted.
    """
    low, high = path.reach
    bows = pieces.bows
    places = [path.touching(bows), bows.at_distance(low)]
    if math.isfinite(high):
        places.append(bows.at_distance(high))
    inner = np.concatenate(places)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = inner / pieces.lengths
        shares[~((shares > 0.0) & (shares < 1.0))] = np.inf
    count = len(bows)
    shares = np.sort(np.concatenate((np.zeros((1, count)), shares, np.ones((1, count)))), axis=0)
    parts = np.sum(shares <= 1.0, axis=0) - 1
    index, rank = grouped(parts)
    begin, end = shares[rank, index], shares[rank + 1, index]
    bows, lengths = bows.take(index), pieces.lengths[index]
    middle = bows.at(0.5 * (begin + end) * lengths)
    inside = (np.abs(middle) > low) & (np.abs(middle) < high)
    keep = np.flatnonzero(inside)
    index, begin, end, middle = index[keep], begin[keep], end[keep], middle[keep]
    bows, lengths = bows.take(keep), lengths[keep]
    phi, q = path.cam_angle_of(middle)
    along, _ = path.along(phi, q)
    normal = bows.normal_at(middle)
    facing = np.where((normal.conj() * along).real < 0.0, -1.0, 1.0)
    starts = np.where(begin == 0.0, bows.points, bows.at(begin * lengths))
    ends = np.where(end == 1.0, pieces.ends[index], bows.at(end * lengths))
    first, _ = path.cam_angle_of(_within(starts, path.reach))
    last, _ = path.cam_angle_of(_within(ends, path.reach))
    # dphi along the curve has the sign of -sigma * facing, with its normal on the right.
    forward = path.rotation * facing * np.sign(lengths) < 0.0
    lows, highs = np.where(forward, first, last), np.where(forward, last, first)
    none = np.remainder(highs - lows, TURN) > BACKWARDS
    return Branches(
        bows=bows,
        facing=facing,
        lows=lows,
        highs=np.where(none, lows, highs),
        elements=pieces.elements[index],
        corners=pieces.corners[index],
    )


def cut(
    starts: ComplexArray,
    ends: ComplexArray,
    normals: ComplexArray,
    curvatures: FloatArray,
    turns: FloatArray,
    lengths: FloatArray,
    elements: IntArray,
) -> Parallel:
    """Arcs cut into parts of at most MOST_TURN; `lengths` (n,) of those that are lines, else 0."""
    parts = np.maximum(1, np.ceil(np.abs(turns) / MOST_TURN)).astype(np.intp)
    index, rank = grouped(parts)
    step = turns[index] / parts[index]
    normal = normals[index] * np.exp(1j * step * rank)
    kappa = curvatures[index]
    bent = kappa != 0.0
    shift = np.divide(normal - normals[index], kappa, out=np.zeros_like(normal), where=bent)
    point = starts[index] + shift
    finish = np.where(rank + 1 == parts[index], ends[index], np.roll(point, -1))
    way = np.divide(2.0 * np.tan(0.5 * step), kappa, out=np.zeros_like(step), where=bent)
    return Parallel(
        Bows(point, normal, kappa),
        np.where(bent, way, lengths[index]),
        finish,
        elements[index],
        np.where(elements < 0, np.abs(turns), TURN)[index],
    )


def _unit(vectors: ComplexArray) -> ComplexArray:
    """(n,) in the directions of `vectors` (n,); 0 of 0."""
    size = np.abs(vectors)
    out: ComplexArray = np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0.0)
    return out


def _within(points: ComplexArray, reach: tuple[float, float]) -> ComplexArray:
    """(n,) `points` with those just beyond the reach moved to its border."""
    distance = np.abs(points)
    wanted = np.clip(distance, *reach)
    scale = np.divide(wanted, distance, out=np.ones_like(distance), where=distance > 0.0)
    moved: ComplexArray = points * scale
    return moved
