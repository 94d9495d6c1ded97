"""The results that effects use of each other: their keys and classes.

The result class of an effect that no other effect uses is in the package of that effect.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Literal, Self

from camgeo.dynamics.effects.effect import Bound, Key, Quantity, Result
from camgeo.dynamics.effects.wording import Label
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.check.finding import Finding
    from camgeo.dynamics.effects.bearing_friction import BearingFriction, Rubbing
    from camgeo.dynamics.effects.forces import ElasticTrain, Force
    from camgeo.dynamics.effects.shaft import SteadyTurn
    from camgeo.kinematics.time_course import TimeCourse
    from camgeo.numeric.extremes import Extreme, Extremes


@dataclass(frozen=True, slots=True, eq=False)
class Acting(Result):
    """A force on the follower.

    Attributes
    ----------
    force : the generalised force. For friction, the part that does not depend on the normal force:
        viscous friction and that of a slider.
    """

    force: Force


@dataclass(frozen=True, slots=True, eq=False)
class Mass:
    """A mass at its centre of mass.

    Attributes
    ----------
    name : which body: "follower", "roller", "rocker", "slider" or "coupler".
    mass : [t].
    place : (n,) complex [mm] position relative to the cam axis, oriented as in the drawing. For a
        translating follower this is the centre of its roller, or the foot of the perpendicular from
        the cam axis to its face; for a slider it is the pin. Any point will do on a body that does
        not rotate.
    per_lift : (n,) complex [1 or mm/rad] derivative of the position by the follower's coordinate.
    rates : (2, n) complex [mm/rad^k] first and second derivative of `place` by the cam angle.
    per_coordinate : `per_lift` (n,) at n cam angles with the follower at any coordinate q (n,).
    """

    name: str
    mass: float
    place: Callable[[FloatArray, Side], ComplexArray]
    per_lift: Callable[[FloatArray, Side], ComplexArray]
    rates: Callable[[FloatArray, Side], ComplexArray]
    per_coordinate: Callable[[FloatArray, FloatArray], ComplexArray]


@dataclass(frozen=True, slots=True, eq=False)
class Inertia(Acting):
    """The moving masses and their inertia force: c2 and c3.

    Attributes
    ----------
    masses : the masses that have a weight, without those of 0.
    moved : the mass that has the demanded motion [t, or t mm^2 if it turns].
    coupler_moment : of the coupler of a linkage about its centre of mass [t mm^2].
    to_follower : M(q) (n,) [t, or t mm^2 for a rocker], all masses reduced to the follower: T = M
        (dq/dt)^2 / 2. The sum of m (dx/dq)^2 over all coordinates, by equal kinetic energy (Volmer,
        "Getriebetechnik", on reduced masses; Norton, "Cam Design and Manufacturing Handbook", on
        effective masses in dynamic models of cam systems).
    mass_terms : (2, n) M and half its derivative by q at n cam angles with the follower at any
        coordinate q (n,): the equation of free motion is M q'' + (dM/dq / 2) q'^2 = sum Q
        (Lagrange).
    """

    masses: tuple[Mass, ...]
    moved: float
    coupler_moment: float
    to_follower: Quantity
    mass_terms: Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Gravity(Acting):
    """The weights.

    Attributes
    ----------
    pull : acceleration of free fall in the drawing [mm/s^2].
    """

    pull: complex


@dataclass(frozen=True, slots=True, eq=False)
class Spring(Acting):
    """A linear spring that closes the contact.

    Attributes
    ----------
    way : x (n,), how far the spring has relaxed since cam angle 0 [mm or rad], and dx/dq (n,).
    preload, stiffness : P [N] and k [N/mm]; for a torsion spring [N mm] and [N mm/rad].
    unit_of_preload, unit_of_stiffness : units for display: "N" and "N/mm", or "N m" and "N m/rad",
        which are 1000 times the internal units.
    helical : the helical spring that has this stiffness; None if the scene states it itself.
    line : (n,) unit vectors in the drawing along which a force above 0 acts on the follower; None
        if it is a torsion spring, or acts on a slider.
    per_stroke : dx/ds by the stroke s of the slider on which it acts; 0 if it acts on the follower.
    """

    way: Callable[[FloatArray, Side], tuple[FloatArray, FloatArray]]
    preload: float
    stiffness: float
    unit_of_preload: str
    unit_of_stiffness: str
    helical: HelicalSpring | None = None
    line: Callable[[FloatArray, Side], ComplexArray] | None = None
    per_stroke: float = 0.0

    def per_preload(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) dx/dq: generalised force per unit of preload."""
        return self.way(phi, side)[1]

    def per_stiffness(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) -x dx/dq: generalised force per unit of stiffness."""
        x, rate = self.way(phi, side)
        return -x * rate


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Elastic(Result):
    """A result that includes the elastic train behind the follower.

    Attributes
    ----------
    behind : None if nothing behind it has mass, or if it is rigid.
    """

    behind: ElasticTrain | None


@dataclass(frozen=True, slots=True, eq=False)
class Bearing:
    """How friction at the contact and the guide of a follower share its load, at n cam angles.

    Attributes
    ----------
    tangential : (n,) force of the cam on the follower along the tangent of its path, per unit of
        |N|.
    tilt : (n,) moment on a guided follower, counter-clockwise, per unit of |N| [mm].
    overhang : (n,) distance of the near end of the guide outwards of the roller's centre [mm].
    """

    tangential: FloatArray
    tilt: FloatArray
    overhang: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Friction(Acting):
    """Friction of the follower.

    Attributes
    ----------
    per_normal : (2, n) contribution of friction per unit of |N| at n cam angles, on the side
        `sense` (see `camgeo.dynamics.effects.contact`): [0] generalised force on q [1 or mm/rad];
        [1] torque on the cam [mm], that is N mm per N, positive if it adds to the drive torque.
        Coulomb friction of guide and pivot is in [0] only, as of a contact force that is their only
        load, and is 0 during dwells; the roller still turns, and a face still slides, during
        dwells. GeometryError at a cusp.
    at_contact : (n,) torque on the cam per unit of |N| [mm] that friction of the roller or face
        takes, on the side `sense`; not below 0.
    bearing : at n cam angles, on the side `sense`.
    guide_length : between the ends of the guide [mm]; None if the scene does not state it.
    on_roller : largest moments on the roller per unit of |N| [mm]: of its bearing, and of rolling.
    rubbing : Coulomb friction in guide or pivot; None without any.
    """

    per_normal: Callable[[FloatArray, Side, int], FloatArray]
    at_contact: Callable[[FloatArray, Side, int], FloatArray]
    bearing: Callable[[FloatArray, Side, int], Bearing]
    guide_length: float | None
    on_roller: tuple[float, float]
    rubbing: Rubbing | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Touching(Result):
    """A result that includes where the follower leaves the cam at its speed.

    Attributes
    ----------
    lost_contact : by the definition of `camgeo.dynamics.effects.contact.lost_contact`.
    """

    lost_contact: LostContact


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Turning(Touching):
    """A result that includes how the cam turns.

    Attributes
    ----------
    turn : the steady state.
    course : in it, to the tolerance.
    rough_course : less accurate; `course` is off by less than the two differ.
    feedback : how an elastic train acts back on it; None if none does.
    """

    turn: SteadyTurn
    course: TimeCourse
    rough_course: TimeCourse
    feedback: Feedback | None = None

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The d quantities that it is solved for, the speed of the cam [rad/s] first."""
        raise NotImplementedError

    def fed_back(
        self, feedback: Feedback, finding: Finding, added_errors: Sequence[float], rough: Self
    ) -> Self:
        """The result as that of the last round with `feedback`, which `finding` reports.

        Parameters
        ----------
        added_errors : errors of the `unknowns` besides those of their bounds.
        rough : of another round, farther from the fixed point than this is.
        """
        updated = self.with_added_errors(added_errors, rough)
        return replace(
            updated,
            rough_course=rough.rough_course,
            feedback=feedback,
            findings=(*self.findings, finding),
            errors={**updated.errors, finding.name: updated.errors["cam speed"]},
        )

    def with_added_errors(self, added_errors: Sequence[float], rough: Self) -> Self:
        """The result with the `added_errors` in those of its figures, see `fed_back`."""
        raise NotImplementedError


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Flying(Result):
    """A result that includes where the follower flies.

    Attributes
    ----------
    flight_ranges : ranges [rad] over which it is off its only flank, or in its clearance, at the
        speed of the scene, the start in [0, 2 pi), the end beyond it; empty if there are none, or
        if that is not known.
    """

    flight_ranges: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class ContactForce(Touching):
    """The normal force N [N] on the follower, positive where the inner flank carries.

    For a conjugate pair it is positive where the main disc carries and negative where the return
    disc does; the other disc then carries nothing.

    Attributes
    ----------
    forces : all forces on the follower except that of the contact.
    friction : None if the scene has none.
    edges : (k,) cam angles [rad] from 0 to 2 pi between which N is smooth and keeps its sign.
    extremes : smallest and largest N of the turn, signed.
    required : (4, n) coefficients of the generalised force R that the contact must provide, with a
        rigid train.
    demand : (n,) R [N or N mm] at the speed of the scene, with the train of its state.
    normal : (n,) N at the speed of the scene, or at rest if it gives none.
    normal_at_rates : (n,) N at n cam angles and at rates (2, n): omega [rad/s] and alpha [rad/s^2],
        with a rigid train.
    bracket : (n,) [1 or mm/rad] R per unit of |N| at n cam angles, on the side `sense`, of a |N| so
        large that all else that loads the bearings is nothing to it.
    bearings : friction under the loads of pivot or guide, with a rigid train; None without any.
    released : (n,) [N or N mm] what is demanded of a contact that carries nothing, at rates (2, n):
        R, with a rigid train, and the friction of what else loads the bearings. It has the sign of
        dn/dq N.
    struck : (n,) inertia [t or t mm^2] reduced to the follower that a jump of its velocity strikes:
        all that is not behind an elastic train; None without masses.
    behind : the elastic train that `forces` include; None if it is rigid.
    with_force : the same with another force on a rigid train, known at all speeds.
    """

    forces: tuple[Force, ...]
    friction: Friction | None
    edges: FloatArray
    extremes: Extremes
    required: Quantity
    normal: Quantity
    normal_at_rates: Callable[[FloatArray, Side, FloatArray], FloatArray]
    bracket: Callable[[FloatArray, Side, int], FloatArray]
    demand: Quantity
    bearings: BearingFriction | None
    released: Callable[[FloatArray, Side, FloatArray], FloatArray]
    with_force: Callable[[Force], ContactForce]
    struck: Quantity | None = None
    behind: ElasticTrain | None = None

    @property
    def lasting(self) -> tuple[Force, ...]:
        """The forces that are known at all speeds, with a rigid train."""
        return tuple(force for force in self.forces if not force.present)

    @property
    def loaded(self) -> BearingFriction | None:
        """`bearings` with the train of its state."""
        bearings = self.bearings
        for force in self.forces:
            if force.present and bearings is not None:
                bearings = bearings.with_force(force)
        return bearings


