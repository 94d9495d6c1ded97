"""Balance of the disc: mass, centre of mass, unbalance, and what cancels it.

The disc is a body of one density between its boundaries; shaft, hub, screws and follower are not
looked at. The unbalance is U = m e, mass times distance of the centre of mass from the cam axis, in
the direction of the centre of mass (ISO 21940-2, vocabulary: unbalance vector). It is that of one
plane: a groove that is open on one side moves the plane and leaves U as it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

from camgeo.check.finding import Finding
from camgeo.effects.balance.body import disc_moments
from camgeo.effects.balance.findings import (
    counterweight_finding,
    disc_findings,
    force_finding,
    no_row_finding,
    row_finding,
    unbalance_finding,
)
from camgeo.effects.balance.holes import Row, most, rows
from camgeo.effects.balance.room import Room
from camgeo.effects.balance.spec import BalanceSpec
from camgeo.effects.balance.spin import Spin
from camgeo.effects.effect import Request, Result
from camgeo.errors import EffectError, GeometryError, ToleranceError
from camgeo.part.part import Part

TAKEN: Final = 0.1
"""Share of the tolerance that a quadrature gets: the errors of the outlines add up, and holes make
the disc smaller than the areas of which they are shares."""


@dataclass(frozen=True, slots=True)
class Balance(Result):
    """The balance of a disc.

    Attributes
    ----------
    findings, columns, error : see `camgeo.effects.effect.Result`. An unbalance may be 0: its error
        is a share of the mass times the radius of a full disc of that mass.
    mass : m [t].
    centre : complex [mm], centre of mass in cam coordinates, at cam angle 0 those of the frame.
    unbalance : complex U [t mm], m times `centre`.
    unbalance_error : estimate of its absolute error [t mm].
    counterweight : [t] at the radius that the scene gives, opposite to `unbalance`; None if none is
        sought.
    holes : balancing holes on the heavy side; None if none are sought or needed, or none fit.
    """

    mass: float
    centre: complex
    unbalance: complex
    unbalance_error: float
    counterweight: float | None
    holes: Row | None
    error: float = field(kw_only=True)


def compute(request: Request[BalanceSpec]) -> Balance:
    """Mass, centre of mass, unbalance and what cancels it.

    Raises
    ------
    GeometryError
        With key "effects.balance.grade" if there is a grade and no speed; as `Subject.part` if bore
        or rim do not fit.
    EffectError
        If there is no disc, or the tolerance cannot be reached.
    """
    spec, subject = request.spec, request.subject
    course = subject.cam.drive.time_course
    if spec.grade is not None and course is None:
        raise GeometryError("needs [cam] speed or speed_curve", key="effects.balance.grade")
    part = _part(request)
    per_area = spec.density * part.thickness
    moments = disc_moments(part, spec.density, request.tolerance * TAKEN)
    mass, unbalance, unsure = moments.area, moments.first, moments.first_error
    radius = math.sqrt(mass / (per_area * math.pi))
    error = max(moments.area_error / mass, unsure / (mass * radius))
    _require(error, request.tolerance)

    balanced = abs(unbalance) <= unsure
    findings = [*disc_findings(mass, unbalance, balanced=balanced)]
    spin = None
    if course is not None:
        spin = Spin(unbalance, subject.cam.rotation, course, subject.cam.drive.smooth_angles)
    findings.append(unbalance_finding(spec.grade, mass, unbalance, unsure, spin))
    if spin is not None:
        findings.append(force_finding(spin))
    counterweight = None
    if spec.counterweight_radius is not None:
        counterweight = 0.0 if balanced else abs(unbalance) / spec.counterweight_radius
        findings.append(counterweight_finding(counterweight, spec.counterweight_radius, unbalance))
    holes = None
    if not balanced and spec.hole_radius is not None:
        holes, finding = _holes(part, spec, unbalance, per_area)
        findings.append(finding)
    return Balance(
        findings=tuple(findings),
        columns=() if spin is None else spin.columns(),
        error=error,
        mass=mass,
        centre=unbalance / mass,
        unbalance=unbalance,
        unbalance_error=unsure,
        counterweight=counterweight,
        holes=holes,
    )


def _part(request: Request[BalanceSpec]) -> Part:
    """The part; EffectError if there is none."""
    try:
        return request.subject.made.part
    except GeometryError as error:
        if error.key:
            raise
        raise EffectError(f"there is no disc to balance: {error.message}") from error


def _require(error: float, tolerance: float) -> None:
    if not error <= tolerance:
        raise EffectError(
            f"the error of mass and centre of mass, a share of {error:.3g}, stays above the"
            f" tolerance {tolerance:g}",
            value=error,
            limit=tolerance,
        )


def _holes(
    part: Part, spec: BalanceSpec, unbalance: complex, per_area: float
) -> tuple[Row | None, Finding]:
    """The fewest holes that fit, and the finding that says so, or why there are none."""
    radius, largest = spec.hole_radius, spec.hole_diameter
    assert radius is not None
    assert largest is not None  # the spec has both or none
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
