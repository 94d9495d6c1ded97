"""Replay: the roller, or the flat face, on contours and outlines of cams whose motion is known
independently, and against brute force."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.face import FaceLift, face_path_of
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.outline.replay import (
    AS_DEMANDED_ELEMENT,
    Replay,
    replay_contour,
    replay_outline,
)
from camgeo.geometry.outline.roller import ActualLift
from camgeo.geometry.pieces import contact_extremes, touch
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import FlatFollower, OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.cams import SCENES, curves, dwell, flank, move, outline, polyline, translating
from tests.findings import known
from tests.long_form import examples
from tests.measuring import Outline, polygon
from tests.mechanism.flat_faces import convex_curves
from tests.reference import angles, hard_case, inner_of, number, pitch_curve_of
from tests.strategies import attack

TURN = 2.0 * math.pi


ROCKER = OscillatingRoller(complex(-90.0, -40.0), 80.0, 60.0, 8.0)


GUIDED = TranslatingFlat(40.0)


FLAT_ROCKER = OscillatingFlat(complex(-90.0, -40.0), 45.0, 8.0)


MIRRORED = replace(FLAT_ROCKER, arm_side=-1, direction=-1, face_offset=-6.0, base_radius=30.0)


FACES = (GUIDED, replace(GUIDED, direction=-1, guide_angle=0.3), FLAT_ROCKER, MIRRORED)


def resting(follower: Any, sigma: int = 1) -> PitchCurve:
    """A cam of which nothing is demanded: all that is replayed comes from the contour."""
    curve = translating(dwell(360)).pitch
    return replace(curve, follower=follower, rotation=sigma)


def centres(replay: Replay, phi: FloatArray, lift: FloatArray) -> ComplexArray:
    """Roller centres in the cam."""
    assert isinstance(replay.lift, ActualLift)
    path = replay.lift.path
    return centres_in(PitchCurve(replay.lift.motion, path.follower, path.rotation), phi, lift)


def centres_in(curve: PitchCurve, phi: FloatArray, lift: FloatArray) -> ComplexArray:
    """Roller centres in the cam, by the follower's own formulas."""
    jet = np.zeros((4, len(phi)))
    jet[0] = lift
    relative = curve.follower.relative_jet(jet, curve.rotation, 1)
    return curve.in_cam(relative, phi, relative.along[0], relative.across[0])


@pytest.mark.parametrize("sigma", [1, -1])
@pytest.mark.parametrize("follower", [TranslatingRoller(40.0, 8.0, offset=10.0), ROCKER, *FACES])
def test_a_circle_about_the_axis_is_a_rest(follower: Any, sigma: int) -> None:
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


@pytest.mark.parametrize(
    ("radius", "e", "side", "loss"),
    [
        (32.0, 6.0 + 2.0j, "inner", abs(6.0 + 2.0j)),
        (48.0, 5.0j, "outer", 5.0),  # a hole, 5 mm too large
    ],
)
def test_an_eccentric_disc_or_hole_gives_the_eccentric_motion(
    radius: float, e: complex, side: str, loss: float
) -> None:
    found = replay_contour(resting(GUIDE), Contour.circle(radius, e), side)
    assert found.actual[0] == pytest.approx(eccentric_lift(found.phi, 40.0, e, 40.0), abs=1e-12)
    assert found.largest_loss.value == pytest.approx(loss, abs=1e-12)
    assert len(found.shocks) == 0


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
    before, after = found.shocks.left[0], found.shocks.right[0]
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
    fall = float((found.drops.right - found.drops.left)[0])
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
        assert float(found.lift.displacement(at)[0]) == pytest.approx(contact, abs=1e-8 / arm)


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
    assert isinstance(found.lift, ActualLift)
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
    exact = known(replay_contour(curve.pitch, fit).ripple)
    strict = replay_contour(curve.pitch, rounded, corner=0.0).ripple
    lenient = replay_contour(curve.pitch, rounded, corner=1e-5).ripple
    assert strict is not None
    assert strict > 1.0 > 2.0 * exact
    assert lenient == pytest.approx(exact, rel=0.05)


