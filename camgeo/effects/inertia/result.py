"""Inertia: the masses that are moved, their inertia forces, and what they amount to elsewhere.

All masses move as the cam angle says, so that their generalised force on the follower follows from
d'Alembert's principle in Lagrange's form (virtual work of -m x'' and -J v''), and their inertia as
felt at the follower or at the camshaft from their kinetic energy. VDI 2142 and the textbooks of
machine dynamics (Volmer, "Getriebetechnik", reduction of masses; Norton, "Design of Machinery",
the chapters on dynamics and cam dynamics) say the same for the single mass.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from camgeo.effects.force import Force
from camgeo.effects.inertia.masses import masses_of
from camgeo.effects.inertia.rates import at_follower, inertia_force, reduced, train_of
from camgeo.effects.inertia.told import TERMS, Told, lacking
from camgeo.effects.locked import refuse_locked
from camgeo.effects.results import Inertia

if TYPE_CHECKING:
    from camgeo.effects.effect import Request, Subject
    from camgeo.effects.inertia.spec import InertiaSpec


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
    train = train_of(subject, spec)
    if spec.beyond(subject.cam.drive.linkage):
        refuse_locked(subject, "'s mass")

    told = Told(subject, request.course, train, TERMS[subject.cam.lift_unit])
    return Inertia(
        force=Force("inertia", partial(inertia_force, train)),
        masses=masses_of(subject, spec),
        moved=_moved(subject, spec),
        to_follower=partial(reduced, train),
        findings=(*told.findings(), *lacking(subject, spec)),
        columns=told.columns(),
    )


def _moved(subject: Subject, spec: InertiaSpec) -> float:
    if subject.cam.drive.linkage is None:
        return at_follower(subject, spec)
    return spec.far(subject.cam.drive.linkage)
