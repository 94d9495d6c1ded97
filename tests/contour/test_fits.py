"""Fits of arcs, of straight pieces and of cubics, fast ones and those of the fewest pieces.

Each is within its tolerance, proved, as smooth as its form can be, near its law, and never larger
for a looser tolerance.
"""

from __future__ import annotations

import itertools
import math
import pickle
from collections.abc import Callable
from decimal import Decimal
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError, UndercutError
from camgeo.geometry.contour import arcs as arcs_module
from camgeo.geometry.contour.arcs import Biarcs, PieceEnds, Strands, fewest_arcs, fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour, Fit, require_simple
from camgeo.geometry.contour.cubics import fewest_cubics, fit_spline
from camgeo.geometry.contour.fewest_chords import fewest_chords
from camgeo.geometry.contour.proof import deviation
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit
from camgeo.geometry.outline.path import Path, Pivot, Stretch, area, whole
from camgeo.geometry.pieces import smooth_pieces
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray, IntArray
from camgeo.part.boundaries import CurveBoundary
from camgeo.studies.accuracy.contours import forced_pieces, least_arcs, least_chords, least_cubics
from tests.contour.cams import TURN, curves, dwell, flank, move, outline
from tests.contour.cams import translating as cam
from tests.contour.paths import (
    FLANK_PATHS,
    OUTLINES,
    PATHS,
    SAGITTA,
    Dense,
    break_count,
    corner,
    curve_of,
    dense_of,
    hard_curve,
    shocks,
    swallow_tail,
)
from tests.laws import LAWS
from tests.long_form import examples
from tests.reference import hard_case
from tests.strategies import attack

Fitter = Callable[[Path, float], Any]

ARCS: tuple[Fitter, ...] = (fit_arcs, fewest_arcs)

CHORDS: tuple[Fitter, ...] = (fit_polyline, fewest_chords)

FITTERS = (*ARCS, *CHORDS)

FAST, FEWEST = (fit_arcs, fit_polyline), (fewest_arcs, fewest_chords)

CUBICS: tuple[Fitter, ...] = (fit_spline, fewest_cubics)

EVERY = (*FITTERS, *CUBICS)

each_fitter = pytest.mark.parametrize("fitter", FITTERS)

each_path = pytest.mark.parametrize("name", PATHS)

some = settings(attack, max_examples=examples(10, long=40))

SHARP = 0.05
"""Tolerance [mm] from which on tips of the paths are so sharp that only the angle of a chord
counts: there the limit, which counts sagittas alone, is none."""


PLACE = 1e-13
"""Rounding of a point of a curve some 100 mm from the axis: 8 ulp [mm]."""


def tangents(contour: Contour) -> tuple[ComplexArray, ComplexArray]:
    """Unit tangents at the start and at the end of each piece."""
    arm = contour.vertices - contour.centres
    chord = contour.ends - contour.vertices
    along: ComplexArray = np.where(contour.sweeps != 0.0, 1j * np.sign(contour.sweeps) * arm, chord)
    along /= np.abs(along)
    last: ComplexArray = along * np.exp(1j * contour.sweeps)
    return along, last


def check_tangent(contour: Contour, except_at: ComplexArray) -> None:
    """No corner: neighbours turn by no more than the rounding of end points over a piece."""
    first, last = tangents(contour)
    turns = np.abs(np.angle(np.roll(first, -1) * np.conj(last)))
    shorter = np.minimum(contour.lengths, np.roll(contour.lengths, -1))
    # Both tangents come from chords whose ends are PLACE off; an arc written as a line, with a
    # sagitta of up to 1e-10 mm, turns by 4e-10 over its length.
    lines = (contour.sweeps == 0.0) | (np.roll(contour.sweeps, -1) == 0.0)
    allowed = (2.0 * PLACE + np.where(lines, 8e-10, 0.0)) / shorter
    for place in except_at:
        allowed[np.argmin(np.abs(contour.ends - place))] = np.pi
    assert np.all(turns <= allowed)


