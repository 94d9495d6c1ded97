"""Effect `roller-spin`: how the roller turns, and the traction that keeps it rolling.

In the notation of `friction`, a roller that rolls on the flank s turns in the fixed frame at

    omega_R = (sigma - s sigma |Z'|/r_R) omega,

and relative to its pin at omega_R - chi' omega. With its moment of inertia J, the friction of its
bearing and of rolling, and the force T along t by which the cam turns it at the lever r_R, the
balance of moments about the pin is

    J d omega_R/dt = |N| (m_p + m_r) + s sigma r_R T.

It rolls while |T| is at most mu_T |N|, with the coefficient of traction mu_T. Where the roller of a
groove changes flanks, it must reverse its spin, and skids whatever the traction (Norton, Cam Design
and Manufacturing Handbook, on form-closed followers and roller slip; Newton's second law for
rotation). Each of the two rollers of a yoke keeps its sense of spin, but nothing drives it while
the other one carries. How far it skids is in `camgeo.dynamics.effects.roller_spin`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Final, NamedTuple, Self

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.contact import (
    INNER,
    OUTER,
    bearing_on_carrier,
    holds_both_ways,
    ranges_below,
    runs,
    with_other_side,
)
from camgeo.dynamics.effects.effect import Column, Request, Result, Subject, build_data
from camgeo.dynamics.effects.results import CONTACT_FORCE, ContactForce
from camgeo.dynamics.effects.wording import N_M, at_angles, extreme_findings, over_ranges, placed
from camgeo.dynamics.oscillator.steady import DEGREE, PiecewiseSeries, interpolated
from camgeo.kinematics.time_course import TimeCourse, period
from camgeo.numeric.arrays import SHARE, FloatArray, IntArray, Side, merged
from camgeo.numeric.extremes import (
    Extreme,
    bracketed_roots,
    indexed_roots,
    piecewise_extremes,
    piecewise_highest,
    piecewise_lowest,
    with_roots,
)
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import RPM, TURN


@dataclass(frozen=True, slots=True)
class RollerData:
    """The roller, from the table ``[effects.roller-spin]``.

    Attributes
    ----------
    moment_of_inertia : J of the turning parts about the pin [t mm^2].
    traction : largest ratio of tangential to normal force at the contact.
    """

    moment_of_inertia: float
    traction: float


@dataclass(frozen=True, slots=True, eq=False)
class RollerSpin(Result):
    """The spin of the roller.

    Attributes
    ----------
    rolling : the roller, as if it never skidded.
    skid : how it turns instead; None if it rolls all round, or nothing turns it.
    opposite : the same of the second roller of a yoke; None without one.
    """

    rolling: Rolling
    skid: Skid | None
    opposite: RollerSpin | None = None


def compute(request: Request[Mapping[str, Any]]) -> RollerSpin:
    """The spin at the speed of the scene, of both rollers of a yoke."""
    main, *others = (_roller_result(rolling) for rolling in Rolling.from_request(request))
    if not others:
        return main
    (other,) = others
    return replace(with_other_side(request.subject, main, other), opposite=other)


def _roller_result(rolling: Rolling) -> RollerSpin:
    """The spin of one roller."""
    edges = rolling.contact.edges
    lowest = piecewise_lowest(rolling.reserve, edges)
    # No traction reverses the spin of a roller at once.
    skids = bool(lowest.value < 0.0 or len(rolling.reversals))
    skid = steady(rolling) if skids else None

    def on_pin(phi: FloatArray, side: Side) -> FloatArray:
        return (rolling.spin(phi, side) if skid is None else skid.spin(phi, side))[1] / RPM

    def slip(phi: FloatArray, side: Side) -> FloatArray:
        return np.zeros(len(phi)) if skid is None else skid.slip(phi, side)

    inside = edges[(edges > 0.0) & (edges < TURN)]
    turning = inside if skid is None else merged(np.concatenate((inside, skid.borders)))
    return RollerSpin(
        findings=(
            *extreme_findings(
                "roller-spin",
                "speed of the roller on its pin",
                piecewise_extremes(on_pin, edges if skid is None else skid.edges),
                "rev/min",
                ", positive counter-clockwise",
            ),
            _reserve_finding(rolling, edges, lowest),
            *_drag_findings(rolling),
            *_reversal_findings(rolling.reversals),
            *(_undriven_findings() if skids and skid is None else _skid_findings(skid)),
        ),
        columns=(
            Column("roller spin", "rev/min", on_pin, borders=turning),
            Column("roller traction", "N", rolling.traction, borders=inside),
            Column("traction reserve", "N", rolling.reserve, 0.0, inside),
            Column("roller slip", "mm/s", slip, borders=turning),
        ),
        rolling=rolling,
        skid=skid,
    )


def _reserve_finding(rolling: Rolling, edges: FloatArray, lowest: Extreme) -> Finding:
    sentence = (
        f"smallest reserve of traction {lowest.value:.6g} N"
        f" {at_angles([lowest.place])}, with a coefficient of {rolling.data.traction:g}"
    )
    if lowest.value >= 0.0:
        return placed("traction-reserve", f"{sentence}: the roller rolls", lowest, "N", 0.0)
    ranges = ranges_below(rolling.reserve, edges, 0.0, lowest)
    where = over_ranges([(stretch.start, stretch.end) for stretch in ranges])
    return placed(
        "traction-reserve",
        f"{sentence}: too little for the roller to roll {where}",
        lowest,
        "N",
        0.0,
        "warning",
    )


def _drag_findings(rolling: Rolling) -> Iterator[Finding]:
    """A warning if friction of bearing and rolling exceeds the traction even at constant speed."""
    drag = float(np.sum(rolling.levers[1:])) / rolling.subject.cam.follower.roller_radius
    if drag <= rolling.data.traction:
        return
    yield Finding(
        "roller-drag",
        "warning",
        f"to keep rolling against the friction of its bearing and of rolling, the roller needs a"
        f" coefficient of traction of {drag:.4g}; it has {rolling.data.traction:g}",
        drag,
        rolling.data.traction,
    )


def _reversal_findings(places: FloatArray) -> Iterator[Finding]:
    if not len(places):
        return
    yield Finding(
        "roller-reversal",
        "warning",
        f"the roller changes flanks {at_angles(places.tolist())}, where it has to reverse its spin"
        " and skids",
        float(len(places)),
        0.0,
        cam_angle=float(places[0]),
    )


def _skid_findings(skid: Skid | None) -> Iterator[Finding]:
    """The findings on how far the roller skids; all values are 0 if it rolls all round."""
    if skid is None:
        yield Finding("largest-slip", "ok", "the roller does not slip", 0.0, unit="mm/s")
        yield Finding("slip-distance", "ok", "slip distance 0 mm per turn", 0.0, unit="mm")
        yield Finding("slip-work", "ok", "work of the slip 0 J per turn", 0.0, unit="J")
        return
    fastest = piecewise_highest(lambda phi, side: np.abs(skid.slip(phi, side)), skid.edges)
    text = f"the roller slips on its flank at up to {fastest.value:.6g} mm/s"
    yield placed("largest-slip", f"{text} {at_angles([fastest.place])}", fastest, "mm/s")
    distance, work, ranges = skid.distance, N_M * skid.work, skid.ranges
    where = f", {over_ranges(ranges)}" if ranges else ""
    text = f"slip distance {distance:.6g} mm per turn{where}"
    yield Finding("slip-distance", "ok", text, distance, unit="mm")
    text = f"work of the slip {work:.6g} J per turn; other effects assume that the roller rolls"
    yield Finding("slip-work", "ok", text, work, unit="J")


def _undriven_findings() -> Iterator[Finding]:
    yield Finding(
        "roller-undriven",
        "warning",
        "neither traction nor friction turns the roller, so its speed is not determined; the speed"
        " on its pin is that of a roller that rolls",
    )


# -- skid -----------------------------------------------------------------------------------------
# How far a roller skids.
#
# Three things rub on the roller, the flank, its pin and the cam that it rolls on, each with a
# moment of up to c_i |N| against its motion relative to v_i, the angular velocity at which the
# roller does not rub on it (`Rolling.rubbed`). With the angular velocity w of the roller in the
# fixed frame,
#
#     J dw/dt = -|N| sum c_i sgn(w - v_i),
#
# where sgn(0) is what keeps w = v_i as long as this is within -1 to 1: the flank, or the pin, holds
# the roller while
#
#     |U_i| <= c_i |N|,    U_i = -J dv_i/dt - |N| sum over the others of c_j sgn(v_i - v_j).
#
# Held by the flank it rolls. Otherwise U_i, the moment that is unmet, pulls it away (Coulomb's law;
# Newton's second law for rotation). While nothing holds the roller, w changes by the impulse of
# |N|, a function of the cam angle alone, times a constant: it is a quadrature. Between the cam
# angles at which |N| changes its formula, two v_i are equal or |U_i| = c_i |N|, a v_i that w
# reaches either holds it from there on or is passed for good, because the rate of w - v_i keeps its
# sign.
#
# The right side falls as w rises, so there is one motion from each start, and two of them come no
# farther apart (Filippov, Differential Equations with Discontinuous Righthand Sides, section 10).
# What a turn adds to w therefore falls as the w at its start rises, and is 0 in the steady state.


EXACT: Final = 1e-13
"""Share of the impulse of a turn that its series may leave out on a piece: their rounding."""

SETTLED: Final = 1e-10
"""A halving that changes an integral by less than this leaves an error of rounding: it divides that
of the rule by 2^32 where the function is smooth."""

AT_ONCE: Final = SHARE**2
"""A roller follows at once if it takes less than this share of the impulse of a turn: the time that
|N| needs for it, which rises from 0 where the flanks change, is its root."""

SHARED_TURNS: Final = 4
"""Turns after which the slowest and the fastest start are one motion, if something holds it."""

PAIRS: Final = ((0, 1), (0, 2), (1, 2))

FREE: Final = -1
"""Number of what holds a roller that nothing holds."""


class HoldingStretch(NamedTuple):
    """A stretch of a turn over which one thing holds the roller, or none.

    Attributes
    ----------
    low, high : its cam angles [rad].
    cell : its cell.
    holder : what holds the roller, or `FREE`.
    start, end : w [rad/s].
    gain : their difference, exact where it is small.
    pull : change of w per impulse of |N| [rad/(N s^2)], while it is free.
    """

    low: float
    high: float
    cell: int
    holder: int
    start: float
    end: float
    gain: float
    pull: float


@lru_cache(maxsize=1)
def rule() -> tuple[FloatArray, FloatArray]:
    """Places and weights of Gauss's rule over [-1, 1], exact for the series of a cell."""
    return np.polynomial.legendre.leggauss(DEGREE // 2 + 1)


@dataclass(frozen=True, eq=False)
class SpinCells:
    """A turn in cells, in each of which a v_i either holds a roller that reaches it or is passed.

    Attributes
    ----------
    rolling : the roller.
    rate : |N| / omega [N s/rad] as series over the cells.
    levers : (3,) c_i [mm].
    inertia : J [t mm^2]; 0 if the roller follows at once.
    start_speeds, end_speeds : (3, m) v_i where the cells start and end [rad/s].
    reserve : (3, m) c_i |N| - |U_i| [N mm] in the middle; v_i holds where it is not negative.
    unmet : (3, m) sign of U_i.
    fastest : magnitude of v_i [rad/s].
    """

    rolling: Rolling
    rate: PiecewiseSeries
    levers: FloatArray
    inertia: float
    start_speeds: FloatArray
    end_speeds: FloatArray
    reserve: FloatArray
    unmet: FloatArray
    fastest: float

    def impulse(self, cell: IntArray, low: FloatArray, span: FloatArray) -> FloatArray:
        """(k,) [N s] of |N| in each `cell` (k,) over a `span` (k,) [rad] from `low` (k,) on.

        By the rule that is exact for the series: a difference of its integrals would not be exact
        over short spans.
        """
        places, weights = rule()
        starts, ends = self.rate.edges[cell], self.rate.edges[cell + 1]
        # from -1 to 1 over the cell, by differences that are exact near its start
        first, share = 2.0 * (low - starts) / (ends - starts), span / (ends - starts)
        x = (first - 1.0)[:, np.newaxis] + share[:, np.newaxis] * (places + 1.0)
        means: FloatArray = self.rate.evaluate(cell[:, np.newaxis], x) @ weights
        return 0.5 * span * means

    @cached_property
    def whole(self) -> FloatArray:
        """(m,) [N s] of |N| over each cell."""
        edges = self.rate.edges
        return self.impulse(np.arange(len(edges) - 1), edges[:-1], np.diff(edges))

    def turn(self, w: float) -> list[HoldingStretch]:
        """The stretches of a turn that starts with `w` [rad/s] at cam angle 0."""
        stretches: list[HoldingStretch] = []
        for cell in range(self.start_speeds.shape[1]):
            stretches += self._through(cell, stretches[-1].end if stretches else w)
        return stretches

    def _through(self, cell: int, w: float) -> Iterator[HoldingStretch]:
        low, high = (float(edge) for edge in self.rate.edges[cell : cell + 2])
        signs, ahead = self._signs(cell, w), float(self.whole[cell])
        while low < high:
            if 0.0 in signs:
                holder = int(np.flatnonzero(signs == 0.0)[0])
                end = float(self.end_speeds[holder, cell])
                yield HoldingStretch(low, high, cell, holder, w, end, end - w, 0.0)
                return
            # Nothing holds it: all three rub, each against its own motion.
            pull = -float(self.levers @ signs) / self.inertia
            place, met = self._next(cell, low, w, pull, signs, w + pull * ahead)
            gain = pull * (ahead if met is None else self._impulse(cell, low, place - low))
            if place > low:
                yield HoldingStretch(low, place, cell, FREE, w, w + gain, gain, pull)
            low, w = place, w + gain
            if met is not None:
                # It is held from here on, or passes the speed and is pulled on.
                signs[met] = 0.0 if self.reserve[met, cell] >= 0.0 else self.unmet[met, cell]
                ahead = self._impulse(cell, low, high - low)

    def _impulse(self, cell: int, low: float, span: float) -> float:
        return float(self.impulse(*(np.array([value]) for value in (cell, low, span)))[0])

    def _signs(self, cell: int, w: float) -> FloatArray:
        """(3,) sgn(w - v_i) from the start of `cell` on; 0 for what holds the roller."""
        gaps, reserve = w - self.start_speeds[:, cell], self.reserve[:, cell]
        near = np.abs(gaps) <= SHARE * self.fastest
        signs = np.where(near, self.unmet[:, cell], np.sign(gaps))
        # Without inertia it takes the speed of what holds it best at once.
        if self.inertia == 0.0:
            signs[np.argmax(reserve)] = 0.0
        else:
            signs[np.flatnonzero(near & (reserve >= 0.0))[:1]] = 0.0
        return signs

    def _next(
        self, cell: int, low: float, w: float, pull: float, signs: FloatArray, end: float
    ) -> tuple[float, int | None]:
        """The angle at which w, which is free at `low` [rad] and would be `end` at the end of the
        cell, reaches a v_i, and which one; the end of the cell and None if it reaches none.
        """
        high = float(self.rate.edges[cell + 1])
        last = end - self.end_speeds[:, cell]
        met = np.sign(last) == -signs
        # A v_i counts if it holds the roller, or if the moment that is unmet pulls it through.
        met &= (self.reserve[:, cell] >= 0.0) | (self.unmet[:, cell] == -signs)
        which = np.flatnonzero(met)
        if not len(which):
            return high, None

        def gap(phi: FloatArray, row: IntArray) -> FloatArray:
            where, start = np.full(len(phi), cell), np.full(len(phi), low)
            reached = w + pull * self.impulse(where, start, phi - start)
            v = self.rolling.rubbed(phi, "right")[0]
            return np.asarray(reached - v[which[row], np.arange(len(phi))])

        every = np.arange(len(which))
        lows, highs = np.full(len(which), low), np.full(len(which), high)
        first = gap(lows, every)
        first[np.sign(first) != signs[which]] = 0.0  # at `low` but for rounding
        places = indexed_roots(gap, lows, highs, np.stack((first, last[which])))
        soonest = int(np.argmin(places))
        return float(places[soonest]), int(which[soonest])


def spin_cells(rolling: Rolling) -> SpinCells:
    """The cells of a turn."""
    edges, levers = rolling.contact.edges, rolling.levers
    ends = [rolling.rubbed(edges[:-1], "right")[0], rolling.rubbed(edges[1:], "left")[0]]
    fastest = float(np.max(np.abs(ends)))
    impulse = rolling.contact.extremes.magnitude * period(rolling.course)
    inertia = rolling.data.moment_of_inertia
    # So light a roller follows at once, as if without inertia.
    if inertia * fastest <= AT_ONCE * impulse * float(np.sum(levers)):
        inertia = 0.0

    def speed_differences(phi: FloatArray) -> FloatArray:
        v = rolling.rubbed(phi, "right")[0]
        return np.stack([v[one] - v[other] for one, other in PAIRS])

    def moments(phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """U_i and c_i |N| [N mm], (3, n) each."""
        pressing = rolling.pressing(phi, "right")
        v, rates = rolling.rubbed(phi, "right")
        # Sum over the others j of c_j sgn(v_i - v_j), at each of n angles.
        friction = np.einsum("j,ijn->in", levers, np.sign(v[:, np.newaxis] - v))
        return -inertia * rates - pressing * friction, levers[:, np.newaxis] * pressing

    def limits(phi: FloatArray) -> FloatArray:
        unmet, there = moments(phi)
        return np.concatenate((there - unmet, there + unmet))

    def rate(phi: FloatArray) -> FloatArray:
        return np.asarray(rolling.pressing(phi, "right") / rolling.course.rates(phi)[0])

    for crossing in (speed_differences, limits):
        edges = with_roots(crossing, edges)
    series = interpolated(rate, edges, EXACT)
    low, high = series.edges[:-1], series.edges[1:]
    unmet, there = moments(0.5 * (low + high))
    return SpinCells(
        rolling=rolling,
        rate=series,
        levers=levers,
        inertia=inertia,
        start_speeds=rolling.rubbed(low, "right")[0],
        end_speeds=rolling.rubbed(high, "left")[0],
        reserve=there - np.abs(unmet),
        unmet=np.sign(unmet),
        fastest=fastest,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Skid:
    """The steady motion of a roller that need not roll, over the m stretches of a turn.

    Attributes
    ----------
    cells : of the turn.
    edges : (m + 1,) cam angles [rad] from 0 to 2 pi between which w is smooth.
    cell, holder : (m,) of each stretch, see `HoldingStretch`.
    start, pull : (m,) [rad/s] and [rad/(N s^2)], likewise.
    """

    cells: SpinCells
    edges: FloatArray
    cell: IntArray
    holder: IntArray
    start: FloatArray
    pull: FloatArray

    @classmethod
    def from_start(cls, cells: SpinCells, w: float) -> Self:
        """The turn that starts with `w` [rad/s] at cam angle 0."""
        stretches = cells.turn(w)
        return cls(
            cells=cells,
            edges=np.array([*(stretch.low for stretch in stretches), TURN]),
            cell=np.array([stretch.cell for stretch in stretches]),
            holder=np.array([stretch.holder for stretch in stretches]),
            start=np.array([stretch.start for stretch in stretches]),
            pull=np.array([stretch.pull for stretch in stretches]),
        )

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """The ranges [rad] over which the roller does not roll."""
        groups = runs(self.holder != FLANK)
        return tuple(
            (float(self.edges[group[0]]), float(self.edges[group[-1] + 1])) for group in groups
        )

    @property
    def borders(self) -> FloatArray:
        """(k,) cam angles [rad] in [0, 2 pi) where what holds or pulls the roller changes."""
        same = (self.holder == np.roll(self.holder, 1)) & (self.pull == np.roll(self.pull, 1))
        return np.asarray(self.edges[:-1][~same])

    def spin(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2, n) w less that of rolling, and less that of the pin [rad/s]."""
        phi = in_turn(phi, side)
        which = np.searchsorted(self.edges, phi, side) - 1
        return self._spin(which, phi - self.edges[which], side)

    def _spin(self, which: IntArray, span: FloatArray, side: Side) -> FloatArray:
        """(2, n) the same by a `span` (n,) [rad] from the start of each of the stretches."""
        low, holder = self.edges[which], self.holder[which]
        v = self.cells.rolling.rubbed(low + span, side)[0]
        impulse = self.cells.impulse(self.cell[which], low, span)
        free = self.start[which] + self.pull[which] * impulse
        w = np.where(holder == FREE, free, v[holder, np.arange(len(span))])
        return np.asarray(w - v[[FLANK, PIN]])

    def slip(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) r_R (w - omega_R), of the roller on its flank [mm/s]."""
        return np.asarray(self._radius * self.spin(phi, side)[0])

    @property
    def _radius(self) -> float:
        return self.cells.rolling.subject.cam.follower.roller_radius

    @property
    def distance(self) -> float:
        """Path of the slip in a turn [mm]."""
        course = self.cells.rolling.course
        return self._slipped(lambda _cell, phi: np.asarray(1.0 / course.rates(phi)[0]))

    @property
    def work(self) -> float:
        """Work of the slip in a turn [N mm]."""
        rate = self.cells.rate

        def impulse(cell: IntArray, phi: FloatArray) -> FloatArray:
            low, high = rate.edges[cell], rate.edges[cell + 1]
            return rate.evaluate(cell, (2.0 * phi - low - high) / (high - low))

        return self.cells.rolling.data.traction * self._slipped(impulse)

    def _slipped(self, weight: Callable[[IntArray, FloatArray], FloatArray]) -> float:
        """The integral of the magnitude of the slip times a `weight` at cells (n,) and angles (n,).

        Each stretch counts as one, however short it is: a slip may last very shortly.
        """
        slips = np.flatnonzero(self.holder != FLANK)
        if not len(slips):
            return 0.0
        spans = np.diff(self.edges)[slips]

        def stretched(x: FloatArray) -> FloatArray:
            # Stretch k is mapped to the interval from k to k + 1.
            number = np.floor(x).astype(np.intp)
            which, span = slips[number], (x - number) * spans[number]
            slip = self._radius * np.abs(self._spin(which, span, "right")[0])
            there = weight(self.cell[which], self.edges[which] + span)
            return np.asarray(spans[number] * slip * there)

        return piecewise_integral(stretched, np.arange(len(slips) + 1.0), SETTLED).value


def steady(rolling: Rolling) -> Skid | None:
    """The steady motion; None if nothing turns the roller.

    The motions that begin slower and faster than any steady one enclose it; mostly something holds
    both alike before long, and they are one from there on.
    """
    cells = spin_cells(rolling)
    # Slower and faster than all that rubs on it: any steady motion is between these.
    low, high = -2.0 * cells.fastest, 2.0 * cells.fastest
    if all(stretch.gain == 0.0 for stretch in cells.turn(low)):
        return None
    for _ in range(SHARED_TURNS):
        low, high = (cells.turn(start)[-1].end for start in (low, high))
        if low == high:
            return Skid.from_start(cells, low)

    def gained(starts: FloatArray) -> FloatArray:
        return np.array(
            [math.fsum(stretch.gain for stretch in cells.turn(float(start))) for start in starts]
        )

    first, last = gained(np.array([low, high]))  # of equal sign where either is 0 but for rounding
    ends = np.array([[max(first, 0.0)], [min(last, 0.0)]])
    root = bracketed_roots(gained, np.array([low]), np.array([high]), ends=ends)
    return Skid.from_start(cells, float(root[0]))


# -- rolling --------------------------------------------------------------------------------------
# A roller that rolls on the flank that carries, and the moments that act on it.


FLANK, PIN, CAM = 0, 1, 2
"""What rubs on the roller: its flank by traction, its pin, and the cam by rolling friction."""


def in_turn(phi: FloatArray, side: Side) -> FloatArray:
    """(n,) cam angles `phi` (n,) [rad] of any turn from 0 to 2 pi, which is 0 from the left."""
    phi = np.mod(phi, TURN)
    return np.where(phi == 0.0, TURN, phi) if side == "left" else phi


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """The rolling roller.

    Attributes
    ----------
    subject : the design.
    course : how the cam turns.
    contact : force at the contact.
    data : of the roller.
    senses : (k,) s, the flank that carries, or the only one, between the edges of `contact`.
    yoke_side : side of a yoke, see `camgeo.dynamics.effects.contact`, that presses this roller; 0
    without one.
    """

    subject: Subject
    course: TimeCourse
    contact: ContactForce
    data: RollerData
    senses: FloatArray
    yoke_side: int = 0

    @classmethod
    def from_request(cls, request: Request[Mapping[str, Any]]) -> tuple[Self, ...]:
        """The roller of a scene, or both of a yoke, each on the inner flank as it touches it."""
        subject, contact = request.subject, request.results[CONTACT_FORCE]
        data, pieces = build_data(RollerData, request.data), len(contact.edges) - 1
        if subject.returning is not None:
            senses = np.full(pieces, float(INNER))
            return tuple(
                cls(touched, request.course, contact, data, senses, alone)
                for touched, alone in ((subject, INNER), (subject.returning, OUTER))
            )
        senses = np.full(pieces, float(subject.cam.contact.push))
        if holds_both_ways(subject):
            middle = 0.5 * (contact.edges[:-1] + contact.edges[1:])
            inner = contact.normal(middle, "right") >= 0.0
            senses = np.where(inner, float(INNER), float(OUTER))
        return (cls(subject, request.course, contact, data, senses),)

    @property
    def reversals(self) -> FloatArray:
        """(n,) cam angles [rad] at which the roller changes flanks."""
        return np.asarray(self.contact.edges[:-1][self.senses != np.roll(self.senses, 1)])

    def sense(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) s."""
        piece = np.searchsorted(self.contact.edges, in_turn(phi, side), side) - 1
        return np.asarray(self.senses[piece])

    def pressing(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) |N| [N]; 0 where the only flank would have to pull, or the other side of a yoke
        carries.
        """
        normal = self.contact.normal(phi, side)
        if self.yoke_side:
            return np.maximum(self.yoke_side * normal, 0.0)
        if holds_both_ways(self.subject):
            return np.abs(normal)
        return np.maximum(self.subject.cam.contact.push * normal, 0.0)

    def spin(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray, FloatArray]:
        """omega_R and that relative to the pin [rad/s], and d omega_R/dt [rad/s^2], (n,) each."""
        subject = self.subject
        relative = subject.state.curve.relative_jet(phi, side, order=2)
        first, second = (relative.along[k] + 1j * relative.across[k] for k in (1, 2))
        pace = np.abs(first)
        gain = np.real(np.conj(first) * second) / pace
        sigma = subject.cam.rotation
        share = self.sense(phi, side) * sigma / subject.cam.follower.roller_radius
        omega, alpha = self.course.rates(phi, side)[:2]
        rate = sigma - share * pace
        return (
            np.asarray(rate * omega),
            np.asarray((rate - relative.turning) * omega),
            np.asarray(rate * alpha - share * gain * omega**2),
        )

    def traction(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) T [N]."""
        sense, radius = self.sense(phi, side), self.subject.cam.follower.roller_radius
        lever = sense * self.subject.cam.rotation / radius
        needed = lever * self.data.moment_of_inertia * self.spin(phi, side)[2]
        return np.asarray(needed + self._shared(phi, side) * self.pressing(phi, side))

    def _shared(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) f_t, see `camgeo.dynamics.effects.friction`."""
        friction = self.contact.friction
        if not self.yoke_side or friction is None:
            return bearing_on_carrier(self.contact, phi, side).tangential
        return friction.bearing(phi, side, self.yoke_side).tangential

    def reserve(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) mu_T |N| - |T| [N]."""
        there = self.data.traction * self.pressing(phi, side)
        return np.asarray(there - np.abs(self.traction(phi, side)))

    @property
    def levers(self) -> FloatArray:
        """(3,) largest moments per unit of |N| [mm] of flank, pin and cam."""
        friction = self.contact.friction
        pin, rolling = (0.0, 0.0) if friction is None else friction.on_roller
        radius = self.subject.cam.follower.roller_radius
        return np.array([self.data.traction * radius, pin, rolling])

    def rubbed(self, phi: FloatArray, side: Side) -> tuple[FloatArray, FloatArray]:
        """(3, n) angular velocities at which flank, pin and cam do not rub on the roller [rad/s],
        omega_R, chi' omega and sigma omega, and (3, n) their rates in time [rad/s^2].
        """
        sigma, swing = self.subject.cam.rotation, self.subject.cam.follower.swing_sense
        omega, alpha = self.course.rates(phi, side)[:2]
        turned, _, rate = self.spin(phi, side)
        velocity, acceleration = self.subject.state.motion.jet(phi, side, 2)[1:3]
        swung = swing * (acceleration * omega**2 + velocity * alpha)
        return (
            np.stack((turned, swing * velocity * omega, sigma * omega)),
            np.stack((rate, swung, sigma * alpha)),
        )
