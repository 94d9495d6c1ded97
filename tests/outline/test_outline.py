"""The real outline: what is kept is clear of every roller, what is dropped is not; the outermost of
pieces over a turn; knife edges, whose flank is the pitch curve."""

from __future__ import annotations

import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.check.disc import check_standstill
from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError, UndercutError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline import outline
from camgeo.geometry.outline.envelope import KINK, Envelope, Node
from camgeo.geometry.outline.outline import (
    Outline,
    _undecided_angle,
    backward_ranges,
    find_crossings,
    flank_envelope,
    real_outline,
)
from camgeo.geometry.outline.path import Path, Pivot, Stretch, area
from camgeo.geometry.outline.replay import replay_contour, replay_outline
from camgeo.geometry.outline.roller import piece_numbers
from camgeo.geometry.pieces import stays_on_one_side
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, IntArray, ascending
from camgeo.part.boundaries import chord_fit
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.contour.cams import SCENES, dwell
from tests.laws import LAWS
from tests.long_form import examples
from tests.measuring import polygon
from tests.outline.clearing import corners, dense, distances
from tests.reference import hard_case, inner_of, pitch_curve_of, plan_of
from tests.strategies import (
    BENT,
    attack,
    linked_pitch_curves,
    near_dead_pitch_curves,
    pitch_curves,
    signs,
    wild_pitch_curves,
    with_roller,
)

ROUNDING = 2.0**-52 * 64.0
"""Of a distance between points that are sums of a few lengths, as a share of the largest."""


def outline_of(flank: WorkingCurve) -> Outline | None:
    """None where the engine says that nothing is left, or that Z' = 0."""
    try:
        return real_outline(flank)
    except GeometryError as error:
        if isinstance(error, UndercutError) or "stands still" in error.message:
            return None
        raise


def size_of(pitch: PitchCurve) -> float:
    points = pitch.point(np.linspace(0.0, TURN, 181))
    return float(np.max(np.abs(points))) + 2.0 * pitch.follower.roller_radius


def flank_of(pitch: PitchCurve, side: int) -> WorkingCurve:
    return WorkingCurve(pitch, side * pitch.follower.roller_radius)


@st.composite
def mechanisms(draw: st.DrawFn) -> PitchCurve:
    """Any mechanism, with a roller that may be far too large."""
    curve = draw(st.one_of(wild_pitch_curves(), pitch_curves(BENT), linked_pitch_curves(BENT)))
    if draw(st.booleans()):
        radius = draw(st.one_of(st.just(0.0), st.floats(1e-12, 0.9))) * curve.follower.base_radius
        return with_roller(curve, radius)
    return curve


def check_reached(pitch: PitchCurve, outline: Outline, rounding: float) -> None:
    """No roller reaches what is kept, and each point of the outline is touched by one."""
    radius = pitch.follower.roller_radius
    for path in (outline.path, *outline.lobes):
        assert np.min(distances(pitch, dense(path, 24))) >= radius - rounding
    assert np.max(distances(pitch, dense(outline.path, 5))) <= radius + rounding


@attack
@given(mechanisms(), signs())
def test_no_roller_reaches_what_is_kept(pitch: PitchCurve, side: int) -> None:
    outline = outline_of(flank_of(pitch, side))
    if outline is not None:
        check_reached(pitch, outline, ROUNDING * size_of(pitch))


@pytest.mark.parametrize(
    ("laws", "spans", "stroke", "base", "roller", "rotation"),
    [
        (("straight-line", "quadratic-parabola"), (85, 79, 26), 38.22, 21.1, 14.92, 1),
        (("simple-sine", "straight-line"), (97, 13, 119), 38.32, 18.39, 13.83, -1),
        (("simple-sine", "straight-line"), (110, 58, 23), 6.48, 33.17, 22.22, 1),
        (("straight-line", "quadratic-parabola"), (64, 26, 13), 25.58, 38.09, 33.67, -1),
    ],
)
def test_undercut_that_meets_a_turn_about_a_corner(
    laws: tuple[str, str],
    spans: tuple[int, int, int],
    stroke: float,
    base: float,
    roller: float,
    rotation: int,
) -> None:
    """Both run back: they are one range, beside a shock."""
    first, rise, back = map(Decimal, spans)
    plan = MotionPlan(
        (
            Dwell(first),
            Move(rise, stroke, LAWS[laws[0]]),
            Move(back, 0.0, LAWS[laws[1]]),
            Dwell(360 - first - rise - back),
        )
    )
    pitch = PitchCurve(plan, TranslatingRoller(base, roller), rotation)
    flank = flank_of(pitch, -1)
    outline = real_outline(flank)
    check_reached(pitch, outline, ROUNDING * size_of(pitch))
    assert outline.dropped
    envelope = flank_envelope(flank)
    ranges = backward_ranges(envelope)
    turns = envelope.starts[envelope.is_pivot]
    assert any(np.any((turns - low) % envelope.total < high - low) for low, high in ranges)
    places = (np.arange(4000) + 0.5) * envelope.total / 4000
    inside = np.zeros(4000, dtype=bool)
    for low, high in ranges:
        inside |= (places - low) % envelope.total < high - low
    pace = envelope.samples(places).pace
    sure = np.abs(pace) > 1e-9
    assert np.array_equal(inside[sure], pace[sure] < 0.0)


