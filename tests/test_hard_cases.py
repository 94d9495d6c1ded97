"""The numerically hard cases, each under its name in the reference.

Values are read from `fixtures/reference/hard_cases.json`; an expectation in words stands next to
the assertion that tests it. Unless stated otherwise a value is met to 1e-12 of its size. The last
tests ensure that no case and no value is left out.
"""

from __future__ import annotations

import ast
import math
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo.check.disc import (
    check_outline,
    check_standstill,
    check_transmission_angle,
    check_undercut,
)
from camgeo.check.machine import DEAD_CENTRE, check_linkage
from camgeo.design.value_table import cam_angles
from camgeo.errors import GeometryError, SceneError, UndercutError
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
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests.findings import known
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

SCENES = Path(__file__).parents[1] / "fixtures" / "scenes"


exactly = pytest.approx


REL = 1e-12


def crank_of(params: dict[str, Any], deflection: float, **changes: str) -> SliderCrank:
    return slider_crank_of(
        {**params, "alpha_sk": math.degrees(deflection), "q24": "positiv", "q25": "positiv"}
        | changes
    )


def slotted_lever_of(params: dict[str, Any]) -> tuple[SlottedLever, float]:
    """A slotted lever of the ratio beta, and its speed [rad/s].

    The crank is of as many units as beta has places after the point, so that both lengths are whole
    numbers: beta = 1.000000001 as a double has lost half the digits of beta - 1.
    """
    beta = Decimal(str(params["beta"]))
    crank = Decimal(10) ** max(-int(beta.as_tuple().exponent), 0)
    return SlottedLever(float(crank), float(beta * crank)), TURN * float(params.get("n", 1.0))


def test_hc01_crank_as_long_as_the_distance() -> None:
    params, expected = hard_case("HC01")
    lever, speed = slotted_lever_of(params)
    # "phi = 90 deg - theta/2 for 0 < theta < 360"
    theta = np.radians(np.array([1e-8, 1e-3, 30.0, 90.0, 200.0, 359.0, 360.0 - 1e-8]))
    phi, omega, acceleration = lever.in_time(theta, speed)
    assert phi == exactly(0.5 * (math.pi - theta), rel=REL, abs=1e-15)
    tiny = math.degrees(phi[0])
    # 90 deg less 5e-9: the part that is lost by naive sums is met as such.
    assert tiny == exactly(float(expected["phi_deg_at_theta_1e_minus_8_deg"]), rel=1e-15)
    assert 90.0 - tiny == exactly(5e-9, abs=2.0 * math.ulp(90.0))
    assert omega == exactly(float(expected["omega2"]), rel=REL)
    assert np.all(acceleration == expected["eps2"])
    # "error or nan, never a silent 0"
    for quantity in (lever.angle, lever.velocity, lever.acceleration):
        with pytest.raises(GeometryError, match="undefined"):
            quantity(angles(0.0))


def test_hc02_crank_nearly_as_long_as_the_distance() -> None:
    params, expected = hard_case("HC02")
    lever, speed = slotted_lever_of(params)
    assert lever.distance - lever.crank == 1.0  # mm, of 1e9
    largest = lever.largest_acceleration
    assert largest.place == exactly(float(expected["theta_of_max_eps_rad"]), rel=REL)
    found = abs(largest.value) * speed**2
    assert found == exactly(float(expected["max_abs_eps2"]), rel=REL)
    at = abs(lever.in_time(np.array([largest.place]), speed)[2, 0])
    assert at == exactly(float(expected["max_abs_eps2"]), rel=REL)
    # "theta* ~ (beta - 1)/sqrt3, max |eps2| ~ 9/(8 sqrt3) omega0^2/(beta - 1)^2"
    gap = 1e-9
    assert largest.place == exactly(gap / math.sqrt(3.0), rel=2.0 * gap)
    limit = 9.0 / (8.0 * math.sqrt(3.0)) * (speed / gap) ** 2
    assert found == exactly(limit, rel=2.0 * gap)
    swing = lever.largest_angle
    assert math.degrees(swing.value) == exactly(float(expected["phi_max_deg"]), rel=REL)
    assert swing.place == exactly(float(expected["theta_phi_max_rad"]), rel=REL)
    _, omega, _ = lever.in_time(angles(0.0, 180.0), speed)
    assert omega[0] == exactly(float(expected["omega2_at_0"]), rel=REL)
    assert omega[1] == exactly(float(expected["omega2_at_180"]), rel=REL)


