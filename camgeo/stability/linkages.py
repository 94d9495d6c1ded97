"""Cases of cams behind a slider-crank: the thesis's examples, dead centres, A = C."""

from __future__ import annotations

import math
from typing import Final

from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.stability.cam_case import EVEN, SHARES, CamSpec

LEAN: Final = math.asin(0.8)
"""The crank's deflection of hard cases HC06 and HC26 [rad]."""


def specs() -> tuple[CamSpec, ...]:
    """The cams."""
    setting = OscillatingRoller(complex(-40.46, -62.0), 61.29, 50.199, 7.0, 1, None)
    # Midway in its swing, so that the rocker stays off the line of centres with each linkage.
    middle = OscillatingRoller(-100.0 + 0j, 80.0, 120.0, 5.0, 1, None)
    setzhub = SliderCrank(160.5, 122.87, math.radians(34.68), True, -1, -1, -1)
    feeding = OscillatingRoller(complex(-29.76, -85.37), 82.03, 38.006, 8.0, 1, None)
    feed = SliderCrank(82.03, 78.0, math.radians(5.64), False, 1, -1, 1)
    dead = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
    return (
        CamSpec(
            "Setzhub", ("110", "80", "20", "90", "60"), 58.5, setting, setzhub, -1,
            back=SHARES,
        ),
        CamSpec("tiny slider stroke", EVEN, 1e-6, setting, setzhub, -1),
        CamSpec("HC28 A near C", EVEN, 2.0, feeding, feed),
        CamSpec("HC05 dead centre", EVEN, 20.0, middle, dead, rise=(1e-3, *SHARES[1:])),
        CamSpec("HC06 A = C", EVEN, 10.0, middle, SliderCrank(50.0, 50.0, LEAN, False, 1, -1, 1)),
        CamSpec(
            "HC06 A = C, other branch", EVEN, 10.0, middle,
            SliderCrank(50.0, 50.0, LEAN, False, 1, -1, -1),
        ),
        CamSpec(
            "HC26 crank through 180 degrees", EVEN, 10.0, middle,
            SliderCrank(50.0, 48.0, LEAN, False, 1, -1, -1),
        ),
    )  # fmt: skip
