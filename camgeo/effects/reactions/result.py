"""Effect `reactions`: forces in the bearings of follower and camshaft, see `bodies`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Column, Quantity, Request, Result
from camgeo.effects.reactions.bodies import Bodies
from camgeo.effects.results import CONTACT_FORCE, GRAVITY, INERTIA, SPRING
from camgeo.effects.wording import N_M, extreme_finding, missed
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import Extreme, piecewise_extremes, piecewise_highest
from camgeo.numeric.quadrature import Integral, piecewise_integral
from camgeo.units import TURN

WORK: Final = "pivot-friction-work"

ENDS: Final = (
    ("largest-near-end-force", "at the near end of the guide", "near end force"),
    ("largest-far-end-force", "at the far end of the guide", "far end force"),
)
WHOLE: Final = (("largest-guide-force", "across the guide", "guide force"),)
"""Finding, place and column of each force on a guide."""


@dataclass(frozen=True, slots=True, eq=False)
class Reactions(Result):
    """The reactions.

    Attributes
    ----------
    bodies : with the forces on them.
    """

    bodies: Bodies


def compute(request: Request[Mapping[str, Any]]) -> Reactions:
    """The reactions at the speed of the scene; EffectError if the work misses the tolerance."""
    results = request.results
    contact = results[CONTACT_FORCE]
    optional = (results.get(INERTIA), results.get(GRAVITY), results.get(SPRING))
    bodies = Bodies(request.subject, contact, *optional)
    edges = contact.edges

    def on_shaft(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(bodies.of_cam(phi, side))

    inside = edges[(edges > 0.0) & (edges < TURN)]
    own = _of_pivot if request.subject.cam.follower.pivot is not None else _of_guide
    shaft = piecewise_highest(on_shaft, edges)
    findings, forces = own(bodies, edges)
    work, errors = _friction_work(request, bodies, edges)
    return Reactions(
        findings=(
            *findings,
            extreme_finding("largest-shaft-load", "largest load on the camshaft", shaft, "N"),
            *work,
        ),
        columns=tuple(
            Column(name, "N", force, borders=inside)
            for name, force in {**forces, "camshaft load": on_shaft}.items()
        ),
        errors=errors,
        bodies=bodies,
    )


def _of_pivot(bodies: Bodies, edges: FloatArray) -> tuple[list[Finding], dict[str, Quantity]]:
    def size(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(bodies.of_pivot(phi, side))

    highest = piecewise_highest(size, edges)
    words = "largest force in the pivot"
    return [extreme_finding("largest-pivot-force", words, highest, "N")], {"pivot force": size}


def _of_guide(bodies: Bodies, edges: FloatArray) -> tuple[list[Finding], dict[str, Quantity]]:
    """Of both ends, or of the guide as a whole; forces to the right count positive."""
    friction = bodies.contact.friction
    ended = friction is not None and friction.guide_length is not None
    findings: list[Finding] = []
    forces: dict[str, Quantity] = {}
    for row, (key, place, column) in enumerate(ENDS if ended else WHOLE):

        def force(phi: FloatArray, side: Side, row: int = row) -> FloatArray:
            found: FloatArray = bodies.of_guide(phi, side)[row]
            return found

        ends = piecewise_extremes(force, edges)
        most = max((ends.highest, ends.lowest), key=lambda end: abs(end.value))
        end = Extreme(abs(most.value), most.place)
        findings.append(extreme_finding(key, f"largest force {place}", end, "N"))
        forces[column] = force
    return findings, forces


def _friction_work(
    request: Request[Mapping[str, Any]], bodies: Bodies, edges: FloatArray
) -> tuple[list[Finding], dict[str, Bound]]:
    """What friction in the pivot takes a turn under its real load, and under N alone."""
    friction = bodies.contact.friction
    if friction is None or not friction.pivot_lever:
        return [], {}
    lever, tolerance = friction.pivot_lever, request.tolerance

    def work(load: Quantity) -> Integral:
        """Of friction under the `load` (n,) [N], over the turn [N mm]."""

        def power(phi: FloatArray) -> FloatArray:
            velocity = request.subject.state.motion.jet(phi, "right", 1)[1]
            return np.asarray(lever * np.abs(load(phi, "right") * velocity))

        return piecewise_integral(power, edges, 0.1 * tolerance)

    real = work(lambda phi, side: np.abs(bodies.of_pivot(phi, side)))
    assumed = work(bodies.contact.normal)
    if real.error > tolerance * real.value:
        raise missed("the work of friction in the pivot", real.error / real.value, "itself",
                     tolerance)  # fmt: skip
    sentence = (
        f"friction in the pivot takes {N_M * real.value:.6g} J a turn under its whole load;"
        f" {N_M * assumed.value:.6g} J under the contact force alone, for which the effect friction"
        " counts it"
    )
    found = Finding(WORK, "ok", sentence, N_M * real.value, unit="J")
    return [found], {WORK: Bound(real.error, real.value).times(N_M)}
