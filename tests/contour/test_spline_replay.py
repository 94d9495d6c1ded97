"""The roller on cubics, against a root of the touching conditions found by mpmath."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, Final

import mpmath
import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, strands_of
from camgeo.geometry.contour.spline_replay import Chain, replay_spline
from camgeo.geometry.outline.replay import Replay, replay_contour
from camgeo.geometry.outline.roller import ActualLift
from tests.effects.scenes import design
from tests.effects.test_trimmed_cams import on_guide


def on_rocker(follower: Any) -> Any:
    """As of `tests.effects.test_trimmed_cams`, for a complex lift too."""
    pivot, arm = mpmath.mpmathify(follower.pivot), mpmath.mpmathify(follower.start_arm)
    return lambda lift: pivot + arm * mpmath.exp(1j * follower.swing_sense * lift)


SCENES: Final = [("plate_translating", on_guide), ("querhub", on_rocker), ("ring", on_guide)]


@cache
def made(scene: str) -> Design:
    return design(scene, "")


@cache
def contour_of(scene: str, tolerance: float) -> SplineContour:
    (outline,) = (e for e in made(scene).disc.drawn.part.boundaries if e.name == "outline")
    return outline.spline(tolerance).contour


def replay_of(scene: str, tolerance: float) -> Replay:
    cam = made(scene).cam
    return replay_spline(cam.disc.pitch_curve, contour_of(scene, tolerance), cam.contact.main)


@pytest.mark.parametrize(("scene", "path"), SCENES)
def test_the_lift_is_that_of_a_roller_that_touches_the_cubic(scene: str, path: Any) -> None:
    """Unknown are lift and parameter: the centre is on the normal at the roller radius."""
    cam, replay = made(scene).cam, replay_of(scene, 1e-3)
    lift = replay.lift
    assert isinstance(lift, ActualLift)
    chain = lift.branches
    assert isinstance(chain, Chain)
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
    cam = made(scene).cam
    for tolerance in (1e-2, 1e-5):
        replay = replay_of(scene, tolerance)
        phi = np.linspace(0.0, 2.0 * math.pi, 3001)
        exact = made(scene).effects.subject.state
        off = np.abs(replay.lift.at(phi) - exact.motion.jet(phi)[0])
        lever = np.abs(exact.curve.leverage(phi))
        assert np.all(off * lever <= 1.1 * tolerance)
        assert not len(replay.shocks)
        assert not len(replay.drops)
        assert cam.follower.roller_radius > 0.0


@pytest.mark.parametrize("scene", ["plate_translating", "querhub", "swallow_tail"])
def test_on_lines_and_arcs_alone_it_is_the_replay_of_these(scene: str) -> None:
    cam = made(scene).cam
    (outline,) = (e for e in made(scene).disc.drawn.part.boundaries if e.name == "outline")
    contour = outline.arcs(1e-2).contour
    pitch, side = cam.disc.pitch_curve, cam.contact.main
    plain, by_strands = replay_contour(pitch, contour, side), replay_spline(
        pitch, strands_of(contour), side
    )  # fmt: skip
    phi = np.linspace(0.0, 2.0 * math.pi, 1999)
    assert by_strands.lift.at(phi) == pytest.approx(plain.lift.at(phi), abs=1e-10)


def test_the_acceleration_of_one_spline_is_continuous() -> None:
    """Simple knots keep the curvature, and so the acceleration."""
    lift = replay_of("plate_translating", 1e-3).lift
    assert isinstance(lift, ActualLift)
    chain = lift.branches
    assert isinstance(chain, Chain)
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
    cam = made("plate_translating").cam
    with pytest.raises(GeometryError, match="turns towards the roller"):
        replay_spline(cam.disc.pitch_curve, strands_of(Contour.polygon(bent)), "inner")
