"""Writes docs/hard-cases.md: `python docs/hard_cases_page.py`, in a checkout with its tests.

For every case of fixtures/reference/hard_cases.json the page states what is hard, what camgeo does,
and how far its values are from the reference's, measured here. A test repeats the measurement and
compares the page with it.
"""

from __future__ import annotations

import math
import textwrap
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from pathlib import Path
from typing import Any

import numpy as np

from camgeo.check.disc import check_outline, check_standstill, check_undercut
from camgeo.check.finding import Finding
from camgeo.check.machine import check_follower, check_linkage
from camgeo.design.value_table import cam_angles
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import find_crossings, real_outline
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.mechanism.slotted_lever import SlottedLever
from camgeo.kinematics.plan import MotionPlan, Move
from camgeo.numeric.extremes import roots_on_grid
from camgeo.units import TURN
from tests.reference import (
    POLYNOMIAL,
    angles,
    hard_case,
    inner_of,
    number,
    pitch_curve_of,
    plan_of,
    reference,
    shift,
    slider_crank_of,
    thesis_params,
)

PAGE = Path(__file__).with_name("hard-cases.md")
TEXTS = Path(__file__).with_name("hard_cases.toml")

HEAD = """# Hard cases

<!-- Made by docs/hard_cases_page.py; change it there. -->

Inputs that break naive programs: `fixtures/reference/hard_cases.json` has 33, each with the values
that it should give, computed with mpmath at 60 digits, or with the expected error. For each this
page describes what is hard, what camgeo does, and how accurate it is. Quoted text is camgeo's own
output.

An error is the difference between camgeo's double and the reference's 30 digits, relative to the
value, or in the unit given with it where the value is 0 or where the result is itself an angle. It
is the worst of all values in the line, twice what was measured on one machine (x86-64), rounded up
to one digit, and never less than four units in the last place, because other processors and
libraries round sines differently. It includes what is already lost when the inputs are rounded to
doubles. A test repeats the measurement and fails if an error exceeds the one stated here.
`tests/test_hard_cases.py` has variants of the cases with other numbers.
"""

ULP = 2.0**-52

LEAST = 4.0
"""Smallest error stated, in units in the last place."""

Values = dict[str, Any]
"""Parameters or expected values of a case."""

Pair = tuple[float | complex, Any]
"""What was found, and the decimals of the reference: one number, or two of a point."""


@dataclass(frozen=True)
class Measured:
    """A line of a table: values that are stated together.

    Attributes
    ----------
    label : what they are.
    error : the worst error of them.
    least : smallest error stated.
    unit : of an absolute error; empty for a relative one.
    """

    label: str
    error: float
    least: float
    unit: str = ""

    @property
    def bound(self) -> float:
        """The error that the page states."""
        return rounded_up(max(2.0 * self.error, self.least))


def rounded_up(value: float) -> float:
    """To one digit, upwards."""
    if value == 0.0:
        return 0.0
    size = math.floor(math.log10(value))
    digit = math.ceil(value / 10.0**size * (1.0 - 1e-12))
    return float(f"{digit}e{size}")


def difference(found: float | complex, true: Any) -> tuple[float, float]:
    """Distance of a double, or two, from a reference's decimals, and the size of these."""
    pair = true if isinstance(true, list) else [true]
    parts = [found.real, found.imag] if isinstance(true, list) else [found]
    with localcontext() as context:
        context.prec = 60
        exact = [Decimal(str(each)) for each in pair]
        gaps = [Decimal(float(p.real)) - e for p, e in zip(parts, exact, strict=True)]
        return (
            float(sum((gap * gap for gap in gaps), Decimal(0)).sqrt()),
            float(sum((each * each for each in exact), Decimal(0)).sqrt()),
        )


def share(label: str, *pairs: Pair) -> Measured:
    """The worst relative error."""
    gaps = [difference(*pair) for pair in pairs]
    return Measured(label, max(gap / size for gap, size in gaps), LEAST * ULP)


def distance(label: str, unit: str, scale: float, *pairs: Pair) -> Measured:
    """The worst error in a unit; `scale` is the size of the terms that make up the value."""
    return Measured(
        label, max(difference(*pair)[0] for pair in pairs), LEAST * math.ulp(scale), unit
    )


def refusal(make: Callable[[], Any]) -> str:
    """The messages with which something is rejected."""
    try:
        make()
    except GeometryError as error:
        return error.message
    raise AssertionError("nothing was refused")