@settings(attack, max_examples=examples(8, long=40))
@given(near_dead_pitch_curves(), signs())
def test_nor_does_one_next_to_a_dead_centre(pitch: PitchCurve, side: int) -> None:
    """Here the rounding of the linkage's lengths is amplified a thousandfold."""
    try:
        outline = outline_of(flank_of(pitch, side))
    except GeometryError as error:
        if "crosses itself" not in error.message:
            raise
        return
    if outline is not None:
        check_reached(pitch, outline, 1e3 * ROUNDING * size_of(pitch))


@attack
@given(wild_pitch_curves(), signs())
def test_a_roller_covers_what_is_dropped(pitch: PitchCurve, side: int) -> None:
    flank = flank_of(pitch, side)
    outline = outline_of(flank)
    if outline is None:
        return
    radius, lobes = pitch.follower.roller_radius, outline.lobes
    for start, end in outline.dropped:
        phi = start + (end - start) * np.linspace(0.0, 1.0, 41)[1:-1]
        phi = phi[~_on(phi, lobes)]
        away = distances(pitch, flank.point(phi))
        assert np.all(away <= radius + ROUNDING * size_of(pitch))
        middle = np.abs(phi - 0.5 * (start + end)) < 0.1 * (end - start)
        if end - start > 0.05:
            assert np.all(away[middle] < radius * (1.0 - 1e-12))


def _on(phi: FloatArray, lobes: tuple[Path, ...]) -> np.ndarray:
    """Whether cam angles belong to what is cut off, which no roller covers."""
    inside = np.zeros(len(phi), dtype=bool)
    for lobe in lobes:
        for stretch in lobe.stretches:
            inside |= (phi - stretch.start) % TURN <= stretch.end - stretch.start
    return inside


@attack
@given(wild_pitch_curves(), signs())
def test_the_path_is_closed_and_simple(pitch: PitchCurve, side: int) -> None:
    outline = outline_of(flank_of(pitch, side))
    if outline is None:
        return
    for path in (outline.path, *outline.lobes):
        ends = [(_start(each), _end(each)) for each in path.elements]
        for (_, end), (start, _) in zip(ends, [*ends[1:], ends[0]], strict=True):
            # A crossing of branches that differ by an angle is known to rounding over its sine.
            sharpest = min([abs(math.sin(p.sweep)) for p in corners(path)], default=1.0)
            known = 16.0 * ROUNDING * size_of(pitch) / max(sharpest, 1e-3)
            # Corners of the pitch curve of less than KINK are taken for rounding.
            assert abs(end - start) <= known + KINK * pitch.follower.roller_radius
        for pivot in corners(path):
            # Material ends in a point there: the path turns on the way it goes round.
            assert pivot.sweep * -pitch.rotation * -side > 0.0
    points = dense(outline.path, 33)
    assert polygon(points).is_valid or area(outline.path) == pytest.approx(
        polygon(points).buffer(0).area * math.copysign(1.0, area(outline.path)), rel=1e-2
    )


def _start(element: Stretch | Pivot) -> complex:
    if isinstance(element, Pivot):
        return element.start
    return complex(element.curve.point(np.array([element.start]))[0])


def _end(element: Stretch | Pivot) -> complex:
    if isinstance(element, Pivot):
        return element.end
    return complex(element.curve.point(np.array([element.end]), "left")[0])


