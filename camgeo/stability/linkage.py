"""The linkages by the circles that cross in a joint, for series of the demanded motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

from camgeo.errors import GeometryError
from camgeo.mechanism.crank_slider import CrankSlider
from camgeo.mechanism.four_bar import FourBar
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.stability.high_precision import Number, multiprecision
from camgeo.stability.series import Series, direction, logarithm, root

Transform = Callable[[Series], Series]


@dataclass(frozen=True, slots=True)
class ExactSliderCrank:
    """A slider-crank with exact lengths and angle, and the assembly of `SliderCrank`."""

    crank: Number
    coupler: Number
    deflection: Number
    assembly: SliderCrank

    def swing(self, stroke: Series) -> Series:
        """psi [rad] from stroke 0, counter-clockwise positive, in (-pi, pi].

        Raises
        ------
        GeometryError
            If crank and coupler do not reach the pin, or lie on one line.
        """
        mp = multiprecision()
        start = self.crank_angle(Series((mp.mpf(0),)))
        psi = self.crank_angle(stroke) - start.terms[0]
        psi = psi - 2 * mp.pi * mp.ceil((psi.terms[0] - mp.pi) / (2 * mp.pi))
        turned: Series = -psi if self.assembly.mirrored else psi
        return turned

    def crank_angle(self, stroke: Series) -> Series:
        """theta [rad]: the pin's angle less that of the triangle of shaft, tip and pin.

        By the law of cosines; raises as `swing` does.
        """
        mp = multiprecision()
        crank, coupler, how = self.crank, self.coupler, self.assembly
        lean = crank * mp.sin(self.deflection)
        start = how.slider_side * (coupler - lean if how.leans_away else coupler + lean)
        height = crank * mp.cos(self.deflection)
        pin = -(start + how.stroke_direction * stroke) + mp.mpc(0, 1) * height
        between = _triangle(crank, coupler, pin)
        # Counted from straight above the shaft: a pin on the guide through the shaft stays off the
        # cut of the logarithm whichever way half an ulp moves it.
        upward = logarithm(pin * mp.mpc(0, -1)).imag
        angle: Series = upward + mp.pi / 2 - how.branch * between
        return angle


@dataclass(frozen=True, slots=True)
class ExactFourBar:
    """A four-bar with exact lengths and angle, and the assembly of `FourBar`."""

    assembly: FourBar
    crank: Number
    coupler: Number
    lever: Number
    shaft_x: Number
    shaft_y: Number
    lever_angle: Number

    def swing(self, motion: Series) -> Series:
        """psi [rad] from motion 0, counter-clockwise positive; raises as `crank_angle` does."""
        start = self.crank_angle(Series((multiprecision().mpf(0),)))
        psi: Series = self.crank_angle(motion) - start.terms[0]
        return psi

    def crank_angle(self, motion: Series) -> Series:
        """theta [rad]: the pin's angle less that of the triangle of shaft, tip and pin.

        The pin's angle is continuous: it is that of the longer of shaft and lever, which the pin
        stays within a quarter turn of, and what lies between.

        Raises
        ------
        GeometryError
            If crank and coupler do not reach the pin, or lie on one line.
        """
        mp = multiprecision()
        shaft = mp.mpc(self.shaft_x, self.shaft_y)
        lever = self.assembly.lever_sense * motion + self.lever_angle
        arm = self.lever * direction(lever)
        if abs(shaft) > self.lever:
            about, rest = logarithm((arm + shaft) / shaft).imag, mp.arg(shaft)
        else:
            about, rest = logarithm((arm + shaft) / arm).imag, lever
        between = _triangle(self.crank, self.coupler, arm + shaft)
        angle: Series = about + rest - self.assembly.branch * between
        return angle


@dataclass(frozen=True, slots=True)
class ExactCrankSlider:
    """A slider behind a crank with exact lengths and angle, and the assembly of `CrankSlider`."""

    assembly: CrankSlider
    crank: Number
    coupler: Number
    deflection: Number

    def stroke(self, motion: Series) -> Series:
        """s [mm] from angle 0.

        Raises
        ------
        GeometryError
            If the coupler does not reach the guide, or stands across it.
        """
        mp = multiprecision()
        inner = self.assembly.inner
        linkage = ExactSliderCrank(self.crank, self.coupler, self.deflection, inner)
        start = linkage.crank_angle(Series((mp.mpf(0),))).terms[0]
        turned = -motion if inner.mirrored else motion
        way = self._pin(turned + start) - self._pin(Series((start,))).terms[0]
        stroke: Series = -inner.stroke_direction * way
        return stroke

    def _pin(self, theta: Series) -> Series:
        tip = self.crank * direction(theta)
        height = self.crank * multiprecision().cos(self.deflection)
        square = self.coupler**2 - (height - tip.imag) ** 2
        if not square.terms[0] > 0 and (len(square.terms) > 1 or square.terms[0] < 0):
            raise GeometryError("the coupler does not reach the guide", key="linkage")
        pin: Series = tip.real + self.assembly.side * root(square)
        return pin


@singledispatch
def exact_linkage(linkage: Any, *numbers: Number) -> tuple[Transform, Transform]:
    """The follower's motion over what is demanded, and what is told of it.

    That is a crank's position [rad], which its motion is a difference of, or the stroke of a slider
    [mm]. `numbers` are the lengths and angles of `linkage`, as `Stage.parameters` has them.
    """
    raise TypeError(type(linkage), numbers)


@exact_linkage.register
def _(linkage: FourBar, *numbers: Number) -> tuple[Transform, Transform]:
    bar = ExactFourBar(linkage, *numbers)
    return bar.swing, bar.crank_angle


@exact_linkage.register
def _(linkage: CrankSlider, *numbers: Number) -> tuple[Transform, Transform]:
    slider = ExactCrankSlider(linkage, *numbers)
    return slider.stroke, slider.stroke


@exact_linkage.register
def _(
    linkage: SliderCrank, length: Number, coupler: Number, deflection: Number
) -> tuple[Transform, Transform]:
    crank = ExactSliderCrank(length, coupler, deflection, linkage)
    return crank.swing, crank.crank_angle


def _triangle(crank: Number, coupler: Number, pin: Series) -> Series:
    """Angle at the shaft of the triangle shaft, tip, pin [rad], by the law of cosines.

    GeometryError if crank and coupler do not reach the pin, or lie on one line.
    """
    mp = multiprecision()
    square = pin.real**2 + pin.imag**2
    opposite = (square + (crank**2 - coupler**2)) / (2 * crank * root(square))
    across = 1 - opposite**2
    if not across.terms[0] > 0 and (len(square.terms) > 1 or across.terms[0] < 0):
        raise GeometryError("crank and coupler do not reach the pin", key="linkage")
    angle: Series = logarithm(opposite + mp.mpc(0, 1) * root(across)).imag
    return angle
