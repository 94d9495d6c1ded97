"""From derivatives over the cam angle to derivatives over time: the cam's own motion phi(t).

VDI 2143-1, eqs. (1) to (4): s' and s'' over the angle, the angle's velocity omega = dphi/dt and
acceleration alpha = d^2phi/dt^2 give velocity and acceleration over time; the third derivative
follows from (2) by applying the chain rule once more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Annotated, Final, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.motion import Jet, Motion
from camgeo.kinematics.plan import MotionPlan, Move, SplineMove
from camgeo.numeric import checked
from camgeo.numeric.arrays import FloatArray, IntArray, Quantity, Side, ascending
from camgeo.numeric.extremes import (
    Extremes,
    isolated_roots,
    isolation_places,
    piecewise_extremes_of_many,
    sampled_extremes,
)
from camgeo.record import Pickled
from camgeo.units import RPM, TURN, LiftUnit, at_cam_angles, counted

if TYPE_CHECKING:
    from camgeo.kinematics.splines import Spline

CLOSING: Final = 1e-9
"""The table of a speed curve may miss a full turn by this much [rad]: rounding of its degrees."""

SMOOTH, SHARP = np.array([1, 2]), np.array([3, 4])
"""Rows of velocity and acceleration, which have extremes where the next row vanishes, and rows of
jerk and torque, whose slopes are not known."""

AngularSpeed = Annotated[float, partial(checked.positive, unit="rad/s")]

FEWEST_ROWS: Final = 4
"""Smallest number of rows of a speed curve."""

METRES: Final[dict[LiftUnit, float]] = {"mm": 1e-3, "rad": 1.0}
"""Factor from the unit of lift to the one in which M = m v a / omega holds without conversion."""


class TimeCourse(Protocol):
    """The angular motion of the cam over one turn, repeated with every turn."""

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles in [0, 2 pi) [rad], ascending, where its formula changes; omega is
        continuous there.
        """

    @property
    def jumps(self) -> FloatArray:
        """The borders at which alpha jumps."""

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """(3, n) omega [rad/s], alpha [rad/s^2] and dalpha/dt [rad/s^3] at `phi` (n,) [rad],
        approached from the given side.
        """

    def time(self, phi: FloatArray) -> FloatArray:
        """(n,) time [s] at which the cam is at `phi` (n,) [rad], any number of turns."""


@dataclass(frozen=True, slots=True)
class ConstantSpeed(checked.CheckedFields):
    """The cam turns at constant speed; time 0 is at cam angle 0.

    Attributes
    ----------
    speed : omega [rad/s], above 0: the cam angle counts in the sense of rotation.

    Raises
    ------
    GeometryError
        If `speed` is not a finite number above 0.
    """

    speed: AngularSpeed

    @property
    def borders(self) -> FloatArray:
        return np.empty(0)

    @property
    def jumps(self) -> FloatArray:
        return np.empty(0)

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        del side
        rates = np.zeros((3, len(phi)))
        rates[0] = self.speed
        return rates

    def time(self, phi: FloatArray) -> FloatArray:
        return np.asarray(phi, dtype=np.float64) / self.speed


