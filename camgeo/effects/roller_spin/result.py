"""Effect `roller-spin`: how the roller turns, and the traction that keeps it rolling.

In the notation of `friction`, a roller that rolls on the flank s turns in the fixed frame at

    omega_R = (sigma - s sigma |Z'|/r_R) omega,

and relative to its pin at omega_R - chi' omega. With its moment of inertia J, the friction of its
bearing and of rolling, and the force T along t by which the cam turns it at the lever r_R, the
balance of moments about the pin is

    J d omega_R/dt = |N| (m_p + m_r) + s sigma r_R T.

It rolls while |T| is at most mu_T |N|, with the coefficient of traction mu_T. Where the roller of a
groove changes flanks, it must reverse its spin at once, and skids whatever the traction (Norton,
Cam Design and Manufacturing Handbook, on form-closed followers and roller slip; Newton's second law
for rotation). Each of the two rollers of a yoke keeps its sense of spin, but nothing drives it
while the other one carries.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column, Quantity, Request, Result, Subject
from camgeo.effects.ranges import ranges_below
from camgeo.effects.results import CONTACT_FORCE, ContactForce
from camgeo.effects.roller_spin import RollerData
from camgeo.effects.touching import INNER, OUTER, bearing_of, sides_of
from camgeo.effects.wording import angles, extreme_findings, over, placed
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes, piecewise_lowest
from camgeo.units import RPM, TURN


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """The rolling roller.

    Attributes
    ----------
    subject : the design, as the roller touches it.
    course : how the cam turns.
    normal : contact force [N], positive where the inner flank carries.
    tangential : f_t.
    data : of the roller.
    """

    subject: Subject
    course: TimeCourse
    normal: Quantity
    tangential: Quantity
    data: RollerData

    def sense(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) s, the flank that carries."""
        return np.where(self.normal(phi, side) >= 0.0, float(INNER), float(OUTER))

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
        needed += self.tangential(phi, side) * np.abs(self.normal(phi, side))
        return np.asarray(needed)

    def reserve(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) mu_T |N| - |T| [N]."""
        there = self.data.traction * np.abs(self.normal(phi, side))
        return np.asarray(there - np.abs(self.traction(phi, side)))


@dataclass(frozen=True, slots=True, eq=False)
class RollerSpin(Result):
    """The spin of the roller, as if it never skidded.

    Attributes
    ----------
    rolling : the roller.
    opposite : the same of the second roller of a yoke; None without one.
    """

    rolling: Rolling
    opposite: RollerSpin | None = None


def compute(request: Request[RollerData]) -> RollerSpin:
    """The spin at the speed of the scene, of both rollers of a yoke."""
    subject, contact = request.subject, request.results[CONTACT_FORCE]
    if subject.returning is None:

        def shared(phi: FloatArray, side: Side) -> FloatArray:
            return bearing_of(contact, phi, side).tangential

        rolling = Rolling(subject, request.course, contact.normal, shared, request.data)
        return _spin_of(rolling, contact.edges)
    (names, noun), found = sides_of(subject), []
    for sense, touched in ((INNER, subject), (OUTER, subject.returning)):
        rolling = Rolling(
            touched,
            request.course,
            partial(_pressing, contact, sense),
            partial(_shared, contact, sense),
            request.data,
        )
        found.append(_spin_of(rolling, contact.edges))
    main, other = found
    second, words = names[OUTER], f"{names[OUTER]} {noun}"
    told = [
        replace(each, name=f"{second}-{each.name}", sentence=f"{words}: {each.sentence}")
        for each in other.findings
    ]
    columns = [
        replace(column, name=f"{names[sense]} {column.name}")
        for sense, each in ((INNER, main), (OUTER, other))
        for column in each.columns
    ]
    findings = (*main.findings, *told)
    return replace(main, findings=findings, columns=tuple(columns), opposite=other)


def _pressing(contact: ContactForce, sense: int, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) [N] on the side `sense` alone."""
    return np.maximum(sense * contact.normal(phi, side), 0.0)


def _shared(contact: ContactForce, sense: int, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) f_t on the side `sense`."""
    if contact.friction is None:
        return np.zeros(len(phi))
    return contact.friction.bearing(phi, side, sense).tangential


def _spin_of(rolling: Rolling, edges: FloatArray) -> RollerSpin:
    """The spin of one roller; all is smooth between neighbouring `edges` (k,) [rad]."""

    def on_pin(phi: FloatArray, side: Side) -> FloatArray:
        return rolling.spin(phi, side)[1] / RPM

    inside = edges[(edges > 0.0) & (edges < TURN)]
    return RollerSpin(
        findings=(
            *extreme_findings(
                "roller-spin",
                "speed of the roller on its pin",
                piecewise_extremes(on_pin, edges),
                "rev/min",
                ", positive counter-clockwise",
            ),
            _of_reserve(rolling, edges),
            *_reversals(rolling, edges),
        ),
        columns=(
            Column("roller spin", "rev/min", on_pin, borders=inside),
            Column("roller traction", "N", rolling.traction, borders=inside),
            Column("traction reserve", "N", rolling.reserve, 0.0, inside),
        ),
        rolling=rolling,
    )


def _of_reserve(rolling: Rolling, edges: FloatArray) -> Finding:
    lowest = piecewise_lowest(rolling.reserve, edges)
    sentence = (
        f"smallest reserve of traction {lowest.value:.6g} N"
        f" {angles([lowest.place])}, with a coefficient of {rolling.data.traction:g}"
    )
    if lowest.value >= 0.0:
        return placed("traction-reserve", f"{sentence}: the roller rolls", lowest, "N", 0.0)
    found = ranges_below(rolling.reserve, edges, 0.0, lowest)
    where = over([(each.start, each.end) for each in found])
    return placed(
        "traction-reserve", f"{sentence}: the roller skids {where}", lowest, "N", 0.0, "warning"
    )


def _reversals(rolling: Rolling, edges: FloatArray) -> Iterator[Finding]:
    """Where the roller changes flanks."""
    middle = 0.5 * (edges[:-1] + edges[1:])
    sense = rolling.sense(middle, "right")
    places = edges[:-1][sense != np.roll(sense, 1)]
    if not len(places):
        return
    yield Finding(
        "roller-reversal",
        "warning",
        f"the roller changes flanks {angles(places.tolist())}, where it has to reverse its spin"
        " and skids",
        float(len(places)),
        0.0,
        cam_angle=float(places[0]),
    )
