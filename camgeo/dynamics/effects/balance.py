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
from functools import reduce
from operator import and_, sub, xor
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.contact import require_part, unbalance_force
from camgeo.dynamics.effects.effect import Bound, Column, Quantity, Request, Result
from camgeo.dynamics.effects.tables import BalanceRequirements
from camgeo.dynamics.effects.wording import KG, at_angle, tolerance_error
from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.outline.path import Moments
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, merged, phase
from camgeo.numeric.extremes import Extreme, bracketed_roots, piecewise_highest
from camgeo.part.mass import disc_moments
from camgeo.part.part import Boundary, Part
from camgeo.units import RPM, place_text

QUADRATURE_SHARE: Final = 0.1
"""Share of the tolerance for each quadrature: the errors of the outlines add up, and relative to
the disc, which is smaller than its outline, they are larger.
"""


@dataclass(frozen=True, slots=True)
class Balance(Result):
    """The balance of a disc.

    Attributes
    ----------
    findings, columns, errors : see `camgeo.dynamics.effects.effect.Result`. As an unbalance may be
    0, the
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
    holes: HoleRow | None


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
    part = require_part(subject, "balance")
    spec = subject.part_spec
    if spec is not None and spec.density is not None:
        data = replace(data, density=spec.density)  # both agree if both are stated
    # Density times thickness: a hole through the disc removes this mass per unit of its area.
    per_area = data.density * (part.disc[-1].z1 - part.disc[0].z0)
    moments = disc_moments(part, data.density, request.tolerance * QUADRATURE_SHARE)
    mass, unbalance, unsure = moments.area, moments.first, moments.first_error
    # The solid disc of this mass is the scale of the error: the distance of the centre may be 0.
    radius = math.sqrt(mass / (per_area * math.pi))
    error = max(moments.area_error / mass, unsure / (mass * radius))
    if not error <= request.tolerance:
        raise tolerance_error(
            "mass or centre of mass of the disc", error, "mass or radius", request.tolerance
        )

    balanced, unbalance_error = abs(unbalance) <= unsure, unsure
    if balanced:  # what was found may be off by all of it
        unbalance, unbalance_error = 0.0j, unsure + abs(unbalance)
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
    if not balanced and data.holes is not None:
        holes, finding = _holes(part, *data.holes, unbalance, per_area)
        findings.append(finding)
    return Balance(
        findings=tuple(findings),
        columns=() if spin is None else spin.columns(),
        errors=figure_errors(
            moments, unbalance_error, radius, spin, data.counterweight_radius, holes
        ),
        mass=mass,
        centre=unbalance / mass,
        unbalance=unbalance,
        unbalance_error=unbalance_error,
        counterweight=counterweight,
        holes=holes,
    )


def _holes(
    part: Part, radius: float, largest: float, unbalance: complex, per_area: float
) -> tuple[HoleRow | None, Finding]:
    """The fewest holes that fit, with the finding; or the finding that says why none do."""
    reason = ""
    room: HoleSpace | None = None
    try:
        for row in rows(unbalance, per_area, radius, largest):
            room = room or HoleSpace(part, largest)
            fault = room.fault(row)
            if not fault:
                rest = abs(unbalance - row.moment(per_area))
                return row, row_finding(row, room.wall(row), rest)
            reason = reason or fault
    except (GeometryError, ToleranceError) as error:
        reason = str(error)
    reached = abs(largest_removable(per_area, radius, largest))
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
    place = "at all cam angles" if steady else at_angle(force.place)
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


def row_finding(row: HoleRow, wall: float, rest: float) -> Finding:
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


# -- holes ----------------------------------------------------------------------------------------
# Equal holes through a disc that cancel its unbalance.
#
# The holes are in a row on a circle about the cam axis, symmetric about the heavy direction. Each
# of n holes of diameter d on the radius R, through the thickness b of a disc of density rho,
# removes the mass rho b pi d^2 / 4; neighbours are the angle delta apart. Together they remove the
# unbalance
#
#     U = rho b pi d^2 / 4 * R * sin(n delta/2) / sin(delta/2),
#
# the sum of n vectors of equal length, each rotated by delta relative to the previous one (Norton,
# "Machine Design", chapter on balancing, static balance, for the vector sum of the m r products).
# Half a diameter of material remains between neighbours: sin(delta/2) = 3 d / (4 R).


MOST_HOLES: Final = 24
"""If more were needed, the disc should be redesigned rather than balanced."""

PITCH: Final = 1.5
"""Centre distance of neighbouring holes, in diameters."""

SHARE: Final = 1e-4
"""Largest deviation of the polygons from the boundaries, as a share of the hole diameter; it is
subtracted from the distances found."""


@dataclass(frozen=True, slots=True)
class HoleRow:
    """A row of equal holes.

    Attributes
    ----------
    count : number of holes.
    diameter : of each [mm].
    radius : of the circle of their centres about the cam axis [mm].
    directions : of their centres [rad], counter-clockwise from the x axis, ascending.
    """

    count: int
    diameter: float
    radius: float
    directions: tuple[float, ...]

    @property
    def centres(self) -> tuple[complex, ...]:
        """Centres of the holes in cam coordinates [mm]."""
        return tuple(
            complex(self.radius * math.cos(angle), self.radius * math.sin(angle))
            for angle in self.directions
        )

    def moment(self, per_area: float) -> complex:
        """The unbalance that they remove [t mm], for `per_area` [t/mm^2] of the disc."""
        hole_moment = per_area * 0.25 * math.pi * self.diameter**2
        return hole_moment * complex(
            math.fsum(centre.real for centre in self.centres),
            math.fsum(centre.imag for centre in self.centres),
        )


def rows(unbalance: complex, per_area: float, radius: float, largest: float) -> Iterator[HoleRow]:
    """Rows of holes that cancel `unbalance`, those with few holes first.

    Parameters
    ----------
    unbalance : [t mm], its direction in cam coordinates; not 0.
    per_area : mass of the disc per unit of area [t/mm^2], density times thickness.
    radius : of the circle of their centres [mm].
    largest : largest diameter of a hole [mm].

    A row with its gaps spans at most half a turn; up to there, more holes remove more.
    """
    heavy = math.atan2(unbalance.imag, unbalance.real)
    for count in range(1, MOST_HOLES + 1):
        diameter = _diameter(abs(unbalance), per_area, radius, count)
        if diameter is None or diameter > largest:
            continue
        delta = 0.0 if count == 1 else 2.0 * math.asin(0.5 * PITCH * diameter / radius)
        # The row is symmetric about the heavy direction.
        middle = 0.5 * (count - 1)
        directions = tuple(heavy + (k - middle) * delta for k in range(count))
        yield HoleRow(count, diameter, radius, directions)


def _diameter(unbalance: float, per_area: float, radius: float, count: int) -> float | None:
    """Diameter of `count` holes that cancel `unbalance`; None if they need over half a turn."""
    share = unbalance / (per_area * 0.25 * math.pi * radius)  # d^2 sin(n delta/2) / sin(delta/2)
    if count == 1:
        return math.sqrt(share)
    # With u = delta/2 and d = 2 R sin(u) / PITCH: sin(u) sin(n u), which grows up to n u = pi/2.
    target = share * (0.5 * PITCH / radius) ** 2
    last = 0.5 * math.pi / count
    if target > math.sin(last):
        return None

    def missing(u: FloatArray) -> FloatArray:
        return np.asarray(np.sin(u) * np.sin(count * u) - target)

    u = bracketed_roots(missing, np.array([0.0]), np.array([last]))
    return 2.0 * radius * math.sin(float(u[0])) / PITCH


def largest_removable(per_area: float, radius: float, largest: float) -> float:
    """The largest unbalance [t mm] that a row of holes can remove."""

    def removed(count: int) -> float:
        if count == 1:
            return largest**2
        # Half the angle between neighbours of the largest diameter; the row spans half a turn at
        # most.
        u = min(math.asin(min(0.5 * PITCH * largest / radius, 1.0)), 0.5 * math.pi / count)
        diameter = min(largest, 2.0 * radius * math.sin(u) / PITCH)
        return diameter**2 * math.sin(count * u) / math.sin(u)

    best = max(removed(count) for count in range(1, MOST_HOLES + 1))
    return per_area * 0.25 * math.pi * radius * best


class HoleSpace:
    """The material through the whole thickness of a disc, beside its hubs.

    Parameters
    ----------
    part : its boundaries.
    largest : largest diameter of a hole [mm].

    Raises
    ------
    UndercutError, ToleranceError, GeometryError
        If a boundary has no polygon that is close enough.
    """

    def __init__(self, part: Part, largest: float) -> None:
        self._tolerance = SHARE * largest
        self._boundaries = {boundary.name: self._polygon(boundary) for boundary in part.boundaries}
        # Boundaries are nested: material begins at one and ends at the next.
        sections = [
            reduce(xor, (self._boundaries[boundary.name] for boundary in layer.boundaries))
            for layer in part.disc
        ]
        material = reduce(and_, sections)
        hubs = [layer.boundaries[0] for layer in part.layers if layer not in part.disc]
        self._material = reduce(sub, (self._boundaries[hub.name] for hub in hubs), material)

    def _polygon(self, boundary: Boundary) -> Any:
        import shapely  # its import takes longer than the rest of the effect

        vertices = boundary.polyline(self._tolerance, "fast").contour.vertices
        return shapely.Polygon(np.column_stack((vertices.real, vertices.imag)))

    def fault(self, row: HoleRow) -> str:
        """The reason why the holes do not fit, as a clause; empty if they fit."""
        import shapely

        for angle, centre in zip(row.directions, row.centres, strict=True):
            place = f"the hole in the direction {math.degrees(angle) % 360.0:.4f} deg"
            if not shapely.contains_xy(self._material, centre.real, centre.imag):
                return f"{place} has its centre outside the material"
            near, name = self._nearest(centre)
            if near <= 0.5 * row.diameter:
                return (
                    f"{place}, {row.diameter:.4f} mm in diameter, cuts into the {name}, which is"
                    f" {near:.4f} mm from its centre"
                )
        return ""

    def wall(self, row: HoleRow) -> float:
        """Smallest wall between a hole and a boundary [mm], for holes that fit."""
        return min(self._nearest(centre)[0] for centre in row.centres) - 0.5 * row.diameter

    def _nearest(self, centre: complex) -> tuple[float, str]:
        """A lower bound of the distance of the nearest boundary from `centre` [mm], and its
        name.
        """
        import shapely

        point = shapely.Point(centre.real, centre.imag)
        return min(
            (float(polygon.exterior.distance(point)) - self._tolerance, name)
            for name, polygon in self._boundaries.items()
        )


# -- spin -----------------------------------------------------------------------------------------
# The inertia force of an unbalanced disc, and the errors of all figures of its balance.


GRAM_MM: Final = 1e6
"""Factor from t mm to g mm."""


def figure_errors(
    moments: Moments,
    unsure: float,
    radius: float,
    spin: Spin | None,
    arm: float | None,
    holes: HoleRow | None,
) -> dict[str, Bound]:
    """The errors of all figures, by the names of findings and columns.

    Parameters
    ----------
    moments : of the disc, its mass [t] and its unbalance U [t mm].
    unsure : the error of U [t mm].
    radius : of a solid disc of that mass [mm].
    arm : the radius of the counterweight [mm].
    """
    mass, unbalance = moments.area, abs(moments.first)
    bound = Bound(unsure, mass * radius)
    # The centre is U / m: to first order the errors of both add up.
    centre_error = (unsure + unbalance / mass * moments.area_error) / mass
    errors = {
        "disc-mass": Bound(moments.area_error, mass).times(KG),
        "centre-of-mass": Bound(centre_error, radius),
        "unbalance": bound.times(GRAM_MM),
    }
    if spin is not None:
        # The force is linear in U, so that of a unit unbalance is the factor of its error.
        forces = ("unbalance-force", "unbalance force x", "unbalance force y")
        errors |= dict.fromkeys(forces, bound.times(spin.largest_force_of_unit()))
    if arm is not None:
        errors["counterweight"] = bound.times(KG / arm)
    if holes is not None:  # d grows no faster than U, see "holes"
        share = unsure / unbalance
        errors["balancing-holes"] = Bound(share * holes.diameter, holes.diameter)
    return errors


@dataclass(frozen=True, slots=True, eq=False)
class Spin:
    """A turning disc with an unbalance.

    Attributes
    ----------
    unbalance : U [t mm] in cam coordinates.
    rotation : sigma, +1 if the cam turns counter-clockwise, -1 clockwise.
    course : how it turns.
    smooth_angles : (k,) [rad], between which the motion is smooth.
    """

    unbalance: complex
    rotation: int
    course: TimeCourse
    smooth_angles: FloatArray

    def force(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) [N] inertia force on the shaft, in the axes of the frame."""
        return unbalance_force(self.unbalance, self.rotation, phi, self.course.rates(phi, side))

    def largest_force(self) -> Extreme:
        """The largest magnitude of the force [N], and the first cam angle [rad] where it is
        reached.
        """
        return self._largest(lambda phi, side: np.abs(self.force(phi, side)))

    def largest_force_of_unit(self) -> float:
        """The largest force [N] of an unbalance of 1 t mm."""
        return replace(self, unbalance=1.0 + 0.0j).largest_force().value

    def largest_speed(self) -> float:
        """The largest omega [rad/s]."""
        return self._largest(lambda phi, side: self.course.rates(phi, side)[0]).value

    def _largest(self, values: Quantity) -> Extreme:
        edges = merged(np.concatenate((self.smooth_angles, self.course.borders)))
        return piecewise_highest(values, edges)

    def columns(self) -> tuple[Column, ...]:
        """The components of the inertia force on the shaft along the axes of the frame."""
        return (
            Column("unbalance force x", "N", lambda phi, side: self.force(phi, side).real),
            Column("unbalance force y", "N", lambda phi, side: self.force(phi, side).imag),
        )
