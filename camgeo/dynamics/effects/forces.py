"""Generalised forces on the follower over the cam angle, also those of an elastic train.

The follower has one coordinate q: its lift [mm], or the angle of the rocker [rad]. A generalised
force Q does the work Q dq: it is in N for a translating follower, in N mm for an oscillating one,
and positive in the direction of increasing q.

Every force here is a polynomial in the speed of the cam at a given cam angle phi,

    Q = c0(phi) + c1(phi) omega + c2(phi) omega^2 + c3(phi) alpha,

with omega = dphi/dt [rad/s] and alpha = d omega/dt [rad/s^2]: weights and springs are c0, viscous
friction is c1, inertia is c2 and c3. The force is thus known for all speeds at once, except one
that is `present`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from camgeo.dynamics.effects.effect import Quantity, Subject
from camgeo.dynamics.oscillator.steady import Response
from camgeo.dynamics.oscillator.train import Train
from camgeo.errors import EffectError
from camgeo.kinematics.mechanism.linkage import Linkage, first_locked_place
from camgeo.kinematics.mechanism.values import Member
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.units import TURN, at_cam_angles

Scalar = TypeVar("Scalar", np.float64, np.complex128)

Coefficients = Callable[[FloatArray, Side], FloatArray]
"""(4, n) c0 to c3 at n cam angles [rad]."""

FreeForce = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""(n,) the force at n cam angles [rad] on a follower with the coordinate q (n,) [mm or rad] and the
velocity dq/dt (n,) [per s], whatever the motion of the state is there."""


@dataclass(frozen=True, slots=True, eq=False)
class Force:
    """A generalised force.

    Attributes
    ----------
    name : e.g. "spring".
    coefficients : (4, n) c0 [N or N mm] to c3.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the formula of a coefficient changes, besides
        the borders of the motion.
    far : the part that acts on the far member of a linkage, as the generalised force on the
        demanded coordinate x [N or N mm]: a share far dx/dq of the `coefficients`; None if nothing
        of it does.
    free_force : the force on a follower that is off the cam, see `FreeForce`; None if it is known
        for the motion of the state alone, and for inertia, which is no force on a free follower.
    cuts : (k,) cam angles [rad] in [0, 2 pi] between which extremes are searched for, besides the
        borders, where a coefficient has many of them.
    present : whether it is known for the present course of the cam in time only, and is then c0.
    """

    name: str
    coefficients: Coefficients
    borders: FloatArray = field(default_factory=lambda: np.empty(0))
    free_force: FreeForce | None = None
    far: Coefficients | None = None
    cuts: FloatArray = field(default_factory=lambda: np.empty(0))
    present: bool = False


def unmoved(values: Callable[[FloatArray, Side], FloatArray]) -> Coefficients:
    """The coefficients of a force (n,) that does not depend on speed: c0 alone."""

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        rows = np.zeros((4, len(phi)))
        rows[0] = values(phi, side)
        return rows

    return coefficients


