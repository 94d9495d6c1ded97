"""A measured disc: how its points lie on the exact flank, and what their deviations do to the
follower.

A measured point is P = S + exp(i alpha) Q, with Q its place in cam coordinates, S the shift and
alpha the rotation of the part, counter-clockwise positive. A fit minimizes the sum of the squares
of the distances e of all Q from the flank. With the exact normal n at the foot of Q a step (dS,
dalpha) of the part changes e by

    de = -n . dS - (n . iQ) dalpha

to the first order, as the foot itself moves along the flank. That is the Jacobian A of the
Gauss-Newton method in closed form, and (A^T A)^-1 sigma^2 is the covariance of shift and rotation.
n . iQ is the lever of the normal about the cam axis; where the flank is a circle about any point it
is a linear combination of the components of n, and the rotation is undetermined.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from enum import StrEnum
from statistics import NormalDist
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.exact_flank import ExactFlank, Feet, Places
from camgeo.geometry.outline.replay import replay_contour, replay_outline, smooth_edges
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, dot, joined, taken
from camgeo.numeric.columns import Columns, NumberColumn, fault
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes, sampled_extremes
from camgeo.reading import COORDINATE
from camgeo.units import MM_PER, TURN, LengthUnit

# -- robust ---------------------------------------------------------------------------------------
# Weights with which a robust fit ignores local errors of form.
#
# Tukey's biweight: with e the deviation and s their scale, points count by (1 - u^2)^2 with u = e /
# (4.685 s), and not at all where |u| >= 1. The scale is the median of |e| over that of the normal
# distribution, so that up to half the points may be outliers. With normally distributed errors the
# result scatters as much as that of least squares with 95 % of the points. Its covariance is that
# of least squares with tau^2 in place of sigma^2 (P. J. Huber, Robust Statistics, 1981, section
# 7.6):
#
#     tau^2 = [sum psi^2 / (n - p)] / [mean psi']^2,  psi = e (1 - u^2)^2.


TUNING: Final = 4.685
"""Constant of Tukey's biweight for an efficiency of 95 % with normally distributed errors."""

NORMAL: Final = 0.6744897501960817
"""Median of the magnitude of a standard normal variable."""


def weights(deviations: FloatArray, floor: float) -> FloatArray:
    """(n,) weights of `deviations` (n,) [mm], whose scale is at least `floor` [mm]."""
    inside = 1.0 - _reduced(deviations, floor) ** 2
    return np.where(inside > 0.0, inside * inside, 0.0)


def standard_error(deviations: FloatArray, freedom: int, floor: float) -> float:
    """tau [mm] of the fit that leaves these `deviations` (n,), with `freedom` n - p."""
    square = _reduced(deviations, floor) ** 2
    inside = np.maximum(1.0 - square, 0.0)
    psi = deviations * inside * inside
    # The mean of d psi/de = (1 - u^2)(1 - 5 u^2).
    slope = float(np.mean(inside * (1.0 - 5.0 * square)))
    return math.sqrt(float(np.sum(psi * psi)) / freedom) / slope if slope > 0.0 else math.inf


def _reduced(deviations: FloatArray, floor: float) -> FloatArray:
    """(n,) u, the deviations relative to their scale; |u| < 1 for points that count."""
    scale = max(float(np.median(np.abs(deviations))) / NORMAL, floor)
    return deviations / (TUNING * scale)


# -- deviation ------------------------------------------------------------------------------------
# Deviations of measured points from the exact flank, over the cam angle.
#
# The scatter of single readings is the part of each deviation that a straight line between its
# neighbours along the flank does not explain. Form errors that extend over many points hardly
# contribute to it, whatever their size.


FEWEST_DEVIATIONS: Final = 12
"""Least number of points from which a scatter is computed."""

FORM_FACTOR: Final = 1.2
"""Where the root mean square exceeds the scatter by this factor, errors of form are reported."""

