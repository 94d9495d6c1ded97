"""The loops of the linkages, closed by Newton's method with 50 digits, without the closed forms.

Derivatives are those of the Taylor series of the solution: Newton's method on power series, which
doubles their known terms with each step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from mpmath import mp, mpc, mpf

from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.numeric.arrays import FloatArray

DIGITS = 50

ORDER = 3

Series = list[Any]
"""Coefficients of t^0 to t^ORDER."""


def four_bar_jet(linkage: FourBar, jet: FloatArray, near: float) -> FloatArray:
    """(4,) theta and derivatives for a demanded `jet` (4,), the solution near `near` [rad]."""

    def gap(theta: Series, x: Series) -> Series:
        chi = _plus([mpf(linkage.lever_angle)], _times([mpf(linkage.lever_sense)], x))
        pin = _plus([mpc(linkage.shaft)], _times([mpf(linkage.lever)], _unit(chi)))
        rod = _plus(pin, _times([mpf(-linkage.crank)], _unit(theta)))
        return _plus(_square(rod), [-(mpf(linkage.coupler) ** 2)])

    return _solved(gap, jet, near)


def slider_driven_crank_jet(linkage: SliderDrivenCrank, jet: FloatArray, near: float) -> FloatArray:
    """(4,) Re P and derivatives for a demanded `jet` (4,), the solution near `near` [mm].

    The crank's angle is counted from where it is at stroke 0, found from the loop too.
    """
    inner = linkage.inner
    height = mpf(inner.crank) * mp.cos(mpf(inner.deflection))
    with mp.workdps(DIGITS):
        sine = mpf(inner.crank) * mp.sin(mpf(inner.deflection))
        foot = inner.slider_side * (mpf(inner.coupler) + (-sine if inner.leans_away else sine))
        height = mpf(inner.crank) * mp.cos(mpf(inner.deflection))
        start = mp.findroot(
            lambda theta: (
                abs(-foot + mpc(0, 1) * height - inner.crank * mp.expj(theta)) ** 2
                - mpf(inner.coupler) ** 2
            ),
            mpf(inner.start_angle),
        )

    def gap(pin: Series, x: Series) -> Series:
        theta = _plus([start], _times([mpf(-1 if inner.mirrored else 1)], x))
        rod = _plus(pin, [mpc(0, 1) * height])
        rod = _plus(rod, _times([mpf(-inner.crank)], _unit(theta)))
        return _plus(_square(rod), [-(mpf(inner.coupler) ** 2)])

    return _solved(gap, jet, near)


def _solved(gap: Callable[[Series, Series], Series], jet: FloatArray, near: float) -> FloatArray:
    with mp.workdps(DIGITS):
        demanded = [mpf(float(value)) / math.factorial(k) for k, value in enumerate(jet)]
        found: Series = [mpf(near)]
        step = mpf(10) ** -20
        for _ in range(8 + ORDER):
            value = gap(found, demanded)
            ahead, behind = (
                gap(_plus(found, [step]), demanded),
                gap(_plus(found, [-step]), demanded),
            )
            slope = (ahead[0] - behind[0]) / (2 * step)
            found = _plus(found, [-each / slope for each in value])
        return np.array([float(mp.re(c)) * math.factorial(k) for k, c in enumerate(found)])


def _filled(series: Series) -> Series:
    return [*series, *[mpf(0)] * (ORDER + 1 - len(series))]


def _plus(a: Series, b: Series) -> Series:
    return [x + y for x, y in zip(_filled(a), _filled(b), strict=True)]


def _times(a: Series, b: Series) -> Series:
    a, b = _filled(a), _filled(b)
    return [sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(ORDER + 1)]


def _unit(angle: Series) -> Series:
    """exp(i angle)."""
    rest = [mpf(0), *_filled(angle)[1:]]
    power: Series = [mpc(1)]
    found: Series = [mpc(1)]
    for k in range(1, ORDER + 1):
        power = _times(power, [mpc(0, 1) * each / k for each in rest])
        found = _plus(found, power)
    return _times(found, [mp.expj(angle[0])])


def _square(z: Series) -> Series:
    real, imaginary = [mp.re(c) for c in z], [mp.im(c) for c in z]
    return _plus(_times(real, real), _times(imaginary, imaginary))
