"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.effects.contact_force import FORCES, Spec
from camgeo.effects.contact_force.balance import Balance
from camgeo.effects.contact_force.findings import force_findings, shock_findings
from camgeo.effects.contact_force.places import refuse_jamming, smooth_edges
from camgeo.effects.effect import Column, Quantity, Request, Result, Subject
from camgeo.effects.face import require_convex
from camgeo.effects.force import Force, all_borders
from camgeo.effects.results import FRICTION, Friction
from camgeo.effects.results import ContactForce as Asked
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extremes
from camgeo.numeric.peaks import piecewise_extremes


@dataclass(frozen=True, slots=True, eq=False)
class ContactForce(Result):
    """The normal force on the follower, positive where the inner flank carries.

    Of a conjugate pair it is positive where the main disc carries, negative where the return disc
    does; the other one carries nothing then.

    Attributes
    ----------
    balance : the forces on the follower.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the force is smooth and keeps its
        sign.
    extremes : smallest and largest force [N] of the turn, signed.
    """

    balance: Balance
    edges: FloatArray
    extremes: Extremes

    @property
    def forces(self) -> tuple[Force, ...]:
        """All forces on the follower but that of the contact."""
        return self.balance.forces

    @property
    def friction(self) -> Friction | None:
        """The result of the effect `friction`, None if the scene does not name it."""
        return self.balance.friction

    def required(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) coefficients of the generalised force R that the contact has to give."""
        return self.balance.required(phi, side)

    def bracket(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) [1 or mm/rad] R per unit of |N| on the side `sense`, see `carrier`."""
        return self.balance.bracket(phi, side, sense)

    def normal(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) N [N] at the scene's speed, or at rest if it has none."""
        return self.balance.normal(phi, side, self.balance.rates(phi))

    def normal_at(
        self, phi: FloatArray, side: Side, omega: FloatArray, alpha: FloatArray
    ) -> FloatArray:
        """(n,) N [N] at the speeds `omega` [rad/s] and accelerations `alpha` [rad/s^2], (n,)."""
        return self.balance.normal(phi, side, np.stack((omega, alpha)))


def compute(request: Request[Spec]) -> Asked:
    """The contact force.

    Raises
    ------
    EffectError
        "jamming", if the follower jams anywhere in the turn; if the pitch curve has a cusp.
    """
    subject, friction = request.subject, request.results.get(FRICTION)
    acting = [request.results.get(key) for key in FORCES]
    forces = [each.force for each in acting if each is not None]
    if friction is not None:
        forces.append(friction.force)
    require_convex(subject, "contact force")
    balance = Balance(subject, tuple(forces), friction)
    edges = smooth_edges(balance)
    refuse_jamming(balance, edges)

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        return balance.normal(phi, side, balance.rates(phi))

    limit = request.spec.limit
    extremes = piecewise_extremes(normal, edges)
    found = force_findings(extremes, subject, limit)
    return ContactForce(
        findings=(*found, *shock_findings(request)),
        columns=_columns(subject, normal, limit, all_borders(forces)),
        balance=balance,
        edges=edges,
        extremes=extremes,
    )


def _columns(
    subject: Subject, normal: Quantity, limit: float | None, borders: FloatArray
) -> tuple[Column, ...]:
    """The signed force; of a conjugate pair that of each disc, which only pushes."""
    if subject.returning is None:
        signed = None if limit is None else subject.cam.contact.push * limit
        return (Column("contact force", "N", normal, signed, borders),)

    def on_main(phi: FloatArray, side: Side) -> FloatArray:
        return np.maximum(normal(phi, side), 0.0)

    def on_return(phi: FloatArray, side: Side) -> FloatArray:
        return np.maximum(-normal(phi, side), 0.0)

    return (
        Column("main contact force", "N", on_main, limit, borders),
        Column("return contact force", "N", on_return, limit, borders),
    )
