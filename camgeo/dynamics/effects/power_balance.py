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
from camgeo.dynamics.effects.contact import select_carrier
from camgeo.dynamics.effects.effect import (
    Bound,
    Column,
    Quantity,
    Request,
    Result,
    Subject,
    driving_slider,
)
from camgeo.dynamics.effects.forces import Force, at_rates, cam_rates
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    DRIVE_TORQUE,
    LOAD,
    ContactForce,
    Friction,
)
from camgeo.dynamics.effects.wording import N_M, extreme_findings, tolerance_error
from camgeo.numeric.arrays import FloatArray, Side, resolved
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.numeric.quadrature import Integral, piecewise_integral
from camgeo.units import TURN


@dataclass(frozen=True, slots=True, eq=False)
class PowerSink:
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
    sinks = power_sinks(request.subject, contact)

    def power(torque: Quantity) -> Quantity:
        return lambda phi, side: N_M * torque(phi, side) * course.rates(phi, side)[0]

    def column(name: str, torque: Quantity) -> Column:
        inside = edges[(edges > 0.0) & (edges < TURN)]
        return Column(name, "W", power(torque), borders=inside)

    drive_work = _work(drive.torque, edges, request.tolerance)
    works = {sink.name: _work(sink.torque, edges, request.tolerance) for sink in sinks}
    # Works that nearly cancel, as of inertia, have no scale of their own.
    scale = max(drive_work.magnitude, *(work.magnitude for work in works.values()))
    worst = max(drive_work.error, *(work.error for work in works.values()))
    if worst > request.tolerance * scale:
        raise tolerance_error(
            "a work of the balance", worst / scale, "the largest", request.tolerance
        )
    shared, efficiency = _efficiency(drive_work, works.get(_work_into(LOAD)))
    return Result(
        findings=(
            *extreme_findings(
                "drive-power",
                "power of the drive",
                piecewise_extremes(power(drive.torque), edges),
                "W",
            ),
            *(_work_finding(sink, works[sink.name]) for sink in sinks),
            *shared,
        ),
        columns=(
            column("drive power", drive.torque),
            *(column(sink.column, sink.torque) for sink in sinks),
        ),
        errors={
            **{name: Bound(N_M * work.error, N_M * scale) for name, work in works.items()},
            **efficiency,
        },
    )


def power_sinks(subject: Subject, contact: ContactForce) -> tuple[PowerSink, ...]:
    """All that takes power: the forces of `contact`, and friction under the loads that it makes."""
    sinks = [
        PowerSink(
            _work_into(force.name),
            f"power into {force.name}",
            _force_words(subject, contact, force),
            _force_torque(subject, contact, force),
        )
        for force in contact.forces
    ]
    if contact.friction is not None:
        sinks += _friction_sinks(subject, contact, contact.friction)
    return tuple(sinks)


def _force_words(subject: Subject, contact: ContactForce, force: Force) -> str:
    """The `force` in words: friction among the forces is the part that does not depend on the
    contact force.
    """
    if contact.friction is None or force is not contact.friction.force:
        return force.name
    return "viscous friction" + (" and that of the slider" if driving_slider(subject) else "")


def _velocity(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) q' [mm or rad per rad]."""
    return np.asarray(subject.state.motion.jet(phi, side, 1)[1])


def _force_torque(subject: Subject, contact: ContactForce, force: Force) -> Quantity:
    """The torque that a `force` takes. A load on an elastic train takes what it receives at the
    output, and the train takes as much less.
    """
    behind, sense = contact.behind, float(force.name == LOAD) - float(force.present)

    def torque(phi: FloatArray, side: Side) -> FloatArray:
        rates = cam_rates(subject, phi, side)
        pull = at_rates(force.coefficients(phi, side), rates)
        values = -pull * _velocity(subject, phi, side)
        if behind is not None and sense:
            values += sense * behind.excess_load_power(phi, side) / rates[0]
        return np.asarray(values)

    return torque


def _friction_sinks(
    subject: Subject, contact: ContactForce, friction: Friction
) -> Iterator[PowerSink]:
    """Friction at the contact, and in pivot or guide."""
    follower, rubbing = subject.cam.follower, friction.rubbing

    def at_contact(phi: FloatArray, side: Side) -> FloatArray:
        normal = contact.normal(phi, side)
        lost = select_carrier(normal, lambda sense: friction.at_contact(phi, side, sense))
        return np.abs(normal) * lost

    yield PowerSink(
        "work-contact-friction",
        f"power lost at the {follower.touching}",
        f"friction of the {follower.touching}",
        at_contact,
    )
    bearings = contact.loaded
    if rubbing is None or bearings is None:
        return

    def in_bearings(phi: FloatArray, side: Side) -> FloatArray:
        noncontact = at_rates(bearings.noncontact_loads(phi, side), cam_rates(subject, phi, side))
        normal = contact.normal(phi, side)
        per = select_carrier(normal, lambda sense: rubbing.per_normal(phi, side, sense))
        # Only the part by the contact grows with |N|.
        loads = noncontact + per * np.abs(normal)
        lost = rubbing.lever * np.sum(np.abs(loads), axis=0)
        return np.asarray(lost * np.abs(_velocity(subject, phi, side)))

    place = "guide" if follower.pivot is None else "pivot"
    words = f"friction in the {place}"
    yield PowerSink(f"work-{place}-friction", f"power lost in the {place}", words, in_bearings)


def _work(torque: Quantity, edges: FloatArray, tolerance: float) -> Integral:
    """The integral of `torque` over a turn [N mm]."""
    return piecewise_integral(lambda phi: torque(phi, "right"), edges, tolerance)


def _work_into(force: str) -> str:
    """Name of the finding of a force."""
    return f"work-{force.removeprefix('the ').replace(' ', '-')}"


def _work_finding(taker: PowerSink, work: Integral) -> Finding:
    value = N_M * resolved(work.value, work.magnitude)
    sentence = f"{taker.words} takes {value:.6g} J per turn"
    return Finding(taker.name, "ok", sentence, value, unit="J")


def _efficiency(
    drive_work: Integral, load: Integral | None
) -> tuple[tuple[Finding, ...], dict[str, Bound]]:
    """The share of the work of the drive that goes into the load; none where one of both is 0."""
    name = "efficiency"
    if load is None:
        return (), {}
    load_work, whole = (
        resolved(integral.value, integral.magnitude) for integral in (load, drive_work)
    )
    if not min(load_work, whole) > 0.0:
        return (), {}
    value = load_work / whole
    sentence = f"of the work of the drive over a turn, {100.0 * value:.4g} % goes into the load"
    error = (load.error + value * drive_work.error) / whole
    finding = Finding(name, "ok", sentence, value)
    return (finding,), {name: Bound(error, max(load.magnitude, drive_work.magnitude) / whole)}
