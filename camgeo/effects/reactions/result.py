"""Effect `reactions`: forces in the bearings of follower and camshaft, see `bodies`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Column, Quantity, Request, Result
from camgeo.effects.reactions import Bearings
from camgeo.effects.reactions.bodies import Bodies
from camgeo.effects.reactions.load import Load
from camgeo.effects.reactions.shaft import Shaft, disc_of
from camgeo.effects.results import CONTACT_FORCE, GRAVITY, INERTIA, SPRING
from camgeo.effects.wording import N_M, missed
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.quadrature import Integral, piecewise_integral
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
        from camgeo.effects.reactions.pins import pins_of  # few followers have a linkage

        pins = pins_of(subject, subject.drive.linkage, contact.forces, inertia, gravity)
    bodies = Bodies(subject, contact, inertia, gravity, results.get(SPRING), pins)
    shaft = Shaft(bodies, disc_of(subject, request.tolerance), request.data.bearings)
    loads = [
        *(_of_guide(bodies) if subject.cam.follower.pivot is None else _of_pivot(bodies)),
        *([] if pins is None else pins.loads()),
        *shaft.loads(),
    ]
    inside = edges[(edges > 0.0) & (edges < TURN)]
    work, errors = _friction_work(request, bodies, edges)
    found = tuple(each.largest(edges) for each in loads)
    errors |= shaft.errors(found, edges, request.tolerance)
    return Reactions(
        findings=(*found, *work),
        columns=tuple(Column(each.name, each.unit, each.values, borders=inside) for each in loads),
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
    """What friction in the pivot takes a turn; behind a linkage also what is counted of it."""
    bearings, tolerance = bodies.contact.bearings, request.tolerance
    if bearings is None or request.subject.cam.follower.pivot is None:
        return [], {}
    lever = bearings.rubbing.lever

    def taken(load: Callable[[FloatArray, Side], ComplexArray]) -> Integral:
        """Under the `load` (n,), over the turn [N mm]."""

        def power(phi: FloatArray) -> FloatArray:
            velocity = request.subject.state.motion.jet(phi, "right", 1)[1]
            return np.asarray(lever * np.abs(load(phi, "right") * velocity))

        return piecewise_integral(power, edges, 0.1 * tolerance)

    work = taken(bodies.of_pivot)
    if work.error > tolerance * work.value:
        raise missed("the work of friction in the pivot", work.error / work.value, "itself",
                     tolerance)  # fmt: skip
    sentence = f"friction in the pivot takes {N_M * work.value:.6g} J a turn"
    if bodies.pins is not None:
        counted = N_M * taken(bodies.of_cam).value
        sentence += (
            f" under its whole load; {counted:.6g} J under the contact force alone, for which the"
            " effect friction counts it behind a linkage"
        )
    found = Finding(WORK, "ok", sentence, N_M * work.value, unit="J")
    return [found], {WORK: Bound(work.error, work.value).times(N_M)}
