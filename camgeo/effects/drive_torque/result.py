"""Drive torque: the torque on the camshaft that moves the follower against its forces.

T dphi is the work of the contact force on the follower and of the friction at the contact
(principle of virtual work; Norton, Cam Design and Manufacturing Handbook, chapters on dynamics of
force- and form-closed systems). T is positive where the cam must be driven in its own sense of
rotation, negative where the follower drives the cam.
"""

from __future__ import annotations

from camgeo.check.finding import Finding, Severity
from camgeo.effects.drive_torque import TorqueLimits
from camgeo.effects.drive_torque.law import TorqueLaw
from camgeo.effects.drive_torque.summary import Summary, moment_of_inertia, summary
from camgeo.effects.effect import Bound, Column, Quantity, Request
from camgeo.effects.force import all_borders
from camgeo.effects.immovable import torque_shocks
from camgeo.effects.results import CONTACT_FORCE, DriveTorque
from camgeo.effects.wording import KG_M2, N_M, at, degrees, placed, resolved_ends
from camgeo.errors import GeometryError
from camgeo.numeric.extremes import Extreme
from camgeo.units import RPM, TURN
from camgeo.wording import counted


def compute(request: Request[TorqueLimits]) -> DriveTorque:
    """Torque, its integrals over a turn to the tolerance, and the flywheel if requested.

    Raises
    ------
    GeometryError
        If a flywheel is requested and the scene gives no speed.
    EffectError
        "jamming", if friction prevents the contact force from driving the follower; and if the
        tolerance cannot be reached.
    """
    subject, data = request.subject, request.data
    course = subject.state.course
    if data.fluctuation is not None and course is None:
        raise GeometryError(
            "a flywheel needs the speed of the cam, [cam] speed or speed_curve",
            key="effects.drive-torque.fluctuation",
        )
    contact = request.results[CONTACT_FORCE]
    law = TorqueLaw(subject, contact)
    found = summary(law, data.fluctuation, request.tolerance)
    return DriveTorque(
        findings=findings(law, found, data),
        columns=_columns(law, data.limit),
        errors=errors_of(found, data),
        contact=contact,
        law=law.coefficients,
        at=law.at,
        torque=law.torque,
        static=law.static,
        edges=contact.edges,
    )


def errors_of(found: Summary, data: TorqueLimits) -> dict[str, Bound]:
    """The errors of the integrals; peaks and columns are exact."""
    scale = N_M * found.peaks.magnitude
    mean = Bound(N_M * found.mean_error, scale)
    out = {
        "mean-torque": mean,
        "work-per-turn": mean.times(TURN),
        "mean-power": mean.times(found.speed),
        "rms-torque": Bound(N_M * found.rms_error, scale),
    }
    if found.stored is not None and data.fluctuation is not None:
        energy = Bound(N_M * found.stored.error, TURN * scale)
        out["energy-fluctuation"] = energy
        out["flywheel"] = energy.times(
            moment_of_inertia(1.0, data.fluctuation, found.speed) * KG_M2 / N_M
        )
    return out


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


def findings(law: TorqueLaw, found: Summary, data: TorqueLimits) -> tuple[Finding, ...]:
    """All findings."""
    turning = law.subject.state.course is not None
    peaks = resolved_ends(found.peaks)
    static = resolved_ends(found.static_peaks, peaks.magnitude)
    out = [
        _peak("largest-torque", "largest drive torque", peaks.highest, data.limit, 1.0),
        _peak("smallest-torque", "smallest drive torque", peaks.lowest, data.limit, -1.0),
    ]
    if turning:
        out += [
            _peak("largest-static-torque", "largest static drive torque", static.highest),
            _peak("smallest-static-torque", "smallest static drive torque", static.lowest),
        ]
    out += [
        _value("rms-torque", "root mean square of the drive torque", N_M * found.rms, "N m"),
        _value("mean-torque", "mean drive torque", N_M * found.mean, "N m"),
        _value("work-per-turn", "work of the drive over a turn", N_M * TURN * found.mean, "J"),
    ]
    if turning:
        power = N_M * found.mean * found.speed
        out.append(_value("mean-power", "mean power of the drive", power, "W"))
    out += _flywheel(found, data.fluctuation)
    if turning:
        out += _shock(law)
    return tuple(out)


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
    sentence = f"{words} {value:.5g} N m {at(peak.place)}{verdict}"
    return placed(name, sentence, Extreme(value, peak.place), "N m", bound, severity)


def _flywheel(found: Summary, fluctuation: float | None) -> list[Finding]:
    stored = found.stored
    if stored is None or fluctuation is None:
        return []
    low, high = stored.extremes.lowest, stored.extremes.highest
    span = stored.span if stored.span > stored.error else 0.0
    moment = KG_M2 * moment_of_inertia(span, fluctuation, found.speed)
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
            f"for a speed fluctuation of {fluctuation:g} at {found.speed / RPM:.5g} rev/min,"
            f" everything that turns with the cam needs a moment of inertia of {moment:.5g} kg m^2",
            moment,
            unit="kg m^2",
        ),
    ]


def _shock(law: TorqueLaw) -> list[Finding]:
    """Where the velocity of a mass jumps; no finding without a mass."""
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
