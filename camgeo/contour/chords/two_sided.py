"""Straight pieces with the curve on both sides of them: vertices off the curve, for given angles.

On a bend chord and curve lie within eps of each other if each vertex is eps off on the outer side
and each chord as far on the inner. The offset of each vertex follows from least squares over the
deviations at the vertices and inside the chords.

Such a chord spans sqrt(16 eps/|kappa|). So the integral of sqrt(|kappa|/(16 eps)) ds counts the
chords needed, and equal shares of it are chords of equal deviation; an inflection counts with the
chord that runs through it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camgeo.contour.hermite import monotone
from camgeo.curve.working_curve import WorkingCurve
from camgeo.mechanism.follower import bend_of_path
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, ascending
from camgeo.units import TURN

CELLS = 512
"""Cells of the table in each smooth piece; they only place vertices, and the result is measured."""

NEAR = 64
"""Cells on each side of an inflection, over two of the others: the chord through it may be short,
and near it the density is a square root."""

STRAIGHT = 1e-9
"""Cells that turn by less than this fraction of the largest turn are straight: changes of their
sign are not inflections."""

FLOOR = 1e-3
"""Fraction of the chords that is spread evenly, so that straight stretches get some."""


@dataclass(frozen=True, slots=True, eq=False)
class StretchTable:
    """Bend, turn and length of a stretch, cell by cell over the cam angle.

    Attributes
    ----------
    grid : (n + 1,) cam angles [rad], ascending.
    bends : (n,) [sqrt(mm)] integral of sqrt(|kappa|) ds over each cell, kappa of the parallel.
    turns : (n,) [rad] angle by which the curve turns in each cell, positive.
    steps : (n,) [mm] length of each cell.
    inflections : (k,) indices of the points of `grid` where the curvature changes its sign.
    sides : (k + 1,) sign of the curvature before, between and after the inflections.
    """

    grid: FloatArray
    bends: FloatArray
    turns: FloatArray
    steps: FloatArray
    inflections: tuple[int, ...]
    sides: FloatArray

    def shares(self, tolerance: float, most_turn: float) -> FloatArray:
        """(n + 1,) chords needed up to each point of the grid, none turning by over `most_turn`."""
        cells = np.maximum(self.bends / (4.0 * np.sqrt(tolerance)), self.turns / most_turn)
        even = self.steps / np.sum(self.steps)
        cells += even * (FLOOR * np.sum(cells) + 1e-9)
        return np.concatenate(([0.0], np.cumsum(cells)))

    def sagittas(
        self, tolerance: float, most_turn: float, shares: FloatArray, at: FloatArray
    ) -> FloatArray:
        """Deviation [mm] of chords that are one share long, where `shares` reach `at` (m,).

        It is `tolerance` unless they are shorter so as not to turn by over `most_turn`.
        """
        cell = np.clip(np.searchsorted(shares, at) - 1, 0, len(self.bends) - 1)
        bend, turn = self.bends[cell], self.turns[cell]
        longest = most_turn * bend / np.where(turn > 0.0, 4.0 * np.sqrt(tolerance) * turn, 1.0)
        return tolerance * np.where(turn > 0.0, np.minimum(longest, 1.0), 1.0) ** 2

    def angles(self, shares: FloatArray, at: FloatArray) -> FloatArray:
        """Cam angles [rad] at which the `shares` reach the values `at`."""
        return monotone(shares, self.grid, at)


def stretch_table(curve: WorkingCurve, start: float, end: float) -> StretchTable:
    """The table of `curve` from cam angle `start` to `end` [rad]."""
    breaks = np.concatenate((curve.breaks - TURN, curve.breaks, curve.breaks + TURN))
    inner = breaks[(breaks > start) & (breaks < end)]
    cuts = ascending(np.concatenate(([start], inner, [end])))
    parts = np.arange(CELLS) / CELLS
    grid = (cuts[:-1, None] + np.diff(cuts)[:, None] * parts).ravel()
    grid = np.append(grid, end)
    crossings = _sign_changes(curve, grid)
    if len(crossings):
        width = 2.0 * (end - start) / len(grid)
        near = crossings[:, None] + width * np.linspace(-1.0, 1.0, 2 * NEAR + 1)
        near = near[(near > start) & (near < end)]
        grid = ascending(np.concatenate((grid, near, crossings)))
    kappa, bends, turns, steps = _cells(curve, grid)
    places = np.searchsorted(grid, crossings)
    edges = [0, *(int(place) for place in places), len(kappa)]
    sides = [float(np.sign(np.sum(turns[a:b] * np.sign(kappa[a:b])))) for a, b in pairwise(edges)]
    return StretchTable(grid, bends, turns, steps, tuple(edges[1:-1]), np.array(sides))


def _cells(
    curve: WorkingCurve, grid: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Curvature of the pitch curve in the middle of each cell, and the cell's bends, turns, steps.

    sqrt(|kappa_d|) ds = sqrt(|kappa| (1 + d kappa)) |Z'| dphi is finite at a cusp too.
    """
    middle, width = 0.5 * (grid[:-1] + grid[1:]), np.diff(grid)
    relative = curve.pitch.relative_jet(middle, order=2)
    speed = curve.pitch.speed(relative)
    kappa = bend_of_path(relative, speed, curve.pitch.rotation)
    regular = np.maximum(1.0 + curve.distance * kappa, 0.0)
    way = speed * width
    return kappa, way * np.sqrt(np.abs(kappa) * regular), way * np.abs(kappa), way * regular


