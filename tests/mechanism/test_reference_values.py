"""All mechanisms of `mechanism_values.json` at all their angles: every quantity that it has."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
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
    kappa, relative = curve.curvature(phi), curve.relative_jet(phi)
    fixed = (relative.along[0] + 1j * relative.across[0]) * np.exp(1j * relative.axis)
    rocker = isinstance(curve.follower, OscillatingRoller)
    # From the rocker, or from the x axis, to the normal; v of a guide is sigma times Wirsig's.
    along = -relative.v if rocker else curve.rotation * relative.v
    signed = np.arctan2(np.abs(relative.u), along)
    found: dict[str, Quantity] = dict(zip(("Z", "Z1", "Z2", "Z3"), curve.jet(phi), strict=True))
    found |= {
        "W": fixed,
        "r": np.abs(curve.point(phi)),
        "inner": inner_of(curve).point(phi),
        "outer": outer_of(curve).point(phi),
        "mu": np.degrees(curve.transmission_angle(phi)),
        "mu_s": np.degrees(signed),
        "kappa": kappa,
        "rho": 1.0 / kappa,
        **_of_the_motion(curve, phi, name),
    }
    pairs = {
        key: (values, complex_column(rows, key) if np.iscomplexobj(values) else column(rows, key))
        for key, values in found.items()
    }
    pairs["point"] = (curve.point(phi), complex_column(rows, "Z"))
    pairs["pressure"] = (np.degrees(curve.pressure_angle(phi)), 90.0 - column(rows, "mu"))
    return pairs


def _of_the_motion(curve: PitchCurve, phi: FloatArray, name: str) -> dict[str, Quantity]:
    """Stroke, rocker and linkage, as far as there are such; angles in degrees."""
    case, motion = mechanisms()[name], curve.motion
    found: dict[str, Quantity] = {}
    if "s" in case["rows"][0]:
        found |= dict(zip(("s", "s1", "s2", "s3"), stroke_of(curve).jet(phi), strict=True))
    if isinstance(curve.follower, OscillatingRoller):
        swing = np.array(motion.jet(phi))
        found["psi_t"] = np.degrees(curve.follower.rocker_angle(swing[0]))
        if not isinstance(motion, LinkedMotion):  # there lift is counted outward or inward
            swing = case["params"]["kappa"] * swing
        swing[0] = np.degrees(swing[0])
        found |= dict(zip(("psi", "psi1", "psi2", "psi3"), swing, strict=True))
    if isinstance(motion, LinkedMotion):
        stroke = motion.demanded.jet(phi)[0]
        assert isinstance(motion.linkage, SliderCrank)
        pin, tip = motion.linkage.joints(stroke)
        coupler = pin - tip
        if motion.linkage.mirrored:  # the reference sees the linkage from the front
            coupler = -np.conj(coupler)
        found["coupler_angle"] = np.degrees(np.angle(coupler))
        found["theta"] = np.degrees(motion.linkage.crank_angle(stroke))
    return found


def deviations(curve: PitchCurve, name: str) -> dict[str, float]:
    pairs = quantities(curve, name)
    if "coupler_angle" in pairs:  # a coupler parallel to the guide is at 180 degrees or at -180
        found, true = pairs["coupler_angle"]
        apart = np.angle(np.exp(1j * np.radians(found - true)))
        pairs["coupler_angle"] = (true + np.degrees(apart), true)
    return {key: deviation(*pair) for key, pair in pairs.items()}


@by_name
def test_every_quantity_at_every_angle(name: str) -> None:
    case = mechanisms()[name]
    found = deviations(pitch_curve_of(case["params"]), name)
    for row in case["rows"]:
        assert set(row) - {"phi_deg"} == set(found) - {"point", "pressure"}
    assert {key: value for key, value in found.items() if not value <= LIMIT} == {}


@by_name
def test_what_is_derived(name: str) -> None:
    """Triangle and start of the rocker, and of the crank."""
    case = mechanisms()[name]
    curve, derived = pitch_curve_of(case["params"]), case["derived"]
    found: dict[str, float] = {}
    if isinstance(curve.follower, OscillatingRoller):
        found["psiG"] = math.degrees(curve.follower.start_angle)
    if isinstance(curve.motion, LinkedMotion):
        assert isinstance(curve.follower, OscillatingRoller)
        assert isinstance(curve.motion.linkage, SliderCrank)
        found["theta0"] = math.degrees(curve.motion.linkage.start_angle)
        found["l1"] = curve.follower.centre_distance
        found["alphaA"] = math.degrees(np.angle(-curve.follower.pivot))
    true = {key: float(value) for key, value in derived.items()}
    assert found == pytest.approx(true, rel=LIMIT, abs=0.0)
