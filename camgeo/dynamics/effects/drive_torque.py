"""Drive torque: the torque on the camshaft that moves the follower against its forces.

T dphi is the work of the contact force on the follower and of the friction at the contact
(principle of virtual work; Norton, Cam Design and Manufacturing Handbook, chapters on dynamics of
force- and form-closed systems). T is positive where the cam must be driven in its own sense of
rotation, negative where the follower drives the cam.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.dynamics.effects.bearing_friction import (
    LINEAR,
    BearingFriction,
    RubbingLaw,
    add_force,
    linear_law,
)
from camgeo.dynamics.effects.contact import INNER, OUTER, carrier, contact_leverage
from camgeo.dynamics.effects.effect import Bound, Column, Quantity, Request, Subject, build_data
from camgeo.dynamics.effects.forces import (
    all_borders,
    at_rates,
    cam_rates,
    smooth_edges,
    torque_shocks,
)
from camgeo.dynamics.effects.results import CONTACT_FORCE, ContactForce, DriveTorque
from camgeo.dynamics.effects.wording import (
    KG_M2,
    N_M,
    at_angle,
    degrees,
    placed,
    resolved_ends,
    tolerance_error,
)
from camgeo.errors import EffectError, GeometryError
from camgeo.kinematics.time_course import period
from camgeo.numeric.arrays import SHARE, FloatArray, Side, resolved
from camgeo.numeric.extremes import (
    Extreme,
    Extremes,
    piecewise_extremes,
    sampled_extremes,
    with_roots,
)
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import RPM, TURN, counted


@dataclass(frozen=True, slots=True)
class TorqueLimits:
    """Limits of torque and speed fluctuation.

    Attributes
    ----------
    limit : largest torque allowed [N mm]; None for no limit.
    fluctuation : allowed speed fluctuation, to size a flywheel; None to size none.
    """

    limit: float | None = None
    fluctuation: float | None = None


def compute(request: Request[Mapping[str, Any]]) -> DriveTorque:
    """Torque, its integrals over a turn to the tolerance, and the flywheel if requested.

    Raises
    ------
    GeometryError
        If a flywheel is requested and the scene gives no speed.
    EffectError
        "jamming", if friction prevents the contact force from driving the follower; and if the
        tolerance cannot be reached.
    """
    subject, data = request.subject, build_data(TorqueLimits, request.data)
    course = subject.state.course
    if data.fluctuation is not None and course is None:
        raise GeometryError(
            "a flywheel needs the speed of the cam, [cam] speed or speed_curve",
            key="effects.drive-torque.fluctuation",
        )
    contact = request.results[CONTACT_FORCE]
    law = TorqueLaw(subject, contact)
    totals = summarise(law, data.fluctuation, request.tolerance)
    return DriveTorque(
        findings=torque_findings(law, totals, data),
        columns=_columns(law, data.limit),
        errors=figure_errors(totals, data),
        contact=contact,
        law=law.coefficients,
        torque_at_rates=law.torque_at_rates,
        torque=law.torque,
        static=law.static,
        edges=contact.edges,
    )


def figure_errors(summary: Summary, data: TorqueLimits) -> dict[str, Bound]:
    """The errors of the integrals; peaks and columns are exact."""
    scale = N_M * summary.peaks.magnitude
    mean = Bound(N_M * summary.mean_error, scale)
    errors = {
        "mean-torque": mean,
        "work-per-turn": mean.times(TURN),
        "mean-power": mean.times(summary.speed),
        "rms-torque": Bound(N_M * summary.rms_error, scale),
    }
    if summary.stored is not None and data.fluctuation is not None:
        energy = Bound(N_M * summary.stored.error, TURN * scale)
        errors["energy-fluctuation"] = energy
        errors["flywheel"] = energy.times(
            moment_of_inertia(1.0, data.fluctuation, summary.speed) * KG_M2 / N_M
        )
    return errors


def _columns(law: TorqueLaw, limit: float | None) -> tuple[Column, ...]:
    borders = all_borders(law.contact.forces)
    most = None if limit is None else N_M * limit

    def column(name: str, values: Quantity, limit: float | None = None) -> Column:
        return Column(name, "N m", lambda phi, side: N_M * values(phi, side), limit, borders)

    total = column("drive torque", law.torque, most)
    if law.subject.state.course is None:
        return (total,)
    return (
        total,
        column("static drive torque", law.static),
        column("dynamic drive torque", law.dynamic),
    )


def torque_findings(law: TorqueLaw, summary: Summary, data: TorqueLimits) -> tuple[Finding, ...]:
    """The findings on the peaks, the integrals, the flywheel and the shocks of the torque."""
    turning = law.subject.state.course is not None
    peaks = resolved_ends(summary.peaks)
    static = resolved_ends(summary.static_peaks, peaks.magnitude)
    report = [
        _peak("largest-torque", "largest drive torque", peaks.highest, data.limit, 1.0),
        _peak("smallest-torque", "smallest drive torque", peaks.lowest, data.limit, -1.0),
    ]
    if turning:
        report += [
            _peak("largest-static-torque", "largest static drive torque", static.highest),
            _peak("smallest-static-torque", "smallest static drive torque", static.lowest),
        ]
    report += [
        _value("rms-torque", "root mean square of the drive torque", N_M * summary.rms, "N m"),
        _value("mean-torque", "mean drive torque", N_M * summary.mean, "N m"),
        _value("work-per-turn", "work of the drive over a turn", N_M * TURN * summary.mean, "J"),
    ]
    if turning:
        power = N_M * summary.mean * summary.speed
        report.append(_value("mean-power", "mean power of the drive", power, "W"))
    report += _flywheel(summary, data.fluctuation)
    if turning:
        report += _shock(law)
    return tuple(report)


def _value(name: str, words: str, value: float, unit: str) -> Finding:
    return Finding(name, "ok", f"{words} {value:.5g} {unit}", value, unit=unit)


def _peak(
    name: str, words: str, peak: Extreme, limit: float | None = None, sense: float = 1.0
) -> Finding:
    """A peak checked against the limit, which applies in both directions: -limit for the
    smallest.
    """
    value, bound = N_M * peak.value, None if limit is None else sense * N_M * limit
    severity: Severity = "ok"
    verdict = ""
    if bound is not None:
        broken = sense * value > sense * bound
        severity = "broken" if broken else "ok"
        verdict = f", {'beyond' if broken else 'within'} {bound:g} N m"
    sentence = f"{words} {value:.5g} N m {at_angle(peak.place)}{verdict}"
    return placed(name, sentence, Extreme(value, peak.place), "N m", bound, severity)


def _flywheel(summary: Summary, fluctuation: float | None) -> list[Finding]:
    stored = summary.stored
    if stored is None or fluctuation is None:
        return []
    low, high = stored.extremes.lowest, stored.extremes.highest
    span = stored.span if stored.span > stored.error else 0.0
    moment = KG_M2 * moment_of_inertia(span, fluctuation, summary.speed)
    return [
        Finding(
            "energy-fluctuation",
            "ok",
            f"a drive of constant torque stores {N_M * span:.5g} J in everything that turns"
            f" with the cam, between cam angles {degrees(low.place)} (slowest) and"
            f" {degrees(high.place)} (fastest)",
            N_M * span,
            unit="J",
        ),
        Finding(
            "flywheel",
            "ok",
            f"for a speed fluctuation of {fluctuation:g} at {summary.speed / RPM:.5g} rev/min,"
            f" everything that turns with the cam needs a moment of inertia of {moment:.5g} kg m^2",
            moment,
            unit="kg m^2",
        ),
    ]


def _shock(law: TorqueLaw) -> list[Finding]:
    """A finding on the jumps of the velocity of a mass; none without masses."""
    contact = law.contact
    if contact.struck is None:
        return []
    places = torque_shocks(law.subject, contact.struck, contact.edges)
    if not len(places):
        return []
    first = float(places[0])
    return [
        Finding(
            "shock",
            "broken",
            f"the velocity jumps at {counted(len(places), 'cam angle')}, first at"
            f" {degrees(first)}: the torque is infinite there, and its impulses are not included in"
            " any value",
            cam_angle=first,
        )
    ]


# -- law -----------------------------------------------------------------------------------------
# The torque on the camshaft as a function of speed and acceleration of the cam.
#
# At a given cam angle the contact must provide the generalised force R = c0 + c1 omega + c2
# omega^2 + c3 alpha on the follower's coordinate q. By virtual work this takes the torque R q' on
# the camshaft if there is no friction. With friction, the normal force N on a flank (sense = +1
# for the inner one, -1 for the outer one) provides the force |N| (sense * leverage + f) and takes
# the torque |N| (sense * leverage * q' + m), where f and m are the contributions of friction per
# unit of |N|. So
#
#     T = R (sense * leverage * q' + m) / (sense * leverage + f),
#
# and the flank that carries follows from the sign of R. T is a linear function of R on either side
# of R = 0, and continuous there. Friction in pivot or guide, which their whole load has a part in,
# is no part of f then: |N| is the root of `camgeo.dynamics.effects.bearing_friction`.


@dataclass(frozen=True, slots=True, eq=False)
class TorqueLaw:
    """The torque as a function of cam angle, speed and acceleration.

    Attributes
    ----------
    subject : the design.
    contact : the contact force, and the forces that it balances.
    """

    subject: Subject
    contact: ContactForce

    def coefficients(self, phi: FloatArray, side: Side) -> FloatArray:
        """(6, n) c0 to c3 of R, then T / R [N mm per unit of R] for R > 0 and for R < 0.

        T / R is nan where the follower would jam with an R of this sign. With friction in pivot or
        guide it is the rows of a `RubbingLaw`.
        """
        if self.contact.bearings is not None:
            return self._rubbing(self.contact.bearings, phi, side).rows
        rows = np.empty((LINEAR, len(phi)))
        rows[:4] = self.contact.required(phi, side)
        velocity = self.subject.state.motion.jet(phi, side, 1)[1]
        friction = self.contact.friction
        if friction is None:
            rows[4:] = velocity
            return rows
        levers = {
            sense: contact_leverage(self.subject, phi, side, sense) for sense in (INNER, OUTER)
        }
        gains = {
            sense: _gain(lever, velocity, friction.per_normal(phi, side, sense))
            for sense, lever in levers.items()
        }
        outwards = levers[INNER] >= 0.0
        # R > 0 is carried by the inner flank where its leverage is above 0, else by the other one.
        rows[4] = np.where(outwards, gains[1], gains[-1])
        rows[5] = np.where(outwards, gains[-1], gains[1])
        return rows

    def _rubbing(self, bearings: BearingFriction, phi: FloatArray, side: Side) -> RubbingLaw:
        """The law with friction in the bearings."""
        velocity = self.subject.state.motion.jet(phi, side, 1)[1]
        drag, friction = bearings.drag(phi, side), self.contact.friction
        assert friction is not None  # that of the bearings is part of it
        sides = {}
        for sense in (INNER, OUTER):
            lever = contact_leverage(self.subject, phi, side, sense)
            loads = bearings.rubbing.per_normal(phi, side, sense)
            force, torque = friction.per_normal(phi, side, sense)
            # per_normal includes the friction of the contact's load alone; b is without it, because
            # the loads include it.
            free = lever + force + drag * np.sum(np.abs(loads), axis=0)
            sides[sense] = (lever * velocity + torque, free, loads)
        outwards = contact_leverage(self.subject, phi, side, INNER) >= 0.0
        torque, free, per = (
            np.stack((np.where(outwards, inner, outer), np.where(outwards, outer, inner)))
            for inner, outer in zip(sides[INNER], sides[OUTER], strict=True)
        )
        return RubbingLaw(
            self.contact.required(phi, side),
            torque,
            free,
            drag,
            bearings.noncontact_loads(phi, side),
            per,
        )

    def torque_at_rates(
        self, phi: FloatArray, side: Side, omega: FloatArray | float, alpha: FloatArray | float
    ) -> FloatArray:
        """(n,) torque [N mm] at `phi` with the cam turning at omega [rad/s] and alpha [rad/s^2], of
        a rigid train.

        Raises
        ------
        EffectError
            "jamming", if friction prevents any contact force from driving the follower.
        """
        shape = np.zeros(phi.shape)
        rates = np.stack((omega + shape, alpha + shape))
        return self._torque_by_law(rates, self.coefficients(phi, side), phi)

    def _torque_by_law(self, rates: FloatArray, rows: FloatArray, phi: FloatArray) -> FloatArray:
        """(n,) torque [N mm] at `rates` (2, n) by the law `rows`, see `coefficients`."""
        law = linear_law(rows, rates[0], rates[1])
        return self._torque_for_force(at_rates(law[:4], rates), law, phi)

    def _torque_for_force(self, force: FloatArray, law: FloatArray, phi: FloatArray) -> FloatArray:
        """(n,) torque [N mm] where the contact provides R = `force` (n,)."""
        gain = np.where(force >= 0.0, law[4], law[5])
        # Where nothing is demanded a gain of nan is no jamming.
        torque: FloatArray = np.where(force == 0.0, 0.0, force * gain)
        jammed = np.isnan(torque)
        if np.any(jammed):
            self._refuse(phi[jammed][:1])
        return torque

    def _refuse(self, here: FloatArray) -> NoReturn:
        """Raise EffectError that the follower jams at the cam angle `here` (1,) [rad]."""
        curves = [carrier(self.subject, sense)[0].state.curve for sense in (INNER, OUTER)]
        angle = math.degrees(min(curve.transmission_angle(here)[0] for curve in curves))
        place = float(here[0]) % TURN
        raise EffectError(
            f"the follower jams {at_angle(place)}: at a transmission angle of {angle:.4f} deg"
            " friction absorbs the entire contact force",
            finding="jamming",
            value=angle,
            unit="deg",
            cam_angle=place,
        )

    def torque(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] at the speed of the scene; the static part if it gives none."""
        rows, contact = self.coefficients(phi, side), self.contact
        if contact.bearings is None:
            return self._torque_for_force(contact.demand(phi, side), rows, phi)
        for force in contact.forces:
            if force.present:
                rows = add_force(rows, contact.bearings, force, phi, side)
        return self._torque_by_law(cam_rates(self.subject, phi, side), rows, phi)

    def static(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] at very low speed: without inertia and viscous friction."""
        return self.torque_at_rates(phi, side, 0.0, 0.0)

    def dynamic(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] the part that the speed adds to the static part."""
        return self.torque(phi, side) - self.static(phi, side)

    def static_edges(self) -> FloatArray:
        """(k,) cam angles [rad] where the formula of the static part changes.

        With friction these include the angles at which its R changes sign, or a force at an end of
        a guide.
        """
        base = smooth_edges(self.subject.state.smooth_angles, self.contact.lasting)
        if self.contact.friction is None:
            return base

        def released(phi: FloatArray) -> FloatArray:
            return self.contact.released(phi, "right", np.zeros((2, len(phi))))

        edges = with_roots(released, base)
        if self.contact.bearings is None or self.subject.cam.follower.pivot is not None:
            return edges

        def loads(phi: FloatArray) -> FloatArray:
            law = RubbingLaw.from_rows(self.coefficients(phi, "right"))
            return np.asarray(law.loads(0.0, 0.0).real)

        return with_roots(loads, edges)