def check_shared_ends(contour: Contour) -> None:
    """Each arc, turned about its centre by its sweep, meets the start of the next piece."""
    turned = contour.centres + (contour.vertices - contour.centres) * np.exp(1j * contour.sweeps)
    arcs = contour.sweeps != 0.0
    # A sweep of half the angle of tangent and chord carries PLACE / chord, times the radius.
    allowed = 8.0 * PLACE * (1.0 + contour.radii / np.maximum(contour.lengths, 1e-6))
    assert np.all((np.abs(turned - contour.ends) <= allowed)[arcs])


def strand_tangents(strand: CubicSpline | Arc) -> tuple[complex, complex]:
    """Unit tangents at both ends."""
    if isinstance(strand, CubicSpline):
        slope = curve_of(strand).derivative()
        first, last = complex(slope(strand.knots[0])), complex(slope(strand.knots[-1]))
    elif strand.sweep:
        sense = 1j * np.sign(strand.sweep)
        first, last = (sense * (end - strand.centre) for end in (strand.start, strand.end))
    else:
        first = last = strand.end - strand.start
    return first / abs(first), last / abs(last)


def check_smooth(contour: SplineContour, corners: int) -> None:
    """C2 inside by simple knots; tangent at all joints except for the corners."""
    turns = []
    for strand, after in zip(
        contour.strands, (*contour.strands[1:], contour.strands[0]), strict=True
    ):
        assert strand.end == after.start
        turns.append(abs(np.angle(strand_tangents(after)[0] / strand_tangents(strand)[1])))
        if isinstance(strand, CubicSpline):
            inner = strand.knots[4:-4]
            assert np.all(np.diff(strand.knots[3:-3]) > 0.0)
            assert np.all(strand.knots[:4] == 0.0)
            assert np.all(strand.knots[-4:] == strand.knots[-1])
            bend = curve_of(strand).derivative(2)
            nearby = 1e-9 * strand.knots[-1]
            jump = np.abs(bend(inner + nearby) - bend(inner - nearby))
            # The third derivative, constant in each span, times the way across the knot.
            middles = 0.5 * (strand.knots[3:-4] + strand.knots[4:-3])
            steepest = np.max(np.abs(curve_of(strand).derivative(3)(middles)))
            assert np.all(jump <= 2.0 * nearby * steepest + 1e-12)
    # A leg of a spline is 1e-3 mm long at least, its ends rounded to 1e-13 mm.
    assert sum(turn > 1e-9 for turn in turns) <= corners


@cache
def fitted(fitter: Fitter, name: str, tolerance: float) -> Any:
    """The fit of an outline, made once for all tests that use it."""
    return fitter(OUTLINES[name](), tolerance)


def check_fit(
    path: Path, exact: Dense, fit: Fit | SplineFit, tolerance: float, slack: float = 1.05
) -> None:
    assert fit.deviation <= tolerance == fit.tolerance
    found = exact.measured(fit.contour)
    assert found <= fit.deviation + SAGITTA
    # The proof's own slack is 1 %; dense sampling finds all but (1/100)^2 of a piece's bulge. To
    # this come the gaps at the feet: the distance times the sine of the angle between piece and
    # curve there, 0.03 where the coarsest arcs turn by a radian.
    assert fit.deviation <= slack * found + SAGITTA
    if isinstance(fit.contour, SplineContour):
        check_smooth(fit.contour, len(path.pivots))
    else:
        require_simple(fit.contour, "outline")
    # A strip as wide as the deviation along the whole length is all that the areas differ by.
    strip = fit.deviation * fit.contour.length
    assert fit.contour.area == pytest.approx(abs(area(path)), abs=strip, rel=0.0)


LIMITS: dict[Fitter, tuple[Callable[[Path, float], float], float, float, float, bool]] = {
    fit_arcs: (least_arcs, 1.0, 1.5, 2.0, True),
    fewest_arcs: (least_arcs, 0.95, 1.1, 2.0, False),
    # With vertices on the curve sqrt(2) of the limit, which lets them lie on the other side.
    fit_polyline: (least_chords, 1.4, 1.02 * math.sqrt(2.0), 2.0, False),
    fewest_chords: (least_chords, 0.99, 1.03, 1.0, False),
    fit_spline: (least_cubics, 0.0, 1.5, 3.0, True),
    fewest_cubics: (least_cubics, 0.0, 1.1, 3.0, True),
}
"""Of each fit the limit, the least and the largest share of it, what each break costs, and whether
pieces that are forced count beside."""