def test_hc03_rotating_slide() -> None:
    params, expected = hard_case("HC03")
    lever, speed = slotted_lever_of(params)
    first, last = lever.angle(np.array([0.0, TURN]))
    total = math.degrees(last - first)
    assert total == exactly(expected["total_phi_over_one_turn_deg"], rel=REL)
    table = expected["phi_deg_unwrapped"]
    phi = np.degrees(lever.angle(angles(*table)))
    assert phi == exactly(np.array([float(value) for value in table.values()]), rel=REL)
    fine = np.linspace(0.0, TURN, 3601)
    assert np.max(np.abs(np.diff(lever.angle(fine)))) < 0.01, "no jump at 60 or 300 deg"
    _, omega, _ = lever.in_time(angles(0.0, 180.0), speed)
    assert omega[0] == exactly(float(expected["omega2_at_0"]), rel=REL)
    assert omega[1] == exactly(float(expected["omega2_at_180"]), rel=REL)
    assert np.max(lever.velocity(fine)) < 0.0, "omega2_zero: never"
    largest = lever.largest_acceleration
    assert abs(largest.value) * speed**2 == exactly(float(expected["max_abs_eps2"]), rel=REL)
    assert math.degrees(largest.place) == exactly(float(expected["theta_of_max_deg"]), rel=REL)
    with pytest.raises(GeometryError, match="no largest angle"):  # "arcsin(R/a) undefined"
        _ = lever.largest_angle
    # The identities that the case names, with the lever of the ratio 1/beta.
    other = SlottedLever(lever.distance, lever.crank)
    assert other.acceleration(fine) == exactly(-lever.acceleration(fine), rel=REL)
    assert other.velocity(fine) == exactly(-1.0 - lever.velocity(fine), abs=REL)
    assert other.angle(fine) == exactly(math.pi - fine - lever.angle(fine), abs=REL)


def test_hc04_distance_far_longer_than_the_crank() -> None:
    params, expected = hard_case("HC04")
    lever, _ = slotted_lever_of(params)
    phi = np.degrees(lever.angle(angles(90.0, 1.0)))
    assert phi[0] == exactly(float(expected["phi_deg_at_90"]), rel=REL)
    assert phi[1] == exactly(float(expected["phi_deg_at_1"]), rel=REL)
    (omega,) = lever.velocity(angles(60.0))
    assert omega == exactly(float(expected["omega2_over_omega0_at_60"]), rel=REL)


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
    assert (finding.severity, finding.unit, finding.limit) == ("no-disc", "mm", DEAD_CENTRE * 100.0)
    assert finding.value == exactly(0.0, abs=1e-13)
    assert "at stroke 0 mm" in finding.sentence
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
    assert expected["theta_zweiter_deg"].startswith("180 (exactly")
    # What makes tan(theta/2) = (B + D)/(A - C) a 0/0, from our own lengths.
    linkage = crank_of(params, deflection)
    length, x, height = linkage.crank, linkage.start_position, linkage.guide_height
    a, b = 2.0 * length * x, -2.0 * length * height
    c = x * x + height * height + length**2 - linkage.coupler**2
    assert a == exactly(float(expected["A"]), rel=REL)
    assert b == exactly(float(expected["B"]), rel=REL)
    assert c == exactly(float(expected["C"]), rel=REL)
    assert math.sqrt(a * a + b * b - c * c) == exactly(float(expected["D"]), rel=REL)
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
    missing = float(words[words.index("mm;") - 1])
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


