"""Replay: the roller on contours and outlines of cams whose motion is known independently."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.outline.replay import (
    AS_DEMANDED_ELEMENT,
    Replay,
    replay_contour,
    replay_outline,
)
from camgeo.geometry.outline.roller import ActualLift
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.cams import curves, dwell, flank, move, outline, polyline, translating
from tests.long_form import examples
from tests.measuring import Outline, polygon
from tests.reference import angles, hard_case, inner_of, number, pitch_curve_of
from tests.strategies import attack

TURN = 2.0 * math.pi

ROCKER = OscillatingRoller(complex(-90.0, -40.0), 80.0, 60.0, 8.0)


def resting(follower: TranslatingRoller | OscillatingRoller, sigma: int = 1) -> PitchCurve:
    """A cam of which nothing is demanded: all that is replayed comes from the contour."""
    curve = translating(dwell(360)).pitch
    return replace(curve, follower=follower, rotation=sigma)


def centres(replay: Replay, phi: FloatArray, lift: FloatArray) -> ComplexArray:
    """Roller centres in the cam, by the follower's own formulas."""
    assert isinstance(replay.lift, ActualLift)
    pitch = replay.lift.path
    jet = np.zeros((4, len(phi)))
    jet[0] = lift
    follower = pitch.follower  # type: ignore[attr-defined]  # each kind of path has one
    relative = follower.relative_jet(jet, pitch.rotation, 1)
    curve = PitchCurve(replay.lift.motion, follower, pitch.rotation)
    return curve.in_cam(relative, phi, relative.along[0], relative.across[0])


# Cams with a known motion ---------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [1, -1])
@pytest.mark.parametrize("follower", [TranslatingRoller(40.0, 8.0, offset=10.0), ROCKER])
def test_a_circle_about_the_axis_is_a_rest(
    follower: TranslatingRoller | OscillatingRoller, sigma: int
) -> None:
    disc = Contour.circle(follower.base_radius - follower.roller_radius)
    found = replay_contour(resting(follower, sigma), disc)
    # A radius of 60 mm is known to 1e-14 mm; the derivatives are sums of a few such lengths.
    assert np.max(np.abs(found.actual)) < 1e-12
    assert found.ripple is None
    assert found.largest_shock is None
    assert len(found.shocks) == len(found.drops) == 0


def eccentric_lift(phi: FloatArray, radius: float, e: complex, base: float) -> FloatArray:
    """Of a centric follower upwards on a circle of roller centres: h = y + sqrt(radius^2 - x^2)."""
    centre = e * np.exp(1j * phi)  # the disc turns, the guide stands
    return np.asarray(centre.imag + np.sqrt(radius**2 - centre.real**2) - base)


def test_an_eccentric_disc_gives_the_eccentric_motion() -> None:
    follower = TranslatingRoller(40.0, 8.0)
    found = replay_contour(resting(follower), Contour.circle(32.0, 6.0 + 2.0j))
    e = 6.0 + 2.0j
    phi = found.phi
    expected = eccentric_lift(phi, 40.0, e, 40.0)
    assert found.actual[0] == pytest.approx(expected, abs=1e-12)
    # By hand: with x + i y = e exp(i phi), x' = -y, y' = x.
    x, y = (e * np.exp(1j * phi)).real, (e * np.exp(1j * phi)).imag
    root = np.sqrt(1600.0 - x**2)
    assert found.actual[1] == pytest.approx(x + x * y / root, abs=1e-12)
    second = -y + (x**2 - y**2) / root - x**2 * y**2 / root**3
    assert found.actual[2] == pytest.approx(second, abs=1e-12)
    assert len(found.shocks) == 0


def test_a_ring_with_an_eccentric_hole() -> None:
    follower = TranslatingRoller(40.0, 8.0)
    found = replay_contour(resting(follower), Contour.circle(48.0, 5.0j), "outer")
    assert found.actual[0] == pytest.approx(eccentric_lift(found.phi, 40.0, 5.0j, 40.0), abs=1e-12)
    assert found.largest_loss.value == pytest.approx(5.0, abs=1e-12)  # the hole is 5 mm too large


