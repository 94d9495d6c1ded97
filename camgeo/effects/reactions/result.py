"""Effect `reactions`: forces in the bearings of follower and camshaft, see `bodies`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Column, Quantity, Request, Result
from camgeo.effects.loads import Loads
from camgeo.effects.reactions import Bearings
from camgeo.effects.reactions.bodies import Bodies
from camgeo.effects.reactions.load import Load
from camgeo.effects.reactions.shaft import Shaft, disc_of
from camgeo.effects.results import CONTACT_FORCE, GRAVITY, INERTIA, SPRING
from camgeo.effects.wording import N_M, missed
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.units import TURN

WORK: Final = "pivot-friction-work"


@dataclass(frozen=True, slots=True, eq=False)
class Reactions(Result):
    """The reactions.

    Attributes
    ----------
    bodies : with the forces on them.
    """

    bodies: Bodies


def compute(request: Request[Bearings]) -> Reactions:
    """The reactions at the speed of the scene; EffectError if a figure misses the tolerance."""
    results = request.results
    contact = results[CONTACT_FORCE]
    subject, edges = request.subject, contact.edges
    inertia, gravity = results.get(INERTIA), results.get(GRAVITY)
    pins = None
    if subject.drive.linkage is not None:
        # few followers have a linkage
        from camgeo.effects.coupler import coupler_of
        from camgeo.effects.reactions.pins import Pins

        linkage = subject.drive.linkage
        pins = Pins(coupler_of(subject, linkage, contact.forces, inertia, gravity))
    coupler = None if pins is None else pins.coupler
    loads = Loads(subject, inertia, gravity, results.get(SPRING), coupler)
    bodies = Bodies(subject, contact, loads, pins)
    shaft = Shaft(bodies, disc_of(subject, request.tolerance), request.data.bearings)
    reported = [
        *(_of_guide(bodies) if subject.cam.follower.pivot is None else _of_pivot(bodies)),
        *([] if pins is None else pins.loads()),
        *shaft.loads(),
    ]
    inside = edges[(edges > 0.0) & (edges < TURN)]
    work, errors = _friction_work(request, bodies, edges)
    found = tuple(each.largest(edges, contact.extremes.magnitude) for each in reported)
    errors |= shaft.errors(found, edges, request.tolerance)
    return Reactions(
        findings=(*found, *work),
        columns=tuple(
            Column(each.name, each.unit, each.values, borders=inside) for each in reported
        ),
        errors=errors,
        bodies=bodies,
    )


def _of_pivot(bodies: Bodies) -> list[Load]:
    def force(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(bodies.of_pivot(phi, side))

    return [Load("pivot force", "force in the pivot", force)]


def _of_guide(bodies: Bodies) -> list[Load]:
    """Of both ends, or of the guide as a whole; forces to the right count positive."""
    friction = bodies.contact.friction

    def end(row: int) -> Quantity:
        return lambda phi, side: bodies.of_guide(phi, side)[row]

    if friction is not None and friction.guide_length is not None:
        return [
            Load(f"{name} end force", f"force at the {name} end of the guide", end(row))
            for row, name in enumerate(("near", "far"))
        ]
    found = [Load("guide force", "force across the guide", end(0))]
    if not bodies.subject.cam.follower.rolls:

        def moment(phi: FloatArray, side: Side) -> FloatArray:
            return N_M * bodies.tilting(phi, side)

        found.append(Load("guide moment", "moment that tilts the face", moment, "N m"))
    return found


def _friction_work(
    request: Request[Bearings], bodies: Bodies, edges: FloatArray
) -> tuple[list[Finding], dict[str, Bound]]:
    """What friction in the pivot takes a turn."""
    bearings, tolerance = bodies.contact.bearings, request.tolerance
    if bearings is None or request.subject.cam.follower.pivot is None:
        return [], {}
    lever = bearings.rubbing.lever

    def power(phi: FloatArray) -> FloatArray:
        velocity = request.subject.state.motion.jet(phi, "right", 1)[1]
        return np.asarray(lever * np.abs(bodies.of_pivot(phi, "right") * velocity))

    work = piecewise_integral(power, edges, 0.1 * tolerance)
    if work.error > tolerance * work.value:
        raise missed("the work of friction in the pivot", work.error / work.value, "itself",
                     tolerance)  # fmt: skip
    sentence = f"friction in the pivot takes {N_M * work.value:.6g} J a turn"
    found = Finding(WORK, "ok", sentence, N_M * work.value, unit="J")
    return [found], {WORK: Bound(work.error, work.value).times(N_M)}
