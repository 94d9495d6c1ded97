"""Effect `contact-force`: the force between cam and follower along their common normal."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from camgeo.check.finding import Finding, Severity, held
from camgeo.effects.bearing_friction import BearingFriction
from camgeo.effects.contact_force import FORCES, ForceLimit
from camgeo.effects.contact_force.balance import (
    ForceBalance,
    edges_of,
    load_edges,
    refuse_jamming,
)
from camgeo.effects.effect import Column, Quantity, Request, Subject
from camgeo.effects.force import Force, all_borders
from camgeo.effects.immovable import shocks
from camgeo.effects.loads import Loads
from camgeo.effects.results import (
    FRICTION,
    GRAVITY,
    INERTIA,
    SPRING,
    VIBRATION,
    ContactForce,
    Inertia,
)
from camgeo.effects.touching import (
    INNER,
    OUTER,
    holds_both_ways,
    lost_contact,
    require_convex,
    sides_of,
)
from camgeo.effects.wording import angles, at, by_place, placed, resolved_ends
from camgeo.motion.kept import MOST_KEPT, recalling
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, Extremes, piecewise_extremes

if TYPE_CHECKING:
    from camgeo.effects.elastic import ElasticTrain


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
    bearings = bearings_of(request, tuple(forces))
    rigid = ForceBalance(subject, tuple(forces), friction, bearings)
    inertia, vibration = request.results.get(INERTIA), request.results.get(VIBRATION)
    behind = None if vibration is None else vibration.behind
    balance = rigid
    if behind is not None:
        train = behind.force(subject.state.smooth_angles)
        balance = rigid.beside(train)
    edges = edges_of(balance)
    refuse_jamming(balance, edges)
    edges = load_edges(balance, edges)

    @recalling  # all effects of the scene ask for it, most of them at the same angles
    def normal(phi: FloatArray, side: Side) -> FloatArray:
        return balance.normal(phi, side, balance.rates(phi, side))

    @recalling
    def demand(phi: FloatArray, side: Side) -> FloatArray:
        return balance.demand(phi, side, balance.rates(phi, side))

    limit = request.data.limit
    extremes = piecewise_extremes(normal, edges)
    found = force_findings(extremes, subject, limit)
    columns = _columns(subject, normal, limit, all_borders(forces))
    struck = struck_by_jumps(inertia, behind)
    made = ContactForce(
        findings=(
            *found,
            *shock_findings(subject, struck),
        ),
        columns=columns,
        lost_contact=lost_contact(subject, normal, extremes, edges, struck),
        forces=balance.forces,
        friction=friction,
        edges=edges,
        extremes=extremes,
        required=rigid.required,
        normal=normal,
        normal_at=rigid.normal,
        bracket=balance.bracket,
        demand=demand,
        bearings=rigid.bearings,
        released=rigid.released,
        beside=lambda force: beside(made, rigid, force),
        struck=struck,
        behind=behind,
    )
    return made


def beside(found: ContactForce, rigid: ForceBalance, force: Force) -> ContactForce:
    """See `ContactForce.beside`; `rigid` is the balance with a rigid train."""
    balance = rigid.beside(force)
    return replace(
        found,
        forces=balance.forces,
        bearings=balance.bearings,
        required=balance.required,
        normal_at=balance.normal,
        released=balance.released,
    )


def bearings_of(request: Request[ForceLimit], forces: tuple[Force, ...]) -> BearingFriction | None:
    """Friction under the loads of pivot or guide with these `forces`; None if the scene has none.

    Raises
    ------
    EffectError
        If the follower cannot move the far end of its linkage, on which something acts.
    """
    results, subject = request.results, request.subject
    friction = results.get(FRICTION)
    if friction is None or friction.rubbing is None:
        return None
    inertia, gravity = results.get(INERTIA), results.get(GRAVITY)
    coupler = None
    if subject.drive.linkage is not None:
        # few followers have a linkage
        from camgeo.effects.coupler import acts_beyond, coupler_of

        if acts_beyond(forces, inertia):
            coupler = coupler_of(subject, subject.drive.linkage, forces, inertia, gravity)
    loads = Loads(subject, inertia, gravity, results.get(SPRING), coupler)
    return BearingFriction(
        friction.rubbing,
        recalling(partial(loads.on_bearings, friction), MOST_KEPT),
        partial(loads.per_far, friction),
    )


def struck_by_jumps(inertia: Inertia | None, behind: ElasticTrain | None) -> Quantity | None:
    """See `ContactForce.struck`."""
    if inertia is None:
        return None
    if behind is None:
        return inertia.to_follower

    def in_front(phi: FloatArray, side: Side) -> FloatArray:
        return inertia.to_follower(phi, side) - behind.reduced(phi, side)

    return in_front


def _columns(
    subject: Subject, normal: Quantity, limit: float | None, borders: FloatArray
) -> tuple[Column, ...]:
    """The signed force; between two discs, or in a yoke, that of each side, which only pushes."""
    if subject.returning is None:
        signed = None if limit is None else subject.cam.contact.push * limit
        return (Column("contact force", "N", normal, signed, borders),)

    def on_main(phi: FloatArray, side: Side) -> FloatArray:
        return np.maximum(normal(phi, side), 0.0)

    def on_return(phi: FloatArray, side: Side) -> FloatArray:
        return np.maximum(-normal(phi, side), 0.0)

    names, _ = sides_of(subject)
    return (
        Column(f"{names[INNER]} contact force", "N", on_main, limit, borders),
        Column(f"{names[OUTER]} contact force", "N", on_return, limit, borders),
    )


def force_findings(extremes: Extremes, subject: Subject, limit: float | None) -> list[Finding]:
    """Largest and smallest force on the flank in use, or the largest force of each side.

    The sides are the flanks of a groove, the discs of a conjugate pair or those of a yoke.
    """
    names, noun = sides_of(subject)
    extremes = resolved_ends(extremes)
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


def shock_findings(subject: Subject, struck: Quantity | None) -> list[Finding]:
    """Where the velocity of a mass jumps: the force is infinite there, and not in the values."""
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
        for places in by_place(shocks(subject, struck))
    ]
