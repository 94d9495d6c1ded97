"""The smallest base circle where r_R against r_K, or global undercut, matters too: not a convex
problem.

Seen from the roller centre at cam angle 0 the cam axis lies in a direction theta in (-pi, 0). Cells
of places that certainly break a condition at one of some cam angles are excluded, which leaves the
neighbourhoods of the nearest places (`cells`); there the nearest place is sought along each
direction, and the direction with the smallest is enclosed. Then the cam angles at which the place
found is extreme join the set, and the pairs at which its flanks are cut off, until it meets the
conditions at all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camgeo.check.sizing.task import Covers, Task, Terms, covered, no_pairs
from camgeo.errors import GeometryError
from camgeo.geometry.outline.clearance import nearest_to_axis
from camgeo.geometry.pieces import curvature_extremes, smooth_pieces
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, joined, taken

REACH, ROOM = 40.0, 4.0
"""The largest base radius searched: as a multiple of that for the transmission angle, and of
r_R/ratio. Far out the pitch curve is nearly a circle, and r_K nearly the base radius."""

DIRECTIONS, RADII = 61, 81
"""Size of the grid of places on which the smallest ratio is sought if none is small enough."""

ZOOM, FINEST = 8.0, 1e-12
"""Each step encloses the direction eight times closer, down to this [rad]."""

STEPS = 40
"""Most steps; a step that ends at the end of its range moves the range, and widens it."""

LEAST_WIDTH, LEAST_SHARE = 1e-6, 1e-4
AGAIN = 4.0, 100.0
"""Range of directions and of radii of a later search: these multiples of the last move, at least
these, and at most those of the first one."""

WIDTH = 1e-2
"""Half the range of directions [rad] about the last place in which the next one is sought."""

JUMP = 1e-3
"""If the nearest place is this fraction beyond the bound of the cells, they are searched again."""

BELOW, ABOVE = 0.06, 0.03
"""Range about the last radius in which the next one is sought at first; a third of it each step."""

DIGITS = 1e-12
"""Width of the last halves of a range of radii, as a fraction of the first range."""

CLOSE = 1e-12
"""Conditions broken by this fraction of their terms count as met."""

ROUNDS = 40
"""Most rounds; a dozen is usual."""

STEP, GROWTH = 1e-9, 4.0
"""After the last round: the first step outward, as a fraction of the radius, and its growth."""


def worst_ratio(task: Task, place: complex) -> tuple[float, float]:
    """Largest r_R/r_K for the sign that matters, at least 0, and its cam angle [rad].

    Raises GeometryError if the roller centre stands still in the cam.
    """
    bends = curvature_extremes(task.pitch_curve_at(place))
    found = [(sign, bends.largest() if sign > 0.0 else bends.smallest()) for sign in task.signs]
    sign, (kappa, phi) = max(found, key=lambda each: each[0] * each[1][0])
    return max(task.follower.roller_radius * sign * kappa, 0.0), phi


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The place of the smallest base circle for all conditions.

    Attributes
    ----------
    place : [mm]; None if none was found.
    bound : base radius [mm] below which there certainly is no place; infinite if there is none up
        to the largest one searched.
    least_ratio : without a place, the smallest r_R/r_K of a grid of places that keep the
        transmission angle; infinite if there are none.
    reach : largest base radius [mm] searched.
    rounds : of the exchange that it took.
    examined : all cam angles, and pairs of them, that were examined.
    """

    place: complex | None
    bound: float
    least_ratio: float
    reach: float
    rounds: int
    examined: Conditions