def allowed(fitter: Fitter, path: Path, tolerance: float) -> tuple[float, float]:
    """The least and the most pieces of a fit."""
    limit, least, most, each_break, beside = LIMITS[fitter]
    pieces, forced = limit(path, tolerance), forced_pieces(path) if beside else 0
    return forced + least * pieces, forced + most * pieces + each_break * break_count(path)


@pytest.mark.parametrize("tolerance", [0.02, 0.001])
@pytest.mark.parametrize("fitter", EVERY)
@pytest.mark.parametrize("name", OUTLINES)
def test_within_tolerance(name: str, fitter: Fitter, tolerance: float) -> None:
    # Chords on both sides of a curve turn more at their corners.
    slack = 1.06 if fitter is fewest_chords else 1.05
    fit = fitted(fitter, name, tolerance)
    check_fit(OUTLINES[name](), dense_of(name), fit, tolerance, slack)


@pytest.mark.parametrize("tolerance", [0.01, 0.001])
@pytest.mark.parametrize("name", FLANK_PATHS)
def test_bound_is_sharp_with_middles_off_the_curve(name: str, tolerance: float) -> None:
    """The middles of biarcs lie off the curve; across from them it leaves no gap."""
    fit = fitted(fit_arcs, name, tolerance)
    # 1 % is the proof's; dense sampling finds all but 1e-3 of a bulge of 100 points or more.
    assert fit.deviation <= 1.011 * dense_of(name).measured(fit.contour, 20_000) + SAGITTA


@some
@given(curves(), st.sampled_from([0.03, 0.002]), st.sampled_from(EVERY))
def test_any_cam(curve: WorkingCurve, tolerance: float, fitter: Fitter) -> None:
    """Breaks are joints, and a dwell is one arc about the axis."""
    path = whole(curve)
    fit = fitter(path, tolerance)
    check_fit(path, Dense.of(path), fit, tolerance)
    contour = fit.contour
    if fitter in CUBICS:
        return
    if fitter is not fewest_chords:
        for place in curve.point(curve.breaks):
            assert np.min(np.abs(contour.vertices - place)) <= PLACE
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    rests = [piece for piece in smooth_pieces(curve) if piece.dwell and fitter in ARCS]
    spans = sorted(piece.end - piece.start for piece in rests)
    assert sorted(contour.sweeps[about_axis].tolist()) == pytest.approx(spans, rel=1e-15)
    for piece in rests:
        radius = abs(curve.point(np.array([piece.start]))[0])
        assert np.min(np.abs(contour.radii[about_axis] - radius)) <= PLACE
    if fitter in ARCS:
        check_tangent(contour, np.empty(0, dtype=np.complex128))
        check_shared_ends(contour)
    else:
        assert contour.arc_count == 0


@pytest.mark.parametrize("tolerance", [0.1, 1e-5])
@pytest.mark.parametrize("fitter", ARCS)
@pytest.mark.parametrize("name", FLANK_PATHS)
def test_arcs_are_tangent_and_meet(name: str, fitter: Fitter, tolerance: float) -> None:
    contour = fitted(fitter, name, tolerance).contour
    check_tangent(contour, np.empty(0, dtype=np.complex128))
    check_shared_ends(contour)


# Numbers of pieces ------------------------------------------------------------------------------


@pytest.mark.parametrize("fitter", EVERY)
@pytest.mark.parametrize("name", FLANK_PATHS)
def test_counts_are_near_their_law(name: str, fitter: Fitter) -> None:
    """Pieces ~ tolerance^(-1/3) for G1 arcs, ^(-1/2) for chords, ^(-1/4) for cubics, and few of the
    fewest."""
    path = OUTLINES[name]()
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        least, most = allowed(fitter, path, tolerance)
        assert least <= len(fitted(fitter, name, tolerance).contour) <= most


@some
@given(
    curves(),
    st.floats(-5.0, -2.0),
    st.floats(1e-3, 0.3),
    st.sampled_from((*FITTERS, fewest_cubics)),
)
def test_counts_of_any_cam_are_near_their_law_and_never_grow(
    curve: WorkingCurve, size: float, step: float, fitter: Fitter
) -> None:
    path, counts = whole(curve), []
    for tolerance in (10.0 ** (size - k * step) for k in range(4)):
        least, most = allowed(fitter, path, tolerance)
        counts.append(len(fitter(path, tolerance).contour))
        assert least <= counts[-1] <= most
    assert counts == sorted(counts)


