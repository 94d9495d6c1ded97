"""What is to be sized, and the conditions that a place of the cam axis must meet.

The place is a complex number P [mm] in axes in which the follower starts at a fixed point:

- translating: P = e - i s_G, roller centre at cam angle 0 in the origin, guide upwards, mirrored so
  that a positive offset is positive;
- oscillating: P = l_1 exp(-i psi_G), pivot in the origin, the arm at cam angle 0 along the x axis,
  mirrored if the arm lies clockwise of the line pivot -> cam axis.

With a = r P, r = 1 for a guide and exp(-i psi) for a rocker, the parts of Z' across and along the
follower are u = p - Im a, v = q - Re a (Wirsig section 3.3.4), linear in P. A transmission angle of
at least mu is u >= T v and u >= -T v, T = tan mu: two half-planes at each cam angle.
"""

from __future__ import annotations

import cmath
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.curve.extremes import Extremes, extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Jet, Motion
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side


@dataclass(frozen=True, slots=True, eq=False)
class Terms:
    """What u, v and the curvature are made of at n cam angles, see the module.

    Attributes
    ----------
    p, q : (n,) [mm/rad].
    turn : (n,) complex r, of magnitude 1.
    alpha, beta : (n,) [mm/rad^2]; |Z'|^3 kappa = |Z'|^2 - alpha u + beta v.
    p1, q1, turning : (n,) dp/dphi, dq/dphi, and d(-arg r)/dphi.
    """

    p: FloatArray
    q: FloatArray
    turn: ComplexArray
    alpha: FloatArray
    beta: FloatArray
    p1: FloatArray
    q1: FloatArray
    turning: FloatArray

    def across_and_along(self, place: complex | ComplexArray) -> tuple[FloatArray, FloatArray]:
        """u, v [mm/rad] for one place, or (k, n) for places (k, 1)."""
        seen = self.turn * place
        return self.p - seen.imag, self.q - seen.real

    def curvature(self, place: complex | ComplexArray) -> FloatArray:
        """kappa [1/mm], shape as of `across_and_along`; Z' must not vanish."""
        u, v = self.across_and_along(place)
        square = u * u + v * v
        kappa: FloatArray = (square - self.alpha * u + self.beta * v) / (square * np.sqrt(square))
        return kappa

    def half_planes(self, tangent: float) -> tuple[ComplexArray, FloatArray]:
        """Normals n (n,) and c (n,) of u >= `tangent` v, which is Re(conj(n) P) >= c."""
        return np.conj((tangent + 1j) * self.turn), tangent * self.q - self.p


@dataclass(frozen=True, slots=True)
class Task(ABC):
    """A cam whose axis is to be placed beside its follower, see `task_of`.

    Attributes
    ----------
    cam : the present design; the follower's arm, roller radius and directions are kept.
    second : the quantity that, with the base radius, determines a place.
    held : the pivot [mm]; None on a guide.
    start : roller centre at cam angle 0 [mm].
    present : place of the cam axis in the present design [mm].
    seen : sense of x and of y of a picture, by the real and the imaginary part of a place.
    """

    cam: Cam

    second: ClassVar[str]
    held: ClassVar[complex | None]

    if TYPE_CHECKING:  # that every kind has

        @property
        def start(self) -> complex: ...

        @property
        def seen(self) -> tuple[int, int]: ...

    @property
    @abstractmethod
    def present(self) -> complex:
        """See the class."""

    @abstractmethod
    def second_of(self, place: complex) -> float:
        """That quantity [mm] at `place`."""

    @abstractmethod
    def moved(self, place: complex) -> dict[str, float | complex]:
        """Values [mm] of the follower, by its scene's keys, with the cam axis at `place`."""

    @abstractmethod
    def terms_of(self, lift: Jet) -> Terms:
        """What the conditions are made of for lifts (3, n), not necessarily of one motion."""

    @property
    def motion(self) -> Motion:
        """The follower's own motion [mm or rad]."""
        return self.cam.drive.motion

    @property
    def follower(self) -> Any:
        """The follower of the present design."""
        return self.cam.follower

    @property
    def signs(self) -> tuple[float, ...]:
        """Sign of the curvature that counts for each flank in use: an inner flank runs inside."""
        return tuple(-float(flank.sign) for flank in self.cam.contact.flanks)

    def follower_at(self, place: complex) -> Any:
        """The follower with the cam axis at `place` [mm]; a rocker keeps its pivot's direction.

        GeometryError if there is no such mechanism.
        """
        return replace(self.follower, base_radius=abs(place - self.start), **self.moved(place))

    def pitch_curve_at(self, place: complex) -> PitchCurve:
        """The pitch curve with the cam axis at `place` [mm]."""
        return PitchCurve(self.motion, self.follower_at(place), self.cam.rotation)

    def terms(self, phi: FloatArray, side: Side = "right") -> Terms:
        """What the conditions are made of at `phi` (n,) [rad]."""
        return self.terms_of(self.motion.jet(phi, side, 2))

    def slack(self, place: complex, tangent: float) -> Extremes:
        """Local extremes of u - `tangent` v [mm/rad] over the turn, by the roots of its slope."""

        def value(phi: FloatArray, side: Side) -> FloatArray:
            u, v = self.terms(phi, side).across_and_along(place)
            return np.asarray(u - tangent * v)

        def slope(phi: FloatArray, side: Side) -> FloatArray:
            terms = self.terms(phi, side)
            seen = terms.turn * place
            u1 = terms.p1 + terms.turning * seen.real
            v1 = terms.q1 - terms.turning * seen.imag
            return np.asarray(u1 - tangent * v1)

        return extremes(self.motion, value, slope)


