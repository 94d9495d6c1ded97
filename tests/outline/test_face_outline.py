"""Whether a flat face can touch a cam, and what is left of the disc of one that undercuts: exact
extremes, and intersections of half planes."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.outline.face import contact_places
from camgeo.geometry.outline.outline import Outline, real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.outline.replay import replay_contour, replay_outline
from camgeo.geometry.pieces import Convexity, contact_extremes, convexity, touch
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat, flat_follower
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, Side
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.long_form import examples
from tests.mechanism.flat_faces import convex_curves, flat_curves
from tests.reference import plan_of
from tests.strategies import attack

DENSE = 4001


def both_sides(curve: PitchCurve) -> list[tuple[FloatArray, Side]]:
    """Many cam angles, and both sides of the breaks."""
    return [
        (np.linspace(0.0, TURN, DENSE), "right"), (curve.breaks, "right"), (curve.breaks, "left"),
    ]  # fmt: skip


@attack
@given(curve=flat_curves())
def test_no_sample_lies_beyond_the_extremes(curve: PitchCurve) -> None:
    found = convexity(curve)
    samples = [touch(curve, phi, side) for phi, side in both_sides(curve)]
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
    assert known[0] <= convexity(curve).radius[0] <= 0.0


LAW = make_law("polynomial-345")


STEP = math.radians(0.02)


def tappet(base: float = 25.0, *strokes: tuple[int, float]) -> PitchCurve:
    """A tappet with moves (span [deg], position [mm]) and a rest of 20 degrees before each."""
    moves = strokes or ((60, 20.0), (80, 0.0))
    segments: list[Dwell | Move] = []
    for span, to in moves:
        segments += [Dwell(Decimal(20)), Move(Decimal(span), to, LAW)]
    segments.append(Dwell(360 - sum((each.span for each in segments), Decimal(0))))
    return PitchCurve(MotionPlan(tuple(segments)), TranslatingFlat(base), 1)


def outline_of(pitch: PitchCurve) -> Outline:
    return real_outline(WorkingCurve(pitch, -0.0))


def demanded(pitch: PitchCurve, phi: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Normals of the face in the cam and its distances from the axis, as demanded."""
    lift = pitch.motion.jet(phi)[0]
    normal = flat_follower(pitch.follower).normal(lift) * np.exp(-1j * pitch.rotation * phi)
    return normal, touch(pitch, phi).distance


def support(outline: Outline, pitch: PitchCurve, phi: FloatArray) -> FloatArray:
    """Distance of the face from the axis on the outline with the normals of `phi`: the largest of
    its points, stretches and corners.
    """
    normal, found = demanded(pitch, phi)
    for start, end in outline.dropped:
        cut = (phi - start) % TURN < end - start
        (corner,) = (p for p in outline.path.pivots if abs(p.phi_start % TURN - start) < 1e-12)
        found[cut] = (np.conj(normal[cut]) * corner.centre).real
    return found


def intersection(normal: ComplexArray, distance: FloatArray) -> tuple[IntArray, ComplexArray]:
    """Which half planes touch their intersection, and its corners.

    Its polar dual is the convex hull of their duals n / h.
    """
    dual = normal / distance
    touching = ConvexHull(np.column_stack((dual.real, dual.imag))).vertices
    one, other = dual[touching], np.roll(dual[touching], -1)
    return touching, 1j * (one - other) / (np.conj(one) * other).imag


def check_against_half_planes(pitch: PitchCurve, outline: Outline) -> None:
    phi = np.arange(0.0, TURN, STEP)
    normal, distance = demanded(pitch, phi)
    touching, corners = intersection(normal, distance)
    kept = np.zeros(len(phi), dtype=np.bool_)
    kept[touching] = True
    size = float(np.max(distance))
    # No face of a stretch that is left may be cut off, and none in a range that is left out kept,
    # except next to the ends of the ranges and where the outline is practically straight.
    for start, end in outline.dropped:
        inside = (phi - start) % TURN
        within = (inside > 2.0 * STEP) & (inside < end - start - 2.0 * STEP)
        assert not np.any(kept[within])
    actual = support(outline, pitch, phi)
    # The intersection of the half planes that were sampled contains the disc, and is larger by at
    # most the height of a triangle over an arc of one step, rho STEP^2 / 8.
    sampled = np.array([np.max((np.conj(n) * corners).real) for n in normal[::37]])
    steep = np.max(np.abs(touch(pitch, phi).pace[0]))
    assert np.all(actual[::37] <= sampled + 1e-12 * size)
    assert np.all(actual[::37] >= sampled - 2.0 * steep * STEP**2 - 1e-12 * size)


def undercuts(found: Convexity) -> bool:
    least = 1e-9 * found.size
    return (
        found.turn[0] > 0.0
        and not found.jumps
        and found.clearance[0] > least
        and -math.inf < found.radius[0] < -least
    )


