"""All cams of `mechanism_values.json` at all their cam angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.reference import (
    column,
    complex_column,
    inner_of,
    mechanisms,
    outer_of,
    pitch_curve_of,
    stroke_of,
)

LIMIT = 1e-12
"""As a share of the size of each quantity, its maximum over the turn. Found: 6e-15 and less for all
but r_K, up to 5e-14, as 1/kappa multiplies the rounding of kappa near an inflection."""

by_name = pytest.mark.parametrize("name", mechanisms())

Quantity = FloatArray | ComplexArray


def deviation(found: Quantity, true: Quantity) -> float:
    """Largest difference as a share of the largest true value, or 0 if all are exactly 0."""
    assert found.shape == true.shape
    assert np.all(np.isfinite(found))
    difference = float(np.max(np.abs(found - true)))
    return difference and difference / float(np.max(np.abs(true)))


def quantities(curve: PitchCurve, name: str) -> dict[str, tuple[Quantity, Quantity]]:
    """Found and true values of everything that the reference gives, by its names there."""
    rows = mechanisms()[name]["rows"]
    phi = np.radians(column(rows, "phi_deg"))
    kappa = curve.curvature(phi)
    pairs: dict[str, tuple[Quantity, Quantity]] = {
        key: (values, complex_column(rows, key))
        for key, values in zip(("Z", "Z1", "Z2", "Z3"), curve.jet(phi), strict=True)
    }
    pairs |= {
        "point": (curve.point(phi), complex_column(rows, "Z")),
        "inner": (inner_of(curve).point(phi), complex_column(rows, "inner")),
        "outer": (outer_of(curve).point(phi), complex_column(rows, "outer")),
        "mu": (np.degrees(curve.transmission_angle(phi)), column(rows, "mu")),
        "pressure": (np.degrees(curve.pressure_angle(phi)), 90.0 - column(rows, "mu")),
        "kappa": (kappa, column(rows, "kappa")),
        "rho": (1.0 / kappa, column(rows, "rho")),
    }
    follower = curve.follower
    if "s" in rows[0]:
        for key, values in zip(("s", "s1", "s2", "s3"), stroke_of(curve).jet(phi), strict=True):
            pairs[key] = (values, column(rows, key))
    if not isinstance(follower, TranslatingRoller):
        swing = curve.motion.jet(phi)
        if not isinstance(curve.motion, LinkedMotion):  # there lift is counted outward or inward
            swing = mechanisms()[name]["params"]["kappa"] * swing
        swing[0] = np.degrees(swing[0])
        for key, values in zip(("psi", "psi1", "psi2", "psi3"), swing, strict=True):
            pairs[key] = (values, column(rows, key))
    return pairs


def deviations(curve: PitchCurve, name: str) -> dict[str, float]:
    return {key: deviation(*pair) for key, pair in quantities(curve, name).items()}


@by_name
def test_every_quantity_at_every_angle(name: str) -> None:
    case = mechanisms()[name]
    assert len(case["rows"]) == 49
    found = deviations(pitch_curve_of(case["params"]), name)
    kind = case["params"]["kind"]
    asked = {"Z", "Z1", "Z2", "Z3", "inner", "outer", "mu", "kappa", "rho"}
    asked |= {"s", "s1", "s2", "s3"} if kind != "osc" else set()
    asked |= {"psi", "psi1", "psi2", "psi3"} if kind != "trans" else set()
    assert asked <= set(found)
    assert {key: value for key, value in found.items() if not value <= LIMIT} == {}


@by_name
def test_start_angle_of_the_rocker_and_of_the_crank(name: str) -> None:
    case = mechanisms()[name]
    curve, derived = pitch_curve_of(case["params"]), case["derived"]
    if isinstance(curve.follower, TranslatingRoller):
        assert derived == {}
        return
    start = np.degrees(curve.follower.start_angle)  # type: ignore[attr-defined]
    assert start == pytest.approx(float(derived["psiG"]), rel=LIMIT)
    if isinstance(curve.motion, LinkedMotion):
        assert np.degrees(curve.motion.linkage.start_angle) == pytest.approx(
            float(derived["theta0"]), rel=LIMIT
        )


@pytest.mark.parametrize("name", ["trans_F_sp_e12", "osc_P_sm", "T6_setzhub_sm_program"])
def test_small_errors_in_the_mechanism_are_seen(name: str) -> None:
    """The other sense, and a base radius and a roller 1e-11 too large."""
    curve = pitch_curve_of(mechanisms()[name]["params"])
    other = deviations(replace(curve, rotation=-curve.rotation), name)
    assert other["Z"] > 0.1
    large = replace(curve.follower, base_radius=curve.follower.base_radius * (1.0 + 1e-11))  # type: ignore[type-var]
    assert deviations(replace(curve, follower=large), name)["Z"] > LIMIT
    thick = replace(curve.follower, roller_radius=curve.follower.roller_radius + 1e-9)  # type: ignore[type-var]
    spoiled = deviations(replace(curve, follower=thick), name)
    assert spoiled["inner"] > LIMIT
    assert spoiled["outer"] > LIMIT
    assert spoiled["Z"] <= LIMIT
