"""The proof of a contour is attacked: it must detect all damage, or refuse the contour.

So are corners of trimmed outlines, vertices off the curve, and contours that contradict themselves.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour import proof
from camgeo.geometry.contour.arcs import fewest_arcs, fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.proof import deviation, locate
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path, whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray
from tests.contour.cams import TURN, curves, dwell, polyline
from tests.contour.paths import (
    FLANK_PATHS,
    OUTLINES,
    PATHS,
    SAGITTA,
    dense_of,
    dense_path,
    hard_curve,
)
from tests.contour.test_circles import eccentric
from tests.findings import known
from tests.laws import LAWS
from tests.long_form import examples
from tests.strategies import attack

TOLERANCE = 0.01

TRIMMED = tuple(name for name in PATHS if name != "cusp")

FIRST = next(iter(FLANK_PATHS))

some = settings(attack, max_examples=examples(10, long=30))

names = st.sampled_from((*FLANK_PATHS, *TRIMMED))

flanks = st.sampled_from(tuple(FLANK_PATHS))

each_flank = pytest.mark.parametrize("name", FLANK_PATHS)

each_trimmed = pytest.mark.parametrize("name", TRIMMED)


@cache
def fitted(name: str, straight: bool = False, tolerance: float = TOLERANCE) -> Contour:
    contour: Contour = (fit_polyline if straight else fit_arcs)(OUTLINES[name](), tolerance).contour
    return contour


def caught(name: str, contour: Contour) -> float:
    """The bound, compared with dense sampling; infinite if the contour is refused."""
    try:
        bound = deviation(OUTLINES[name](), contour)
    except GeometryError:
        return np.inf
    assert bound >= dense_of(name).measured(contour, 4_000) - SAGITTA
    return bound


def repeated(contour: Contour, times: int) -> Contour:
    return Contour(*(np.tile(each, times) for each in parts_of(contour)))


def rolled(contour: Contour, start: int) -> Contour:
    return Contour(*(np.roll(each, start) for each in parts_of(contour)))


def parts_of(contour: Contour) -> tuple[Any, Any, Any]:
    return contour.vertices, contour.sweeps, contour.centres


def corner_index(name: str, contour: Contour) -> int:
    (corner,) = (pivot.centre for pivot in OUTLINES[name]().pivots if pivot.distance == 0.0)
    return int(np.argmin(np.abs(contour.vertices - corner)))


# Single vertices and pieces ---------------------------------------------------------------------


@some
@given(names, st.booleans(), st.integers(0, 10**6), st.floats(-5.0, 1.3), st.floats(0.0, TURN))
def test_moved_vertex(name: str, straight: bool, index: int, size: float, angle: float) -> None:
    contour = fitted(name, straight)
    vertices = contour.vertices.copy()
    vertices[index % len(vertices)] += 10.0**size * complex(np.cos(angle), np.sin(angle))
    caught(name, Contour.through(vertices, contour.sweeps))


@some
@given(
    st.sampled_from(TRIMMED),
    st.booleans(),
    st.floats(-4.0, 0.5),
    st.floats(0.0, TURN),
    st.integers(-2, 2),
)
def test_moved_corner(name: str, straight: bool, size: float, angle: float, which: int) -> None:
    contour = fitted(name, straight)
    vertices = contour.vertices.copy()
    k = (corner_index(name, contour) + which) % len(vertices)
    vertices[k] += 10.0**size * np.exp(1j * angle)
    bound = caught(name, Contour.through(vertices, contour.sweeps))
    if which == 0 and straight:
        # Moved along one of its chords it is off by the sine of the corner's turn from the exact
        # way on, 0.12 at least for all of these.
        assert bound >= 0.1 * 10.0**size - TOLERANCE or bound == np.inf


@some
@given(
    flanks,
    st.sampled_from([1e-1, 1e-2]),
    st.integers(0, 2**32 - 1),
    st.sampled_from([-1.0, 0.0, 1.0]),
    st.booleans(),
)
def test_vertices_off_the_curve(
    name: str, tolerance: float, seed: int, side: float, straight: bool
) -> None:
    """Arcs and chords with vertices off by the tolerance, on one side or on both."""
    contour = fitted(name, straight, tolerance)
    chord = np.roll(contour.vertices, -1) - np.roll(contour.vertices, 1)
    signs = np.random.default_rng(seed).uniform(-1.0, 1.0, len(contour))
    off = tolerance * np.where(side == 0.0, np.sign(signs), side)
    # Mostly across, a little along.
    moved = contour.vertices + chord / np.abs(chord) * (1j * off + 0.1 * tolerance * signs)
    other = Contour.through(moved, contour.sweeps)
    # A vertex counts as far as it is off, 1 % more, and a step along that is a tenth of it;
    # corners are hit by the samples to their distance from them times the turn of a piece.
    assert caught(name, other) <= 1.05 * dense_of(name).measured(other, 10_000) + SAGITTA


def test_a_vertex_moved_along_the_curve_is_seen() -> None:
    """Two chords in line where the curve is straight: the distance across is nothing."""
    contour = fitted(FIRST, straight=True)
    for index in range(0, len(contour), 50):
        vertices = contour.vertices.copy()
        vertices[index] += 0.3 * (vertices[(index + 1) % len(vertices)] - vertices[index])
        assert caught(FIRST, polyline(vertices)) < np.inf


@some
@given(flanks, st.integers(0, 10**6), st.floats(-6.0, 0.5), st.sampled_from([1.0, -1.0]))
def test_changed_bulge(name: str, index: int, size: float, sign: float) -> None:
    contour = fitted(name)
    sweeps = contour.sweeps.copy()
    index %= len(sweeps)
    sweeps[index] = np.clip(sweeps[index] + sign * 10.0**size, -6.2, 6.2)
    caught(name, Contour.through(contour.vertices, sweeps))


@each_flank
def test_arcs_reversed_or_run_the_long_way_round(name: str) -> None:
    """Between the same ends; the long way round on the same circle, so only the sweep differs."""
    contour = fitted(name)
    for index in np.flatnonzero(contour.sweeps)[::9]:
        sweep, radius = contour.sweeps[index], contour.radii[index]
        sweeps = contour.sweeps.copy()
        sweeps[index] = -sweep
        # Its middle is now two sagittas off; where that is nothing, so is the damage.
        sagitta = radius * (1.0 - np.cos(0.5 * sweep))
        bound = caught(name, Contour.through(contour.vertices, sweeps))
        assert bound >= 2.0 * sagitta - TOLERANCE
        for turns in (-TURN, TURN):
            sweeps[index] = sweep + turns * np.sign(sweep)
            damaged = Contour(contour.vertices, sweeps, contour.centres)
            # From the middle of the arc there to the other side of its circle.
            assert caught(name, damaged) > min(1.0, radius)


@some
@given(names, st.booleans(), st.integers(0, 10**6), st.integers(1, 40))
def test_left_out_vertices(name: str, straight: bool, start: int, count: int) -> None:
    """The gap is closed by the piece before it."""
    contour = fitted(name, straight)
    keep = (np.arange(len(contour)) - start) % len(contour) >= min(count, len(contour) - 3)
    caught(name, Contour.through(contour.vertices[keep], contour.sweeps[keep]))


@pytest.mark.parametrize("straight", [False, True])
@each_trimmed
def test_corner_cut_off(name: str, straight: bool) -> None:
    """The corner left out: its neighbours joined by a straight piece, or by the arc there was."""
    contour = fitted(name, straight)
    k = corner_index(name, contour)
    keep = np.arange(len(contour)) != k
    arcs, lines = contour.sweeps.copy(), contour.sweeps.copy()
    lines[k - 1] = 0.0
    for sweeps in (arcs, lines):
        cut = Contour.through(contour.vertices[keep], sweeps[keep])
        far = float(np.min(np.abs(cut.points(1e-4) - contour.vertices[k])))
        assert caught(name, cut) >= min(far, 0.05)


def test_arc_whose_end_is_off_its_circle() -> None:
    """A contour may contradict itself: centre and end of an arc do not fit together."""
    path, contour = OUTLINES["inner shocks"](), fitted("inner shocks")
    for index in np.flatnonzero(contour.sweeps)[::5]:
        centres = contour.centres.copy()
        arm = contour.vertices[index] - centres[index]
        centres[index] += 0.1 * arm / abs(arm)
        damaged = Contour(contour.vertices, contour.sweeps, centres)
        about = centres[index]
        off = abs(abs(contour.ends[index] - about) - abs(contour.vertices[index] - about))
        try:
            assert deviation(path, damaged) >= off - 1e-12
        except GeometryError:
            continue


# All of it --------------------------------------------------------------------------------------


@some
@given(names, st.booleans(), st.floats(-4.0, 1.0), st.floats(0.0, TURN))
def test_shift_of_the_whole(name: str, straight: bool, size: float, angle: float) -> None:
    contour = fitted(name, straight)
    step = 10.0**size * complex(np.cos(angle), np.sin(angle))
    moved = np.where(contour.sweeps != 0.0, contour.centres + step, 0.0)
    bound = caught(name, Contour(contour.vertices + step, contour.sweeps, moved))
    # A closed curve has normals in all directions: somewhere the shift is all distance, or a
    # nearer part of the curve comes in between, which the first of its curvature bounds allow.
    assert bound >= 0.9 * abs(step) - TOLERANCE


@pytest.mark.parametrize(
    ("factor", "off"), [(1.0 / 25.4, 20.0), (0.5, 21.5), (0.99, 0.43), (1.01, 0.43), (2.0, 43.0)]
)
def test_scaled_and_in_inches(factor: float, off: float) -> None:
    contour = fitted(FIRST)
    scaled = Contour(factor * contour.vertices, contour.sweeps, factor * contour.centres)
    # 50 mm of base radius, 7 mm roller: the dwell lies at 43.2 mm from the axis.
    assert caught(FIRST, scaled) >= off


@each_trimmed
def test_other_outlines_are_caught(name: str) -> None:
    others = [dense_path(PATHS[other](), 500) for other in TRIMMED]
    own = TRIMMED.index(name)
    for points in (*others[:own], *others[own + 1 :], *map(np.conj, others)):
        assert caught(name, polyline(points)) > 0.1


def test_foreign_contours_are_refused_or_far() -> None:
    for contour in (
        Contour.circle(40.0),
        Contour.circle(1.0, 100.0 + 0j),
        fitted("ring"),
        polyline(np.array([0j, 50.0, 50j])),
    ):
        assert caught(FIRST, contour) > 1.0


def test_lobes_and_tails_left_on_are_caught() -> None:
    curve = hard_curve("HC21c")
    for count in (720, 3_600, 36_000):
        points = curve.point(np.linspace(0.0, TURN, count, endpoint=False))
        # The tail reaches 0.09 mm beyond the crossing.
        assert caught("swallow tail", polyline(points)) > 0.05
    untrimmed = fit_arcs(whole(hard_curve("HC22")), TOLERANCE).contour
    assert caught("cut-off lobe", untrimmed) > 50.0
    lobe = untrimmed.vertices[np.abs(untrimmed.vertices) > 29.0]
    assert caught("cut-off lobe", polyline(lobe)) > 10.0


@pytest.mark.parametrize("name", [FIRST, "swallow tail"])
def test_twice_round_is_refused(name: str) -> None:
    with pytest.raises(GeometryError, match="once round"):
        deviation(OUTLINES[name](), repeated(fitted(name), 2))


def test_there_and_back_is_refused() -> None:
    """A detour along the curve itself and back again encloses nothing but is no outline."""
    vertices = fitted(FIRST, straight=True).vertices
    detour = np.concatenate((vertices[:20], vertices[18:10:-1], vertices[11:]))
    with pytest.raises(GeometryError, match="once round"):
        deviation(OUTLINES[FIRST](), polyline(detour))


def test_stretch_left_out_is_refused() -> None:
    """Between two corners nothing but a straight piece."""
    path, contour = OUTLINES["inner shocks"](), fitted("inner shocks", straight=True)
    corners = [pivot.start for pivot in path.pivots] + [path.pivots[0].end]
    places = sorted(int(np.argmin(np.abs(contour.vertices - place))) for place in corners)
    assert caught("inner shocks", polyline(contour.vertices[places])) > 1.0


def test_what_runs_across_the_curve_is_refused_with_the_place() -> None:
    path = OUTLINES[FIRST]()
    curve = path.stretches[0].curve
    astray = curve.point(np.linspace(0.0, TURN, 200, endpoint=False))
    place = astray[50]
    astray[50] += 3.0 + 3.0j
    with pytest.raises(GeometryError, match="cannot be compared") as caught:
        deviation(path, polyline(astray))
    near = known(re.search(r"near X (\S+), Y (\S+) mm", str(caught.value)))
    assert abs(complex(float(near[1]), float(near[2])) - place) <= 5.0


# What is no damage ------------------------------------------------------------------------------


@some
@given(
    curves().map(whole) | st.sampled_from(TRIMMED).map(lambda name: OUTLINES[name]()),
    st.booleans(),
    st.booleans(),
    st.integers(0, 10**6),
)
def test_found_again_however_it_is_run(path: Path, straight: bool, back: bool, start: int) -> None:
    fit = (fit_polyline if straight else fit_arcs)(path, TOLERANCE)
    turned = rolled(fit.contour.reversed() if back else fit.contour, start)
    runs = locate(path, turned)
    assert sum(len(run.sweeps) for run in runs) == len(turned)
    for run in runs:
        angles = run.angles[:-1] if path.is_whole else run.angles
        assert np.all(np.diff(angles) > 0.0)
        if path.is_whole:
            assert 0.0 <= angles[0] < TURN
            assert angles[-1] - angles[0] < TURN
            # Vertices within the tolerance of their feet, which is why they are found.
            feet = path.stretches[0].curve.point(angles)
            assert np.max(np.abs(run.starts - feet)) <= TOLERANCE
        else:
            assert (angles[0], angles[-1]) == (run.leg.start, run.leg.end)
    # Both bounds lie within the proof's 1 % above the same distance.
    assert deviation(path, turned) == pytest.approx(fit.deviation, rel=0.011, abs=1e-10)


@pytest.mark.parametrize("straight", [False, True])
@each_trimmed
def test_rounded_as_in_a_program(name: str, straight: bool) -> None:
    path, contour = OUTLINES[name](), fitted(name, straight)
    rounded = Contour.through(np.round(contour.vertices, 4), contour.sweeps)
    # A vertex moves by 7e-5 mm at most; an arc of given sweep moves with its ends.
    assert deviation(path, rounded) <= deviation(path, contour) + 1e-3
    assert caught(name, rounded) < 2.0 * TOLERANCE


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6])
def test_flat_arcs_are_as_near_as_their_lines(bulge: float) -> None:
    """Flat arcs are off by their sagittas, without the rounding of circles up to 1e16 mm large."""
    path, lines = OUTLINES[FIRST](), fitted(FIRST, straight=True)
    flat = Contour.through(lines.vertices, np.full(len(lines), 4.0 * np.arctan(bulge)))
    sagitta = 0.5 * bulge * float(np.max(lines.lengths))
    before = deviation(path, lines)
    # The bound exceeds the distance by up to a hundredth.
    assert abs(deviation(path, flat) - before) <= 2.0 * sagitta + 0.01 * before


# Where it ends ----------------------------------------------------------------------------------


def test_what_moves_too_fast_to_be_compared_is_named() -> None:
    """20 mm in a ten-thousandth of a degree, on the flank of a knife edge."""
    law = LAWS["polynomial-345"]
    rise, fall = Move(Decimal("219.99988"), 20.0, law), Move(Decimal("0.00012"), 0.0, law)
    plan = MotionPlan((dwell(30), rise, dwell(40), fall, dwell(70)))
    knife = whole(WorkingCurve(PitchCurve(plan, TranslatingRoller(50.0, 0.0, 8.0), 1), 0.0))
    with pytest.raises(GeometryError, match=r"cannot be compared .* from 289\.9998") as caught:
        fit_polyline(knife, 1e-3)
    assert caught.value.key == "motion"
    assert "move a longer span or a shorter stroke" in caught.value.message


def test_cells_that_cannot_be_halved_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """A flat face that swings by 16 degrees within 2e-5: the proof ends where numbers do."""
    law, span = LAWS["polynomial-345"], Decimal("2e-5")
    rise = Move(Decimal(130), math.radians(18.95), law)
    back = Move(Decimal(102), math.radians(16.14), law)
    plan = MotionPlan((rise, back, Dwell(128 - span), Move(span, 0.0, law)))
    pitch = PitchCurve(plan, OscillatingFlat(23.84 + 5.5j, 6.12, 0.0), 1)
    path = real_outline(WorkingCurve(pitch, 0.0)).path
    rounds = 0

    def counted(self: PitchCurve, low: FloatArray, high: FloatArray) -> Any:
        nonlocal rounds
        rounds += 1
        return enclosed(self, low, high)

    enclosed = PitchCurve.jet_and_bounds
    monkeypatch.setattr(PitchCurve, "jet_and_bounds", counted)
    with pytest.raises(GeometryError, match="cannot be compared"):
        fit_arcs(path, 0.01)
    assert rounds < 200  # 281 in 40 rounds of each proof that fails


@pytest.mark.parametrize(("off", "tolerance"), [("1e-6", 1e-2), ("1e-6", 1e-6), ("1e-3", 1e-4)])
def test_the_proof_of_a_near_circle_ends(
    off: str, tolerance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Spans that miss half a turn by a little: the distance is nearly 0, and no cell shows that."""
    most = 0
    plain = proof._Cells.halved

    def counted(cells: proof._Cells, which: np.ndarray) -> proof._Cells:
        nonlocal most
        made = plain(cells, which)
        most = max(most, len(made.low))
        return made

    monkeypatch.setattr(proof._Cells, "halved", counted)
    path = eccentric(12.0, 3.0, str(Decimal(180) + Decimal(off)))
    fit = fewest_arcs(path, tolerance)
    assert len(fit.contour) <= 8
    assert fit.deviation <= tolerance
    assert proof.deviation(path, fit.contour) <= max(fit.deviation, proof.ENOUGH)
    assert most <= proof.MAX_CELLS


def test_at_the_cap_the_bound_is_wider_and_still_one(monkeypatch: pytest.MonkeyPatch) -> None:
    path = eccentric(12.0, 3.0, "180.001")
    contour = fewest_arcs(path, 1e-2).contour
    sharp = proof.deviation(path, contour)
    monkeypatch.setattr(proof, "MAX_CELLS", 500)
    assert sharp < proof.deviation(path, contour) <= 1e-2