@attack
@given(curves() | convex_curves().map(lambda pitch: WorkingCurve(pitch, -0.0)))
def test_a_whole_outline_gives_the_motion_back(curve: WorkingCurve) -> None:
    assume(curve.distance or curve.pitch.follower.roller_radius == 0.0)
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
    assert known(found.ripple) > 0.1


def test_a_corner_in_a_wrong_place_is_seen() -> None:
    """The test above breaks if the corner does: 1 um off, it is no longer reached smoothly."""
    inner, path, *_ = hc21c()
    corner = replace(path.pivots[0], centre=path.pivots[0].centre * (1.0 + 1e-3 / 30.0))
    assert len(replay_outline(inner.pitch, Path((path.stretches[0], corner))).drops) == 2


def test_an_outline_without_stretches_is_refused() -> None:
    inner, path, *_ = hc21c()
    with pytest.raises(GeometryError, match="without any stretch"):
        replay_outline(inner.pitch, Path(path.pivots))
    with pytest.raises(GeometryError, match="does not meet the contour"):
        replay_outline(inner.pitch, Path(path.stretches))


GUIDE = TranslatingRoller(40.0, 8.0)

BACK = polyline(np.array([30 + 30j, 30 - 30j, -30 - 30j, -30 + 30j]))

BEYOND = polyline(np.array([100, -30 + 30j, -30 - 30j]))


@pytest.mark.parametrize(
    ("follower", "contour", "side", "words"),
    [
        (GUIDE, Contour.circle(30.0).reversed(), "inner", "counter-clockwise"),
        (GUIDE, Contour.circle(10.0, 50.0 + 0j), "inner", "must run once round the cam axis"),
        (ROCKER, Contour.circle(500.0), "inner", "within the follower's reach"),
        (GUIDED, Contour.circle(10.0, 12.0), "inner", "once round the cam axis"),
        (GUIDED, BACK, "inner", "counter-clockwise"),
        (GUIDED, Contour.circle(40.0), "outer", "inner flank"),
        (FLAT_ROCKER, Contour.circle(120.0), "inner", "cannot lie on the contour"),
        (FLAT_ROCKER, BEYOND, "inner", "pivot's foot"),
    ],
)
def test_wrong_contours_are_refused(follower: Any, contour: Contour, side: str, words: str) -> None:
    with pytest.raises(GeometryError, match=words):
        replay_contour(resting(follower), contour, side)


def test_a_contour_too_rough_and_a_roller_for_a_face_are_refused() -> None:
    rng = np.random.default_rng(1)
    wild = 30.0 * np.exp(1j * TURN * np.arange(20_000) / 20_000) + rng.normal(size=20_000)
    with pytest.raises(GeometryError, match="too rough"):
        replay_contour(resting(GUIDE), polyline(wild))
    with pytest.raises(GeometryError, match="flat-faced follower"):
        face_path_of(GUIDE, 1)


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
    assert np.all(np.isfinite(replay_contour(resting(TranslatingRoller(38.0, 8.0)), shape).actual))


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


each_face = pytest.mark.parametrize("face", FACES)


each_sense = pytest.mark.parametrize("sigma", [1, -1])


def lines(face: Any, phi: FloatArray, lift: FloatArray, sigma: int) -> ComplexArray:
    """(2, n) normals of the face and its points nearest to the pivot or the axis, in the cam.

    By the geometry of the mechanism in the frame, turned against the cam.
    """
    if face.pivot is None:
        normal = np.full(len(phi), cmath.rect(1.0, face.guide_angle))
        foot = normal * (face.base_radius + face.direction * lift)
    else:
        towards = -face.pivot / abs(face.pivot)
        along = towards * np.exp(1j * face.arm_side * face.face_angle(lift))
        normal = 1j * face.arm_side * along
        foot = face.pivot + face.face_offset * normal
    found: ComplexArray = np.stack((normal, foot)) * np.exp(-1j * sigma * phi)
    return found


