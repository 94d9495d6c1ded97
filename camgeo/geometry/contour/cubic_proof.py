"""Proof of a spline contour: by lines and arcs that are proved to lie much closer to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from itertools import pairwise
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.legs import (
    APART,
    Chain,
    Leg,
    StretchLeg,
    TurnLeg,
    check_regular,
    runs_of,
    torn_apart,
)
from camgeo.geometry.contour.proof import ENOUGH, SLIGHT, by_curve, deviation, proved_bound
from camgeo.geometry.contour.spline import CUBIC, Arc, CubicSpline, SplineContour, cut
from camgeo.geometry.outline.path import Path
from camgeo.geometry.pieces import Piece
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower import bend_of_path
from camgeo.kinematics.motion import FULL_ORDER
from camgeo.numeric.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Side,
    frozen,
    grouped,
    taken,
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

ARC_CELLS = 4
"""Cells of an arc to begin with in the proof of a fit. What is not known over a cell falls with the
cube of its width; and these arcs are short enough for a hundredth of the distance, so that cells of
the same width are a fifth as many an arc as where the arcs themselves make the distance."""

Measure = Callable[[Contour], float]


def spline_deviation(path: Path, contour: SplineContour) -> float:
    """Upper bound [mm] of the distance between `contour` and `path`, in both directions.

    Parameters
    ----------
    path : the exact path, as for `camgeo.geometry.contour.proof.deviation`.
    contour : once round the path, in either direction.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round, so that no bound can be given.
    """
    return bound_by_arcs(lambda arcs: deviation(path, arcs), contour)


def bound_by_arcs(measure: Measure, contour: SplineContour) -> float:
    """Upper bound [mm] of a distance of `contour`, if `measure` gives one of lines and arcs.

    Raises what `measure` raises for arcs of any length.
    """
    finest = FINEST * contour.reach
    share = max(SHARE * (COARSE * contour.reach), finest)
    found, failed = math.inf, None
    for _ in range(ROUNDS):
        fine = approximating_arcs(contour, share)
        try:
            reached = measure(fine.contour)
        except GeometryError as fault:
            # Fine arcs follow each bend of the spline, also those that the proof of arcs cannot
            # handle.
            failed = fault
            if found < math.inf:
                break
            share *= COARSER
            continue
        found = min(found, reached + fine.apart)
        reached = max(reached, ENOUGH)
        if fine.apart <= SHARPNESS * reached or share <= finest:
            break
        if failed is not None:
            break
        share = max(min(0.25 * share, SHARE * reached), finest)
    if found == math.inf and failed is not None:
        raise failed
    return found


def fitted_deviation(
    legs: Sequence[Leg], parts: Sequence[Part], contour: SplineContour, scale: float, enough: float
) -> float:
    """As `spline_deviation`, for a contour whose place along the path is known.

    Parameters
    ----------
    legs : of the path, in order.
    parts : (strands,) the part of the path of each strand; the contour runs in its direction.
    scale : largest distance found [mm].
    enough : a bound [mm] that need not be made sharper.

    Raises
    ------
    GeometryError
        If the contour does not follow the path once round.
    """
    fine = approximating_arcs(contour, max(SHARE * max(scale, enough), FINEST * contour.reach))
    angles = _angles(parts, contour, fine)
    arcs = fine.contour
    ends = np.cumsum(fine.counts)
    chains: list[list[Chain]] = [[] for _ in legs]
    for part, end, count in zip(parts, ends, fine.counts, strict=True):
        which = slice(int(end - count), int(end))
        chains[part.leg].append(
            Chain(angles[which], arcs.vertices[which], arcs.sweeps[which], arcs.centres[which])
        )
    runs = runs_of(
        [(leg, found or [Chain.empty()]) for leg, found in zip(legs, chains, strict=True)]
    )
    if any(np.any(np.diff(run.angles) <= 0.0) for run in runs):
        raise GeometryError("the contour does not follow the exact curve once round")
    return proved_bound(runs, ARC_CELLS, enough) + fine.apart


def _angles(parts: Sequence[Part], contour: SplineContour, fine: ApproximatingArcs) -> FloatArray:
    """(n,) parameters [rad] of the legs at the feet of the vertices of the arcs.

    A spline runs over the arc length, except for its deviation along the curve, which is as small
    as that across: one Newton step is enough, and any other place would do, see
    `camgeo.geometry.contour.proof`.
    """
    angles = np.repeat([part.begin for part in parts], fine.counts)
    low, width = [], []
    courses: dict[int, ArcLength] = {}
    for part, strand in zip(parts, contour.strands, strict=True):
        if part.course is not None:
            courses[id(part.course)] = part.course
        if isinstance(strand, CubicSpline):
            begin = 0.0 if part.course is None else part.course.s[part.piece, 0]
            low.append(begin + strand.knots[3:-4])
            width.append(np.diff(strand.knots[3:-3]))
    of_strand = np.repeat(np.arange(len(parts)), fine.counts)
    inner = fine.cubics >= 0
    inner[np.cumsum(fine.counts) - fine.counts] = False  # a strand's own start is known
    owner = np.array([id(part.course) for part in parts])[of_strand]
    piece = np.array([part.piece for part in parts])[of_strand]
    for key, course in courses.items():
        which = np.flatnonzero(inner & (owner == key))
        if not len(which):
            continue
        cubic = fine.cubics[which]
        s = np.concatenate(low)[cubic] + fine.shares[which] * np.concatenate(width)[cubic]
        found = course.angles(piece[which], s)
        points, tangents, pace = course.curve.traced(found)
        apart = (np.conj(tangents) * (fine.contour.vertices[which] - points)).real
        forward = pace > 0.0
        angles[which] = found + np.where(forward, apart, 0.0) / np.where(forward, pace, 1.0)
    return angles


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
def _over_quarters() -> FloatArray:
    """(7, 28): Bernstein coefficients of degree 6 over [0, 1] -> those over each quarter."""
    rows = np.zeros((ORDER + 1, QUARTERS, ORDER + 1))
    for k in range(ORDER + 1):
        for quarter in range(QUARTERS):
            low, high = quarter / QUARTERS, (quarter + 1) / QUARTERS
            for upper in range(ORDER + 1):
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
    """Sagitta of the arc of each part, 0 for a line, positive where it turns counter-clockwise;
    bound of the distance, infinite where the part does not certainly follow its arc.

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
    forward &= np.all(np.abs(sides.imag) <= math.tan(WIDEST) * sides.real, axis=1)

    from_line = np.max(np.abs((y @ ELEVATION) @ _over_quarters()), axis=1)
    line = from_line <= aim
    middle = 0.125 * (local[:, 0] + 3.0 * local[:, 1] + 3.0 * local[:, 2] + local[:, 3])
    # Through both ends and m: centre on x = L/2 at height h with |m|^2 = L m_x + 2 h m_y.
    height = np.where(line | (middle.imag == 0.0), 1.0, middle.imag)
    square = middle.real * (middle.real - lengths) + middle.imag * middle.imag
    centre = square / (2.0 * height)
    radius = np.where(forward, np.hypot(0.5 * lengths, centre), 1.0)
    from_arc, beside = _from_arcs(x, y, lengths, centre, radius)
    deep = 0.25 * lengths * lengths / (radius + np.abs(centre))
    sagitta = np.where(line, 0.0, np.sign(centre) * deep)
    from_arc = np.where(radius > flattest, np.maximum(from_arc, 8.0 * aim), from_arc)
    bound = np.where(line, from_line, np.where(beside, from_arc, np.inf))
    return sagitta, np.where(forward, bound, np.inf)


