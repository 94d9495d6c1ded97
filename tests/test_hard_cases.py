"""The numerically hard cases that concern input and closing, each by its name in the reference.

Values are read from `fixtures/reference/hard_cases.json`; an expectation in words stands beside the
assertion that holds us to it. Unless it says otherwise a value is met to 1e-12 of itself.
"""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.check.curvature import check_undercut
from camgeo.check.linkage import check_linkage
from camgeo.check.standstill import check_standstill
from camgeo.curve.curvature import curvature_extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, SceneError
from camgeo.files.value_table import cam_angles
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.slider_crank import SliderCrank
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.plan import Dwell, MotionPlan, Move
from camgeo.scene.load import load_scene
from tests.reference import (
    POLYNOMIAL,
    angles,
    hard_case,
    inner_of,
    number,
    pitch_curve_of,
    plan_of,
    slider_crank_of,
    thesis_params,
)

SCENES = Path(__file__).parents[1] / "fixtures" / "scenes"

exactly = pytest.approx
REL = 1e-12


def crank_of(params: dict[str, Any], deflection: float, **changes: str) -> SliderCrank:
    return slider_crank_of(
        {**params, "alpha_sk": math.degrees(deflection), "q24": "positiv", "q25": "positiv"}
        | changes
    )


def test_hc05_dead_centre_at_the_start() -> None:
    params, expected = hard_case("HC05")
    linkage = crank_of(params, math.radians(params["alpha_sk"]))
    motion = LinkedMotion(plan_of(params, float(params["s_H"])), linkage)
    assert math.degrees(linkage.start_angle) == exactly(expected["theta_start_deg"], rel=REL)

    # In the dwell nothing is divided: psi' = psi'' = 0.
    assert np.all(motion.jet(angles(0.0, 45.0, 89.9, 350.0)) == 0.0)

    # The digits that X = 100 - 2e-7 has left: the tolerances that the case names.
    probe = motion.jet(angles(expected["phi_probe_deg"]))
    theta = math.degrees(linkage.start_angle + probe[0, 0])
    assert theta == exactly(float(expected["theta_deg"]), abs=1e-8)
    assert probe[1, 0] == exactly(float(expected["theta1"]), rel=1e-6)
    assert probe[2, 0] == exactly(float(expected["theta2"]), rel=1e-6)
    full = float(linkage.crank_angle(np.array([float(params["s_H"])]))[0])
    assert math.degrees(full) == exactly(float(expected["theta_at_full_stroke_deg"]), rel=REL)

    # psi' goes to 0 like sqrt(z) from the joint on, psi'' grows without bound.
    near = motion.jet(angles("90.001", "90.01", "90.1"))
    assert np.all(np.diff(np.abs(near[1])) > 0.0)
    assert np.all(np.diff(np.abs(near[2])) < 0.0)

    # "report dead centre": as a finding, and as an error where psi'' has no value.
    (finding,) = (f for f in check_linkage(motion) if f.name == "dead-centre")
    assert finding.severity == "fatal"
    with pytest.raises(GeometryError, match="dead centre"):
        motion.jet(angles(90.0))


def test_hc06_half_angle_formula_is_0_over_0() -> None:
    params, expected = hard_case("HC06")
    deflection = math.asin(4.0 / 5.0)
    stroke = np.array([0.0, 10.0])
    first = crank_of(params, deflection).crank_angle(stroke)
    second = crank_of(params, deflection, q23="zweiter").crank_angle(stroke)
    assert math.degrees(first[0]) == exactly(float(expected["theta_erster_deg"]), rel=REL)
    assert math.degrees(first[1]) == exactly(float(expected["theta_erster_at_s10_deg"]), rel=REL)
    assert math.degrees(second[0]) == exactly(180.0, rel=REL)
    assert math.degrees(second[1]) == exactly(float(expected["theta_zweiter_at_s10_deg"]), rel=REL)
    # The crank's tip is where the case says: what A = C makes undefined is regular.
    tip = 50.0 * np.exp(1j * second[0])
    assert tip == exactly(-50.0, abs=50.0 * 1e-12)


