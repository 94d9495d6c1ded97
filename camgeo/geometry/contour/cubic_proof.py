"""Proof of a spline contour: by lines and arcs that are proved to lie much closer to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.proof import ENOUGH
from camgeo.geometry.contour.spline import CUBIC, Arc, SplineContour, cut
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    frozen,
    grouped,
)

SHARE = 0.01
"""Distance of the arcs from the spline, as a fraction of the deviation: a larger one lengthens the
arcs only by its cube root."""

SHARPNESS = 0.015
"""Largest fraction of the bound that the arcs may add."""

COARSE = 1e-6
"""First guess of an unknown deviation, as a fraction of the contour's reach."""

FINEST = 2.0**-52 * 64.0
"""Fraction of the reach below which closer arcs are mere rounding."""

ROUNDS = 8
"""Most refinements of the arcs; two suffice where the scale is known."""

COARSER = 8.0
"""Factor of the distance of coarser arcs, tried where finer ones cannot be measured."""


Measure = Callable[[Contour], float]


def bound_by_arcs(measure: Measure, contour: SplineContour) -> float:
    """Upper bound [mm] of a distance of `contour`, if `measure` gives one of lines and arcs.

    Raises what `measure` raises for arcs of any length.
    """
    finest = FINEST * contour.reach
    share = max(SHARE * (COARSE * contour.reach), finest)
    bound, failed = math.inf, None
    for _ in range(ROUNDS):
        fine = approximating_arcs(contour, share)
        try:
            reached = measure(fine.contour)
        except GeometryError as fault:
            # Fine arcs follow each bend of the spline, also those that the proof of arcs cannot
            # handle.
            failed = fault
            if bound < math.inf:
                break
            share *= COARSER
            continue
        bound = min(bound, reached + fine.distance)
        reached = max(reached, ENOUGH)
        if fine.distance <= SHARPNESS * reached or share <= finest:
            break
        if failed is not None:
            break
        # Closer arcs for the next round: a hundredth of what was measured, at most a quarter of
        # before.
        share = max(min(0.25 * share, SHARE * reached), finest)
    if bound == math.inf and failed is not None:
        raise failed
    return bound


# -- lines and arcs -------------------------------------------------------------------------------
# A spline contour as lines and arcs, and the proof of their distance from it.
#
# Each cubic is cut into parts, and each part gets the arc through its two ends and its middle;
# `bounds_beside_arcs` bounds the distance of the part from the circle. The part moves forwards
# round the centre all the way, so that its rays from there meet the arc and nothing but the arc;
# and as both share their ends, each ray through the arc meets the part. So the bound holds in both
# directions. For a line the same with its normal.
#
# With c and r of the arc, q(t) = (|x(t) - c|^2 - r^2) / 2r is a polynomial of degree 6; its
# Bernstein coefficients over quarters of the part enclose it, and the distance of x(t) from the
# circle follows from q. For a line the same with its normal, of degree 3.


WIDEST = 0.5
"""A part turns from its chord, and a ray from the middle one, by at most this angle [rad]; the two
together stay far from a right angle."""

QUARTERS = 4
"""Parts of [0, 1] over which the Bernstein coefficients give bounds: these are too large by a half
over the whole, and by a twentieth over quarters."""

ORDER: Final = 6
"""Degree of q."""


@cache
def _quarter_coefficients() -> FloatArray:
    """(7, 28): Bernstein coefficients of degree 6 over [0, 1] -> those over each quarter."""
    rows = np.zeros((ORDER + 1, QUARTERS, ORDER + 1))
    for k in range(ORDER + 1):
        for quarter in range(QUARTERS):
            low, high = quarter / QUARTERS, (quarter + 1) / QUARTERS
            for upper in range(ORDER + 1):
                # Blossoms by de Casteljau's scheme: `upper` arguments at the end of the quarter,
                # the others at its start.
                values = [float(j == k) for j in range(ORDER + 1)]
                for level in range(ORDER):
                    place = high if level < upper else low
                    values = [
                        (1.0 - place) * one + place * other for one, other in pairwise(values)
                    ]
                rows[k, quarter, upper] = values[0]
    return frozen(rows.reshape(ORDER + 1, -1), np.float64)