@pytest.mark.parametrize("name", FLANK_PATHS)
def test_arcs_with_turned_tangents_beat_the_curves_own(name: str) -> None:
    """Biarcs with the curve's own tangents need 0.2912 / 0.2002 of the limit and more."""
    path = OUTLINES[name]()
    count = len(fitted(fit_arcs, name, 1e-6).contour) - forced_pieces(path)
    # The ends of a piece cost 1.3 spans, a whole number half a span, in the mean: two pairs.
    assert count <= 1.1 * least_arcs(path, 1e-6) + 4.0 * break_count(path)


@pytest.mark.parametrize(
    ("fitter", "name"),
    [
        *itertools.product(FAST, FLANK_PATHS),
        *itertools.product(FEWEST, [name for name in OUTLINES if "clockwise" not in name]),
    ],
)
def test_counts_never_grow_with_the_tolerance(fitter: Fitter, name: str) -> None:
    path, counts = OUTLINES[name](), []
    for tolerance in np.geomspace(0.3, 1e-4, examples(12, long=40)).tolist():
        counts.append(len(fitter(path, tolerance).contour))
        if tolerance < SHARP and fitter in FEWEST:
            assert counts[-1] <= allowed(fitter, path, tolerance)[1]
    assert counts == sorted(counts)
    assert counts[0] < counts[-1]


@pytest.mark.parametrize("tolerance", [0.05, 1e-3, 1e-5])
@pytest.mark.parametrize("name", OUTLINES)
def test_the_fast_fits_never_need_fewer(name: str, tolerance: float) -> None:
    for fast, fewest in (ARCS, CHORDS):
        most = len(fitted(fast, name, tolerance).contour)
        assert len(fitted(fewest, name, tolerance).contour) <= most


@pytest.mark.parametrize("fitter", FEWEST)
@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_size_does_not_matter(size: float, fitter: Fitter) -> None:
    """A cam and a tolerance a thousand times as large ask for the same pieces."""

    def scaled(factor: float) -> Path:
        segments = dwell(40), move(140, 15.0 * factor), dwell(60), move(120, 0.0)
        return whole(cam(*segments, base=40.0 * factor, roller=8.0 * factor))

    for tolerance in (1e-2, 1e-4):
        one, other = fitter(scaled(1.0), tolerance), fitter(scaled(size), size * tolerance)
        assert len(one.contour) == len(other.contour)
        # Off by the same amount, except for rounding, which a tolerance of 1e-4 mm shows.
        assert other.deviation == pytest.approx(size * one.deviation, rel=1e-6)


def test_a_circle_needs_the_chords_that_geometry_demands() -> None:
    """cos(pi/n) = (r - u)/(r + u); the proof takes 1.15 % of the tolerance, u the rest.

    Moves by nothing are a circle as well: joints of the plan alone add none.
    """
    least = math.pi / (2.0 * math.asin(math.sqrt(1e-3 / 32.001)))
    still = cam(dwell(40), move(140, 0.0), dwell(60), move(120, 0.0))
    one, other = (
        len(fewest_chords(whole(each), 1e-3).contour) for each in (cam(dwell(360)), still)
    )
    assert least <= one == other <= 1.008 * least + 1.0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6])
@pytest.mark.parametrize("stroke", [1e-12, 1e-9, 1e-4])
def test_slight_strokes(stroke: float, tolerance: float) -> None:
    """Two arcs a move follow a stroke of less than the tolerance."""
    curve = cam(dwell(40), move(100, stroke), dwell(60), move(160, 0.0))
    contour = fewest_arcs(whole(curve), tolerance).contour
    assert len(contour) == 6 if stroke < tolerance else len(contour) <= 10
    check_tangent(contour, np.empty(0, dtype=np.complex128))