def test_hc11_a_stroke_of_a_nanometre() -> None:
    params, expected = hard_case("HC11")
    curve = pitch_curve_of(params)
    phi = angles(expected["phi_deg"])
    jet = curve.motion.jet(phi)
    assert jet[0, 0] == exactly(float(expected["s"]), rel=REL)
    assert jet[2, 0] == exactly(float(expected["s2"]), rel=REL)
    within = 1e-12  # the case's own, on rho and mu
    assert abs(curve.point(phi)[0]) - 100.0 == exactly(float(expected["r_minus_100"]), abs=within)
    rho = 1.0 / curve.curvature(phi)[0]
    assert rho - 100.0 == exactly(float(expected["rho_minus_100"]), abs=within)
    pressure = math.degrees(curve.pressure_angle(phi)[0])
    assert pressure == exactly(float(expected["ninety_minus_mu_deg"]), rel=REL)
    mu = math.degrees(curve.transmission_angle(phi)[0])
    assert 90.0 - mu == exactly(float(expected["ninety_minus_mu_deg"]), abs=within)


def test_hc12_a_base_circle_of_a_kilometre() -> None:
    params, expected = hard_case("HC12")
    curve = pitch_curve_of(params)
    phi = angles(params["phi_deg"])
    pressure = math.degrees(curve.pressure_angle(phi)[0])
    assert pressure == exactly(float(expected["ninety_minus_mu_deg"]), rel=1e-12)
    assert 1.0 / curve.curvature(phi)[0] == exactly(float(expected["rho"]), rel=1e-14)
    # Of a flank with a roller of 10 mm.
    radius = abs(WorkingCurve(curve, -10.0).point(phi)[0])
    assert radius == exactly(float(expected["inner_radius"]), rel=1e-14)


def test_hc13_inflection_at_a_millionth() -> None:
    params, expected = hard_case("HC13")
    lam = float(params["lambda_"])
    law = shift(POLYNOMIAL, lam)
    orders = {"f": 0, "f1": 1, "f2": 2, "f3": 3}
    middle = expected["z_05"]
    places = (
        (float(expected["z_half_lambda"]["z"]), expected["z_half_lambda"]),
        (lam, expected["z_lambda"]),
        (0.5, middle),
    )
    for z, values in places:
        found = law(np.array([z]))
        for key, order in orders.items():
            if key in values:
                assert found[order][0] == exactly(float(values[key]), rel=REL)
    largest = characteristic(law).acceleration
    assert largest.value == exactly(float(expected["max_f2"]), rel=REL)
    assert largest.place == exactly(float(expected["z_of_max_f2"]), rel=REL)
    assert law(np.zeros(1))[3][0] == exactly(float(expected["f3_at_0"]), rel=REL)
    # "f(z; lambda) = 1 - f(1 - z; 1 - lambda)"
    other = shift(POLYNOMIAL, 1.0 - lam)
    assert other.complement(np.array([0.5]))[0] == exactly(float(middle["f"]), rel=REL)
    assert expected["lambda_0_or_1"] == "error"
    for limit in (0.0, 1.0):
        with pytest.raises(GeometryError, match="strictly between 0 and 1"):
            shift(POLYNOMIAL, limit)


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
    # of 2 pi in phi and in the joint is a dz of 5e-8: no double of phi gives r_K to 1e-7.
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
    found = check_transmission_angle(curve, math.radians(60.0))
    assert (found.value, found.severity) == (expected["mu_at_0"], "broken")
    with pytest.raises(GeometryError, match="offset must not exceed"):
        replace(curve.follower, offset=math.nextafter(50.0, 51.0))