ONE: Final = 1e-6
"""Points whose feet are closer than this [rad] count as one, with the mean of their deviations."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A range of the path without measured points.

    Attributes
    ----------
    width : of cam angle [rad].
    place : cam angle [rad] at which it begins.
    """

    width: float
    place: float


@dataclass(frozen=True, slots=True, eq=False)
class Deviations:
    """Deviations in the order of the path, in which no place occurs twice.

    Attributes
    ----------
    places : (n,) feet of the points on the exact flank.
    values : (n,) deviations [mm], positive where there is too much material.
    widest : the widest gap between neighbouring points.
    """

    places: Places
    values: FloatArray
    widest: Gap

    @property
    def extremes(self) -> Extremes:
        """Smallest and largest deviation [mm], each with its cam angle [rad]."""
        return sampled_extremes(self.places.phi, self.values)

    @property
    def profile(self) -> float:
        """Width [mm] of the narrowest zone, symmetric about the flank, that contains all points.

        A profile tolerance of ISO 1101 limits this width.
        """
        return 2.0 * self.extremes.magnitude

    @property
    def root_mean_square(self) -> float:
        """Root mean square of the deviations [mm]."""
        return float(np.sqrt(np.mean(self.values**2)))

    @property
    def scatter(self) -> float:
        """Standard deviation [mm] of a single reading, from each deviation and its neighbours."""
        values, course = self.values, self.places.course
        left, right = course[1:-1] - course[:-2], course[2:] - course[1:-1]
        share = right / (left + right)
        # Of three independent readings with the variance v, the difference from the line through
        # the outer two has the variance v (1 + share^2 + (1 - share)^2).
        rest = values[1:-1] - share * values[:-2] - (1.0 - share) * values[2:]
        variances = rest * rest / (1.0 + share * share + (1.0 - share) ** 2)
        return float(np.sqrt(np.mean(variances)))

    @property
    def form(self) -> float:
        """Root mean square [mm] of the errors of form, without scatter.

        It is 0 where they cannot be told from scatter: where all deviations together exceed the
        scatter by less than `FORM_FACTOR`.
        """
        total, scatter = self.root_mean_square, self.scatter
        return (
            math.sqrt(total * total - scatter * scatter) if total > FORM_FACTOR * scatter else 0.0
        )

    @property
    def uncertainty(self) -> float:
        """Bound [mm] that the errors of all deviations keep at once, at `CONFIDENCE`.

        Readings are assumed to scatter independently and normally; systematic errors of the
        measurement are not included.
        """
        # Bonferroni: each of n readings may leave a two-sided interval with 1/n of the probability.
        outside = (1.0 - CONFIDENCE) / (2.0 * len(self.values))
        return -NormalDist().inv_cdf(outside) * self.scatter

    @staticmethod
    def from_feet(flank: ExactFlank, feet: Feet, values: FloatArray) -> Deviations:
        """The deviations `values` (n,) [mm] at `feet` (n,), ordered along the path.

        Raises GeometryError if fewer than `FEWEST_DEVIATIONS` places have been measured.
        """
        order = np.argsort(feet.places.course, kind="stable")
        course, values = feet.places.course[order], values[order]
        first = np.concatenate(([True], np.diff(course) > ONE))
        starts = np.flatnonzero(first)
        if len(starts) < FEWEST_DEVIATIONS:
            raise GeometryError(
                f"points at {FEWEST_DEVIATIONS} places of the flank or more are needed, and there"
                f" are {len(starts)}"
            )
        counts = np.diff(np.append(starts, len(course)))
        means = np.add.reduceat(values, starts) / counts  # of points that count as one
        course = course[starts]
        places = flank.places(course)
        widths = np.diff(np.append(course, course[0] + flank.total))  # closed: the last gap wraps
        widest = int(np.argmax(widths))
        gap = Gap(float(widths[widest]), float(places.phi[widest]))
        return Deviations(places, means, gap)


