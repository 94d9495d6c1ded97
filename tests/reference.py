"""Reference values of `fixtures/reference`, and the mechanisms they were computed for."""

from __future__ import annotations

import json
import math
import tomllib
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.laws import LAWS

FOLDER = Path(__file__).parents[1] / "fixtures" / "reference"

LAW_NAMES = {
    "straight_line": "straight-line",
    "quadratic_parabola": "quadratic-parabola",
    "simple_sine": "simple-sine",
    "poly345": "polynomial-345",
    "inclined_sine": "inclined-sine",
    "mod_acc_trapezoid": "modified-trapezoid",
    "mod_sine": "modified-sine",
    "uu_sine_straight": "sine-straight",
    "uu_simple_sine": "simple-sine",
    "gg_mod_sine": "modified-sine",
    "rg_mod_sine": "modified-sine",
    "gr_mod_sine": "modified-sine",
    "ru_mod_trapezoid": "modified-trapezoid",
    "ur_mod_trapezoid": "modified-trapezoid",
    "ru_harmonic": "harmonic-combination",
    "ur_harmonic": "harmonic-combination",
    "gu_harmonic": "harmonic-combination",
    "ug_harmonic": "harmonic-combination",
}
"""Names of the laws there and here; those that end in `poly5` are `polynomial-5`."""

POLYNOMIAL = LAWS["polynomial-345"]


def shift(law: Law, inflection: float) -> Law:
    """`law` with its inflection point at lambda = `inflection` (VDI 2143-1, 6.1.2)."""
    return make_law(law.name, law.task, **{**law.parameters, "inflection": inflection})


@cache
def reference(file: str) -> Any:
    """The contents of a JSON or TOML file of the reference; not to be changed."""
    text = (FOLDER / file).read_text(encoding="utf-8")
    return tomllib.loads(text) if file.endswith(".toml") else json.loads(text)