def refused(found: Sequence[Finding]) -> list[str]:
    """The sentences of the findings that forbid a disc."""
    return [f.sentence for f in found if f.severity in ("no-disc", "invalid")]


# The slotted lever ------------------------------------------------------------------------------


def _slotted_lever(params: Values) -> tuple[SlottedLever, float]:
    """A slotted lever by lengths that are whole numbers, and its speed [rad/s]."""
    beta = Decimal(str(params["beta"]))
    crank = Decimal(10) ** max(-int(beta.as_tuple().exponent), 0)
    return SlottedLever(float(crank), float(beta * crank)), TURN * float(params.get("n", 1.0))


def _hc01(params: Values, expected: Values) -> list[Measured]:
    lever, speed = _slotted_lever(params)
    phi, omega, acceleration = lever.in_time(angles("1e-8"), speed)[:, 0]
    return [
        share(
            "phi at theta = 1e-8 deg, omega_2",
            (math.degrees(phi), expected["phi_deg_at_theta_1e_minus_8_deg"]),
            (omega, expected["omega2"]),
        ),
        Measured("eps_2 = 0", difference(acceleration, expected["eps2"])[0], 0.0),
    ]


def _hc01_words(params: Values) -> list[str]:
    return [refusal(lambda: _slotted_lever(params)[0].angle(angles(0)))]


def _hc02(params: Values, expected: Values) -> list[Measured]:
    lever, speed = _slotted_lever(params)
    largest, swing = lever.largest_acceleration, lever.largest_angle
    _, omega, _ = lever.in_time(angles(0, 180), speed)
    return [
        share(
            "largest eps_2, and where",
            (abs(largest.value) * speed**2, expected["max_abs_eps2"]),
            (largest.place, expected["theta_of_max_eps_rad"]),
        ),
        share(
            "largest phi, and where",
            (math.degrees(swing.value), expected["phi_max_deg"]),
            (swing.place, expected["theta_phi_max_rad"]),
        ),
        share(
            "omega_2 at 0 and 180 deg",
            (omega[0], expected["omega2_at_0"]),
            (omega[1], expected["omega2_at_180"]),
        ),
    ]


def _hc03(params: Values, expected: Values) -> list[Measured]:
    lever, speed = _slotted_lever(params)
    table = expected["phi_deg_unwrapped"]
    phi = np.degrees(lever.angle(angles(*table)))
    start, end = np.degrees(lever.angle(np.array([0.0, TURN])))
    _, omega, _ = lever.in_time(angles(0, 180), speed)
    largest = lever.largest_acceleration
    return [
        share(
            "phi, and its change over a turn",
            *zip(phi, table.values(), strict=True),
            (end - start, expected["total_phi_over_one_turn_deg"]),
        ),
        share(
            "omega_2 at 0 and 180 deg",
            (omega[0], expected["omega2_at_0"]),
            (omega[1], expected["omega2_at_180"]),
        ),
        share(
            "largest eps_2, and where",
            (abs(largest.value) * speed**2, expected["max_abs_eps2"]),
            (math.degrees(largest.place), expected["theta_of_max_deg"]),
        ),
    ]


def _hc03_words(params: Values) -> list[str]:
    return [refusal(lambda: _slotted_lever(params)[0].largest_angle)]


def _hc04(params: Values, expected: Values) -> list[Measured]:
    lever, _ = _slotted_lever(params)
    phi = np.degrees(lever.angle(angles(90, 1)))
    return [
        share(
            "phi at 90 and 1 deg",
            (phi[0], expected["phi_deg_at_90"]),
            (phi[1], expected["phi_deg_at_1"]),
        ),
        share(
            "omega_2 at 60 deg",
            (lever.velocity(angles(60))[0], expected["omega2_over_omega0_at_60"]),
        ),
    ]


# Linkages ---------------------------------------------------------------------------------------


def _crank_of(params: Values, deflection: float, **changes: str) -> SliderCrank:
    own = {"alpha_sk": math.degrees(deflection), "q24": "positiv", "q25": "positiv"}
    return slider_crank_of({**params, **own, **changes})


def _hc05_motion(params: Values) -> LinkedMotion:
    linkage = _crank_of(params, math.radians(params["alpha_sk"]))
    return LinkedMotion(plan_of(params, float(params["s_H"])), linkage)