def apart(found: Replay, points: ComplexArray, phi: FloatArray) -> FloatArray:
    """(n,) how far the farthest of the `points` lies beyond the face at `phi` (n,) [mm]."""
    lift = found.lift
    assert isinstance(lift, FaceLift)
    normal, foot = lines(lift.pitch.follower, phi, lift.displacement(phi), lift.pitch.rotation)
    beyond = [np.max((np.conj(n) * (points - f)).real) for n, f in zip(normal, foot, strict=True)]
    return np.array(beyond)


@each_sense
@each_face
def test_an_eccentric_disc_touches_its_face(face: Any, sigma: int) -> None:
    """The centre of the circle stays its radius from the face, and the lift is that of a sine."""
    centre, radius = 3.0 - 2.0j, face.base_radius + 1.0
    found = replay_contour(resting(face, sigma), Contour.circle(radius, centre))
    normal, foot = lines(face, found.phi, found.actual[0], sigma)
    away = (np.conj(normal) * (foot - centre)).real
    assert np.max(np.abs(away - radius)) < 1e-13 * 40.0
    if face.pivot is None:
        turned = centre * np.exp(1j * (sigma * found.phi - face.guide_angle))
        sense = face.direction
        assert found.actual[0] == pytest.approx(sense * (turned.real + 1.0), abs=1e-13)
        assert found.actual[1] == pytest.approx(-sense * sigma * turned.imag, abs=1e-13)
        assert found.actual[2] == pytest.approx(-sense * turned.real, abs=1e-13)
    assert len(found.shocks) == len(found.drops) == 0


def test_a_square_is_all_shocks() -> None:
    """Flush with a side the contact jumps from corner to corner, the velocity by its length."""
    square = polyline(np.array([30 + 30j, -30 + 30j, -30 - 30j, 30 - 30j]))
    found = replay_contour(resting(replace(GUIDED, base_radius=30.0)), square)
    assert len(found.shocks) == 4
    assert found.shocks.right - found.shocks.left == pytest.approx([60.0] * 4, abs=1e-12)
    top = found.lift.jet(np.array([math.pi / 4.0]))
    assert top[:, 0] == pytest.approx([30.0 * math.sqrt(2.0) - 30.0, 0.0, -30.0 * math.sqrt(2.0)])


def test_a_notch_is_not_felt() -> None:
    corners = [complex(4.0, 30.0), complex(4.0, 15.0), complex(-4.0, 15.0), complex(-4.0, 30.0)]
    notched = [*corners, -30 + 30j, -30 - 30j, 30 - 30j, 30 + 30j]
    square = polyline(np.array([30 + 30j, -30 + 30j, -30 - 30j, 30 - 30j]))
    pitch = resting(GUIDED)
    one, other = (replay_contour(pitch, each) for each in (polyline(np.array(notched)), square))
    phi = np.linspace(0.01, TURN, 500)
    assert one.lift.jet(phi) == pytest.approx(other.lift.jet(phi), abs=1e-12)


# Against brute force ----------------------------------------------------------------------------


def rounded(rng: np.random.Generator) -> Outline:
    """Nearly round, with some arcs that turn inwards."""
    return Outline.around(rng, radii=(22.0, 30.0), sweeps=(-1.0, 1.8), straight=0.4)


@settings(attack, max_examples=examples(16, long=60))
@given(st.integers(0, 10**9), st.sampled_from(FACES), st.sampled_from([1, -1]))
def test_the_face_touches_and_cuts_nothing(seed: int, face: FlatFollower, sigma: int) -> None:
    rng = np.random.default_rng(seed)
    shape = rounded(rng)
    dense = shape.dense(5000)
    assume(polygon(dense).is_valid)
    contour = Contour(shape.starts, shape.sweeps, shape.centres)
    try:
        found = replay_contour(resting(face, sigma), contour)
    except GeometryError:  # contact beyond the pivot's foot
        reject()
    phi = np.concatenate((rng.uniform(0.0, TURN, 20), found.lift.borders))
    beyond = apart(found, dense, phi)
    # Some points in 5000 mm of outline are 0.1 mm apart: of a radius of 10 mm they leave out
    # (0.1 mm)^2 / (8 * 10 mm).
    assert np.max(beyond) <= 1e-12
    assert np.min(beyond) >= -2e-4


