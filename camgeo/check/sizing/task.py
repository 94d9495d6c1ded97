"""What is to be sized, and the conditions that a place of the cam axis must meet.

The place is a complex number P [mm] in axes in which the follower starts at a fixed point:

- translating: P = e - i s_G, roller centre at cam angle 0 in the origin, guide upwards, mirrored so
  that a positive offset is positive;
- oscillating: P = l_1 exp(-i psi_G), pivot in the origin, the arm at cam angle 0 along the x axis,
  mirrored if the arm lies clockwise of the line pivot -> cam axis.

With a = r P, r = 1 for a guide and exp(-i psi) for a rocker, the parts of Z' across and along the
follower are u = p - Im a, v = q - Re a (Wirsig section 3.3.4), linear in P. A transmission angle of
at least mu is u >= T v and u >= -T v, T = tan mu: two half-planes at each cam angle.

Turned with the cam, the roller centre is (B - P) exp(-i sense phi), B its place in those axes.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.sizing.placing import Placing, Rocking
from camgeo.curve.extremes import Extremes, extremes
from camgeo.errors import GeometryError
from camgeo.mechanism.follower import Follower
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Jet
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
    centre : (n,) complex, the roller centre in the axes of the follower: r B [mm].
    """

    p: FloatArray
    q: FloatArray
    turn: ComplexArray
    alpha: FloatArray
    beta: FloatArray
    p1: FloatArray
    q1: FloatArray
    turning: FloatArray
    centre: ComplexArray

    def to_axis(self, place: complex | ComplexArray) -> FloatArray:
        """Distance of the roller centre from the cam axis [mm], shape as of `across_and_along`."""
        distance: FloatArray = np.abs(self.centre - self.turn * place)
        return distance

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
class Task(Placing):
    """A cam with a roller, whose axis is to be placed beside its follower, see `task_of`.

    Attributes
    ----------
    start : roller centre at cam angle 0 [mm].
    sense : in which the cam turns in the axes of places: +1 counter-clockwise, -1 clockwise.
    directions : the first and the last direction [rad] in which the cam axis may lie from the
        roller centre at cam angle 0.
    """

    if TYPE_CHECKING:  # that every kind has

        @property
        def start(self) -> complex: ...

        @property
        def sense(self) -> int: ...

    @property
    def directions(self) -> tuple[float, float]:
        """See the class."""
        return -math.pi, 0.0

    @abstractmethod
    def terms_of(self, lift: Jet) -> Terms:
        """What the conditions are made of for lifts (3, n), not necessarily of one motion."""

    def base_radius_at(self, place: complex) -> float:
        """See `Placing`."""
        return abs(place - self.start)

    @property
    def signs(self) -> tuple[float, ...]:
        """Sign of the curvature that counts for each flank in use: an inner flank runs inside."""
        return tuple(-float(flank.sign) for flank in self.cam.contact.flanks)

    @property
    def half(self) -> float:
        """Distance [mm] that the roller centre must keep from the cam axis; 0 in a ring."""
        return self.cam.disc.flank_distance if self.cam.contact.runs_inside else 0.0

    def held_to(self) -> tuple[ComplexArray, FloatArray]:
        """Normals n (k,) and c (k,) of the half-planes Re(conj(n) P) >= c of its directions."""
        if self.directions[0] < self.directions[1]:
            return np.empty(0, dtype=np.complex128), np.empty(0)
        return np.array([1.0 + 0j, -1.0 + 0j]), np.zeros(2)

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
    def sense(self) -> int:
        """See `Task`: the axes are mirrored."""
        return -self.cam.rotation

    @property
    def directions(self) -> tuple[float, float]:
        """See `Task`: both rollers of a yoke lie in line with the cam axis."""
        below = -0.5 * math.pi
        return (-math.pi, 0.0) if self.cam.yoke is None else (below, below)

    @property
    def present(self) -> complex:
        """See `Task`."""
        return complex(self.follower.offset, -self.follower.start_height)

    def second_of(self, place: complex) -> float:
        """See `Task`: the offset."""
        return place.real

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Placing`."""
        return {"offset": place.real if self.cam.yoke is None else 0.0}

    def terms_of(self, lift: Jet) -> Terms:
        """See `Task`."""
        one, none = np.ones(lift.shape[1], dtype=np.complex128), np.zeros(lift.shape[1])
        height, rate, bend = self.follower.direction * lift[:3]
        q = self.cam.rotation * rate
        bend_of_q = self.cam.rotation * bend
        return Terms(height, q, one, bend, q, rate, bend_of_q, none, 1j * height)


class OnRocker(Rocking, Task):
    """On a rocker: the axis lies anywhere about its pivot, whose direction from it is kept."""

    __slots__ = ()

    @property
    def start(self) -> complex:
        """See `Task`."""
        return complex(self.follower.arm)

    @property
    def sense(self) -> int:
        """See `Task`."""
        turning: int = self.cam.rotation * self.follower.arm_side
        return turning

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
            none, -arm * turning * bend, rate, np.full(len(q), complex(arm)),
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
