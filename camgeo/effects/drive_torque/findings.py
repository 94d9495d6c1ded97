"""What the drive torque has to say."""

from __future__ import annotations

from typing import Final

from camgeo.check.finding import Finding, Severity
from camgeo.effects.drive_torque.flywheel import moment_of_inertia
from camgeo.effects.drive_torque.summary import Summary
from camgeo.effects.drive_torque.torque import DriveTorque
from camgeo.effects.shocks import torque_shocks
from camgeo.effects.told import at, degrees, loss_of_contact, placed
from camgeo.numeric.extremes import Extreme
from camgeo.units import RPM, TURN

N_M: Final = 1e-3
"""N m in an N mm."""

KG_M2: Final = 1e-3
"""kg m^2 in a t mm^2."""

WATT: Final = 1e-3
"""W in an N mm/s."""


def findings(
    torque: DriveTorque, found: Summary, limit: float | None, fluctuation: float | None
) -> tuple[Finding, ...]:
    """All findings; `limit` in N mm."""
    peaks, static = found.peaks, found.static_peaks
    out = [
        _peak("largest-torque", "largest drive torque", peaks.highest, limit, 1.0),
        _peak("smallest-torque", "smallest drive torque", peaks.lowest, limit, -1.0),
    ]
    if torque.course is not None:
        out += [
            _peak("largest-static-torque", "largest static drive torque", static.highest),
            _peak("smallest-static-torque", "smallest static drive torque", static.lowest),
        ]
    out += [
        _value("rms-torque", "root mean square of the drive torque", N_M * found.rms, "N m"),
        _value("mean-torque", "mean drive torque", N_M * found.mean, "N m"),
        _value("work-per-turn", "work of the drive over a turn", N_M * TURN * found.mean, "J"),
    ]
    if torque.course is not None:
        power = WATT * found.mean * found.speed
        out.append(_value("mean-power", "mean power of the drive", power, "W"))
    out += _flywheel(found, fluctuation)
    out += _shock(torque)
    subject, normal = torque.law.subject, torque.law.contact.normal
    lost = loss_of_contact("torque-without-contact", "drive torque", subject, normal, torque.edges)
    return (*out, *lost)


def _value(name: str, words: str, value: float, unit: str) -> Finding:
    return Finding(name, "ok", f"{words} {value:.5g} {unit}", value, unit=unit)


def _peak(
    name: str, words: str, peak: Extreme, limit: float | None = None, sense: float = 1.0
) -> Finding:
    """A peak held to the limit, which is one for both directions: -limit for the smallest."""
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
    moment = KG_M2 * moment_of_inertia(stored.span, fluctuation, found.speed)
    return [
        Finding(
            "energy-fluctuation",
            "ok",
            f"a drive of constant torque stores {N_M * stored.span:.5g} J in what turns with the"
            f" cam, between cam angles {degrees(low.place)} (slowest) and {degrees(high.place)}"
            " (fastest)",
            N_M * stored.span,
            unit="J",
        ),
        Finding(
            "flywheel",
            "ok",
            f"for a speed fluctuation of {fluctuation:g} at {found.speed / RPM:.5g} rev/min all"
            f" that turns with the cam needs a moment of inertia of {moment:.5g} kg m^2",
            moment,
            unit="kg m^2",
        ),
    ]


def _shock(torque: DriveTorque) -> list[Finding]:
    """Where a mass changes its velocity in no time; none if there is neither mass nor speed."""
    if torque.course is None:
        return []
    law = torque.law
    places = torque_shocks(
        law.subject, lambda phi, side: law.contact.required(phi, side)[3], torque.edges
    )
    if not len(places):
        return []
    first = float(places[0])
    return [
        Finding(
            "shock",
            "broken",
            f"the velocity jumps at {len(places)} cam angles, first at {degrees(first)}: the torque"
            " is infinite there, and its impulses are in none of these figures",
            cam_angle=first,
        )
    ]
