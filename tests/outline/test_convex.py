"""Whether a flat face can touch a cam: exact extremes, and what they imply for the outline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.outline.convex import contact_extremes, convexity, touch
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.mechanism.flat_faces import convex_curves, flat_curves
from tests.reference import plan_of
from tests.strategies import attack

DENSE = 4001


def dense(curve: PitchCurve) -> list[tuple[FloatArray, Side]]:
    """Many cam angles, and both sides of the breaks."""
    return [
        (np.linspace(0.0, TURN, DENSE), "right"), (curve.breaks, "right"), (curve.breaks, "left"),
    ]  # fmt: skip


@attack
@given(curve=flat_curves())
def test_no_sample_lies_beyond_the_extremes(curve: PitchCurve) -> None:
    found = convexity(curve)
    samples = [touch(curve, phi, side) for phi, side in dense(curve)]
    turn = np.concatenate([at.turn[0] for at in samples])
    height = np.concatenate([at.distance for at in samples])
    assert np.min(turn) >= found.turn[0] - 1e-12
    assert np.min(height) >= found.clearance[0] - 1e-12 * found.size
    assume(found.turn[0] > 0.0)
    radius = np.concatenate([at.pace[0] / at.turn[0] for at in samples])
    size = np.max(np.abs(radius))
    assert np.min(radius) >= found.radius[0] - 1e-12 * size
    # And it is a value of the curve, at its place.
    at = [touch(curve, np.array([found.radius[1]]), side) for side in ("right", "left")]
    values = [float(each.pace[0, 0] / each.turn[0, 0]) for each in at]
    assert min(abs(value - found.radius[0]) for value in values) <= 1e-6 * size
    places = contact_extremes(curve)
    contact = np.concatenate([at.contact[0] for at in samples])
    assert np.min(contact) >= places.smallest()[0] - 1e-12 * size
    assert np.max(contact) <= places.largest()[0] + 1e-12 * size


@attack
@given(curve=flat_curves(), more=st.floats(-5.0, 60.0))
def test_a_parallel_face_has_a_parallel_outline(curve: PitchCurve, more: float) -> None:
    """Base radius, and for a rocker the face offset as well, larger by D: all radii are by D."""
    follower = curve.follower
    assume(follower.base_radius + more > 1.0)
    base = follower.base_radius + more
    if isinstance(follower, TranslatingFlat):
        other: TranslatingFlat | OscillatingFlat = replace(follower, base_radius=base)
    else:
        assert isinstance(follower, OscillatingFlat)
        offset = follower.face_offset + more
        other = replace(follower, base_radius=base, face_offset=offset)
    here, there = convexity(curve), convexity(replace(curve, follower=other))
    assume(here.turn[0] > 0.0)
    scale = 1e-11 * (abs(here.radius[0]) + base + 200.0)
    assert there.radius[0] == pytest.approx(here.radius[0] + more, abs=scale)
    assert there.clearance[0] == pytest.approx(here.clearance[0] + more, abs=scale)


@settings(attack, max_examples=20)
@given(curve=convex_curves())
def test_all_of_a_convex_curve_is_the_outline(curve: PitchCurve) -> None:
    """Once round, convex: its tangents turn once, and the area is half the integral of h rho."""
    outline = real_outline(WorkingCurve(curve, 0.0))
    assert outline.path.is_whole
    assert not outline.dropped
    phi = np.linspace(0.0, TURN, DENSE)
    tangents = WorkingCurve(curve, 0.0).tangent(phi)
    turned = np.angle(tangents[1:] * np.conj(tangents[:-1]))
    assert np.all(-curve.rotation * turned > 0.0)
    assert np.sum(turned) == pytest.approx(-curve.rotation * TURN)

    def strip(angles: FloatArray) -> FloatArray:
        at = touch(curve, angles)
        return np.asarray(at.distance * at.pace[0])

    wide = 0.5 * float(np.sum(integrals(strip, *cells(curve.borders, 6))))
    assert abs(area(outline.path)) == pytest.approx(wide, rel=1e-10)


@settings(attack, max_examples=12)
@given(curve=convex_curves(), tolerance=st.sampled_from([1e-2, 1e-3, 1e-4]))
def test_a_proved_deviation_holds_for_samples(curve: PitchCurve, tolerance: float) -> None:
    """The bound that is built on the third one: no point of the curve lies farther from its arc."""
    fit = fit_arcs(real_outline(WorkingCurve(curve, 0.0)).path, tolerance)
    assert fit.deviation <= tolerance
    points = fit.contour.points(1e-3 * tolerance)
    assert len(points) < 400_000
    samples = curve.point(np.linspace(0.0, TURN, 301))
    starts, chords = points, np.roll(points, -1) - points
    length = np.abs(chords)
    farthest = 0.0
    for sample in samples:
        share = np.clip((np.conj(chords) * (sample - starts)).real / length**2, 0.0, 1.0)
        farthest = max(farthest, float(np.min(np.abs(starts + share * chords - sample))))
    assert farthest <= fit.deviation + 1e-3 * tolerance + 1e-12


def test_undercut_between_the_samples_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cells find what the extremes miss: here all of them, but those at the breaks."""
    plan = plan_of({"phi_H": [30, 40, 40, 120, 130]}, 20.0)
    curve = PitchCurve(plan, TranslatingFlat(20.0), 1)
    known = convexity(curve).radius
    none = np.empty(0), np.empty(0, dtype=np.intp)
    monkeypatch.setattr("camgeo.geometry.pieces.isolated_roots", lambda *_: none)
    found = convexity(curve).radius
    assert known[0] <= found[0] <= 0.0