def test_a_square_with_all_its_shocks() -> None:
    """Flat sides inward of nothing: the roller turns about the corners, without a shock."""
    square = polyline(np.array([30 + 30j, -30 + 30j, -30 - 30j, 30 - 30j]))
    found = replay_contour(resting(TranslatingRoller(38.0, 8.0)), square)
    assert len(found.shocks) == len(found.drops) == 0
    top = found.lift.jet(np.array([0.0, math.pi / 4.0]))
    assert top[0] == pytest.approx([0.0, math.sqrt(1800.0) + 8.0 - 38.0], abs=1e-12)
    # On a side the centre runs on a line 38 mm from the axis: h = 38/cos(phi), h'' = 38 at 0.
    assert top[1, 0] == pytest.approx(0.0, abs=1e-12)
    assert top[2, 0] == pytest.approx(38.0, abs=1e-12)


def test_a_notch_is_a_shock() -> None:
    """The roller drops into a notch until it touches both edges: there its velocity jumps."""
    half = 4.0
    corners = [complex(half, 30.0), complex(half, 15.0), complex(-half, 15.0), complex(-half, 30.0)]
    notched = [*corners[::1], -30 + 30j, -30 - 30j, 30 - 30j, 30 + 30j]
    found = replay_contour(resting(TranslatingRoller(38.0, 8.0)), polyline(np.array(notched)))
    assert len(found.shocks) == 1
    assert found.shocks.phi[0] == pytest.approx(0.0, abs=1e-14)
    # Deepest at the middle: both edges 8 mm from the centre.
    depth = 30.0 + math.sqrt(64.0 - half**2)
    assert found.lift.jet(np.zeros(1))[0, 0] == pytest.approx(depth - 38.0, abs=1e-12)
    # Along the circle about (4, 30): F = |Z - P|^2 by hand, Z' = -i Z + i h'.
    slope = depth * half / (depth - 30.0) - 0.0
    before, after = found.shocks.before[0], found.shocks.after[0]
    assert after == pytest.approx(-before, abs=1e-11)
    assert abs(after) == pytest.approx(slope, abs=1e-11)
    assert after > 0.0
    assert found.largest_loss.value == pytest.approx(38.0 - depth, abs=1e-12)


def test_an_overhang_drops_the_roller() -> None:
    """A hook: past its tip the roller falls, and its velocity has no bound there."""
    hook = np.array(
        [20 - 20j, 40 + 20j, 40 + 55j, 10 + 55j, 10 + 50j, 30 + 20j, -20 + 20j, -20 - 20j]
    )
    found = replay_contour(resting(TranslatingRoller(28.0, 3.0)), polyline(hook))
    assert len(found.drops) == 1
    fall = float((found.drops.after - found.drops.before)[0])
    assert abs(fall) > 10.0
    assert np.all(np.isfinite(found.actual))


# The contact condition, solved without any of it ------------------------------------------------


def star(rng: np.random.Generator) -> Outline:
    """With deep slots and sharp tips."""
    return Outline.around(rng, radii=(9.0, 36.0), sweeps=(-2.4, 2.4), straight=0.5)


@settings(attack, max_examples=examples(8, long=40))
@given(st.integers(0, 10**9), st.booleans(), st.sampled_from([1, -1]))
def test_lift_by_the_smallest_distance(seed: int, rocker: bool, sigma: int) -> None:
    """From outside the roller is let in until its centre is a roller radius from the contour."""
    rng = np.random.default_rng(seed)
    shape = star(rng)
    assume(polygon(shape.dense(5000)).is_valid)
    contour = Contour(shape.starts, shape.sweeps, shape.centres)
    follower = ROCKER if rocker else TranslatingRoller(60.0, 8.0, offset=5.0)
    try:
        found = replay_contour(resting(follower, sigma), contour)
    except GeometryError:  # deeper at some angle than the follower reaches
        reject()
    path = path_of(follower, sigma)
    top = math.radians(140.0) - path.start if rocker else 30.0
    arm = ROCKER.arm if rocker else 1.0
    borders = rng.choice(found.lift.borders, 6)
    for phi in np.concatenate((rng.uniform(0.0, TURN, 5), borders + 0.01, borders - 0.01)):
        at = np.array([phi])

        def gap(value: float, at: FloatArray = at) -> float:
            centre = centres(found, at, np.array([value]))
            return float(shape.distances(centre)[0]) - follower.roller_radius

        # Steps of half the gap cannot pass the first contact.
        high = top
        while (free := gap(high)) > 1e-6:
            high -= 0.5 * free / arm
        low = high - 4e-6 / arm
        if gap(low) >= 0.0:
            continue  # the path grazes the contour, or nearly: the place is not known so well
        contact = brentq(gap, low, top, xtol=1e-14)
        # 4e-6 mm that lead through the contour at 1/4 mm a mm or steeper: 1e-14 mm are known.
        assert float(found.lift.at(at)[0]) == pytest.approx(contact, abs=1e-8 / arm)


