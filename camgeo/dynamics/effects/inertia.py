"""Inertia: the moving masses, their inertia forces, and their inertia reduced to follower and cam.

The motion of all masses is determined by the cam angle. Their generalised force on the follower
follows from d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and
their inertia reduced to the follower or the camshaft follows from their kinetic energy. VDI 2142
and textbooks of machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design
of Machinery", chapters on dynamics and cam dynamics) do the same for a single mass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Column, Request, Subject, driving_slider
from camgeo.dynamics.effects.forces import Force, at_rates, refuse_locked, shaft_and_turn, shocks
from camgeo.dynamics.effects.results import Inertia, Mass
from camgeo.dynamics.effects.tables import MassProperties
from camgeo.dynamics.effects.wording import (
    FORCES,
    KG_M2,
    MASSES,
    Label,
    extreme_finding,
    extreme_findings,
)
from camgeo.kinematics.mechanism.linkage import FarEnd, Linkage
from camgeo.kinematics.mechanism.linkages import turning
from camgeo.kinematics.motion import Jet, Motion
from camgeo.kinematics.time_course import TimeCourse
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes, piecewise_highest
from camgeo.units import at_cam_angles, cam_angle

WRITTEN: Final = 1e-3
"""Relative error of a moment of inertia that may come from writing it with a few digits."""


def compute(request: Request[MassProperties]) -> Inertia:
    """The inertia of the masses in `request.data`.

    Raises
    ------
    GeometryError
        With the key, if the scene gives the mass of a part that the mechanism does not have.
    EffectError
        If the follower cannot move a mass behind a linkage at some cam angle.
    """
    subject, data = request.subject, request.data
    train, linkage = mass_train(subject, data), subject.drive.linkage
    if data.beyond(linkage):
        refuse_locked(subject, "'s mass")

    lift = subject.cam.lift_unit
    report = _Report(subject, request.course, train, MASSES[lift], FORCES[lift])
    inertia = Inertia(
        force=Force("inertia", partial(inertia_force, train)),
        masses=weighted_masses(subject, data),
        moved=at_follower(subject, data) if linkage is None else data.far(linkage),
        coupler_moment=0.0 if linkage is None else data.turning(linkage),
        to_follower=partial(reduced, train),
        mass_terms=partial(reduced_mass_terms, train, subject.drive.far_end),
        columns=report.columns(),
    )
    findings = report.findings(shocks(subject, inertia.to_follower))
    return replace(inertia, findings=(*findings, *lacking(subject, data)))


def lacking(subject: Subject, data: MassProperties) -> tuple[Finding, ...]:
    """A warning if the rocker's moment of inertia is below that of its mass as a point.

    By the parallel axis theorem (Steiner), the moment about the pivot is m r^2 plus the moment
    about the centre of mass.
    """
    pivot = subject.cam.follower.pivot
    if data.rocker_centre is None or pivot is None:
        return ()
    least = data.rocker_mass * abs(data.rocker_centre - pivot) ** 2
    if data.moment_of_inertia >= least * (1.0 - WRITTEN):
        return ()
    value, bound = KG_M2 * data.moment_of_inertia, KG_M2 * least
    return (
        Finding(
            name="rocker-moment-of-inertia",
            severity="warning",
            sentence=(
                f"the rocker's moment of inertia {value:.6g} kg m^2 is less than the"
                f" {bound:.6g} kg m^2 of its mass as a point at its centre of mass"
            ),
            value=value,
            limit=bound,
            unit="kg m^2",
        ),
    )


@dataclass(frozen=True, slots=True)
class _Report:
    """The quantities that findings and columns show."""

    subject: Subject
    course: TimeCourse
    train: Train
    reduced: Label
    acting: Label

    def mass(self, phi: FloatArray, side: Side) -> FloatArray:
        """Inertia reduced to the follower, in the unit of `reduced`."""
        return reduced(self.train, phi, side) * self.reduced.scale

    def at_cam(self, phi: FloatArray, side: Side) -> FloatArray:
        """Inertia reduced to the camshaft [kg m^2]."""
        return np.asarray(KG_M2 * at_cam(self.train, phi, side)[0])

    def force(self, phi: FloatArray, side: Side) -> FloatArray:
        """Inertia force at the speed of the scene [N or N m]."""
        acting = at_rates(inertia_force(self.train, phi, side), self.course.rates(phi, side))
        return acting * self.acting.scale

    def columns(self) -> tuple[Column, ...]:
        return (
            Column(f"reduced {self.reduced.word}", self.reduced.unit, self.mass),
            Column(f"inertia {self.acting.word}", self.acting.unit, self.force),
        )

    def findings(self, shocks: Sequence[float]) -> tuple[Finding, ...]:
        """All findings; `shocks` are the cam angles [rad] at which the velocity jumps."""
        edges, unit = self.subject.state.smooth_angles, self.reduced.unit
        largest = piecewise_highest(self.at_cam, edges)
        name = f"reduced-{self.reduced.word.replace(' ', '-')}"
        words = f"{self.reduced.word} reduced to the follower"
        report = []
        if isinstance(self.train, DirectTrain):  # constant over the cam angle
            value = float(self.mass(np.zeros(1), "right")[0])
            sentence = f"{words} {value:.6g} {unit}"
            report.append(Finding(name, "ok", sentence, value, unit=unit))
        else:
            masses = piecewise_extremes(self.mass, edges)
            report += extreme_findings(name, words, masses, unit)
        report.append(
            extreme_finding(
                "largest-moment-at-cam",
                "largest moment of inertia reduced to the camshaft",
                largest,
                "kg m^2",
            )
        )
        report.append(self._largest_force(edges, shocks))
        return tuple(report)

    def _largest_force(self, edges: FloatArray, shocks: Sequence[float]) -> Finding:
        forces = piecewise_extremes(self.force, edges)
        worst = max(forces.lowest, forces.highest, key=lambda end: abs(end.value))
        unit, what = self.acting.unit, self.acting.word
        if not shocks:
            return extreme_finding("largest-inertia-force", f"largest inertia {what}", worst, unit)
        angle = shocks[0]
        return Finding(
            name="largest-inertia-force",
            severity="warning",
            sentence=(
                f"the inertia {what} is infinite at a shock {at_cam_angles(angle)}; elsewhere the"
                f" largest is {worst.value:.6g} {unit} at {cam_angle(worst.place)} deg"
            ),
            unit=unit,
            cam_angle=angle,
        )


# -- masses ---------------------------------------------------------------------------------------
# The masses that have a weight, and their positions.


def weighted_masses(subject: Subject, data: MassProperties) -> tuple[Mass, ...]:
    """The masses of `data` that are not 0."""
    points: list[tuple[str, float, _GuidedPoint | _RockerPoint | _CouplerPoint]]
    follower, linkage = subject.cam.follower, subject.drive.linkage
    pivot = follower.pivot
    if pivot is not None:
        centre = pivot if data.rocker_centre is None else data.rocker_centre
        points = [
            ("rocker", data.rocker_mass, _RockerPoint(subject, pivot, centre - pivot)),
            ("roller", data.roller_mass, _RockerPoint(subject, pivot, follower.start_arm)),
        ]
    else:
        guided = _GuidedPoint(subject)
        points = [("follower", data.mass, guided), ("roller", data.roller_mass, guided)]
    if linkage is not None:
        placed = (subject, linkage, *shaft_and_turn(subject, linkage))
        if driving_slider(subject) is not None:
            points.append(("slider", data.mass, _CouplerPoint(*placed, 1.0)))
        points.append(("coupler", data.coupler_mass, _CouplerPoint(*placed, data.coupler_centre)))
    return tuple(
        Mass(name, mass, point.place, point.per_lift, point.rates, point.per_coordinate)
        for name, mass, point in points
        if mass
    )


@dataclass(frozen=True, slots=True)
class _GuidedPoint:
    """The roller centre of a translating follower, or the foot of the cam axis on its face."""

    subject: Subject

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        cam = self.subject.cam
        lift = self.subject.state.motion.jet(phi, side, 1)[0]
        return np.asarray(cam.follower.start_arm + cam.follower.way * lift)

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self.per_coordinate(phi, phi)

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        lifts = self.subject.state.motion.jet(phi, side, 2)[1:3]
        return np.asarray(self.subject.cam.follower.way * lifts)

    def per_coordinate(self, _: FloatArray, q: FloatArray) -> ComplexArray:
        return np.full(len(q), self.subject.cam.follower.way)


@dataclass(frozen=True, slots=True)
class _RockerPoint:
    """A point of the rocker; `start` is its position at cam angle 0 relative to the pivot [mm]."""

    subject: Subject
    pivot: complex
    start: complex

    def _lever(self, q: FloatArray) -> ComplexArray:
        swing = self.subject.cam.follower.swing_sense * q
        return np.asarray(self.start * np.exp(1j * swing))

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(self.pivot + self._lever(self.subject.state.motion.jet(phi, side, 1)[0]))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self.per_coordinate(phi, self.subject.state.motion.jet(phi, side, 1)[0])

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        swing = self.subject.state.motion.jet(phi, side, 2)
        return turning(self._lever(swing[0]), self.subject.cam.follower.swing_sense * swing[1:3])

    def per_coordinate(self, _: FloatArray, q: FloatArray) -> ComplexArray:
        return np.asarray(1j * self.subject.cam.follower.swing_sense * self._lever(q))


@dataclass(frozen=True, slots=True)
class _CouplerPoint:
    """A point of the coupler: `share` is 0 at the tip of the crank, 1 at the far pin.

    `shaft` is the shaft of the crank relative to the cam axis [mm], `turn` the direction of the
    linkage's own x axis in the drawing.
    """

    subject: Subject
    linkage: Linkage
    shaft: complex
    turn: complex
    share: float

    def place(self, phi: FloatArray, side: Side) -> ComplexArray:
        pin, tip = self.linkage.joints(self.subject.state.output.jet(phi, side)[0])
        return np.asarray(self.shaft + self.turn * (tip + self.share * (pin - tip)))

    def per_lift(self, phi: FloatArray, side: Side) -> ComplexArray:
        return self._per_lift(self.subject.state.output.jet(phi, side)[0])

    def rates(self, phi: FloatArray, side: Side) -> ComplexArray:
        state = self.subject.state
        stroke, follower = state.output.jet(phi, side), state.motion.jet(phi, side, 2)
        pin, tip = self.linkage.joint_rates(stroke[0], stroke[1:3], follower[1:3])
        return np.asarray(self.turn * (tip + self.share * (pin - tip)))

    def per_coordinate(self, phi: FloatArray, q: FloatArray) -> ComplexArray:
        far = self.subject.drive.far_end
        assert far is not None  # it is on a coupler
        return self._per_lift(far.place(phi, q))

    def _per_lift(self, position: FloatArray) -> ComplexArray:
        pin, tip = joints_per_lift(self.linkage, position)
        return np.asarray(self.turn * (tip + self.share * (pin - tip)))


# -- rates ----------------------------------------------------------------------------------------
# The coordinates of the masses, as functions of cam angle and of the follower's coordinate.


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Derivatives of one coordinate x of a mass at n cam angles.

    Attributes
    ----------
    inertia : m [t], or the moment of inertia [t mm^2] if x is an angle [rad].
    first, second : (n,) x' and x'' over the cam angle [mm or rad per rad^k].
    per_lift : (n,) dx/dq over the follower's coordinate q.
    """

    inertia: float
    first: FloatArray
    second: FloatArray
    per_lift: FloatArray


