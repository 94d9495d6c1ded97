"""Replay of flat faces: on contours, against brute force and cams whose motion is known."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.convex import contact_extremes, touch
from camgeo.geometry.outline.face import FaceLift, face_path_of
from camgeo.geometry.outline.path import whole
from camgeo.geometry.outline.replay import Replay, replay_contour, replay_outline
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.face import FlatFollower
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.cams import dwell, polyline, translating
from tests.long_form import examples
from tests.measuring import Outline, polygon
from tests.mechanism.flat_faces import convex_curves
from tests.strategies import attack

FIXTURES = Path(__file__).parents[2] / "fixtures"

TURN = 2.0 * math.pi

GUIDED = TranslatingFlat(40.0)

ROCKER = OscillatingFlat(complex(-90.0, -40.0), 45.0, 8.0)

MIRRORED = replace(ROCKER, arm_side=-1, direction=-1, face_offset=-6.0, base_radius=30.0)

FACES = (GUIDED, replace(GUIDED, direction=-1, guide_angle=0.3), ROCKER, MIRRORED)

each_face = pytest.mark.parametrize("face", FACES)

each_sense = pytest.mark.parametrize("sigma", [1, -1])


def resting(face: FlatFollower, sigma: int = 1) -> PitchCurve:
    """A cam without a demanded motion: all that is replayed comes from the contour."""
    curve = translating(dwell(360)).pitch
    return replace(curve, follower=face, rotation=sigma)


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
    normal, foot = lines(lift.pitch.follower, phi, lift.at(phi), lift.pitch.rotation)
    beyond = [np.max((np.conj(n) * (points - f)).real) for n, f in zip(normal, foot, strict=True)]
    return np.array(beyond)


# Known motions --------------------------------------------------------------------------------


@each_sense
@each_face
def test_a_circle_about_the_axis_is_a_rest(face: FlatFollower, sigma: int) -> None:
    found = replay_contour(resting(face, sigma), Contour.circle(face.base_radius))
    assert np.max(np.abs(found.actual)) < 1e-13 * face.base_radius
    assert found.ripple is None
    assert len(found.shocks) == len(found.drops) == 0


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
    assert found.shocks.after - found.shocks.before == pytest.approx([60.0] * 4, abs=1e-12)
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


@settings(attack, max_examples=examples(10, long=40))
@given(st.integers(0, 10**9), st.sampled_from(FACES), st.sampled_from([1, -1]))
def test_each_derivative_is_that_of_the_one_before(
    seed: int, face: FlatFollower, sigma: int
) -> None:
    shape = rounded(np.random.default_rng(seed))
    assume(polygon(shape.dense(500)).is_valid)
    try:
        found = replay_contour(
            resting(face, sigma), Contour(shape.starts, shape.sweeps, shape.centres)
        )
    except GeometryError:
        reject()
    ends = np.append(found.lift.borders, found.lift.borders[0] + TURN)
    wide = np.diff(ends) > 1e-2
    middle, step = (0.5 * (ends[:-1] + ends[1:]))[wide], 1e-4
    before, here, after = (found.lift.jet(middle + k * step, order=3) for k in (-1, 0, 1))
    size = 1.0 if face.pivot is not None else 40.0
    for order in (0, 1, 2):
        slope = (after[order] - before[order]) / (2.0 * step)
        # The third derivative of the next, tens of its size, times step^2 / 6.
        assert slope == pytest.approx(here[order + 1], abs=1e-6 * size)


# Real cams --------------------------------------------------------------------------------------


def flat_scenes() -> list[Path]:
    found = []
    for folder in ("scenes", "effects"):
        for path in sorted((FIXTURES / folder).glob("*.toml")):
            if '-flat"' in path.read_text(encoding="utf-8"):
                found.append(path)
    return found


@pytest.mark.parametrize("scene", flat_scenes(), ids=lambda path: path.stem)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_fit_gives_the_motion_back(scene: Path, tolerance: float) -> None:
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


@attack
@given(curve=convex_curves())
def test_a_whole_outline_gives_the_motion_back(curve: PitchCurve) -> None:
    found = replay_outline(curve, whole(WorkingCurve(curve, -0.0)))
    assert np.all(found.actual == found.demanded)
    assert found.largest_loss.value == 0.0


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("face", [GUIDED, ROCKER])
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


def test_corners_below_the_limit_do_not_count() -> None:
    """A polygon of many sides: shocks everywhere, unless small corners are to be ignored."""
    ring = polyline(40.0 * np.exp(1j * TURN * np.arange(400) / 400))
    found = replay_contour(resting(GUIDED), ring)
    assert len(found.shocks) == 400
    assert found.shocks.largest is not None
    assert abs(found.shocks.largest.value) == pytest.approx(80.0 * math.sin(math.pi / 400.0))
    ignored = replay_contour(resting(GUIDED), ring, corner=0.02)
    assert len(ignored.shocks) == 0
    # The corner before those left out goes on, by at most twice the limit across cam angle 0.
    dense = np.linspace(0.0, TURN, 2000)
    assert np.max(np.abs(ignored.lift.at(dense) - found.lift.at(dense))) <= 0.5 * 40.0 * 0.04**2


def test_many_pieces_take_no_time() -> None:
    count = 20_000
    angles = TURN * np.arange(count) / count
    noise = np.random.default_rng(1).uniform(-1e-4, 1e-4, count)
    found = replay_contour(resting(GUIDED), polyline((40.0 + noise) * np.exp(1j * angles)))
    assert abs(found.largest_error.value) <= 1e-4


# Refusals ---------------------------------------------------------------------------------------


def test_wrong_contours_are_refused() -> None:
    pitch = resting(GUIDED)
    with pytest.raises(GeometryError, match="once round the cam axis"):
        replay_contour(pitch, Contour.circle(10.0, 12.0))
    with pytest.raises(GeometryError, match="counter-clockwise"):
        replay_contour(pitch, polyline(np.array([30 + 30j, 30 - 30j, -30 - 30j, -30 + 30j])))
    with pytest.raises(GeometryError, match="inner flank"):
        replay_contour(pitch, Contour.circle(40.0), "outer")
    with pytest.raises(GeometryError, match="cannot lie on the contour"):
        replay_contour(resting(ROCKER), Contour.circle(120.0))
    with pytest.raises(GeometryError, match="pivot's foot"):
        replay_contour(resting(ROCKER), polyline(np.array([100, -30 + 30j, -30 - 30j])))
    with pytest.raises(GeometryError, match="flat-faced follower"):
        face_path_of(TranslatingRoller(40.0, 8.0), 1)