def test_a_move_of_a_millionth_of_a_radian() -> None:
    tiny = Decimal("0.00006")
    segments = (dwell(40), Move(Decimal(140) - tiny, 10.0, LAWS["polynomial-345"]))
    curve = cam(*segments, dwell(0), Move(tiny, 10.0, LAWS["straight-line"]), move(180, 0.0))
    contour = fewest_arcs(whole(curve), 1e-3).contour
    assert len(contour) <= len(fit_arcs(whole(curve), 1e-3).contour)
    check_tangent(contour, np.empty(0, dtype=np.complex128))


def test_no_arc_exceeds_half_a_turn_where_the_tolerance_is_as_wide_as_the_cam() -> None:
    """But for dwells, which are one arc of any sweep."""
    curve = cam(move(180, 12.0, "simple-sine"), move(180, 0.0, "simple-sine"))
    contour = fewest_arcs(whole(curve), 30.0).contour
    assert np.max(np.abs(contour.sweeps)) <= math.pi
    assert np.sum(contour.sweeps) == pytest.approx(TURN)


def test_attempts_that_do_not_help_are_few(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []

    def none(strands: Strands, pieces: IntArray, counts: IntArray) -> list[SimpleNamespace]:
        tried.append(int(np.sum(counts)))
        return [SimpleNamespace(deviation=math.inf) for _ in counts]

    monkeypatch.setattr(arcs_module, "arc_splines", none)
    monkeypatch.setattr(arcs_module, "LAID", 0)
    assert fewest_arcs(whole(flank("vorschub", -1)), 1e-2).deviation <= 1e-2
    assert len(tried) == 1


# Shapes -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(
    ("plan", "spans"),
    [
        ((dwell(30), move(100, 20.0), dwell(40), move(120, 0.0), dwell(70)), [100.0, 40.0]),
        ((dwell(250), move(60, 10.0), move(50, 0.0)), [250.0]),
        ((move(60, 10.0), dwell(200), move(50, 0.0), dwell(50)), [200.0, 50.0]),
        ((dwell(360),), [360.0]),
        ((dwell(100), dwell(0), dwell(260)), [360.0]),
    ],
)
def test_dwells_across_the_start_and_beyond_half_a_turn(
    plan: tuple[Any, ...], spans: list[float], rotation: int
) -> None:
    contour = fit_arcs(whole(cam(*plan, rotation=rotation)), 0.001).contour
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    found = sorted(np.degrees(contour.sweeps[about_axis]).tolist())
    assert found == pytest.approx(sorted(spans), rel=1e-15)


@each_fitter
def test_a_whole_turn_without_a_stroke(fitter: Fitter) -> None:
    """One smooth piece from a point to itself, whose chord has no length."""
    fit = fitter(whole(cam(move(360, 0.0))), 0.01)
    assert fit.deviation <= 0.01
    assert fit.contour.area == pytest.approx(math.pi * 32.0**2, abs=0.01 * 2.0 * math.pi * 32.0)


@pytest.mark.parametrize("fitter", [fit_arcs, fewest_arcs, fit_polyline])
def test_a_flank_that_runs_off_within_a_degree(fitter: Fitter) -> None:
    """A stroke in a quarter of a degree, too short for even samples of a turn."""
    segments = (
        Move(Decimal("0.255238"), 0.91154, LAWS["polynomial-4567"]), Dwell(Decimal("12.465865")),
        Move(Decimal("330.222967"), 0.0, LAWS["polynomial-345"]), Dwell(Decimal("17.05593")),
    )  # fmt: skip
    follower = OscillatingRoller(64.38 - 81.2j, 126.324, 73.39, 0.0105, -1, 1)
    path = whole(WorkingCurve(PitchCurve(MotionPlan(segments), follower, 1), -0.0105))
    fit = fitter(path, 0.07)
    # Placed anew, as when a file is read.
    assert deviation(path, fit.contour) <= 1.02 * fit.deviation <= 1.02 * 0.07