class OnGuide(Task):
    """On a guide, upright, below which the axis lies anywhere."""

    __slots__ = ()

    second = "offset"
    held = None
    start = 0j
    seen = (-1, 1)

    @property
    def present(self) -> complex:
        """See `Task`."""
        return complex(self.follower.offset, -self.follower.start_height)

    def second_of(self, place: complex) -> float:
        """See `Task`: the offset."""
        return place.real

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Task`."""
        return {"offset": place.real}

    def terms_of(self, lift: Jet) -> Terms:
        """See `Task`."""
        one, none = np.ones(lift.shape[1], dtype=np.complex128), np.zeros(lift.shape[1])
        height, rate, bend = self.follower.direction * lift[:3]
        q = self.cam.rotation * rate
        return Terms(height, q, one, bend, q, rate, self.cam.rotation * bend, none)


class OnRocker(Task):
    """On a rocker: the axis lies anywhere about its pivot, whose direction from it is kept."""

    __slots__ = ()

    second = "pivot at"
    held = 0j

    @property
    def start(self) -> complex:
        """See `Task`."""
        return complex(self.follower.arm)

    @property
    def present(self) -> complex:
        """See `Task`."""
        return cmath.rect(self.follower.centre_distance, -self.follower.start_angle)

    @property
    def seen(self) -> tuple[int, int]:
        """See `Task`."""
        return 1, self.follower.arm_side

    def second_of(self, place: complex) -> float:
        """See `Task`: the distance of the pivot from the cam axis."""
        return abs(place)

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Task`."""
        away = self.follower.pivot / self.follower.centre_distance
        return {"pivot": away * abs(place)}

    def terms_of(self, lift: Jet) -> Terms:
        """See `Task`."""
        none, arm = np.zeros(lift.shape[1]), self.follower.arm
        sense = self.follower.arm_side * self.follower.swing_sense
        turning = self.follower.arm_side * self.cam.rotation
        angle, rate, bend = sense * lift[:3]
        along = turning * rate
        q = arm * (1.0 - along)
        return Terms(
            none, q, np.exp(-1j * angle), arm * bend, -along * q,
            none, -arm * turning * bend, rate,
        )  # fmt: skip


TASKS: Final[dict[type[Follower], type[Task]]] = {
    TranslatingRoller: OnGuide,
    OscillatingRoller: OnRocker,
}
"""The task by the class of the follower."""


def task_of(cam: Cam) -> Task:
    """The task of placing the axis of `cam`.

    GeometryError with key "follower.kind" if its follower has no roller.
    """
    kind = TASKS.get(type(cam.follower))
    if kind is None:
        name = cam.follower.kind
        message = f'this needs a roller follower, and this one is "{name}"'
        raise GeometryError(message, key="follower.kind", value=name)
    return kind(cam)