@dataclass(frozen=True, slots=True, eq=False)
class SpeedCurve(Pickled):
    """The cam angle over time from a table of one turn: a periodic quintic spline through it, C4.

    Attributes
    ----------
    t : (n,) time [s], ascending, n >= 4.
    phi : (n,) cam angle [rad], ascending; the last one is a turn beyond the first.
    spline : phi over t.

    Raises
    ------
    GeometryError
        If the table does not ascend or does not span exactly a turn, and if phi' <= 0 anywhere: the
        cam would stand still or run backwards.
    """

    t: FloatArray
    phi: FloatArray
    spline: Spline = field(init=False, repr=False)

    def __post_init__(self) -> None:
        t, phi = checked.array("t", self.t), checked.array("phi", self.phi)
        checked.hold(self, t=t, phi=phi)
        if len(t) != len(phi):
            rows = f"{counted(len(t), 'time')} and {counted(len(phi), 'angle')}"
            raise GeometryError(f"{rows}; allowed: as many angles as times", key="phi")
        if len(t) < FEWEST_ROWS:
            raise GeometryError(
                f"{counted(len(t), 'row')}; allowed: {FEWEST_ROWS} rows or more", key="t"
            )
        span = float(phi[-1] - phi[0])
        if not abs(span - TURN) <= CLOSING:
            raise GeometryError(
                f"the cam angle advances by {span!r} rad from the first to the last row; allowed:"
                f" one turn, {TURN!r}",
                key="phi",
                value=repr(span),
            )
        from camgeo.kinematics.splines import (
            Spline,
        )  # only needed here: constant speed has no spline

        spline = Spline.closed(t, phi, float(t[-1] - t[0]), TURN, gap=CLOSING)
        slowest = spline.extremes(1).lowest
        if not slowest.value > 0.0:
            angle = float(spline.values(np.array([slowest.place]), 0)[0, 0])
            raise GeometryError(
                "the cam would stand still or run backwards between the rows:"
                f" {slowest.value / RPM:.6g} rev/min {at_cam_angles(angle)}, {slowest.place:.6g} s;"
                " allowed: above 0",
                key="phi",
                value=repr(slowest.value),
            )
        checked.hold(self, spline=spline)

    @classmethod
    def read(cls, data: bytes | str, file: str) -> SpeedCurve:
        """Read a table of time [s] and cam angle [degrees] over one turn, from 0 and 0.

        The format is that of `camgeo.numeric.columns`; a heading may call the columns "t" or "time"
        [s], and "phi", "angle" or "cam angle" [deg].

        Raises
        ------
        GeometryError
            With file and line, if a row is not as described there, times or angles do not start at
            0, ascend, or end at 360 degrees; and if the disc would stand still or run backwards
            between the rows.
        """
        # few curves are in a file
        from camgeo.kinematics.tables import ANGLE, TwoColumns
        from camgeo.numeric.columns import NumberColumn

        time = NumberColumn("time", ("t", "time"), ("s", "sec", "second", "seconds"), "s")
        table = TwoColumns.read(data, file, (time, ANGLE))
        times = table.first
        table.check_from_zero(times, "time")
        radians = table.turn_radians(table.second)
        try:
            return cls(times, radians)
        except GeometryError as error:  # whose key is not one of the file
            raise GeometryError(f"{file}: {error.message}", value=error.value) from error

    @property
    def borders(self) -> FloatArray:
        """(n - 1,) the cam angles of the table, in [0, 2 pi)."""
        return ascending(np.mod(self.phi[:-1], TURN))

    @property
    def jumps(self) -> FloatArray:
        return np.empty(0)

    def rates(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        del side  # all three are continuous
        return self.spline.values(self.time(phi))[1:]

    def time(self, phi: FloatArray) -> FloatArray:
        return self.spline.inverse(phi)


def period(course: TimeCourse) -> float:
    """Duration of a turn [s]."""
    start, end = course.time(np.array([0.0, TURN]))
    return float(end - start)


def in_time(jet: Jet, course: TimeCourse, phi: FloatArray, side: Side = "right") -> FloatArray:
    """Lift and its derivatives over time.

    Parameters
    ----------
    jet : (4, n) s, s', s'', s''' over the cam angle at `phi`, from `side` [mm or rad per rad^k].
    course : how the cam turns.
    phi : (n,) cam angles [rad].

    Returns
    -------
    (4, n) s [mm], velocity v = s' omega [mm/s], acceleration a = s'' omega^2 + s' alpha [mm/s^2]
    and jerk s''' omega^3 + 3 s'' omega alpha + s' dalpha/dt [mm/s^3], or with rad instead of mm.
    VDI 2143-1, eqs. (1) and (2); with constant omega (3) and (4).
    """
    return _chained(jet, course.rates(phi, side))


def _chained(jet: Jet, rates: FloatArray) -> FloatArray:
    omega, alpha, alpha_rate = rates
    s, s1, s2, s3 = jet[:4]
    return np.stack(
        (
            s,
            s1 * omega,
            s2 * omega**2 + s1 * alpha,
            s3 * omega**3 + 3.0 * s2 * omega * alpha + s1 * alpha_rate,
        )
    )


def inertia_torque(
    timed: FloatArray, omega: FloatArray, inertia: float = 1.0, unit: LiftUnit = "mm"
) -> FloatArray:
    """(n,) torque [N m] on the camshaft that accelerates the follower: M omega = m v a.

    Parameters
    ----------
    timed : (4, n) lift over time, as `in_time` gives it.
    omega : (n,) [rad/s] of the cam.
    inertia : mass [kg] of a follower whose lift is in mm, or moment of inertia [kg m^2] of one
        whose swing is in rad; 1 gives the torque per unit of it.
    unit : of the lift.

    Positive where the cam drives the follower, negative where the follower drives the cam; its
    integral over the cam angle is zero over a turn. Spring, load and friction are not included.
    """
    return np.asarray(inertia * METRES[unit] ** 2 * timed[1] * timed[2] / omega)


@dataclass(frozen=True, slots=True)
class TimeExtremes:
    """Smallest and largest values over a turn, signed, with their cam angles [rad].

    Attributes
    ----------
    velocity : [mm/s or rad/s]
    acceleration : [mm/s^2 or rad/s^2]
    jerk : [mm/s^3 or rad/s^3]
    torque : inertia torque per unit of mass [N m/kg], or of the moment of inertia [N m/(kg m^2)].
    """

    velocity: Extremes
    acceleration: Extremes
    jerk: Extremes
    torque: Extremes


@dataclass(frozen=True, slots=True, eq=False)
class RowQuantities:
    """`Many` quantities that are rows of a single one: `rows` (k,) are their numbers."""

    rows: IntArray

    @property
    def count(self) -> int:
        """See `Many`."""
        return len(self.rows)

    def everywhere(self, quantity: Quantity, x: FloatArray, side: Side) -> FloatArray:
        """See `Many.everywhere`."""
        return quantity(x, side)[self.rows]

    def paired_values(
        self, quantity: Quantity, x: FloatArray, side: Side, which: IntArray
    ) -> FloatArray:
        """See `Many.paired_values`."""
        return np.asarray(quantity(x, side)[self.rows[which], np.arange(len(x))])


def time_extremes(motion: Motion, course: TimeCourse, unit: LiftUnit = "mm") -> TimeExtremes:
    """Physical extremes of `motion` with the cam turning as `course` says.

    Between neighbouring borders of both, velocity and acceleration turn where acceleration and
    jerk change sign: those places are isolated roots. Extremes of jerk and torque, whose slopes are
    not known, are searched on grids, see `camgeo.numeric.extremes`. At borders both one-sided
    values count.
    """
    edges = ascending(np.concatenate((motion.borders, course.borders, [0.0, TURN])))
    # Borders of motion and time course that differ by rounding only would leave a piece without
    # width.
    edges = edges[np.concatenate((np.diff(edges) > 8.0 * math.ulp(TURN), [True]))]

    def timed(phi: FloatArray, side: Side = "right") -> FloatArray:
        """(5, n) lift over time, and the torque."""
        rates = course.rates(phi, side)
        time_jet = _chained(motion.jet(phi, side), rates)
        return np.concatenate((time_jet, [inertia_torque(time_jet, rates[0], 1.0, unit)]))

    def row_values(phi: FloatArray, rows: IntArray) -> FloatArray:
        return np.asarray(timed(phi)[rows, np.arange(len(phi))])

    places = isolation_places(edges)
    # Jerk and acceleration are the slopes of acceleration and velocity, up to the factor omega.
    known = timed(places.ravel())[SMOOTH + 1].reshape(len(SMOOTH), *places.shape)
    roots, which = isolated_roots(
        lambda phi, row: row_values(phi, SMOOTH[row] + 1),
        lambda phi, row: row_values(phi, SMOOTH[row]),
        places,
        known,
    )
    right, left = timed(edges[:-1]), timed(edges[1:], "left")
    at_roots = row_values(roots, SMOOTH[which])
    velocity, acceleration = (
        sampled_extremes(
            np.concatenate((edges[:-1], edges[1:], roots[which == k])),
            np.concatenate((right[row], left[row], at_roots[which == k])),
        )
        for k, row in enumerate(SMOOTH)
    )
    jerk, torque = piecewise_extremes_of_many(RowQuantities(SHARP), timed, edges)
    return TimeExtremes(velocity, acceleration, jerk, torque)


def plan_extremes(plan: MotionPlan, course: TimeCourse, unit: LiftUnit = "mm") -> TimeExtremes:
    """The same as `time_extremes`, without a search if the cam turns at constant speed.

    With constant speed velocity, acceleration, jerk and torque have their extremes where s', s'',
    s''' and s' s'' have theirs (VDI 2143-1, section 5.1): at the turning points of the laws and at
    the borders, from either side. A motion by data needs the search.
    """
    by_data = any(isinstance(segment, SplineMove) for segment in plan.segments)
    if by_data or not isinstance(course, ConstantSpeed):
        return time_extremes(plan, course, unit)
    places = [plan.borders]
    for segment, start, end in plan.stretches:
        if isinstance(segment, Move):
            turns = np.concatenate([region.places[1:-1] for region in segment.law.regions])
            places.append(start + turns * (end - start))
    phi = ascending(np.concatenate(places))
    sides = [in_time(plan.jet(phi, side), course, phi) for side in ("right", "left")]
    timed = np.concatenate(sides, axis=1)
    torque = inertia_torque(timed, course.rates(np.tile(phi, 2))[0], unit=unit)

    def extremes(values: FloatArray) -> Extremes:
        return sampled_extremes(np.tile(phi, 2), values)

    return TimeExtremes(
        velocity=extremes(timed[1]),
        acceleration=extremes(timed[2]),
        jerk=extremes(timed[3]),
        torque=extremes(torque),
    )