def _sign_changes(curve: WorkingCurve, grid: FloatArray) -> FloatArray:
    """(k,) cam angles [rad] where the curvature changes its sign; straight parts have none."""
    kappa, _, turns, _ = _cells(curve, grid)
    bent = np.flatnonzero(turns > STRAIGHT * np.max(turns))
    if len(bent) < 2:
        return np.empty(0)
    change = np.flatnonzero(np.sign(kappa[bent[:-1]]) != np.sign(kappa[bent[1:]]))
    if not len(change):
        return np.empty(0)
    middle = 0.5 * (grid[:-1] + grid[1:])
    low, high = middle[bent[change]], middle[bent[change + 1]]
    sign = np.sign(kappa[bent[change]])
    for _ in range(40):
        half = 0.5 * (low + high)
        same = np.sign(curve.pitch.curvature(half)) == sign
        low, high = np.where(same, half, low), np.where(same, high, half)
    return ascending(0.5 * (low + high))


COARSE, FINE, FINEST = 3, 7, 31
"""Points inside each chord at which the deviation is sampled: the more chords, the closer each is
to a parabola; a few long ones may have a sharp bend near an end. Odd, with one in the middle."""

MANY, POINTS = 1500, 2000
"""Number of chords from which `COARSE` suffices; below, about this many points in all."""

SWEEPS = 20
"""Sweeps of Jacobi's iteration for the offsets: each leaves a third of the error."""

MOST_CUTS = 40
"""Most steps in which the place of least deviation is bracketed: each drops one line."""

ROUNDING = 1e-12
"""Lines above others by less than this fraction count as equal."""

Place = Callable[[FloatArray], tuple[ComplexArray, ComplexArray]]
"""Points [mm] and unit tangents at ascending cam angles [rad] of one stretch."""


@dataclass(frozen=True, slots=True, eq=False)
class Stretched:
    """A stretch for straight pieces, from corner to corner or all round.

    Attributes
    ----------
    table : its bends, turns and lengths.
    place, points : points with tangents, and points alone, at ascending cam angles inside it.
    rotation : sigma; the outward normal is i sigma times the tangent.
    closed : whether it goes all round without a corner; else its ends are vertices.
    """

    table: StretchTable
    place: Place
    points: Callable[[FloatArray], ComplexArray]
    rotation: int
    closed: bool

    def angles(self, shares: FloatArray, places: FloatArray) -> FloatArray:
        """Cam angles [rad] at which the `shares` of the table reach `places` (m,), ascending.

        All round, places before the start and past the end are those of the neighbouring turns.
        """
        if not self.closed:
            return self.table.angles(shares, places)
        turns, rest = np.divmod(places, shares[-1])
        return self.table.angles(shares, rest) + TURN * turns


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """Vertices of straight pieces along a stretch, and their deviations.

    Attributes
    ----------
    angles : (m,) cam angles [rad] of the vertices, ascending.
    vertices : (m,) complex [mm].
    worst : (c,) [mm] largest distance between each piece and the curve; c = m all round, else
        m - 1.
    span : (c,) [mm] half the range of the signed distance of each piece.
    turns : (c,) [rad] angle between the tangents at the ends of each piece.
    gap : [mm] largest distance of a vertex from its foot along its pieces.
    """

    angles: FloatArray
    vertices: ComplexArray
    worst: FloatArray
    span: FloatArray
    turns: FloatArray
    gap: float


