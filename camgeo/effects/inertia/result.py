"""Inertia: the masses that are moved, their inertia forces, and what they amount to elsewhere.

All masses move as the cam angle says, so that their generalised force on the follower follows from
d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and their inertia as
felt at the follower or at the camshaft from their kinetic energy. VDI 2142 and the textbooks of
machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design of Machinery",
the chapters on dynamics and cam dynamics) say the same for the single mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from camgeo.effects.effect import Result
from camgeo.effects.force import Force
from camgeo.effects.inertia.masses import Mass, masses_of
from camgeo.effects.inertia.rates import Train, at_follower, inertia_force, reduced, train_of
from camgeo.effects.inertia.told import TERMS, Told, lacking
from camgeo.effects.locked import refuse_locked
from camgeo.effects.results import Inertia as Asked
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:
    from camgeo.effects.effect import Request, Subject
    from camgeo.effects.inertia.spec import InertiaSpec


@dataclass(frozen=True, slots=True, eq=False)
class Inertia(Result):
    """What `compute` gives.

    Attributes
    ----------
    force : the generalised inertia force on the follower [N or N mm]: c2 and c3.
    train : the coordinates in which masses move.
    masses : those with a weight, and their places; 0 is left out.
    moved : what moves with the demanded motion [t, or t mm^2 if it turns].
    """

    force: Force
    train: Train
    masses: tuple[Mass, ...]
    moved: float

    def to_follower(self, phi: FloatArray, side: Side = "right") -> FloatArray:
        """M(q) (n,) [t, or t mm^2 for a rocker] at n cam angles: T = M (dq/dt)^2 / 2.

        The sum of m (dx/dq)^2 over all coordinates: equal kinetic energy (Volmer,
        "Getriebetechnik", on reduced masses; Norton, "Cam Design and Manufacturing Handbook", on
        effective masses in dynamic models of cam systems).
        """
        return reduced(self.train, phi, side)


def compute(request: Request[InertiaSpec]) -> Asked:
    """The inertia of what `request.spec` names.

    Raises
    ------
    GeometryError
        With the key, if the mechanism has no part of which the scene gives the mass.
    EffectError
        If a mass behind a linkage cannot be moved by the follower at some cam angle.
    """
    subject, spec = request.subject, request.spec
    train = train_of(subject, spec)
    if spec.beyond(subject.cam.drive.linkage):
        refuse_locked(subject, "'s mass")

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        return inertia_force(train, phi, side)

    force = Force("inertia", coefficients)
    told = Told(subject, request.course, train, TERMS[subject.cam.lift_unit])
    return Inertia(
        force=force,
        train=train,
        masses=masses_of(subject, spec),
        moved=_moved(subject, spec),
        findings=(*told.findings(), *lacking(subject, spec)),
        columns=told.columns(),
    )


def _moved(subject: Subject, spec: InertiaSpec) -> float:
    if subject.cam.drive.linkage is None:
        return at_follower(subject, spec)
    return spec.far(subject.cam.drive.linkage)
