"""Where the cam axis may be placed beside a follower, for each kind of roller follower.

Places, and the terms of the conditions, are as of `camgeo.check.sizing.task`.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Any, Protocol

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray


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


class Places(Protocol):
    """The places of the cam axis for one follower.

    Attributes
    ----------
    start : roller centre at cam angle 0 [mm].
    present : place of the cam axis in the present design [mm].
    second : what tells a place besides the base radius.
    seen : sense of x and of y of a picture, by the real and the imaginary part of a place.
    held : the pivot [mm]; None on a guide.
    """

    @property
    def start(self) -> complex: ...

    @property
    def present(self) -> complex: ...

    @property
    def second(self) -> str: ...

    @property
    def seen(self) -> tuple[int, int]: ...

    @property
    def held(self) -> complex | None: ...

    def second_of(self, place: complex) -> float:
        """That length [mm] of `place`."""

    def moved(self, place: complex) -> dict[str, float | complex]:
        """Values [mm] of the follower, by its scene's keys, with the cam axis at `place`."""

    def record(self, place: complex) -> dict[str, Any]:
        """The same with its names for JSON."""

    def terms(self, lift: Jet, rotation: int) -> Terms:
        """What the conditions are made of for lifts (3, n), which need not belong together."""


@dataclass(frozen=True, slots=True)
class OnGuide:
    """A guide upwards, beside which the axis lies anywhere below."""

    follower: TranslatingRoller
    start: complex = 0j
    second: str = "offset"
    seen: tuple[int, int] = (-1, 1)
    held: complex | None = None

    @property
    def present(self) -> complex:
        """See `Places`."""
        return complex(self.follower.offset, -self.follower.start_height)

    def second_of(self, place: complex) -> float:
        """See `Places`: the offset."""
        return place.real

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Places`."""
        return {"offset": place.real}

    def record(self, place: complex) -> dict[str, Any]:
        """See `Places`."""
        return {"offset_mm": place.real}

    def terms(self, lift: Jet, rotation: int) -> Terms:
        """See `Places`."""
        one, none = np.ones(lift.shape[1], dtype=np.complex128), np.zeros(lift.shape[1])
        height, rate, bend = self.follower.direction * lift[:3]
        q = rotation * rate
        return Terms(height, q, one, bend, q, rate, rotation * bend, none)


@dataclass(frozen=True, slots=True)
class OnRocker:
    """A rocker, about whose pivot the axis lies anywhere in the direction that the pivot has."""

    follower: OscillatingRoller
    second: str = "pivot at"
    held: complex | None = 0j

    @property
    def start(self) -> complex:
        """See `Places`."""
        return complex(self.follower.arm)

    @property
    def present(self) -> complex:
        """See `Places`."""
        return cmath.rect(self.follower.centre_distance, -self.follower.start_angle)

    @property
    def seen(self) -> tuple[int, int]:
        """See `Places`."""
        return 1, self.follower.arm_side

    def second_of(self, place: complex) -> float:
        """See `Places`: the distance of the pivot from the cam axis."""
        return abs(place)

    def moved(self, place: complex) -> dict[str, float | complex]:
        """See `Places`."""
        away = self.follower.pivot / self.follower.centre_distance
        return {"pivot": away * abs(place)}

    def record(self, place: complex) -> dict[str, Any]:
        """See `Places`."""
        away = self.follower.pivot / self.follower.centre_distance
        pivot = away * abs(place)
        return {
            "arm_mm": self.follower.arm,
            "pivot_mm": [pivot.real, pivot.imag],
            "pivot_distance_mm": abs(place),
        }

    def terms(self, lift: Jet, rotation: int) -> Terms:
        """See `Places`."""
        none, arm = np.zeros(lift.shape[1]), self.follower.arm
        sense = self.follower.arm_side * self.follower.swing_sense
        turning = self.follower.arm_side * rotation
        angle, rate, bend = sense * lift[0], sense * lift[1], sense * lift[2]
        along = turning * rate
        q = arm * (1.0 - along)
        return Terms(
            none, q, np.exp(-1j * angle), arm * bend, -along * q,
            none, -arm * turning * bend, rate,
        )  # fmt: skip


@singledispatch
def places_of(follower: Any) -> Places:
    """The places for a follower; GeometryError with key "follower.kind" if it has no roller."""
    message = f'what is asked for is for roller followers, and this one is "{follower.kind}"'
    raise GeometryError(message, key="follower.kind", value=follower.kind)


@places_of.register
def _(follower: TranslatingRoller) -> Places:
    return OnGuide(follower)


@places_of.register
def _(follower: OscillatingRoller) -> Places:
    return OnRocker(follower)


def at_place(follower: Any, places: Places, place: complex) -> Any:
    """The follower with the cam axis at `place` [mm]; GeometryError if there is no such mechanism.

    A rocker keeps the direction in which the pivot lies.
    """
    return replace(follower, base_radius=abs(place - places.start), **places.moved(place))
