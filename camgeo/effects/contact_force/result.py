"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

import numpy as np

from camgeo.check.finding import Finding, Severity, held
from camgeo.effects.contact_force import FORCES, ForceLimit
from camgeo.effects.contact_force.balance import ForceBalance, edges_of, refuse_jamming
from camgeo.effects.effect import Column, Quantity, Request, Subject
from camgeo.effects.force import all_borders, total
from camgeo.effects.immovable import shocks
from camgeo.effects.results import FRICTION, INERTIA, ContactForce
from camgeo.effects.touching import (
    INNER,
    OUTER,
    holds_both_ways,
    lost_contact,
    require_convex,
    sides_of,
)
from camgeo.effects.wording import angles, at, by_place, placed
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes


def compute(request: Request[ForceLimit]) -> ContactForce:
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
    balance = ForceBalance(subject, tuple(forces), friction)
    edges = edges_of(balance)
    refuse_jamming(balance, edges)

    def normal(phi: FloatArray, side: Side) -> FloatArray:
        return balance.normal(phi, side, balance.rates(phi))

    def required(phi: FloatArray, side: Side) -> FloatArray:
        return -total(forces, phi, side)

    limit = request.data.limit
    extremes = piecewise_extremes(normal, edges)
    found = force_findings(extremes, subject, limit)
    inertia = request.results.get(INERTIA)
    return ContactForce(
        findings=(*found, *shock_findings(request)),
        columns=_columns(subject, normal, limit, all_borders(forces)),
        lost_contact=lost_contact(subject, normal, extremes, edges, inertia),
        forces=balance.forces,
        friction=friction,
        edges=edges,
        extremes=extremes,
        required=required,
        normal=normal,
        normal_at=balance.normal,
        bracket=balance.bracket,
    )


def _columns(
    subject: Subject, normal: Quantity, limit: float | None, borders: FloatArray
) -> tuple[Column, ...]:
    """The signed force; for a conjugate pair that of each disc, which only pushes."""
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


def force_findings(extremes: Extremes, subject: Subject, limit: float | None) -> list[Finding]:
    """Largest and smallest force on the flank in use, or the largest force of each side.

    The sides are the flanks of a groove or the discs of a conjugate pair.
    """
    names, noun = sides_of(subject)
    low, high = extremes.lowest, extremes.highest
    mirrored = Extreme(-low.value, low.place)
    if not holds_both_ways(subject):
        inner = subject.cam.contact.runs_inside
        where = f"the {subject.cam.contact} flank"
        smallest = low if inner else Extreme(-high.value, high.place)
        largest = _largest(high if inner else mirrored, where, limit)
        return [largest, _smallest(smallest, where, subject.cam.follower.touching)]
    both = sorted(((high, INNER), (mirrored, OUTER)), key=lambda each: -each[0].value)
    found = [_largest(both[0][0], f"the {names[both[0][1]]} {noun}", limit)]
    for extreme, sense in both:
        if extreme.value > 0.0:
            text = f"largest contact force {_value(extreme, f'the {names[sense]} {noun}')}"
            found.append(placed(f"largest-contact-force-{names[sense]}", text, extreme, "N"))
    return found


def _largest(extreme: Extreme, where: str, limit: float | None) -> Finding:
    text = f"largest contact force {_value(extreme, where)}"
    return held("largest-contact-force", text, extreme.value, limit, "N", extreme.place)


def _smallest(extreme: Extreme, where: str, what: str) -> Finding:
    lost = extreme.value < 0.0
    tail = f": the {what} is not held on its flank there" if lost else ""
    sentence = f"smallest contact force {_value(extreme, where)}{tail}"
    severity: Severity = "warning" if lost else "ok"
    return placed("smallest-contact-force", sentence, extreme, "N", severity=severity)


def _value(extreme: Extreme, where: str) -> str:
    return f"on {where} {extreme.value:.6g} N {at(extreme.place)}"


def shock_findings(request: Request[ForceLimit]) -> list[Finding]:
    """Where the velocity of a mass jumps: the force is infinite there, and not in the values."""
    inertia = request.results.get(INERTIA)
    return [
        Finding(
            name="shock",
            severity="broken",
            sentence=(
                f"the velocity jumps {angles(places)}: the inertia force at the contact is infinite"
                " for an instant, and not included in any value"
            ),
            cam_angle=places[0],
        )
        for places in by_place(shocks(request.subject, inertia))
    ]
