"""Balance of the disc: mass, centre of mass, unbalance, and what cancels it.

The disc is a body of uniform density between its boundaries; shaft, hub, screws and follower are
not included. The unbalance is U = m e, the mass times the distance of the centre of mass from the
cam axis, in the direction of the centre of mass (ISO 21940-2, vocabulary: unbalance vector). It
applies to one plane: a groove that is open on one side shifts the plane and does not change U.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

from camgeo.check.finding import Finding
from camgeo.effects.balance.holes import Room, Row, most, rows
from camgeo.effects.balance.spin import GRAM_MM, Errors, Spin
from camgeo.effects.balance.table import BalanceRequirements
from camgeo.effects.effect import Request, Result
from camgeo.effects.turning_disc import part_of
from camgeo.effects.wording import KG, at, missed
from camgeo.errors import GeometryError, ToleranceError
from camgeo.motion.time_course import ConstantSpeed
from camgeo.numeric.arrays import phase
from camgeo.part.mass import disc_moments
from camgeo.part.part import Part
from camgeo.part.spec import PartSpec
from camgeo.units import RPM
from camgeo.wording import place_text

TAKEN: Final = 0.1
"""Share of the tolerance for each quadrature: the errors of the outlines add up, and relative to
the disc, which is smaller than its outline, they are larger.
"""


@dataclass(frozen=True, slots=True)
class Balance(Result):
    """The balance of a disc.

    Attributes
    ----------
    findings, columns, errors : see `camgeo.effects.effect.Result`. As an unbalance may be 0, the
        scale of its error is the mass times the radius of a solid disc of that mass.
    mass : m [t].
    centre : complex [mm], centre of mass in cam coordinates, the frame coordinates at cam angle 0.
    unbalance : complex U [t mm], m times `centre`.
    unbalance_error : estimate of its absolute error [t mm].
    counterweight : [t] at the radius in the scene, opposite to `unbalance`; None if not requested.
    holes : balancing holes on the heavy side; None if not requested, not needed, or none fit.
    """

    mass: float
    centre: complex
    unbalance: complex
    unbalance_error: float
    counterweight: float | None
    holes: Row | None


def compute(request: Request[BalanceRequirements]) -> Balance:
    """Mass, centre of mass, unbalance and what cancels it.

    Raises
    ------
    GeometryError
        With key "effects.balance.grade" if there is a grade and no speed; as for the part if bore
        or rim do not fit.
    EffectError
        If there is no disc, or the tolerance cannot be reached.
    """
    data, subject = request.data, request.subject
    course = subject.state.course
    if data.grade is not None and course is None:
        raise GeometryError("needs [cam] speed or speed_curve", key="effects.balance.grade")
    part = part_of(subject, "balance")
    data = _with_density(data, subject.part_spec)
    per_area = data.density * (part.disc[-1].z1 - part.disc[0].z0)
    moments = disc_moments(part, data.density, request.tolerance * TAKEN)
    mass, unbalance, unsure = moments.area, moments.first, moments.first_error
    radius = math.sqrt(mass / (per_area * math.pi))
    error = max(moments.area_error / mass, unsure / (mass * radius))
    if not error <= request.tolerance:
        raise missed(
            "mass or centre of mass of the disc", error, "mass or radius", request.tolerance
        )

    balanced = abs(unbalance) <= unsure
    errors = Errors(mass, moments.area_error, abs(unbalance), unsure, radius)
    if balanced:  # what was found may be off by all of it
        errors = replace(errors, unsure=unsure + abs(unbalance))
        unbalance = 0.0j
    findings = [*disc_findings(mass, unbalance, balanced=balanced)]
    spin = None
    if course is not None:
        spin = Spin(unbalance, subject.cam.rotation, course, subject.state.smooth_angles)
    findings.append(unbalance_finding(data.grade, mass, unbalance, unsure, spin))
    if spin is not None:
        findings.append(force_finding(spin))
    counterweight = None
    if data.counterweight_radius is not None:
        counterweight = 0.0 if balanced else abs(unbalance) / data.counterweight_radius
        findings.append(counterweight_finding(counterweight, data.counterweight_radius, unbalance))
    holes = None
    if not balanced and data.hole_radius is not None:
        holes, finding = _holes(part, data, unbalance, per_area)
        findings.append(finding)
    return Balance(
        findings=tuple(findings),
        columns=() if spin is None else spin.columns(),
        errors=errors.figures(spin, data.counterweight_radius, holes),
        mass=mass,
        centre=unbalance / mass,
        unbalance=unbalance,
        unbalance_error=errors.unsure,
        counterweight=counterweight,
        holes=holes,
    )


def _with_density(data: BalanceRequirements, spec: PartSpec | None) -> BalanceRequirements:
    """The density of the part, where that is stated; both agree if both are."""
    if spec is None or spec.density is None:
        return data
    return replace(data, density=spec.density)


def _holes(
    part: Part, data: BalanceRequirements, unbalance: complex, per_area: float
) -> tuple[Row | None, Finding]:
    """The fewest holes that fit, with the finding; or the finding that says why none do."""
    radius, largest = data.hole_radius, data.hole_diameter
    assert radius is not None
    assert largest is not None  # the data has both or none
    reason = ""
    room: Room | None = None
    try:
        for row in rows(unbalance, per_area, radius, largest):
            room = room or Room(part, largest)
            fault = room.fault(row)
            if not fault:
                rest = abs(unbalance - row.moment(per_area))
                return row, row_finding(row, room.wall(row), rest)
            reason = reason or fault
    except (GeometryError, ToleranceError) as error:
        reason = str(error)
    reached = abs(most(per_area, radius, largest))
    return None, no_row_finding(radius, largest, reason, reached, abs(unbalance))


def degrees(angle: float) -> float:
    """`angle` [rad] in degrees, in [0, 360)."""
    return math.degrees(angle) % 360.0


def disc_findings(mass: float, unbalance: complex, *, balanced: bool) -> Iterator[Finding]:
    """Mass [t] and, from the unbalance [t mm], the centre of mass."""
    yield Finding("disc-mass", "ok", f"mass of the disc {KG * mass:.6g} kg", KG * mass, unit="kg")
    centre = unbalance / mass
    where = f"at {place_text(centre)} in cam coordinates"
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
    """The unbalance [t mm], known to within `unsure`, checked against the grade [mm/s] if any.

    Permissible is U = G m / omega at the largest speed (ISO 21940-11:2016, 6.3: the grade is
    G = e_per omega, the permissible residual unbalance U_per = e_per m).
    """
    value = GRAM_MM * abs(unbalance)
    if abs(unbalance) <= unsure:
        text = f"unbalance of the disc 0, to within the error of {GRAM_MM * unsure:.2g} g mm"
        value = 0.0
    else:
        direction = degrees(phase(unbalance))
        text = f"unbalance of the disc {value:.6g} g mm, in the direction {direction:.4f} deg"
    if grade is None or spin is None:
        return Finding("unbalance", "ok", text, value, unit="g mm")
    omega = spin.largest_speed()
    allowed = GRAM_MM * grade * mass / omega
    broken = value > allowed
    return Finding(
        name="unbalance",
        severity="broken" if broken else "ok",
        sentence=(
            f"{text}, {'above' if broken else 'at most'} {allowed:.6g} g mm, balance quality grade"
            f" G {grade:g} at {omega / RPM:.6g} rev/min"
        ),
        value=value,
        limit=allowed,
        unit="g mm",
    )


def force_finding(spin: Spin) -> Finding:
    """The inertia force on the shaft."""
    force = spin.largest_force()
    steady = isinstance(spin.course, ConstantSpeed)
    place = "at all cam angles" if steady else at(force.place)
    return Finding(
        name="unbalance-force",
        severity="ok",
        sentence=f"largest force of the unbalance on the shaft {force.value:.6g} N, {place}",
        value=force.value,
        unit="N",
        cam_angle=None if steady else force.place,
    )


def counterweight_finding(weight: float, radius: float, unbalance: complex) -> Finding:
    """The counterweight [t] at `radius` [mm]."""
    if weight == 0.0:
        return Finding("counterweight", "ok", "no counterweight is needed", 0.0, unit="kg")
    direction = degrees(phase(-unbalance))
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
    """Balancing holes that fit, with the thinnest wall [mm] and the remaining unbalance [t mm]."""
    places = ", ".join(f"{degrees(angle):.4f}" for angle in row.directions)
    what, cancel = ("hole", "cancels") if row.count == 1 else ("holes", "cancel")
    return Finding(
        name="balancing-holes",
        severity="ok",
        sentence=(
            f"{row.count} {what} of {row.diameter:.6g} mm through the disc, {row.radius:.6g} mm"
            f" from the cam axis in the direction {places} deg, {cancel} the unbalance"
            f" ({GRAM_MM * rest:.2g} g mm left, thinnest wall {wall:.4g} mm)"
        ),
        value=row.diameter,
        unit="mm",
    )


def no_row_finding(
    radius: float, largest: float, fault: str, reached: float, unbalance: float
) -> Finding:
    """A warning that no balancing holes [mm] fit: the fault of the row with fewest holes, or the
    unbalance that they reach [t mm].
    """
    reason = fault or (
        f"they remove at most {GRAM_MM * reached:.6g} of {GRAM_MM * unbalance:.6g} g mm"
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