def test_hc16_triangle_that_does_not_close() -> None:
    params, expected = hard_case("HC16")
    pivot, arm = complex(-params["x_A0"], -params["y_A0"]), params["l_3"]
    with pytest.raises(GeometryError, match="form no triangle"):
        OscillatingRoller(pivot, arm, params["r_G"], 5.0)
    # At the limit itself, where psi_G = 0, the rocker lies on the line of centres: nothing could
    # start to move.
    assert expected["psi_G_at_limit"] == 0
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
    assert all(finding.severity == "no-disc" for finding in found)
    ranges = [finding.cam_range for finding in found]
    assert any(span is not None and span[0] > span[1] for span in ranges), "past cam angle 0"
    with pytest.raises(UndercutError, match="over the cam axis"):
        real_outline(inner)
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
    for undefined in (
        curve.curvature, curve.transmission_angle, curve.pressure_angle, curve.curvature_slope,
        curve.leverage, inner.point,
    ):  # fmt: skip
        assert np.all(np.isfinite(undefined(angles(100.0))))
        with pytest.raises(GeometryError, match="stands still in the turning cam"):
            undefined(phi)
    (finding,) = check_standstill(curve)
    assert (finding.name, finding.severity) == ("standstill", "no-disc")
    assert finding.cam_angle == exactly(phi[0], abs=1e-6)
    assert "rocker lies on the line of centres" in finding.sentence
    # psi_t reaches -0.1 or 0.1 degrees where it stood still: 100 mm of it are 0.17 mm a rad.
    for start in (5.9, 6.1):
        assert check_standstill(pitch_curve_of(params | {"psi_G_deg": start})) == ()


def test_hc19_the_common_normal_passes_through_the_pivot() -> None:
    params, expected = hard_case("HC19")
    curve = pitch_curve_of(params)
    phi = angles(params["phi_deg"])
    assert curve.motion.jet(phi)[1, 0] == exactly(expected["psi1"], rel=REL)
    mu = math.degrees(curve.transmission_angle(phi)[0])
    assert mu == exactly(expected["mu"], rel=REL)
    assert abs(curve.jet(phi)[1, 0]) == exactly(expected["abs_Z1"], rel=REL)
    assert 1.0 / curve.curvature(phi)[0] == exactly(float(expected["rho"]), rel=REL)
    assert curve.curvature(phi)[0] == exactly(float(expected["kappa"]), rel=REL)


def inflections(curve: PitchCurve) -> list[float]:
    """Cam angles [degrees] at which the curvature passes 0, between its neighbouring extremes."""
    places = curvature_extremes(curve).phi % TURN
    grid = np.unique(np.concatenate((places, np.linspace(0.0, TURN, 181))))
    return [float(angle) for angle in np.degrees(roots_on_grid(curve.curvature, grid))]


def test_hc20_a_cam_without_inflections() -> None:
    params, expected = hard_case("HC20")
    curve = pitch_curve_of(params)
    found = inflections(curve)
    assert found == expected["phi_deg"]
    assert len(found) == expected["n"]
    assert (curvature_extremes(curve).smallest()[0] > 0.0) == expected["convex_everywhere"]


def test_hc20b_a_cam_with_four_inflections() -> None:
    params, expected = hard_case("HC20b")
    curve = pitch_curve_of(params)
    found = inflections(curve)
    assert len(found) == expected["n"]
    assert found == exactly([float(angle) for angle in expected["phi_deg"]], abs=1e-9)
    # "work with kappa = 1/r_K": it passes 0 steadily where r_K passes through infinity.
    for angle in found:
        around = curve.curvature(np.radians(angle + np.array([-1e-6, 0.0, 1e-6])))
        assert np.all(np.isfinite(around))
        assert around[0] * around[2] < 0.0