# -- pressed --------------------------------------------------------------------------------------
# The follower pressed against a disc as it was measured.
#
# Between neighbouring points the deviation is linear along the path, and the disc is curved as the
# exact flank is: it consists of arcs that turn as the exact normal does, over cells of at most a
# quarter of a degree. With deviations of zero the follower reproduces the motion of the exact disc
# to 0.00002 mm at the corners of a trimmed flank, and ten times better on a whole one, so that what
# remains is the effect of the deviations.


STEP: Final = math.radians(1.0)
"""Step [rad] of the samples that a replay makes by itself, which are not used here."""

SAMPLES: Final = 3600
"""Number of cam angles at which lifts are compared for a picture, besides those of the points."""

SAME: Final = 1e-12
"""Nodes of a stretch that are closer than this [rad] count as one."""


@dataclass(frozen=True, slots=True, eq=False)
class LiftErrors:
    """The errors of the lift that the deviations of a disc cause.

    Attributes
    ----------
    phi : (n,) cam angles [rad] in [0, 2 pi), ascending, for a picture.
    errors : (n,) lift on the measured disc less that on the exact one [mm or rad].
    extremes : smallest and largest error of the revolution, with their cam angles [rad].
    """

    phi: FloatArray
    errors: FloatArray
    extremes: Extremes

    @staticmethod
    def from_deviations(
        flank: ExactFlank, deviations: Deviations, *, clearance: float = 0.0
    ) -> LiftErrors:
        """Compare the lift of the follower pressed against the measured disc and the exact one.

        `clearance` is that of the groove [mm], see `replay_outline`.

        Raises
        ------
        GeometryError
            If the follower cannot run all round the measured disc.
        """
        pitch = flank.curve.pitch
        exact = replay_outline(pitch, flank.path, step=STEP, clearance=clearance).lift
        contour = measured_contour(flank, deviations)
        actual = replay_contour(pitch, contour, flank.side, step=STEP).lift
        grid = np.arange(SAMPLES) * (TURN / SAMPLES)
        phi = np.unique(np.concatenate((grid, deviations.places.phi)))

        def error(phi: FloatArray, side: Side = "right") -> FloatArray:
            return actual.displacement(phi, side) - exact.displacement(phi, side)

        extremes = piecewise_extremes(error, smooth_edges(actual, exact))
        return LiftErrors(phi, error(phi), extremes)


def measured_contour(flank: ExactFlank, deviations: Deviations) -> Contour:
    """The contour of the disc, or of the hole, as measured: closed and counter-clockwise."""
    nodes = flank.nodes
    if flank.path.is_whole:
        nodes = taken(nodes, slice(None, -1))  # the last is the first
    measured = deviations.places
    # Measured places are added to the nodes, unless they coincide with one.
    near = np.searchsorted(nodes.course, measured.course)
    distances = np.minimum(
        np.abs(measured.course - nodes.course[np.maximum(near - 1, 0)]),
        np.abs(measured.course - nodes.course[np.minimum(near, len(nodes) - 1)]),
    )
    every: Places = joined([nodes, taken(measured, distances > SAME)])
    # Stable, so that of the two nodes at a corner the first one stays the first.
    every = taken(every, np.argsort(every.course, kind="stable"))
    amounts = np.interp(every.course, measured.course, deviations.values, period=flank.total)
    vertices = every.points + amounts * every.normals
    turns = np.angle(np.roll(every.normals, -1) * every.normals.conj())
    # At a corner two nodes share their place; the contour joins them by a straight line.
    corner = every.course == np.roll(every.course, -1)
    if not flank.path.is_whole:
        corner[-1] = True  # the path begins and ends at a corner
    return Contour.through(vertices, np.where(corner, 0.0, turns)).counter_clockwise()


# -- alignment ------------------------------------------------------------------------------------


