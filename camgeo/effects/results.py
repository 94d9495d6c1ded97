"""The results that effects ask of each other: their keys, and what each offers.

An effect offers more than stands here to whoever asks it from outside. What stands here is held
against it by the type checker: its `compute` promises it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Mapping

    from camgeo.effects.force import Force
    from camgeo.motion.motion import Side
    from camgeo.numeric.arrays import ComplexArray, FloatArray
    from camgeo.numeric.extremes import Extremes

Answer = TypeVar("Answer")
Answer_co = TypeVar("Answer_co", covariant=True)


class Key(str, Generic[Answer_co]):
    """The name of an effect, and the type of its result."""

    __slots__ = ()


class Results:
    """The results that an effect is given: of what it needs, and of what it uses that is named."""

    def __init__(self, by_name: Mapping[str, Any]) -> None:
        self._by_name = by_name

    def __getitem__(self, key: Key[Answer]) -> Answer:
        found: Answer = self._by_name[key]
        return found

    def get(self, key: Key[Answer]) -> Answer | None:
        """The result of the effect `key`; None if it is only used, and the scene names none."""
        return self._by_name.get(key)


class Acting(Protocol):
    """What acts on the follower."""

    @property
    def force(self) -> Force:
        """The generalised force; of friction that in which the normal force has no part."""


class Weighed(Protocol):
    """A mass in its centre."""

    @property
    def mass(self) -> float:
        """[t]."""

    def place(self, phi: FloatArray, side: Side, /) -> ComplexArray:
        """(n,) complex [mm] where it is, seen from the cam axis."""

    def per_lift(self, phi: FloatArray, side: Side, /) -> ComplexArray:
        """(n,) complex [1 or mm/rad] how its place goes with the follower's coordinate."""


class Inertia(Acting, Protocol):
    """The masses that are moved."""

    @property
    def masses(self) -> tuple[Weighed, ...]:
        """Those with a weight."""

    @property
    def moved(self) -> float:
        """What moves with the demanded motion [t, or t mm^2 if it turns]."""

    def to_follower(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) all of them, reduced to the follower [t, or t mm^2 for a rocker]."""


class Spring(Acting, Protocol):
    """The spring that closes the contact."""

    @property
    def preload(self) -> float:
        """[N or N mm]."""

    @property
    def stiffness(self) -> float:
        """[N/mm or N mm/rad]."""

    @property
    def unit_of_preload(self) -> str:
        """In which to show it: "N", or "N m" for 1000 N mm."""

    @property
    def unit_of_stiffness(self) -> str:
        """In which to show it: "N/mm", or "N m/rad" for 1000 N mm/rad."""

    def per_preload(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) generalised force per unit of preload."""

    def per_stiffness(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) generalised force per unit of stiffness."""


class Friction(Acting, Protocol):
    """Friction of the follower."""

    def per_normal(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(2, n) force on q, and torque on the cam, per unit of |N| on the side `sense`."""


class ContactForce(Protocol):
    """The normal force N [N] on the follower, positive where the inner flank carries."""

    @property
    def forces(self) -> tuple[Force, ...]:
        """All forces on the follower but that of the contact."""

    @property
    def friction(self) -> Friction | None:
        """None if the scene names none."""

    @property
    def edges(self) -> FloatArray:
        """(k,) cam angles [rad] from 0 to 2 pi: N is smooth between them and keeps its sign."""

    @property
    def extremes(self) -> Extremes:
        """Smallest and largest N of the turn."""

    def required(self, phi: FloatArray, side: Side) -> FloatArray:
        """(4, n) coefficients of the generalised force R that the contact has to give."""

    def bracket(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        """(n,) [1 or mm/rad] R per unit of |N| on the side `sense`, see `carrier`."""

    def normal(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) N at the scene's speed, or at rest if it has none."""

    def normal_at(
        self, phi: FloatArray, side: Side, omega: FloatArray, alpha: FloatArray
    ) -> FloatArray:
        """(n,) N at the speeds `omega` [rad/s] and accelerations `alpha` [rad/s^2], (n,)."""


class TorqueLaw(Protocol):
    """The torque on the camshaft as a law of its angle, speed and acceleration."""

    @property
    def contact(self) -> ContactForce:
        """What the torque has to give."""

    def coefficients(self, phi: FloatArray, side: Side) -> FloatArray:
        """(6, n) c0 to c3 of R, then torque by R [N mm per unit of R] for R > 0 and for R < 0."""


class DriveTorque(Protocol):
    """The torque on the camshaft."""

    @property
    def law(self) -> TorqueLaw:
        """At every speed."""


INERTIA: Final = Key[Inertia]("inertia")
GRAVITY: Final = Key[Acting]("gravity")
LOAD: Final = Key[Acting]("load")
SPRING: Final = Key[Spring]("spring")
FRICTION: Final = Key[Friction]("friction")
CONTACT_FORCE: Final = Key[ContactForce]("contact-force")
DRIVE_TORQUE: Final = Key[DriveTorque]("drive-torque")
