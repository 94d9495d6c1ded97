"""Inertia: the masses that are moved, their inertia forces, and what they amount to elsewhere.

All masses move as the cam angle says, so that their generalised force on the follower follows from
d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and their inertia as
felt at the follower or at the camshaft from their kinetic energy. VDI 2142 and the textbooks of
machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design of Machinery",
the chapters on dynamics and cam dynamics) say the same for the single mass.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column
from camgeo.effects.force import Force, at_rates
from camgeo.effects.immovable import refuse_locked, shocks
from camgeo.effects.inertia.masses import masses_of
from camgeo.effects.inertia.rates import (
    DirectTrain,
    Train,
    at_cam,
    at_follower,
    inertia_force,
    reduced,
    train_of,
)
from camgeo.effects.results import Inertia
from camgeo.effects.told import FORCES, KG, KG_M2, Shown, extreme_finding, extreme_findings
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import piecewise_extremes

if TYPE_CHECKING:
    from camgeo.effects.effect import Request, Subject
    from camgeo.effects.inertia.spec import InertiaSpec
    from camgeo.mechanism.kind import Unit
    from camgeo.motion.time_course import TimeCourse

WRITTEN: Final = 1e-3
"""Share by which a moment of inertia that was written in a few digits may be too small."""

MASSES: Final[Mapping[Unit, Shown]] = {
    "mm": Shown("mass", "kg", KG),
    "rad": Shown("moment of inertia", "kg m^2", KG_M2),
}
"""The inertia of a follower, by the unit of its lift."""


def compute(request: Request[InertiaSpec]) -> Inertia:
    """The inertia of what `request.spec` names.

    Raises
    ------
    GeometryError
        With the key, if the mechanism has no part of which the scene gives the mass.
    EffectError
        If a mass behind a linkage cannot be moved by the follower at some cam angle.
    """
    subject, spec = request.subject, request.spec
    train, linkage = train_of(subject, spec), subject.drive.linkage
    if spec.beyond(linkage):
        refuse_locked(subject, "'s mass")

    lift = subject.cam.lift_unit
    told = Told(subject, request.course, train, MASSES[lift], FORCES[lift])
    inertia = Inertia(
        force=Force("inertia", partial(inertia_force, train)),
        masses=masses_of(subject, spec),
        moved=at_follower(subject, spec) if linkage is None else spec.far(linkage),
        to_follower=partial(reduced, train),
        columns=told.columns(),
    )
    found = told.findings(shocks(subject, inertia))
    return replace(inertia, findings=(*found, *lacking(subject, spec)))


def lacking(subject: Subject, spec: InertiaSpec) -> tuple[Finding, ...]:
    """A warning if the rocker's moment of inertia is less than its mass alone has by its distance.

    By the parallel axis theorem (Steiner) the moment about the pivot is m r^2 and what the body has
    about its centre of mass.
    """
    pivot = subject.cam.follower.pivot
    if spec.rocker_centre is None or pivot is None:
        return ()
    least = spec.rocker_mass * abs(spec.rocker_centre - pivot) ** 2
    if spec.moment_of_inertia >= least * (1.0 - WRITTEN):
        return ()
    value, bound = KG_M2 * spec.moment_of_inertia, KG_M2 * least
    return (
        Finding(
            name="rocker-moment-of-inertia",
            severity="warning",
            sentence=(
                f"the rocker's moment of inertia {value:.6g} kg m^2 is less than the"
                f" {bound:.6g} kg m^2 that its mass has about the pivot as a point in its centre"
            ),
            value=value,
            limit=bound,
            unit="kg m^2",
        ),
    )


@dataclass(frozen=True, slots=True)
class Told:
    """Findings and columns."""

    subject: Subject
    course: TimeCourse
    train: Train
    reduced: Shown
    acting: Shown

    def mass(self, phi: FloatArray, side: Side) -> FloatArray:
        """Reduced to the follower, in `unit`."""
        return reduced(self.train, phi, side) * self.reduced.scale

    def at_cam(self, phi: FloatArray, side: Side) -> FloatArray:
        """Reduced to the camshaft [kg m^2]."""
        return np.asarray(KG_M2 * at_cam(self.train, phi, side)[0])

    def force(self, phi: FloatArray, side: Side) -> FloatArray:
        """At the speed of the scene [N or N m]."""
        found = at_rates(inertia_force(self.train, phi, side), self.course.rates(phi))
        return found * self.acting.scale

    def columns(self) -> tuple[Column, ...]:
        return (
            Column(f"reduced {self.reduced.word}", self.reduced.unit, self.mass),
            Column(f"inertia {self.acting.word}", self.acting.unit, self.force),
        )

    def findings(self, shocks: Sequence[float]) -> tuple[Finding, ...]:
        """All; `shocks` are the cam angles [rad] of those."""
        edges, unit = self.subject.drive.smooth_angles, self.reduced.unit
        largest = piecewise_extremes(self.at_cam, edges).highest
        name = f"reduced-{self.reduced.word.replace(' ', '-')}"
        at = f"{self.reduced.word} reduced to the follower"
        found = []
        if isinstance(self.train, DirectTrain):  # the same at all cam angles
            value = float(self.mass(np.zeros(1), "right")[0])
            sentence = f"{at} {value:.6g} {unit}"
            found.append(Finding(name, "ok", sentence, value, unit=unit))
        else:
            masses = piecewise_extremes(self.mass, edges)
            found += extreme_findings(name, at, masses, unit)
        found.append(
            extreme_finding(
                "largest-moment-at-cam",
                "largest moment of inertia reduced to the camshaft",
                largest,
                "kg m^2",
            )
        )
        found.append(self._largest_force(edges, shocks))
        return tuple(found)

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
                f"the inertia {what} is infinite at a shock at cam angle"
                f" {math.degrees(angle):.6g} deg; elsewhere largest {worst.value:.6g} {unit} at"
                f" {math.degrees(worst.place):.6g} deg"
            ),
            unit=unit,
            cam_angle=angle,
        )
