"""Fits of trimmed outlines: exact corners, exact arcs between stretches, all within tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Fit, require_simple
from camgeo.geometry.contour.proof import deviation
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.working_curve import WorkingCurve
from tests.contour.cams import TURN, dwell, move, translating
from tests.contour.paths import (
    PATHS,
    SAGITTA,
    area,
    corner,
    cut_off_lobe,
    hard_curve,
    measured,
    shocks,
    swallow_tail,
)
from tests.contour.tangents import PLACE, check_shared_ends, check_tangent, tangents
from tests.strategies import attack

Fitter = Callable[[Path, float], Fit]

FITTERS: tuple[Fitter, ...] = (fit_arcs, fit_polyline)

names = pytest.mark.parametrize("name", PATHS)

some = pytest.mark.parametrize("tolerance", [0.02, 0.001])


def corners(path: Path) -> list[Pivot]:
    return [pivot for pivot in path.pivots if pivot.distance == 0.0]


def check_fit(path: Path, fit: Fit, tolerance: float) -> None:
    assert fit.deviation <= tolerance == fit.tolerance
    found = measured(path, fit.contour)
    assert found <= fit.deviation + SAGITTA
    # The proof's own slack is 1 %; dense sampling finds all but (1/100)^2 of a piece's bulge. To
    # this come the gaps at the feet: the distance times the sine of the angle between piece and
    # curve there, 0.03 where the coarsest arcs turn by a radian.
    assert fit.deviation <= 1.05 * found + 1e-9
    require_simple(fit.contour, "outline")
    # A strip as wide as the deviation along the whole length is all that the areas differ by.
    strip = fit.deviation * fit.contour.length
    assert fit.contour.area == pytest.approx(abs(area(path)), abs=strip, rel=0.0)


@some
@pytest.mark.parametrize("fitter", FITTERS)
@names
def test_within_tolerance(name: str, fitter: Fitter, tolerance: float) -> None:
    path = PATHS[name]()
    check_fit(path, fitter(path, tolerance), tolerance)


@pytest.mark.parametrize("fitter", FITTERS)
@names
def test_corners_are_vertices_and_the_only_ones(name: str, fitter: Fitter) -> None:
    path = PATHS[name]()
    contour = fitter(path, 1e-3).contour
    for pivot in corners(path):
        assert np.count_nonzero(contour.vertices == pivot.centre) == 1
    for pivot in path.pivots:
        assert np.any(contour.vertices == pivot.start)
        assert np.min(np.abs(contour.vertices - pivot.end)) <= PLACE
    if fitter is fit_arcs:
        check_tangent(contour, np.array([pivot.centre for pivot in corners(path)], dtype=complex))
        check_shared_ends(contour)


@names
def test_corners_turn_as_the_path_does(name: str) -> None:
    path = PATHS[name]()
    contour = fit_arcs(path, 1e-3).contour
    first, last = tangents(contour)
    turns = np.angle(np.roll(first, -1) * np.conj(last))
    for pivot in corners(path):
        k = int(np.argmin(np.abs(contour.ends - pivot.centre)))
        # Contours run counter-clockwise: against the path where the cam does.
        sense = -path.stretches[0].curve.pitch.rotation
        # Printed digits of crossing angles and points in place of exact ones: 1e-12.
        assert turns[k] == pytest.approx(sense * pivot.sweep, abs=1e-11)
        assert turns[k] > 0.0 or pivot.distance < path.stretches[0].curve.distance


@pytest.mark.parametrize(("flank", "rotation"), [(-1, 1), (-1, -1), (1, 1), (1, -1)])
def test_turn_of_the_roller_is_one_exact_arc(flank: int, rotation: int) -> None:
    path = shocks(flank, rotation)
    (turn,) = (pivot for pivot in path.pivots if pivot.distance != 0.0)
    for tolerance in (0.02, 1e-4):
        contour = fit_arcs(path, tolerance).contour
        found = np.flatnonzero(contour.centres == turn.centre)
        assert len(found) == 1
        assert abs(contour.sweeps[found[0]]) == abs(turn.sweep)
        assert contour.radii[found[0]] == pytest.approx(8.0, rel=1e-15)


def test_dwell_cut_in_two_is_two_exact_arcs() -> None:
    curve = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
    start, end = math.radians(20.0), math.radians(200.0)
    path = Path((Stretch(curve, start, end), Stretch(curve, end, start + TURN)))
    contour = fit_arcs(path, 1e-3).contour
    about_axis = (contour.sweeps != 0.0) & (contour.centres == 0.0)
    found = np.degrees(np.sort(contour.sweeps[about_axis]))
    # Each is a difference of two angles of at most 2 pi + 1, rounded once.
    assert found == pytest.approx([20.0, 20.0, 40.0, 40.0], abs=1e-13)
    assert contour.area == pytest.approx(fit_arcs(whole(curve), 1e-3).contour.area, abs=0.2)


def test_corner_in_a_dwell_and_at_cam_angle_0() -> None:
    """A stretch that begins at a break, and one that ends a rounding error beyond another."""
    curve = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
    for angle in (0.0, math.radians(60.0), np.nextafter(math.radians(60.0), 4.0)):
        point = complex(curve.point(np.array([angle]))[0])
        path = Path(
            (Stretch(curve, angle, angle + TURN), corner(curve, angle + TURN, angle, point))
        )
        fit = fit_arcs(path, 1e-3)
        assert len(fit.contour) == len(fit_arcs(whole(curve), 1e-3).contour)
        assert np.min(fit.contour.lengths) > 0.1


@attack
@given(
    st.floats(-0.5, -1e-9) | st.floats(0.0, 14.0),
    st.sampled_from([0.01, 0.001]),
    st.sampled_from(FITTERS),
)
def test_parallels_round_the_corner(by: float, tolerance: float, fitter: Fitter) -> None:
    """As for a cutter; a parallel inside of the outline has no arc to go round the corner on."""
    path = swallow_tail().offset(by)
    if by < 0.0:
        with pytest.raises(UndercutError):
            fitter(path, tolerance)
        return
    fit = fitter(path, tolerance)
    assert measured(path, fit.contour, 2_000) <= fit.deviation + SAGITTA
    assert fit.deviation <= tolerance


@pytest.mark.parametrize("sweep", [1e-13, 1e-9, 1e-6, 1e-5])
def test_turn_too_small_for_a_piece(sweep: float) -> None:
    """An arc of less than a hundredth of the tolerance is a corner, also in a file read back."""
    tolerance = 1e-3
    curve = translating(dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))
    centre, normal = complex(curve.pitch.point(np.zeros(1))[0]), 1j
    turn = Pivot(centre, -8.0, normal, sweep, TURN, 0.0)
    path = Path((Stretch(curve, 0.0, TURN), turn))
    fit = fit_arcs(path, tolerance)
    arcs = np.count_nonzero(fit.contour.centres == centre)
    assert arcs == (8.0 * sweep > 0.01 * tolerance)
    assert fit.deviation <= tolerance
    assert deviation(path, fit.contour) == pytest.approx(fit.deviation, rel=0.011, abs=1e-9)


def test_arc_turned_inside_out_is_refused() -> None:
    path = shocks(-1, 1)
    fit_arcs(path.offset(7.99), 0.01)
    touching = path.offset(8.0)  # the turn has become a corner
    assert len(corners(touching)) == 1
    check_fit(touching, fit_arcs(touching, 0.01), 0.01)
    for by in (8.01, 20.0, -0.01):
        with pytest.raises(UndercutError, match="turned inside out"):
            fit_arcs(path.offset(by), 0.01)


def test_path_without_a_stretch_is_refused() -> None:
    with pytest.raises(GeometryError, match="needs a stretch"):
        fit_arcs(Path((Pivot(0j, 1.0, 1j, 1.0, 0.0, 0.0),)), 0.01)


def test_gap_between_elements_is_no_fit() -> None:
    path = swallow_tail()
    (stretch,), (pivot,) = path.stretches, path.pivots
    moved = Pivot(pivot.centre + 0.1, 0.0, pivot.normal, pivot.sweep, pivot.before, pivot.after)
    for fitter in FITTERS:
        with pytest.raises((GeometryError, ArithmeticError)):
            fitter(Path((stretch, moved)), 0.01)


# Cusps ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [0.1, 0.01, 1e-3, 1e-5, 1e-6])
def test_curvature_without_bound(tolerance: float) -> None:
    """HC21a: 1 + d kappa touches zero, the curvature is infinite there and the tangent is not."""
    path = whole(hard_curve("HC21a"))
    fit = fit_arcs(path, tolerance)
    assert fit.deviation <= tolerance
    check_tangent(fit.contour, np.empty(0, dtype=np.complex128))
    # As many arcs as for a parallel 1 mm farther out, which has no cusp, and a few more.
    plain = fit_arcs(path.offset(1.0), tolerance)
    assert len(fit.contour) <= 1.1 * len(plain.contour) + 8
    assert deviation(path, fit.contour) == pytest.approx(fit.deviation, rel=0.011, abs=1e-9)


@pytest.mark.parametrize("fitter", FITTERS)
def test_stretch_that_ends_in_its_cusp(fitter: Fitter) -> None:
    curve = hard_curve("HC21a")
    angle = math.radians(78.9790897521664912236687251744)
    path = Path((Stretch(curve, angle, angle + TURN),))
    check_fit(path, fitter(path, 0.001), 0.001)
    place = complex(curve.point(np.array([angle]))[0])
    path = Path((Stretch(curve, angle, angle + TURN), corner(curve, angle + TURN, angle, place)))
    check_fit(path, fitter(path, 0.001), 0.001)


@pytest.mark.parametrize("fitter", FITTERS)
@pytest.mark.parametrize("case", ["HC21c"])
def test_undercut_is_still_refused(case: str, fitter: Fitter) -> None:
    with pytest.raises(UndercutError, match="cusp or undercut"):
        fitter(whole(hard_curve(case)), 0.01)


@pytest.mark.parametrize("roller", [40.0, 41.0])
def test_dwell_shrunk_to_a_point_or_beyond_is_refused(roller: float) -> None:
    curve = translating(dwell(180), move(100, 1.0), move(80, 0.0), roller=roller)
    for fitter in FITTERS:
        with pytest.raises(UndercutError, match="cusp or undercut"):
            fitter(whole(WorkingCurve(curve.pitch, -roller)), 0.01)


@pytest.mark.parametrize("tolerance", [1.0, 0.1])
@pytest.mark.parametrize("fitter", FITTERS)
def test_tips_sharper_than_the_tolerance(fitter: Fitter, tolerance: float) -> None:
    """Round the tip of a lobe the pieces must turn, however little they may deviate."""
    curve = hard_curve("HC21a")
    sharp = WorkingCurve(curve.pitch, 0.9999 * curve.distance)
    fit = fitter(whole(sharp), tolerance)
    assert measured(whole(sharp), fit.contour) <= fit.deviation + SAGITTA <= tolerance + SAGITTA


def test_nothing_is_left_beyond_the_neck_of_a_lobe() -> None:
    """HC22: the corner is 9.06 mm from the axis, the lobe that falls away reached to 136 mm."""
    path = cut_off_lobe()
    contour = fit_arcs(path, 1e-3).contour
    far = int(np.argmax(np.abs(contour.vertices)))
    assert contour.vertices[far] == path.pivots[0].centre
