"""The exact cam of the suite against the reference collection, which was computed elsewhere."""

from __future__ import annotations

import math
from typing import Any

import pytest
from mpmath import mp, mpf

from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from tests.reference import hard_case
from tests.stability import cams, loops
from tests.stability.cam_case import CamSpec
from tests.stability.exact_cam import CamJet
from tests.stability.lifts import lift
from tests.stability.linkage import exact_linkage
from tests.stability.series import Series, variable

DIGITS = 60

TURN = 360

PRINTED = mpf(10) ** -26
"""The reference prints 30 digits, its last ones rounded."""


def spec(name: str) -> CamSpec:
    found = {each.name: each for each in (*cams.specs(), *loops.specs())}
    return found[name]


def exact_parameters(cam: CamSpec, *, back: bool = False) -> list[Any]:
    """The inputs of a move: joints exactly as written, lengths as doubles."""
    parameters: list[Any] = [mpf(value) for value in cam.parameters(back=back)]
    number = 3 if back else 1
    first = sum(mpf(span) for span in cam.spans[:number])
    parameters[:2] = mp.radians(first), mp.radians(first + mpf(cam.spans[number]))
    return parameters


def jet_at(name: str, degrees: str, *, back: bool = False) -> CamJet:
    """A cam with a vertical guide at exactly those degrees."""
    cam = spec(name)
    parameters = exact_parameters(cam, back=back)
    parameters[-1] = mp.pi / 2
    return cam.stage.jet(mp.radians(mpf(degrees)), parameters)


def near(found: Any, expected: Any, relative: Any = PRINTED) -> bool:
    with mp.workdps(DIGITS):
        expected = mpf(expected)
        return bool(abs(mpf(found) - expected) <= mpf(relative) * abs(expected))


def test_hc11_a_tiny_stroke() -> None:
    _, expected = hard_case("HC11")
    with mp.workdps(DIGITS):
        cam = spec("HC11 tiny stroke")
        parameters = exact_parameters(cam)
        parameters[3], parameters[-1] = mpf("1e-6"), mp.pi / 2
        jet = cam.stage.jet(mp.radians(mpf("112.5")), parameters)
        bend = jet.bend
        assert near(jet.lift.terms[0], expected["s"])
        assert near(jet.lift.derivative(2), expected["s2"])
        # 29 digits of 100 mm and 1e-6 mm more than that: 20 are left of the difference.
        assert near(1 / bend.terms[0] - 100, expected["rho_minus_100"], mpf(10) ** -20)
        angle = mp.degrees(mp.pi / 2 - jet.transmission_angle)
        assert near(angle, expected["ninety_minus_mu_deg"])


def test_hc12_a_huge_base_circle() -> None:
    params, expected = hard_case("HC12")
    with mp.workdps(DIGITS):
        jet = jet_at("HC12 huge base circle", str(params["phi_deg"]))
        assert near(1 / jet.bend.terms[0], expected["rho"])
        angle = mp.degrees(mp.pi / 2 - jet.transmission_angle)
        assert near(angle, expected["ninety_minus_mu_deg"])
        assert near(abs(jet.parallel(-mpf(10))), expected["inner_radius"])


def test_hc14_a_return_in_a_millionth_of_a_degree() -> None:
    params, expected = hard_case("HC14")
    assert params["phi_H"][3] == "0.000001"
    with mp.workdps(DIGITS):
        jet = jet_at("HC14 return in 1e-6 degrees", "359.9999985", back=True)
        assert near(jet.lift.derivative(1), expected["s1"])
        assert near(abs(jet.centre.terms[1]), expected["abs_B1"])
        assert near(mp.degrees(jet.transmission_angle), expected["mu_deg"])
        assert near(1 / jet.bend.terms[0], expected["rho"], mpf(10) ** -24)


def test_hc19_the_normal_passes_the_pivot() -> None:
    """mu = 54 degrees, |Z'| = 100 and r_K = 100 exactly, with the triangle's angle exactly 30."""
    with mp.workdps(DIGITS):
        cam = spec("HC19 psi' = 1")
        parameters = exact_parameters(cam)
        parameters[3] = mp.radians(48)
        square = mpf(100) ** 2 + mpf(80) ** 2 - 2 * 100 * 80 * mp.cos(mp.radians(30))
        parameters[6] = mp.sqrt(square)
        jet = cam.stage.jet(mp.radians(135), parameters)
        assert near(jet.lift.derivative(1), 1)
        assert near(mp.degrees(jet.transmission_angle), 54)
        assert near(abs(jet.centre.terms[1]), 100)
        assert near(jet.bend.terms[0], "0.01")


def test_hc05_a_dead_centre() -> None:
    _, expected = hard_case("HC05")
    with mp.workdps(DIGITS):
        how = SliderCrank(40.0, 60.0, math.pi / 2.0, False, 1, -1, 1)
        _, crank_angle = exact_linkage(how, mpf(40), mpf(60), mp.pi / 2)
        z = variable(mpf("0.001"), 2 / mp.pi, 4)
        stroke = 20 * lift("polynomial-345", z, 1 - z, mpf(0.5))[0]
        theta = crank_angle(stroke)
        assert near(mp.degrees(theta.terms[0]) % TURN, expected["theta_deg"])
        assert near(theta.derivative(1), expected["theta1"])
        assert near(theta.derivative(2), expected["theta2"])
        end = crank_angle(Series((mpf(20),))).terms[0]
        assert near(mp.degrees(end) % TURN, expected["theta_at_full_stroke_deg"])


def test_hc26_the_swing_through_180_degrees() -> None:
    _, expected = hard_case("HC26")
    with mp.workdps(DIGITS):
        how = SliderCrank(50.0, 48.0, math.asin(0.8), False, 1, -1, -1)
        swing, crank_angle = exact_linkage(how, mpf(50), mpf(48), mp.asin(mpf(4) / 5))
        turned = swing(Series((mpf(10),))).terms[0]
        assert near(mp.degrees(turned), expected["swing_deg"])
        start = crank_angle(Series((mpf(0),))).terms[0]
        assert near(mp.degrees(start) % TURN, expected["theta_start_mod360"])


@pytest.mark.parametrize("name", [each.name for each in (*cams.specs(), *loops.specs())])
def test_curvature_slope_and_tilt_are_derivatives(name: str) -> None:
    """By central differences over 1e-12 rad, whose error is 1e-24 of the third derivative."""
    cam = spec(name)
    with mp.workdps(DIGITS):
        parameters = [mpf(value) for value in cam.parameters(back=False)]
        start, end = parameters[:2]
        phi, step = start + (end - start) * mpf("0.37"), (end - start) * mpf(10) ** -12
        here, before, after = (
            cam.stage.jet(place, parameters, 5) for place in (phi, phi - step, phi + step)
        )
        for now, then, slope, scale in (
            (before.bend.terms[0], after.bend.terms[0], here.bend.terms[1], here.bend.terms[0]),
            (before.tilt.terms[0], after.tilt.terms[0], here.tilt.terms[1], mpf(1)),
            (before.centre.terms[3], after.centre.terms[3], 4 * here.centre.terms[4],
             here.centre.terms[3]),
        ):  # fmt: skip
            span = end - start
            assert abs((then - now) / (2 * step) - slope) * span <= mpf(10) ** -15 * (
                abs(scale) + abs(slope) * span
            )