@attack
@given(pitch_curves(), signs())
def test_a_mild_cam_is_left_whole(pitch: PitchCurve, side: int) -> None:
    flank = flank_of(pitch, side)
    margin = np.min(flank.regularity(np.linspace(0.0, TURN, 721)))
    outline = outline_of(flank)
    if margin > 0.5 and outline is not None and not find_crossings(flank):
        assert outline.path.is_whole
        assert outline.dropped == ()
        assert outline.lobes == ()


def test_a_neck_that_all_but_closes_is_found_open_or_closed() -> None:
    """Half the width of HC22's neck is the roller radius at which its lobe is cut off."""
    params, _ = hard_case("HC22")
    limit = 13.53091360897672  # half the chord that is square to the pitch curve at both ends
    for share in (1e-3, 1e-6, 1e-9, 1e-12):
        for sign in (-1.0, 1.0):
            changed = params | {"kappa": 1, "r_R": limit * (1.0 + sign * share)}
            outline = real_outline(inner_of(pitch_curve_of(changed)))
            assert len(outline.lobes) == (1 if sign > 0.0 else 0)
            assert outline.is_trimmed == (sign > 0.0)
            if sign > 0.0:
                ((start, end),) = outline.dropped
                # The flanks cross as far from the neck as the root of what they overlap.
                assert end - start == pytest.approx(
                    math.radians(73.608617661), abs=4.0 * math.sqrt(share)
                )


def test_a_pitch_curve_that_crosses_itself_is_refused() -> None:
    """The roller centre passes the foot of its guide: the same places in the cam come again."""
    plan = plan_of({"phi_H": [30, 60, 40, 80, 150]}, 60.0)
    pitch = PitchCurve(plan, TranslatingRoller(30.0, 2.0, 10.0, direction=-1), 1)
    assert not stays_on_one_side(pitch)
    for side in (-1, 1):
        with pytest.raises(GeometryError, match="crosses itself at cam angles") as raised:
            real_outline(flank_of(pitch, side))
        words = raised.value.message.split()
        place = words.index("angles")
        angles = np.radians([float(words[place + 1]), float(words[place + 3])])
        one, two = pitch.point(angles)
        # The message gives six decimals of a degree.
        assert abs(one - two) < 2.0 * np.radians(1e-6) * float(np.max(np.abs(pitch.jet(angles)[1])))


def test_a_rocker_that_passes_the_line_of_centres_may_leave_a_simple_curve() -> None:
    params, _ = hard_case("HC27")
    pitch = pitch_curve_of(params | {"r_R": 5.0})
    assert not stays_on_one_side(pitch)
    assert real_outline(inner_of(pitch)).path.is_whole


@attack
@given(wild_pitch_curves())
def test_on_one_side_of_the_axis_no_pitch_curve_crosses_itself(pitch: PitchCurve) -> None:
    try:
        if stays_on_one_side(pitch):
            assert find_crossings(WorkingCurve(pitch, 0.0)) == ()
    except GeometryError as error:
        if "stands still" not in error.message:
            raise


def test_a_corner_of_the_pitch_curve_is_rounded_by_the_roller() -> None:
    """A straight-line rise: the roller turns at its foot, and its top is a corner of the disc."""
    line = LAWS["straight-line"]
    plan = MotionPlan(
        (
            Dwell(Decimal(90)),
            Move(Decimal(90), 20.0, line),
            Dwell(Decimal(90)),
            Move(Decimal(90), 0.0, line),
        )
    )
    pitch = PitchCurve(plan, TranslatingRoller(40.0, 8.0), 1)
    outline = real_outline(WorkingCurve(pitch, -8.0))
    rounded = [p for p in outline.path.pivots if p.distance != 0.0]
    assert {round(math.degrees(p.phi_end)) for p in rounded} == {90, 0}
    for pivot in rounded:
        assert abs(pivot.distance) == 8.0
        assert pivot.centre == pytest.approx(
            complex(pitch.point(np.array([pivot.phi_end]))[0]), abs=1e-12
        )
    tops = corners(outline.path)
    assert len(tops) == 2
    away = distances(pitch, np.array([p.centre for p in tops]))
    assert away == pytest.approx(8.0, abs=1e-11)


def test_clearance_sees_a_roller_that_covers() -> None:
    """The oracle of this module can fail: the whole working curve of HC21c is not clear."""
    params, _ = hard_case("HC21c")
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    phi = np.radians(np.linspace(74.0, 83.0, 19))
    away = distances(flank.pitch, flank.point(phi))
    assert np.min(away) < -flank.distance - 1e-3