@some
@given(curves(), st.floats(0.0, TURN), st.floats(0.02, 0.3), st.integers(1, 6))
def test_distances_of_biarcs(curve: WorkingCurve, start: float, span: float, count: int) -> None:
    """The distance found from six places a span is that of dense samples, also where tangents are
    turned off the curve's own at the joints between."""
    breaks = np.concatenate([curve.breaks - TURN, curve.breaks, curve.breaks + TURN, [start + 9.0]])
    end = min(start + span, float(np.min(breaks[breaks > start + 1e-9])))
    joints = np.linspace(start, end, count + 1)
    ends = PieceEnds(*curve.traced(joints[-1:], "left"))
    biarcs = Biarcs.along(curve, joints, np.array([count]), ends)
    chain = biarcs.chain()
    points = curve.point(np.linspace(start, end, 4000)[:-1])
    contour = Contour(
        np.append(chain.vertices, biarcs.ends[-1]),
        np.append(chain.sweeps, 0.0),
        np.append(chain.centres, 0.0),
    )
    found = float(np.max(outline(contour).distances(points)))
    # Hermite's cubics leave 1/384 of the fourth derivative over a sixth of a span; what the proof
    # has in reserve is 1.5 %.
    assert np.max(biarcs.distances) == pytest.approx(found, rel=0.012, abs=1e-11)


@pytest.mark.parametrize("fitter", [fewest_arcs, fewest_chords, fit_spline, fewest_cubics])
def test_the_same_input_gives_the_same_bytes(fitter: Fitter) -> None:
    path = whole(flank("setzhub", -1))
    first = pickle.dumps(fitter(path, 1e-4).contour)
    fitter(whole(flank("ring", 1)), 1e-4)
    assert pickle.dumps(fitter(path, 1e-4).contour) == first


# Corners, turns and cusps -----------------------------------------------------------------------


def corners(path: Path) -> list[Pivot]:
    return [pivot for pivot in path.pivots if pivot.distance == 0.0]


@each_fitter
@each_path
def test_corners_are_vertices_and_the_only_ones(name: str, fitter: Fitter) -> None:
    path, contour = OUTLINES[name](), fitted(fitter, name, 1e-3).contour
    for pivot in corners(path):
        assert np.count_nonzero(contour.vertices == pivot.centre) == 1
    for pivot in path.pivots:
        assert np.any(contour.vertices == pivot.start)
        assert np.min(np.abs(contour.vertices - pivot.end)) <= PLACE
    if fitter in ARCS:
        check_tangent(contour, np.array([pivot.centre for pivot in corners(path)], dtype=complex))
        check_shared_ends(contour)


@each_path
def test_corners_turn_as_the_path_does(name: str) -> None:
    path, contour = OUTLINES[name](), fitted(fit_arcs, name, 1e-3).contour
    first, last = tangents(contour)
    turns = np.angle(np.roll(first, -1) * np.conj(last))
    for pivot in corners(path):
        k = int(np.argmin(np.abs(contour.ends - pivot.centre)))
        # Contours run counter-clockwise: against the path where the cam does.
        sense = -path.stretches[0].curve.pitch.rotation
        # Printed digits of crossing angles and points in place of exact ones: 1e-12.
        assert turns[k] == pytest.approx(sense * pivot.sweep, abs=1e-11)
        assert turns[k] > 0.0 or pivot.distance < path.stretches[0].curve.distance


@pytest.mark.parametrize(("side", "rotation"), [(-1, 1), (-1, -1), (1, 1), (1, -1)])
def test_turn_of_the_roller_is_one_exact_arc(side: int, rotation: int) -> None:
    path = shocks(side, rotation)
    (turn,) = (pivot for pivot in path.pivots if pivot.distance != 0.0)
    for tolerance in (0.02, 1e-4):
        contour = fit_arcs(path, tolerance).contour
        found = np.flatnonzero(contour.centres == turn.centre)
        assert len(found) == 1
        assert abs(contour.sweeps[found[0]]) == abs(turn.sweep)
        assert contour.radii[found[0]] == pytest.approx(8.0, rel=1e-15)


PLAIN = cam(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))


def test_dwell_cut_in_two_is_two_exact_arcs() -> None:
    start, end = math.radians(20.0), math.radians(200.0)
    path = Path((Stretch(PLAIN, start, end), Stretch(PLAIN, end, start + TURN)))
    contour = fit_arcs(path, 1e-3).contour
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    found = np.degrees(np.sort(contour.sweeps[about_axis]))
    # Each is a difference of two angles of at most 2 pi + 1, rounded once.
    assert found == pytest.approx([20.0, 20.0, 40.0, 40.0], abs=1e-13)
    assert contour.area == pytest.approx(fit_arcs(whole(PLAIN), 1e-3).contour.area, abs=0.2)


