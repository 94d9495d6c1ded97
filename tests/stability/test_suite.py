"""The suite: every case is as accurate as doubles allow, and a bad algorithm is detected."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower import bend_of_path
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.units import TURN
from tests.reference import reference
from tests.stability import cams, faces, loops, outlines, slotted_levers
from tests.stability.cam_case import CamSpec, cases_of
from tests.stability.measure import Case, Found, Reading, measure
from tests.stability.quick import CASES, quick
from tests.stability.suite import GROUPS, LIMIT, names, run, table, worst_of_cases


def spec(name: str) -> CamSpec:
    return next(each for each in cams.specs() if each.name == name)


@pytest.mark.parametrize("group", GROUPS)
def test_no_digits_are_lost_that_the_inputs_have(group: str) -> None:
    readings = [each for each in quick() if each.group == group]
    assert readings
    poor = [each for each in readings if each.ratio > LIMIT]
    assert poor == []


def test_names_distinguish_cases() -> None:
    twice = [key for key, count in Counter((c.group, c.name, c.quantities) for c in CASES).items()
             if count > 1]  # fmt: skip
    assert twice == []
    assert {case.group for case in CASES} == set(GROUPS)


@pytest.mark.parametrize("case", [pytest.param(c, id=f"{c.group}-{c.name}") for c in CASES])
def test_a_case_gives_what_it_names(case: Case) -> None:
    assert case.places
    found = case.found(np.array(case.places))
    assert len(found) == len(case.quantities)
    assert all(len(column) == len(case.places) for column in found)


@pytest.mark.parametrize("name", ["HC01", "HC02", "HC03", "HC04", "HC05", "HC06", "HC11", "HC12",
                                  "HC13", "HC14", "HC15", "HC17", "HC18", "HC19", "HC20b", "HC21b",
                                  "HC21c", "HC22", "HC22b", "HC23", "HC26", "HC27",
                                  "HC28"])  # fmt: skip
def test_the_hard_cases_are_among_them(name: str) -> None:
    assert any(case.name.startswith(name) for case in CASES)
    assert name in {case["id"] for case in reference("hard_cases.json")}


# A bad algorithm is seen --------------------------------------------------------------------------


def worsened(name: str, quantity: str, bad: FloatArray | ComplexArray) -> list[Reading]:
    """Readings of a quantity of a cam's rise with other values for it."""
    (case, *_) = cases_of(spec(name))
    index = case.quantities.index(quantity)

    def found(phi: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        columns = list(case.found(phi))
        columns[index] = bad
        return tuple(columns)

    return [each for each in measure(replace(case, found=found)) if each.quantity == quantity]


def places(name: str) -> tuple[PitchCurve, FloatArray]:
    cam = spec(name)
    (case, *_) = cases_of(cam)
    return cam.curve, np.array(case.places)


def ratio(readings: list[Reading]) -> float:
    (row,) = table(readings)
    return row.largest_ratio.ratio


def test_an_angle_by_its_cosine_is_seen() -> None:
    """HC12: acos of the scalar product is off by 1e-8 near 90 degrees less mu = 0."""
    name = "HC12 huge base circle"
    curve, phi = places(name)
    relative = curve.relative_jet(phi, order=1)
    bad = np.arccos(np.minimum(np.abs(relative.u) / curve.speed(relative), 1.0))
    assert ratio(worsened(name, "pressure angle", curve.pressure_angle(phi))) <= LIMIT
    assert ratio(worsened(name, "pressure angle", bad)) > 1e3 * LIMIT


def test_curvature_by_differences_is_seen() -> None:
    """The best step leaves the cube root of the rounding, a third of the digits."""
    name = "offset guide"
    curve, phi = places(name)
    step = np.finfo(float).eps ** 0.25
    phi = np.maximum(phi, phi[1])
    before, here, after = (curve.point(phi + shift) for shift in (-step, 0.0, step))
    first, second = (after - before) / (2.0 * step), (after - 2.0 * here + before) / step**2
    bad = -np.imag(np.conj(first) * second) / np.abs(first) ** 3
    assert ratio(worsened(name, "curvature", curve.curvature(phi))[1:]) <= LIMIT
    assert ratio(worsened(name, "curvature", bad)[1:]) > 1e3 * LIMIT


def test_a_slope_that_cancels_is_seen() -> None:
    """kappa' from Z', Z'', Z''': with a tiny stroke large terms leave a tiny one."""
    name = "tiny stroke, offset"
    curve, phi = places(name)
    _, z1, z2, z3 = curve.jet(phi)
    square = np.abs(z1) ** 2
    cross, cross_slope = np.imag(np.conj(z1) * z2), np.imag(np.conj(z1) * z3)
    dot = np.real(np.conj(z1) * z2)
    bad = -(cross_slope - 3.0 * cross * dot / square) / square**1.5
    assert ratio(worsened(name, "curvature slope", curve.curvature_slope(phi))) <= LIMIT
    assert ratio(worsened(name, "curvature slope", bad)) > 1e3 * LIMIT


def test_a_wrong_formula_is_seen() -> None:
    """One ulp in a million of the base radius."""
    name = "offset guide"
    curve, phi = places(name)
    assert ratio(worsened(name, "pitch curve Z", curve.point(phi) * (1.0 + 1e-10))) > LIMIT


def test_a_mirrored_disc_is_seen() -> None:
    name = "offset guide"
    curve, phi = places(name)
    assert ratio(worsened(name, "curvature", -curve.curvature(phi))) > 1e12


def changed(cases: Sequence[Case], name: str, quantity: str, bad: Found) -> tuple[float, float]:
    """Ratios of a quantity of a case, by camgeo and by a function of the places instead."""
    case = next(c for c in cases if c.name == name and quantity in c.quantities)
    case = replace(case, exact=cache(case.exact))  # the same for both
    index = case.quantities.index(quantity)

    def found(places: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        columns = list(case.found(places))
        (columns[index],) = bad(places)
        return tuple(columns)

    def worst(case: Case) -> float:
        return max(each.ratio for each in measure(case) if each.quantity == quantity)

    return worst(case), worst(replace(case, found=found))


def test_a_crossing_by_points_is_seen() -> None:
    """Points of a tail 1e-13 mm wide differ by their rounding only: 1e-7 of its width is left."""
    excess = 1e-9
    name = f"roller {excess:.0e} too large"
    case = next(c for c in CASES if c.name == name and "crossing point" in c.quantities)
    first, second, _ = (float(np.real(column[0])) for column in case.found(np.array(case.places)))

    def bad(places: FloatArray) -> tuple[FloatArray]:
        return (np.full(len(places), first + 1e-7 * (second - first)),)

    good, poor = changed([case], name, "crossing, first cam angle", bad)
    assert good <= LIMIT
    # 3e-12 rad of 2e-16 rad an ulp, and a conditioning of 1e4 ulp.
    assert poor > 1.0

    def worse(places: FloatArray) -> tuple[FloatArray]:
        return (np.full(len(places), first + 1e-4 * (second - first)),)

    assert changed([case], name, "crossing, first cam angle", worse)[1] > LIMIT


def test_a_lever_by_the_ratio_of_its_lengths_is_seen() -> None:
    """Equation (2) of the exercise as printed, at theta = 1e-7.

    Its denominator of 1e-14 is a difference of terms of 1, known to 1e-16: a hundredth. Half an ulp
    of the lengths changes their difference, a share of 1e-9 of them, by 1e-7 of it.
    """
    name = "HC02 beta 1 + 1e-9"
    crank, distance = slotted_levers.LEVERS[name]
    beta = distance / crank

    def printed(theta: FloatArray) -> tuple[FloatArray]:
        cosine = np.cos(theta)
        return ((beta * cosine - 1.0) / (1.0 + beta**2 - 2.0 * beta * cosine),)

    case = next(c for c in CASES if c.name == name and "lever velocity" in c.quantities)
    near = replace(case, places=(1e-7,))
    good, poor = changed([near], name, "lever velocity", printed)
    assert good <= LIMIT
    assert poor > 10.0 * LIMIT


def test_the_stroke_of_a_long_coupler_as_a_difference_is_seen() -> None:
    """Of two places of the pin 1e6 mm away: 20 mm are known to 1e-10 mm."""
    name = "slider-driven-crank, long coupler"
    cam = next(each for each in loops.specs() if each.name == name)
    linkage = cam.linkage
    assert isinstance(linkage, SliderDrivenCrank)

    def difference(phi: FloatArray) -> tuple[FloatArray]:
        pins = [linkage.joints(each)[0].real for each in (cam.plan.jet(phi)[0], np.zeros(1))]
        return (pins[0] - pins[1],)

    good, poor = changed(CASES, f"{name}, rise", "lift s", difference)
    assert good <= LIMIT
    assert poor > 10.0 * LIMIT


def test_a_contact_seen_from_a_far_pivot_is_seen() -> None:
    """The place on the face and the way to the pivot, 1e6 mm each, leave 50 mm."""
    name = "far pivot"
    cam = next(each for each in faces.specs() if each.name == name)
    follower = cam.follower
    assert isinstance(follower, OscillatingFlat)

    def from_the_pivot(phi: FloatArray) -> tuple[ComplexArray]:
        jet = cam.plan.jet(phi)
        place = follower.touch(jet, cam.rotation).contact[0]
        side = follower.arm_side
        along = np.exp(1j * (phase(-follower.pivot) + side * follower.face_angle(jet[0])))
        contact = follower.pivot + (place + 1j * side * follower.face_offset) * along
        return (contact * np.exp(-1j * cam.rotation * phi),)

    good, poor = changed(CASES, f"{name}, rise", "pitch curve Z", from_the_pivot)
    assert good <= LIMIT
    assert poor > 10.0 * LIMIT


def test_the_curvature_under_a_face_that_nearly_stands_is_seen() -> None:
    """From Z' and Z'', which are all but parallel, as for a roller."""
    name = "face that nearly stands in the cam"
    cam = next(each for each in faces.specs() if each.name == name)

    def from_derivatives(phi: FloatArray) -> tuple[FloatArray]:
        relative = cam.curve.relative_jet(phi, order=2)
        return (bend_of_path(relative, cam.curve.speed(relative), cam.rotation),)

    good, poor = changed(CASES, f"{name}, rise", "curvature", from_derivatives)
    assert good <= LIMIT
    assert poor > 10.0 * LIMIT


def test_an_area_of_a_polygon_is_seen() -> None:
    """Of 100,000 corners: the share of 1e-9 off its sides is 1e6 ulp."""
    name = "HC21c swallow tail"

    def polygon(places: FloatArray) -> tuple[FloatArray]:
        spec, side = next(each for each in outlines.flanks() if each[0].name == name)
        flank = WorkingCurve(spec.curve, side * spec.follower.roller_radius)
        (stretch,) = real_outline(flank).path.stretches
        corners = flank.point(np.linspace(stretch.start, stretch.end, 100_001)[:-1] % TURN)
        across = np.conj(corners) * np.roll(corners, -1)
        return (np.full(len(places), abs(0.5 * float(np.sum(across.imag)))),)

    good, poor = changed(CASES, name, "area of the disc", polygon)
    assert good <= LIMIT
    assert poor > 1e3 * LIMIT


# What is run and reported -------------------------------------------------------------------------


def made_up(quantity: str, case: str, error: float, conditioning: float) -> Reading:
    return Reading(quantity, "cams", case, 1.0, 1.0, error, conditioning)


def test_the_table_has_the_largest_ratio_first() -> None:
    readings = [
        made_up("a", "x", 100.0, 200.0),
        made_up("a", "y", 3.0, 0.1),
        made_up("b", "x", math.inf, 1.0),
        made_up("c", "x", 0.0, 0.0),
    ]
    b, a, c = table(readings)
    assert (b.quantity, b.within_limit) == ("b", False)
    assert (a.largest_error.case, a.largest_ratio.case) == ("x", "y")
    assert (a.count, a.within_limit) == (2, True)
    assert c.largest_ratio.ratio == 0.0


def test_points_of_a_picture() -> None:
    readings = [
        made_up("a", "x", 2.0, 1.0),
        made_up("a", "x", 5.0, 1.0),
        made_up("a", "x", 7.0, 70.0),
        made_up("a", "y", 3.0, 1.0),
        made_up("a", "z", math.inf, 1.0),
    ]
    assert worst_of_cases(readings) == (readings[2], readings[1], readings[3])


def test_only_what_is_asked_for_is_run() -> None:
    stated: list[str] = []
    readings = run(CASES, ["place of a cusp"], quick=True, progress=stated.append)
    assert {each.quantity for each in readings} == {"place of a cusp"}
    assert stated == [f"extremes: {name}" for name in dict.fromkeys(each.case for each in readings)]
    whole = run(CASES, ["scca, b 0.3, d 0.2"], quick=True)
    assert {each.case for each in whole} == {"scca, b 0.3, d 0.2"}
    assert len(whole) == 2 * 5


def test_names_are_groups_quantities_and_cases() -> None:
    known = names(CASES)
    assert len(known) == len(set(known))
    assert set(GROUPS) <= set(known)
    assert {"curvature", "f'''", "HC11 tiny stroke, rise"} <= set(known)