@dataclass(frozen=True, slots=True, eq=False)
class DriveTorque(Result):
    """The torque on the camshaft.

    Attributes
    ----------
    contact : the contact force.
    law : (6, n) c0 to c3 of R, then torque per unit of R [N mm] for R > 0 and for R < 0; with
        friction in the bearings the rows of `camgeo.dynamics.effects.bearing_friction.RubbingLaw`,
        whose `linear_law` gives these six at given rates.
    torque_at_rates : (n,) [N mm] at n cam angles, with the cam turning at omega [rad/s] and alpha
        [rad/s^2].
    torque : (n,) [N mm] at the speed of the scene; the static part if it gives none.
    static : (n,) [N mm] at very low speed: without inertia and viscous friction.
    edges : (k,) cam angles [rad] from 0 to 2 pi, ascending, between which the torque is smooth.
    """

    contact: ContactForce
    law: Quantity
    torque_at_rates: Callable[
        [FloatArray, Side, FloatArray | float, FloatArray | float], FloatArray
    ]
    torque: Quantity
    static: Quantity
    edges: FloatArray


INERTIA: Final = Key[Inertia]("inertia")
GRAVITY: Final = Key[Gravity]("gravity")
LOAD: Final = Key[Acting]("load")
SPRING: Final = Key[Spring]("spring")
FRICTION: Final = Key[Friction]("friction")
VIBRATION: Final = Key[Elastic]("vibration")
LIFT_OFF: Final = Key[Flying]("lift-off")
CONTACT_FORCE: Final = Key[ContactForce]("contact-force")
DRIVE_TORQUE: Final = Key[DriveTorque]("drive-torque")
SPEED_FLUCTUATION: Final = Key[Turning]("speed-fluctuation")
CAMSHAFT_WINDUP: Final = Key[Turning]("camshaft-windup")