@settings(attack, max_examples=examples(6, long=200))
@given(curve=flat_curves())
def test_what_is_left_is_the_intersection_of_all_half_planes(curve: PitchCurve) -> None:
    assume(undercuts(convexity(curve)))
    try:
        outline = outline_of(curve)
    except UndercutError:
        reject()
    assert outline.dropped
    assert not outline.lobes
    check_against_half_planes(curve, outline)
    for stretch in outline.path.stretches:
        inner = np.linspace(stretch.start, stretch.end, 400)[1:-1]
        assert np.all(touch(curve, inner).pace[0] >= -1e-9 * curve.follower.base_radius)
    for corner in outline.path.pivots:
        ends = curve.point(np.array([corner.phi_start, corner.phi_end]))
        assert np.max(np.abs(ends - corner.centre)) <= 1e-11 * np.max(np.abs(ends))
    lost = replay_outline(curve, outline.path)
    assert np.min(lost.lost) >= -1e-12 * curve.follower.lift_scale
    assert lost.largest_loss.value > 0.0
    assert len(lost.drops) == 0


def test_an_arc_that_two_corners_cut_off_is_left_out() -> None:
    """Two rises with a short rest between them: the rest is not touched at all."""
    pitch = tappet(10.0, (20, 6.0), (20, 12.0), (60, 0.0))
    outline = outline_of(pitch)
    start, end = outline.dropped[0]
    assert start < math.radians(40.0)
    assert end > math.radians(60.0)
    check_against_half_planes(pitch, outline)


@pytest.mark.parametrize("rotation", [1, -1])
def test_the_contact_runs_over_the_corners_too(rotation: int) -> None:
    """Where a stretch is dropped its corner is touched, as far along the face as it lies then."""
    pitch = replace(tappet(), rotation=rotation)
    outline = outline_of(pitch)
    places, angles = contact_places(pitch, outline.path)
    assert np.all((angles >= 0.0) & (angles < TURN))
    phi = np.arange(0.0, TURN, math.radians(0.01))
    normal = demanded(pitch, phi)[0]
    along = (np.conj(normal) * pitch.point(phi)).imag
    sense = np.sign(np.sum(along * touch(pitch, phi).contact[0]))
    for corner in outline.path.pivots:
        inside = (phi - corner.phi_start) % TURN < (corner.phi_end - corner.phi_start) % TURN
        along[inside] = (np.conj(normal[inside]) * corner.centre).imag
    along *= sense
    # At the end of a corner's range its place changes by up to 10 um from sample to sample.
    assert np.min(along) - 0.01 <= np.min(places) <= np.min(along) + 1e-9
    assert np.max(along) - 1e-9 <= np.max(places) <= np.max(along) + 0.01
    for k in (np.argmin(places), np.argmax(places)):
        nearest = int(np.argmin(np.abs(phi - angles[k])))
        assert along[nearest] == pytest.approx(float(places[k]), abs=0.05)


