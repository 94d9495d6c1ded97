"""Cases of cams behind a slider-crank, a four-bar and a slider-driven-crank.

The thesis's examples, dead centres, A = C, tiny motions, all scales.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from tests.stability.cam_case import EVEN, SHARES, CamSpec

PLACES: Final = (1e-9, 0.21, 0.5, 0.83, 0.97)
"""Places inside a move, as fractions of it."""

SHORT: Final = 1e-6
"""Fraction of the way to a dead centre by which a motion that ends next to it stops short."""

LATE: Final = (0.3, 0.5, 0.8, 0.97, 0.999)
"""Places in a motion that ends in a dead centre, as fractions of its span."""

EARLY: Final = (1e-3, *PLACES[1:])
"""Places in a motion that starts in a dead centre."""

RIGHT: Final = 0.5 * math.pi

LEAN: Final = math.asin(0.8)
"""Deflection of the crank in hard cases HC06 and HC26 [rad]."""


def specs() -> tuple[CamSpec, ...]:
    """The cams."""
    found = (*_four_bars(), *_slider_driven_cranks())
    near = (replace(each, rise=PLACES) if each.rise == SHARES else each for each in found)
    return (*_slider_cranks(), *near)


def four_bar(scale: float = 1.0, branch: int = 1) -> FourBar:
    """An ordinary one."""
    shaft = scale * (100.0 + 30.0j)
    return FourBar(60.0 * scale, 90.0 * scale, 50.0 * scale, shaft, 2.0, 1, branch)


def driven_crank(scale: float = 1.0, *, mirrored: bool = False) -> SliderDrivenCrank:
    """An ordinary one."""
    return SliderDrivenCrank(
        SliderCrank(60.0 * scale, 120.0 * scale, 0.5, False, 1, -1, 1, mirrored)
    )


def _rocker(scale: float = 1.0, arm_side: int = 1) -> OscillatingRoller:
    """Centred in its swing, so that it stays off the line of centres with each linkage."""
    pivot = complex(-100.0 * scale, 0.0)
    return OscillatingRoller(pivot, 80.0 * scale, 120.0 * scale, 5.0 * scale, arm_side, None)


def _guided(scale: float = 1.0, direction: int = 1) -> TranslatingRoller:
    return TranslatingRoller(100.0 * scale, 10.0 * scale, 12.0 * scale, direction=direction)


def _slider_cranks() -> tuple[CamSpec, ...]:
    setting = OscillatingRoller(complex(-40.46, -62.0), 61.29, 50.199, 7.0, 1, None)
    # Centred in its swing, so that the rocker stays off the line of centres with each linkage.
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


def _to_dead_centre(linkage: FourBar | SliderDrivenCrank) -> float:
    return linkage.dead_positions(0.0, math.tau)[0]


def _four_bars() -> tuple[CamSpec, ...]:
    plain, rocker = four_bar(), _rocker()
    closing = FourBar(60.0, 75.0, 50.0, 100.0 + 0j, 2.0, -1, -1)
    way = _to_dead_centre(closing)
    # The pin starts at (80, 60) mm exactly, without rounding.
    stretched = FourBar(60.0, 40.0, 60.0, 20.0 + 60.0j, 0.0, -1, 1)
    folded = FourBar(150.0, 50.0, 60.0, 20.0 + 60.0j, 0.0, 1, -1)
    turning = FourBar(80.0, 100.0, 30.0, 100.0 + 0j, 0.4, 1, 1)
    near = FourBar(50.0, 50.0, 60.0, -60.0 + 0j, 0.25, -1, 1)
    return (
        CamSpec("four-bar", EVEN, 0.5, rocker, plain, back=PLACES),
        CamSpec("four-bar, other branch", EVEN, 0.5, rocker, four_bar(branch=-1), -1),
        CamSpec("four-bar, tiny motion", EVEN, 1e-8, rocker, plain),
        CamSpec(
            "four-bar, next to a dead centre", EVEN, way * (1.0 - SHORT), rocker, closing, rise=LATE
        ),
        CamSpec("four-bar, to a dead centre", EVEN, way, rocker, closing, rise=LATE),
        CamSpec("four-bar, from a dead centre", EVEN, 0.4, rocker, stretched, rise=EARLY),
        CamSpec("four-bar, from a folded one", EVEN, 0.2, rocker, folded, rise=EARLY),
        CamSpec("four-bar, tiny motion from a dead centre", EVEN, 1e-6, rocker, stretched,
                rise=EARLY),
        CamSpec("four-bar, lever turns round", EVEN, math.tau, rocker, turning),
        CamSpec("four-bar, pin passes the shaft", EVEN, 0.499, rocker, near),
        *(
            CamSpec(f"four-bar, scale {scale:g}", EVEN, 0.5, _rocker(scale), four_bar(scale))
            for scale in (1e-6, 1e6)
        ),
    )  # fmt: skip


def _slider_driven_cranks() -> tuple[CamSpec, ...]:
    plain, guided = driven_crank(), _guided()
    closing = SliderDrivenCrank(SliderCrank(60.0, 50.0, 0.5, False, 1, -1, 1))
    way = _to_dead_centre(closing)
    # Slightly less than a right angle, which the exact crank has on the other side.
    on_line = SliderDrivenCrank(SliderCrank(40.0, 60.0, RIGHT - 2.0**-50, False, 1, -1, 1))
    equal = SliderDrivenCrank(SliderCrank(50.0, 50.0 * (1.0 + 1e-9), 1.57, True, 1, 1, 1))
    long = SliderDrivenCrank(SliderCrank(60.0, 1e6, 0.5, False, 1, -1, 1))
    return (
        CamSpec("slider-driven-crank", EVEN, 0.5, guided, plain, back=PLACES),
        CamSpec(
            "slider-driven-crank, mirrored", EVEN, 0.5, guided, driven_crank(mirrored=True), -1,
        ),
        CamSpec("slider-driven-crank, tiny motion", EVEN, 1e-8, guided, plain),
        CamSpec(
            "slider-driven-crank, next to a dead centre", EVEN, way * (1.0 - SHORT), guided,
            closing, rise=LATE,
        ),
        CamSpec("slider-driven-crank, to a dead centre", EVEN, way, guided, closing, rise=LATE),
        CamSpec("slider-driven-crank, stretched", EVEN, 0.4, guided, on_line, rise=EARLY),
        CamSpec(
            "slider-driven-crank, tiny motion, stretched", EVEN, 1e-6, guided, on_line, rise=EARLY,
        ),
        CamSpec("slider-driven-crank, A near C", EVEN, 0.4, guided, equal),
        CamSpec("slider-driven-crank, long coupler", EVEN, 0.4, guided, long),
        CamSpec("slider-driven-crank, crank turns round", EVEN, math.tau, guided, on_line),
        *(
            CamSpec(
                f"slider-driven-crank, scale {scale:g}", EVEN, 0.5, _guided(scale),
                driven_crank(scale),
            )
            for scale in (1e-6, 1e6)
        ),
    )  # fmt: skip
