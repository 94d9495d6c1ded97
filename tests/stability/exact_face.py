"""A cam under a flat face by its definition: the envelope of the lines of the face in the cam
frame.

Nothing here is shared with the engine: the contact is where a line crosses its neighbour, by
Cramer's rule, and its derivatives are those of the series.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from tests.stability.exact_cam import TERMS, Stage
from tests.stability.high_precision import Number
from tests.stability.series import Series, direction, variable


@dataclass(frozen=True, slots=True, eq=False)
class FaceJet:
    """A flat face and its contact at one cam angle, seen from the cam.

    Attributes
    ----------
    lift : [mm or rad].
    normal : of the face, away from the cam axis.
    distance : of the face from the cam axis [mm].
    along : direction along the face in which the place of the contact is measured.
    origin : point from which the place of the contact is measured, or the point above it [mm].
    rotation : sigma.
    """

    lift: Series
    normal: Series
    distance: Series
    along: Series
    origin: Series
    rotation: int

    @property
    def contact(self) -> Series:
        """Z [mm], a term shorter than the lift."""
        a, b, h = (_shorter(each) for each in (self.normal.real, self.normal.imag, self.distance))
        a1, b1, h1 = self.normal.real.slope(), self.normal.imag.slope(), self.distance.slope()
        cross = a * b1 - b * a1
        x, y = (h * b1 - b * h1) / cross, (a * h1 - h * a1) / cross
        contact: Series = x + y * mp.mpc(0, 1)
        return contact

    @property
    def turn(self) -> Series:
        """tau, a term shorter than the lift."""
        turn: Series = -self.rotation * _dot(_square_to(_shorter(self.normal)), self.normal.slope())
        return turn

    @property
    def pace(self) -> Series:
        """p [mm/rad], two terms shorter than the lift: the part of Z' along t."""
        t = -self.rotation * _square_to(_shorter(_shorter(self.normal)))
        return _dot(t, self.contact.slope())

    @property
    def place(self) -> Series:
        """The place of the contact along the face [mm], a term shorter than the lift."""
        return _dot(_shorter(self.along), self.contact - _shorter(self.origin))

    @property
    def pressure_angle(self) -> Number:
        """Acute angle between the face's normal and the way of a rocker's contact [rad]."""
        lever = self.contact.terms[0] - self.origin.terms[0]
        turned = lever * mp.conj(self.normal.terms[0])
        return mp.atan2(abs(mp.re(turned)), abs(mp.im(turned)))


def face_jet(stage: Stage, phi: Number, parameters: Sequence[Number]) -> FaceJet:
    """The face at the cam angle `phi` [rad]; `parameters` as of `Stage`.

    GeometryError if the face cannot be that far from the cam axis.
    """
    s = stage.demanded(phi, parameters, TERMS)
    base, *rest = parameters[6:]
    follower = stage.follower
    normal, distance, along, origin = _held(follower, s, base, *rest)
    turn = direction(variable(-stage.rotation * phi, -stage.rotation, TERMS))
    return FaceJet(s, normal * turn, distance, along * turn, origin * turn, stage.rotation)


@singledispatch
def _held(follower: Any, *_: Any) -> tuple[Series, Series, Series, Series]:
    """Normal, distance, direction and origin of the face in the fixed frame, see `FaceJet`."""
    raise TypeError(type(follower))


@_held.register
def _on_guide(
    follower: TranslatingFlat, s: Series, base: Number, guide: Number
) -> tuple[Series, Series, Series, Series]:
    normal = variable(mp.expj(guide), 0, TERMS)
    along = normal / mp.mpc(0, 1)  # to the right
    return normal, base + follower.direction * s, along, variable(mp.mpf(0), 0, TERMS)


@_held.register
def _on_rocker(
    follower: OscillatingFlat, s: Series, base: Number, x: Number, y: Number, offset: Number
) -> tuple[Series, Series, Series, Series]:
    pivot = mp.mpc(x, y)
    if not abs(base - offset) < abs(pivot):
        raise GeometryError("the face cannot lie there", key="follower.base_radius")
    corner = mp.asin((base - offset) / abs(pivot))
    side = follower.arm_side
    sense = 1 if follower.direction is None else follower.direction * side
    along = direction(sense * s + (mp.arg(-pivot) + side * corner))
    normal = along * mp.mpc(0, side)
    origin = variable(pivot, 0, TERMS)
    return normal, _dot(normal, origin) + offset, along, origin


def _shorter(x: Series) -> Series:
    return Series(x.terms[:-1])


def _dot(a: Series, b: Series) -> Series:
    product: Series = a.real * b.real + a.imag * b.imag
    return product


def _square_to(x: Series) -> Series:
    turned: Series = x * mp.mpc(0, 1)
    return turned