def test_hc07_linkage_that_does_not_close(tmp_path: Path) -> None:
    params, expected = hard_case("HC07")
    text = (SCENES / "schnitt.toml").read_text(encoding="utf-8")
    changed = text.replace("to = 5.5", f"to = {params['s_H']}")
    assert changed != text
    scene = tmp_path / "scene.toml"
    scene.write_text(changed, encoding="utf-8")
    with pytest.raises(SceneError, match="does not close") as raised:
        load_scene(scene)
    # "error naming phi and the missing length"
    words = str(raised.value).split()
    first, last = words[words.index("angles") + 1], words[words.index("degrees:") - 1]
    assert float(first) == exactly(float(expected["phi_first_failure_deg"]), abs=1e-7)
    assert float(last) == exactly(float(expected["phi_last_failure_deg"].split()[-1]), abs=1e-7)
    missing = float(words[words.index("mm") - 1])
    linkage = slider_crank_of(thesis_params("T5_schnitt", -1))
    assert missing == exactly(float(linkage.missing_length(np.array([40.0]))[0]), rel=1e-5)
    reachable = float(expected["s_reachable_max"])
    assert linkage.missing_length(np.array([reachable]))[0] == exactly(0.0, abs=1e-12)


def test_hc08_plan_that_does_not_close() -> None:
    params, expected = hard_case("HC08")
    with pytest.raises(GeometryError, match=f"add up to {expected['sum_deg']} degrees"):
        plan_of({"phi_H": params["T6_as_OCRed"]}, 58.5)
    plan_of({"phi_H": expected["correct"]}, 58.5)


def test_hc09_zero_length_dwell() -> None:
    params, expected = hard_case("HC09")
    curve = pitch_curve_of(thesis_params("T5_schnitt", params["sigma"]))
    joint = angles(50)
    before, after = curve.motion.jet(joint, "left")[:, 0], curve.motion.jet(joint)[:, 0]
    assert math.degrees(after[0]) == exactly(float(expected["psi_deg"]), rel=REL)
    assert before[0] == exactly(after[0], rel=1e-15)
    for jet in (before, after):
        assert jet[1] == expected["psi1"]
        assert jet[2] == expected["psi2"]
    assert before[3] == exactly(float(expected["psi3_left"]), rel=REL)
    assert after[3] == exactly(float(expected["psi3_right"]), rel=REL)
    assert 1.0 / curve.curvature(joint)[0] == exactly(float(expected["rho"]), rel=REL)
    assert abs(curve.point(joint)[0]) == exactly(float(expected["r"]), rel=REL)
    mu = math.degrees(curve.transmission_angle(joint)[0])
    assert mu == exactly(float(expected["mu"]), rel=REL)


def test_hc10_rise_of_zero_length() -> None:
    params, _ = hard_case("HC10")
    with pytest.raises(GeometryError, match="infinite velocity"):
        plan_of(params, float(params["s_H"]))
    # "with s_H = 0 accepted and all curves are circles"
    curve = PitchCurve(plan_of(params, 0.0), TranslatingRoller(50.0, 10.0), 1)
    phi = np.linspace(0.0, 2.0 * math.pi, 100)
    for offset, radius in ((-10.0, 40.0), (0.0, 50.0), (10.0, 60.0)):
        assert np.abs(WorkingCurve(curve, offset).point(phi)) == exactly(radius, rel=1e-15)


def test_hc14_return_in_a_millionth_of_a_degree() -> None:
    params, expected = hard_case("HC14")
    curve = pitch_curve_of(params)
    phi = angles(expected["phi_deg"])
    rel = 1e-7  # the case's own
    assert curve.motion.jet(phi)[1, 0] == exactly(float(expected["s1"]), rel=rel)
    mu = math.degrees(curve.transmission_angle(phi)[0])
    assert mu == exactly(float(expected["mu_deg"]), rel=rel)
    assert abs(curve.jet(phi)[1, 0]) == exactly(float(expected["abs_B1"]), rel=rel)
    # In the middle of the return s'' passes 0 with the slope f''' = -30, and r_K with it: a change
    # dz changes it by u s'' / s'^2 = 60 * 30 / (20 * (15/8)^2) dz = 25.6 dz of itself. Half an ulp
    # of 2 pi in phi and in the joint is a dz of 5e-8: no double of phi tells r_K to 1e-7.
    half_ulp = 0.5 * math.ulp(2.0 * math.pi)
    conditioning = 60.0 * 30.0 / (20.0 * 1.875**2) * 2.0 * half_ulp / math.radians(1e-6)
    assert 1.0 / curve.curvature(phi)[0] == exactly(float(expected["rho"]), rel=conditioning)


def test_hc14b_a_single_rise_is_not_periodic() -> None:
    params, _ = hard_case("HC14b")
    stroke = float(params["s_H"])
    rise = Move(Decimal(params["phi_H"][1]), stroke, POLYNOMIAL)
    with pytest.raises(GeometryError, match="does not close after one turn"):
        MotionPlan((rise,))
    with pytest.raises(GeometryError, match="infinite velocity"):
        plan_of(params, stroke)