def test_hc21a_roller_exactly_at_the_limit() -> None:
    params, expected = hard_case("HC21a")
    curve = pitch_curve_of(params)
    bends, flank = curvature_extremes(curve), inner_of(curve)
    kappa, phi = bends.largest()
    assert 1.0 / kappa == exactly(float(expected["rho_min"]), rel=REL)
    assert math.degrees(phi) == exactly(float(expected["phi_deg"]), abs=1e-6)
    back = np.degrees(bends.phi) > 130.0  # the return begins there
    worst = int(np.argmax(bends.values[back]))
    rho = 1.0 / bends.values[back][worst]
    assert rho == exactly(float(expected["rho_min_on_return"]), rel=REL)
    at = math.degrees(bends.phi[back][worst])
    assert at == exactly(float(expected["phi_on_return"]), abs=1e-6)
    tip = angles(expected["phi_deg"])
    assert flank.point(tip)[0] == exactly(number(expected["inner_point"]), rel=REL)
    # |Z'| is some 40 mm/rad, 1 + d kappa a rounding of 1.
    assert flank.traced(tip)[2][0] == exactly(expected["inner_speed"], abs=40.0 * 1e-14)
    # One cusp: neither undercut nor nothing.
    (finding,) = check_undercut(flank, "inner", bends)
    assert (finding.name, finding.severity) == ("cusp-inner", "no-disc")
    assert math.degrees(finding.cam_angle or 0.0) == exactly(float(expected["phi_deg"]), abs=1e-6)


@pytest.mark.parametrize(
    ("case", "within", "above"), [("HC21b", 1e-6, 1e-6), ("HC21c", 1e-8, 0.05)]
)
def test_hc21b_and_hc21c_cusps_of_a_roller_above_the_limit(
    case: str, within: float, above: float
) -> None:
    params, expected = hard_case(case)
    curve = pitch_curve_of(params)
    flank = inner_of(curve)
    # "must be reported as undercut although any plotted step may look smooth"
    (finding,) = check_undercut(flank, "inner", curvature_extremes(curve))
    assert (finding.name, finding.severity) == ("undercut-inner", "no-disc")
    assert finding.value == exactly(-above, rel=1e-6)
    found = np.array(known(finding.cam_range))
    first, second = float(expected["cusp1_phi_deg"]), float(expected["cusp2_phi_deg"])
    assert np.degrees(found) == exactly(np.array([first, second]), abs=within)
    tips = flank.point(found)
    # Near a cusp the flank moves by the square of what the angle is off.
    assert tips[0] == exactly(number(expected["cusp1"]), rel=REL)
    assert tips[1] == exactly(number(expected["cusp2"]), rel=REL)
    if "loop_width_mm" in expected:
        # The tips are rounded to a few ulp of 31 mm.
        width = float(expected["loop_width_mm"])
        assert abs(tips[1] - tips[0]) == exactly(width, abs=8.0 * math.ulp(31.0))


def test_hc21c_the_swallow_tail_crosses_itself() -> None:
    params, expected = hard_case("HC21c")
    flank = inner_of(pitch_curve_of(params))
    (crossing,) = find_crossings(flank)
    within = 1e-8  # degrees, the case's own
    first, second = float(expected["crossing_phi1_deg"]), float(expected["crossing_phi2_deg"])
    assert math.degrees(crossing.first) == exactly(first, abs=within)
    assert math.degrees(crossing.second) == exactly(second, abs=within)
    assert crossing.point == exactly(number(expected["crossing_point"]), rel=REL)
    # "inner curve between the two crossing angles must be trimmed"
    outline = real_outline(flank)
    assert np.degrees(outline.dropped) == exactly(np.array([[first, second]]), abs=within)
    (corner,) = outline.path.pivots
    assert corner.centre == exactly(crossing.point, rel=REL)
    assert outline.lobes == ()


