"""Effect `reactions`: forces in the bearings of follower and camshaft, see "bodies" below."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.contact import (
    INNER,
    OUTER,
    bearing_on_carrier,
    carrier,
    require_part,
    unbalance_force,
)
from camgeo.dynamics.effects.effect import Bound, Column, Quantity, Request, Result, Subject, scaled
from camgeo.dynamics.effects.forces import at_rates, cam_rates
from camgeo.dynamics.effects.loads import Coupler, Loads, follower_loads, guide_ends
from camgeo.dynamics.effects.results import CONTACT_FORCE, ContactForce
from camgeo.dynamics.effects.wording import N_M, extreme_finding, tolerance_error
from camgeo.geometry.outline.path import Moments
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side, resolved
from camgeo.numeric.extremes import Extreme, piecewise_highest
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


def compute(request: Request[tuple[float, float] | None]) -> Reactions:
    """The reactions at the speed of the scene; EffectError if a figure misses the tolerance."""
    contact = request.results[CONTACT_FORCE]
    subject, edges = request.subject, contact.edges
    loads = follower_loads(subject, request.results, contact.forces, idle=True)
    bodies = Bodies(subject, contact, loads)
    shaft = CamshaftLoad(bodies, single_disc_moments(subject, request.tolerance), request.data)
    reported = [
        *(
            _guide_reactions(bodies)
            if subject.cam.follower.pivot is None
            else _pivot_reactions(bodies)
        ),
        *([] if loads.coupler is None else _joint_reactions(loads.coupler)),
        *shaft.loads(),
    ]
    inside = edges[(edges > 0.0) & (edges < TURN)]
    work, errors = _friction_work(request, bodies, edges)
    findings = tuple(reaction.largest(edges, contact.extremes.magnitude) for reaction in reported)
    errors |= shaft.errors(findings, edges, request.tolerance)
    return Reactions(
        findings=(*findings, *work),
        columns=tuple(
            Column(reaction.name, reaction.unit, reaction.values, borders=inside)
            for reaction in reported
        ),
        errors=errors,
        bodies=bodies,
    )


def _pivot_reactions(bodies: Bodies) -> list[Reaction]:
    def force(phi: FloatArray, side: Side) -> FloatArray:
        return np.abs(bodies.of_pivot(phi, side))

    return [Reaction("pivot force", "force in the pivot", force)]


def _guide_reactions(bodies: Bodies) -> list[Reaction]:
    """The forces at both ends of the guide, or on the guide as a whole; positive to the right."""
    friction = bodies.contact.friction

    def end(row: int) -> Quantity:
        return lambda phi, side: bodies.of_guide(phi, side)[row]

    if friction is not None and friction.guide_length is not None:
        return [
            Reaction(f"{name} end force", f"force at the {name} end of the guide", end(row))
            for row, name in enumerate(("near", "far"))
        ]
    reactions = [Reaction("guide force", "force across the guide", end(0))]
    if not bodies.subject.cam.follower.rolls:
        moment = scaled(bodies.tilting, N_M)
        reactions.append(Reaction("guide moment", "moment that tilts the face", moment, "N m"))
    return reactions


def _joint_reactions(coupler: Coupler) -> list[Reaction]:
    """The forces in the joints of a linkage, and across the guide of a slider."""
    linkage, follower = coupler.linkage, coupler.subject.cam.follower.mover

    def size(joint: Literal["near", "far", "held"]) -> Quantity:
        return lambda phi, side: np.abs(getattr(coupler.at_speed(phi, side), joint))

    words = f"force between coupler and {linkage.member}"
    reactions = [
        Reaction("near pin force", f"force between {follower} and coupler", size("near")),
        Reaction("far pin force", words, size("far")),
    ]
    if linkage.unit == "mm":
        reactions.append(
            Reaction("slider guide force", "force across the guide of the slider", size("held"))
        )
    return reactions


def _friction_work(
    request: Request[tuple[float, float] | None], bodies: Bodies, edges: FloatArray
) -> tuple[list[Finding], dict[str, Bound]]:
    """The work of friction in the pivot over a turn, with its error."""
    bearings, tolerance = bodies.contact.bearings, request.tolerance
    if bearings is None or request.subject.cam.follower.pivot is None:
        return [], {}
    lever = bearings.rubbing.lever

    def power(phi: FloatArray) -> FloatArray:
        velocity = request.subject.state.motion.jet(phi, "right", 1)[1]
        return np.asarray(lever * np.abs(bodies.of_pivot(phi, "right") * velocity))

    work = piecewise_integral(power, edges, 0.1 * tolerance)
    if work.error > tolerance * work.value:
        raise tolerance_error(
            "the work of friction in the pivot", work.error / work.value, "itself", tolerance
        )
    sentence = f"friction in the pivot takes {N_M * work.value:.6g} J per turn"
    finding = Finding(WORK, "ok", sentence, N_M * work.value, unit="J")
    return [finding], {WORK: Bound(work.error, work.value).times(N_M)}


# -- bodies ---------------------------------------------------------------------------------------
# Forces on the free bodies: follower with its roller, and cam.
#
# The cam presses on the roller with F_c = |N| (s n + f_t t), in the notation of `friction`, at its
# centre, and the roller turns its pin by the moment -m_p. What pivot and guide carry is defined in
# `camgeo.dynamics.effects.loads`, as friction in them needs it. On a flat face F_c acts at the
# contact, which is the distance e to the right of the axis of its guide, so that M = N e; in a
# conjugate pair it is that of the disc that carries. For the camshaft see "shaft".


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """The bodies and what acts on them.

    Forces are complex [N], in the axes of the drawing, for n cam angles [rad].

    Attributes
    ----------
    subject : the design.
    contact : the contact force.
    loads : what acts on the follower besides the contact.
    """

    subject: Subject
    contact: ContactForce
    loads: Loads

    def of_cam(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_c, of the disc that carries."""
        normal = self.contact.normal(phi, side)
        sliding = np.abs(normal) * bearing_on_carrier(self.contact, phi, side).tangential
        force = np.zeros(len(phi), dtype=np.complex128)
        for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
            if not np.any(here):
                continue
            disc, flank = carrier(self.subject, sense)
            relative = disc.state.curve.relative_jet(phi[here], side, order=1)
            ahead = relative.along[1] + 1j * relative.across[1]
            tangent = ahead / np.abs(ahead) * np.exp(1j * relative.axis)
            across = 1j * disc.cam.rotation * flank * np.abs(normal[here])
            force[here] = (across + sliding[here]) * tangent
        return force

    def of_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) R on a rocker."""
        loads = at_rates(self.loads.on_pivot(phi, side), cam_rates(self.subject, phi, side))
        return np.asarray(loads - self.of_cam(phi, side))

    def of_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2, n) R_1 and R_2 of a guide with two ends; else the side force alone, and 0."""
        friction, loads = self.contact.friction, self.loads
        length, overhang = None, np.zeros(len(phi))
        if friction is not None:
            length, overhang = friction.guide_length, friction.bearing(phi, side, INNER).overhang
        noncontact = at_rates(loads.on_guide(phi, side), cam_rates(self.subject, phi, side))
        force, bearing = (
            loads.across(self.of_cam(phi, side)),
            bearing_on_carrier(self.contact, phi, side),
        )
        moment = np.abs(self.contact.normal(phi, side)) * bearing.tilt
        # The contact acts at the overhang of the side that carries, all else at that of the main
        # follower.
        pressed = guide_ends(force, moment, bearing.overhang, length)
        return guide_ends(noncontact, 0.0, overhang, length) + pressed

    def tilting(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) M [N mm] of a flat face whose guide has no stated length, about the cam axis's foot
        on it; counter-clockwise positive.
        """
        relative = self.subject.state.curve.relative_jet(phi, side, order=1)
        return np.asarray(self.contact.normal(phi, side) * relative.along[0])


# -- load -----------------------------------------------------------------------------------------
# A reaction over the cam angle, with its finding.


@dataclass(frozen=True, slots=True)
class Reaction:
    """A reaction as it is reported.

    Attributes
    ----------
    name : of its column; its finding is "largest-" and the name.
    words : of its finding.
    values : in `unit`.
    """

    name: str
    words: str
    values: Quantity
    unit: str = "N"

    @property
    def finding(self) -> str:
        """The name of its finding."""
        return f"largest-{self.name.replace(' ', '-')}"

    def largest(self, edges: FloatArray, force: float) -> Finding:
        """The finding of its largest magnitude between `edges` (k,) [rad]; a force that is rounding
        of `force` [N] is 0.
        """
        end = piecewise_highest(lambda phi, side: np.abs(self.values(phi, side)), edges)
        if self.unit == "N":
            # A reaction is a difference of forces: what is rounding of these is 0.
            end = Extreme(resolved(end.value, force), end.place)
        return extreme_finding(self.finding, f"largest {self.words}", end, self.unit)


# -- shaft ----------------------------------------------------------------------------------------
# Load on the bearings of the camshaft.
#
# The shaft carries -F_c, the weight m g of the disc and the inertia force of its unbalance. All act
# in the middle plane of the disc, so that bearings at z_1 and z_2 along the axis, measured from
# that plane, carry the shares z_2/(z_2 - z_1) and -z_1/(z_2 - z_1): moments about each of them
# vanish.


QUADRATURE_SHARE: Final = 0.1
"""Share of the tolerance for the integrals over the outlines of the disc, whose errors add up."""


@dataclass(frozen=True, slots=True, eq=False)
class CamshaftLoad:
    """The camshaft.

    Attributes
    ----------
    bodies : with the force of the cam.
    disc : its mass [t] and first moment [t mm]; None if the scene does not give its weight.
    bearings : z_1 and z_2 [mm]; None if they are not stated.
    """

    bodies: Bodies
    disc: Moments | None
    bearings: tuple[float, float] | None

    def load(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) [N] on the shaft."""
        total = -self.bodies.of_cam(phi, side)
        if self.disc is not None:
            sigma, rates = (
                self.bodies.subject.cam.rotation,
                cam_rates(self.bodies.subject, phi, side),
            )
            total += self.disc.area * self.bodies.loads.pull
            total += unbalance_force(self.disc.first, sigma, phi, rates)
        return total

    def loads(self) -> list[Reaction]:
        """The load on the shaft, and that on each bearing if they are stated."""

        def share(part: float) -> Quantity:
            return lambda phi, side: abs(part) * np.abs(self.load(phi, side))

        reactions = [Reaction("camshaft load", "load on the camshaft", share(1.0))]
        if self.bearings is not None:
            first, second = self.bearings
            for name, part in (("first", second), ("second", -first)):
                words = f"load on the {name} bearing of the camshaft"
                reactions.append(
                    Reaction(f"{name} bearing load", words, share(part / (second - first)))
                )
        return reactions

    def errors(
        self, findings: Iterable[Finding], edges: FloatArray, tolerance: float
    ) -> dict[str, Bound]:
        """Of the loads, and of their findings among the `findings`.

        Raises
        ------
        EffectError
            If an error exceeds the tolerance, relative to the largest load.
        """
        if self.disc is None:
            return {}

        def per_unbalance(phi: FloatArray, side: Side) -> FloatArray:
            rates = cam_rates(self.bodies.subject, phi, side)
            return np.abs(unbalance_force(1.0, 1, phi, rates))

        error = self.disc.first_error * piecewise_highest(per_unbalance, edges).value
        error += self.disc.area_error * abs(self.bodies.loads.pull)
        largest = {finding.name: finding.value or 0.0 for finding in findings}
        loads = self.loads()
        whole = largest[loads[0].finding]
        if error > tolerance * whole:
            raise tolerance_error(
                "the load on the camshaft", error / whole, "the largest", tolerance
            )
        bounds: dict[str, Bound] = {}
        for reaction in loads:
            bound = Bound(error, whole).times(largest[reaction.finding] / whole if whole else 0.0)
            bounds |= {reaction.name: bound, reaction.finding: bound}
        return bounds


def single_disc_moments(subject: Subject, tolerance: float) -> Moments | None:
    """Mass and first moment of the single disc; None if its thickness or density is not stated.

    Raises
    ------
    EffectError
        If there is no disc.
    """
    spec = subject.part_spec
    if subject.paired or spec is None or spec.thickness is None or spec.density is None:
        return None
    from camgeo.part.mass import disc_moments  # few scenes state what the disc is made of

    return disc_moments(require_part(subject, "weigh"), spec.density, QUADRATURE_SHARE * tolerance)
