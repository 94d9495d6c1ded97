"""Peaks of lift tables between their rows, which a fixed number of samples per turn misses.

Scenes of public reports in fixtures/found. The spline is scipy's, the formulas are those of the
mechanism.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

import camgeo
from camgeo.app.answers.size import size
from camgeo.check.finding import Finding
from camgeo.design.machining import machining_of
from camgeo.numeric.arrays import FloatArray

FOUND = Path(__file__).parents[2] / "fixtures" / "found"

CLOSE = 1e-6
"""Of two solutions of one spline, whose second derivatives are rounded by 1e-16 of the lift over
the square of the distance of rows, 1e-5 at least."""

STEP = 5e-4
"""Of the grid [deg]: at a peak a value is off by at most 1e-6 of what it changes by in a row of a
quarter of a degree."""


def lift(name: str, unit: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Cam angles [deg] on a grid, and the lift there with two derivatives [mm or rad]."""
    table = np.loadtxt(next((FOUND / name).glob("*.csv")), delimiter=",", skiprows=1)
    if table[-1, 0] < 360.0:
        table = np.vstack((table, [360.0, table[0, 1]]))
    angle, values = np.radians(table[:, 0]), table[:, 1] * unit
    spline = make_interp_spline(angle, values, k=5, bc_type="periodic")
    phi = np.arange(0.0, 360.0, STEP)
    s, s1, s2 = (spline(np.radians(phi), order) for order in range(3))
    return phi, s, s1, s2


def finding(name: str, check: str) -> Finding:
    design = camgeo.load(FOUND / name / f"{name}.toml")
    return next(each for each in design.findings if each.name == check)


def place(found: Finding) -> float:
    """Where [deg]."""
    assert found.cam_angle is not None
    return math.degrees(found.cam_angle)


def test_the_smallest_radius_of_a_half_degree_table() -> None:
    phi, s, s1, s2 = lift("half_degree_table", 1.0)
    radius = 60.0 + s
    kappa = (radius**2 + 2.0 * s1**2 - radius * s2) / np.hypot(radius, s1) ** 3
    worst = int(np.argmax(kappa))
    found = finding("half_degree_table", "radius-ratio-inner")
    assert found.value == pytest.approx(14.0 * kappa[worst], rel=CLOSE)
    assert place(found) == pytest.approx(phi[worst], abs=STEP)
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
    found = finding("quarter_degree_lever", "transmission-angle")
    assert found.value == pytest.approx(mu[least], rel=CLOSE)
    assert place(found) == pytest.approx(phi[least], abs=STEP)
    assert found.severity == "broken"


def test_the_smallest_radius_under_a_flat_face() -> None:
    phi, s, _, s2 = lift("inch_lobe_flat", 25.4)
    radius = 0.55 * 25.4 + s + s2
    least = int(np.argmin(radius))
    found = finding("inch_lobe_flat", "convexity")
    assert found.value == pytest.approx(radius[least], rel=CLOSE)
    assert place(found) == pytest.approx(phi[least], abs=STEP)
    scene = camgeo.load(FOUND / "inch_lobe_flat" / "inch_lobe_flat.toml")
    sized = size(scene).sizing
    assert sized.answer is not None
    assert sized.answer.base_radius == pytest.approx(-np.min(s + s2), rel=CLOSE)
    assert [each.name for each in sized.active] == ["convexity"]


def test_a_cutter_that_is_larger_than_a_hollow_is_refused_with_its_place() -> None:
    design = camgeo.load(FOUND / "cutter_too_large" / "cutter_too_large.toml")
    phi, s, s1, s2 = lift("cutter_too_large", 1.0)
    radius = 60.0 + s
    kappa = (radius**2 + 2.0 * s1**2 - radius * s2) / np.hypot(radius, s1) ** 3
    worst = int(np.argmin(kappa))
    hollow = -1.0 / kappa[worst] + 6.0  # the flank lies within the path of the roller's centre
    (refused,) = machining_of(design.discs).findings
    assert refused.severity == "invalid"
    told = f"its smallest concave radius is {hollow:.6g} mm at cam angle {phi[worst]:.4f}"
    assert told in refused.sentence