# Real cams --------------------------------------------------------------------------------------


FLAT_SCENES = [
    path
    for folder in ("scenes", "effects")
    for path in sorted((SCENES.parent / folder).glob("*.toml"))
    if '-flat"' in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("scene", FLAT_SCENES, ids=lambda path: path.stem)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_fit_gives_the_motion_of_a_face_back(scene: Any, tolerance: float) -> None:
    """The support function of a fit is within its deviation of that of the cam."""
    disc = camgeo.load(scene).cam.disc
    fit = fit_arcs(disc.outline("inner").path, tolerance)
    found = replay_contour(disc.pitch_curve, fit.contour)
    face = disc.follower
    lever = 1.0
    if face.pivot is not None:
        lever = contact_extremes(disc.pitch_curve).smallest()[0]
    assert abs(found.largest_error.value) <= 1.001 * fit.deviation / lever
    assert abs(found.largest_error.value) > 0.01 * tolerance / abs(face.pivot or 1.0)
    assert len(found.shocks) == len(found.drops) == 0
    assert isinstance(found.lift, FaceLift)
    places, angles = found.lift.contacts()
    sampled = touch(disc.pitch_curve, found.phi).contact[0]
    # On an arc of a different radius, off by the slope of the deviation: sqrt(8 rho deviation).
    off = 3.0 * math.sqrt(8.0 * 100.0 * fit.deviation)
    assert np.min(places) == pytest.approx(np.min(sampled), abs=off)
    assert np.max(places) == pytest.approx(np.max(sampled), abs=off)
    dense = np.linspace(0.0, TURN, 2000)
    numbers = found.lift.number(dense)
    circles = found.lift.circles
    there = found.lift.path.contact(dense, circles.centres[numbers], circles.radii[numbers])
    assert np.min(places) <= np.min(there)
    assert np.max(there) <= np.max(places)
    assert np.all((angles >= 0.0) & (angles < TURN))


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("face", [GUIDED, FLAT_ROCKER])
def test_sizes_tiny_and_huge(face: Any, scale: float) -> None:
    shape = rounded(np.random.default_rng(3))
    contour = Contour(shape.starts, shape.sweeps, shape.centres)
    small = {"base_radius": scale * face.base_radius}
    if face.pivot is not None:
        small |= {"pivot": scale * face.pivot, "face_offset": scale * face.face_offset}
    other = Contour(scale * shape.starts, shape.sweeps, scale * shape.centres)
    one = replay_contour(resting(face), contour)
    scaled = replay_contour(resting(replace(face, **small)), other)
    unit = 1.0 if face.pivot is not None else scale
    phi = np.linspace(0.005, TURN, 400)
    assert scaled.lift.jet(phi) / unit == pytest.approx(one.lift.jet(phi), rel=1e-9, abs=1e-9)


def test_corners_below_the_limit_do_not_count_under_a_face() -> None:
    """A polygon of many sides: shocks everywhere, unless small corners are to be ignored."""
    ring = polyline(40.0 * np.exp(1j * TURN * np.arange(400) / 400))
    found = replay_contour(resting(GUIDED), ring)
    assert len(found.shocks) == 400
    assert abs(known(found.shocks.largest).value) == pytest.approx(80.0 * math.sin(math.pi / 400.0))
    ignored = replay_contour(resting(GUIDED), ring, corner=0.02)
    assert len(ignored.shocks) == 0
    # The corner before those left out goes on, by at most twice the limit across cam angle 0.
    dense = np.linspace(0.0, TURN, 2000)
    assert (
        np.max(np.abs(ignored.lift.displacement(dense) - found.lift.displacement(dense)))
        <= 0.5 * 40.0 * 0.04**2
    )


def test_many_pieces_take_no_time() -> None:
    count = 20_000
    angles = TURN * np.arange(count) / count
    noise = np.random.default_rng(1).uniform(-1e-4, 1e-4, count)
    found = replay_contour(resting(GUIDED), polyline((40.0 + noise) * np.exp(1j * angles)))
    assert abs(found.largest_error.value) <= 1e-4