def _hc05(params: Values, expected: Values) -> list[Measured]:
    motion = _hc05_motion(params)
    linkage = motion.linkage
    assert isinstance(linkage, SliderCrank)
    probe = motion.jet(angles(expected["phi_probe_deg"]))[:, 0]
    full = linkage.crank_angle(np.array([float(params["s_H"])]))[0]
    theta = math.degrees(linkage.start_angle + probe[0])
    return [
        share(
            "theta at rest and at full stroke",
            (math.degrees(linkage.start_angle), expected["theta_start_deg"]),
            (math.degrees(full), expected["theta_at_full_stroke_deg"]),
        ),
        distance("theta 0.09 deg after the joint", "deg", 180.0, (theta, expected["theta_deg"])),
        share(
            "theta', theta'' there", (probe[1], expected["theta1"]), (probe[2], expected["theta2"])
        ),
    ]


def _hc05_words(params: Values) -> list[str]:
    motion = _hc05_motion(params)
    return [refusal(lambda: motion.jet(angles(90))), *refused(check_linkage(motion))]


def _hc06(params: Values, expected: Values) -> list[Measured]:
    deflection, stroke = math.asin(0.8), np.array([0.0, 10.0])
    first = np.degrees(_crank_of(params, deflection).crank_angle(stroke))
    second = np.degrees(_crank_of(params, deflection, q23="zweiter").crank_angle(stroke))
    return [
        share(
            "theta of both branches, at stroke 0 and 10",
            (first[0], expected["theta_erster_deg"]),
            (first[1], expected["theta_erster_at_s10_deg"]),
            (second[0], 180),
            (second[1], expected["theta_zweiter_at_s10_deg"]),
        )
    ]


def _hc07_words(params: Values) -> list[str]:
    thesis = thesis_params("T5_schnitt", -1)
    plan = plan_of(thesis, float(params["s_H"]))
    return [refusal(lambda: LinkedMotion(plan, slider_crank_of(thesis)))]


def _hc07(params: Values, expected: Values) -> list[Measured]:
    words = _hc07_words(params)[0].split()
    first, last = float(words[words.index("angles") + 1]), float(words[words.index("degrees:") - 1])
    linkage = slider_crank_of(thesis_params("T5_schnitt", -1))
    reach = linkage.missing_length(np.array([float(expected["s_reachable_max"])]))[0]
    return [
        distance(
            "first and last cam angle, as reported",
            "deg",
            1e7 * ULP,  # printed with ten digits
            (first, expected["phi_first_failure_deg"]),
            (last, expected["phi_last_failure_deg"].split()[-1]),
        ),
        distance("missing length at the largest stroke", "mm", 100.0, (reach, 0)),
    ]


def _hc25(_: Values, expected: Values) -> list[Measured]:
    pairs: list[Pair] = []
    for branch in ("zweiter", "erster"):
        params = thesis_params("T6_setzhub", -1) | {"q23": branch}
        linkage = slider_crank_of(params)
        motion = LinkedMotion(plan_of(params, float(params["s_H"])), linkage)
        theta = math.degrees(linkage.start_angle) % 360.0
        swing = math.degrees(motion.jet(angles(200))[0, 0])
        pairs += [
            (theta, expected[f"theta0_{branch}_deg"]),
            (swing, expected[f"swing_{branch}_deg"]),
        ]
    return [share("start and swing of both branches", *pairs)]


def _hc25_words(_: Values) -> list[str]:
    params = thesis_params("T6_setzhub", -1) | {"q23": "erster"}
    motion = LinkedMotion(plan_of(params, float(params["s_H"])), slider_crank_of(params))
    return [found.sentence for found in check_linkage(motion) if found.severity != "ok"]


def _hc26(params: Values, expected: Values) -> list[Measured]:
    linkage = _crank_of({**params, "q21": "nein"}, math.asin(0.8))
    strokes = [0.0, float(params["s_H"]), float(expected["s_at_theta_180"])]
    theta = np.degrees(linkage.crank_angle(np.array(strokes))) % 360.0
    jet = np.array([[strokes[1]], [0.0], [0.0], [0.0]])
    swing = math.degrees(linkage.transform(jet)[0, 0])
    return [
        share(
            "theta at the start, the end and 180 deg",
            (theta[0], expected["theta_start_mod360"]),
            (theta[1], expected["theta_end_mod360"]),
            (theta[2], 180),
        ),
        share("swing", (swing, expected["swing_deg"])),
    ]


