"""Cases of whole cams: ordinary ones, hard ones from the lift to the curvature, all scales; of each
move all quantities.

Behind a slider-crank, a four-bar and a slider-driven-crank: the thesis's examples, dead centres,
A = C, tiny motions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Final

import numpy as np
from mpmath import mp

from camgeo.cam.cam import Disc, Drive
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
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
        if isinstance(motion, LinkedMotion) and hasattr(motion.linkage, "crank_angle"):
            # psi is a difference of crank angles; only psi_G + psi enters the curve. Seen from
            # behind, psi turns the other way than theta.
            angle = motion.linkage.crank_angle(motion.demanded.jet(phi)[0])
            rates = -lifts[1:] if getattr(motion.linkage, "mirrored", False) else lifts[1:]
            lifts = np.concatenate((angle[np.newaxis], rates))
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


# The cams -----------------------------------------------------------------------------------------


def specs() -> tuple[CamSpec, ...]:
    """Those without a linkage, ordinary ones first."""
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


# Behind a linkage ------------------------------------------------------------------------------

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


def linked_specs() -> tuple[CamSpec, ...]:
    """Those behind a linkage."""
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


def _centred(scale: float = 1.0) -> OscillatingRoller:
    """A rocker centred in its swing, so that it stays off the line of centres with each linkage."""
    pivot = complex(-100.0 * scale, 0.0)
    return OscillatingRoller(pivot, 80.0 * scale, 120.0 * scale, 5.0 * scale, 1, None)


def _guided(scale: float = 1.0) -> TranslatingRoller:
    return TranslatingRoller(100.0 * scale, 10.0 * scale, 12.0 * scale)


def _slider_cranks() -> tuple[CamSpec, ...]:
    setting = OscillatingRoller(complex(-40.46, -62.0), 61.29, 50.199, 7.0, 1, None)
    setzhub = SliderCrank(160.5, 122.87, math.radians(34.68), True, -1, -1, -1)
    feeding = OscillatingRoller(complex(-29.76, -85.37), 82.03, 38.006, 8.0, 1, None)
    feed = SliderCrank(82.03, 78.0, math.radians(5.64), False, 1, -1, 1)
    middle, dead = _centred(), SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
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
    plain, lever = four_bar(), _centred()
    closing = FourBar(60.0, 75.0, 50.0, 100.0 + 0j, 2.0, -1, -1)
    way = _to_dead_centre(closing)
    # The pin starts at (80, 60) mm exactly, without rounding.
    stretched = FourBar(60.0, 40.0, 60.0, 20.0 + 60.0j, 0.0, -1, 1)
    folded = FourBar(150.0, 50.0, 60.0, 20.0 + 60.0j, 0.0, 1, -1)
    turning = FourBar(80.0, 100.0, 30.0, 100.0 + 0j, 0.4, 1, 1)
    near = FourBar(50.0, 50.0, 60.0, -60.0 + 0j, 0.25, -1, 1)
    return (
        CamSpec("four-bar", EVEN, 0.5, lever, plain, back=PLACES),
        CamSpec("four-bar, other branch", EVEN, 0.5, lever, four_bar(branch=-1), -1),
        CamSpec("four-bar, tiny motion", EVEN, 1e-8, lever, plain),
        CamSpec(
            "four-bar, next to a dead centre", EVEN, way * (1.0 - SHORT), lever, closing, rise=LATE
        ),
        CamSpec("four-bar, to a dead centre", EVEN, way, lever, closing, rise=LATE),
        CamSpec("four-bar, from a dead centre", EVEN, 0.4, lever, stretched, rise=EARLY),
        CamSpec("four-bar, from a folded one", EVEN, 0.2, lever, folded, rise=EARLY),
        CamSpec("four-bar, tiny motion from a dead centre", EVEN, 1e-6, lever, stretched,
                rise=EARLY),
        CamSpec("four-bar, lever turns round", EVEN, math.tau, lever, turning),
        CamSpec("four-bar, pin passes the shaft", EVEN, 0.499, lever, near),
        *(
            CamSpec(f"four-bar, scale {scale:g}", EVEN, 0.5, _centred(scale), four_bar(scale))
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
