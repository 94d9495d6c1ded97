"""What the balance of a disc has to say."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import Final

from camgeo.check.finding import Finding
from camgeo.effects.balance.holes import Row
from camgeo.effects.balance.spin import Spin
from camgeo.motion.time_course import ConstantSpeed
from camgeo.units import RPM, TURN

KG: Final = 1e3
"""One t in kg."""

GRAM_MM: Final = 1e6
"""One t mm in g mm."""


def degrees(angle: float) -> float:
    """`angle` [rad] in degrees, in [0, 360)."""
    return math.degrees(angle) % 360.0


def disc_findings(mass: float, unbalance: complex, *, balanced: bool) -> Iterator[Finding]:
    """Mass [t] and centre of mass, from the unbalance [t mm]."""
    yield Finding("disc-mass", "ok", f"mass of the disc {KG * mass:.6g} kg", KG * mass, unit="kg")
    centre = unbalance / mass
    where = f"at ({centre.real:.6g}, {centre.imag:.6g}) mm in cam coordinates"
    yield Finding(
        "centre-of-mass",
        "ok",
        "the centre of mass lies on the cam axis"
        if balanced
        else f"the centre of mass lies {abs(centre):.6g} mm from the cam axis, {where}",
        0.0 if balanced else abs(centre),
        unit="mm",
    )


def unbalance_finding(
    grade: float | None, mass: float, unbalance: complex, unsure: float, spin: Spin | None
) -> Finding:
    """The unbalance [t mm], known to `unsure`, held to the grade [mm/s] if there is one.

    Permissible is U = G m / omega at the largest speed (ISO 21940-11:2016, 6.3: the grade is
    G = e_per omega, the permissible residual unbalance U_per = e_per m).
    """
    value = GRAM_MM * abs(unbalance)
    if abs(unbalance) <= unsure:
        told = f"unbalance of the disc 0 but for the error of {GRAM_MM * unsure:.2g} g mm"
        value = 0.0
    else:
        direction = degrees(cmath.phase(unbalance))
        told = f"unbalance of the disc {value:.6g} g mm, in the direction {direction:.4f} deg"
    if grade is None or spin is None:
        return Finding("unbalance", "ok", told, value, unit="g mm")
    omega = spin.largest_speed()
    allowed = GRAM_MM * grade * mass / omega
    broken = value > allowed
    return Finding(
        name="unbalance",
        severity="broken" if broken else "ok",
        sentence=(
            f"{told}, {'above' if broken else 'at most'} {allowed:.6g} g mm, balance quality grade"
            f" G {grade:g} at {omega / RPM:.6g} rev/min"
        ),
        value=value,
        limit=allowed,
        unit="g mm",
    )


def force_finding(spin: Spin) -> Finding:
    """The force of inertia on the shaft."""
    force, phi = spin.largest_force()
    steady = isinstance(spin.course, ConstantSpeed)
    place = "all round" if steady else f"at cam angle {math.degrees(phi):.4f} deg"
    return Finding(
        name="unbalance-force",
        severity="ok",
        sentence=f"largest force of the unbalance on the shaft {force:.6g} N, {place}",
        value=force,
        unit="N",
        cam_angle=None if steady else phi % TURN,
    )


def counterweight_finding(weight: float, radius: float, unbalance: complex) -> Finding:
    """The counterweight [t] at `radius` [mm]."""
    if weight == 0.0:
        return Finding("counterweight", "ok", "no counterweight is needed", 0.0, unit="kg")
    direction = degrees(cmath.phase(-unbalance))
    return Finding(
        name="counterweight",
        severity="ok",
        sentence=(
            f"a counterweight of {KG * weight:.6g} kg with its centre of mass {radius:.6g} mm from"
            f" the cam axis, in the direction {direction:.4f} deg, cancels the unbalance"
        ),
        value=KG * weight,
        unit="kg",
    )


def row_finding(row: Row, wall: float, rest: float) -> Finding:
    """Balancing holes that fit, with their least wall [mm] and the unbalance left over [t mm]."""
    places = ", ".join(f"{degrees(angle):.4f}" for angle in row.directions)
    what = "hole" if row.count == 1 else "holes"
    return Finding(
        name="balancing-holes",
        severity="ok",
        sentence=(
            f"{row.count} {what} of {row.diameter:.6g} mm through the disc, {row.radius:.6g} mm"
            f" from the cam axis in the direction {places} deg, cancel the unbalance"
            f" ({GRAM_MM * rest:.2g} g mm left, thinnest wall {wall:.4g} mm)"
        ),
        value=row.diameter,
        unit="mm",
    )


def no_row_finding(
    radius: float, largest: float, fault: str, reached: float, unbalance: float
) -> Finding:
    """No balancing holes [mm]: by the fault of the row of fewest; without, by what they reach
    [t mm].
    """
    reason = fault or (
        f"they take off {GRAM_MM * reached:.6g} of {GRAM_MM * unbalance:.6g} g mm at most"
    )
    return Finding(
        name="holes-do-not-fit",
        severity="warning",
        sentence=(
            f"no holes up to {largest:.6g} mm in diameter, {radius:.6g} mm from the cam axis,"
            f" cancel the unbalance: {reason}"
        ),
        value=None if fault else GRAM_MM * reached,
        limit=None if fault else GRAM_MM * unbalance,
        unit="" if fault else "g mm",
    )