def _gain(lever: FloatArray, velocity: FloatArray, per_normal: FloatArray) -> FloatArray:
    """(n,) T / R, with `lever` = sense * leverage; nan where the follower jams."""
    force = lever + per_normal[0]
    # With friction the contact must still push along its leverage; in a dwell nothing has to move.
    jams = (force == 0.0) | ((force * lever <= 0.0) & (velocity != 0.0))
    torque = lever * velocity + per_normal[1]
    return np.where(jams, np.nan, torque / np.where(jams, 1.0, force))


# -- summary --------------------------------------------------------------------------------------
# Values of a torque over a turn: extremes, mean, root mean square, work, and the flywheel.
#
# A drive with the constant torque T_m, equal to the mean, stores E(phi), the integral of T_m - T,
# in everything that turns with the cam. E has its extremes where T passes T_m. With the mean speed
# omega and the allowed fluctuation delta, the difference of largest and smallest speed divided by
# the mean, this needs the moment of inertia
#
#     J = (E_max - E_min) / (delta omega^2)
#
# (Norton, Design of Machinery, chapter on dynamic force analysis, section on controlling the input
# torque by flywheels; Khurmi and Gupta, Theory of Machines, chapter 16 on turning moment diagrams).


@dataclass(frozen=True, slots=True)
class StoredEnergy:
    """E over a turn, 0 at cam angle 0.

    Attributes
    ----------
    extremes : smallest and largest E [N mm], with their cam angles [rad].
    error : estimate of the error of `span` [N mm].
    """

    extremes: Extremes
    error: float

    @property
    def span(self) -> float:
        """E_max - E_min [N mm]."""
        return self.extremes.highest.value - self.extremes.lowest.value


