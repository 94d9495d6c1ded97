"""A roller with play pressed against a flank of its groove: where it really is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.check.flank import largest_deviation
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.replay import replay_outline
from camgeo.geometry.outline.roller import PlayedLift
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from tests.contour.cams import dwell, move, translating
from tests.integrals import cells, integrals
from tests.outline.clearing import distances
from tests.strategies import SMOOTH, attack, linked_pitch_curves, pitch_curves, signs

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

EPS = 2.0**-52

few = settings(attack, max_examples=15)

mechanisms = st.one_of(pitch_curves(SMOOTH), linked_pitch_curves(SMOOTH))


def flank_of(curve: PitchCurve, press: int, clearance: float) -> WorkingCurve:
    return WorkingCurve(curve, press * (curve.follower.roller_radius + 0.5 * clearance))


def played(curve: PitchCurve, press: int, clearance: float) -> PlayedLift:
    path = path_of(curve.follower, curve.rotation)
    return PlayedLift(path, WorkingCurve(curve, 0.5 * press * clearance))


def centres(curve: PitchCurve, phi: FloatArray, lift: FloatArray) -> ComplexArray:
    """Roller centres in the cam, by the follower's own formula."""
    jet = np.zeros((4, len(phi)))
    jet[0] = lift
    relative = curve.follower.relative_jet(jet, curve.rotation, 1)
    return curve.in_cam(relative, phi, relative.along[0], relative.across[0])


def assume_easy(curve: PitchCurve, clearance: float) -> None:
    """Cams that are no hard cases: speed, transmission angle and curvature leave room."""
    phi = np.linspace(0.0, TURN, 721)
    speed = np.abs(curve.jet(phi)[1])
    assume(np.min(speed) > 0.1 * np.max(speed))
    assume(np.min(curve.transmission_angle(phi)) > 0.3)
    half = curve.follower.roller_radius + 0.5 * clearance
    assume(half * np.max(np.abs(curve.curvature(phi))) < 0.8)
    for side in (-1, 1):
        outline = real_outline(WorkingCurve(curve, side * half))
        assume(outline.path.is_whole)


@few
@given(curve=mechanisms, press=signs(), clearance=st.floats(1e-4, 0.5))
def test_the_roller_touches_one_flank_and_clears_the_other(
    curve: PitchCurve, press: int, clearance: float
) -> None:
    assume_easy(curve, clearance)
    phi = np.linspace(0.0, TURN, 41)[:-1]
    at = centres(curve, phi, played(curve, press, clearance).jet(phi)[0])
    radius = curve.follower.roller_radius
    size = float(np.max(np.abs(at))) + radius
    # A lift is known to 64 ulp of a turn, times the way of the roller centre in it.
    rounding = 1024.0 * EPS * (size + float(np.max(np.abs(curve.jet(phi)[1]))))
    touched = distances(flank_of(curve, press, clearance), at)  # type: ignore[arg-type]  # its points are all that is used
    assert np.max(np.abs(touched - radius)) <= rounding
    other = distances(flank_of(curve, -press, clearance), at)  # type: ignore[arg-type]  # its points are all that is used
    assert np.max(np.abs(other - radius - clearance)) <= rounding


@few
@given(curve=mechanisms, press=signs(), clearance=st.floats(1e-3, 0.5))
def test_each_derivative_is_that_of_the_one_before(
    curve: PitchCurve, press: int, clearance: float
) -> None:
    assume_easy(curve, clearance)
    lift = played(curve, press, clearance)
    borders, _ = lift.path.cam_angle_of(lift.parallel.point(curve.borders))
    low, high = cells(np.sort(borders), 6)
    change = lift.jet(high, "left")[:2] - lift.jet(low, "right")[:2]
    found = integrals(lambda phi: lift.jet(phi)[1:], low, high)
    size = np.max(np.abs(lift.jet(np.linspace(0.0, TURN, 721))), axis=1)
    # 24 points follow a smooth motion to rounding; that of a rest is of the lengths it is made of.
    unit = curve.follower.base_radius / abs(curve.follower.reach)
    for order in (0, 1):
        limit = 1e-10 * (size[order] + size[order + 1]) + 1e-12 * unit
        assert np.max(np.abs(found[order] - change[order])) <= limit


@few
@given(curve=mechanisms, press=signs(), clearance=st.floats(1e-3, 0.5))
def test_the_leverage_is_how_fast_a_lift_leaves_the_flank(
    curve: PitchCurve, press: int, clearance: float
) -> None:
    """A lift that is a little larger takes the centre off its parallel by the leverage times it."""
    assume_easy(curve, clearance)
    phi, lift = np.linspace(0.0, TURN, 24)[:-1], played(curve, press, clearance)
    lever, held = lift.leverage(phi), lift.jet(phi)[0]
    unit = 1.0 / abs(curve.follower.reach)
    away = [
        distances(curve, centres(curve, phi, held + step)) for step in (-1e-5 * unit, 1e-5 * unit)
    ]
    # The centre runs outside the pitch curve, or inside, where the distance falls.
    rate = press * (away[1] - away[0]) / (2e-5 * unit)
    assert rate == pytest.approx(lever, rel=1e-4, abs=1e-5 / unit)


@few
@given(curve=mechanisms, press=signs())
def test_a_small_play_is_what_the_check_reports(curve: PitchCurve, press: int) -> None:
    """To first order in the clearance, with an error that falls as the clearance does."""
    assume_easy(curve, 1e-3)
    errors = []
    for clearance in (1e-3, 1e-4):
        replay = replay_outline(
            curve,
            real_outline(flank_of(curve, press, clearance)).path,
            clearance=clearance,
        )
        deviation, _ = largest_deviation(curve, clearance)
        error = abs(replay.largest_error.value) / deviation - 1.0
        # Samples every tenth of a degree miss a top by at most its bend: 4e-7 of it times some ten.
        errors.append(max(abs(error) - 4e-5, 0.0))
    assert errors[0] <= 0.02
    assert errors[1] <= 0.11 * errors[0] + 1e-6


def test_a_play_that_cannot_be_followed_is_refused() -> None:
    """Beyond the smallest radius of curvature, less than 20 mm, the parallel runs back."""
    curve = translating(move(40, 20.0), move(40, 0.0), dwell(280)).pitch
    with pytest.raises(GeometryError, match="play is too large to be followed"):
        PlayedLift(path_of(curve.follower, curve.rotation), WorkingCurve(curve, -20.0)).jet(
            np.linspace(0.0, TURN, 91)
        )


def test_a_trimmed_flank_is_left_to_its_drawing() -> None:
    design = camgeo.load(SCENES / "trimmed_ring.toml")
    path = design.cam.disc.outline("outer").path
    with pytest.raises(GeometryError, match="replay a drawing"):
        replay_outline(design.cam.disc.pitch_curve, path, clearance=0.1)
