"""Arc splines for a given number of arcs: equations, evenness, order and independence."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.fewest_arcs import (
    PROBES,
    Arcs,
    ArcSystem,
    JointedCurve,
    Layout,
    Strands,
    arc_splines,
    evened,
)
from camgeo.geometry.contour.least_pieces import ARC
from camgeo.geometry.contour.legs import bends_of
from camgeo.geometry.pieces import smooth_pieces
from camgeo.numeric.arrays import IntArray
from tests.contour.cams import FLANKS, dwell, flank, translating


def _strands(name: tuple[str, int]) -> Strands:
    curve = flank(*name)
    pieces = [piece for piece in smooth_pieces(curve) if not piece.dwell]
    return Strands.of(curve, pieces, bends_of(curve, pieces))


@given(st.lists(st.integers(1, 6), min_size=1, max_size=5), st.integers(0, 2**32 - 1))
def test_banded_equations_are_those_of_the_whole_matrix(counts: list[int], seed: int) -> None:
    """Against numpy's least squares of all equations, spelt out by the definition."""
    layout = Layout.of(np.array(counts))
    random = np.random.default_rng(seed)
    arcs, joints = len(layout.left), len(layout.left) + len(counts)
    basis = random.normal(size=(arcs, 4, 6))
    square, pull = basis @ basis.transpose(0, 2, 1), random.normal(size=(arcs, 4))
    bond, gap = random.normal(size=(arcs, 4)), random.normal(size=arcs)
    free = np.ones(joints, dtype=np.bool_)
    free[layout.first] = free[layout.last] = False
    found = ArcSystem.of(layout).solved(square, pull, bond, gap, free)
    assert np.all(found[~free] == 0.0)

    whole, right = np.zeros((2 * joints + arcs,) * 2), np.zeros(2 * joints + arcs)
    for arc, joint in enumerate(layout.left):
        own = np.arange(2 * joint, 2 * joint + 4)
        whole[np.ix_(own, own)] += square[arc]
        right[own] += pull[arc]
        whole[own, 2 * joints + arc] = whole[2 * joints + arc, own] = bond[arc]
        right[2 * joints + arc] = gap[arc]
    bound = free[layout.left] | free[layout.left + 1]
    keep = np.concatenate((np.repeat(free, 2), bound))
    expected = np.linalg.solve(whole[np.ix_(keep, keep)], right[keep])
    scale = 1.0 + np.max(np.abs(expected), initial=0.0)
    condition = np.linalg.cond(whole[np.ix_(keep, keep)]) if np.any(keep) else 1.0
    unknowns = expected[: 2 * np.count_nonzero(free)]
    assert np.max(np.abs(found[free].ravel() - unknowns), initial=0.0) <= 1e-14 * condition * scale


@settings(max_examples=30)
@given(st.lists(st.integers(1, 9), min_size=1, max_size=4), st.integers(0, 2**32 - 1))
def test_joints_stay_where_arcs_deviate_alike_and_close_in_where_they_do_not(
    counts: list[int], seed: int
) -> None:
    layout = Layout.of(np.array(counts))
    random = np.random.default_rng(seed)
    steps = random.uniform(0.1, 1.0, len(layout.left))
    places = np.zeros(len(layout.left) + len(counts))
    places[layout.left + 1] = steps
    places = np.cumsum(places)
    places += np.repeat(np.arange(len(counts)), np.array(counts) + 1)
    same = evened(layout, places, np.zeros(len(layout.left)))
    assert same == pytest.approx(places, rel=1e-13)
    worst = random.integers(len(layout.left))
    shrink = np.zeros(len(layout.left))
    shrink[worst] = 0.5
    moved = evened(layout, places, shrink)
    ends = np.concatenate((layout.first, layout.last))
    assert np.all(moved[ends] == places[ends])
    assert np.all(np.diff(moved) > 0.0)
    if counts[layout.spline[worst]] > 1:
        left = layout.left[worst]
        assert moved[left + 1] - moved[left] < steps[worst]


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_a_spline_depends_on_its_piece_and_number_alone(name: tuple[str, int]) -> None:
    strands = _strands(name)
    pieces: IntArray = np.arange(len(strands.difficulty.totals))
    together = arc_splines(strands, np.repeat(pieces, 2), np.tile([9, 14], len(pieces)))
    for number, count in ((0, 9), (1, 14)):
        for piece in pieces:
            (alone,) = arc_splines(strands, np.array([piece]), np.array([count]))
            other = together[2 * piece + number]
            # Sums over the batch round differently, some 1e-15; rounds that swing multiply it.
            assert alone.deviation == pytest.approx(other.deviation, rel=1e-9)
            assert alone.angles == pytest.approx(other.angles, abs=1e-9)


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_deviation_is_near_its_limit(name: tuple[str, int]) -> None:
    """N arcs deviate as N - 1.3 would without ends: those cost 0.65, and the few zeros of dkappa/ds
    parts of an arc; a fiftieth is what rounds of evening out leave. None beats the limit.
    """
    strands = _strands(name)
    pieces: IntArray = np.arange(len(strands.difficulty.totals))
    for count in (40, 80):
        splines = arc_splines(strands, pieces, np.full(len(pieces), count))
        for spline, total in zip(splines, strands.difficulty.totals, strict=True):
            arcs = total * (ARC / spline.deviation) ** (1.0 / 3.0)
            assert count - 1.3 - 0.02 * count <= arcs <= count


