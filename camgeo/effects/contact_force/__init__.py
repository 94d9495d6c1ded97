"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.contact_force.balance import FLANKS, INNER, OUTER, Balance, Friction
from camgeo.effects.contact_force.places import refuse_jamming, smooth_edges
from camgeo.effects.effect import Column, Effect, Request, toucher
from camgeo.effects.force import Force
from camgeo.motion.joints import breaks
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.numeric.peaks import piecewise_extremes
from camgeo.units import TURN

FORCES: Final = ("inertia", "gravity", "load", "spring")
"""Effects that are forces on the follower, besides friction."""

SHOCK: Final = 0
"""Order up to which the motion is continuous where its velocity jumps."""


class _Inertia(Protocol):
    to_follower: Callable[[FloatArray, Side], FloatArray]


@dataclass(frozen=True, slots=True)
class Spec:
    """What the scene says: `limit` is the largest force allowed [N], None for none."""

    limit: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ContactForce:
    """The normal force on the follower, positive where the inner flank carries.

    Attributes
    ----------
    findings, columns, error : see `camgeo.effects.effect.Result`.
    balance : the forces on the follower.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which the force is smooth and keeps its
        sign.
    extremes : smallest and largest force [N] of the turn, signed.
    """

    findings: tuple[Finding, ...]
    columns: tuple[Column, ...]
    balance: Balance
    edges: FloatArray
    extremes: Extremes
    error: float | None = None

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
        """(n,) [1 or mm/rad] R per unit of |N| on the inner (+1) or outer (-1) flank."""
        return self.balance.bracket(phi, side, sense)

    def normal(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) N [N] at the scene's speed, or at rest if it has none."""
        return self.balance.normal(phi, side, self.balance.rates(phi))

    def normal_at(
        self, phi: FloatArray, side: Side, omega: FloatArray, alpha: FloatArray
    ) -> FloatArray:
        """(n,) N [N] at the speeds `omega` [rad/s] and accelerations `alpha` [rad/s^2], (n,)."""
        return self.balance.normal(phi, side, np.stack((omega, alpha)))


def parse(table: Mapping[str, Any]) -> Spec:
    """From the table of the scene."""
    return Spec(table.get("limit"))


def compute(request: Request) -> ContactForce:
    """The contact force.

    Raises
    ------
    EffectError
        "jamming", if the follower jams anywhere in the turn; if the pitch curve has a cusp.
    """
    subject, results = request.subject, request.results
    friction: Friction | None = results.get("friction")
    forces: list[Force] = [results[name].force for name in FORCES if name in results]
    if friction is not None:
        forces.append(friction.force)
    if subject.follower.is_flat:
        from camgeo.effects.face import require_convex

        require_convex(subject, "contact force")
    balance = Balance(subject, tuple(forces), friction)
    edges = smooth_edges(balance)
    refuse_jamming(balance, edges)

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        return balance.normal(phi, side, balance.rates(phi))

    limit: float | None = request.spec.limit
    inside = np.concatenate([force.borders for force in forces] or [np.empty(0)])
    signed = -limit if limit is not None and subject.contact == "outer" else limit
    extremes = piecewise_extremes(normal, edges)
    found = _findings(extremes, subject.contact, limit, toucher(subject))
    return ContactForce(
        findings=(*found, *_shocks(request)),
        columns=(Column("contact force", "N", normal, signed, inside),),
        balance=balance,
        edges=edges,
        extremes=extremes,
    )


def _findings(extremes: Extremes, contact: str, limit: float | None, what: str) -> list[Finding]:
    """Largest and smallest force of the flank that has to carry; in a groove that of each flank."""
    low, high = extremes.lowest, extremes.highest
    mirrored = Extreme(-low.value, low.place)
    if contact == "inner":
        return [_largest(high, INNER, limit), _smallest(low, INNER, what)]
    if contact == "outer":
        return [
            _largest(mirrored, OUTER, limit),
            _smallest(Extreme(-high.value, high.place), OUTER, what),
        ]
    both = sorted(((high, INNER), (mirrored, OUTER)), key=lambda each: -each[0].value)
    found = [_largest(*both[0], limit)]
    for extreme, sense in both:
        if extreme.value > 0.0:
            found.append(_on_flank(extreme, sense))
    return found


def _largest(extreme: Extreme, sense: int, limit: float | None) -> Finding:
    broken = limit is not None and extreme.value > limit
    held = "" if limit is None else f", {'above' if broken else 'at most'} {limit:g} N"
    return Finding(
        name="largest-contact-force",
        severity="broken" if broken else "ok",
        sentence=f"largest contact force {_told(extreme, sense)}{held}",
        value=extreme.value,
        limit=limit,
        unit="N",
        cam_angle=extreme.place % TURN,
    )


def _smallest(extreme: Extreme, sense: int, what: str) -> Finding:
    lost = extreme.value < 0.0
    tail = f": the {what} is not held to its flank there" if lost else ""
    return Finding(
        name="smallest-contact-force",
        severity="warning" if lost else "ok",
        sentence=f"smallest contact force {_told(extreme, sense)}{tail}",
        value=extreme.value,
        unit="N",
        cam_angle=extreme.place % TURN,
    )


def _on_flank(extreme: Extreme, sense: int) -> Finding:
    return Finding(
        name=f"largest-contact-force-{FLANKS[sense]}",
        severity="ok",
        sentence=f"largest contact force {_told(extreme, sense)}",
        value=extreme.value,
        unit="N",
        cam_angle=extreme.place % TURN,
    )


def _told(extreme: Extreme, sense: int) -> str:
    angle = math.degrees(extreme.place % TURN)
    return f"on the {FLANKS[sense]} flank {extreme.value:.6g} N at cam angle {angle:.4f} deg"


def _shocks(request: Request) -> list[Finding]:
    """Where the velocity jumps: with a mass the force is infinite there, and not in the values."""
    inertia: _Inertia | None = request.results.get("inertia")
    if inertia is None:
        return []
    found = []
    for joint in breaks(request.subject.plan):
        angle = joint.cam_angle
        if joint.order >= SHOCK + 1 or not inertia.to_follower(np.array([angle]), "right")[0] > 0.0:
            continue
        found.append(
            Finding(
                name="shock",
                severity="broken",
                sentence=(
                    f"the velocity jumps at cam angle {math.degrees(angle):.4f} deg: the contact"
                    " force of the masses is infinite for a moment, which is in none of the values"
                ),
                cam_angle=angle,
            )
        )
    return found


EFFECT: Final = Effect(
    name="contact-force",
    title="force between cam and follower along their common normal",
    compute=compute,
    parse=parse,
    uses=(*FORCES, "friction"),
    keys=(tuple(f"effects.{name}" for name in FORCES),),
)