@cache
def hard_case(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Parameters and expected values of a hard case."""
    (case,) = [case for case in reference("hard_cases.json") if case["id"] == name]
    return case["params"], case["expected"]


@cache
def mechanisms() -> dict[str, dict[str, Any]]:
    """The cams of `mechanism_values.json` by name, without its slotted levers."""
    cases: dict[str, dict[str, Any]] = reference("mechanism_values.json")["mechanisms"]
    return {name: case for name, case in cases.items() if case["params"]["kind"] != "crank_slide"}


def law_cases() -> list[dict[str, Any]]:
    """The laws of `motion_law_values.json`."""
    cases: list[dict[str, Any]] = reference("motion_law_values.json")["cases"]
    return cases


def law_terms(case: dict[str, Any]) -> tuple[str, str, dict[str, float]]:
    """Name, task and parameters of a case of `motion_law_values.json`, as `make_law` takes them."""
    there, task = case["law"], case["task"]
    if there == "rr_asymmetric":
        name = LAW_NAMES[case["params"]["base"]]
    else:
        name = "polynomial-5" if there.endswith("poly5") else LAW_NAMES[there]
    velocity = "v0" if task == "G-U" else "v1"
    terms = {"lam": "inflection", "c": "curved", "vG": velocity}
    numbers = {key: text for key, text in case["params_hex"].items() if key != "base"}
    return name, task, {terms.get(key, key): float.fromhex(text) for key, text in numbers.items()}


def law_of(case: dict[str, Any]) -> Law:
    """The law of a case of `motion_law_values.json`."""
    name, task, parameters = law_terms(case)
    return make_law(name, task, **parameters)


def plan_of(params: dict[str, Any], stroke: float) -> MotionPlan:
    """Rest, rise to `stroke`, rest, return, rest over the spans `phi_H`, by 3-4-5 polynomials."""
    first, rise, second, back, last = (Decimal(str(span)) for span in params["phi_H"])
    up, down = POLYNOMIAL, POLYNOMIAL
    if "lambda_rise" in params:
        up = shift(POLYNOMIAL, params["lambda_rise"])
        down = shift(POLYNOMIAL, params["lambda_return"])
    return MotionPlan(
        (
            Dwell(first),
            Move(rise, stroke, up),
            Dwell(second),
            Move(back, 0.0, down),
            Dwell(last),
        )
    )


def slider_crank_of(params: dict[str, Any]) -> SliderCrank:
    """The linkage of a thesis example by its answers (mechanisms.md 4.2)."""
    return SliderCrank(
        crank=float(params["l_sk"]),
        coupler=float(params["l_4"]),
        deflection=math.radians(float(params["alpha_sk"])),
        leans_away=params["q21"] == "ja",
        slider_side=1 if params["q25"] == "positiv" else -1,
        stroke_direction=1 if params["q22"] == "ja" else -1,
        branch=1 if params["q23"] == "erster" else -1,
        mirrored=params["q24"] == "negativ",
    )


def pitch_curve_of(params: dict[str, Any]) -> PitchCurve:
    """The pitch curve of a mechanism of the reference collection."""
    kind, sigma = params["kind"], params["sigma"]
    roller = float(params.get("r_R", 0.0))
    direction = params.get("kappa", 1)
    if kind == "trans":
        follower = TranslatingRoller(
            float(params["r_G"]), roller, offset=float(params["e"]), direction=direction
        )
        return PitchCurve(plan_of(params, float(params["s_H"])), follower, sigma)
    if kind == "osc":
        rocker = _rocker_of(params, roller, direction)
        return PitchCurve(plan_of(params, math.radians(params["psi_H_deg"])), rocker, sigma)
    motion = LinkedMotion(plan_of(params, float(params["s_H"])), slider_crank_of(params))
    return PitchCurve(motion, _rocker_of(params, roller, None), sigma)


def _rocker_of(params: dict[str, Any], roller: float, direction: int | None) -> OscillatingRoller:
    arm = float(params["l_3"])
    if "psi_G_deg" in params:  # the cam axis lies to the right of the pivot there
        distance = float(params["l_1"])
        square = distance**2 + arm**2
        square -= 2.0 * distance * arm * math.cos(math.radians(params["psi_G_deg"]))
        return OscillatingRoller(-distance + 0j, arm, math.sqrt(square), roller, 1, direction)
    pivot = complex(-float(params["x_A0"]), -float(params["y_A0"]))
    return OscillatingRoller(pivot, arm, float(params["r_G"]), roller, 1, direction)


THESIS_CAMS = {
    "querhub": "T4_querhub_ASSUMED",
    "schnitt": "T5_schnitt",
    "setzhub": "T6_setzhub",
    "vorschub": "T7_vorschub",
}
"""The cams of the thesis, by the names of their scenes: keys of `thesis_examples.toml`."""


def thesis_params(name: str, sigma: int) -> dict[str, Any]:
    """Parameters of a cam of `thesis_examples.toml` in the form of `mechanism_values.json`."""
    params = dict(reference("thesis_examples.toml")[name]["params"])
    params["phi_H"] = [params[f"phi_H{span}"] for span in ("01", "12", "23", "34", "45")]
    return params | {"kind": "cam_linkage", "sigma": sigma}


def stroke_of(curve: PitchCurve) -> Motion:
    """The motion of the plan: that of the slider if there is a linkage."""
    return curve.motion.demanded if isinstance(curve.motion, LinkedMotion) else curve.motion


def inner_of(curve: PitchCurve) -> WorkingCurve:
    """The inner working curve."""
    return WorkingCurve(curve, -curve.follower.roller_radius)


def outer_of(curve: PitchCurve) -> WorkingCurve:
    """The outer working curve."""
    return WorkingCurve(curve, curve.follower.roller_radius)


def angles(*degrees: float | str) -> FloatArray:
    """Cam angles in radians."""
    return np.array([math.radians(float(angle)) for angle in degrees])


def number(pair: list[str]) -> complex:
    """A complex number of the reference collection."""
    return complex(float(pair[0]), float(pair[1]))


def column(rows: list[dict[str, Any]], key: str) -> FloatArray:
    """A real quantity of all rows."""
    return np.array([float(row[key]) for row in rows])


def complex_column(rows: list[dict[str, Any]], key: str) -> ComplexArray:
    """A complex quantity of all rows."""
    return np.array([number(row[key]) for row in rows])