@pytest.mark.parametrize(
    "angle", [0.0, math.radians(60.0), math.nextafter(math.radians(60.0), 4.0)]
)
def test_corner_in_a_dwell_and_at_cam_angle_0(angle: float) -> None:
    """A stretch that begins at a break, and one that ends a rounding error beyond another."""
    point = complex(PLAIN.point(np.array([angle]))[0])
    end = corner(PLAIN, angle + TURN, angle, point)
    contour = fit_arcs(Path((Stretch(PLAIN, angle, angle + TURN), end)), 1e-3).contour
    assert len(contour) == len(fit_arcs(whole(PLAIN), 1e-3).contour)
    assert np.min(contour.lengths) > 0.1


@attack
@given(
    st.floats(-0.5, -1e-9) | st.floats(0.0, 14.0),
    st.sampled_from([0.01, 0.001]),
    st.sampled_from(FAST),
)
def test_parallels_round_the_corner(by: float, tolerance: float, fitter: Fitter) -> None:
    """As for a cutter; a parallel inside of the outline has no arc to go round the corner on."""
    path = swallow_tail().offset(by)
    if by < 0.0:
        with pytest.raises(UndercutError):
            fitter(path, tolerance)
        return
    fit = fitter(path, tolerance)
    assert Dense.of(path).measured(fit.contour, 2_000) <= fit.deviation + SAGITTA
    assert fit.deviation <= tolerance


@pytest.mark.parametrize("sweep", [1e-13, 1e-9, 1e-6, 1e-5])
def test_turn_too_small_for_a_piece(sweep: float) -> None:
    """An arc of less than a hundredth of the tolerance is a corner, also in a file read back."""
    tolerance, centre = 1e-3, complex(PLAIN.pitch.point(np.zeros(1))[0])
    path = Path((Stretch(PLAIN, 0.0, TURN), Pivot(centre, -8.0, 1j, sweep, TURN, 0.0)))
    fit = fit_arcs(path, tolerance)
    arcs = np.count_nonzero(fit.contour.centres == centre)
    assert arcs == (8.0 * sweep > 0.01 * tolerance)
    assert fit.deviation <= tolerance
    assert deviation(path, fit.contour) == pytest.approx(fit.deviation, rel=0.011, abs=1e-9)


@pytest.mark.parametrize("tolerance", [0.1, 0.01, 1e-3, 1e-5, 1e-6])
def test_curvature_without_bound(tolerance: float) -> None:
    """HC21a: 1 + d kappa touches zero, the curvature is infinite there and the tangent is not."""
    path, fit = OUTLINES["cusp"](), fitted(fit_arcs, "cusp", tolerance)
    assert fit.deviation <= tolerance
    check_tangent(fit.contour, np.empty(0, dtype=np.complex128))
    # As many arcs as for a parallel 1 mm farther out, which has no cusp, and a few more.
    plain = fit_arcs(path.offset(1.0), tolerance)
    assert len(fit.contour) <= 1.1 * len(plain.contour) + 8
    assert deviation(path, fit.contour) == pytest.approx(fit.deviation, rel=0.011, abs=1e-9)


@pytest.mark.parametrize("fitter", FAST)
def test_stretch_that_ends_in_its_cusp(fitter: Fitter) -> None:
    curve = hard_curve("HC21a")
    angle = math.radians(78.9790897521664912236687251744)
    stretch = Stretch(curve, angle, angle + TURN)
    end = corner(curve, angle + TURN, angle, complex(curve.point(np.array([angle]))[0]))
    for path in (Path((stretch,)), Path((stretch, end))):
        check_fit(path, Dense.of(path), fitter(path, 0.001), 0.001)


@pytest.mark.parametrize("tolerance", [1.0, 0.1])
@pytest.mark.parametrize("fitter", FAST)
def test_tips_sharper_than_the_tolerance(fitter: Fitter, tolerance: float) -> None:
    """Round the tip of a lobe the pieces must turn, however little they may deviate."""
    curve = hard_curve("HC21a")
    sharp = whole(WorkingCurve(curve.pitch, 0.9999 * curve.distance))
    fit = fitter(sharp, tolerance)
    assert Dense.of(sharp).measured(fit.contour) <= fit.deviation + SAGITTA <= tolerance + SAGITTA


