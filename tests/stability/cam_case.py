"""A cam of the suite, and the cases of its moves: all quantities from the lift to the curvature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Final

import numpy as np
from mpmath import mp

from camgeo.cam.cam import Disc, Drive
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.stability.exact_cam import AnyFollower, AnyLinkage, Stage
from tests.stability.measure import Case, Exact, Found
from tests.stability.series import Number

CAMS: Final = "cams"

LINKAGES: Final = "linkages"


LIFTS: Final = ("lift s", "s'", "s''", "s'''")

CURVES: Final = (
    "pitch curve Z",
    "Z'",
    "Z''",
    "Z'''",
    "inner working curve",
    "outer working curve",
    "curvature",
    "curvature slope",
    "1 - r_R kappa",
    "transmission angle",
    "pressure angle",
)

CRANKS: Final = ("crank angle theta", "psi'", "psi''", "psi'''")

EVEN: Final = ("90", "90", "0", "90", "90")

WIDE: Final = ("30", "100", "40", "120", "70")

STEEP: Final = ("30", "60", "40", "80", "150")
"""Spans of cams, see `CamSpec`; the last of hard cases HC20b and HC21, with concave flanks."""

MIDDLE: Final = 0.5

SHARES: Final = (1e-9, 0.07, 0.21, 0.4, 0.5, 0.66, 0.83, 0.97)
"""Places inside a move, as fractions of it."""


@dataclass(frozen=True, slots=True)
class CamSpec:
    """A cam of the suite: a rise and a return from rest to rest.

    Attributes
    ----------
    name : states what is hard about it.
    spans : of the rest, rise, rest, return, rest in degrees, as written.
    stroke : [mm or rad].
    follower, linkage, rotation : the mechanism.
    law, inflection : of both moves.
    rise, back : places in the rise and in the return, as fractions of their spans.
    """

    name: str
    spans: tuple[str, str, str, str, str]
    stroke: float
    follower: AnyFollower
    linkage: AnyLinkage | None = None
    rotation: int = 1
    law: str = "polynomial-345"
    inflection: float = 0.5
    rise: tuple[float, ...] = SHARES
    back: tuple[float, ...] = ()

    @property
    def plan(self) -> MotionPlan:
        """The demanded motion."""
        law = make_law(self.law, "R-R", inflection=self.inflection)
        first, up, high, down, last = (Decimal(span) for span in self.spans)
        return MotionPlan(
            (
                Dwell(first),
                Move(up, self.stroke, law),
                Dwell(high),
                Move(down, 0.0, law),
                Dwell(last),
            )
        )

    @property
    def curve(self) -> PitchCurve:
        """The pitch curve, as the engine computes it."""
        unit = self.follower.lift_unit if self.linkage is None else self.linkage.unit
        drive = Drive(self.plan, self.linkage, unit)
        return Disc(drive, self.follower, self.rotation).pitch_curve

    @property
    def stage(self) -> Stage:
        """The exact cam."""
        return Stage(self.law, self.follower, self.linkage, self.rotation)

    def joints(self, *, back: bool) -> tuple[float, float]:
        """Cam angles [rad] of both ends of a move, as the engine uses them."""
        number = 3 if back else 1
        first = sum(map(Decimal, self.spans[:number]), Decimal(0))
        last = first + Decimal(self.spans[number])
        return math.radians(float(first)), math.radians(float(last))

    def parameters(self, *, back: bool) -> tuple[float, ...]:
        """The inputs of the exact cam for a move."""
        low, high = (self.stroke, 0.0) if back else (0.0, self.stroke)
        return self.stage.parameters(*self.joints(back=back), low, high, self.inflection)


def cases_of(spec: CamSpec) -> list[Case]:
    """The cases of one cam, one for each of its moves that has places."""
    stage = spec.stage
    names = (*(CRANKS if hasattr(spec.linkage, "crank_angle") else LIFTS), *CURVES)

    def exact(phi: Number, *parameters: Number) -> tuple[Number, ...]:
        return quantities(stage, phi, parameters)

    group = CAMS if spec.linkage is None else LINKAGES
    return of_moves(spec, group, names, computed(spec.curve), exact)


def of_moves(
    spec: CamSpec, group: str, quantities: tuple[str, ...], found: Found, exact: Exact
) -> list[Case]:
    """A case for each move of a cam that has places."""
    cases = []
    for back, shares, word in ((False, spec.rise, "rise"), (True, spec.back, "return")):
        if shares:
            start, end = spec.joints(back=back)
            places = tuple(start + share * (end - start) for share in shares)
            inputs = spec.parameters(back=back)
            cases.append(
                Case(group, f"{spec.name}, {word}", quantities, places, inputs, found, exact)
            )
    return cases


def computed(curve: PitchCurve) -> Found:
    """The engine's values of the quantities of a cam."""
    inner = WorkingCurve(curve, -curve.follower.roller_radius)
    outer = WorkingCurve(curve, curve.follower.roller_radius)

    def found(phi: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        motion = curve.motion
        lifts = motion.jet(phi)[:4]
        if isinstance(motion, LinkedMotion):
            # psi is a difference of crank angles; only psi_G + psi enters the curve.
            crank_angle = getattr(motion.linkage, "crank_angle", None)
            if crank_angle is not None:
                angle = crank_angle(motion.demanded.jet(phi)[0])
                lifts = np.concatenate((angle[np.newaxis], lifts[1:]))
        return (
            *lifts,
            *curve.jet(phi),
            inner.point(phi),
            outer.point(phi),
            curve.curvature(phi),
            curve.curvature_slope(phi),
            inner.regularity(phi),
            curve.transmission_angle(phi),
            curve.pressure_angle(phi),
        )

    return found


def quantities(stage: Stage, phi: Number, parameters: Sequence[Number]) -> tuple[Number, ...]:
    """The exact values of the same quantities."""
    jet = stage.jet(phi, parameters)
    bend = jet.bend
    angle = jet.transmission_angle
    return (
        *(jet.lift.derivative(order) for order in range(4)),
        *(jet.centre.derivative(order) for order in range(4)),
        jet.parallel(-jet.roller),
        jet.parallel(jet.roller),
        bend.terms[0],
        bend.terms[1],
        1 - jet.roller * bend.terms[0],
        angle,
        mp.pi / 2 - angle,
    )
