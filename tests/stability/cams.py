"""Cases of whole cams: ordinary ones, hard ones from the lift to the curvature, all scales."""

from __future__ import annotations

import math
from dataclasses import replace

from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from tests.stability.cam_case import EVEN, MIDDLE, SHARES, STEEP, WIDE, CamSpec


def specs() -> tuple[CamSpec, ...]:
    """The cams, ordinary ones first."""
    return (*_ordinary(), *_translating(), *_oscillating(), *_scaled())


def rocker(
    distance: float, arm: float, corner: float, direction: int = 1, side: int = 1
) -> OscillatingRoller:
    """A rocker to the left of the cam axis; `corner` is the angle at its pivot [degrees]."""
    square = distance**2 + arm**2 - 2.0 * distance * arm * math.cos(math.radians(corner))
    pivot = complex(-distance, 0.0)
    return OscillatingRoller(pivot, arm, math.sqrt(square), 5.0, side, direction)


def _ordinary() -> tuple[CamSpec, ...]:
    guided = TranslatingRoller(50.0, 10.0, 12.0)
    turned = TranslatingRoller(60.0, 8.0, -9.0, guide_angle=0.3, direction=-1)
    carried = OscillatingRoller(complex(70.0, -55.0), 64.0, 45.0, 6.0, -1)
    return (
        CamSpec("offset guide", WIDE, 20.0, guided, back=SHARES),
        CamSpec("inward guide", WIDE, 20.0, turned, rotation=-1, law="modified-sine"),
        CamSpec("rocker", WIDE, 0.35, carried, rotation=-1, law="modified-trapezoid", back=SHARES),
    )


def _translating() -> tuple[CamSpec, ...]:
    central = TranslatingRoller(100.0, 10.0)
    tight = TranslatingRoller(25.0, 14.136531876910917)
    return (
        CamSpec("HC11 tiny stroke", EVEN, 1e-6, central),
        CamSpec("tiny stroke, offset", EVEN, 1e-6, TranslatingRoller(100.0, 10.0, 20.0)),
        CamSpec("HC12 huge base circle", EVEN, 20.0, TranslatingRoller(1e6, 10.0)),
        CamSpec(
            "HC13 lambda 1e-6", WIDE, 20.0, TranslatingRoller(50.0, 10.0), inflection=1e-6,
            rise=(5e-7, 1e-3, MIDDLE, 0.99),
        ),
        CamSpec(
            "HC13 lambda 1 - 1e-6", WIDE, 20.0, TranslatingRoller(50.0, 10.0),
            inflection=1.0 - 1e-6, rise=(1e-2, MIDDLE, 0.999, 1.0 - 5e-7),
        ),
        CamSpec(
            "HC14 return in 1e-6 degrees", ("0", "359.999998", "0", "0.000001", "0.000001"), 20.0,
            TranslatingRoller(50.0, 10.0), back=(0.07, 0.4, MIDDLE, 0.8),
        ),
        CamSpec(
            "HC15 offset equals base radius", WIDE, 20.0, TranslatingRoller(50.0, 10.0, 50.0)
        ),
        CamSpec("HC17 roller beyond base circle", WIDE, 20.0, TranslatingRoller(50.0, 60.0)),
        CamSpec(
            "HC20b inflections", STEEP, 20.0, TranslatingRoller(25.0, 8.0),
            rise=(0.02464985199112413, 0.02465, 0.3288565711, 0.32885657113781, 0.33),
        ),
        CamSpec(
            "HC21b next to cusps", STEEP, 20.0, tight,
            rise=(0.8160790, 0.81607908249, 0.8163181514536081, 0.8165571201),
        ),
        CamSpec(
            "HC22 neck of a lobe", ("10", "40", "0", "40", "270"), 130.0,
            TranslatingRoller(22.0, 16.0),
        ),
        CamSpec(
            "HC23 runs back", ("30", "45", "40", "120", "125"), 60.0,
            TranslatingRoller(50.0, 5.0, 40.0),
            rise=(0.1, 0.2263864319980378, 0.4, 0.5342310864179735, 0.9),
        ),
    )  # fmt: skip


def _oscillating() -> tuple[CamSpec, ...]:
    degree = math.pi / 180.0
    low = OscillatingRoller(-100.0 + 0j, 80.0, 20.0 * (1.0 + 1e-9), 5.0)
    high = OscillatingRoller(-100.0 + 0j, 80.0, 180.0 * (1.0 - 1e-9), 5.0, 1, -1)
    standing = (0.4, 0.499, 0.49999, 0.4999999888888889, 0.50001)
    return (
        CamSpec("tiny swing", EVEN, 1e-8, rocker(100.0, 80.0, 50.0)),
        CamSpec("triangle nearly flat", EVEN, 0.3, low, rise=(1e-6, *SHARES)),
        CamSpec("triangle nearly stretched", EVEN, 0.3, high, rise=(1e-6, *SHARES)),
        CamSpec("HC18 next to Z' = 0", EVEN, 12.0 * degree, rocker(100.0, 80.0, 6.0, -1),
                rise=standing),
        CamSpec("HC19 psi' = 1", EVEN, 48.0 * degree, rocker(100.0, 80.0, 30.0)),
        CamSpec("HC27 passes line of centres", EVEN, 30.0 * degree, rocker(100.0, 80.0, 165.0),
                rise=(0.3, 0.49, 0.4999999, MIDDLE, 0.7)),
    )  # fmt: skip


def _scaled() -> tuple[CamSpec, ...]:
    base = CamSpec("", STEEP, 0.0, TranslatingRoller(1.0, 0.1))
    return tuple(
        replace(
            base,
            name=f"scale {scale:g} mm",
            stroke=0.8 * scale,
            follower=TranslatingRoller(scale, 0.3 * scale, 0.2 * scale),
        )
        for scale in (1e-6, 1e6)
    )