def cam_rates(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(2 or more, n) omega [rad/s] and alpha [rad/s^2] of the scene; 0 if it gives no speed."""
    course = subject.state.course
    return np.zeros((2, len(phi))) if course is None else course.rates(phi, side)


def at_rates(coefficients: NDArray[Scalar], rates: FloatArray) -> NDArray[Scalar]:
    """(..., n) the force with `coefficients` (4, ..., n) at `rates` (2 or more, n): omega and
    alpha.
    """
    omega, alpha = rates[0], rates[1]
    c0, c1, c2, c3 = coefficients
    return np.asarray(c0 + omega * (c1 + omega * c2) + alpha * c3)


def smooth_edges(smooth: FloatArray, forces: Sequence[Force]) -> FloatArray:
    """(k,) the smooth angles of the motion, `smooth`, borders and cuts of all `forces` [rad]."""
    cuts = [force.cuts for force in forces]
    return merged(np.concatenate((smooth, all_borders(forces), *cuts)))


def all_borders(forces: Sequence[Force]) -> FloatArray:
    """(k,) the borders of all `forces` [rad]."""
    return np.concatenate([force.borders for force in forces] or [np.empty(0)])


# -- linked ---------------------------------------------------------------------------------------
# Where the linkage of a design lies in the drawing.


def shaft_and_turn(subject: Subject, linkage: Linkage) -> tuple[complex, complex]:
    """Position [mm] of the crank's shaft, and the direction of the linkage's own x axis.

    The linkage is defined in its own frame, about the pivot of a rocker. On a carriage its pin is
    assumed to be at the roller's centre, and the guide of the pin to be that of the follower.
    """
    follower = subject.cam.follower
    if follower.pivot is not None:
        return follower.pivot, 1.0 + 0.0j
    still, one = np.zeros((2, 1)), np.array([[1.0], [0.0]])
    pin, ahead = linkage.joints(still[0])[0], linkage.joint_rates(still[0], still, one)[0]
    # The pin must move along the guide: this fixes the direction of the linkage in the drawing.
    turn = complex(follower.way / ahead[0, 0])
    return follower.start_arm - turn * complex(pin[0]), turn


def output_per_follower(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) dx/dq, the derivative of the demanded motion by the follower's coordinate."""
    if subject.drive.linkage is None:
        return np.ones(len(phi))
    return subject.drive.linkage.per_follower(subject.state.output.jet(phi, side)[0])


# -- immovable ------------------------------------------------------------------------------------
# Masses that no finite force moves: where the velocity jumps, and behind a locked linkage.


JUMP: Final = 1e-9
"""A jump of the velocity by less than this share of the largest is rounding."""

POSES: Final[dict[Member, tuple[str, str, str]]] = {
    "slider": (
        "the coupler is square to the guide of the slider",
        "stroke",
        "the rocker cannot move the slider",
    ),
    "lever": ("coupler and lever are in line", "angle", "the rocker cannot move the lever"),
    "crank": ("crank and coupler are in line", "angle", "the slider cannot turn the crank"),
}
"""The pose of the linkage, the kind of its position, and what the follower cannot do, by the member
at the far end."""


def shocks(subject: Subject, mass: Quantity | None) -> list[float]:
    """The cam angles [rad] at which the velocity of the `mass` (n,) jumps, which is reduced to the
    follower; none without masses.
    """
    if mass is None:
        return []
    jumps = subject.state.shocks
    return [phi for phi in jumps if mass(np.array([phi]), "right")[0] > 0.0]


def torque_shocks(subject: Subject, per_alpha: Quantity, edges: FloatArray) -> FloatArray:
    """(k,) the cam angles [rad] at which the torque on the camshaft is infinite.

    There the velocity of the follower jumps and `per_alpha` is not 0: the inertia
    reduced to it, or the derivative of its force by the acceleration of the cam. The follower moves
    between `edges` (m,) [rad].
    """
    motion = subject.state.motion
    places = np.asarray(motion.breaks)
    if not len(places):
        return places
    jump = np.abs(motion.jet(places, "right", 1)[1] - motion.jet(places, "left", 1)[1])
    # The velocities in the middle of the pieces are the scale by which a jump is distinguished from
    # rounding.
    inside = np.abs(motion.jet(edges[:-1] + 0.5 * np.diff(edges), "right", 1)[1])
    heavy = (per_alpha(places, "left") != 0.0) | (per_alpha(places, "right") != 0.0)
    return np.asarray(
        places[heavy & (jump > JUMP * max(float(np.max(inside)), float(np.max(jump))))]
    )


def refuse_locked(subject: Subject, burden: str) -> None:
    """Raise EffectError if the follower cannot move the far end of its linkage at some cam angle.

    `burden` completes the sentence with what acts there, e.g. "'s mass" or " against its load".
    """
    linkage = subject.drive.linkage
    if linkage is None:
        return

    locked = first_locked_place(linkage, subject.state.output)
    if locked is None:
        return
    pose, what, cannot = POSES[linkage.member]
    phi, position = locked
    value, unit = (position, "mm") if linkage.unit == "mm" else (math.degrees(position), "deg")
    raise EffectError(
        f"{pose} {at_cam_angles(phi)}, {what} {value:.6g} {unit}:"
        f" {cannot}{burden} there, whatever the force; the {what} must stay clear of this value",
        finding=f"locked-{linkage.member}",
        value=value,
        unit=unit,
        cam_angle=phi,
    )


# -- elastic --------------------------------------------------------------------------------------
# The force that an elastic train passes to the follower, beyond that of a rigid one.
#
# The base of the train has the motion y of the output of a rigid train, on the follower. Its first
# spring and damper push the masses with the force F, which accelerates them all and moves what
# holds them to the frame, against the load p on the output, and push back the base as much. Forces
# of a rigid train have -m y'' of the masses and p instead, m in sum. So the generalised force on
# the follower is that of a rigid train and
#
#     Q = -(F - m y'' + p) dy/dq,
#
# known for the present course of the cam in time only: the state of a train depends on how the cam
# has turned before. Springs and weights act on the base, so they do not excite the train.
#
# With the cam running f times as fast, in the time of the scene, the train is one whose rates are
# divided by f, on the same base; forces are then f^2 times those in that time.


MOST_PERIODS: Final = 4096
"""Periods per turn up to which each period is searched for extremes. Beyond this, the samples of a
lasting vibration cover all its phases, and a decaying one is searched where it begins.
"""

RUNGS: Final = 8
"""Rungs in an octave. A number of periods takes the edges of the next rung, so that those of
neighbouring speeds are the same."""

BEGINNING: Final = np.array([1.0, 2.0])
"""Periods after each border that are then searched separately."""


def search_edges(smooth: FloatArray, train: Train | None, period: float) -> FloatArray:
    """The edges between which extremes are searched for, at most a period of the train apart."""
    if train is None:
        return smooth
    periods = float(np.max(train.rates.imag)) * period / TURN
    if not periods > 1.0:
        return smooth
    # Numbers of periods are rounded up to a rung, so that neighbouring speeds share their edges.
    rung = math.ceil(RUNGS * math.log2(min(periods, MOST_PERIODS)))
    count = math.ceil(2.0 ** (rung / RUNGS))
    edges = np.concatenate((smooth, np.linspace(0.0, TURN, count + 1)))
    if periods > MOST_PERIODS:
        # A vibration that decays is largest in its first periods behind an edge.
        begin = (smooth[:-1, np.newaxis] + BEGINNING * (TURN / periods)).ravel()
        edges = np.concatenate((edges, begin[begin < TURN]))
    return merged(edges)


@dataclass(frozen=True, slots=True, eq=False)
class ElasticTrain:
    """The elastic train behind the follower, at one speed of the cam.

    Attributes
    ----------
    response : in the time of the scene.
    mass : behind the train, as far as forces of a rigid train have it [t, or t mm^2 if it turns].
    per_lift : (n,) dy/dq [1, 1/mm or mm].
    pushes : (n,) F [N or N mm] of a response at n cam angles, in the time of the scene.
    base : (3, n) y, y', y'' at n cam angles, in the time of the scene.
    load : p, as a force on y; None if there is none.
    slips : (n,) velocity of the output beyond y' of a response, as `pushes`; None without a load.
    """

    response: Response
    mass: float
    per_lift: Quantity
    pushes: Callable[[Response, FloatArray, Side], FloatArray]
    base: Quantity
    load: Force | None = None
    slips: Callable[[Response, FloatArray, Side], FloatArray] | None = None

    def beyond_rigid(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) Q [N or N mm]."""
        return self.beyond_base(phi, side) * self.per_lift(phi, side)

    def beyond_base(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) -(F - m y'' + p) [N or N mm], on the base."""
        push = self.pushes(self.response, phi, side)
        if self.load is not None:
            push = push + self.load.coefficients(phi, side)[0]
        return np.asarray(self.mass * self.base(phi, side)[2] - push)

    def excess_load_power(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) power [N mm/s] that the load takes from the train beyond -p y', which it has from a
        rigid one.
        """
        if self.load is None or self.slips is None:
            return np.zeros(len(phi))
        pressed = self.load.coefficients(phi, side)[0]
        return np.asarray(-pressed * self.slips(self.response, phi, side))

    def reduced(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) m (dy/dq)^2, the part of `Inertia.to_follower` that is behind the train."""
        way = self.per_lift(phi, side)
        return self.mass * way * way

    @property
    def error(self) -> float:
        """Estimate of the error of F [N or N mm]."""
        return self.response.reading_error(self.train.force(0))

    @property
    def train(self) -> Train:
        """The train, decomposed into its modes."""
        return self.response.train

    def edges(self, smooth: FloatArray) -> FloatArray:
        """(k,) cam angles [rad] between which F is searched for extremes."""
        return search_edges(smooth, self.train, self.response.base.period)

    def force(self, smooth: FloatArray) -> Force:
        """Q, which is smooth between the angles `smooth` (m,) [rad] and the borders of the load."""
        cuts = self.edges(smooth)
        return Force(
            "the elastic train",
            unmoved(self.beyond_rigid),
            borders=np.empty(0) if self.load is None else self.load.borders,
            cuts=cuts,
            present=True,
            far=unmoved(self.beyond_base),
        )

    def perturbed_trains(self, demand: Quantity) -> tuple[ElasticTrain, ElasticTrain]:
        """The train with F off by its error, twice: so that the contact carries more everywhere,
        where it must provide the generalised force `demand`; and so that the drive puts in more.

        A force of the contact or a load follows from F at the same cam angle, and a sum of such
        forces or of powers over the turn is off most where all of them are off to the same side.
        """

        def pressing(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(demand(phi, side) * self.per_lift(phi, side))

        def driving(phi: FloatArray, side: Side) -> FloatArray:
            return np.asarray(self.base(phi, side)[1])

        return self._perturbed(pressing), self._perturbed(driving)

    def _perturbed(self, way: Quantity) -> ElasticTrain:
        """The train with F off by its error in the direction of `way`."""

        def pushes(response: Response, phi: FloatArray, side: Side) -> FloatArray:
            error = response.reading_error(response.train.force(0))
            return self.pushes(response, phi, side) + error * np.sign(way(phi, side))

        return replace(self, pushes=pushes)

    def with_speed_factor(self, factor: float) -> ElasticTrain:
        """The train with the cam running `factor` times as fast as in `response`."""
        load, once = self.load, factor**-2
        if load is not None:
            pressed = load.coefficients
            # Forces in the time of the response are smaller by the square of the factor.
            load = replace(load, coefficients=lambda phi, side: once * pressed(phi, side))
        return replace(self, response=self.response.in_time(factor), load=load)