def crossings_of_the_lobe(case: str) -> None:
    params, expected = hard_case(case)
    flank = inner_of(pitch_curve_of(params))
    ends = zip(
        expected["self_intersections_on_axis_phi_deg"],
        expected["mirror_phi_deg"],
        expected["radial_position_mm"],
        strict=True,
    )
    axis = np.exp(1j * math.radians(expected["lobe_axis_angle_deg"]))
    wanted = sorted((float(one), float(other), float(r) * axis) for one, other, r in ends)
    # The reference itself: both flanks are on the axis of the lobe there.
    for one, other, point in wanted:
        assert flank.point(angles(one, other)) == exactly(np.array([point, point]), rel=REL)
    found = find_crossings(flank)
    assert len(found) == len(wanted)
    for crossing, (one, other, point) in zip(found, wanted, strict=True):
        within = 1e-9  # degrees, the case's own
        assert math.degrees(crossing.first) == exactly(one, abs=within)
        assert math.degrees(crossing.second) == exactly(other, abs=within)
        assert crossing.point == exactly(complex(point), rel=REL)
    # "reject by global test": the neck is cut through where it is left first, and a lobe falls.
    outline = real_outline(flank)
    tips = [path.pivots[0].centre for path in (outline.path, *outline.lobes)]
    assert tips == exactly([point for _, _, point in wanted], rel=REL)
    cut, lobe = check_outline(outline, "inner", [], "no-disc")
    assert (cut.name, cut.severity) == ("global-undercut-inner", "no-disc")
    assert np.degrees(known(cut.cam_range)) == exactly(np.array(wanted[0][:2]), abs=1e-9)
    assert (lobe.name, lobe.severity) == ("lobe-inner", "no-disc")


def test_hc22_the_neck_of_a_lobe_is_cut_through() -> None:
    params, expected = hard_case("HC22")
    curve = pitch_curve_of(params)
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    rho = float(expected["rho_convex_min"])
    assert 1.0 / kappa == exactly(rho, rel=REL)
    # The lobe is symmetric about its top at cam angle 50; a flat extremum has half the digits.
    place = math.degrees(phi)
    nearer = min(place, 100.0 - place)
    assert nearer == exactly(float(expected["rho_convex_min_phi"]), abs=1e-6)
    assert params["r_R"] * kappa == exactly(float(expected["r_R_over_rho"]), rel=REL)
    # "r_K > r_R passes, r_K >= r_R/0.7 fails"
    (local,) = check_undercut(inner_of(curve), "inner", bends)
    assert local.severity == "ok"
    assert params["r_R"] < 1.0 / kappa < params["r_R"] / 0.7
    crossings_of_the_lobe("HC22")


def test_hc22b_two_flanks_nearer_than_the_roller_is_wide() -> None:
    params, expected = hard_case("HC22b")
    curve = pitch_curve_of(params)
    bends = curvature_extremes(curve)
    kappa, _ = bends.largest()
    assert 1.0 / kappa == exactly(expected["rho_convex_min"], rel=REL)
    assert params["r_R"] / 0.7 == exactly(float(expected["r_R_over_0_7"]), rel=REL)
    # "global undercut although r_K >= r_R/0.7 holds everywhere"
    assert 1.0 / kappa > params["r_R"] / 0.7
    (local,) = check_undercut(inner_of(curve), "inner", bends)
    assert local.severity == "ok"
    crossings_of_the_lobe("HC22b")


def test_hc23_the_pitch_curve_runs_back() -> None:
    params, expected = hard_case("HC23")
    curve = pitch_curve_of(params)
    assert isinstance(curve.follower, TranslatingRoller)
    offset = curve.follower.offset

    def turning(phi: np.ndarray[Any, Any]) -> Any:
        z, z1 = curve.jet(phi)[:2]
        return np.imag(np.conj(z) * z1)

    grid = np.linspace(0.0, TURN, 721)
    wanted = [float(angle) for angle in expected["reversal_phi_deg"]]
    assert np.degrees(roots_on_grid(turning, grid)) == exactly(np.array(wanted), abs=1e-9)
    # "reverses where sigma e kappa s' > r^2"
    slope = curve.motion.jet(grid)[1]
    back = curve.rotation * offset * slope > np.abs(curve.point(grid)) ** 2
    assert np.array_equal(back, turning(grid) > 0.0)
    assert np.array_equal(back, (grid > angles(wanted[0])) & (grid < angles(wanted[1])))
    # "defined by side of traversal": the roller is r_R from the flank, on the same side, all round.
    flank, phi = inner_of(curve), np.radians(np.array([20.0, 47.0, 60.0]))
    tangent = curve.jet(phi)[1]
    side = (flank.point(phi) - curve.point(phi)) / (-1j * curve.rotation * tangent)
    assert np.abs(side.imag) == exactly(0.0, abs=REL)
    assert side.real * np.abs(tangent) == exactly(np.full(3, params["r_R"]), rel=REL)


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
        warned = [f.name for f in check_linkage(motion) if f.severity != "ok"]
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