@dataclass(frozen=True, slots=True)
class Summary:
    """Values of a turn; torques in N mm.

    Attributes
    ----------
    peaks, static_peaks : smallest and largest value of the torque and of its static part.
    mean : over the cam angle: the work of a turn [N mm] divided by 2 pi.
    rms : root mean square over time.
    speed : mean speed over time [rad/s]; 0 if the scene gives none.
    stored : energy in the flywheel; None if none is requested.
    mean_error, rms_error : estimates of the errors of `mean` and `rms` [N mm].
    """

    peaks: Extremes
    static_peaks: Extremes
    mean: float
    rms: float
    speed: float
    stored: StoredEnergy | None
    mean_error: float
    rms_error: float

    @property
    def error(self) -> float:
        """The largest error, relative to the largest torque; that of the energy divided by 2 pi."""
        largest = self.peaks.magnitude
        stored = 0.0 if self.stored is None else self.stored.error / TURN
        worst = max(self.mean_error, self.rms_error, stored)
        return worst / largest if largest > 0.0 else 0.0


def summarise(law: TorqueLaw, fluctuation: float | None, tolerance: float) -> Summary:
    """The values of the torque in `law`, with integrals to `tolerance`.

    The mean square over time is the integral of T^2 dt over the turn divided by its duration, with
    dt = dphi / omega; at constant speed, or without a speed, it is the mean over the cam angle.

    Raises
    ------
    EffectError
        If the tolerance cannot be reached.
    """
    edges, course = law.contact.edges, law.subject.state.course

    def values(phi: FloatArray) -> FloatArray:
        return law.torque(phi, "right")

    def squares(phi: FloatArray) -> FloatArray:
        slowness = 1.0 if course is None else 1.0 / course.rates(phi)[0]
        return np.asarray(values(phi) ** 2 * slowness)

    duration = TURN if course is None else period(course)
    peaks = piecewise_extremes(law.torque, edges)
    static_peaks = piecewise_extremes(law.static, law.static_edges())
    work = piecewise_integral(values, edges, tolerance)
    mean = resolved(work.value, work.magnitude) / TURN  # conservative forces do no work
    square = piecewise_integral(squares, edges, tolerance)
    mean_square, unsure = max(square.value, 0.0) / duration, square.error / duration
    rms = math.sqrt(mean_square)
    # The lower end is the farther one, as a root is steeper there.
    rms_error = rms - math.sqrt(max(mean_square - unsure, 0.0))
    stored = None
    if fluctuation is not None:
        stored = stored_energy(values, mean, work.error / TURN, edges, tolerance)
    speed = 0.0 if course is None else TURN / duration
    totals = Summary(peaks, static_peaks, mean, rms, speed, stored, work.error / TURN, rms_error)
    if totals.error > max(tolerance, SHARE):
        raise tolerance_error(
            "an integral of the drive torque", totals.error, "the largest torque", tolerance
        )
    return totals


def stored_energy(
    torque: Callable[[FloatArray], FloatArray],
    mean: float,
    unsure: float,
    edges: FloatArray,
    tolerance: float,
) -> StoredEnergy:
    """The energy stored if the drive provides the mean torque.

    Parameters
    ----------
    torque : (n,) cam angles [rad] -> (n,) [N mm], smooth between neighbouring edges.
    mean, unsure : mean of the torque over the turn, and its error [N mm].
    edges : (m + 1,) [rad] from 0 to 2 pi, ascending.
    tolerance : of the integrals, relative to the integral of the magnitude.
    """

    def surplus(phi: FloatArray) -> FloatArray:
        return mean - torque(phi)

    places = with_roots(surplus, edges)
    stored = piecewise_integral(surplus, places, tolerance)
    # E has its extremes where T passes T_m, and nowhere in between.
    energy = np.concatenate(([0.0], np.cumsum(stored.parts)))
    return StoredEnergy(sampled_extremes(places, energy), stored.error + TURN * unsure)


def moment_of_inertia(energy: float, fluctuation: float, speed: float) -> float:
    """J [t mm^2] for the span of energy [N mm], delta, and the mean speed [rad/s]."""
    return energy / (fluctuation * speed * speed)
