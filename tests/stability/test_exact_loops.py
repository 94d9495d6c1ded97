"""The exact linkages against their loops, closed by Newton on power series with 50 digits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from tests.mechanism.loops import four_bar_jet, slider_driven_crank_jet
from tests.stability import loops
from tests.stability.cam_case import CamSpec
from tests.stability.linkage import exact_linkage
from tests.stability.series import Series

NAMES = [each.name for each in loops.specs() if not isinstance(each.linkage, SliderCrank)]

ROUNDED = 4.0 * 2.0**-53
"""The loops give their 50 digits rounded to doubles, some after a factorial."""


def spec(name: str) -> CamSpec:
    return next(each for each in loops.specs() if each.name == name)


@pytest.mark.parametrize("name", NAMES)
def test_motion_and_derivatives_are_those_of_the_loop(name: str) -> None:
    cam = spec(name)
    linkage = cam.linkage
    assert isinstance(linkage, FourBar | SliderDrivenCrank)
    jet = np.array([0.37 * cam.stroke, 0.8, -0.5, 1.3])
    count = 6 if isinstance(linkage, FourBar) else 3
    numbers = cam.parameters(back=False)[-count:]
    with mp.workdps(60):
        motion, position = exact_linkage(linkage, *(mpf(each) for each in numbers))
        demanded = Series(tuple(mpf(each) / math.factorial(k) for k, each in enumerate(jet)))
        own, reported = motion(demanded), position(demanded)
        found = [float(reported.derivative(order)) for order in range(4)]
        assert [float(own.derivative(k)) for k in (1, 2, 3)] == found[1:]
        if isinstance(linkage, FourBar):
            expected = four_bar_jet(linkage, jet, float(linkage.crank_angle(jet[:1])[0]))
            rest = position(Series((mpf(0),))).terms[0]
            assert abs(float(reported.terms[0] - rest - own.terms[0])) == 0.0
        else:
            inner = linkage.inner
            sense = -1.0 if inner.mirrored else 1.0
            ends = []
            for each in (jet, np.zeros(4)):
                near = sense * float(linkage.joints(each[:1])[0][0].real)
                ends.append(-inner.stroke_direction * slider_driven_crank_jet(linkage, each, near))
            # Behind a long coupler the stroke is a difference of what has been rounded.
            size = max(abs(ends[0][0]), abs(ends[1][0]))
            assert abs(found[0] - (ends[0][0] - ends[1][0])) <= ROUNDED * size
            found, expected = found[1:], ends[0][1:]
    assert found == pytest.approx(expected, rel=ROUNDED)