Train = Callable[[FloatArray, Side], list[Rates]]
"""Gives all coordinates with an inertia at n cam angles [rad]."""


def at_follower(subject: Subject, data: MassProperties) -> float:
    """Inertia of the follower itself: its mass [t], or its moment about the pivot [t mm^2].

    The roller counts as a point mass at its centre, without the inertia of its spin.
    """
    follower = subject.cam.follower
    inertia = {"mm": data.mass, "rad": data.moment_of_inertia}[follower.lift_unit]
    return inertia + data.roller_mass * follower.reach**2


def mass_train(subject: Subject, data: MassProperties) -> DirectTrain | LinkedTrain:
    """The train of `subject` with the masses of `data`."""
    inertia = at_follower(subject, data)
    linkage = subject.drive.linkage
    if linkage is not None and data.beyond(linkage):
        return LinkedTrain(subject.state.output, linkage, inertia, data)
    return DirectTrain(subject.state.motion, inertia)


@dataclass(frozen=True, slots=True)
class DirectTrain:
    """All inertia moves along the follower's own coordinate."""

    motion: Motion
    inertia: float

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        jet = self.motion.jet(phi, side, 2)
        return [Rates(self.inertia, jet[1], jet[2], np.ones(len(phi)))]


def joints_per_lift(linkage: Linkage, position: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """dP/dq and dT/dq (n,) of the coupler's pin and tip by the follower's coordinate q."""
    # By q the far end moves at dx/dq, and the follower at 1; second derivatives do not matter.
    way = linkage.per_follower(position)
    still = np.zeros_like(way)
    pin, tip = linkage.joint_rates(
        position, np.stack((way, still)), np.stack((np.ones_like(way), still))
    )
    return pin[0], tip[0]


@dataclass(frozen=True, slots=True)
class LinkedTrain:
    """The follower, the member with the demanded motion, and the coupler as a rigid body.

    With pin P, tip of the crank T and D = P - T = l_4 exp(i v), the coupler turns at v' = Im(D'/D),
    v'' = Im(D''/D), since D'' = (i v'' - v'^2) D, and its centre of mass is C = T + lambda D (rigid
    body kinematics in complex numbers).
    """

    output: Motion
    linkage: Linkage
    inertia: float
    data: MassProperties

    def __call__(self, phi: FloatArray, side: Side) -> list[Rates]:
        return self.rates(self.output.jet(phi, side))

    def rates(self, stroke: Jet) -> list[Rates]:
        """The coordinates with the far end at `stroke` (4, n); their derivatives are by the same
        variable as those of `stroke`.
        """
        linkage, data = self.linkage, self.data
        follower = linkage.transform(stroke, 2)
        coordinates = [
            Rates(self.inertia, follower[1], follower[2], np.ones(len(follower[1]))),
            Rates(data.far(linkage), stroke[1], stroke[2], linkage.per_follower(stroke[0])),
        ]
        pin, tip = linkage.joints(stroke[0])
        rod, share = pin - tip, data.coupler_centre
        pins, tips = linkage.joint_rates(stroke[0], stroke[1:3], follower[1:3])
        rods = pins - tips
        centres = tips + share * rods
        pin_per_lift, tip_per_lift = joints_per_lift(linkage, stroke[0])
        rod_per_lift = pin_per_lift - tip_per_lift
        per_lift = tip_per_lift + share * rod_per_lift
        mass = data.coupler_mass
        # The centre of mass moves in the plane: x and y are two coordinates.
        coordinates.append(Rates(mass, centres[0].real, centres[1].real, per_lift.real))
        coordinates.append(Rates(mass, centres[0].imag, centres[1].imag, per_lift.imag))
        # D'/D has the imaginary part v', D''/D has v''.
        turns = (rods / rod).imag
        moment = data.turning(linkage)
        coordinates.append(Rates(moment, turns[0], turns[1], (rod_per_lift / rod).imag))
        return [coordinate for coordinate in coordinates if coordinate.inertia]


def reduced(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """M (n,), see `Inertia.to_follower`."""
    mass = np.zeros(len(phi))
    for coordinate in train(phi, side):
        mass += coordinate.inertia * coordinate.per_lift * coordinate.per_lift
    return mass


def reduced_mass_terms(
    train: DirectTrain | LinkedTrain, far: FarEnd | None, phi: FloatArray, q: FloatArray
) -> FloatArray:
    """(2, n) M and dM/dq / 2, see `Inertia.mass_terms`: the sums of m (dx/dq)^2 and m dx/dq
    d^2x/dq^2.
    """
    terms = np.zeros((2, len(q)))
    if far is None or isinstance(train, DirectTrain):
        # M is constant, and its derivative 0.
        terms[0] = train.inertia
        return terms
    # The jet has derivatives by q here: `first` is dx/dq, `second` is d^2x/dq^2.
    for coordinate in train.rates(far.jet(phi, q)):
        terms += (
            coordinate.inertia
            * coordinate.per_lift
            * np.stack((coordinate.first, coordinate.second))
        )
    return terms


def inertia_force(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """(4, n) coefficients of the sum of -m (d^2 x/dt^2) dx/dq at n cam angles.

    d^2 x/dt^2 = x'' omega^2 + x' alpha (VDI 2143-1, eq. 2). By Lagrange's equation it is
    -(M d^2 q/dt^2 + dM/dq (dq/dt)^2 / 2), of the reduced inertia M(q).
    """
    coefficients = np.zeros((4, len(phi)))
    for coordinate in train(phi, side):
        of_lift = -coordinate.inertia * coordinate.per_lift
        coefficients[2] += of_lift * coordinate.second
        coefficients[3] += of_lift * coordinate.first
    return coefficients


def at_cam(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """(2, n) J [t mm^2] and dJ/dphi [t mm^2/rad]: T = J omega^2 / 2 at the camshaft.

    J is the sum of m x'^2, which is M q'^2; its derivative that of 2 m x' x''.
    """
    inertia = np.zeros((2, len(phi)))
    for coordinate in train(phi, side):
        inertia[0] += coordinate.inertia * coordinate.first * coordinate.first
        inertia[1] += 2.0 * coordinate.inertia * coordinate.first * coordinate.second
    return inertia