def lay(
    stretch: Stretched,
    angles: FloatArray,
    held: BoolArray,
    offsets: FloatArray,
    loose: BoolArray,
) -> Chords:
    """Straight pieces with vertices on the normals at `angles` (m,).

    Where `held` (m,), a vertex is off the curve by its `offsets` (m,) [mm], outward positive; least
    squares place the others, and `loose` (m,) ones are then moved to where the largest deviation of
    the vertex and its two pieces is least.
    """
    last = angles[0] + TURN if stretch.closed else angles[-1]
    count = len(angles) if stretch.closed else len(angles) - 1
    points, tangents = stretch.place(angles)
    normals = 1j * stretch.rotation * tangents
    ends = np.append(angles[1:], last)[:count]
    samples = min(max(POINTS // count | 1, FINE), FINEST) if count < MANY else COARSE
    parts = (np.arange(samples) + 1.0) / (samples + 1.0)
    inner = angles[:count, None] + (ends - angles[:count])[:, None] * parts
    between = stretch.points(inner.ravel()).reshape(inner.shape)

    height, share = _heights(points, between, count, stretch.rotation)
    highest = np.argmax(np.abs(height), axis=1)[:, None]
    off = _least_squares(
        np.take_along_axis(height, highest, axis=1)[:, 0],
        np.take_along_axis(share, highest, axis=1)[:, 0],
        held,
        offsets,
    )
    for number in np.flatnonzero(loose):
        off[number] = _least_worst(int(number), off, height, share)
    vertices = points + off * normals
    height, _ = _heights(vertices, between, count, stretch.rotation)
    heights = np.column_stack((-off[:count], height, -np.roll(off, -1)[:count]))
    top, bottom = np.max(heights, axis=1), np.min(heights, axis=1)
    peaks = _peaks(heights)
    top = np.maximum(top, np.max(peaks, axis=1))
    bottom = np.minimum(bottom, np.min(peaks, axis=1))

    chord = (np.roll(vertices, -1) - vertices)[:count]
    along = chord / np.abs(chord)
    after = np.roll(tangents, -1)[:count]
    gap = max(
        float(np.max(np.abs(off[:count] * (np.conj(tangents[:count]) * along).imag))),
        float(np.max(np.abs(np.roll(off, -1)[:count] * (np.conj(after) * along).imag))),
    )
    turns = np.abs(np.angle(after * np.conj(tangents[:count])))
    return Chords(angles, vertices, np.maximum(top, -bottom), 0.5 * (top - bottom), turns, gap)


def _heights(
    vertices: ComplexArray, between: ComplexArray, count: int, rotation: int
) -> tuple[FloatArray, FloatArray]:
    """Heights (c, p) of points outward of their chords, and fractions of the chords' lengths."""
    start = vertices[:count]
    chord = (np.roll(vertices, -1) - vertices)[:count]
    local = (between - start[:, None]) * np.conj(chord / np.abs(chord) ** 2)[:, None]
    return rotation * local.imag * np.abs(chord)[:, None], local.real


def _least_squares(
    height: FloatArray, share: FloatArray, held: BoolArray, offsets: FloatArray
) -> FloatArray:
    """Offsets (m,) that minimise the squares of themselves and of the remaining heights.

    `height`, `share` (c,): that of the highest point over each chord between points of the curve.
    For a parabola half the sagitta remains on each side.
    """
    size, count = len(held), len(height)
    weight = np.zeros(size)
    part, rise = np.zeros(size), np.zeros(size)
    weight[:count], part[:count], rise[:count] = 1.0, share, height
    rest = 1.0 - part
    own = 1.0 + weight * rest * rest + np.roll(weight * part * part, 1)
    next_to = weight * rest * part
    right = weight * rest * rise + np.roll(weight * part * rise, 1)
    off = np.where(held, offsets, right / own)
    for _ in range(SWEEPS):
        around = next_to * np.roll(off, -1) + np.roll(next_to * off, 1)
        off = np.where(held, offsets, (right - around) / own)
    return off


def _least_worst(number: int, off: FloatArray, height: FloatArray, share: FloatArray) -> float:
    """Offset of one vertex that minimises the largest deviation there and of its pieces.

    The maximum of straight lines over the offset has one lowest point; cutting planes, one falling
    and one rising, find it.
    """
    count, following = len(height), (number + 1) % len(off)
    lines = [(0.0, 1.0)]
    if number < count:
        rest = height[number] - share[number] * off[following]
        lines += zip(rest, 1.0 - share[number], strict=True)
    before = (number - 1) % len(off)
    if before < count:
        rest = height[before] - (1.0 - share[before]) * off[before]
        lines += zip(rest, share[before], strict=True)
    base, slope = np.array(lines).T
    height_of, rise_of = np.concatenate((base, -base)), np.concatenate((-slope, slope))
    falling, rising = int(np.argmin(rise_of)), int(np.argmax(rise_of))
    at = 0.0
    for _ in range(MOST_CUTS):
        at = (height_of[falling] - height_of[rising]) / (rise_of[rising] - rise_of[falling])
        values = height_of + rise_of * at
        top = int(np.argmax(values))
        if values[top] <= values[falling] + ROUNDING * abs(values[falling]):
            break
        if rise_of[top] < 0.0:
            falling = top
        else:
            rising = top
    return float(at)


def _peaks(heights: FloatArray) -> FloatArray:
    """Values at the vertices of parabolas through three neighbours each, where inside them."""
    before, here, after = heights[:, :-2], heights[:, 1:-1], heights[:, 2:]
    slope, bend = 0.5 * (after - before), before - 2.0 * here + after
    inside = np.abs(slope) < np.abs(bend)
    return here - np.where(inside, 0.5 * slope * slope / np.where(inside, bend, 1.0), 0.0)