def test_hc27_the_rocker_passes_the_line_of_centres() -> None:
    params, expected = hard_case("HC27")
    curve = pitch_curve_of(params)
    phi = angles(expected["phi_deg"])
    # psi_t = 180 degrees is rounded: to half an ulp of pi, here by l_1/|Z'| of it.
    assert curve.transmission_angle(phi)[0] == exactly(expected["mu"], abs=1e-14)
    assert curve.point(phi)[0] == exactly(number(expected["Z"]), rel=REL)
    assert abs(curve.point(phi)[0]) == exactly(float(expected["r"]), rel=REL)
    assert math.isfinite(curve.curvature(phi)[0])
    found = check_transmission_angle(curve, math.radians(45.0))
    assert found.severity == "broken"
    assert found.value == exactly(expected["mu"], abs=1e-12)
    # The way down and the way back pass it in the middle, on either stroke.
    nearest = min(
        abs(math.degrees(known(found.cam_angle)) - each) for each in (expected["phi_deg"], 225)
    )
    assert nearest < 1e-9
    # "changes from F to P at this point": outward before it, inward behind it.
    around = phi + np.radians(np.array([-1.0, 1.0]))
    z, z1 = curve.jet(around)[:2]
    outward = np.real(np.conj(z) * z1)
    assert outward[0] > 0.0 > outward[1]


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
    b = -2.0 * crank * height
    # `branch` "erster" or "zweiter" is the sign of D, in the case as in the thesis's form.
    d = linkage.branch * math.sqrt(a * a + b * b - c * c)
    assert b + d == exactly(float(expected["B_plus_D"]), rel=1e-11)


# No case, and no value of one, is left out ------------------------------------------------------


@cache
def functions_here() -> dict[str, ast.FunctionDef]:
    """The functions of this file by their names."""
    tree = ast.parse(Path(__file__).read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def named(case: str) -> list[ast.FunctionDef]:
    """The functions of this file that have the case in their name."""
    return [
        function
        for function in functions_here().values()
        if function.name.startswith("test_") and case.lower() in function.name.split("_")
    ]


def words_of(function: ast.FunctionDef) -> list[str]:
    """Patterns of all strings in a function and in the functions that it calls, f-strings too."""
    others = functions_here()
    called = {node.id for node in ast.walk(function) if isinstance(node, ast.Name)} & set(others)
    found = []
    for each in (function, *(others[name] for name in called)):
        for node in ast.walk(each):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.append(re.escape(node.value))
            elif isinstance(node, ast.JoinedStr):
                parts = (
                    re.escape(str(part.value)) if isinstance(part, ast.Constant) else ".+"
                    for part in node.values
                )
                found.append("".join(parts))
    return found


def is_words(value: Any) -> bool:
    """Whether an expectation is in words and not a number."""
    return isinstance(value, str) and re.match(r"-?\d", value) is None


CASES = [case["id"] for case in reference("hard_cases.json")]


def test_there_are_33_cases() -> None:
    assert len(CASES) == len(set(CASES)) == 33


@pytest.mark.parametrize("case", CASES)
def test_every_case_has_a_test_of_its_name_that_asks_for_each_of_its_values(case: str) -> None:
    functions = named(case)
    assert functions, f"no test is named after {case}"
    words = [pattern for function in functions for pattern in words_of(function)]
    _, expected = hard_case(case)
    missing = [
        key
        for key, value in expected.items()
        if not is_words(value) and not any(re.fullmatch(pattern, key) for pattern in words)
    ]
    assert missing == []