PAIRS = tuple(
    (i, j, math.comb(3, i) * math.comb(3, j) / math.comb(ORDER, i + j))
    for i in range(4)
    for j in range(4)
)
"""Product of two cubics in Bernstein form: coefficient i + j gets its share of b_i b_j."""

ELEVATION = np.array(
    [
        [
            math.comb(3, i) * math.comb(3, k - i) / math.comb(ORDER, k) if 0 <= k - i <= 3 else 0.0
            for k in range(ORDER + 1)
        ]
        for i in range(4)
    ]
)
"""(4, 7): a cubic in Bernstein form of degree 6."""


def bounds_beside_arcs(
    parts: ComplexArray, aim: float, flattest: float
) -> tuple[FloatArray, FloatArray]:
    """(n,) sagitta [mm] of the arc of each of `parts` (n, 4) [mm], 0 for a line, positive where it
    turns counter-clockwise; (n,) bound [mm] of the distance of the part from it, infinite where the
    part does not certainly follow it.

    Where an arc would have more than the radius `flattest` the bound is such that the part is
    halved, until it is a line.
    """
    chords = parts[:, 3] - parts[:, 0]
    lengths = np.abs(chords)
    safe_lengths = np.where(lengths > 0.0, lengths, 1.0)
    local = (parts - parts[:, :1]) * np.conj(chords / safe_lengths)[:, None]
    local[:, 3] = lengths
    x, y = local.real, local.imag
    sides = np.diff(local, axis=1)
    forward = lengths > 0.0
    # Every side of the control polygon keeps near the chord's direction, so that the part does too.
    forward &= np.all(np.abs(sides.imag) <= math.tan(WIDEST) * sides.real, axis=1)

    from_line = np.max(np.abs((y @ ELEVATION) @ _quarter_coefficients()), axis=1)
    line = from_line <= aim
    middle = 0.125 * (local[:, 0] + 3.0 * local[:, 1] + 3.0 * local[:, 2] + local[:, 3])
    # Through both ends and m: centre on x = L/2 at height h with |m|^2 = L m_x + 2 h m_y.
    height = np.where(line | (middle.imag == 0.0), 1.0, middle.imag)
    square = middle.real * (middle.real - lengths) + middle.imag * middle.imag
    centre = square / (2.0 * height)
    radius = np.where(forward, np.hypot(0.5 * lengths, centre), 1.0)
    from_arc, narrow = _circle_bounds(x, y, lengths, centre, radius)
    # The sagitta r - |c| without its cancellation, from (r - |c|) (r + |c|) = L^2 / 4.
    deep = 0.25 * lengths * lengths / (radius + np.abs(centre))
    sagitta = np.where(line, 0.0, np.sign(centre) * deep)
    from_arc = np.where(radius > flattest, np.maximum(from_arc, 8.0 * aim), from_arc)
    bound = np.where(line, from_line, np.where(narrow, from_arc, np.inf))
    return sagitta, np.where(forward, bound, np.inf)


