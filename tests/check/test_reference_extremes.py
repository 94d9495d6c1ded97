"""Extremes of the cams of the reference and of the thesis, and where they are.

Values of the reference's own cams are held to 1e-12 of their size, places to 1e-12 of the turn; the
thesis's are given with fewer digits, and hard cases may be flat extremes, whose place the small
second derivative divides.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgeo.check.flank import transmission_angle_extremes
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.numeric.extremes import roots_on_grid
from camgeo.units import TURN
from tests.reference import (
    hard_case,
    inner_of,
    mechanisms,
    pitch_curve_of,
    reference,
    thesis_params,
)

SHARP = 1e-12
SHARP_PLACE = 1e-12 * 360.0  # degrees

REL = 1e-9
PLACE = 1e-6  # degrees

EXTREMES: dict[str, dict[str, Any]] = reference("mechanism_extremes.json")

COMPARED = {
    "mu_min_deg", "mu_min_phi", "mu_min_kind", "mu_min_rise_deg", "mu_min_rise_phi",
    "mu_min_return_deg", "mu_min_return_phi", "rho_convex_min", "rho_convex_min_phi",
    "rho_convex_min_kind", "inflection_phi", "r_R",
}  # fmt: skip
"""Keys that the tests below compare; the concave ones are those of cams that have a hollow."""

CRITERIA = {
    "inner_criterion_3_36", "inner_local_undercut", "outer_criterion_3_36", "outer_local_undercut",
}  # fmt: skip
"""Compared in `test_findings`."""

THESIS = [
    (name, sigma)
    for name in reference("thesis_examples.toml")
    if name != "readme"
    for sigma in (-1, 1)
]


def place(phi: float) -> float:
    return math.degrees(phi)


def inflections(curve: PitchCurve) -> list[float]:
    """Cam angles [degrees] at which the curvature passes 0, between its neighbouring extremes."""
    grid = np.unique(np.concatenate((curvature_extremes(curve).phi, np.linspace(0.0, TURN, 181))))
    found = np.degrees(roots_on_grid(curve.curvature, grid)) % 360.0
    return sorted(float(angle) for angle in found)


def test_every_key_is_compared() -> None:
    assert set(EXTREMES) == set(mechanisms())
    for expected in EXTREMES.values():
        hollow = {"rho_concave_min", "rho_concave_min_phi"} if expected["inflection_phi"] else set()
        assert set(expected) == COMPARED | CRITERIA | hollow


def _kind(curve: PitchCurve, phi: float) -> str:
    """What makes the extreme at `phi` one: a root of the slope, or a break."""
    return "joint" if np.min(np.abs(curve.breaks - phi)) < math.radians(SHARP_PLACE) else "smooth"


@pytest.mark.parametrize("name", EXTREMES)
def test_smallest_transmission_angle(name: str) -> None:
    expected = EXTREMES[name]
    curve = pitch_curve_of(mechanisms()[name]["params"])
    mu, phi = transmission_angle_extremes(curve).smallest()
    assert expected["mu_min_kind"] == _kind(curve, phi)
    assert math.degrees(mu) == pytest.approx(float(expected["mu_min_deg"]), rel=SHARP)
    assert place(phi) == pytest.approx(float(expected["mu_min_phi"]), abs=SHARP_PLACE)


@pytest.mark.parametrize("name", EXTREMES)
@pytest.mark.parametrize("stroke", ["rise", "return"])
def test_smallest_transmission_angle_of_each_stroke(name: str, stroke: str) -> None:
    expected = EXTREMES[name]
    params = mechanisms()[name]["params"]
    first, rise, second, back, _ = (float(span) for span in params["phi_H"])
    start = first if stroke == "rise" else first + rise + second
    end = start + (rise if stroke == "rise" else back)
    found = transmission_angle_extremes(pitch_curve_of(params))
    degrees = np.degrees(found.phi)
    within = (degrees >= start - 1e-9) & (degrees <= end + 1e-9)
    values = np.degrees(found.values[within])
    assert np.min(values) == pytest.approx(float(expected[f"mu_min_{stroke}_deg"]), rel=SHARP)
    at = degrees[within][np.argmin(values)]
    true = float(expected[f"mu_min_{stroke}_phi"])
    # In the joints at both ends of a stroke the angle may be the same to the last bit.
    value_there = math.degrees(pitch_curve_of(params).transmission_angle(np.radians([true]))[0])
    assert at == pytest.approx(true, abs=SHARP_PLACE) or value_there == pytest.approx(
        np.min(values), rel=1e-14
    )


@pytest.mark.parametrize("name", EXTREMES)
def test_smallest_radii_of_curvature(name: str) -> None:
    expected = EXTREMES[name]
    curve = pitch_curve_of(mechanisms()[name]["params"])
    assert curve.follower.roller_radius == float(expected["r_R"])
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    assert expected["rho_convex_min_kind"] == _kind(curve, phi)
    assert 1.0 / kappa == pytest.approx(float(expected["rho_convex_min"]), rel=SHARP)
    assert place(phi) == pytest.approx(float(expected["rho_convex_min_phi"]), abs=SHARP_PLACE)
    kappa, phi = bends.smallest()
    if "rho_concave_min" not in expected:  # then there are no inflections either
        assert kappa > 0.0
        return
    assert -1.0 / kappa == pytest.approx(float(expected["rho_concave_min"]), rel=SHARP)
    assert place(phi) == pytest.approx(float(expected["rho_concave_min_phi"]), abs=SHARP_PLACE)


@pytest.mark.parametrize("name", EXTREMES)
def test_inflections(name: str) -> None:
    """Simple roots: their places are as good as the rounding of the curvature by its slope."""
    expected = [float(phi) for phi in EXTREMES[name]["inflection_phi"]]
    found = inflections(pitch_curve_of(mechanisms()[name]["params"]))
    assert found == pytest.approx(expected, abs=SHARP_PLACE)


@pytest.mark.parametrize(("name", "sigma"), THESIS)
def test_results_of_the_thesis_examples(name: str, sigma: int) -> None:
    example = reference("thesis_examples.toml")[name]
    expected = example["results_sigma_plus1" if sigma > 0 else "results_sigma_minus1"]
    curve = pitch_curve_of(thesis_params(name, sigma))
    swing = np.degrees(curve.motion.jet(curve.breaks)[0])
    extreme = swing[np.argmax(np.abs(swing))]
    assert extreme == pytest.approx(expected["psi_extreme"], rel=REL)
    radii = np.abs(curve.point(np.linspace(0.0, TURN, 721)))
    ends = np.abs(curve.point(curve.breaks))
    outward = np.max(ends) > curve.follower.base_radius * (1.0 + 1e-9)
    assert expected["cam_type"] == ("F" if outward else "P")
    # Off the line of centres the distance is monotone in the swing: its extremes are at joints.
    assert np.min(ends) == pytest.approx(expected["r_min"], rel=REL)
    assert np.max(ends) == pytest.approx(expected["r_max"], rel=REL)
    assert np.min(radii) >= np.min(ends) * (1.0 - 1e-14)
    assert np.max(radii) <= np.max(ends) * (1.0 + 1e-14)
    mu, phi = transmission_angle_extremes(curve).smallest()
    assert math.degrees(mu) == pytest.approx(expected["mu_min"], rel=REL)
    assert place(phi) == pytest.approx(expected["mu_min_at"], abs=PLACE)
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    assert 1.0 / kappa == pytest.approx(expected["rho_convex_min"], rel=REL)
    assert place(phi) == pytest.approx(expected["rho_convex_min_at"], abs=PLACE)
    kappa, phi = bends.smallest()
    if isinstance(expected["rho_concave_min"], str):
        assert "convex everywhere" in expected["rho_concave_min"]
        assert kappa > 0.0
    else:
        assert -1.0 / kappa == pytest.approx(expected["rho_concave_min"], rel=REL)
        assert place(phi) == pytest.approx(expected["rho_concave_min_at"], abs=PLACE)
    assert inflections(curve) == pytest.approx(expected["inflections"], abs=1e-9)


@pytest.mark.parametrize(("name", "sigma"), THESIS)
def test_what_is_derived_in_the_thesis_examples(name: str, sigma: int) -> None:
    derived = reference("thesis_examples.toml")[name]["derived"]
    curve = pitch_curve_of(thesis_params(name, sigma))
    follower, linkage = curve.follower, curve.motion.linkage  # type: ignore[attr-defined]  # the reference case has this kind of follower
    assert linkage.start_position == pytest.approx(derived["s_0"], rel=1e-12)
    assert linkage.guide_height == pytest.approx(derived["e_sk"], rel=1e-12)
    assert follower.centre_distance == pytest.approx(derived["l_1"], rel=1e-12)  # type: ignore[attr-defined]  # the reference case has this kind of follower
    start = math.degrees(follower.start_angle)  # type: ignore[attr-defined]  # the reference case has this kind of follower
    assert start == pytest.approx(derived["psi_G_from_r_G"], rel=1e-12)
    assert math.degrees(linkage.start_angle) == pytest.approx(derived["theta_0"], rel=1e-12)


def test_hc20_a_cam_without_and_hc20b_one_with_inflections() -> None:
    params, expected = hard_case("HC20")
    curve = pitch_curve_of(params)
    assert inflections(curve) == expected["phi_deg"] == []
    assert curvature_extremes(curve).smallest()[0] > 0.0
    params, expected = hard_case("HC20b")
    found = inflections(pitch_curve_of(params))
    assert len(found) == expected["n"]
    assert found == pytest.approx([float(phi) for phi in expected["phi_deg"]], abs=1e-9)


def test_hc21a_the_tightest_place_and_that_of_the_return() -> None:
    params, expected = hard_case("HC21a")
    curve = pitch_curve_of(params)
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    assert 1.0 / kappa == pytest.approx(float(expected["rho_min"]), rel=1e-12)
    assert place(phi) == pytest.approx(float(expected["phi_deg"]), abs=1e-6)
    back = np.degrees(bends.phi) > 130.0  # the return begins there
    worst = int(np.argmax(bends.values[back]))
    rho = 1.0 / bends.values[back][worst]
    assert rho == pytest.approx(float(expected["rho_min_on_return"]), rel=1e-12)
    at = math.degrees(bends.phi[back][worst])
    assert at == pytest.approx(float(expected["phi_on_return"]), abs=1e-6)
    flank = inner_of(curve)
    tip = complex(*(float(part) for part in expected["inner_point"]))
    angle = np.radians([float(expected["phi_deg"])])
    assert flank.point(angle)[0] == pytest.approx(tip, rel=1e-13)
    # 1 + d kappa is a rounding of 1 there, |Z'| some 40 mm.
    assert flank.pace(angle)[0] == pytest.approx(expected["inner_speed"], abs=1e-12)


@pytest.mark.parametrize("name", ["HC22", "HC22b"])
def test_hc22_where_the_local_test_passes(name: str) -> None:
    """Undercut there is global; the smallest radius is reported all the same."""
    params, expected = hard_case(name)
    kappa, phi = curvature_extremes(pitch_curve_of(params)).largest()
    assert 1.0 / kappa == pytest.approx(float(expected["rho_convex_min"]), rel=REL)
    assert 1.0 / kappa > params["r_R"]
    if name == "HC22":
        first = float(expected["rho_convex_min_phi"])
        # Rise and return are alike: the lobe is symmetric about the top, at 50 degrees.
        assert min(place(phi), 100.0 - place(phi)) == pytest.approx(first, abs=PLACE)