@pytest.mark.parametrize("roller", [3.0, 7.5, 9.5])
@pytest.mark.parametrize("stroke", [1.0, 1e-3, 1e-6, 3e-7])
@pytest.mark.parametrize("side", [-1, 1])
def test_the_slightest_shock_leaves_one_corner_on_each_flank(
    roller: float, stroke: float, side: int
) -> None:
    """Up and down by straight lines: one shock is a corner inside, the other one outside."""
    line = LAWS["straight-line"]
    up, down = Move(Decimal(180), stroke, line), Move(Decimal(180), 0.0, line)
    pitch = PitchCurve(MotionPlan((up, down)), TranslatingRoller(10.0, roller), 1)
    outline = real_outline(flank_of(pitch, side))
    (corner,) = corners(outline.path)
    assert len(outline.path.elements) == 4
    ((start, end),) = outline.dropped
    place = math.pi if side < 0 else TURN
    assert start < place < end
    # The velocity jumps by 2 s/pi: the tangents turn by that over the distance from the axis.
    jump = 2.0 * math.atan2(stroke / math.pi, 10.0 + (stroke if side < 0 else 0.0))
    away = distances(pitch, np.array([corner.centre]))
    assert away == pytest.approx(roller, abs=ROUNDING * size_of(pitch))
    assert 0.5 * jump < abs(corner.sweep) < 40.0 * jump


def test_what_is_not_decided_has_a_place() -> None:
    """The first range that runs back without a crossing about it, also across the turn's end."""
    envelope = Envelope(inner_of(pitch_curve_of({"kappa": 1, **hard_case("HC21c")[0]})))
    backward = [(1.0, 1.2), (6.2, 6.4), (3.0, 3.2)]
    about = (Node(0.9, 1.3, 0j), Node(0.2, 6.1, 0j))
    assert _undecided_angle(envelope, backward, about) == pytest.approx(math.degrees(3.1))
    assert _undecided_angle(envelope, backward[:2], about) == pytest.approx(math.degrees(0.9))


ranges = st.lists(
    st.tuples(st.integers(0, 359), st.integers(1, 359)), min_size=1, max_size=8, unique=True
)
"""Starts and widths [deg] of the ranges of pieces, each higher than the one before."""


def outermost(low: FloatArray, width: FloatArray) -> tuple[FloatArray, IntArray]:
    """Borders and the piece from each on; piece k has the height k."""
    high = (low + width) % TURN
    nodes = ascending(np.concatenate((low, high)))
    cells = outline.AngleCells.from_nodes(nodes)
    first = np.searchsorted(nodes, low)
    count = np.remainder(np.searchsorted(nodes, high) - first, len(nodes))
    cell, piece = outline.cover_cells(cells, first, count, "its pieces overlap")
    kept = outline.visible_pieces(cell, piece.astype(float), piece.astype(float))
    borders, parent, held = outline.outermost(
        cells, (cell[kept], piece[kept]), np.empty(0), lambda which, _: which.astype(float)
    )
    assert np.array_equal(parent, np.arange(len(nodes)))
    return outline.changes(borders, held)


@given(ranges)
def test_the_highest_piece_at_every_angle(degrees: list[tuple[int, int]]) -> None:
    low, width = np.radians(np.array(degrees, dtype=np.float64)).T
    borders, held = outermost(low, width)
    between = np.radians(np.arange(360.0) + 0.5)
    covers = (between - low[:, None]) % TURN < width[:, None]
    highest = [int(np.flatnonzero(each)[-1]) if each.any() else outline.NONE for each in covers.T]
    for turn in (-TURN, 0.0, TURN):
        assert piece_numbers(borders, held, between + turn, "right").tolist() == highest
    before = piece_numbers(borders, held, borders, "left")
    assert np.array_equal(before, np.roll(held, 1))


def test_all_pairs_in_one_cell() -> None:
    cell = np.array([0, 0, 0, 2, 3, 3])
    found = {
        pair for one, other in outline.pairs_in_cells(cell) for pair in zip(one, other, strict=True)
    }
    assert found == {(0, 1), (1, 2), (0, 2), (4, 5)}


