"""Extremes of the cams of the reference and of the thesis, of tables between their rows, and of
random mechanisms; and where they are.

Values of the reference's own cams are held to 1e-12 of their size, places to 1e-12 of the turn; the
thesis's are given with fewer digits. Scenes of fixtures/found are public reports: the spline is
scipy's there, the formulas are those of the mechanism."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

import camgeo
from camgeo.app.answers.size import size
from camgeo.check.disc import transmission_angle_extremes
from camgeo.check.finding import Finding
from camgeo.design.machining import plan_machining
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import roots_on_grid
from camgeo.units import TURN
from tests.draws.extremes import cases, misses_of
from tests.findings import known
from tests.reference import (
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


THESIS = [
    (name, sigma)
    for name in reference("thesis_examples.toml")
    if name != "readme"
    for sigma in (-1, 1)
]


def inflections(curve: PitchCurve) -> list[float]:
    """Cam angles [degrees] at which the curvature passes 0, between its neighbouring extremes."""
    grid = np.unique(np.concatenate((curvature_extremes(curve).phi, np.linspace(0.0, TURN, 181))))
    found = np.degrees(roots_on_grid(curve.curvature, grid)) % 360.0
    return sorted(float(angle) for angle in found)


def _kind(curve: PitchCurve, phi: float) -> str:
    """What makes the extreme at `phi` one: a root of the slope, or a break."""
    return "joint" if np.min(np.abs(curve.breaks - phi)) < math.radians(SHARP_PLACE) else "smooth"


def with_place(expected: dict[str, Any], key: str, place: str) -> Any:
    """A value of the reference, and its place."""
    value = pytest.approx(float(expected[key]), rel=SHARP)
    return value, pytest.approx(float(expected[place]), abs=SHARP_PLACE)


@pytest.mark.parametrize("name", EXTREMES)
def test_extremes_of_the_reference(name: str) -> None:
    """Inflections are simple roots: their places are as good as the rounding of the curvature by
    its slope.
    """
    expected = EXTREMES[name]
    curve = pitch_curve_of(mechanisms()[name]["params"])
    assert curve.follower.roller_radius == float(expected["r_R"])
    mu, at = transmission_angle_extremes(curve).smallest()
    wanted = with_place(expected, "mu_min_deg", "mu_min_phi")
    assert (math.degrees(mu), math.degrees(at)) == wanted
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    wanted = with_place(expected, "rho_convex_min", "rho_convex_min_phi")
    assert (1.0 / kappa, math.degrees(phi)) == wanted
    kinds = expected["mu_min_kind"], expected["rho_convex_min_kind"]
    assert kinds == (_kind(curve, at), _kind(curve, phi))
    kappa, phi = bends.smallest()
    if "rho_concave_min" in expected:
        wanted = with_place(expected, "rho_concave_min", "rho_concave_min_phi")
        assert (-1.0 / kappa, math.degrees(phi)) == wanted
    else:  # then there are no inflections either
        assert kappa > 0.0
    found = inflections(curve)
    assert found == pytest.approx([*map(float, expected["inflection_phi"])], abs=SHARP_PLACE)


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
    assert math.degrees(phi) == pytest.approx(expected["mu_min_at"], abs=PLACE)
    bends = curvature_extremes(curve)
    kappa, phi = bends.largest()
    assert 1.0 / kappa == pytest.approx(expected["rho_convex_min"], rel=REL)
    assert math.degrees(phi) == pytest.approx(expected["rho_convex_min_at"], abs=PLACE)
    kappa, phi = bends.smallest()
    if isinstance(expected["rho_concave_min"], str):
        assert "convex everywhere" in expected["rho_concave_min"]
        assert kappa > 0.0
    else:
        assert -1.0 / kappa == pytest.approx(expected["rho_concave_min"], rel=REL)
        assert math.degrees(phi) == pytest.approx(expected["rho_concave_min_at"], abs=PLACE)
    assert inflections(curve) == pytest.approx(expected["inflections"], abs=1e-9)


FOUND = Path(__file__).parents[2] / "fixtures" / "found"


CLOSE = 1e-6
"""Of two solutions of one spline, whose second derivatives are rounded by 1e-16 of the lift over
the square of the distance of rows, 1e-5 at least."""


GRID = 5e-4
"""Of the grid [deg]: at a peak a value is off by at most 1e-6 of what it changes by in a row of a
quarter of a degree."""


def lift(name: str, unit: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Cam angles [deg] on a grid, and the lift there with two derivatives [mm or rad]."""
    table = np.loadtxt(next((FOUND / name).glob("*.csv")), delimiter=",", skiprows=1)
    if table[-1, 0] < 360.0:
        table = np.vstack((table, [360.0, table[0, 1]]))
    angle, values = np.radians(table[:, 0]), table[:, 1] * unit
    spline = make_interp_spline(angle, values, k=5, bc_type="periodic")
    phi = np.arange(0.0, 360.0, GRID)
    s, s1, s2 = (spline(np.radians(phi), order) for order in range(3))
    return phi, s, s1, s2