def test_hc15_offset_equal_to_the_base_radius() -> None:
    params, expected = hard_case("HC15")
    curve = pitch_curve_of({**params, "kappa": 1})
    assert isinstance(curve.follower, TranslatingRoller)
    assert curve.follower.start_height == expected["s_G"]
    assert curve.transmission_angle(angles(0))[0] == expected["mu_at_0"]
    assert 1.0 / curve.curvature(angles(0))[0] == exactly(expected["rho_at_0"], rel=REL)
    at = expected["at_80"]
    mu = math.degrees(curve.transmission_angle(angles(80))[0])
    assert mu == exactly(float(at["mu"]), rel=REL)
    assert 1.0 / curve.curvature(angles(80))[0] == exactly(float(at["rho"]), rel=REL)
    assert curve.point(angles(80))[0] == exactly(number(at["Z"]), rel=REL)
    with pytest.raises(GeometryError, match="offset must not exceed"):
        replace(curve.follower, offset=math.nextafter(50.0, 51.0))


def test_hc16_triangle_that_does_not_close() -> None:
    params, expected = hard_case("HC16")
    pivot, arm = complex(-params["x_A0"], -params["y_A0"]), params["l_3"]
    with pytest.raises(GeometryError, match="form no triangle"):
        OscillatingRoller(pivot, arm, params["r_G"], 5.0)
    # At the limit itself the rocker lies on the line of centres: nothing could start to move.
    limit = expected["limit_r_G_min"]
    with pytest.raises(GeometryError, match="must lie between 30 and 130"):
        OscillatingRoller(pivot, arm, limit, 5.0)
    # Just inside, psi_G goes to 0 like a root and keeps its digits.
    tiny = 1e-9
    just = OscillatingRoller(pivot, arm, limit + tiny, 5.0)
    assert just.start_angle == exactly(math.sqrt(2.0 * limit * tiny / (50.0 * arm)), rel=1e-6)


def test_hc17_roller_larger_than_the_base_circle() -> None:
    params, expected = hard_case("HC17")
    curve = pitch_curve_of({**params, "kappa": 1})
    inner = inner_of(curve)
    at_0 = inner.point(angles(0))[0]
    assert at_0 == exactly(number(expected["inner_at_0"]), abs=50.0 * 1e-15)
    assert 1.0 / curve.curvature(angles(0))[0] == exactly(expected["rho_at_0"], rel=REL)
    assert 1.0 / inner.curvature(angles(0))[0] == exactly(expected["rho_inner"], rel=REL)
    # "local undercut in the rest itself"
    found = check_undercut(inner, "inner", curvature_extremes(curve))
    assert all(finding.severity == "fatal" for finding in found)
    ranges = [finding.cam_range for finding in found]
    assert any(span is not None and span[0] > span[1] for span in ranges), "past cam angle 0"
    # "with r_R = r_G the whole rest maps to the point A_0"
    rest = WorkingCurve(curve, -50.0).point(angles(0, 10, 29, 300))
    assert np.abs(rest) == exactly(0.0, abs=50.0 * 1e-15)


def test_hc18_real_cusp_of_the_pitch_curve() -> None:
    params, expected = hard_case("HC18")
    curve = pitch_curve_of(params)
    phi = angles(params["phi_deg"])
    jet = curve.jet(phi)[:, 0]
    size = 100.0  # l_1, the largest length in the sums
    assert jet[0] == exactly(number(expected["Z"]), rel=REL)
    assert abs(jet[1]) == exactly(expected["abs_Z1"], abs=size * 1e-15)
    assert jet[2] == exactly(number(expected["Z2"]), rel=REL)
    assert curve.motion.jet(phi)[1, 0] * -1.0 == exactly(float(expected["psi1"]), rel=REL)
    assert isinstance(curve.follower, OscillatingRoller)
    rocker = curve.follower.rocker_angle(curve.motion.jet(phi)[0])[0]
    assert rocker == exactly(expected["psi_t"], abs=1e-15)
    before = curve.jet(phi - math.radians(1e-6))[1, 0]
    # phi itself is rounded to 4e-16 of 1.7e-8 rad
    assert abs(before) == exactly(float(expected["abs_Z1_1e_minus_6_deg_before"]), rel=1e-7)
    # "no division by |B'|; working curves undefined at this angle"
    inner = WorkingCurve(curve, -5.0)
    for undefined in (curve.curvature, curve.transmission_angle, inner.point):
        with pytest.raises(GeometryError, match="stands still"):
            undefined(phi)
    (finding,) = check_standstill(curve)
    assert finding.severity == "fatal"
    assert finding.cam_angle == exactly(phi[0], abs=1e-6)
    assert "rocker lies on the line of centres" in finding.sentence