def _circle_bounds(
    x: FloatArray, y: FloatArray, lengths: FloatArray, centre: FloatArray, radius: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """(n,) bound [mm] of the distance of parts, in the axes of their chords, from their circles;
    (n,) whether all rays from the centre to the part are near the middle one.
    """
    half = 0.5 / radius
    q = np.zeros((len(x), ORDER + 1))
    for i, j, share in PAIRS:
        q[:, i + j] += share * (x[:, i] * x[:, j] + y[:, i] * y[:, j])
    q *= half[:, None]
    # |x - c|^2 - r^2 = |x|^2 - 2 c x, for the circle passes through the origin.
    dot = (0.5 * lengths)[:, None] * x + centre[:, None] * y
    q -= ((2.0 * half)[:, None] * dot) @ ELEVATION
    largest = np.max(np.abs(q @ _quarter_coefficients()), axis=1)
    # |x - c| = sqrt(r^2 + 2 r q): the distance is q for small q, and at most this.
    inner = 1.0 - 2.0 * largest / radius
    bound = 2.0 * largest / (1.0 + np.sqrt(np.maximum(inner, 0.0)))
    arm = -np.sign(centre)[:, None] * (y - centre[:, None])
    aside = np.abs(x - 0.5 * lengths[:, None])
    narrow = np.all((arm > 0.0) & (aside <= math.tan(WIDEST) * arm), axis=1)
    return bound, narrow & (inner > 0.0)


ROUNDING = 2.0**-52 * 16.0
"""Rounding of a distance, as a fraction of the largest length that enters it."""

FLATNESS = 2.0**-52 * 256.0
"""Rounding of a distance from a circle, as a fraction of its radius: four times that assumed by the
proof of arcs, see `camgeo.geometry.contour.proof`. An arc that would round by more than the
tolerance is cut until its parts are lines."""

FLATTEST = 16.0
"""An arc with a radius up to this multiple of the contour's reach stays an arc, whatever the
tolerance."""

REFINEMENTS = 24
"""Most rounds of refinement."""

MAX_PARTS = 2_000_000
"""Most parts of a contour."""

MOST_TURNING = 4096
"""Most parts of a cubic that still turn too far: finer ones contain a point in which it turns back.
"""

LARGEST_FACTOR = 64.0
"""Largest factor of the number of parts in a round."""

FIRST = 1.04
"""Factor on the estimated number of parts: the bound of the error exceeds it by a tenth."""


@dataclass(frozen=True, slots=True, eq=False)
class ApproximatingArcs:
    """Lines and arcs close to a spline contour.

    Attributes
    ----------
    contour : the lines and arcs.
    distance : upper bound of the distance between the two, in both directions [mm].
    counts : (strands,) pieces of `contour` for each strand.
    cubics, shares : (n,) where the vertices of `contour` lie on the splines: the number of the
        cubic among all cubics of the contour, and the share of its span; -1 and 0 at arcs.
    """

    contour: Contour
    distance: float
    counts: IntArray
    cubics: IntArray
    shares: FloatArray


def approximating_arcs(contour: SplineContour, tolerance: float) -> ApproximatingArcs:
    """Lines and arcs close to a spline contour, with their proved distance and their places on it.

    Joints lie on the splines; the arcs are tangent there only within the tolerance.

    Parameters
    ----------
    tolerance : distance [mm] that the arcs aim at; only rounding may exceed it.

    Raises
    ------
    GeometryError
        If a spline turns back in a point, so that no arcs can follow it.
    """
    strands = contour.strands
    pieces = [strand.beziers for strand in contour.splines]
    owners = [k for k, strand in enumerate(strands) if not isinstance(strand, Arc)]
    parts = _parts(pieces, owners, tolerance, contour.reach)
    exact = [k for k, strand in enumerate(strands) if isinstance(strand, Arc)]
    owner = np.concatenate((parts.owner, np.array(exact, dtype=np.intp)))
    order = np.argsort(owner, kind="stable")
    starts, sweeps, centres = parts.arcs()
    arc_contour = Contour(
        np.concatenate((starts, [arc.start for arc in contour.arcs]))[order],
        np.concatenate((sweeps, [arc.sweep for arc in contour.arcs]))[order],
        np.concatenate((centres, [arc.centre for arc in contour.arcs]))[order],
    )
    sizes = np.maximum(np.abs(centres) + np.abs(starts - centres), contour.reach)
    distance = np.max(parts.bounds + ROUNDING * sizes, initial=ROUNDING * contour.reach)
    none = np.zeros(len(exact))
    return ApproximatingArcs(
        arc_contour,
        float(distance),
        np.bincount(owner, minlength=len(strands)),
        np.concatenate((parts.cubics, none.astype(np.intp) - 1))[order],
        np.concatenate((parts.shares, none))[order],
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """Parts of cubics with their arcs.

    Attributes
    ----------
    controls : (n, 4) complex [mm] Bezier points.
    sagittas, bounds : (n,) [mm], as `bounds_beside_arcs` has them.
    owner : (n,) strand of each.
    cubics, shares : (n,), as of `ApproximatingArcs`, of their starts.
    """

    controls: ComplexArray
    sagittas: FloatArray
    bounds: FloatArray
    owner: IntArray
    cubics: IntArray
    shares: FloatArray

    def arcs(self) -> tuple[ComplexArray, FloatArray, ComplexArray]:
        """Starts, sweeps and centres (n,) of the lines and arcs."""
        starts, ends = self.controls[:, 0], self.controls[:, 3]
        chords = ends - starts
        straight = self.sagittas == 0.0
        lengths = np.abs(chords)
        turned = 4.0 * np.arctan2(2.0 * self.sagittas, lengths)
        safe = np.where(straight, 1.0, self.sagittas)
        # From the middle of the chord to the centre: r - h with r = L^2 / (8 h) + h / 2, h the
        # sagitta.
        inwards = 1j * chords / lengths * (lengths * lengths / (8.0 * safe) - 0.5 * safe)
        centres = np.where(straight, 0.0, 0.5 * (starts + ends) + inwards)
        return starts, np.where(straight, 0.0, turned), centres


def _parts(pieces: list[ComplexArray], owners: list[int], tolerance: float, reach: float) -> _Parts:
    """Parts of all splines; `owners` are the numbers of their strands."""
    none = np.zeros((0, CUBIC + 1), dtype=np.complex128)
    whole = np.concatenate([none, *pieces])
    # Cubics whose control points coincide have no length and no arcs.
    moving = np.flatnonzero(np.max(np.abs(np.diff(whole, axis=1)), axis=1) > 0.0)
    owner = np.repeat(np.array(owners, dtype=np.intp), [len(beziers) for beziers in pieces])[moving]
    whole = whole[moving]
    aim = max(tolerance, ROUNDING * reach)
    flattest = max(aim / FLATNESS, FLATTEST * reach)
    counts = _first_counts(whole, aim)
    for _ in range(REFINEMENTS):
        parts = cut(whole, counts)
        sagittas, bounds = bounds_beside_arcs(parts, aim, flattest)
        firsts = np.cumsum(counts) - counts
        worst = np.maximum.reduceat(bounds, firsts) if len(counts) else bounds
        bad = worst > aim
        if not np.any(bad):
            of_whole, number = grouped(counts)
            shares = number / counts[of_whole]
            return _Parts(parts, sagittas, bounds, owner[of_whole], moving[of_whole], shares)
        # The error of an arc grows with the cube of its length; 1.02 for arcs that are not yet
        # short.
        finer = np.where(
            np.isinf(worst), 2.0, np.minimum(1.02 * np.cbrt(worst / aim), LARGEST_FACTOR)
        )
        counts = np.where(bad, np.maximum(counts + 1, np.ceil(counts * finer)), counts)
        counts = counts.astype(np.intp)
        turning = np.isinf(worst) & (counts > MOST_TURNING)
        if int(np.sum(counts)) > MAX_PARTS or np.any(turning):
            break
    raise GeometryError(
        "a spline turns back, or its points are spaced too unevenly for arcs to follow it"
    )


def _first_counts(whole: ComplexArray, aim: float) -> IntArray:
    """(n,) estimate of the number of arcs that each cubic needs: an arc through both ends and the
    middle is off by sqrt(3)/36 of the third difference across the chord.
    """
    chord = whole[:, 3] - whole[:, 0]
    length = np.abs(chord)
    third = chord - 3.0 * (whole[:, 2] - whole[:, 1])
    across = np.abs((np.conj(chord) * third).imag) / np.where(length > 0.0, length, 1.0)
    needed = np.ceil(FIRST * np.cbrt(math.sqrt(3.0) / 36.0 * across / aim))
    return np.clip(needed, 1.0, LARGEST_FACTOR).astype(np.intp)