def finding(name: str, check: str) -> tuple[Finding, float]:
    """A finding of a scene, and where [deg] it is."""
    design = camgeo.load(FOUND / name / f"{name}.toml")
    found = next(each for each in design.findings if each.name == check)
    return found, math.degrees(known(found.cam_angle))


def test_the_smallest_radius_of_a_half_degree_table() -> None:
    phi, s, s1, s2 = lift("half_degree_table", 1.0)
    radius = 60.0 + s
    kappa = (radius**2 + 2.0 * s1**2 - radius * s2) / np.hypot(radius, s1) ** 3
    worst = int(np.argmax(kappa))
    found, place = finding("half_degree_table", "radius-ratio-inner")
    assert found.value == pytest.approx(14.0 * kappa[worst], rel=CLOSE)
    assert place == pytest.approx(phi[worst], abs=GRID)
    assert found.severity == "broken"
    assert f"{1.0 / kappa[worst]:.4f}" == "18.0786"  # as reported


def test_the_smallest_angle_of_a_quarter_degree_lever() -> None:
    phi, s, s1, _ = lift("quarter_degree_lever", math.radians(1.0))
    start = math.acos((110.0**2 + 105.0**2 - 62.0**2) / (2.0 * 110.0 * 105.0))
    # The arm lies counter-clockwise of the line from the pivot to the cam axis, which it leaves
    # while the cam turns clockwise.
    arm = 105.0 * np.exp(1j * (math.pi + start + s))
    velocity = 1j * s1 * arm + 1j * (110.0 + arm)
    normal = 1j * velocity / np.abs(velocity)
    mu = np.degrees(np.arcsin(np.abs(np.real(np.conj(normal) * 1j * arm / 105.0))))
    least = int(np.argmin(mu))
    found, place = finding("quarter_degree_lever", "transmission-angle")
    assert found.value == pytest.approx(mu[least], rel=CLOSE)
    assert place == pytest.approx(phi[least], abs=GRID)
    assert found.severity == "broken"


def test_the_smallest_radius_under_a_flat_face() -> None:
    phi, s, _, s2 = lift("inch_lobe_flat", 25.4)
    radius = 0.55 * 25.4 + s + s2
    least = int(np.argmin(radius))
    found, place = finding("inch_lobe_flat", "convexity")
    assert found.value == pytest.approx(radius[least], rel=CLOSE)
    assert place == pytest.approx(phi[least], abs=GRID)
    scene = camgeo.load(FOUND / "inch_lobe_flat" / "inch_lobe_flat.toml")
    sized = size(scene).best.sizing
    assert known(sized.answer).base_radius == pytest.approx(-np.min(s + s2), rel=CLOSE)
    assert [each.name for each in sized.active] == ["convexity"]


def test_a_cutter_that_is_larger_than_a_hollow_is_refused_with_its_place() -> None:
    design = camgeo.load(FOUND / "cutter_too_large" / "cutter_too_large.toml")
    phi, s, s1, s2 = lift("cutter_too_large", 1.0)
    radius = 60.0 + s
    kappa = (radius**2 + 2.0 * s1**2 - radius * s2) / np.hypot(radius, s1) ** 3
    worst = int(np.argmin(kappa))
    hollow = -1.0 / kappa[worst] + 6.0  # the flank lies within the path of the roller's centre
    (refused,) = plan_machining(design.discs).findings
    assert refused.severity == "invalid"
    told = f"its smallest concave radius is {hollow:.6g} mm at cam angle {phi[worst]:.4f}"
    assert told in refused.sentence


SEED = 0x2026


STEP = 0.02
"""Of the grid [deg], ten times that of the program."""


@pytest.mark.parametrize("case", [*cases(SEED, 3, 2)], ids=lambda case: case[0])
def test_nothing_is_beyond_what_is_told(
    case: tuple[str, object, str | None], tmp_path: Path
) -> None:
    name, values, rows = case
    assert misses_of(values, rows, tmp_path, sizes=name.startswith("plan 3"), step=STEP) == []
