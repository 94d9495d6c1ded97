"""Findings and columns of the inertia."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Column
from camgeo.effects.force import at_rates
from camgeo.effects.inertia.rates import DirectTrain, Train, at_cam, inertia_force, reduced
from camgeo.effects.told import extreme_finding, extreme_findings
from camgeo.motion.joints import breaks
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import piecewise_extremes

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.inertia.spec import InertiaSpec
    from camgeo.mechanism.kind import Unit
    from camgeo.motion.time_course import TimeCourse

KG: Final = 1e3
"""Kilograms a tonne."""

KG_M2: Final = 1e-3
"""kg m^2 a t mm^2."""

N_M: Final = 1e-3
"""N m a N mm."""

WRITTEN: Final = 1e-3
"""Share by which a moment of inertia that was written in a few digits may be too small."""


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
class Terms:
    """What the inertia of a follower and its force are called, and their units.

    `mass_scale` and `force_scale` are the figures told a unit inside.
    """

    mass: str
    mass_unit: str
    mass_scale: float
    force: str
    force_unit: str
    force_scale: float


TERMS: Final[Mapping[Unit, Terms]] = {
    "mm": Terms("mass", "kg", KG, "force", "N", 1.0),
    "rad": Terms("moment of inertia", "kg m^2", KG_M2, "torque", "N m", N_M),
}
"""By the unit of the follower's lift."""


@dataclass(frozen=True, slots=True)
class Told:
    """Findings and columns."""

    subject: Subject
    course: TimeCourse
    train: Train
    terms: Terms

    def mass(self, phi: FloatArray, side: Side) -> FloatArray:
        """Reduced to the follower, in `unit`."""
        return reduced(self.train, phi, side) * self.terms.mass_scale

    def at_cam(self, phi: FloatArray, side: Side) -> FloatArray:
        """Reduced to the camshaft [kg m^2]."""
        return np.asarray(KG_M2 * at_cam(self.train, phi, side)[0])

    def force(self, phi: FloatArray, side: Side) -> FloatArray:
        """At the speed of the scene [N or N m]."""
        found = at_rates(inertia_force(self.train, phi, side), self.course.rates(phi))
        return found * self.terms.force_scale

    def columns(self) -> tuple[Column, ...]:
        terms = self.terms
        return (
            Column(f"reduced {terms.mass}", terms.mass_unit, self.mass),
            Column(f"inertia {terms.force}", terms.force_unit, self.force),
        )

    def findings(self) -> tuple[Finding, ...]:
        edges = self.subject.cam.drive.smooth_angles
        largest = piecewise_extremes(self.at_cam, edges).highest
        name = f"reduced-{self.terms.mass.replace(' ', '-')}"
        at = f"{self.terms.mass} reduced to the follower"
        found = []
        if isinstance(self.train, DirectTrain):  # the same at all cam angles
            value = float(self.mass(np.zeros(1), "right")[0])
            sentence = f"{at} {value:.6g} {self.terms.mass_unit}"
            found.append(Finding(name, "ok", sentence, value=value, unit=self.terms.mass_unit))
        else:
            masses = piecewise_extremes(self.mass, edges)
            found += extreme_findings(name, at, masses, self.terms.mass_unit)
        found.append(
            extreme_finding(
                "largest-moment-at-cam",
                "largest moment of inertia reduced to the camshaft",
                largest,
                "kg m^2",
            )
        )
        found.append(self._largest_force(edges))
        return tuple(found)

    def _largest_force(self, edges: FloatArray) -> Finding:
        forces = piecewise_extremes(self.force, edges)
        worst = max(forces.lowest, forces.highest, key=lambda end: abs(end.value))
        unit, what = self.terms.force_unit, self.terms.force
        shocks = [
            each
            for each in breaks(self.subject.cam.drive.plan)
            if each.order < 1 and self.mass(np.array([each.cam_angle]), "right")[0] > 0.0
        ]
        if not shocks:
            return extreme_finding("largest-inertia-force", f"largest inertia {what}", worst, unit)
        angle = shocks[0].cam_angle
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
