"""The linkages by the circles that cross in a joint, for series of the demanded motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

from mpmath import mp

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from tests.stability.high_precision import Number
from tests.stability.series import Series, direction, logarithm, root

Transform = Callable[[Series], Series]
"""Raises GeometryError if the linkage does not close."""


@singledispatch
def exact_linkage(linkage: Any, *numbers: Number) -> tuple[Transform, Transform]:
    """The follower's motion over the demanded position, and the value compared.

    That value is a crank's position [rad], of which its motion is a difference, or the stroke of a
    slider [mm]. `numbers` are the lengths and angles of `linkage`, as in `Stage.parameters`.
    """
    raise TypeError(type(linkage), numbers)


@exact_linkage.register
def _(
    linkage: SliderCrank, crank: Number, coupler: Number, deflection: Number
) -> tuple[Transform, Transform]:
    lean = crank * mp.sin(deflection)
    start = linkage.slider_side * (coupler - lean if linkage.leans_away else coupler + lean)
    height = crank * mp.cos(deflection)

    def crank_angle(stroke: Series) -> Series:
        """theta [rad]: the pin's angle minus that of the triangle of shaft, tip and pin."""
        pin = -(start + linkage.stroke_direction * stroke) + mp.mpc(0, 1) * height
        # Measured from straight above the shaft: a pin on the guide through the shaft stays off the
        # branch cut of the logarithm whichever way half an ulp moves it.
        upward = logarithm(pin * mp.mpc(0, -1)).imag
        angle: Series = upward + mp.pi / 2 - linkage.branch * _triangle(crank, coupler, pin)
        return angle

    def swing(stroke: Series) -> Series:
        """psi [rad] from stroke 0, counter-clockwise positive, in (-pi, pi]."""
        psi = crank_angle(stroke) - crank_angle(Series((mp.mpf(0),))).terms[0]
        psi = psi - 2 * mp.pi * mp.ceil((psi.terms[0] - mp.pi) / (2 * mp.pi))
        turned: Series = -psi if linkage.mirrored else psi
        return turned

    return swing, crank_angle


@exact_linkage.register
def _(
    linkage: FourBar,
    crank: Number,
    coupler: Number,
    length: Number,
    shaft_x: Number,
    shaft_y: Number,
    lever_angle: Number,
) -> tuple[Transform, Transform]:
    shaft = mp.mpc(shaft_x, shaft_y)

    def crank_angle(motion: Series) -> Series:
        """theta [rad]: the pin's angle minus that of the triangle of shaft, tip and pin.

        The pin's angle is continuous: it is that of the longer of shaft and lever, from which the
        pin stays within a quarter turn, plus the difference.
        """
        lever = linkage.lever_sense * motion + lever_angle
        arm = length * direction(lever)
        if abs(shaft) > length:
            about, rest = logarithm((arm + shaft) / shaft).imag, mp.arg(shaft)
        else:
            about, rest = logarithm((arm + shaft) / arm).imag, lever
        angle: Series = about + rest - linkage.branch * _triangle(crank, coupler, arm + shaft)
        return angle

    def swing(motion: Series) -> Series:
        """psi [rad] from motion 0, counter-clockwise positive."""
        psi: Series = crank_angle(motion) - crank_angle(Series((mp.mpf(0),))).terms[0]
        return psi

    return swing, crank_angle


@exact_linkage.register
def _(
    linkage: SliderDrivenCrank, crank: Number, coupler: Number, deflection: Number
) -> tuple[Transform, Transform]:
    inner, height = linkage.inner, crank * mp.cos(deflection)
    crank_angle = exact_linkage(inner, crank, coupler, deflection)[1]

    def pin(theta: Series) -> Series:
        tip = crank * direction(theta)
        square = coupler**2 - (height - tip.imag) ** 2
        _check_reach(square, "the coupler does not reach the guide")
        place: Series = tip.real + linkage.side * root(square)
        return place

    def stroke(motion: Series) -> Series:
        """s [mm] from angle 0."""
        start = crank_angle(Series((mp.mpf(0),))).terms[0]
        turned = -motion if inner.mirrored else motion
        way = pin(turned + start) - pin(Series((start,))).terms[0]
        found: Series = -inner.stroke_direction * way
        return found

    return stroke, stroke


def _triangle(crank: Number, coupler: Number, pin: Series) -> Series:
    """Angle at the shaft of the triangle shaft, tip, pin [rad], by the law of cosines.

    GeometryError if crank and coupler do not reach the pin, or are collinear.
    """
    square = pin.real**2 + pin.imag**2
    opposite = (square + (crank**2 - coupler**2)) / (2 * crank * root(square))
    across = 1 - opposite**2
    _check_reach(across, "crank and coupler do not reach the pin")
    angle: Series = logarithm(opposite + mp.mpc(0, 1) * root(across)).imag
    return angle


def _check_reach(square: Series, fault: str) -> None:
    """GeometryError where a root is not real, or lacks derivatives that are requested."""
    if not square.terms[0] > 0 and (len(square.terms) > 1 or square.terms[0] < 0):
        raise GeometryError(fault, key="linkage")