def smallest_with_bends(task: Task, tangent: float, ratio: float, least: float) -> Nearest:
    """The smallest base circle for mu and r_R/r_K, without undercut.

    Parameters
    ----------
    tangent : T of the transmission angle.
    ratio : largest r_R/r_K.
    least : base radius [mm] below which there is no place.
    """
    reach = max(REACH * least, ROOM * (task.follower.roller_radius / ratio + abs(task.start)))
    phi, covers = samples_of(task), no_pairs(task)
    last: tuple[Start, ...] = ()
    share, bound = 1.0, least
    before = 0.0, math.inf
    for number in range(1, ROUNDS + 1):
        now = conditions(task, tangent, ratio, phi, covers)
        reached = [_enclosed(task, now, start, least, share) for start in last]
        radius = min((each[1] for each in reached), default=math.inf)
        # Conditions are only added, so the nearest place can only move away; the cells are searched
        # again if it has moved by more than they left open.
        if not radius <= bound * (1.0 + JUMP):
            found = nearest_cells(now, task.start, bound, reach, task.directions)
            bound = max(bound, found.bound)
            if not found.starts:
                least_ratio = _least_ratio(task, now, least, reach)
                return Nearest(None, bound, least_ratio, reach, number, now)
            reached += [_enclosed(task, now, start, least) for start in found.starts]
            reached += [start[:2] for start in found.starts]
        theta, radius = min(reached, key=lambda each: each[1])
        place = _place(task, theta, radius)
        extreme, broken = extreme_angles(task, place, tangent, ratio)
        more = no_pairs(task) if broken else covered(task, place)
        if not (broken or len(more.first)):
            return Nearest(place, bound, 0.0, reach, number, now)
        moves = abs(theta - before[0]), abs(radius - before[1]) / radius
        last = ((theta, radius, min(max(AGAIN[0] * moves[0], LEAST_WIDTH), WIDTH)),)
        share, before = min(max(AGAIN[1] * moves[1], LEAST_SHARE), 1.0), (theta, radius)
        phi = np.unique(np.concatenate((phi, extreme)))
        covers = covers + more
    place_beyond = _outward(task, theta, radius, tangent, ratio, reach)
    return Nearest(place_beyond, bound, math.inf, reach, ROUNDS, now)


def _place(task: Task, theta: float, radius: float) -> complex:
    return complex(task.start + radius * np.exp(1j * theta))


def _outward(
    task: Task, theta: float, radius: float, tangent: float, ratio: float, reach: float
) -> complex | None:
    """The first place farther out in a direction that meets everything; None if none is met."""
    step = STEP
    while radius * (1.0 + step) < reach:
        place = _place(task, theta, radius * (1.0 + step))
        if meets(task, place, tangent, ratio):
            return place
        step *= GROWTH
    return None


def meets(task: Task, place: complex, tangent: float, ratio: float) -> bool:
    """Whether the cam axis at `place` meets all conditions over the whole turn, to rounding."""
    try:
        broken = extreme_angles(task, place, tangent, ratio)[1]
    except GeometryError:
        return False
    return not broken and not len(covered(task, place).first)


def extreme_angles(
    task: Task, place: complex, tangent: float, ratio: float
) -> tuple[FloatArray, bool]:
    """Cam angles [rad] at which the conditions are extreme, and whether one is broken."""
    angles, broken = [], False
    size = abs(place) + abs(task.start)
    for t in (tangent, -tangent):
        found = task.slack(place, t)
        broken = broken or float(np.min(found.values)) < -CLOSE * size * math.hypot(1.0, t)
        angles.append(found.phi)
    curve = task.pitch_curve_at(place)
    try:
        bends = curvature_extremes(curve)
    except GeometryError:  # it stands still somewhere
        return np.concatenate(angles), True
    angles.append(bends.phi)
    for sign in task.signs:
        worst = float(np.max(sign * bends.values)) * task.follower.roller_radius
        broken = broken or worst > ratio * (1.0 + CLOSE)
    if task.half > 0.0:
        apart, phi = nearest_to_axis(curve)
        broken = broken or apart <= task.half
        angles.append(np.array([phi]))
    return np.concatenate(angles), broken


def _least_ratio(task: Task, now: Conditions, least: float, reach: float) -> float:
    first, last = task.directions
    theta = first + (last - first) * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radii = np.geomspace(least, reach, RADII)
    places = (task.start + radii * np.exp(1j * theta)[:, np.newaxis]).ravel()
    free = Conditions(now.terms, now.tangent, 0.0, 1.0, now.signs)
    kept = places[free.met(places)]
    return float(np.min(now.worst_ratio(kept))) if len(kept) else math.inf


def _enclosed(
    task: Task, now: Conditions, start: Start, least: float, share: float = 1.0
) -> tuple[float, float]:
    """Direction and base radius of the smallest circle near `start`; infinite if there is none.

    `share` is that of the range of radii to begin with.
    """
    best, radius, width = start
    for _ in range(STEPS):
        # Cam angles at which the whole neighbourhood meets the conditions can be skipped.
        places = np.array([task.start + radius * np.exp(1j * best)])
        near = within(now, places, 1.1 * radius * (width + BELOW * share))
        theta = np.clip(best + width * np.linspace(-1.0, 1.0, 33), *task.directions)
        scan = radius * np.linspace(1.0 - BELOW * share, 1.0 + ABOVE * share, 46)
        halvings = max(1, math.ceil(math.log2(share / DIGITS)))
        reached = _nearest_along(task, near, theta, np.maximum(scan, least), halvings)
        index = int(np.argmin(reached))
        if not np.isfinite(reached[index]):
            return best, math.inf
        moved = theta[index] != best and index in (0, len(theta) - 1)
        best, radius = float(theta[index]), float(reached[index])
        if moved:  # it may lie beyond the end of the range
            width = min(2.0 * width, WIDTH)
            continue
        if width <= FINEST:
            break
        width /= ZOOM
        share /= 3.0
    return best, radius


