"""Areas that a cutter clears: contours that rays from a pole meet once, and spirals between them.

In each direction the distance from the pole is r = (1 - u) a + u b, with a the curve at which the
cutter first touches the stock and b that on which the cut ends. u grows evenly with the angle
turned, or ever more slowly where the end is what limits the pace, as at hollow flanks; it eases
into 1, where the path joins b along its tangent.

The cutter's engagement is measured on what the turn before has left: the arc of its circle from
the point where it makes the new wall forward to where it crosses the wall of that turn, and in the
first turn that of the stock.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Pieces
from camgeo.milling.track import Track, biarcs
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, Side, ascending
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.units import TURN

PER_TURN = 720
"""Places per turn at which the engagement is measured for pacing."""

EASE = 0.25
"""Turns over which the spiral eases into the curve on which it ends."""

MOST_TURNS = 500
"""More is a stepover far too small for the stock."""

NEARLY = 0.01
"""Turns by which a spiral may be longer than it has to."""

SLOWINGS = (0.2, 0.35, 0.5)
"""Of the pace, that are tried; each pays only if it saves `WORTH` turns."""

WORTH = 0.2

PLACES = (0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9)
"""Shares of a span at which a fit is compared with the spiral."""

SPANS, MOST_SPANS = 8, 4096
"""Biarcs a turn that a fit begins with, and at most."""


@dataclass(frozen=True, slots=True)
class Morph:
    """The spiral r = (1 - u) a + u b; `w` is the angle turned along it [rad], 0 where u is 0.

    Attributes
    ----------
    a, b : where it begins and where it ends, about the same pole.
    sense : 1 counter-clockwise, -1 clockwise.
    side : where the material is, -1 on the right of the path, as in climb milling, 1 on its left.
    finish : direction [rad] in which it joins b.
    turns : number of turns from a to b.
    slowing : share of its first pace, 0 to 1, that it has lost where it begins to ease into b.
    """

    a: Star
    b: Star
    sense: int
    side: int
    finish: float
    turns: float
    slowing: float = 0.0

    @property
    def ease(self) -> float:
        """Turns over which it eases into b."""
        return min(EASE, 0.5 * self.turns)

    @property
    def rate(self) -> float:
        """Growth of u per turn at the beginning, where it is largest."""
        plain = self.turns - self.ease
        return 1.0 / (plain * (1.0 - 0.5 * self.slowing) + 0.5 * self.ease * (1.0 - self.slowing))

    def share(self, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) u and its derivative at `turn` (m,), in turns; 0 before 0 and 1 beyond `turns`."""
        left = self.turns - turn
        ease, rate, lost = self.ease, self.rate, self.slowing / (self.turns - self.ease)
        last = rate * (1.0 - self.slowing)
        u = np.where(
            left < ease, 1.0 - 0.5 * last * left**2 / ease, rate * turn * (1.0 - 0.5 * lost * turn)
        )
        slope = np.where(left < ease, last * left / ease, rate * (1.0 - lost * turn))
        u = np.where(turn <= 0.0, 0.0, np.where(left <= 0.0, 1.0, u))
        return u, np.where((turn < 0.0) | (left <= 0.0), 0.0, slope)

    def at(self, turn: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(m,) points [mm] and unit tangents at `turn` (m,), in turns from where u leaves 0."""
        direction = self.finish + self.sense * 2.0 * np.pi * (turn - self.turns)
        (ra, sa), (rb, sb) = self.a.at(direction), self.b.at(direction)
        u, slope = self.share(turn)
        r = (1.0 - u) * ra + u * rb
        growth = slope / (2.0 * np.pi) * (rb - ra) + self.sense * ((1.0 - u) * sa + u * sb)
        ray = np.exp(1j * direction)
        along = ray * (growth + 1j * self.sense * r)
        return self.a.pole + ray * r, along / np.abs(along)


def engagements(morph: Morph, radius: float, per_turn: int = PER_TURN) -> FloatArray:
    """(m,) [rad] engagement of a cutter of `radius` [mm] at even steps along `morph`.

    From its beginning to one turn beyond its end; 0 where the cutter runs in air.
    """
    count = math.ceil((morph.turns + 1.0) * per_turn)
    turn = np.arange(-per_turn, count + 1) / per_turn
    points, tangents = morph.at(turn)
    walls = points + 1j * morph.side * tangents * radius
    now = np.arange(per_turn, len(turn))
    centre, normal = points[now], 1j * morph.side * tangents[now]
    found = np.zeros(len(now))
    inside = np.abs(walls[now - per_turn] - centre) < radius
    # Forward along the wall of the turn before until it leaves the cutter's circle.
    before = walls[now - per_turn]
    waiting = np.flatnonzero(inside)
    for step in range(1, per_turn):
        ahead = np.minimum(now[waiting] - per_turn + step, now[waiting])
        after = walls[ahead]
        out = np.abs(after - centre[waiting]) >= radius
        done = waiting[out]
        start, way = before[done] - centre[done], after[out] - before[done]
        # The point between the two on the circle.
        half, square = (np.conj(start) * way).real, np.abs(way) ** 2
        rest = radius**2 - np.abs(start) ** 2
        share = (np.sqrt(half**2 + square * rest) - half) / np.where(square > 0.0, square, 1.0)
        arm = start + np.clip(share, 0.0, 1.0) * way
        found[done] = -morph.side * np.angle(arm * np.conj(normal[done]))
        before[waiting] = after
        waiting = waiting[~out]
        if not len(waiting):
            break
    found[waiting] = np.pi  # the wall never leaves the circle
    return np.maximum(found, 0.0)


def paced(
    a: Star,
    b: Star,
    *,
    sense: int,
    side: int,
    finish: float,
    radius: float,
    limit: float,
    step: float,
) -> Morph:
    """The shortest spiral whose engagement is at most `limit` [rad] and whose turns lie at most
    `step` [mm] apart along any ray.

    Raises
    ------
    GeometryError
        If that takes more than `MOST_TURNS`.
    """
    rays = np.linspace(0.0, 2.0 * np.pi, PER_TURN, endpoint=False)
    travel = float(np.max(np.abs(a.at(rays)[0] - b.at(rays)[0])))
    fewest = max(travel / step, 1e-3)
    if fewest > MOST_TURNS:
        message = f"makes more than {MOST_TURNS} turns of the roughing spiral"
        raise GeometryError(message, key="tool.stepover", value=f"{step:g}")

    # Without slowing, 1 / rate is the number of turns less half of those in which it eases.
    plain = Morph(a, b, sense, side, finish, fewest + 0.5 * min(EASE, fewest))

    def holds(morph: Morph) -> bool:
        if morph.rate * travel > step * (1.0 + 1e-9):
            return False
        return float(np.max(engagements(morph, radius))) <= limit

    best = _shortest(plain, MOST_TURNS, holds)
    if best is None:
        message = f"is too small: no roughing spiral of {MOST_TURNS} turns keeps to it"
        raise GeometryError(message, "tool.engagement", f"{math.degrees(limit):g}")
    for slowing in SLOWINGS:
        shorter = replace(best, turns=best.turns - WORTH, slowing=slowing)
        if shorter.turns > plain.turns and holds(shorter):
            best = _shortest(replace(plain, slowing=slowing), best.turns, holds) or shorter
    return best


def _shortest(morph: Morph, most: float, holds: Callable[[Morph], bool]) -> Morph | None:
    """The morph with the fewest turns, at least its own and about `most` at most, that holds."""
    if holds(morph):
        return morph
    low = high = morph.turns
    while not holds(replace(morph, turns=high)):
        if high > most:
            return None
        low, high = high, 1.3 * high + 0.5
    while high - low > NEARLY:
        middle = 0.5 * (low + high)
        if holds(replace(morph, turns=middle)):
            high = middle
        else:
            low = middle
    return replace(morph, turns=high)


def fitted(morph: Morph, tolerance: float) -> Track:
    """The spiral as tangential arcs, found within `tolerance` [mm] of it, from its beginning to
    where it joins b.

    The distance is taken at `PLACES` of each span, and must leave a fifth of the tolerance for what
    lies between them. How near the arcs come to the part is proved from the arcs themselves.
    """
    spans = max(2, math.ceil(SPANS * morph.turns))
    joints = np.linspace(0.0, morph.turns, spans + 1)
    # A joint where the curvature jumps, and no short span beside it.
    easing = morph.turns - morph.ease
    joints[1 + int(np.argmin(np.abs(joints[1:-1] - easing)))] = easing
    most = MOST_SPANS * math.ceil(morph.turns)
    while len(joints) <= most:
        points, tangents = morph.at(joints)
        track = biarcs(points, tangents)
        coarse = np.zeros(len(joints) - 1, dtype=np.bool_)
        for share in PLACES:
            there, _ = morph.at(joints[:-1] + share * np.diff(joints))
            coarse |= _off(there, track) > 0.8 * tolerance
        if not np.any(coarse):
            return track
        middles = 0.5 * (joints[:-1] + joints[1:])[coarse]
        joints = np.sort(np.concatenate((joints, middles)))
    raise GeometryError(f"cannot follow the spiral within {tolerance:g} mm", "toolpath")


def _off(points: ComplexArray, track: Track) -> FloatArray:
    """(n,) distance [mm] of each point from the two arcs of its span."""
    found = np.empty(len(points))
    for parity in (0, 1):
        pieces = slice(parity, None, 2)
        start, end = track.starts[pieces], track.ends[pieces]
        sweep, centre = track.sweeps[pieces], track.centres[pieces]
        line = np.abs((np.conj(end - start) * (points - start)).imag) / np.abs(end - start)
        off = np.where(sweep == 0.0, line, np.abs(np.abs(points - centre) - np.abs(start - centre)))
        found = off if parity == 0 else np.minimum(found, off)
    return found


# -- star -----------------------------------------------------------------------------------------
# Closed contours that every ray from a pole meets once: their distance from it by direction.


STEEPEST = 0.05
"""Least cosine of the angle between a ray's normal and the contour: a steeper one is refused."""

SPLIT = 0.5 * np.pi
"""Arcs are cut into parts of at most this sweep, so that none reaches round its centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Star:
    """A contour seen from the pole.

    Attributes
    ----------
    pole : complex [mm].
    angles : (n,) [rad] directions at which the pieces begin, ascending from `angles[0]` over less
        than one turn.
    starts, ends, centres : (n,) complex [mm] of the pieces, relative to the pole.
    sweeps : (n,) [rad].
    """

    pole: complex
    angles: FloatArray
    starts: ComplexArray
    ends: ComplexArray
    centres: ComplexArray
    sweeps: FloatArray

    @classmethod
    def of(cls, contour: Contour, pole: complex = 0j) -> Self | None:
        """The contour seen from `pole`.

        None if some ray may meet it more than once, or nearly along it.
        """
        pieces = contour.counter_clockwise().split(SPLIT)
        starts, ends = pieces.vertices - pole, pieces.ends - pole
        centres, sweeps = pieces.centres - pole, pieces.sweeps
        turns = np.angle(ends * np.conj(starts))
        if np.min(_uprightness(starts, ends, centres, sweeps)) < STEEPEST:
            return None
        if np.any(turns <= 0.0) or abs(float(np.sum(turns)) - 2.0 * np.pi) > 1e-6:
            return None
        angles = float(np.angle(starts[0])) + np.concatenate(([0.0], np.cumsum(turns)[:-1]))
        return cls(pole, angles, starts, ends, np.where(sweeps == 0.0, 0.0, centres), sweeps)

    def at(self, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(m,) distances r [mm] from the pole in `directions` (m,) [rad], and dr/d(direction)."""
        ahead = np.mod(directions - self.angles[0], 2.0 * np.pi) + self.angles[0]
        index = np.clip(np.searchsorted(self.angles, ahead, "right") - 1, 0, len(self.angles) - 1)
        ray = np.exp(1j * directions)
        start, centre, sweep = self.starts[index], self.centres[index], self.sweeps[index]
        chord = self.ends[index] - start
        straight = (np.conj(start) * chord).imag / (np.conj(ray) * chord).imag
        seen = np.conj(ray) * centre
        foot, off = seen.real, seen.imag
        half = np.sqrt(np.maximum(np.abs(start - centre) ** 2 - off * off, 0.0))
        r = np.where(sweep == 0.0, straight, foot + np.sign(sweep) * half)
        along = np.where(sweep == 0.0, chord, 1j * np.sign(sweep) * (r * ray - centre))
        turned = np.conj(ray) * along
        return r, r * turned.real / turned.imag

    def distances(self, beyond: Star | None = None) -> Extremes:
        """Smallest and largest distance [mm] from the pole, or `beyond` another contour about the
        same pole, each with its direction [rad].
        """
        stars = [self] if beyond is None else [self, beyond]
        turns = np.concatenate([np.mod(star.angles, TURN) for star in stars])

        def distance(directions: FloatArray, _: Side) -> FloatArray:
            own = self.at(directions)[0]
            return own if beyond is None else own - beyond.at(directions)[0]

        return piecewise_extremes(distance, ascending(np.append(turns, [0.0, TURN])))

    def along(self, direction: float) -> float:
        """Distance [mm] along the contour, counter-clockwise from its first vertex, to where the
        ray in `direction` [rad] meets it.
        """
        point = complex(self.points(np.array([direction]))[0]) - self.pole
        ahead = (direction - self.angles[0]) % (2.0 * np.pi) + self.angles[0]
        index = max(int(np.searchsorted(self.angles, ahead, "right")) - 1, 0)
        arms = self.starts - self.centres
        straight = np.abs(self.ends - self.starts)
        lengths = np.where(self.sweeps == 0.0, straight, np.abs(self.sweeps * arms))
        way = abs(point - self.starts[index])
        if self.sweeps[index]:
            turned = np.angle((point - self.centres[index]) / arms[index])
            way = abs(turned) * abs(arms[index])
        return float(np.sum(lengths[:index]) + way)

    def points(self, directions: FloatArray) -> ComplexArray:
        """(m,) complex [mm] of the contour in `directions` (m,) [rad]."""
        found: ComplexArray = self.pole + self.at(directions)[0] * np.exp(1j * directions)
        return found


def _uprightness(
    starts: ComplexArray, ends: ComplexArray, centres: ComplexArray, sweeps: FloatArray
) -> FloatArray:
    """(n,) the least cosine along each piece of the angle between it and the normal of the ray.

    It is weighted by the distance from the pole over the least one of the piece's ends.
    """
    chord = ends - starts
    size = np.where(chord == 0.0, 1.0, np.abs(chord))
    straight = (np.conj(starts) * chord).imag / size
    radius = np.abs(starts - centres)
    sign = np.where(sweeps < 0.0, -1.0, 1.0)
    arms = [each - centres for each in (starts, ends)]
    off = np.abs(centres)
    toward = np.where(off > 0.0, -centres / np.where(off > 0.0, off, 1.0), 1.0)
    unit = np.where(radius > 0.0, radius, 1.0)
    # p = c + R a with |a| = 1; p x t = sign (R + c . a), least where a points back to the pole.
    values = [sign * (radius + (np.conj(centres) * arm).real / unit) for arm in arms]
    least = np.minimum(*values)
    inner = sign * toward
    turned = np.mod(sign * np.angle(inner * np.conj(arms[0])), 2.0 * np.pi)
    there = sign * (radius + (np.conj(centres) * inner).real)
    least = np.where(turned < np.abs(sweeps), np.minimum(least, there), least)
    reach = np.minimum(np.abs(starts), np.abs(ends))
    found: FloatArray = np.where(sweeps == 0.0, straight, least) / np.where(reach > 0.0, reach, 1.0)
    return found


# -- within ---------------------------------------------------------------------------------------
# What closed contours enclose, in closed form.


def inside(boundary: Pieces, places: ComplexArray) -> BoolArray:
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