@pytest.mark.parametrize("step", [0.2, *hard_case("HC24")[0]["others_with_the_same_fault"]])
def test_hc24_no_extra_row(step: float) -> None:
    _, expected = hard_case("HC24")
    rows = cam_angles(Decimal(str(step)))
    assert len(rows) == round(360.0 / step)
    if step == hard_case("HC24")[0]["n"]:
        assert len(rows) == expected["correct"]
        counted, angle = 0, 0.0
        while angle < 360.0:  # what the program of the thesis does
            counted, last, angle = counted + 1, angle, angle + step
        assert counted == expected["points_by_accumulation"]
        assert last == exactly(float(expected["last_accumulated"]), abs=1e-12)
    assert rows[-1] == float(360 - Decimal(str(step)))


def test_hc25_wrong_assembly_branch() -> None:
    _, expected = hard_case("HC25")
    swings = {}
    for branch in ("zweiter", "erster"):
        params = thesis_params("T6_setzhub", -1) | {"q23": branch}
        linkage = slider_crank_of(params)
        theta = math.degrees(linkage.start_angle) % 360.0
        assert theta == exactly(float(expected[f"theta0_{branch}_deg"]), rel=REL)
        motion = LinkedMotion(plan_of(params, float(params["s_H"])), linkage)
        swings[branch] = math.degrees(motion.jet(angles(200))[0, 0])
        assert swings[branch] == exactly(float(expected[f"swing_{branch}_deg"]), rel=REL)
        # "coupler parallel to the guide at s = 0 only for zweiter"
        warned = [f.name for f in check_linkage(motion)]
        assert warned == ([] if branch == "zweiter" else ["linkage-branch"])


def test_hc26_crank_passes_180_degrees() -> None:
    params, expected = hard_case("HC26")
    linkage = crank_of({**params, "q21": "nein"}, math.asin(4.0 / 5.0))
    assert linkage.start_position == exactly(params["s_0"], rel=REL)
    assert linkage.guide_height == exactly(params["e_sk"], rel=REL)
    stroke = float(params["s_H"])
    theta = np.degrees(linkage.crank_angle(np.array([0.0, stroke]))) % 360.0
    assert theta[0] == exactly(float(expected["theta_start_mod360"]), rel=REL)
    assert theta[1] == exactly(float(expected["theta_end_mod360"]), rel=REL)
    motion = LinkedMotion(plan_of({"phi_H": [60, 100, 40, 100, 60]}, stroke), linkage)
    swing = np.degrees(motion.jet(np.radians(np.linspace(60.0, 200.0, 2001)))[0])
    assert swing[-1] == exactly(float(expected["swing_deg"]), rel=REL)
    assert np.max(np.abs(np.diff(swing))) < 0.02, "a smooth swing of 10.5 deg, no jump by 360"
    place = float(expected["s_at_theta_180"])
    at_180 = math.degrees(linkage.crank_angle(np.array([place]))[0]) % 360.0
    assert at_180 == exactly(180.0, rel=REL)


def test_hc28_conditioning_of_the_half_angle_formula() -> None:
    _, expected = hard_case("HC28")
    linkage = slider_crank_of(thesis_params("T7_vorschub", -1))
    theta = math.degrees(linkage.start_angle)
    assert theta == exactly(float(expected["theta0_deg"].split()[0]), rel=1e-13)
    # The figures that show the loss in the thesis's form, from our own lengths.
    crank, x, height = linkage.crank, linkage.start_position, linkage.guide_height
    a = 2.0 * crank * x
    c = x * x + height * height + crank**2 - linkage.coupler**2
    assert a == exactly(float(expected["A"]), rel=REL)
    assert c == exactly(float(expected["C"]), rel=REL)
    assert (a - c) / a == exactly(float(expected["A_minus_C_over_A"]), rel=1e-11)


def test_dwell_of_zero_length_needs_no_special_case() -> None:
    """A plan with rests of zero length anywhere is the plan without them."""
    zero = Dwell(Decimal(0))
    rise, back = Move(Decimal(180), 5.0, POLYNOMIAL), Move(Decimal(180), 0.0, POLYNOMIAL)
    plain, padded = MotionPlan((rise, back)), MotionPlan((zero, rise, zero, zero, back, zero))
    phi = np.linspace(0.0, 2.0 * math.pi, 361)
    assert np.array_equal(plain.jet(phi), padded.jet(phi))
