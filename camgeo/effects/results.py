"""The results that effects ask of each other: their keys, and what each of them gives.

The result of an effect that no other one asks for is a class of its own package.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

from camgeo.effects.effect import Key, Result

if TYPE_CHECKING:
    from collections.abc import Callable

    from camgeo.effects.effect import Quantity
    from camgeo.effects.force import Force
    from camgeo.motion.motion import Side
    from camgeo.numeric.arrays import ComplexArray, FloatArray
    from camgeo.numeric.extremes import Extremes


@dataclass(frozen=True, slots=True, eq=False)
class Acting(Result):
    """What acts on the follower.

    Attributes
    ----------
    force : the generalised force; of friction that in which the normal force has no part: viscous
        friction, and that of a slider. Its potential energy, if there is one, is 0 at cam angle 0.
    """

    force: Force


class Mass(Protocol):
    """A mass in its centre."""

    @property
    def name(self) -> str:
        """Of what: "follower", "roller", "rocker", "slider" or "coupler"."""

    @property
    def mass(self) -> float:
        """[t]."""

    def place(self, phi: FloatArray, side: Side, /) -> ComplexArray:
        """(n,) complex [mm] where it is, seen from the cam axis, as the drawing of the cam has it.

        A translating follower is taken to be in its roller's centre, or in the foot of the cam axis
        on its face, and a slider in its pin: where on the body does not matter for a body that does
        not turn.
        """

    def per_lift(self, phi: FloatArray, side: Side, /) -> ComplexArray:
        """(n,) complex [1 or mm/rad] how its place goes with the follower's coordinate."""


@dataclass(frozen=True, slots=True, eq=False)
class Inertia(Acting):
    """The masses that are moved, and their inertia force: c2 and c3.

    Attributes
    ----------
    masses : those with a weight; 0 is left out.
    moved : what moves with the demanded motion [t, or t mm^2 if it turns].
    to_follower : M(q) (n,) [t, or t mm^2 for a rocker], all of them reduced to the follower: T = M
        (dq/dt)^2 / 2. The sum of m (dx/dq)^2 over all coordinates: equal kinetic energy (Volmer,
        "Getriebetechnik", on reduced masses; Norton, "Cam Design and Manufacturing Handbook", on
        effective masses in dynamic models of cam systems).
    """

    masses: tuple[Mass, ...]
    moved: float
    to_follower: Quantity


@dataclass(frozen=True, slots=True, eq=False)
class Spring(Acting):
    """A linear spring that closes the contact.

    Attributes
    ----------
    way : x (n,), by how much it has relaxed since cam angle 0 [mm or rad], and dx/dq (n,).
    preload, stiffness : P [N] and k [N/mm]; of a torsion spring [N mm] and [N mm/rad].
    unit_of_preload, unit_of_stiffness : in which to show the two; "N" and "N/mm", or "N m" and
        "N m/rad", of which one is 1000 of those inside.
    """

    way: Callable[[FloatArray, Side], tuple[FloatArray, FloatArray]]
    preload: float
    stiffness: float
    unit_of_preload: str
    unit_of_stiffness: str

    def per_preload(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) dx/dq: generalised force per unit of preload."""
        return self.way(phi, side)[1]

    def per_stiffness(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) -x dx/dq: generalised force per unit of stiffness."""
        x, rate = self.way(phi, side)
        return -x * rate


@dataclass(frozen=True, slots=True, eq=False)
class Friction(Acting):
    """Friction of the follower.

    Attributes
    ----------
    per_normal : (2, n) what friction adds per unit of |N| at n cam angles, on the side `sense`, see
        `carrier`: [0] generalised force on q [1 or mm/rad]; [1] torque on the cam [mm], that is
        N mm per N, positive where the cam has to be driven more. Coulomb's friction of guide and
        pivot is in [0] alone, and none in a rest; the roller turns, and a face slides, in a rest
        too. GeometryError at a cusp.
    """

    per_normal: Callable[[FloatArray, Side, int], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class ContactForce(Result):
    """The normal force N [N] on the follower, positive where the inner flank carries.

    Of a conjugate pair it is positive where the main disc carries, negative where the return disc
    does; the other one carries nothing then.

    Attributes
    ----------
    forces : all forces on the follower but that of the contact.
    friction : None if the scene names none.
    edges : (k,) cam angles [rad] from 0 to 2 pi: N is smooth between them and keeps its sign.
    extremes : smallest and largest N of the turn, signed.
    required : (4, n) coefficients of the generalised force R that the contact has to give.
    normal : (n,) N at the scene's speed, or at rest if it has none.
    normal_at : (n,) N at n cam angles and at rates (2, n): omega [rad/s] and alpha [rad/s^2].
    bracket : (n,) [1 or mm/rad] R per unit of |N| at n cam angles, on the side `sense`, see
        `carrier`.
    """

    forces: tuple[Force, ...]
    friction: Friction | None
    edges: FloatArray
    extremes: Extremes
    required: Quantity
    normal: Quantity
    normal_at: Callable[[FloatArray, Side, FloatArray], FloatArray]
    bracket: Callable[[FloatArray, Side, int], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class DriveTorque(Result):
    """The torque on the camshaft.

    Attributes
    ----------
    contact : what it has to give.
    law : (6, n) c0 to c3 of R, then torque by R [N mm per unit of R] for R > 0 and for R < 0.
    at : (n,) [N mm] at n cam angles, with the cam turning at omega [rad/s] and alpha [rad/s^2].
    torque : (n,) [N mm] with the cam turning as the scene says; very slowly if it gives no speed.
    static : (n,) [N mm] with the cam turning very slowly: without inertia and viscous friction.
    edges : (k,) cam angles [rad] from 0 to 2 pi, ascending, between which the torque is smooth.
    """

    contact: ContactForce
    law: Quantity
    at: Callable[[FloatArray, Side, FloatArray | float, FloatArray | float], FloatArray]
    torque: Quantity
    static: Quantity
    edges: FloatArray


INERTIA: Final = Key[Inertia]("inertia")
GRAVITY: Final = Key[Acting]("gravity")
LOAD: Final = Key[Acting]("load")
SPRING: Final = Key[Spring]("spring")
FRICTION: Final = Key[Friction]("friction")
CONTACT_FORCE: Final = Key[ContactForce]("contact-force")
DRIVE_TORQUE: Final = Key[DriveTorque]("drive-torque")
