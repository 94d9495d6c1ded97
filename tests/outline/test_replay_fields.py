"""Every field of a replay, from the lift itself and from the contour's own geometry."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import camgeo
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.geometry.outline.replay import (
    AS_DEMANDED_ELEMENT,
    Replay,
    closing_error,
    play,
    replay_contour,
    replay_outline,
)
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.contour.cams import flank, outline
from tests.outline.test_face_lift import GUIDED, rounded
from tests.outline.test_face_lift import resting as facing
from tests.outline.test_replay import ROCKER, centres, resting, star

SCENES: Final = Path(__file__).parents[2] / "fixtures" / "scenes"

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
    return of_contour(facing(face, sigma), Contour(shape.starts, shape.sweeps, shape.centres))


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
    low, here, high = (lift.at(phi + step) for step in (-h, 0.0, h))
    jet = lift.jet(phi)
    size = np.max(np.abs(replay.actual[:, ::7]), axis=1) + 1.0
    # Of the third derivative h^2 / 6 is left; the lift's rounding, over h or its square.
    assert np.max(np.abs((high - low) / (2.0 * h) - jet[1])) <= 1e-7 * (size[1] + size[2])
    assert np.max(np.abs((high - 2.0 * here + low) / h**2 - jet[2])) <= 3e-3 * size[2]
    assert np.array_equal(jet[0], here)


def test_what_holds_the_roller_is_its_radius_away_and_nothing_is_nearer(made: Made) -> None:
    replay, contour = made
    if contour is None or not hasattr(replay.lift, "branches"):
        return  # corners of an outline, and a face, are compared elsewhere
    some = np.arange(0, len(replay.phi), 41)
    at = centres(replay, replay.phi[some], replay.actual[0, some])
    follower: Any = replay.lift.path.follower  # type: ignore[attr-defined]  # that of a roller
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
    inside = lift.at(dense) - lift.motion.jet(dense)[0]
    at = (
        lift.at(np.array([replay.largest_error.place]))
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
    beside = lift.at(near % TURN) - lift.motion.jet(near % TURN)[0]
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
    before, after = (lift.at(places, side) for side in ("left", "right"))
    falls = np.abs(after - before) > 1e-6
    assert places[falls] == pytest.approx(replay.drops.phi, abs=1e-12)
    assert before[falls] == pytest.approx(replay.drops.before)
    assert after[falls] == pytest.approx(replay.drops.after)
    places = places[~falls]
    left, right = (lift.jet(places, side)[1] for side in ("left", "right"))
    jumps = np.abs(right - left) > 1e-3 * (1.0 + np.abs(left))
    assert set(np.round(places[jumps], 9)) <= set(np.round(replay.shocks.phi, 9))
    known = np.isin(np.round(places, 9), np.round(replay.shocks.phi, 9))
    assert left[known] == pytest.approx(replay.shocks.before)
    assert right[known] == pytest.approx(replay.shocks.after)
    largest = replay.shocks.largest
    assert (largest is None) == (len(replay.shocks) == 0)
    if largest is not None:
        jump = replay.shocks.after - replay.shocks.before
        assert abs(largest.value) == np.max(np.abs(jump))
        assert largest.value == jump[replay.shocks.phi == largest.place][0]
        if replay.demanded_velocity:
            assert replay.largest_shock == abs(largest.value) / replay.demanded_velocity
    doubled = replay.shocks.scaled(-2.0)
    assert np.array_equal(doubled.before, -2.0 * replay.shocks.before)
    assert np.array_equal(doubled.after, -2.0 * replay.shocks.after)


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
    apart = sense * (other.lift.at(dense) - main.lift.at(dense))
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