@pytest.mark.parametrize("share", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_tail_however_small_is_found(share: float) -> None:
    """A base radius just below the least one: cusps at the deepest place, and a blunt corner."""
    least = -convexity(tappet(1000.0)).radius[0] + 1000.0
    pitch = tappet(least - share * 20.0)
    outline = outline_of(pitch)
    assert 1 <= len(outline.dropped) <= 2
    phi = convexity(pitch).radius[1]
    (hit,) = [each for each in outline.dropped if (phi - each[0]) % TURN < each[1] - each[0]]
    # p is a parabola about its least value, -share * 20 mm: the tail is root 3 times as wide as it.
    if share <= 1e-4:
        beside = touch(pitch, phi + 1e-4 * np.array([-1.0, 0.0, 1.0])).pace[0]
        bend = float(np.diff(beside, 2)[0]) / 1e-8
        width = 2.0 * math.sqrt(6.0 * share * 20.0 / bend)
        assert hit[1] - hit[0] == pytest.approx(width, rel=0.05)
    lost = replay_outline(pitch, outline.path).largest_loss.value
    assert 0.0 <= lost < 20.0 * share


@pytest.mark.parametrize("base", [25.0, 80.0, 86.6, 86.67])
def test_blind_to_all_extremes_it_drops_the_same(
    base: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cells find where the envelope runs back, with no help but that of the breaks."""
    known = outline_of(tappet(base))
    assert known.dropped
    none = np.empty(0), np.empty(0, dtype=np.intp)
    monkeypatch.setattr("camgeo.geometry.pieces.isolated_roots", lambda *_: none)
    found = outline_of(tappet(base))
    assert np.array(found.dropped) == pytest.approx(np.array(known.dropped), abs=1e-9)
    assert area(found.path) == pytest.approx(area(known.path), rel=1e-12)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_sizes_tiny_and_huge(scale: float) -> None:
    one = outline_of(tappet())
    other = outline_of(tappet(25.0 * scale, (60, 20.0 * scale), (80, 0.0)))
    assert np.array(other.dropped) == pytest.approx(np.array(one.dropped), abs=1e-9)
    assert area(other.path) / scale**2 == pytest.approx(area(one.path), rel=1e-12)


def test_a_fit_of_it_replays_the_same_loss() -> None:
    pitch = tappet()
    path = outline_of(pitch).path
    fit = fit_arcs(path, 1e-3)
    one, other = replay_outline(pitch, path), replay_contour(pitch, fit.contour)
    assert other.largest_loss.value == pytest.approx(one.largest_loss.value, abs=fit.deviation)
    phi = np.linspace(0.0, TURN, 1000)
    assert other.lift.displacement(phi) == pytest.approx(
        one.lift.displacement(phi), abs=fit.deviation
    )


def test_a_lobe_far_too_steep_is_all_cut_off() -> None:
    """300 mm in ten degrees, on half a millimetre: the rests alone are left, and a corner."""
    pitch = tappet(0.5, (10, 300.0), (10, 0.0))
    outline = outline_of(pitch)
    (dropped,) = outline.dropped
    assert dropped == pytest.approx((math.radians(20.0), math.radians(60.0)), abs=1e-2)
    check_against_half_planes(pitch, outline)
    lost = replay_outline(pitch, outline.path).largest_loss.value
    assert 299.0 < lost < 300.0


def snapped(law: str, rise: str, fall: str, base: float, offset: float, turns: int) -> PitchCurve:
    """A rocker that swings 16 degrees; one of the two moves is far too short."""
    spans = [Decimal(30), Decimal(rise), Decimal(40), Decimal(fall)]
    up = Move(spans[1], math.radians(16.0), make_law(law))
    down = Move(spans[3], 0.0, make_law("modified-sine"))
    rests = Dwell(spans[0]), Dwell(spans[2]), Dwell(360 - sum(spans, Decimal(0)))
    plan = MotionPlan((rests[0], up, rests[1], down, rests[2]))
    return PitchCurve(plan, OscillatingFlat(complex(-70.0, 50.0), base, offset, 1), turns)


@pytest.mark.parametrize(
    ("law", "rise", "fall", "base", "offset", "turns"),
    [
        ("polynomial-4567", "120", "0.00039", 20.0, 0.0, 1),
        ("cycloidal", "120", "0.00044", 20.0, 0.0, 1),
        ("polynomial-345", "120", "0.00031", 35.0, 0.0, 1),
        ("polynomial-345", "0.00018", "120", 50.0, 0.0, -1),
    ],
)
def test_a_swing_within_no_time_is_cut_to_the_half_planes(
    law: str, rise: str, fall: str, base: float, offset: float, turns: int
) -> None:
    pitch = snapped(law, rise, fall, base, offset, turns)
    outline = outline_of(pitch)
    start, span = (30.0, rise) if float(rise) < 1.0 else (190.0, fall)
    short = np.radians(start + float(span) * np.linspace(0.0, 1.0, 4001))
    phi = np.sort(np.concatenate((np.arange(0.0, TURN, STEP), short)))
    normal, distance = demanded(pitch, phi)
    _, corners = intersection(normal, distance)
    sampled = np.array([np.max((np.conj(n) * corners).real) for n in normal[::37]])
    actual = support(outline, pitch, phi)[::37]
    assert np.all(actual <= sampled + 1e-9 * np.max(distance))
    # What is between samples: at most a side of the disc times half a step of the normal.
    turned = np.max(np.abs(np.diff(np.unwrap(np.angle(normal)))))
    assert np.all(actual >= sampled - np.max(distance) * turned)


def test_what_too_fast_a_face_leaves_open_is_told_with_its_place() -> None:
    with pytest.raises(
        GeometryError, match=r"near cam angle 30\.000\d+ deg; give the move"
    ) as found:
        outline_of(snapped("polynomial-345", "0.00013", "120", 20.0, 8.0, -1))
    assert found.value.key == "motion"


def test_what_leaves_no_disc_is_refused() -> None:
    jumping = PitchCurve(
        MotionPlan((Move(Decimal(180), 10.0, make_law("straight-line")),
                    Move(Decimal(180), 0.0, make_law("straight-line")))),
        TranslatingFlat(40.0), 1,
    )  # fmt: skip
    with pytest.raises(UndercutError, match="can only touch a convex cam"):
        outline_of(jumping)
    with pytest.raises(GeometryError, match="inner flank"):
        replay_outline(jumping, real_outline(WorkingCurve(tappet(200.0), 0.0)).path)