ACTING: Final = (INERTIA, GRAVITY, LOAD, SPRING)
"""Effects that act on the follower, besides friction."""

FINDERS: Final = (SPEED_FLUCTUATION, CAMSHAFT_WINDUP)
"""The effects that find how the cam turns, of which a scene names at most one."""


# -- helical spring -------------------------------------------------------------------------------
# A helical compression spring of round wire.
#
# With the wire diameter d, the mean coil diameter D, n active coils and the shear modulus G, the
# spring index C = D/d, and a force F,
#
#     k = G d^4 / (8 D^3 n),      tau = K 8 F D / (pi d^3),      K = (4 C - 1)/(4 C - 4) + 0.615/C,
#
# with Wahl's factor K for the curvature of the wire and the direct shear. As a rod with waves
# along its axis, held at one end and driven at the other, it has the natural frequencies j f_1 with
#
#     f_1 = 1/2 sqrt(k/m),      m = rho pi^2 d^2 D n / 4,
#
# the mass of the active coils. Its ends seated so that a buckled spring has the effective length
# alpha L_0, a spring of steel is stable at any deflection if its free length L_0 < 2.63 D/alpha.
# Budynas, Nisbett, Shigley's Mechanical Engineering Design, 8th ed., chapter 10; Wahl, Mechanical
# Springs, on the factor; Norton, Machine Design, chapter on springs.