# Fits of cams ---------------------------------------------------------------------------------


FLANKS = [("plate_translating", -1), ("setzhub", -1), ("ring", 1), ("groove", 1)]


@pytest.mark.parametrize(("scene", "side"), FLANKS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_fit_gives_the_motion_back(scene: str, side: int, tolerance: float) -> None:
    curve = flank(scene, side)
    found = replay_contour(
        curve.pitch, fit_arcs(whole(curve), tolerance).contour, "inner" if side < 0 else "outer"
    )
    # An error across the flank is 1/sin(mu) of it along the path; mu is 41 degrees at least. One
    # along the flank moves it by no more.
    phi = np.linspace(0.0, TURN, 721)
    steepest = 1.0 / math.sin(float(np.min(curve.pitch.transmission_angle(phi))))
    arm = 1.0 if found.lift.path.reach[1] == math.inf else curve.pitch.follower.arm  # type: ignore[attr-defined]  # only rockers have an arm
    assert (
        0.1 * tolerance / arm < abs(found.largest_error.value) < steepest * tolerance / arm * 1.001
    )
    assert len(found.shocks) == len(found.drops) == 0


def test_ripple_of_arcs_falls_with_the_cube_root_of_the_tolerance() -> None:
    """Deviation of an arc of length l is ~ kappa' l^3, its error of curvature ~ kappa' l."""
    curve = flank("plate_translating", -1)
    ripples = [
        replay_contour(curve.pitch, fit_arcs(whole(curve), 10.0**-k).contour).ripple
        for k in (2, 5, 8)
    ]
    assert all(ripple is not None for ripple in ripples)
    first, second, third = (float(ripple or 0.0) for ripple in ripples)
    assert 0.2 < first < 1.0
    # A thousandth of the tolerance, a tenth of the ripple, within a factor of 2: pieces are whole.
    assert 5.0 < first / second < 20.0
    assert 5.0 < second / third < 20.0


def test_ripple_of_a_polyline_does_not_fall() -> None:
    """Between flat and corner the acceleration jumps, however near both lie to the curve."""
    curve = flank("plate_translating", -1)
    errors, ripples = [], []
    for count in (360, 3600):
        points = curve.point(np.linspace(0.0, TURN, count, endpoint=False))
        found = replay_contour(curve.pitch, polyline(points).counter_clockwise())
        errors.append(abs(found.largest_error.value))
        ripples.append(found.ripple)
    assert errors[1] < 0.02 * errors[0]  # like the square of the spacing
    assert ripples[0] is not None
    assert ripples[1] is not None
    assert ripples[0] > 5.0
    assert ripples[1] == pytest.approx(ripples[0], rel=0.1)


def test_corners_below_the_limit_do_not_count() -> None:
    curve = flank("setzhub", -1)
    fit = fit_arcs(whole(curve), 1e-3).contour
    rounded = Contour(np.round(fit.vertices, 8), fit.sweeps, fit.centres)
    exact = replay_contour(curve.pitch, fit).ripple
    assert exact is not None
    strict = replay_contour(curve.pitch, rounded, corner=0.0).ripple
    lenient = replay_contour(curve.pitch, rounded, corner=1e-5).ripple
    assert strict is not None
    assert strict > 1.0 > 2.0 * exact
    assert lenient == pytest.approx(exact, rel=0.05)


@settings(attack, max_examples=examples(6, long=12))  # each takes two fits
@given(curves(), st.floats(-3.0, 3.0))
def test_a_turned_contour_shifts_the_motion(curve: WorkingCurve, angle: float) -> None:
    contact = "inner" if curve.distance < 0.0 else "outer"
    if curve.distance == 0.0:
        return
    fit = fit_arcs(whole(curve), 1e-2).contour
    turn = cmath.exp(-1j * curve.pitch.rotation * angle)
    turned = Contour(fit.vertices * turn, fit.sweeps, fit.centres * turn)
    here = replay_contour(curve.pitch, fit, contact)
    there = replay_contour(curve.pitch, turned, contact)
    phi = np.linspace(0.1, 6.1, 101)
    # Turning costs 1e-16 of the coordinates, 100 mm; the slopes are below 100 mm/rad.
    assert there.lift.at(phi + angle) == pytest.approx(here.lift.at(phi), abs=1e-10)


@pytest.mark.parametrize(("scene", "side"), [each for each in FLANKS if each[0] != "setzhub"])
def test_a_mirrored_cam_makes_the_same_motion(scene: str, side: int) -> None:
    curve = flank(scene, side)
    fit = fit_arcs(whole(curve), 1e-3).contour
    mirrored = Contour(fit.vertices.conj(), -fit.sweeps, fit.centres.conj()).reversed()
    follower = curve.pitch.follower
    if isinstance(follower, TranslatingRoller):
        follower = replace(follower, guide_angle=-follower.guide_angle, offset=-follower.offset)
        motion = curve.pitch.motion
    else:
        assert isinstance(follower, OscillatingRoller)
        follower = replace(follower, pivot=follower.pivot.conjugate(), arm_side=-follower.arm_side)
        motion = curve.pitch.motion
    contact = "inner" if side < 0 else "outer"
    here = replay_contour(curve.pitch, fit, contact)
    pitch = PitchCurve(motion, follower, -curve.pitch.rotation)
    there = replay_contour(pitch, mirrored, contact)
    phi = np.linspace(0.1, 6.1, 101)
    assert there.lift.jet(phi)[0] == pytest.approx(here.lift.jet(phi)[0], abs=1e-11)
    assert there.ripple == pytest.approx(here.ripple, rel=1e-6)


# Real outlines --------------------------------------------------------------------------------


@attack
@given(curves())
def test_a_whole_outline_gives_the_motion_back(curve: WorkingCurve) -> None:
    if curve.distance == 0.0:
        return
    found = replay_outline(curve.pitch, whole(curve))
    assert np.array_equal(found.actual, found.demanded)
    assert found.largest_loss.value == 0.0
    assert len(found.shocks) == len(found.drops) == 0
    assert np.all(found.element == AS_DEMANDED_ELEMENT)


def hc21c() -> tuple[WorkingCurve, Path, float, float, complex]:
    params, expected = hard_case("HC21c")
    inner = inner_of(pitch_curve_of(params))
    first, second = angles(expected["crossing_phi1_deg"], expected["crossing_phi2_deg"])
    point = number(expected["crossing_point"])
    pivot = Pivot(point, 0.0, 1.0 + 0j, 0.0, float(first), float(second))
    return inner, Path((Stretch(inner, second, first + TURN), pivot)), first, second, point


def test_hc21c_rolls_over_the_corner() -> None:
    inner, path, first, second, point = hc21c()
    found = replay_outline(inner.pitch, path)
    lost = found.element != AS_DEMANDED_ELEMENT
    assert np.min(found.phi[lost]) == pytest.approx(first, abs=1e-14)
    assert np.max(found.phi[lost]) == pytest.approx(second, abs=1e-14)
    assert np.all(found.lost[~lost] == 0.0)
    # At its ends the loss begins like the third power of the angle: below rounding at first.
    assert np.all(found.lost[lost] > -1e-13)
    assert np.all(found.lost[(found.phi > first + 1e-3) & (found.phi < second - 1e-3)] > 0.0)
    # While it is lost the corner is a roller radius from the centre.
    phi = found.phi[lost]
    away = np.abs(centres(found, phi, found.actual[0, lost]) - point)
    assert away == pytest.approx(np.full(len(phi), -inner.distance), abs=1e-12)
    # By hand for a guide through the axis: h = y + sqrt(r^2 - x^2), x + i y the corner in its axes.
    turned = point * np.exp(1j * phi)
    height = turned.imag + np.sqrt(inner.distance**2 - turned.real**2)
    assert found.actual[0, lost] == pytest.approx(height - 25.0, abs=1e-12)
    # The working curve touches the corner tangentially to the roller on both sides: no shock.
    assert len(found.shocks) == 0
    assert found.largest_loss.value == pytest.approx(0.017970, abs=1e-6)
    assert found.ripple is not None
    assert found.ripple > 0.1


def test_a_corner_in_a_wrong_place_is_seen() -> None:
    """The test above breaks if the corner does: 1 um off, it is no longer reached smoothly."""
    inner, path, *_ = hc21c()
    corner = replace(path.pivots[0], centre=path.pivots[0].centre * (1.0 + 1e-3 / 30.0))
    found = replay_outline(inner.pitch, Path((path.stretches[0], corner)))
    assert len(found.drops) == 2


def test_an_outline_without_stretches_is_refused() -> None:
    inner, path, *_ = hc21c()
    with pytest.raises(GeometryError, match="without any stretch"):
        replay_outline(inner.pitch, Path(path.pivots))
    with pytest.raises(GeometryError, match="does not meet the contour"):
        replay_outline(inner.pitch, Path(path.stretches))


# What cannot be replayed ------------------------------------------------------------------------


def test_wrong_contours_are_refused() -> None:
    pitch = resting(TranslatingRoller(40.0, 8.0))
    with pytest.raises(GeometryError, match="counter-clockwise"):
        replay_contour(pitch, Contour.circle(30.0).reversed())
    with pytest.raises(GeometryError, match="must run once round the cam axis"):
        replay_contour(pitch, Contour.circle(10.0, 50.0 + 0j))
    with pytest.raises(GeometryError, match="within the follower's reach"):
        replay_contour(resting(ROCKER), Contour.circle(500.0))
    rng = np.random.default_rng(1)
    wild = 30.0 * np.exp(1j * TURN * np.arange(20_000) / 20_000) + rng.normal(size=20_000)
    with pytest.raises(GeometryError, match="too rough"):
        replay_contour(pitch, polyline(wild))


def test_pieces_of_no_length_and_spikes_do_no_harm() -> None:
    circle = 32.0 * np.exp(1j * TURN * np.arange(90) / 90)
    doubled = np.insert(circle, 7, circle[7])
    pitch = resting(TranslatingRoller(40.0, 8.0))
    plain = replay_contour(pitch, polyline(circle))
    assert replay_contour(pitch, polyline(doubled)).ripple == plain.ripple
    spiked = np.insert(circle, 8, [circle[7] * 1.1, circle[7]])
    found = replay_contour(pitch, polyline(spiked))
    assert found.largest_error.value == pytest.approx(3.2, abs=1e-3)


def test_the_roller_in_a_fillet_of_its_own_radius() -> None:
    """An arc of just the roller radius is one place for its centre: the velocity jumps there."""
    corner = 20.0 + 30.0j
    points = np.array([28 + 30j, 20 + 22j, -30 + 22j, -30 - 30j, 28 - 30j])
    shape = Contour(points, np.array([-0.5 * math.pi, 0, 0, 0, 0]), np.array([corner, 0, 0, 0, 0]))
    # The fillet runs from the wall x = 28 to the floor y = 22; beyond the wall is material.
    found = replay_contour(resting(TranslatingRoller(38.0, 8.0)), shape)
    assert np.all(np.isfinite(found.actual))


@pytest.mark.parametrize("count", [20_000])
def test_many_pieces(count: int) -> None:
    curve = translating(dwell(60), move(100, 15.0), dwell(40), move(100, 0.0), dwell(60))
    points = curve.point(np.linspace(0.0, TURN, count, endpoint=False))
    found = replay_contour(curve.pitch, polyline(points).counter_clockwise())
    assert len(found.phi) > 3600 + count
    assert np.all(np.isfinite(found.actual))
    assert outline(polyline(points)).distances(
        centres(found, found.phi[::5000], found.actual[0, ::5000])
    ) == pytest.approx(8.0, abs=1e-11)


@pytest.mark.parametrize(("share", "loss"), [(1e-4, 7.28e-8), (1e-5, 7.304e-10), (1e-6, 7.308e-12)])
def test_what_a_narrow_tail_loses_is_found_between_the_samples(share: float, loss: float) -> None:
    """HC21 with the roller by a share above the limit: a range of 0.05 degrees for 1e-6.

    The loss falls with the square of the share; that for 1e-6 was found with 60 digits.
    """
    params, _ = hard_case("HC21a")
    roller = float(params["r_R"]) * (1.0 + share)
    flank = inner_of(pitch_curve_of(params | {"kappa": 1, "r_R": roller}))
    found = replay_outline(flank.pitch, real_outline(flank).path).largest_loss
    assert found.value == pytest.approx(loss, rel=2e-2)
