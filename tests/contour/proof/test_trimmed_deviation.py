"""The proof for trimmed outlines is attacked: damage at corners must show, or be refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.proof import deviation, locate
from camgeo.geometry.outline.path import Path, whole
from tests.contour.cams import TURN, polyline
from tests.contour.paths import (
    PATHS,
    SAGITTA,
    cut_off_lobe,
    dense_path,
    hard_curve,
    measured,
    swallow_tail,
)
from tests.long_form import examples
from tests.strategies import attack

TOLERANCE = 0.01

TRIMMED = tuple(name for name in PATHS if name != "cusp")

names = pytest.mark.parametrize("name", TRIMMED)

some = settings(attack, max_examples=examples(8, long=25))


def fitted(name: str, straight: bool) -> tuple[Path, Contour]:
    path = PATHS[name]()
    return path, (fit_polyline if straight else fit_arcs)(path, TOLERANCE).contour


def caught(path: Path, contour: Contour) -> float:
    """The bound, compared with dense sampling; infinite if the contour is refused."""
    try:
        bound = deviation(path, contour)
    except GeometryError:
        return np.inf
    assert bound >= measured(path, contour, 4_000) - SAGITTA
    return bound


def corner_index(path: Path, contour: Contour) -> int:
    (corner,) = (pivot.centre for pivot in path.pivots if pivot.distance == 0.0)
    return int(np.argmin(np.abs(contour.vertices - corner)))


@some
@given(st.sampled_from(TRIMMED), st.booleans(), st.booleans(), st.integers(0, 10**6))
def test_found_again_however_it_is_run(name: str, straight: bool, back: bool, start: int) -> None:
    path = PATHS[name]()
    fit = (fit_polyline if straight else fit_arcs)(path, TOLERANCE)
    contour = fit.contour.reversed() if back else fit.contour
    turned = Contour(
        np.roll(contour.vertices, start),
        np.roll(contour.sweeps, start),
        np.roll(contour.centres, start),
    )
    runs = locate(path, turned)
    assert sum(len(run.sweeps) for run in runs) == len(contour)
    for run in runs:
        assert np.all(np.diff(run.angles) > 0.0)
        assert (run.angles[0], run.angles[-1]) == (run.leg.start, run.leg.end)
    # Both bounds lie within the proof's 1 % above the same distance.
    assert deviation(path, turned) == pytest.approx(fit.deviation, rel=0.011, abs=1e-10)


@pytest.mark.parametrize("straight", [False, True])
@names
def test_rounded_as_in_a_program(name: str, straight: bool) -> None:
    path, contour = fitted(name, straight)
    exact = deviation(path, contour)
    rounded = Contour.through(np.round(contour.vertices, 4), contour.sweeps)
    # A vertex moves by 7e-5 mm at most; an arc of given sweep moves with its ends.
    assert deviation(path, rounded) <= exact + 1e-3
    assert caught(path, rounded) < 2.0 * TOLERANCE


@pytest.mark.parametrize("straight", [False, True])
@names
def test_corner_cut_off(name: str, straight: bool) -> None:
    """The corner left out: its neighbours joined by a straight piece, or by the arc there was."""
    path, contour = fitted(name, straight)
    k = corner_index(path, contour)
    keep = np.arange(len(contour)) != k
    arcs = contour.sweeps.copy()
    lines = arcs.copy()
    lines[k - 1] = 0.0
    for sweeps in (arcs, lines):
        cut = Contour.through(contour.vertices[keep], sweeps[keep])
        far = float(np.min(np.abs(cut.points(1e-4) - contour.vertices[k])))
        assert caught(path, cut) >= min(far, 0.05)


@some
@given(
    st.sampled_from(TRIMMED),
    st.booleans(),
    st.floats(-4.0, 0.5),
    st.floats(0.0, TURN),
    st.integers(-2, 2),
)
def test_moved_corner(name: str, straight: bool, size: float, angle: float, which: int) -> None:
    path, contour = fitted(name, straight)
    vertices = contour.vertices.copy()
    k = (corner_index(path, contour) + which) % len(vertices)
    vertices[k] += 10.0**size * np.exp(1j * angle)
    bound = caught(path, Contour.through(vertices, contour.sweeps))
    if which == 0 and straight:
        # Moved along one of its chords it is off by the sine of the corner's turn from the exact
        # way on, 0.12 at least for all of these.
        assert bound >= 0.1 * 10.0**size - TOLERANCE or bound == np.inf


def test_swallow_tail_left_on_is_caught() -> None:
    path, curve = swallow_tail(), hard_curve("HC21c")
    for count in (720, 3_600, 36_000):
        points = curve.point(np.linspace(0.0, TURN, count, endpoint=False))
        # The tail reaches 0.09 mm beyond the crossing.
        assert caught(path, polyline(points)) > 0.05


def test_lobe_left_on_or_in_place_of_the_disc_is_caught() -> None:
    path, curve = cut_off_lobe(), hard_curve("HC22")
    untrimmed = fit_arcs(whole(curve), TOLERANCE).contour
    assert caught(path, untrimmed) > 50.0
    radius = np.abs(untrimmed.vertices)
    lobe = untrimmed.vertices[radius > 29.0]
    assert caught(path, polyline(lobe)) > 10.0


@pytest.mark.parametrize("mirrored", [False, True])
@names
def test_other_outlines_are_caught(name: str, mirrored: bool) -> None:
    path = PATHS[name]()
    for other in TRIMMED:
        points = dense_path(PATHS[other](), 500)
        if other == name and not mirrored:
            continue
        contour = polyline(np.conj(points) if mirrored else points)
        assert caught(path, contour) > 0.1


def test_arc_whose_end_is_off_its_circle() -> None:
    """A contour may contradict itself: centre and end of an arc do not fit together."""
    path, contour = fitted("inner shocks", straight=False)
    for index in range(0, len(contour), 5):
        if contour.sweeps[index] == 0.0:
            continue
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


def test_twice_round_is_refused() -> None:
    path, contour = fitted("swallow tail", straight=False)
    twice = Contour(
        np.tile(contour.vertices, 2), np.tile(contour.sweeps, 2), np.tile(contour.centres, 2)
    )
    with pytest.raises(GeometryError, match="once round"):
        deviation(path, twice)


def test_stretch_left_out_is_refused() -> None:
    """Between two corners nothing but a straight piece."""
    path, contour = fitted("inner shocks", straight=True)
    corners = [pivot.start for pivot in path.pivots] + [path.pivots[0].end]
    places = sorted(int(np.argmin(np.abs(contour.vertices - place))) for place in corners)
    only = polyline(contour.vertices[places])
    assert caught(path, only) > 1.0