def _from_arcs(
    x: FloatArray, y: FloatArray, lengths: FloatArray, centre: FloatArray, radius: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Bound of the distance of parts, in the frame of their chords, from their circles; whether
    all rays from the centre to the part are near the middle one.
    """
    half = 0.5 / radius
    q = np.zeros((len(x), ORDER + 1))
    for i, j, share in PAIRS:
        q[:, i + j] += share * (x[:, i] * x[:, j] + y[:, i] * y[:, j])
    q *= half[:, None]
    # |x - c|^2 - r^2 = |x|^2 - 2 c x, for the circle passes through the origin.
    dot = (0.5 * lengths)[:, None] * x + centre[:, None] * y
    q -= ((2.0 * half)[:, None] * dot) @ ELEVATION
    off = np.max(np.abs(q @ _over_quarters()), axis=1)
    # |x - c| = sqrt(r^2 + 2 r q): the distance is q for small q, and at most this.
    inner = 1.0 - 2.0 * off / radius
    bound = 2.0 * off / (1.0 + np.sqrt(np.maximum(inner, 0.0)))
    arm = -np.sign(centre)[:, None] * (y - centre[:, None])
    aside = np.abs(x - 0.5 * lengths[:, None])
    within = np.all((arm > 0.0) & (aside <= math.tan(WIDEST) * arm), axis=1)
    return bound, within & (inner > 0.0)


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
    contour : these.
    apart : upper bound of the distance between the two, in both directions [mm].
    counts : (strands,) pieces of `contour` for each strand.
    cubics, shares : (n,) where the vertices of `contour` lie on the splines: the number of the
        cubic among all cubics of the contour, and the share of its span; -1 and 0 at arcs.
    """

    contour: Contour
    apart: float
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
    found = Contour(
        np.concatenate((starts, [arc.start for arc in contour.arcs]))[order],
        np.concatenate((sweeps, [arc.sweep for arc in contour.arcs]))[order],
        np.concatenate((centres, [arc.centre for arc in contour.arcs]))[order],
    )
    sizes = np.maximum(np.abs(centres) + np.abs(starts - centres), contour.reach)
    apart = np.max(parts.bounds + ROUNDING * sizes, initial=ROUNDING * contour.reach)
    none = np.zeros(len(exact))
    return ApproximatingArcs(
        found,
        float(apart),
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
        inwards = 1j * chords / lengths * (lengths * lengths / (8.0 * safe) - 0.5 * safe)
        centres = np.where(straight, 0.0, 0.5 * (starts + ends) + inwards)
        return starts, np.where(straight, 0.0, turned), centres


def _parts(pieces: list[ComplexArray], owners: list[int], tolerance: float, reach: float) -> _Parts:
    """Parts of all splines; `owners` are the numbers of the strands that these are."""
    none = np.zeros((0, CUBIC + 1), dtype=np.complex128)
    whole = np.concatenate([none, *pieces])
    moving = np.flatnonzero(np.max(np.abs(np.diff(whole, axis=1)), axis=1) > 0.0)
    owner = np.repeat(np.array(owners, dtype=np.intp), [len(each) for each in pieces])[moving]
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
    raise GeometryError("a spline turns back, or its points lie too unevenly for arcs to follow it")


def _first_counts(whole: ComplexArray, aim: float) -> IntArray:
    """(n,) about the number of arcs that each cubic needs: one through both ends and the middle is
    off by sqrt(3)/36 of the third difference across the chord.
    """
    chord = whole[:, 3] - whole[:, 0]
    length = np.abs(chord)
    third = chord - 3.0 * (whole[:, 2] - whole[:, 1])
    across = np.abs((np.conj(chord) * third).imag) / np.where(length > 0.0, length, 1.0)
    needed = np.ceil(FIRST * np.cbrt(math.sqrt(3.0) / 36.0 * across / aim))
    return np.clip(needed, 1.0, LARGEST_FACTOR).astype(np.intp)


# -- parts ----------------------------------------------------------------------------------------
# A path as parts for a fit of splines: smooth pieces, evaluated at once, and arcs.


ROUNDING_OF_PARTS = 2.0**-52 * 64.0
"""Rounding of a point, and smallest tolerance, as a fraction of the distance from the cam axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part of a path that becomes one strand: a smooth piece of a stretch, or a turn.

    Attributes
    ----------
    leg : number of the leg that it lies on.
    begin : its parameter [rad] where the strand begins.
    start : its point there [mm].
    course, piece : for a spline, the arc length that its knots measure, from the start of the piece
        of that number; None for an arc.
    sweep, centre : of an arc, [rad] and [mm].
    first, last : unit tangents at the ends of a smooth piece.
    """

    leg: int
    begin: float
    start: complex
    course: ArcLength | None = None
    piece: int = 0
    sweep: float = 0.0
    centre: complex = 0j
    first: complex = 0j
    last: complex = 0j

    def arc(self, end: complex) -> Arc | None:
        """The single arc of a dwell or a turn; None for a piece that needs a spline."""
        if self.course is not None:
            return None
        return Arc(self.start, end, self.sweep, self.centre)


def parts_of(legs: Sequence[Leg], tolerance: float) -> list[Part]:
    """The parts of a path, in order; those too short for a strand are omitted.

    Raises
    ------
    UndercutError
        If a piece is not regular.
    GeometryError
        If the path is torn apart inside a stretch.
    """
    stretches = [(k, leg) for k, leg in enumerate(legs) if isinstance(leg, StretchLeg)]
    pieces = [(number, leg, piece) for number, leg in stretches for piece in leg.pieces]
    found: list[Part | None] = [None] * len(pieces)
    right = np.empty(len(pieces), dtype=np.complex128)
    left = right.copy()
    for curve, chosen in by_curve([(leg, piece) for _, leg, piece in pieces]):
        numbers = [pieces[k][0] for k in chosen]
        starts, ends, parts = _of_curve(curve, [pieces[k][2] for k in chosen], numbers)
        right[chosen], left[chosen] = starts, ends
        for k, part in zip(chosen, parts, strict=True):
            found[k] = part
    order: list[Part] = []
    begin = 0
    for number, leg in enumerate(legs):
        if isinstance(leg, TurnLeg):
            if leg.length > SLIGHT * tolerance:
                order.append(Part(number, 0.0, leg.first, sweep=leg.sweep, centre=leg.centre))
            continue
        end = begin + len(leg.pieces)
        _require_joined(leg, right[begin:end], left[begin:end], tolerance)
        kept = [part for part in found[begin:end] if part is not None]
        if kept and not leg.closed:
            # An omitted piece before a part belongs to that part.
            start = kept[0].start if leg.first is None else leg.first
            kept[0] = replace(kept[0], start=start, begin=leg.start)
        order += kept
        begin = end
    return order


def _require_joined(
    leg: StretchLeg, right: ComplexArray, left: ComplexArray, tolerance: float
) -> None:
    """A parallel is torn apart where the follower's velocity jumps: there it is no single leg.

    `right`, `left` (pieces,) are the starts and the ends of its pieces.
    """
    gaps = np.abs(right - np.roll(left, 1))
    if not leg.closed:
        gaps[0] = 0.0
    if np.any(gaps > np.maximum(tolerance, ROUNDING_OF_PARTS * np.abs(right))):
        raise torn_apart(leg.pieces[int(np.argmax(gaps))].start)


def _of_curve(
    curve: WorkingCurve, pieces: Sequence[Piece], legs: Sequence[int]
) -> tuple[ComplexArray, ComplexArray, list[Part | None]]:
    """Starts and ends (pieces,) [mm] of pieces of one curve, and the parts that they will be; None
    for one too short. `legs` are the numbers of their legs.

    Two evaluations serve all: one from the right, one from the left, as calls cost more than
    numbers.
    """
    moving = [k for k, piece in enumerate(pieces) if not piece.is_arc]
    rests = [k for k, piece in enumerate(pieces) if piece.is_arc]
    phi, nodes = cells_of([pieces[k] for k in moving])
    count = len(moving)
    resting_from = np.array([pieces[k].start for k in rests])
    middle = np.array([0.5 * (pieces[k].start + pieces[k].end) for k in rests])
    here = Traced.of(
        curve, np.concatenate((phi[:, :-1].ravel(), nodes.ravel(), resting_from, middle))
    )
    back = Traced.of(curve, np.array([piece.end for piece in pieces]), "left")

    stop, last = phi[:, :-1].size, phi[:, :-1].size + nodes.size
    cells = here.shaped(slice(0, stop), (count, CELLS))
    inside = here.shaped(slice(stop, last), nodes.shape)
    resting = here.shaped(slice(last, None), (2, len(rests)))
    for place, k in enumerate(moving):
        check_regular(curve, pieces[k], inside.regular[place])
    for place, k in enumerate(rests):
        check_regular(curve, pieces[k], resting.regular[:, place])

    starts = np.empty(len(pieces), dtype=np.complex128)
    middles = starts.copy()
    starts[moving], middles[moving] = cells.points[:, 0], cells.points[:, CELLS // 2]
    starts[rests], middles[rests] = resting.points
    ends = back.points
    long = np.abs(middles - starts) + np.abs(ends - middles) > APART * np.abs(starts)

    rows = [place for place, k in enumerate(moving) if long[k]]
    kept = [moving[place] for place in rows]
    course = None
    if kept:
        points = np.column_stack((cells.points[rows], ends[kept]))
        tangents = np.column_stack((cells.tangents[rows], back.tangents[kept]))
        course = ArcLength.of(curve, phi[rows], points, tangents, taken(inside, rows))
    parts: list[Part | None] = [None] * len(pieces)
    for row, (place, k) in enumerate(zip(rows, kept, strict=True)):
        first, arriving = complex(cells.tangents[place, 0]), complex(back.tangents[k])
        begin, start = pieces[k].start, complex(starts[k])
        parts[k] = Part(legs[k], begin, start, course, row, first=first, last=arriving)
    for k in rests:
        if long[k]:
            centre = pieces[k].centre or 0j
            turn = -curve.pitch.rotation * (pieces[k].end - pieces[k].start)
            parts[k] = Part(legs[k], pieces[k].start, complex(starts[k]), sweep=turn, centre=centre)
    return starts, ends, parts


# -- arc length -----------------------------------------------------------------------------------
# Smooth pieces of a curve over their arc length, and their difficulty for a spline.
#
# All pieces of a path are evaluated in one call: the cost is in the calls, not in the points.


CELLS = 160
"""Cells of cam angle per piece. The arc length is only a parameter: its error of some 1e-8 moves a
spline along the curve, not off it."""

NODES = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
"""The three Gauss nodes in [-1, 1]."""

WEIGHTS = np.array([5.0, 8.0, 5.0]) / 9.0

SLOWEST = 1e-9
"""Smallest divisor 1 + d kappa; below it there is a cusp, where the difficulty is infinite at one
point."""

FLOOR = 0.02
"""Smallest density of knots, as a fraction of the piece's mean: every stretch gets knots."""

NEWTON = 4
"""Steps from the arc length to the cam angle, from a start within a cell."""


@dataclass(frozen=True, slots=True, eq=False)
class Traced:
    """One evaluation of a parallel at n cam angles, in arrays of one shape.

    Attributes
    ----------
    points, tangents : complex [mm], and unit in the direction of growing cam angle.
    speed : |Z'| of the pitch curve [mm/rad].
    regular : 1 + d kappa.
    bend : kappa of the pitch curve [1/mm].
    slope : dkappa/dphi of the pitch curve [1/(mm rad)].
    """

    points: ComplexArray
    tangents: ComplexArray
    speed: FloatArray
    regular: FloatArray
    bend: FloatArray
    slope: FloatArray

    @classmethod
    def of(cls, curve: WorkingCurve, phi: FloatArray, side: Side = "right") -> Traced:
        """The evaluation at `phi` (n,) [rad], in one call."""
        pitch = curve.pitch
        relative = pitch.relative_jet(phi, side)
        speed = pitch.speed(relative)
        jet = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        tangents = jet[1] / speed
        points = jet[0] + (1j * pitch.rotation * curve.distance) * tangents
        bend = bend_of_path(relative, speed, pitch.rotation)
        if len(relative.along) <= FULL_ORDER:  # a flat face has no R_3
            slope = pitch.curvature_slope(phi, side)
        else:
            (_, a1, a2, a3), (_, b1, b2, b3) = relative.along, relative.across
            cube = speed * speed * speed
            growth = (a1 * a2 + b1 * b2) / (speed * speed)
            slope = pitch.rotation * (b1 * a3 - a1 * b3) / cube - 3.0 * bend * growth
        return cls(points, tangents, speed, 1.0 + curve.distance * bend, bend, slope)

    def shaped(self, which: slice, shape: tuple[int, ...]) -> Traced:
        """The part `which` of all arrays, reshaped."""
        part = taken(self, which)
        return Traced(*(getattr(part, each.name).reshape(shape) for each in fields(part)))


@dataclass(frozen=True, slots=True, eq=False)
class ArcLength:
    """Smooth pieces of one parallel, end to end on one line of arc length S.

    Piece k is S in [ends[k], ends[k + 1]] [mm]; its cells of cam angle are uniform.

    Attributes
    ----------
    curve : the parallel.
    phi : (pieces, CELLS + 1) cam angles [rad] of the cells' ends.
    s : (pieces, CELLS + 1) arc length S [mm] there.
    points, tangents : (pieces, CELLS + 1) complex, there [mm] and unit.
    pace : (pieces, CELLS, 3) ds/dphi [mm/rad] at Gauss's nodes.
    density : (pieces, CELLS) difficulty |kappa'' - kappa^3|^(1/4) [1/mm] of each cell.
    """

    curve: WorkingCurve
    phi: FloatArray
    s: FloatArray
    points: ComplexArray
    tangents: ComplexArray
    pace: FloatArray
    density: FloatArray

    @classmethod
    def of(
        cls,
        curve: WorkingCurve,
        phi: FloatArray,
        points: ComplexArray,
        tangents: ComplexArray,
        inside: Traced,
    ) -> ArcLength:
        """From the curve at the cells' ends and, `inside`, at the nodes: see `cells_of`.

        The pieces must be regular, except for cusps at single points.
        """
        half = 0.5 * (phi[:, -1:] - phi[:, :1]) / CELLS
        regular = np.maximum(inside.regular, SLOWEST)
        pace = inside.speed * regular
        steps = half * (pace @ WEIGHTS)
        lengths = np.sum(steps, axis=1)
        ends = np.concatenate(([0.0], np.cumsum(lengths)))
        s = np.concatenate((np.zeros_like(half), np.cumsum(steps, axis=1)), axis=1)
        # The two curvatures of a parallel: kappa_d = kappa/(1 + d kappa), and its slope over s_d.
        slope = inside.slope / (pace * regular * regular)
        kappa = inside.bend[..., 1] / regular[..., 1]
        apart = half * (pace[..., 0] + pace[..., 2]) * 0.5 * (NODES[2] - NODES[0])
        second = (slope[..., 2] - slope[..., 0]) / apart
        density = np.sqrt(np.sqrt(np.abs(second - kappa**3)))
        return cls(curve, phi, s + ends[:-1, None], points, tangents, pace, density)

    @property
    def ends(self) -> FloatArray:
        """(pieces + 1,) S [mm] at the ends of the pieces."""
        return np.append(self.s[:, 0], self.s[-1, -1])

    @property
    def totals(self) -> FloatArray:
        """(pieces,) integral of the difficulty over each piece."""
        totals: FloatArray = np.sum(self.density * np.diff(self.s, axis=1), axis=1)
        return totals

    def require_finite(self) -> None:
        """Raise GeometryError if the curve stands still or its difficulty is not finite."""
        if not np.all(np.isfinite(self.s)) or np.any(np.diff(self.s, axis=1) <= 0.0):
            raise GeometryError("the curve stands still: no spline over its arc length can be made")
        if not np.all(np.isfinite(self.totals)):
            raise GeometryError("the curvature of the curve is infinite on a stretch of it")

    @property
    def shares(self) -> FloatArray:
        """(pieces, CELLS + 1) share of the difficulty up to each cell's end, from 0 to 1, floored;
        evenly along a piece without any.
        """
        steps = np.diff(self.s, axis=1)
        lengths = np.sum(steps, axis=1, keepdims=True)
        work = self.density * steps
        total = np.sum(work, axis=1, keepdims=True)
        least = np.where(total > 0.0, FLOOR * total, 1.0) / lengths
        sums = np.cumsum(work + least * steps, axis=1)
        shares = np.concatenate((np.zeros_like(lengths), sums / sums[:, -1:]), axis=1)
        shares[:, -1] = 1.0
        return shares

    def angles(self, piece: IntArray, s: FloatArray) -> FloatArray:
        """(n,) cam angles [rad] at the arc lengths S `s` (n,) [mm] of the pieces `piece` (n,)."""
        flat = self.s[:, :-1].ravel()
        cell = self._cells(piece, s)
        pace = self.pace.reshape(-1, 3)[cell]
        # Pace as a parabola a + b x + c x^2 over x in [-1, 1]; its integral is the arc length.
        a = pace[:, 1]
        b = (pace[:, 2] - pace[:, 0]) / (2.0 * NODES[2])
        c = (0.5 * (pace[:, 2] + pace[:, 0]) - a) / (NODES[2] * NODES[2])
        low = self.phi[:, :-1].ravel()[cell]
        first, whole = self.phi[:, 1] - self.phi[:, 0], self.phi[:, -1] - self.phi[:, 0]
        # The cells of a piece of some ulps are no longer apart.
        half = 0.5 * np.where(first > 0.0, first, whole / CELLS)[piece]
        wanted = (s - flat[cell]) / half
        x = np.clip(wanted / a - 1.0, -1.0, 1.0)
        for _ in range(NEWTON):
            reached = a * (x + 1.0) + b * (x * x - 1.0) / 2.0 + c * (x * x * x + 1.0) / 3.0
            slope = np.maximum(a + x * (b + x * c), 1e-3 * a)
            x = np.clip(x + (wanted - reached) / slope, -1.0, 1.0)
        return low + half * (x + 1.0)

    def near(self, piece: IntArray, s: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(n,), (n,) complex points [mm] and approximate unit tangents at S `s` (n,) [mm].

        By cubics between the cells' ends: for spans of at least four cells the cubics are off by
        less than a hundredth of what a spline of such spans is. Costs no evaluation.
        """
        cell = self._cells(piece, s)
        place = cell + cell // CELLS  # of the cell's start among the cells' ends
        flat, points, tangents = self.s.ravel(), self.points.ravel(), self.tangents.ravel()
        low, first, last = flat[place], points[place], points[place + 1]
        step = flat[place + 1] - low
        t = (s - low) / step
        leave, arrive = step * tangents[place], step * tangents[place + 1]
        chord = last - first
        bow, lean = leave - chord, arrive - chord
        w = 1.0 - t
        at = first + t * chord + (t * w) * (w * bow - t * lean)
        along = chord + (w * (1.0 - 3.0 * t)) * bow + (t * (3.0 * t - 2.0)) * lean
        return at, along / step

    def _cells(self, piece: IntArray, s: FloatArray) -> IntArray:
        """(n,) number of the cell that each `s` (n,) of the pieces `piece` (n,) lies in."""
        cell = np.searchsorted(self.s[:, :-1].ravel(), s, side="right") - 1
        return np.minimum(np.maximum(cell, piece * CELLS), piece * CELLS + (CELLS - 1))


def cells_of(pieces: Sequence[Piece]) -> tuple[FloatArray, FloatArray]:
    """(pieces, CELLS + 1) and (pieces, CELLS, 3) cam angles [rad] of cells' ends and nodes."""
    start = np.array([piece.start for piece in pieces])[:, None]
    end = np.array([piece.end for piece in pieces])[:, None]
    phi = start + (end - start) * (np.arange(CELLS + 1) / CELLS)
    phi[:, -1:] = end
    middle = 0.5 * (phi[:, :-1] + phi[:, 1:])
    half = 0.5 * (end - start) / CELLS
    return phi, middle[..., None] + half[..., None] * NODES