CONFIDENCE: Final = 0.95
"""Level of confidence of each uncertainty by itself."""

FEWEST_POINTS: Final = 11
"""Least number of points of a fit."""

STEPS: Final = 40
"""Largest number of steps of a fit; from starts as near as these, it hardly takes six."""

SETTLED: Final = 1e-12
"""A step below this fraction of the flank's size is the last one: the fit has converged."""

ROBUST: Final = 1e-10
PATIENT: Final = 200
"""The same fraction and the largest number of steps of a robust fit, whose weights change from step
to step."""

NEAR: Final = 1e-5
TRIAL: Final = 15
"""The same fraction and the largest number of steps while starts are compared."""

SLACK: Final = 1000.0
"""A fit whose last step exceeds the fraction above by this factor has not converged."""

LOST: Final = 1e-9
"""A direction in which no point moves off the flank by more than this fraction of the step is
undetermined."""

STARTS: Final = 720
"""Number of rotations tried for the start of a fit, evenly spaced over a full turn."""

TRIED: Final = 6
"""How many of the best of them are followed."""

PROMISING: Final = 3.0
"""Starts that miss by this factor more than the best one are not followed."""

SOME: Final = 400
"""Number of points that decide between starts."""

ALIKE: Final = 1.5
"""Two fits whose distances differ by less than this factor are equally good."""

FLOOR: Final = 1e-12
"""Distances below this fraction of the flank's size are rounding."""

DISTINCT_TURN: Final = math.radians(1.0)
"""Fits that differ by a smaller rotation than this [rad] count as one."""


class Align(StrEnum):
    """What is fitted: nothing, the rotation about the cam axis, or shift and rotation."""

    DATUM = "datum"
    ROTATION = "rotation"
    FREE = "free"

    @property
    def fitted(self) -> int:
        """Number of fitted parameters."""
        return {Align.DATUM: 0, Align.ROTATION: 1, Align.FREE: 3}[self]


