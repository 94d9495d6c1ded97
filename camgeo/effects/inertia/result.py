"""Inertia: the moving masses, their inertia forces, and their inertia reduced to follower and cam.

The motion of all masses is determined by the cam angle. Their generalised force on the follower
follows from d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and
their inertia reduced to the follower or the camshaft follows from their kinetic energy. VDI 2142
and textbooks of machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design
of Machinery", chapters on dynamics and cam dynamics) do the same for a single mass.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    reduced_at,
    train_of,
)
from camgeo.effects.results import Inertia
from camgeo.effects.wording import FORCES, KG_M2, MASSES, Label, extreme_finding, extreme_findings
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes, piecewise_highest
from camgeo.wording import at_cam_angles, cam_angle

if TYPE_CHECKING:
    from camgeo.effects.effect import Request, Subject
    from camgeo.effects.inertia.table import MassProperties
    from camgeo.motion.time_course import TimeCourse

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
    train, linkage = train_of(subject, data), subject.drive.linkage
    if data.beyond(linkage):
        refuse_locked(subject, "'s mass")

    lift = subject.cam.lift_unit
    report = _Report(subject, request.course, train, MASSES[lift], FORCES[lift])
    inertia = Inertia(
        force=Force("inertia", partial(inertia_force, train)),
        masses=masses_of(subject, data),
        moved=at_follower(subject, data) if linkage is None else data.far(linkage),
        coupler_moment=0.0 if linkage is None else data.turning(linkage),
        to_follower=partial(reduced, train),
        at=partial(reduced_at, train, subject.drive.far_end),
        columns=report.columns(),
    )
    found = report.findings(shocks(subject, inertia.to_follower))
    return replace(inertia, findings=(*found, *lacking(subject, data)))


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
        found = at_rates(inertia_force(self.train, phi, side), self.course.rates(phi, side))
        return found * self.acting.scale

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
        at = f"{self.reduced.word} reduced to the follower"
        found = []
        if isinstance(self.train, DirectTrain):  # constant over the cam angle
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
                f"the inertia {what} is infinite at a shock {at_cam_angles(angle)}; elsewhere the"
                f" largest is {worst.value:.6g} {unit} at {cam_angle(worst.place)} deg"
            ),
            unit=unit,
            cam_angle=angle,
        )