def test_too_many_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three pieces over three of six cells each: nine pairs, as many as may be, and no more."""
    low, width = np.array([0.0, 0.1, 0.2]), np.array([6.0, 6.0, 6.0])
    monkeypatch.setattr(outline, "MOST_PAIRS", 9)
    assert outermost(low, width)[1].tolist() == [0, 1, 2, outline.NONE]
    monkeypatch.setattr(outline, "MOST_PAIRS", 8)
    with pytest.raises(GeometryError, match="its pieces overlap in 2 layers; smooth it first"):
        outermost(low, width)


SCENE = SCENES / "knife_edge.toml"


@attack
@given(curve=wild_pitch_curves(), side=signs())
def test_nothing_is_cut_off_whatever_the_motion(curve: PitchCurve, side: int) -> None:
    """1 + 0 kappa never vanishes; with shocks the corners stand where the velocity jumps."""
    edge = with_roller(curve, 0.0)
    assume(not check_standstill(edge))
    outline = real_outline(WorkingCurve(edge, math.copysign(0.0, side)))
    assert not outline.is_trimmed
    assert outline.lobes == ()
    assert all(each.distance == 0.0 for each in outline.path.pivots)
    replay = replay_outline(edge, outline.path)
    assert replay.press == side
    assert replay.largest_error.value == 0.0
    assert len(replay.drops) == 0


def test_on_a_polygon_the_edge_rides_along_its_sides() -> None:
    """The height of the polygon's side over the angle, exactly; no arcs about its vertices."""
    follower = TranslatingRoller(40.0, 0.0)
    curve = PitchCurve(MotionPlan((dwell(360),)), follower, 1)
    polygon = chord_fit(Contour.circle(40.0), 0.5).contour
    replay = replay_contour(curve, polygon, "inner")
    ends = polygon.vertices
    half = 0.5 * abs(ends[1] - ends[0])
    apothem = math.sqrt(abs(ends[0]) ** 2 - half**2)
    width = 2.0 * math.asin(half / abs(ends[0]))
    around = np.angle(1j * np.exp(-1j * replay.phi) / ends[0]) % width
    height = apothem / np.cos(around - 0.5 * width)
    # The lift is a difference of lengths of 40 mm, the angles are rounded to some ulp of a turn.
    assert np.max(np.abs(replay.actual[0] + 40.0 - height)) < 1e-12
    assert len(replay.shocks) == len(ends)
    inside = replay_contour(curve, polygon, "outer")
    assert np.max(np.abs(inside.actual[0] - replay.actual[0])) < 1e-12


def with_motion(motion: str) -> Design:
    text = SCENE.read_text("utf-8")
    first, last = text.index("[[motion]]"), text.index("[limits]")
    return Design(parse_scene(text[:first] + motion + text[last:]))


CONCAVE = """[[motion]]
dwell = 100
[[motion]]
law = "straight-line"
span = 130
to = 10
[[motion]]
law = "modified-sine"
span = 130
to = 0
"""


def test_a_concave_corner_is_drawn_and_no_cutter_makes_it() -> None:
    """Where the edge sets out from rest with a jump."""
    design = with_motion(CONCAVE)
    assert design.judgement.has_outline
    fit = design.disc.drawn.part.boundaries[0].arcs(1e-3)
    assert fit.deviation <= 1e-3
    corner = complex(design.cam.disc.pitch_curve.point(np.array([math.radians(100.0)]))[0])
    assert np.min(np.abs(fit.contour.vertices - corner)) <= 1e-12
    with pytest.raises(SceneError, match="a concave part of it") as caught:
        design.disc.milled.toolpath(1e-3)
    assert [fault.key for fault in caught.value.faults] == ["tool[1]"]


def test_the_check_states_that_any_curvature_fits() -> None:
    design = camgeo.load(SCENE)
    (found,) = (f for f in design.findings if f.name == "radius-ratio-inner")
    assert (found.severity, found.value) == ("ok", 0.0)
    assert "knife edge" in found.sentence
    assert design.judgement.cures == ()
    assert design.disc.pictured.trimmed_stretches == ()


@pytest.mark.parametrize(("base", "offset"), [("30", "3"), ("10", "0"), ("3", "0")])
def test_a_sharp_corner_has_an_outline(base: str, offset: str) -> None:
    """However far it turns about the corner: 23, 37 and 47 degrees."""
    text = SCENE.read_text("utf-8").replace("base_radius = 30", f"base_radius = {base}")
    design = Design(parse_scene(text.replace("offset = 3", f"offset = {offset}"), str(SCENE)))
    assert {each.severity for each in design.findings} <= {"ok", "warning", "broken"}
    assert len(design.cam.disc.inner_outline.path.pivots) == 1