@dataclass(frozen=True, slots=True)
class Frame:
    """Where the part lies in the coordinates of the measurement.

    Attributes
    ----------
    shift : S [mm].
    turn : alpha [rad], counter-clockwise positive, in (-pi, pi].
    """

    shift: complex = 0j
    turn: float = 0.0

    def inward(self, points: ComplexArray) -> ComplexArray:
        """(n,) places of measured `points` (n,) [mm] in cam coordinates."""
        places: ComplexArray = (points - self.shift) * cmath.exp(-1j * self.turn)
        return places

    def moved(self, shift: complex, turn: float) -> Frame:
        """The frame after a step of the part in cam coordinates, first the shift, then the turn."""
        return Frame(
            self.shift + cmath.exp(1j * self.turn) * shift,
            -math.remainder(-self.turn - turn, 2.0 * math.pi),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """Measured points laid on the exact flank.

    Attributes
    ----------
    align : what is fitted.
    frame : position of the part in the measurement.
    feet : feet of the points on the flank, in cam coordinates.
    deviations : (n,) distances from the flank less the radius of the ball [mm], positive where
        there is too much material.
    shift_uncertainty : of both coordinates of the shift [mm], at `CONFIDENCE`; None if not fitted.
    turn_uncertainty : of the rotation [rad]; infinite if the points do not determine it, None if it
        is not fitted.
    sway : how much errors of form can move a fit of least squares: the largest shift [mm] and
        rotation [rad] that any deviations of 1 mm root mean square cause; 0 for what is not fitted.
    other_turn : another rotation [rad] at which the points fit as well, as on a flank that repeats
        itself; None if there is none.
    """

    align: Align
    frame: Frame
    feet: Feet
    deviations: FloatArray
    shift_uncertainty: tuple[float, float] | None = None
    turn_uncertainty: float | None = None
    sway: tuple[float, float] = (0.0, 0.0)
    other_turn: float | None = None

    @staticmethod
    def from_points(
        flank: ExactFlank,
        points: ComplexArray,
        align: Align,
        ball: float = 0.0,
        *,
        robust: bool = False,
    ) -> Alignment:
        """Lay measured `points` (n,) [mm] on the flank, by least squares.

        Parameters
        ----------
        ball : radius [mm] of the ball whose centres the points are; 0 for points of the flank.
        robust : whether the fit ignores local errors of form, by the weights of `weights`.

        Raises
        ------
        GeometryError
            If there are too few points for a fit, it does not converge, or the points do not
            determine the shift.
        """
        if align is Align.DATUM:
            return _alignment(flank, points, align, Frame(), ball)
        if len(points) < FEWEST_POINTS:
            raise GeometryError(
                f"a fit needs {FEWEST_POINTS} points or more, and there are {len(points)};"
                " align by datum"
            )
        frame, other = _best(flank, points, align, ball)
        frame = _fit(flank, points, align, frame, ball)
        if robust:
            frame = _fit(flank, points, align, frame, ball, ROBUST, PATIENT, robust=True)
        alignment = _alignment(flank, points, align, frame, ball)
        shift, turn, sway = _uncertainties(alignment, flank.size, robust=robust)
        other = None if math.isinf(turn) else other
        return replace(
            alignment, shift_uncertainty=shift, turn_uncertainty=turn, sway=sway, other_turn=other
        )


def _alignment(
    flank: ExactFlank, points: ComplexArray, align: Align, frame: Frame, ball: float
) -> Alignment:
    """The points in a given frame, without uncertainties."""
    feet = flank.feet(frame.inward(points))
    return Alignment(align, frame, feet, feet.distances - ball)


def _best(
    flank: ExactFlank, points: ComplexArray, align: Align, ball: float
) -> tuple[Frame, float | None]:
    """A frame near the best one, and another rotation that fits as well, if there is one."""
    some = points[:: -(-len(points) // SOME)]
    fits: list[tuple[float, Frame]] = []
    for start in _starts(flank, some, align):
        try:
            frame = _fit(flank, some, align, start, ball, NEAR, TRIAL)
        except GeometryError:
            continue
        distances = flank.feet(frame.inward(some)).distances - ball
        fits.append((float(np.sqrt(np.mean(distances**2))), frame))
    if not fits:
        raise GeometryError(
            "the points do not lie on a flank of this disc: no fit of them converges"
        )
    # Of equally good fits, the one with the smallest rotation is meant.
    least = ALIKE * min(size for size, _ in fits) + FLOOR * flank.size
    good = [frame for size, frame in fits if size <= least]
    best = min(good, key=lambda frame: abs(frame.turn))
    others = [
        frame.turn
        for frame in good
        if abs(math.remainder(frame.turn - best.turn, 2.0 * math.pi)) > DISTINCT_TURN
    ]
    return best, min(others, key=abs, default=None)


def _starts(flank: ExactFlank, points: ComplexArray, align: Align) -> list[Frame]:
    """Frames from which a fit may converge.

    Distances from the cam axis over the polar angle are compared at many rotations. If a shift is
    fitted too, the axis is estimated first, by the centres of area.
    """
    nodes = flank.nodes.points
    order = np.argsort(np.angle(nodes))
    polar, radii = np.angle(nodes)[order], np.abs(nodes)[order]

    def misses(inward: ComplexArray) -> FloatArray:
        nominal = np.interp(np.angle(inward), polar, radii, period=2.0 * math.pi)
        return np.asarray(np.sqrt(np.mean((np.abs(inward) - nominal) ** 2, axis=-1)))

    centre, flank_centre = 0j, 0j
    if align is Align.FREE:
        centre, flank_centre = _centre(points), _centre(nodes)
    turns = np.linspace(-math.pi, math.pi, STARTS, endpoint=False)
    misfits = misses((points - centre) * np.exp(-1j * turns)[:, np.newaxis] + flank_centre)
    lowest = np.flatnonzero((misfits <= np.roll(misfits, 1)) & (misfits <= np.roll(misfits, -1)))
    lowest = lowest[np.argsort(misfits[lowest], kind="stable")][:TRIED]
    # The best rotation may lie between two that were tried, half their spacing away.
    unsure = PROMISING * float(misfits[lowest[0]]) + math.pi / STARTS * flank.size
    starts = [
        Frame(centre - flank_centre * cmath.exp(1j * turn), turn) for turn in turns[lowest].tolist()
    ]
    promising = [
        start for start, miss in zip(starts, misfits[lowest], strict=True) if miss <= unsure
    ]
    return [Frame()] * bool(misses(points) <= unsure) + promising


def _centre(points: ComplexArray) -> complex:
    """Centroid of the polygon through `points` (n,), ordered by polar angle about their mean."""
    mean = complex(np.mean(points))
    ring = points - mean
    ring = ring[np.argsort(np.angle(ring))]
    following = np.roll(ring, -1)
    areas = (ring.conj() * following).imag
    total = float(np.sum(areas))
    return (
        mean if total <= 0.0 else mean + complex(np.sum((ring + following) * areas)) / total / 3.0
    )


def _jacobian(feet: Feet, size: float) -> FloatArray:
    """(n, 3) -de for steps of the shift [mm] and of the rotation [rad] times `size` [mm].

    With `size`, the flank's, all three columns have the same unit and are comparable.
    """
    normals = feet.places.normals
    places = feet.places.points + feet.distances * normals
    return np.column_stack((normals.real, normals.imag, dot(normals, 1j * places) / size))


def _fit(
    flank: ExactFlank,
    points: ComplexArray,
    align: Align,
    frame: Frame,
    ball: float,
    settled: float = SETTLED,
    steps: int = STEPS,
    *,
    robust: bool = False,
) -> Frame:
    """The frame of least squares near `frame`, by Gauss and Newton; with weights if `robust`."""
    last = math.inf
    for _ in range(steps):
        feet = flank.feet(frame.inward(points))
        matrix = _jacobian(feet, flank.size)
        columns = _determined(matrix, align)
        step = np.zeros(3)
        misses = feet.distances - ball
        if robust:
            # Rows times the roots of the weights: least squares then minimizes the weighted sum.
            roots = np.sqrt(weights(misses, FLOOR * flank.size))
            matrix, misses = matrix * roots[:, np.newaxis], misses * roots
        step[columns] = np.linalg.lstsq(matrix[:, columns], misses, rcond=None)[0]
        step /= flank.size
        frame = frame.moved(complex(step[0], step[1]) * flank.size, float(step[2]))
        last = float(np.max(np.abs(step)))
        if last <= settled or last > 1.0:
            break
    if last > SLACK * settled:
        raise GeometryError(
            "the points do not lie on a flank of this disc: the fit does not converge"
        )
    return frame


def _determined(matrix: FloatArray, align: Align) -> list[int]:
    """The columns of `matrix` (n, 3) that are fitted and that the points determine.

    Raises GeometryError if they do not determine the shift.
    """
    count = math.sqrt(len(matrix))
    if align is Align.FREE:
        if np.linalg.svd(matrix[:, :2], compute_uv=False)[1] <= LOST * count:
            raise GeometryError(
                "the points do not determine the shift of the part: their normals are all parallel;"
                " measure all round, or align by datum"
            )
        # The rotation is determined by what its column has beyond those of the shift.
        known, _ = np.linalg.qr(matrix[:, :2])
        lever = matrix[:, 2] - known @ (known.T @ matrix[:, 2])
    else:
        lever = matrix[:, 2]
    shows = float(np.linalg.norm(lever)) > LOST * count
    return [0, 1] * (align is Align.FREE) + [2] * shows


def _uncertainties(
    alignment: Alignment, size: float, *, robust: bool = False
) -> tuple[tuple[float, float] | None, float, tuple[float, float]]:
    """The uncertainties of shift [mm] and rotation [rad] at `CONFIDENCE`, and the sway.

    They follow from the covariance by Student's t distribution.
    """
    from scipy.special import stdtrit  # only fits need it

    count = len(alignment.deviations)
    matrix = _jacobian(alignment.feet, size)
    columns = _determined(matrix, alignment.align)
    freedom = count - alignment.align.fitted
    sigma = math.sqrt(float(np.sum(alignment.deviations**2)) / freedom)
    if robust:
        sigma = standard_error(alignment.deviations, freedom, FLOOR * size)
    factor = sigma * float(stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE))
    chosen = matrix[:, columns]
    cofactors = np.zeros((3, 3))
    if columns:
        cofactors[np.ix_(columns, columns)] = np.linalg.inv(chosen.T @ chosen)
    turn_factor = math.sqrt(cofactors[2, 2]) / size
    turn = factor * turn_factor if 2 in columns else math.inf
    # The shift is that of the cam axis in the coordinates of the measurement, which are rotated.
    cosine, sine = math.cos(alignment.frame.turn), math.sin(alignment.frame.turn)
    across = np.array([[cosine, -sine], [sine, cosine]])
    covariance = across @ cofactors[:2, :2] @ across.T
    x, y = (factor * math.sqrt(covariance[k, k]) for k in (0, 1))
    # By Cauchy and Schwarz: the fit is linear in the deviations, and its rows have these norms.
    shift_factor = math.sqrt(float(np.linalg.norm(cofactors[:2, :2], 2)))
    sway = (math.sqrt(count) * shift_factor, math.sqrt(count) * turn_factor)
    return ((x, y) if alignment.align is Align.FREE else None), turn, sway


# -- measured -------------------------------------------------------------------------------------
# The columns x and y of a CSV file.


UNITS: Final[dict[str, LengthUnit]] = {
    "mm": "mm", "inch": "inch", "in": "inch", '"': "inch"
}  # fmt: skip

LENGTHS: Final = tuple(
    NumberColumn(name, (name, f"{name} measured", f"measured {name}"), tuple(UNITS), "mm or inch")
    for name in "xy"
)


def measured_points(columns: Columns, file: str, unit: LengthUnit) -> ComplexArray:
    """(n,) complex points [mm] from the first two columns, x and y; in `unit` if they state none.

    Raises GeometryError with file and line if the columns have different units, or if a coordinate
    is too large.
    """
    units = {UNITS[stated_unit.lower()] for stated_unit in columns.units[:2] if stated_unit}
    if len(units) > 1:
        raise fault(file, columns.lines[0], "", "x and y have different units; allowed: one")
    x, y = columns.values[:2]
    for values in (x, y):
        beyond = np.flatnonzero(np.abs(values) > COORDINATE)
        if len(beyond):
            row = int(beyond[0])
            message = f"too large; allowed: coordinates up to {COORDINATE:g}"
            raise fault(file, columns.lines[row], repr(float(values[row])), message)
    places: ComplexArray = (x + 1j * y) * MM_PER[units.pop() if units else unit]
    return places


# -- normals --------------------------------------------------------------------------------------
# Normals that a file states next to its points, compared with the true ones.
#
# A measuring machine subtracts the radius of its ball along the normal that it is given. Normals
# along the radius from the cam axis, as computed from a table of polar coordinates, are wrong by
# the angle delta between normal and radius. The resulting point is then off the flank by r (1 - cos
# delta) for a ball of radius r: the flank seems to have more material than it has.


TELLING: Final = np.radians(1.0)
"""Least angle [rad] between normal and radius at which a stated normal tells which one it is."""


@dataclass(frozen=True, slots=True)
class StatedNormals:
    """How the normals that a file states compare with the true ones.

    Attributes
    ----------
    largest : largest angle [rad] between a stated and the true normal, with its cam angle.
    into_material : whether they point into the material; their angles are then those of the
        opposite directions.
    radial : whether most of those that tell are nearer to the radius than to the true normal.
    """

    largest: Extreme
    into_material: bool
    radial: bool


def radius_angles(feet: Feet) -> FloatArray:
    """(n,) angle delta [rad] from the radius from the cam axis to the true normal, signed.

    The radius is reversed where it points to the other side of the flank than the normal.
    """
    radii = feet.places.points / np.abs(feet.places.points)
    turned = feet.places.normals * radii.conj()
    return np.angle(np.where(turned.real < 0.0, -turned, turned))


def false_share(delta: FloatArray) -> FloatArray:
    """(n,) 1 - cos delta: the apparent deviation by radial normals, per radius of the ball."""
    # Without the cancellation of 1 - cos at small angles.
    return 2.0 * np.sin(0.5 * delta) ** 2


def stated_normals(feet: Feet, turn: float, normals: ComplexArray) -> StatedNormals:
    """Compare stated `normals` (n,) of any length but 0 with the true ones at the `feet` (n,).

    The part is rotated by `turn` [rad] in the coordinates of the measurement.
    """
    relative = normals * np.exp(-1j * turn) * feet.places.normals.conj()
    into_material = bool(np.median(relative.real) < 0.0)
    angles = np.angle(-relative if into_material else relative)
    # The radius lies at -delta from the true normal.
    delta = radius_angles(feet)
    telling = np.abs(delta) > TELLING
    nearer = np.abs(angles + delta) < np.abs(angles)
    radial = bool(np.any(telling) and np.mean(nearer[telling]) > 0.5)
    worst = int(np.argmax(np.abs(angles)))
    largest = Extreme(float(abs(angles[worst])), float(feet.places.phi[worst]))
    return StatedNormals(largest, into_material, radial)


# -- axes -----------------------------------------------------------------------------------------
# Points measured in other coordinates than those of the cam: shifted, rotated, or from the other
# side.


GROSS: Final = 2e-3
"""Deviations (root mean square) beyond this fraction of the flank's size are not manufacturing
errors: 0.1 mm on a cam of 50 mm."""

BETTER: Final = 0.1
"""Other coordinates are right if at most this share of the deviations is left in them."""


@dataclass(frozen=True, slots=True)
class OtherAxes:
    """Coordinates in which the points fit.

    Attributes
    ----------
    frame : position of the part in the coordinates of the measurement; their y is reversed if
        `mirrored`.
    mirrored : whether the points are those of the disc seen from the other side.
    left : root mean square of the remaining deviations [mm].
    """

    frame: Frame
    mirrored: bool
    left: float


def other_axes(
    flank: ExactFlank, points: ComplexArray, deviation: float, ball: float = 0.0
) -> OtherAxes | None:
    """The coordinates in which measured `points` (n,) [mm] fit far better than as measured.

    `deviation` is the root mean square of the deviations as measured [mm]. None if it is not gross,
    or if no other coordinates are much better.
    """
    some = points[:: -(-len(points) // SOME)]
    if deviation <= GROSS * flank.size or len(some) < FEWEST_POINTS:
        return None
    candidates = []
    for mirrored in (False, True):
        try:
            alignment = Alignment.from_points(
                flank, some.conj() if mirrored else some, Align.FREE, ball
            )
        except GeometryError:
            continue
        left = float(np.sqrt(np.mean(alignment.deviations**2)))
        candidates.append(OtherAxes(alignment.frame, mirrored, left))
    # On a flank that is its own mirror image, rounding must not decide for the other side: it has
    # to be twice as good.
    best = min(candidates, key=lambda each: (1.0 + each.mirrored) * each.left, default=None)
    return best if best is not None and best.left < BETTER * deviation else None
