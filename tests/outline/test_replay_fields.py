"""Every field of a replay, from the lift itself and from the contour's own geometry; a roller with
play in its groove; and the roller on cubics, against a root of the touching conditions."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, Final

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.app.answers.replay import closing_error
from camgeo.check.disc import largest_deviation
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, as_spline_contour
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import whole
from camgeo.geometry.outline.replay import (
    AS_DEMANDED_ELEMENT,
    Replay,
    play,
    replay_contour,
    replay_outline,
    replay_spline,
)
from camgeo.geometry.outline.roller import ActualLift, PlayedLift, SplineBranches
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.contour.cams import SCENES, dwell, flank, move, outline, translating
from tests.effects.scenes import design
from tests.integrals import cells, integrals
from tests.outline.clearing import distances
from tests.outline.test_replay import (
    GUIDED,
    ROCKER,
    centres,
    centres_in,
    resting,
    rounded,
    star,
)
from tests.state.test_outline import on_guide
from tests.strategies import SMOOTH, attack, linked_pitch_curves, pitch_curves, signs

STEP: Final = np.radians(0.1)
"""Of the samples."""


Made = tuple[Replay, Contour | None]
"""A replay, and what was replayed if it is lines and arcs."""


def of_contour(pitch: Any, contour: Contour, side: str = "inner") -> Made:
    return replay_contour(pitch, contour, side), contour


def star_of(follower: Any, seed: int, sigma: int) -> Made:
    shape = star(np.random.default_rng(seed))
    return of_contour(resting(follower, sigma), Contour(shape.starts, shape.sweeps, shape.centres))


def round_of(face: Any, seed: int, sigma: int) -> Made:
    shape = rounded(np.random.default_rng(seed))
    return of_contour(resting(face, sigma), Contour(shape.starts, shape.sweeps, shape.centres))


def fit_of(scene: str, side: int, fitter: Any) -> Made:
    curve = flank(scene, side)
    contour = fitter(whole(curve), 1e-2).contour
    return of_contour(curve.pitch, contour, "inner" if side < 0 else "outer")


def real(scene: str, side: str = "inner") -> Made:
    disc = camgeo.load(SCENES / f"{scene}.toml").cam.disc
    return replay_outline(disc.pitch_curve, disc.outline(side).path), None


CASES: Final[dict[str, Callable[[], Made]]] = {
    "star on a guide": lambda: star_of(TranslatingRoller(60.0, 8.0, offset=5.0), 7, 1),
    "star on a rocker": lambda: star_of(ROCKER, 32, -1),
    "arcs of a plate": lambda: fit_of("plate_translating", -1, fit_arcs),
    "arcs of a groove": lambda: fit_of("groove", 1, fit_arcs),
    "chords of a ring": lambda: fit_of("ring", 1, fit_polyline),
    "chords under a rocker": lambda: fit_of("schnitt", -1, fit_polyline),
    "round shape under a face": lambda: round_of(GUIDED, 3, 1),
    "a swallow tail": lambda: real("swallow_tail"),
    "a ring that is cut": lambda: real("trimmed_ring", "outer"),
    "a knife edge": lambda: real("knife_edge"),
    "straight moves": lambda: real("straight_moves"),
}


@pytest.fixture(scope="module", params=CASES)
def made(request: pytest.FixtureRequest) -> Made:
    return CASES[request.param]()


def sided(replay: Replay) -> tuple[FloatArray, FloatArray]:
    """(n,) whether each sample is the left one of two at its cam angle, or the right one."""
    left = np.append(np.diff(replay.phi) == 0.0, False)
    left[-1] = replay.phi[-1] == TURN
    return left, ~left


def test_samples_are_the_lift_on_both_sides_of_all_borders(made: Made) -> None:
    replay, _ = made
    phi, lift = replay.phi, replay.lift
    assert phi[0] == 0.0
    assert np.all(np.diff(phi) >= 0.0)
    assert np.max(np.diff(phi)) <= STEP * (1.0 + 1e-9)
    left, right = sided(replay)
    for which, side in ((left, "left"), (right, "right")):
        at: FloatArray = np.where(phi[which] == TURN, 0.0, phi[which])
        one: Side = "left" if side == "left" else "right"
        assert np.array_equal(replay.actual[:, which], lift.jet(at, one))
        assert np.array_equal(replay.demanded[:, which], lift.motion.jet(at, one, 2)[:3])
    borders = np.concatenate((lift.borders, lift.breaks))
    dropped = [np.any(np.abs(replay.drops.phi - each) < 1e-12) for each in borders]
    twice = np.where(phi[left] == TURN, 0.0, phi[left])
    assert np.all(np.isin(borders, twice) | dropped)


def test_derivatives_are_those_of_the_lift(made: Made) -> None:
    replay, _ = made
    lift, h = replay.lift, 1e-5
    edges = np.concatenate((lift.borders, lift.breaks, lift.motion.borders, [0.0, TURN]))
    phi = (np.arange(331) + 0.37) * TURN / 331.0
    phi = phi[np.min(np.abs(phi[:, None] - edges), axis=1) > 3.0 * h]
    low, here, high = (lift.displacement(phi + step) for step in (-h, 0.0, h))
    jet = lift.jet(phi)
    size = np.max(np.abs(replay.actual[:, ::7]), axis=1) + 1.0
    # Of the third derivative h^2 / 6 is left; the lift's rounding, over h or its square.
    assert np.max(np.abs((high - low) / (2.0 * h) - jet[1])) <= 1e-7 * (size[1] + size[2])
    assert np.max(np.abs((high - 2.0 * here + low) / h**2 - jet[2])) <= 3e-3 * size[2]
    assert np.array_equal(jet[0], here)


def test_what_holds_the_roller_is_its_radius_away_and_nothing_is_nearer(made: Made) -> None:
    replay, contour = made
    if contour is None or not isinstance(replay.lift, ActualLift):
        return  # corners of an outline, and a face, are compared elsewhere
    some = np.arange(0, len(replay.phi), 41)
    at = centres(replay, replay.phi[some], replay.actual[0, some])
    follower: Any = replay.lift.path.follower
    shape, element = outline(contour), replay.element[some]
    assert np.all(element != AS_DEMANDED_ELEMENT)
    pieces, vertices = element >= 0, element < 0
    away: FloatArray = np.empty(len(some))
    away[pieces] = shape.apart(at[pieces], element[pieces])
    away[vertices] = np.abs(at[vertices] - contour.vertices[-1 - element[vertices]])
    assert away == pytest.approx(np.full(len(some), follower.roller_radius), abs=1e-9)
    assert np.min(shape.distances(at)) >= follower.roller_radius - 1e-9


def test_nothing_is_beyond_its_summary(made: Made) -> None:
    replay, _ = made
    lift, sense = replay.lift, replay.press * replay.lift.outward
    error = replay.actual - replay.demanded
    assert np.array_equal(replay.lost, sense * error[0])
    dense = np.linspace(0.0, TURN, 20_001)[:-1]
    inside = lift.displacement(dense) - lift.motion.jet(dense)[0]
    at = (
        lift.displacement(np.array([replay.largest_error.place]))
        - lift.motion.jet(np.array([replay.largest_error.place]))[0]
    )
    assert replay.largest_error.value == pytest.approx(float(at[0]), rel=1e-9, abs=1e-13)
    most = max(float(np.max(np.abs(each))) for each in (error[0], inside))
    assert abs(replay.largest_error.value) >= most * (1.0 - 1e-9) - 1e-13
    rates = [replay.actual[1], np.where(replay.smooth, replay.actual[2], 0.0)]
    for found, values in zip((replay.velocity, replay.acceleration), rates, strict=True):
        assert (found is None) == (len(replay.drops) > 0)
        assert found is None or abs(found.value) >= np.max(np.abs(values)) * (1.0 - 1e-9)
    best = replay.largest_loss
    most = max(0.0, float(np.max(sense * error[0])), float(np.max(sense * inside)))
    assert most - 1e-13 <= best.value * (1.0 + 1e-9)
    near = best.place + STEP * np.linspace(-1.1, 1.1, 2001)
    beside = lift.displacement(near % TURN) - lift.motion.jet(near % TURN)[0]
    top = float(np.max(sense * beside))
    assert best.value >= top - 1e-9 * abs(top) - 1e-13
    assert best.value == pytest.approx(max(top, 0.0), rel=1e-3, abs=1e-12)
    fine = lift.motion.jet(dense)
    for peak, order in ((replay.demanded_velocity, 1), (replay.demanded_acceleration, 2)):
        assert peak == pytest.approx(float(np.max(np.abs(fine[order]))), rel=1e-5, abs=1e-12)


def test_its_summary_does_not_depend_on_the_samples() -> None:
    curve = flank("plate_translating", -1)
    contour = fit_arcs(whole(curve), 1e-2).contour
    fine, coarse = (
        replay_contour(curve.pitch, contour, step=np.radians(step)) for step in (0.1, 10.0)
    )
    assert len(coarse.phi) < len(fine.phi)
    for name in ("largest_loss", "largest_error", "velocity", "acceleration", "ripple"):
        assert getattr(coarse, name) == getattr(fine, name)


def test_shocks_and_drops_are_where_the_lift_jumps(made: Made) -> None:
    replay, _ = made
    lift = replay.lift
    places = np.unique(np.concatenate((lift.borders, lift.breaks)))
    before, after = (lift.displacement(places, side) for side in ("left", "right"))
    falls = np.abs(after - before) > 1e-6
    assert places[falls] == pytest.approx(replay.drops.phi, abs=1e-12)
    assert before[falls] == pytest.approx(replay.drops.left)
    assert after[falls] == pytest.approx(replay.drops.right)
    places = places[~falls]
    left, right = (lift.jet(places, side)[1] for side in ("left", "right"))
    jumps = np.abs(right - left) > 1e-3 * (1.0 + np.abs(left))
    assert set(np.round(places[jumps], 9)) <= set(np.round(replay.shocks.phi, 9))
    known = np.isin(np.round(places, 9), np.round(replay.shocks.phi, 9))
    assert left[known] == pytest.approx(replay.shocks.left)
    assert right[known] == pytest.approx(replay.shocks.right)
    largest = replay.shocks.largest
    assert (largest is None) == (len(replay.shocks) == 0)
    if largest is not None:
        jump = replay.shocks.right - replay.shocks.left
        assert abs(largest.value) == np.max(np.abs(jump))
        assert largest.value == jump[replay.shocks.phi == largest.place][0]
        if replay.demanded_velocity:
            assert replay.largest_shock == abs(largest.value) / replay.demanded_velocity
    doubled = replay.shocks.scaled(-2.0)
    assert np.array_equal(doubled.left, -2.0 * replay.shocks.left)
    assert np.array_equal(doubled.right, -2.0 * replay.shocks.right)


@pytest.mark.parametrize("scene", ["conjugate_lever", "conjugate_carriage"])
def test_two_discs_leave_the_difference_of_their_lifts(scene: str) -> None:
    """Fits that are off by different tolerances, so that play and squeeze differ."""
    design = camgeo.load(SCENES / f"{scene}.toml")
    replays, dense = [], np.linspace(0.0, TURN, 7201)
    for disc, tolerance in zip(design.discs, (0.03, 0.01), strict=True):
        path = disc.cam.disc.outline("inner").path
        found = replay_contour(disc.cam.disc.pitch_curve, fit_arcs(path, tolerance).contour)
        replays.append(found)
    main, other = replays
    sense = 1.0 if design.cam.disc.pitch_curve.leverage(np.zeros(1))[0] > 0.0 else -1.0
    apart = sense * (other.lift.displacement(dense) - main.lift.displacement(dense))
    assert np.array_equal(play(main, other, dense), apart)
    ends = closing_error(main, other)
    assert ends.lowest.value == pytest.approx(float(np.min(apart)), rel=1e-3)
    assert ends.highest.value == pytest.approx(float(np.max(apart)), rel=1e-3)
    for end in (ends.lowest, ends.highest):
        assert play(main, other, np.array([end.place]))[0] == pytest.approx(end.value, abs=1e-9)
    mirrored = closing_error(other, main)
    assert mirrored.highest.value == pytest.approx(ends.highest.value, abs=1e-12)
    with pytest.raises(camgeo.CamgeoError, match="same sense"):
        closing_error(main, main)


EPS = 2.0**-52


few = settings(attack, max_examples=15)


mechanisms = st.one_of(pitch_curves(SMOOTH), linked_pitch_curves(SMOOTH))


def flank_of(curve: PitchCurve, press: int, clearance: float) -> WorkingCurve:
    return WorkingCurve(curve, press * (curve.follower.roller_radius + 0.5 * clearance))


def played(curve: PitchCurve, press: int, clearance: float) -> PlayedLift:
    path = path_of(curve.follower, curve.rotation)
    return PlayedLift(path, WorkingCurve(curve, 0.5 * press * clearance))


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
    at = centres_in(curve, phi, played(curve, press, clearance).jet(phi)[0])
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
    borders, _ = lift.path.cam_coordinates(lift.parallel.point(curve.borders))
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
        distances(curve, centres_in(curve, phi, held + step))
        for step in (-1e-5 * unit, 1e-5 * unit)
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
    with pytest.raises(GeometryError, match="side clearance is too large"):
        PlayedLift(path_of(curve.follower, curve.rotation), WorkingCurve(curve, -20.0)).jet(
            np.linspace(0.0, TURN, 91)
        )


def test_a_trimmed_flank_is_left_to_its_drawing() -> None:
    design = camgeo.load(SCENES / "trimmed_ring.toml")
    path = design.cam.disc.outline("outer").path
    with pytest.raises(GeometryError, match="replay a drawing"):
        replay_outline(design.cam.disc.pitch_curve, path, clearance=0.1)


def on_rocker(follower: Any) -> Any:
    """As of `tests.state.test_outline`, for a complex lift too."""
    pivot, arm = mpmath.mpmathify(follower.pivot), mpmath.mpmathify(follower.start_arm)
    return lambda lift: pivot + arm * mpmath.exp(1j * follower.swing_sense * lift)


@cache
def design_of(scene: str) -> Design:
    return design(scene, "")


@cache
def contour_of(scene: str, tolerance: float) -> SplineContour:
    (outline,) = (e for e in design_of(scene).disc.drawn.part.boundaries if e.name == "outline")
    return outline.spline(tolerance).contour


def replay_of(scene: str, tolerance: float) -> Replay:
    cam = design_of(scene).cam
    return replay_spline(cam.disc.pitch_curve, contour_of(scene, tolerance), cam.contact.main)


@pytest.mark.parametrize(
    ("scene", "path"),
    [("plate_translating", on_guide), ("querhub", on_rocker), ("ring", on_guide)],
)
def test_the_lift_is_that_of_a_roller_that_touches_the_cubic(scene: str, path: Any) -> None:
    """Unknown are lift and parameter: the centre is on the normal at the roller radius."""
    cam, replay = design_of(scene).cam, replay_of(scene, 1e-3)
    lift = replay.lift
    assert isinstance(lift, ActualLift)
    chain = lift.branches
    assert isinstance(chain, SplineBranches)
    first = len(chain.arcs.elements)
    middles = 0.5 * (lift.borders + np.append(lift.borders[1:], lift.borders[0] + 2.0 * math.pi))
    curved = np.flatnonzero(lift.numbers >= first)
    chosen = curved[np.linspace(0, len(curved) - 1, 6).astype(int)]
    place, distance = path(cam.follower), mpmath.mpf(chain.cubics.distance)
    jets = lift.jet(middles[chosen], "right", 3)
    for index, phi, jet in zip(chosen.tolist(), middles[chosen].tolist(), jets.T, strict=True):
        number = np.array([lift.numbers[index] - first])
        b = [mpmath.mpmathify(complex(each)) for each in chain.cubics.pieces[number[0]]]
        guess = float(chain.touching(lift.path, np.array([phi]), number)[0])

        def apart(q: Any, t: Any, angle: Any, b: Any = b) -> Any:
            w = 1 - t
            point = w**3 * b[0] + 3 * w * w * t * b[1] + 3 * w * t * t * b[2] + t**3 * b[3]
            way = w * w * (b[1] - b[0]) + 2 * w * t * (b[2] - b[1]) + t * t * (b[3] - b[2])
            return (
                place(q) * mpmath.exp(-1j * cam.rotation * angle)
                - point
                + (1j * distance * way / abs(way))
            )

        def moved(angle: Any, apart: Any = apart, start: Any = (float(jet[0]), guess)) -> Any:
            def faults(q: Any, t: Any) -> Any:
                off = apart(q, t, angle)
                return [mpmath.re(off), mpmath.im(off)]

            return mpmath.findroot(faults, start)[0]

        with mpmath.workdps(40):
            wanted = [float(mpmath.diff(moved, mpmath.mpf(phi), k)) for k in range(4)]
        scale = max(map(abs, wanted)) + 1.0
        assert jet == pytest.approx(wanted, abs=1e-9 * scale)


@pytest.mark.parametrize("scene", ["plate_translating", "querhub", "ring", "swallow_tail"])
def test_the_lift_is_off_by_what_the_tolerance_allows(scene: str) -> None:
    cam = design_of(scene).cam
    for tolerance in (1e-2, 1e-5):
        replay = replay_of(scene, tolerance)
        phi = np.linspace(0.0, 2.0 * math.pi, 3001)
        exact = design_of(scene).effects.subject.state
        off = np.abs(replay.lift.displacement(phi) - exact.motion.jet(phi)[0])
        lever = np.abs(exact.curve.leverage(phi))
        assert np.all(off * lever <= 1.1 * tolerance)
        assert not len(replay.shocks)
        assert not len(replay.drops)
        assert cam.follower.roller_radius > 0.0


@pytest.mark.parametrize("scene", ["plate_translating", "querhub", "swallow_tail"])
def test_on_lines_and_arcs_alone_it_is_the_replay_of_these(scene: str) -> None:
    cam = design_of(scene).cam
    (outline,) = (e for e in design_of(scene).disc.drawn.part.boundaries if e.name == "outline")
    contour = outline.arcs(1e-2).contour
    pitch, side = cam.disc.pitch_curve, cam.contact.main
    plain, by_strands = replay_contour(pitch, contour, side), replay_spline(
        pitch, as_spline_contour(contour), side
    )  # fmt: skip
    phi = np.linspace(0.0, 2.0 * math.pi, 1999)
    assert by_strands.lift.displacement(phi) == pytest.approx(
        plain.lift.displacement(phi), abs=1e-10
    )


def test_the_acceleration_of_one_spline_is_continuous() -> None:
    """Simple knots keep the curvature, and so the acceleration."""
    lift = replay_of("plate_translating", 1e-3).lift
    assert isinstance(lift, ActualLift)
    chain = lift.branches
    assert isinstance(chain, SplineBranches)
    first = len(chain.arcs.elements)
    inside = (lift.numbers >= first) & (np.roll(lift.numbers, 1) >= first)
    contour = contour_of("plate_translating", 1e-3)
    joined = sum(len(each) - 1 for each in contour.strands if isinstance(each, CubicSpline))
    left, right = (lift.jet(lift.borders[inside], side)[2] for side in ("left", "right"))
    same = np.isclose(left, right, atol=1e-7 * np.max(np.abs(left)))
    assert np.count_nonzero(same) >= joined
    assert joined > 5


def test_a_corner_towards_the_roller_is_refused() -> None:
    """A square with one side pressed in."""
    corners = 60.0 * np.exp(1j * np.array([0.2, 1.8, 3.3, 4.8]))
    bent = np.array([corners[0], 0.4 * (corners[0] + corners[1]), *corners[1:]])
    cam = design_of("plate_translating").cam
    with pytest.raises(GeometryError, match="turns towards the roller"):
        replay_spline(cam.disc.pitch_curve, as_spline_contour(Contour.polygon(bent)), "inner")