def _hc28(_: Values, expected: Values) -> list[Measured]:
    linkage = slider_crank_of(thesis_params("T7_vorschub", -1))
    theta = math.degrees(linkage.start_angle)
    return [share("theta at stroke 0", (theta, expected["theta0_deg"].split()[0]))]


# Plans ------------------------------------------------------------------------------------------


def _hc08_words(params: Values) -> list[str]:
    return [refusal(lambda: plan_of({"phi_H": params["T6_as_OCRed"]}, 58.5))]


def _hc09(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(thesis_params("T5_schnitt", params["sigma"]))
    joint = angles(50)
    before, after = curve.motion.jet(joint, "left")[:, 0], curve.motion.jet(joint)[:, 0]
    mu = math.degrees(curve.transmission_angle(joint)[0])
    return [
        share("psi", (math.degrees(after[0]), expected["psi_deg"])),
        Measured(
            "psi', psi'' = 0, on both sides",
            float(np.max(np.abs([before[1:3], after[1:3]]))),
            0.0,
        ),
        share(
            "psi''' on either side",
            (before[3], expected["psi3_left"]),
            (after[3], expected["psi3_right"]),
        ),
        share(
            "r_K, r, mu",
            (1.0 / curve.curvature(joint)[0], expected["rho"]),
            (abs(curve.point(joint)[0]), expected["r"]),
            (mu, expected["mu"]),
        ),
    ]


def _hc10_words(params: Values) -> list[str]:
    return [refusal(lambda: plan_of(params, float(params["s_H"])))]


def _hc13(params: Values, expected: Values) -> list[Measured]:
    lam = float(params["lambda_"])
    law, orders = shift(POLYNOMIAL, lam), ("f", "f1", "f2", "f3")
    pairs: list[Pair] = []
    for key, z in (("z_half_lambda", 0.5 * lam), ("z_lambda", lam), ("z_05", 0.5)):
        values = law(np.array([z]))
        pairs += [
            (values[order][0], expected[key][name])
            for order, name in enumerate(orders)
            if expected[key].get(name, 0) != 0
        ]
    largest = characteristic(law).acceleration
    jerk = law(np.zeros(1))[3][0]
    return [
        share("f to f''' at lambda/2, lambda, 1/2", *pairs, (jerk, expected["f3_at_0"])),
        share("largest f''", (largest.value, expected["max_f2"])),
        share("its place", (largest.place, expected["z_of_max_f2"])),
    ]


def _hc13_words(_: Values) -> list[str]:
    return [refusal(lambda: shift(POLYNOMIAL, 0.0))]


def _hc14(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(expected["phi_deg"])
    mu = math.degrees(curve.transmission_angle(phi)[0])
    return [
        share(
            "s', |Z'|, mu",
            (curve.motion.jet(phi)[1, 0], expected["s1"]),
            (abs(curve.jet(phi)[1, 0]), expected["abs_B1"]),
            (mu, expected["mu_deg"]),
        ),
        share("r_K", (1.0 / curve.curvature(phi)[0], expected["rho"])),
    ]


def _hc14b_words(params: Values) -> list[str]:
    stroke = float(params["s_H"])
    rise = Move(Decimal(params["phi_H"][1]), stroke, POLYNOMIAL)
    return [refusal(lambda: MotionPlan((rise,))), refusal(lambda: plan_of(params, stroke))]


def _hc24(params: Values, expected: Values) -> list[Measured]:
    rows = len(cam_angles(Decimal(str(params["n"]))))
    return [Measured("1800 rows", abs(rows - expected["correct"]), 0.0)]


# Curves -----------------------------------------------------------------------------------------


def _hc11(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(expected["phi_deg"])
    jet = curve.motion.jet(phi)[:, 0]
    rho = 1.0 / curve.curvature(phi)[0]
    pressure = math.degrees(curve.pressure_angle(phi)[0])
    return [
        share("s, s''", (jet[0], expected["s"]), (jet[2], expected["s2"])),
        share("pressure angle, 90 deg - mu", (pressure, expected["ninety_minus_mu_deg"])),
        distance(
            "r, r_K",
            "mm",
            100.0,
            (abs(curve.point(phi)[0]) - 100.0, expected["r_minus_100"]),
            (rho - 100.0, expected["rho_minus_100"]),
        ),
    ]


def _hc12(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(params["phi_deg"])
    pressure = math.degrees(curve.pressure_angle(phi)[0])
    radius = abs(WorkingCurve(curve, -10.0).point(phi)[0])
    return [
        share("pressure angle, 90 deg - mu", (pressure, expected["ninety_minus_mu_deg"])),
        share(
            "r_K, radius of the inner flank",
            (1.0 / curve.curvature(phi)[0], expected["rho"]),
            (radius, expected["inner_radius"]),
        ),
    ]


def _hc15(params: Values, expected: Values) -> list[Measured]:
    curve, at = pitch_curve_of(params), expected["at_80"]
    mu = math.degrees(curve.transmission_angle(angles(80))[0])
    return [
        Measured("mu = 0 in the rest", float(curve.transmission_angle(angles(0))[0]), 0.0),
        share("r_K in the rest", (1.0 / curve.curvature(angles(0))[0], expected["rho_at_0"])),
        share(
            "mu, r_K, Z at 80 deg",
            (mu, at["mu"]),
            (1.0 / curve.curvature(angles(80))[0], at["rho"]),
            (complex(curve.point(angles(80))[0]), at["Z"]),
        ),
    ]


def _hc15_words(params: Values) -> list[str]:
    follower = pitch_curve_of(params).follower
    assert isinstance(follower, TranslatingRoller)
    return [
        *refused(check_follower(follower, runs_on_inner=True)),
        refusal(lambda: replace(follower, offset=math.nextafter(50.0, 51.0))),
    ]


def _hc16_words(params: Values) -> list[str]:
    pivot = complex(-params["x_A0"], -params["y_A0"])
    return [refusal(lambda: OscillatingRoller(pivot, params["l_3"], params["r_G"], 5.0))]


def _hc17(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(params)
    inner = inner_of(curve)
    at = angles(0)
    return [
        share(
            "point and r_K of the inner flank, r_K of the pitch curve, in the rest",
            (complex(inner.point(at)[0]), expected["inner_at_0"]),
            (1.0 / inner.curvature(at)[0], expected["rho_inner"]),
            (1.0 / curve.curvature(at)[0], expected["rho_at_0"]),
        )
    ]


def _hc17_words(params: Values) -> list[str]:
    curve = pitch_curve_of(params)
    return refused(check_follower(curve.follower, runs_on_inner=True))


def _hc18(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(params["phi_deg"])
    jet = curve.jet(phi)[:, 0]
    before = abs(curve.jet(phi - math.radians(1e-6))[1, 0])
    return [
        share("Z, Z''", (complex(jet[0]), expected["Z"]), (complex(jet[2]), expected["Z2"])),
        distance("Z' = 0", "mm/rad", 100.0, (abs(jet[1]), expected["abs_Z1"])),
        share(
            "|Z'| a millionth of a degree before",
            (before, expected["abs_Z1_1e_minus_6_deg_before"]),
        ),
    ]


def _hc18_words(params: Values) -> list[str]:
    curve, phi = pitch_curve_of(params), angles(params["phi_deg"])
    return [refusal(lambda: curve.curvature(phi)), *refused(check_standstill(curve))]


def _hc19(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(params["phi_deg"])
    mu = math.degrees(curve.transmission_angle(phi)[0])
    return [
        share(
            "psi', mu, |Z'|, kappa",
            (curve.motion.jet(phi)[1, 0], expected["psi1"]),
            (mu, expected["mu"]),
            (abs(curve.jet(phi)[1, 0]), expected["abs_Z1"]),
            (curve.curvature(phi)[0], expected["kappa"]),
        )
    ]


def _inflections(curve: PitchCurve) -> list[float]:
    """Cam angles [degrees] at which the curvature passes 0."""
    places = curvature_extremes(curve).phi % TURN
    grid = np.unique(np.concatenate((places, np.linspace(0.0, TURN, 181))))
    return [float(angle) for angle in np.degrees(roots_on_grid(curve.curvature, grid))]


def _hc20(params: Values, expected: Values) -> list[Measured]:
    count = len(_inflections(pitch_curve_of(params)))
    return [Measured("no inflection", abs(count - expected["n"]), 0.0)]


def _hc20b(params: Values, expected: Values) -> list[Measured]:
    found = _inflections(pitch_curve_of(params))
    pairs = zip(found, expected["phi_deg"], strict=True)
    return [distance("the four inflections", "deg", 180.0, *pairs)]


def _hc21a(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(params)
    bends, flank = curvature_extremes(curve), inner_of(curve)
    kappa, phi = bends.largest()
    back = np.degrees(bends.phi) > 130.0
    worst = int(np.argmax(bends.values[back]))
    tip = angles(expected["phi_deg"])
    return [
        share(
            "smallest r_K of rise and return",
            (1.0 / kappa, expected["rho_min"]),
            (1.0 / bends.values[back][worst], expected["rho_min_on_return"]),
        ),
        distance(
            "their cam angles",
            "deg",
            180.0,
            (math.degrees(phi), expected["phi_deg"]),
            (math.degrees(bends.phi[back][worst]), expected["phi_on_return"]),
        ),
        share("point of the flank there", (complex(flank.point(tip)[0]), expected["inner_point"])),
        distance("speed of the flank there", "mm/rad", 40.0, (flank.traced(tip)[2][0], 0)),
    ]


def _of_undercut(params: Values) -> list[str]:
    """Findings of the check of local undercut."""
    curve = pitch_curve_of(params)
    return refused(check_undercut(inner_of(curve), "inner", curvature_extremes(curve)))


def _cusps(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(params)
    flank = inner_of(curve)
    (finding,) = check_undercut(flank, "inner", curvature_extremes(curve))
    assert finding.cam_range is not None
    ends = np.array(finding.cam_range)
    tips = flank.point(ends)
    names = ("cusp1", "cusp2")
    # Where 1 + d kappa, a rounding of 1, passes 0.
    slope = float(np.min(np.abs(flank.distance * curve.curvature_slope(ends))))
    return [
        distance(
            "cam angles of the cusps",
            "deg",
            math.degrees(1.0 / slope),
            *(
                (math.degrees(e), expected[f"{n}_phi_deg"])
                for e, n in zip(ends, names, strict=True)
            ),
        ),
        share("the cusps", *((complex(t), expected[n]) for t, n in zip(tips, names, strict=True))),
    ]


def _hc21b(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(params)
    flank = inner_of(curve)
    (finding,) = check_undercut(flank, "inner", curvature_extremes(curve))
    assert finding.cam_range is not None
    tips = flank.point(np.array(finding.cam_range))
    width = abs(tips[1] - tips[0])
    loop = distance("width of the loop", "mm", 31.0, (width, expected["loop_width_mm"]))
    return [*_cusps(params, expected), loop]


def _crossing_lines(params: Values, wanted: list[tuple[Any, Any, Any]]) -> list[Measured]:
    """Crossings found, against cam angles [deg] and points of the reference."""
    found = find_crossings(inner_of(pitch_curve_of(params)))
    ends: list[Pair] = []
    points: list[Pair] = []
    for crossing, (first, second, point) in zip(found, wanted, strict=True):
        ends += [(math.degrees(crossing.first), first), (math.degrees(crossing.second), second)]
        points.append((crossing.point, point))
    return [
        distance("cam angles at which the flank crosses itself", "deg", 90.0, *ends),
        share("the points", *points),
    ]


def _hc21c(params: Values, expected: Values) -> list[Measured]:
    first, second = expected["crossing_phi1_deg"], expected["crossing_phi2_deg"]
    crossings = _crossing_lines(params, [(first, second, expected["crossing_point"])])
    return [*_cusps(params, expected), *crossings]


def _lobe(params: Values, expected: Values) -> list[Measured]:
    kappa, _ = curvature_extremes(pitch_curve_of(params)).largest()
    angle = math.radians(expected["lobe_axis_angle_deg"])
    wanted = [
        (first, second, [str(float(r) * math.cos(angle)), str(float(r) * math.sin(angle))])
        for first, second, r in zip(
            expected["self_intersections_on_axis_phi_deg"],
            expected["mirror_phi_deg"],
            expected["radial_position_mm"],
            strict=True,
        )
    ]
    return [
        share("smallest convex r_K", (1.0 / kappa, expected["rho_convex_min"])),
        *_crossing_lines(params, wanted),
    ]


def _lobe_words(params: Values) -> list[str]:
    curve = pitch_curve_of(params)
    return refused(check_outline(real_outline(inner_of(curve)), "inner", [], "no-disc"))


def _hc23(params: Values, expected: Values) -> list[Measured]:
    curve = pitch_curve_of(params)

    def turning(phi: np.ndarray[Any, np.dtype[np.float64]]) -> Any:
        z, z1 = curve.jet(phi)[:2]
        return np.imag(np.conj(z) * z1)

    found = np.degrees(roots_on_grid(turning, np.linspace(0.0, TURN, 721)))
    pairs = zip(found, expected["reversal_phi_deg"], strict=True)
    return [distance("where the polar angle turns back", "deg", 90.0, *pairs)]


def _hc27(params: Values, expected: Values) -> list[Measured]:
    curve, phi = pitch_curve_of(params), angles(expected["phi_deg"])
    mu = math.degrees(curve.transmission_angle(phi)[0])
    point = curve.point(phi)[0]
    assert number(expected["Z"]).real > 0.0
    return [
        distance("mu = 0", "deg", 180.0, (mu, expected["mu"])),
        share("Z, r", (complex(point), expected["Z"]), (abs(point), expected["r"])),
    ]


MEASURES: dict[str, Callable[[Values, Values], list[Measured]]] = {
    "HC01": _hc01,
    "HC02": _hc02,
    "HC03": _hc03,
    "HC04": _hc04,
    "HC05": _hc05,
    "HC06": _hc06,
    "HC07": _hc07,
    "HC09": _hc09,
    "HC11": _hc11,
    "HC12": _hc12,
    "HC13": _hc13,
    "HC14": _hc14,
    "HC15": _hc15,
    "HC17": _hc17,
    "HC18": _hc18,
    "HC19": _hc19,
    "HC20": _hc20,
    "HC20b": _hc20b,
    "HC21a": _hc21a,
    "HC21b": _hc21b,
    "HC21c": _hc21c,
    "HC22": _lobe,
    "HC22b": _lobe,
    "HC23": _hc23,
    "HC24": _hc24,
    "HC25": _hc25,
    "HC26": _hc26,
    "HC27": _hc27,
    "HC28": _hc28,
}
"""The lines of each case's table, from its parameters and its expected values."""

WORDS: dict[str, Callable[[Values], list[str]]] = {
    "HC01": _hc01_words,
    "HC03": _hc03_words,
    "HC05": _hc05_words,
    "HC07": _hc07_words,
    "HC08": _hc08_words,
    "HC10": _hc10_words,
    "HC13": _hc13_words,
    "HC14b": _hc14b_words,
    "HC15": _hc15_words,
    "HC16": _hc16_words,
    "HC17": _hc17_words,
    "HC18": _hc18_words,
    "HC21a": _of_undercut,
    "HC21b": _of_undercut,
    "HC21c": _of_undercut,
    "HC22": _lobe_words,
    "HC22b": _lobe_words,
    "HC25": _hc25_words,
}
"""Messages of camgeo on the cases that it rejects or finds faults in."""


def measured(case: str) -> list[Measured]:
    """The lines of a case; none for one that has no values."""
    measure = MEASURES.get(case)
    return [] if measure is None else measure(*hard_case(case))


def words(case: str) -> list[str]:
    """Messages of camgeo on a case, if it rejects it or finds faults in it."""
    say = WORDS.get(case)
    return [] if say is None else say(hard_case(case)[0])


def shown_value(line: Measured) -> str:
    """The error as the page states it."""
    if line.bound == 0.0:
        return "exact"
    return f"<= {line.bound:.0e}".replace("e-0", "e-") + (f" {line.unit}" if line.unit else "")


def page() -> str:
    """The page's text."""
    texts = tomllib.loads(TEXTS.read_text(encoding="utf-8"))
    parts = [HEAD]
    for case in reference("hard_cases.json"):
        name = case["id"]
        hard, does = _wrapped(texts[name]["hard"]), _wrapped("**camgeo:** " + texts[name]["camgeo"])
        parts.append(f"\n## {name}: {case['title']}\n\n{hard}\n\n{does}\n")
        lines = measured(name)
        if lines:
            parts.append("\n| value | error |\n|---|---|\n")
        for line in lines:
            label = line.label.replace("|", "\\|")
            parts.append(f"| {label} | {shown_value(line)} |\n")
        parts += [f"\n> {sentence}\n" for sentence in words(name)]
    return "".join(parts)


def _wrapped(text: str) -> str:
    return textwrap.fill(" ".join(text.split()), 100, break_on_hyphens=False)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