# What cannot be fitted --------------------------------------------------------------------------


@pytest.mark.parametrize("fitter", EVERY)
def test_what_is_no_outline_is_refused(fitter: Fitter) -> None:
    """A curve torn apart by a shock, a lobe sharper at its tip than the roller, a swallow tail, and
    dwells shrunk to a point or beyond."""
    torn = cam(dwell(40), move(140, 15.0, "straight-line"), dwell(60), move(120, 0.0))
    with pytest.raises(GeometryError, match="gap at cam angle 40 degrees"):
        fitter(whole(torn), 0.001)
    segments = dwell(180), move(100, 1.0), move(80, 0.0)
    for curve in (
        cam(move(40, 20.0), move(40, 0.0), dwell(280), roller=20.0),
        hard_curve("HC21c"),
        cam(*segments, roller=40.0),
        cam(*segments, roller=41.0),
    ):
        with pytest.raises(UndercutError, match="cusp or undercut between cam angles"):
            fitter(whole(curve), 0.001)


@pytest.mark.parametrize(
    "fitter",
    # `fewest_arcs` falls back on the fast fit.
    [pytest.param(each, marks=[pytest.mark.long] * (each is fewest_arcs)) for each in EVERY],
)
def test_tolerance_beyond_arithmetic_is_refused(fitter: Fitter) -> None:
    with pytest.raises(ToleranceError, match="tolerance 1e-14 mm requested") as caught:
        fitter(whole(flank("querhub", -1)), 1e-14)
    assert caught.value.reached > caught.value.asked == 1e-14


@pytest.mark.parametrize("case", ["HC22", "HC22b"])
def test_global_undercut_is_refused(case: str) -> None:
    """Regular everywhere, yet two flanks cut each other off."""
    parameters, expected = hard_case(case)
    first, rise, rest, back, last = parameters["phi_H"]
    stroke, roller = float(parameters["s_H"]), float(parameters["r_R"])
    plan = dwell(first), move(rise, stroke), dwell(rest), move(back, 0.0), dwell(last)
    follower = TranslatingRoller(parameters["r_G"], roller)
    path = whole(WorkingCurve(PitchCurve(MotionPlan(plan), follower, 1), -roller))
    boundary = CurveBoundary("outline", False, path)
    for refused in (boundary.arcs, boundary.polyline):
        with pytest.raises(UndercutError, match="global undercut"):
            refused(0.01)
    # The crossing that is named lies where the reference has one of its two.
    with pytest.raises(UndercutError, match=r"outline crosses itself .*global undercut") as caught:
        require_simple(fit_arcs(path, 0.001).contour, "outline")
    place = caught.value.message.split("[")[1].split("]")[0].split()
    radius = abs(complex(float(place[0]), float(place[1])))
    # Chords of the test for simplicity lie 1e-5 of the outline's length off.
    assert min(abs(radius - float(each)) for each in expected["radial_position_mm"]) < 0.05


def test_arc_turned_inside_out_is_refused() -> None:
    path = shocks(-1, 1)
    fit_arcs(path.offset(7.99), 0.01)
    touching = path.offset(8.0)  # the turn has become a corner
    assert len(corners(touching)) == 1
    check_fit(touching, Dense.of(touching), fit_arcs(touching, 0.01), 0.01)
    for by in (8.01, 20.0, -0.01):
        with pytest.raises(UndercutError, match="turned inside out"):
            fit_arcs(path.offset(by), 0.01)


def test_path_without_a_stretch_is_refused() -> None:
    with pytest.raises(GeometryError, match="has no stretch"):
        fit_arcs(Path((Pivot(0j, 1.0, 1j, 1.0, 0.0, 0.0),)), 0.01)


@pytest.mark.parametrize("fitter", FAST)
def test_gap_between_elements_is_no_fit(fitter: Fitter) -> None:
    path = swallow_tail()
    (stretch,), (pivot,) = path.stretches, path.pivots
    moved = Pivot(
        pivot.centre + 0.1, 0.0, pivot.normal, pivot.sweep, pivot.phi_start, pivot.phi_end
    )
    with pytest.raises((GeometryError, ArithmeticError)):
        fitter(Path((stretch, moved)), 0.01)