def test_arcs_deviate_alike() -> None:
    strands = _strands(("plate_translating", -1))
    pieces, counts = np.array([0]), np.array([20])
    (spline,) = arc_splines(strands, pieces, counts)
    found = []
    for k, half in enumerate(spline.halves):
        phi = np.linspace(spline.angles[k], spline.angles[k + 1], 200)[1:-1]
        chord = spline.vertices[k + 1] - spline.vertices[k]
        centre = spline.vertices[k] + 0.5 * chord * (1.0 + 1j / np.tan(half))
        radius = abs(spline.vertices[k] - centre)
        found.append(np.max(np.abs(np.abs(strands.curve.point(phi) - centre) - radius)))
    # Fourteen rounds leave a hundredth or two; the first arcs at the ends, one bulge each, more.
    assert max(found) <= spline.deviation * 1.002
    assert min(found[2:-2]) >= 0.95 * max(found)


@pytest.mark.parametrize("count", [2, 6, 30])
def test_one_step_is_least_squares(count: int) -> None:
    """No slight change of the joints that keeps the arcs tangent lowers the sum of squares."""
    strands = _strands(("setzhub", -1))
    layout, pieces = Layout.of(np.array([count])), np.array([0])
    system = ArcSystem.of(layout)
    places = strands.difficulty.joints(layout, pieces)
    jointed = JointedCurve.of(strands, layout, pieces, places, PROBES)
    off = np.zeros((count + 1, 2))
    for _ in range(6):
        off = off + jointed.step(system, off)
    squares = np.sum(Arcs.of(jointed, off).errors(jointed.samples)[0] ** 2)
    assert np.max(np.abs(Arcs.of(jointed, off).miss)) <= 1e-13
    random = np.random.default_rng(3)
    for _ in range(20):
        change = random.normal(size=off.shape) * np.array([1.0, 0.1]) * 0.05 * np.max(np.abs(off))
        change[[0, -1]] = 0.0
        other = _tangent(jointed, off + change)
        assert np.max(np.abs(Arcs.of(jointed, other).miss)) <= 1e-13
        # The derivatives of the errors are those of flat arcs, so the least is missed a little.
        assert np.sum(Arcs.of(jointed, other).errors(jointed.samples)[0] ** 2) >= 0.99 * squares


def _tangent(jointed: JointedCurve, off: np.ndarray) -> np.ndarray:
    """The offsets and turns near `off` with G1 arcs, by Newton's method with least changes."""
    for _ in range(12):
        miss = Arcs.of(jointed, off).miss
        columns = []
        for joint in range(1, len(off) - 1):
            for part in (0, 1):
                step = np.zeros_like(off)
                step[joint, part] = 1e-6
                columns.append((Arcs.of(jointed, off + step).miss - miss) / 1e-6)
        change = np.linalg.lstsq(np.array(columns).T, -miss, rcond=None)[0]
        off = off.copy()
        off[1:-1] += change.reshape(-1, 2)
    return off


def test_a_circle_that_is_no_dwell_is_one_arc() -> None:
    """A rest taken for a move: constant curvature."""
    curve = translating(dwell(100), dwell(260))
    (piece,) = smooth_pieces(curve)
    short = type(piece)(0.0, 2.0)
    strands = Strands.of(curve, [short], bends_of(curve, [short]))
    (spline,) = arc_splines(strands, np.array([0]), np.array([1]))
    assert spline.deviation <= 1e-13
    chain = spline.chain()
    assert abs(chain.centres[0]) <= 1e-13 * 32.0 * 4.0
    assert abs(chain.sweeps[0]) == pytest.approx(2.0, rel=1e-14)