def _nearest_along(
    task: Task, now: Conditions, theta: FloatArray, scan: FloatArray, halvings: int
) -> FloatArray:
    """(k,) smallest base radius within `scan` in each direction; infinite if there is none."""
    ways = np.exp(1j * theta)
    met = now.met((task.start + scan * ways[:, np.newaxis]).ravel()).reshape(len(theta), -1)
    some = np.any(met, axis=1)
    first = np.argmax(met, axis=1)
    good, bad = scan[first], scan[np.maximum(first - 1, 0)]
    for _ in range(halvings):
        middle = 0.5 * (good + bad)
        fine = now.met(task.start + middle * ways)
        good, bad = np.where(fine, middle, good), np.where(fine, bad, middle)
    return np.where(some, good, np.inf)


# -- cells ----------------------------------------------------------------------------------------
# Where the smallest base circle may be: cells that certainly break a condition are excluded.
#
# A cell is a patch of directions and distances seen from the roller centre at cam angle 0. Between
# its middle and any of its places (u, v) changes by at most half the diagonal, h, so all of it
# breaks
#
# - the transmission angle, if u - T |v| + h sqrt(1 + T^2) < 0 at one cam angle;
# - the curvature of one sign, if the largest value of
#   K rho^3 - sign (rho^2 - alpha u + beta v), K = ratio/r_R, rho = |(u, v)|,
#   is below 0 at one cam angle: the linear terms change by at most h |(alpha, beta)|, and the rest
#   has no maximum inside the range of rho;
# - the distance of the roller from the cam axis, if at one cam angle it is below half - h;
# - that no point of a flank is covered, see `camgeo.check.sizing.task`.
#
# The remaining cells are halved both ways. No place is dropped without proof: only those nearer
# than the best one found, by more than `GAP` of its distance, still matter.


FIRST_DIRECTIONS = 32
"""Number of directions of the first cells, which are as long as they are wide."""

LEVELS = 11
"""The last cells are 1e-4 of their distance wide."""

GAP = 2e-4
"""A place nearer by less than this fraction is left to the search along directions."""

MOST_CELLS = 12_000
MOST_RUNS = 4
"""Neighbourhoods of the nearest places that are searched further."""

BLOCK = 2_000_000
"""Most values computed at once."""

Start = tuple[float, float, float]
"""Direction, base radius, and half the range of directions to search."""


@dataclass(frozen=True, slots=True)
class Found:
    """Neighbourhoods of the nearest places.

    Attributes
    ----------
    starts : one for each, empty if the middle of no cell meets the conditions.
    bound : base radius [mm] below which every place breaks a condition; infinite if all do.
    """

    starts: tuple[Start, ...]
    bound: float


def nearest_cells(
    now: Conditions,
    start: complex,
    least: float,
    reach: float,
    directions: tuple[float, float] = (-math.pi, 0.0),
) -> Found:
    """The places nearest to `start` that meet `now`, from `least` to `reach` [mm], in some
    `directions` [rad]; in a single one the cells have no width.
    """
    first, last = directions
    count = FIRST_DIRECTIONS if first < last else 1
    rows = max(1, math.ceil(math.log(reach / least) * FIRST_DIRECTIONS / math.pi))
    height = 0.5 * math.log(reach / least) / rows
    width = 0.5 * (last - first) / count
    theta = first + width * (2.0 * np.arange(count) + 1.0)
    depth = math.log(least) + height * (2.0 * np.arange(rows) + 1.0)
    theta, depth = (each.ravel() for each in np.meshgrid(theta, depth))
    best, bound = math.inf, math.inf
    good = np.empty((2, 0))
    for _ in range(LEVELS):
        radius = np.exp(depth)
        places = start + radius * np.exp(1j * theta)
        half = radius * math.exp(height) * math.hypot(width, height)
        left = ~excluded(now, places, half)
        theta, depth, radius, places = theta[left], depth[left], radius[left], places[left]
        met = now.met(places)
        if np.any(met):
            best = min(best, float(np.min(radius[met])))
            good = np.concatenate((good, np.stack((theta[met], radius[met]))), axis=1)
        lower = np.exp(depth - height)
        open_ = lower < (1.0 - GAP) * best
        theta, depth, lower = theta[open_], depth[open_], lower[open_]
        if len(theta) > MOST_CELLS:
            order = np.argsort(lower)
            bound = min(bound, float(lower[order[MOST_CELLS]]))
            theta, depth = theta[order[:MOST_CELLS]], depth[order[:MOST_CELLS]]
        if not len(theta):
            break
        width, height = 0.5 * width, 0.5 * height
        ways = (-1.0, 1.0) if width > 0.0 else (0.0,)
        theta, depth = (
            np.concatenate([theta + s * width for s in ways for _ in range(2)]),
            np.concatenate([depth + s * height for _ in ways for s in (-1.0, 1.0)]),
        )
    if len(theta):
        bound = min(bound, float(np.exp(np.min(depth) - height)))
    return Found(_starts(good, best, width), min(bound, (1.0 - GAP) * best))