Seats = Literal["flat", "flat-hinged", "hinged", "flat-free"]

EFFECTIVE: Final[Mapping[Seats, float]] = {
    "flat": 0.5,
    "flat-hinged": 0.707,
    "hinged": 1.0,
    "flat-free": 2.0,
}
"""alpha: effective length of the buckled spring as a share of its length, by its two seats."""

STABLE: Final = 2.63
"""Free length of a stable spring of steel in coil diameters, for alpha = 1."""


@dataclass(frozen=True, slots=True)
class HelicalSpring:
    """The spring.

    Attributes
    ----------
    wire : d [mm].
    coil : D [mm], above d.
    active, total : coils that deflect, n, and all coils.
    free_length : L_0 [mm], longer than the solid spring.
    shear_modulus : G [MPa].
    density : rho [t/mm^3].
    seats : see `EFFECTIVE`.
    strength : largest shear stress allowed [MPa]; None for no limit.
    """

    wire: float
    coil: float
    active: float
    total: float
    free_length: float
    shear_modulus: float
    density: float
    seats: Seats
    strength: float | None = None

    @property
    def index(self) -> float:
        """C."""
        return self.coil / self.wire

    @property
    def stiffness(self) -> float:
        """k [N/mm]."""
        return self.shear_modulus * self.wire / (8.0 * self.index**3 * self.active)

    @property
    def solid_length(self) -> float:
        """Length with all coils touching and ground ends [mm]."""
        return self.wire * self.total

    @property
    def solid_force(self) -> float:
        """Force at that length [N]."""
        return self.stiffness * (self.free_length - self.solid_length)

    @property
    def stress_per_force(self) -> float:
        """tau/F [1/mm^2]."""
        index = self.index
        factor = (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index
        return factor * 8.0 * index / (math.pi * self.wire**2)

    @property
    def stable_length(self) -> float:
        """Free length below which it cannot buckle [mm]."""
        return STABLE * self.coil / EFFECTIVE[self.seats]

    @property
    def surge_frequency(self) -> float:
        """2 pi f_1 [rad/s]."""
        mass = 0.25 * self.density * math.pi**2 * self.wire**2 * self.coil * self.active
        return math.pi * math.sqrt(self.stiffness / mass)


# -- unknowns -------------------------------------------------------------------------------------
# What is solved for to find how the cam turns, and how an elastic train acts back on it.


@dataclass(frozen=True, slots=True)
class Feedback:
    """The last of the rounds in which an elastic train and how the cam turns are computed for each
    other.

    Attributes
    ----------
    rounds : their number.
    residual : the largest difference of the speed that it finds from the one that the train is
        computed for [rad/s].
    ratio : what is left of a change after a round, as estimated from the last ones.
    """

    rounds: int
    residual: float
    ratio: float


@dataclass(frozen=True, slots=True, eq=False)
class Unknown:
    """A quantity over the cam angle that an equation of motion is solved for.

    Attributes
    ----------
    label : how it is displayed.
    values : (n,) at n cam angles [rad].
    bound : its error.
    """

    label: Label
    values: Callable[[FloatArray], FloatArray]
    bound: Bound


# -- lost contact ---------------------------------------------------------------------------------
# Where the follower leaves its only flank.


@dataclass(frozen=True, slots=True)
class LowRange:
    """A range of the turn, and the smallest value in it.

    Attributes
    ----------
    start, end : cam angles [rad] in [0, 2 pi]; the end is below the start if the range passes cam
        angle 0.
    lowest : the smallest value and its cam angle.
    """

    start: float
    end: float
    lowest: Extreme


@dataclass(frozen=True, slots=True)
class LostContact:
    """Where the follower leaves its only flank, at one speed of the cam.

    Attributes
    ----------
    ranges : in which the flank would have to pull, each with its lowest force [N].
    leaps : cam angles [rad] at which the velocity of a mass jumps away from the flank.
    """

    ranges: tuple[LowRange, ...] = ()
    leaps: tuple[float, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.ranges or self.leaps)

    @property
    def lowest(self) -> Extreme | None:
        """The lowest force [N] of all ranges; None if there are only leaps."""
        return min(
            (low_range.lowest for low_range in self.ranges), key=lambda low: low.value, default=None
        )
