"""Cases of cams under flat faces: near cusps, faces nearly standing in the cam, distant pivots."""

from __future__ import annotations

import math
from typing import Final

from mpmath import mp

from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat, flat_follower
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.stability.cams import EVEN, LIFTS, MIDDLE, SHARES, STEEP, WIDE, CamSpec, of_moves
from tests.stability.exact_cam import face_jet
from tests.stability.measure import Case
from tests.stability.series import Number, Series

GROUP: Final = "flat faces"

QUANTITIES: Final = (
    *LIFTS,
    "pitch curve Z",
    "Z'",
    "Z''",
    "place of the contact",
    "slope of the place",
    "turn tau",
    "tau'",
    "pace p",
    "p'",
    "radius rho",
    "curvature",
    "curvature slope",
    "transmission angle",
    "pressure angle",
)


def specs() -> tuple[CamSpec, ...]:
    """The cams."""
    return (*_translating(), *_oscillating(), *_scaled())


def cases_of(spec: CamSpec) -> list[Case]:
    """The cases of one cam, one for each of its moves that has places."""
    stage, curve = spec.stage, spec.curve
    follower = flat_follower(spec.follower)

    def found(phi: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        lifts = curve.motion.jet(phi)[:4]
        touch = follower.touch(lifts, spec.rotation)
        return (
            *lifts,
            *curve.jet(phi),
            *touch.contact,
            *touch.turn,
            *touch.pace,
            touch.pace[0] / touch.turn[0],
            curve.curvature(phi),
            curve.curvature_slope(phi),
            curve.transmission_angle(phi),
            curve.pressure_angle(phi),
        )

    def exact(phi: Number, *parameters: Number) -> tuple[Number, ...]:
        jet = face_jet(stage, phi, parameters)
        contact, place, turn, pace = jet.contact, jet.place, jet.turn, jet.pace
        forward = pace if pace.terms[0] > 0 else -pace
        curvature = Series(turn.terms[:2]) / forward
        angle = jet.pressure_angle if follower.swing_sense else mp.mpf(0)
        return (
            *(jet.lift.derivative(order) for order in range(4)),
            *(contact.derivative(order) for order in range(3)),
            *place.terms[:2],
            *turn.terms[:2],
            *pace.terms[:2],
            pace.terms[0] / turn.terms[0],
            *curvature.terms[:2],
            mp.pi / 2 - angle,
            angle,
        )

    return of_moves(spec, GROUP, QUANTITIES, found, exact)


def _translating() -> tuple[CamSpec, ...]:
    plain = TranslatingFlat(50.0)
    return (
        CamSpec("flat face", WIDE, 20.0, plain, back=SHARES),
        CamSpec(
            "flat face, inward", WIDE, 20.0, TranslatingFlat(60.0, 0.3, -1), rotation=-1,
            law="modified-sine",
        ),
        CamSpec("flat face, tiny stroke", EVEN, 1e-6, TranslatingFlat(100.0)),
        CamSpec("flat face, huge base circle", EVEN, 20.0, TranslatingFlat(1e6)),
        CamSpec(
            "flat face, next to a cusp", WIDE, 20.0, TranslatingFlat(19.3), rise=(0.7, 0.72, 0.79)
        ),
        CamSpec("flat face, undercut", STEEP, 20.0, TranslatingFlat(30.0)),
    )  # fmt: skip


def _oscillating() -> tuple[CamSpec, ...]:
    pivot = complex(70.0, -55.0)
    lying = OscillatingFlat(-100.0 + 0j, 8.0, 8.0)
    # The swing of a 3-4-5 polynomial over 60 degrees that reaches psi' = 1 in its middle.
    steepest = math.radians(60.0) / 1.875
    through = OscillatingFlat(-100.0 + 0j, 40.0, 0.0)
    square = OscillatingFlat(-100.0 + 0j, 20.0 + 100.0 * (1.0 - 1e-9), 20.0, 1, -1)
    far = OscillatingFlat(-1e6 + 0j, 50.0, 20.0)
    return (
        CamSpec("face of a rocker", WIDE, 0.25, OscillatingFlat(pivot, 60.0, 8.0, -1),
                rotation=-1, back=SHARES),
        CamSpec("face of a rocker, inward", WIDE, 0.25, OscillatingFlat(pivot, 50.0, -12.0, 1, -1),
                law="modified-sine"),
        CamSpec("face of a rocker, tiny swing", EVEN, 1e-8, through),
        CamSpec("face towards the axis", EVEN, 0.2, lying),
        CamSpec("face square to the line of centres", EVEN, 0.2, square, rise=(1e-6, *SHARES)),
        CamSpec("face that nearly stands in the cam", STEEP, steepest * (1.0 - 1e-6), through,
                rise=(0.3, 0.49, 0.4999, MIDDLE, 0.6)),
        CamSpec("face that turns back", STEEP, 1.5 * steepest, through),
        CamSpec("far pivot", EVEN, 2e-5, far),
    )  # fmt: skip


def _scaled() -> tuple[CamSpec, ...]:
    return tuple(
        CamSpec(
            f"face of a rocker, scale {scale:g} mm", EVEN, 0.2,
            OscillatingFlat(complex(-1.2, 0.9) * scale, 0.6 * scale, 0.1 * scale),
        )
        for scale in (1e-6, 1e6)
    )  # fmt: skip
