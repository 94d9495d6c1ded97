"""Power balance: the power of the camshaft, and what each force and each friction takes of it.

By the principle of virtual work the camshaft provides, per unit of cam angle,

    T = -sum Q_i q' + |N| (m - f q') + lambda sum |L_j| |q'|,

with the generalised forces Q_i on the follower's coordinate q; with the force f on q and the torque
m on the cam by which friction of roller or face acts, per unit of the contact force N; and with the
loads L_j that rub in pivot or guide at the lever lambda (`camgeo.dynamics.effects.loads`). Each
term but T is computed from the forces in its own place, none as the rest of the sum (Norton, Cam
Design and Manufacturing Handbook, chapters on dynamics). What a force takes is positive where it
receives power: of inertia and springs it comes back within a turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.contact import on_carrier
from camgeo.dynamics.effects.effect import (
    Bound,
    Column,
    Quantity,
    Request,
    Result,
    Subject,
    driving_slider,
)
from camgeo.dynamics.effects.forces import Force, at_rates, rates_of
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    DRIVE_TORQUE,
    LOAD,
    ContactForce,
    Friction,
)
from camgeo.dynamics.effects.wording import N_M, extreme_findings, missed
from camgeo.numeric.arrays import FloatArray, Side, resolved
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.quadrature import Integral, piecewise_integral
from camgeo.units import TURN


@dataclass(frozen=True, slots=True, eq=False)
class Taker:
    """What takes power from the camshaft.

    Attributes
    ----------
    name : of its finding.
    column : name of its column.
    words : what it is, in a sentence.
    torque : (n,) power per speed of the cam [N mm].
    """

    name: str
    column: str
    words: str
    torque: Quantity


def compute(request: Request[object]) -> Result:
    """The balance at the speed of the scene, its integrals over a turn to the tolerance.

    Raises
    ------
    EffectError
        If the tolerance cannot be reached.
    """
    contact, drive = request.results[CONTACT_FORCE], request.results[DRIVE_TORQUE]
    course, edges = request.course, contact.edges
    takers = takers_of(request.subject, contact)

    def power(torque: Quantity) -> Quantity:
        return lambda phi, side: N_M * torque(phi, side) * course.rates(phi, side)[0]

    def column(name: str, torque: Quantity) -> Column:
        inside = edges[(edges > 0.0) & (edges < TURN)]
        return Column(name, "W", power(torque), borders=inside)

    given = _work(drive.torque, edges, request.tolerance)
    works = {each.name: _work(each.torque, edges, request.tolerance) for each in takers}
    scale = max(given.magnitude, *(each.magnitude for each in works.values()))
    worst = max(given.error, *(each.error for each in works.values()))
    if worst > request.tolerance * scale:
        raise missed("a work of the balance", worst / scale, "the largest", request.tolerance)
    shared, efficiency = _efficiency(given, works.get(_work_into(LOAD)))
    return Result(
        findings=(
            *extreme_findings(
                "drive-power",
                "power of the drive",
                piecewise_extremes(power(drive.torque), edges),
                "W",
            ),
            *(_taken(each, works[each.name]) for each in takers),
            *shared,
        ),
        columns=(
            column("drive power", drive.torque),
            *(column(each.column, each.torque) for each in takers),
        ),
        errors={
            **{name: Bound(N_M * each.error, N_M * scale) for name, each in works.items()},
            **efficiency,
        },
    )


def takers_of(subject: Subject, contact: ContactForce) -> tuple[Taker, ...]:
    """All that takes power: the forces of `contact`, and friction under the loads that it makes."""
    found = [
        Taker(
            _work_into(each.name),
            f"power into {each.name}",
            _words_of(subject, contact, each),
            _of_force(subject, contact, each),
        )
        for each in contact.forces
    ]
    if contact.friction is not None:
        found += _of_friction(subject, contact, contact.friction)
    return tuple(found)


def _words_of(subject: Subject, contact: ContactForce, force: Force) -> str:
    """Friction that is a force does not depend on that of the contact."""
    if contact.friction is None or force is not contact.friction.force:
        return force.name
    return "viscous friction" + (" and that of the slider" if driving_slider(subject) else "")


def _velocity(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) q' [mm or rad per rad]."""
    return np.asarray(subject.state.motion.jet(phi, side, 1)[1])


def _of_force(subject: Subject, contact: ContactForce, force: Force) -> Quantity:
    """Of a load on an elastic train what it takes at the output; the train takes the less."""
    behind, sense = contact.behind, float(force.name == LOAD) - float(force.present)

    def torque(phi: FloatArray, side: Side) -> FloatArray:
        rates = rates_of(subject, phi, side)
        pull = at_rates(force.coefficients(phi, side), rates)
        found = -pull * _velocity(subject, phi, side)
        if behind is not None and sense:
            found += sense * behind.given(phi, side) / rates[0]
        return np.asarray(found)

    return torque


def _of_friction(subject: Subject, contact: ContactForce, friction: Friction) -> Iterator[Taker]:
    """Friction at the contact, and in pivot or guide."""
    follower, rubbing = subject.cam.follower, friction.rubbing

    def at_contact(phi: FloatArray, side: Side) -> FloatArray:
        normal = contact.normal(phi, side)
        lost = on_carrier(normal, lambda sense: friction.at_contact(phi, side, sense))
        return np.abs(normal) * lost

    yield Taker(
        "work-contact-friction",
        f"power lost at the {follower.touching}",
        f"friction of the {follower.touching}",
        at_contact,
    )
    bearings = contact.loaded
    if rubbing is None or bearings is None:
        return

    def in_bearings(phi: FloatArray, side: Side) -> FloatArray:
        own = at_rates(bearings.own(phi, side), rates_of(subject, phi, side))
        normal = contact.normal(phi, side)
        per = on_carrier(normal, lambda sense: rubbing.per_normal(phi, side, sense))
        loads = own + per * np.abs(normal)
        lost = rubbing.lever * np.sum(np.abs(loads), axis=0)
        return np.asarray(lost * np.abs(_velocity(subject, phi, side)))

    place = "guide" if follower.pivot is None else "pivot"
    words = f"friction in the {place}"
    yield Taker(f"work-{place}-friction", f"power lost in the {place}", words, in_bearings)


def _work(torque: Quantity, edges: FloatArray, tolerance: float) -> Integral:
    """Of a turn [N mm]."""
    return piecewise_integral(lambda phi: torque(phi, "right"), edges, tolerance)


def _work_into(force: str) -> str:
    """Name of the finding of a force."""
    return f"work-{force.removeprefix('the ').replace(' ', '-')}"


def _taken(taker: Taker, work: Integral) -> Finding:
    value = N_M * resolved(work.value, work.magnitude)
    sentence = f"{taker.words} takes {value:.6g} J a turn"
    return Finding(taker.name, "ok", sentence, value, unit="J")


def _efficiency(
    given: Integral, load: Integral | None
) -> tuple[tuple[Finding, ...], dict[str, Bound]]:
    """The share of the work of the drive that goes into the load; none where one of both is 0."""
    name = "efficiency"
    if load is None:
        return (), {}
    taken, whole = (resolved(each.value, each.magnitude) for each in (load, given))
    if not min(taken, whole) > 0.0:
        return (), {}
    value = taken / whole
    sentence = f"of the work of the drive over a turn, {100.0 * value:.4g} % goes into the load"
    error = (load.error + value * given.error) / whole
    found = Finding(name, "ok", sentence, value)
    return (found,), {name: Bound(error, max(load.magnitude, given.magnitude) / whole)}