def excluded(now: Conditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    """(k,) whether all places within `half` (k,) [mm] of `places` (k,) break a condition."""
    count = 1 + len(places) * now.count // BLOCK
    parts = zip(np.array_split(places, count), np.array_split(half, count), strict=True)
    return np.concatenate([_excluded(now, each[:, None], reach[:, None]) for each, reach in parts])


def _excluded(now: Conditions, places: ComplexArray, half: FloatArray) -> BoolArray:
    terms = now.terms
    u, v = terms.across_and_along(places)
    tilted = u - now.tangent * np.abs(v) + half * math.hypot(1.0, now.tangent)
    out: BoolArray = np.any(tilted < 0.0, axis=1)
    if now.half > 0.0:
        out |= np.any(terms.to_axis(places) + half <= now.half, axis=1)
    if now.covers is not None and len(now.covers.first) and not np.all(out):
        rest = ~out
        gap, pace = now.covers.gap(places[rest, 0])
        sure = gap + now.covers.change(half[rest], pace) < 0.0
        out[rest] = np.any(sure, axis=1)
    rest = ~out
    if not np.any(rest) or not now.roller > 0.0:
        return out
    u, v, half = u[rest], v[rest], half[rest]
    rho = np.hypot(u, v)
    linear = terms.alpha * u - terms.beta * v
    slack = half * np.hypot(terms.alpha, terms.beta)
    bent = np.zeros(len(u), dtype=np.bool_)
    for sign in now.signs:
        value = np.full(rho.shape, -np.inf)
        for end in (np.maximum(rho - half, 0.0), rho + half):
            square = end * end
            value = np.maximum(value, (now.ratio / now.roller) * square * end - sign * square)
        bent |= np.any(value + sign * linear + slack < 0.0, axis=1)
    out[rest] = bent
    return out


def within(now: Conditions, place: ComplexArray, half: float) -> Conditions:
    """`now` without the cam angles and the pairs at which all places within `half` [mm] of `place`
    (1,) meet it.

    At least one cam angle remains.
    """
    terms = now.terms
    u, v = terms.across_and_along(place)
    asked = u - now.tangent * np.abs(v) - half * math.hypot(1.0, now.tangent) < 0.0
    asked |= terms.to_axis(place) - half <= now.half
    covers = now.covers
    if covers is not None:
        gap, pace = covers.gap(place)
        covers = covers.some((gap - covers.change(np.array([[half]]), pace) < 0.0)[0])
    if now.roller > 0.0:
        slope = now.ratio / now.roller
        rho = np.hypot(u, v)
        low, high = np.maximum(rho - half, 0.0), rho + half
        linear = terms.alpha * u - terms.beta * v
        slack = half * np.hypot(terms.alpha, terms.beta)
        for sign in now.signs:
            # The minimum of slope rho^3 - sign rho^2, at 2/(3 slope) if that is in the range.
            end = np.clip(2.0 / (3.0 * slope), low, high) if sign > 0.0 else low
            asked |= end * end * (slope * end - sign) + sign * linear - slack < 0.0
    if not np.any(asked):
        asked[0] = True
    return replace(now, terms=taken(terms, asked), covers=covers)


def _starts(good: FloatArray, best: float, width: float) -> tuple[Start, ...]:
    """Runs of neighbouring directions whose places are about as near as the nearest."""
    near = good[:, good[1] <= (1.0 + 4.0 * GAP) * best]
    if not near.shape[1]:
        return ()
    near = near[:, np.argsort(near[0])]
    cuts = np.flatnonzero(np.diff(near[0]) > 0.05) + 1
    runs = np.split(near, cuts, axis=1)
    runs.sort(key=lambda run: float(np.min(run[1])))
    found = []
    for run in runs[:MOST_RUNS]:
        first = int(np.argmin(run[1]))
        reach = float(np.max(np.abs(run[0] - run[0, first])))
        found.append((float(run[0, first]), float(run[1, first]), reach + 4.0 * width + 1e-3))
    return tuple(found)


# -- conditions -----------------------------------------------------------------------------------
# All conditions on a place of the cam axis, at a set of cam angles.


SAMPLES = 17
"""Cam angles per piece to start with; the exchange adds those that matter."""

BLOCK_OF_PLACES = 4_000_000
"""Most values computed at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """All conditions at a set of cam angles.

    Attributes
    ----------
    terms : at these cam angles.
    tangent : of the transmission angle.
    roller : r_R [mm].
    ratio : the largest r_R/r_K.
    signs : of the curvatures that count.
    half : see `Task.half`.
    covers : pairs of cam angles; None if global undercut is left out.
    """

    terms: Terms
    tangent: float
    roller: float
    ratio: float
    signs: tuple[float, ...]
    half: float = 0.0
    covers: Covers | None = None

    @property
    def count(self) -> int:
        """The number of conditions on a place."""
        return len(self.terms.q) + (0 if self.covers is None else len(self.covers.first))

    def met(self, places: ComplexArray) -> BoolArray:
        """(k,) whether the places (k,) meet all of them."""
        parts = np.array_split(places, 1 + len(places) * self.count // BLOCK_OF_PLACES)
        return np.concatenate([self._met(part) for part in parts])

    def _met(self, places: ComplexArray) -> BoolArray:
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        met = np.asarray(np.all(u >= self.tangent * np.abs(v), axis=1) & np.all(u > 0.0, axis=1))
        if np.any(met) and self.half > 0.0:
            apart = self.terms.to_axis(places[met][:, np.newaxis])
            met[met] = np.all(apart > self.half, axis=1)
        if np.any(met):
            met[met] = self.worst_ratio(places[met]) <= self.ratio
        if np.any(met) and self.covers is not None:
            met[met] = self.covers.met(places[met])
        return met

    def room(self, places: ComplexArray) -> FloatArray:
        """(k,) margin of the tightest condition at the places (k,), as a fraction of its limit or
        as an angle [rad]; negative where one is broken.
        """
        u, v = self.terms.across_and_along(places[:, np.newaxis])
        with np.errstate(divide="ignore", invalid="ignore"):
            kept = (u - self.tangent * np.abs(v)) / np.hypot(u, v)
            left = [np.min(kept, axis=1) / math.hypot(1.0, self.tangent)]
            left.append(1.0 - self.worst_ratio(places) / self.ratio)
        if self.half > 0.0:
            apart = self.terms.to_axis(places[:, np.newaxis])
            left.append(np.min(apart, axis=1) / self.half - 1.0)
        if self.covers is not None and len(self.covers.first):
            gap = self.covers.gap(places)[0] / np.abs(self.covers.distance)
            left.append(np.min(gap, axis=1))
        return np.asarray(np.nan_to_num(np.min(left, axis=0), nan=-np.inf))

    def worst_ratio(self, places: ComplexArray) -> FloatArray:
        """(k,) largest r_R/r_K for the sign that matters; Z' must not vanish."""
        kappa = self.terms.curvature(places[:, np.newaxis])
        worst = [np.max(sign * kappa, axis=1) for sign in self.signs]
        return np.asarray(self.roller * np.max(worst, axis=0))


def samples_of(task: Task) -> FloatArray:
    """(n,) cam angles [rad] inside all pieces, including their ends up to rounding."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    share[0], share[-1] = 1e-9, 1.0 - 1e-9
    found = [
        piece.start + (piece.end - piece.start) * (share[:1] if piece.dwell else share)
        for piece in smooth_pieces(task.motion)
    ]
    return np.concatenate(found)


def with_more(task: Task, now: Conditions, phi: FloatArray, covers: Covers) -> Conditions:
    """`now` and the conditions at the cam angles `phi` (n,) [rad] and of the pairs `covers`."""
    more = conditions(task, now.tangent, now.ratio, phi, covers).terms
    terms = joined((now.terms, more))
    return replace(now, terms=terms, covers=covers if now.covers is None else now.covers + covers)


def conditions(
    task: Task, tangent: float, ratio: float, phi: FloatArray, covers: Covers | None = None
) -> Conditions:
    """The conditions at the cam angles `phi` (n,) [rad] and on both sides of each break, and those
    of the pairs `covers`.
    """
    breaks = task.motion.breaks
    right = task.terms(np.concatenate((phi, breaks)))
    terms = joined((right, task.terms(breaks, "left")))
    roller, half = task.follower.roller_radius, task.half
    return Conditions(terms, tangent, roller, ratio, task.signs, half, covers)
