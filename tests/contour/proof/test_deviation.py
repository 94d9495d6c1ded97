"""The proof of a contour is attacked: it must detect all damage, or refuse the contour."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.contour.chords import fit_polyline
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.proof import deviation, locate
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray
from tests.contour.cams import FLANKS, TURN, curves, dense_flank, dwell, flank, polyline
from tests.laws import LAWS
from tests.long_form import examples

TOLERANCE = 0.01

SAGITTA = 2e-6
"""Error of the dense curve used for measuring [mm]."""

some = settings(
    max_examples=examples(9, long=30), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)

names = st.sampled_from(FLANKS)


@cache
def _fit(name: tuple[str, int], straight: bool = False) -> Contour:
    return (fit_polyline if straight else fit_arcs)(whole(flank(*name)), TOLERANCE).contour


def _caught(name: tuple[str, int], contour: Contour) -> float:
    """The bound, compared with dense sampling; infinite if the contour is refused."""
    curve = flank(*name)
    try:
        bound = deviation(whole(curve), contour)
    except GeometryError:
        return np.inf
    assert bound >= dense_flank(name).measured(contour, 4_000) - SAGITTA
    return bound


@some
@given(names, st.booleans(), st.integers(0, 10**6), st.floats(-5.0, 1.3), st.floats(0.0, TURN))
def test_moved_vertex(
    name: tuple[str, int], straight: bool, index: int, size: float, angle: float
) -> None:
    contour = _fit(name, straight)
    vertices = contour.vertices.copy()
    step = 10.0**size * complex(np.cos(angle), np.sin(angle))
    vertices[index % len(vertices)] += step
    _caught(name, Contour.through(vertices, contour.sweeps))


@some
@given(names, st.integers(0, 10**6), st.floats(-6.0, 0.5), st.sampled_from([1.0, -1.0]))
def test_changed_bulge(name: tuple[str, int], index: int, size: float, sign: float) -> None:
    contour = _fit(name)
    sweeps = contour.sweeps.copy()
    index %= len(sweeps)
    changed = sweeps[index] + sign * 10.0**size
    sweeps[index] = np.clip(changed, -6.2, 6.2)
    _caught(name, Contour.through(contour.vertices, sweeps))


@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_reversed_arc(name: tuple[str, int]) -> None:
    contour = _fit(name)
    for index in range(0, len(contour), 9):
        sweeps = contour.sweeps.copy()
        sweeps[index] *= -1.0
        bound = _caught(name, Contour.through(contour.vertices, sweeps))
        # Its middle is now two sagittas off; where that is nothing, so is the damage.
        sagitta = contour.radii[index] * (1.0 - np.cos(0.5 * contour.sweeps[index]))
        assert bound >= 2.0 * sagitta - TOLERANCE


@pytest.mark.parametrize("turns", [-1.0, 1.0])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_arc_that_runs_the_long_way_round(name: tuple[str, int], turns: float) -> None:
    """The arc is on the same circle and between the same ends: only its sweep differs."""
    contour = _fit(name)
    for index in range(0, len(contour), 9):
        sweeps = contour.sweeps.copy()
        if sweeps[index] == 0.0:
            continue
        sweeps[index] += turns * np.sign(sweeps[index]) * TURN
        damaged = Contour(contour.vertices, sweeps, contour.centres)
        # From the middle of the arc there to the other side of its circle.
        assert _caught(name, damaged) > min(1.0, contour.radii[index])


@pytest.mark.parametrize("straight", [False, True])
@pytest.mark.parametrize("name", FLANKS, ids=str)
def test_dropped_vertex(name: tuple[str, int], straight: bool) -> None:
    contour = _fit(name, straight)
    for index in range(0, len(contour), len(contour) // 4):
        keep = np.arange(len(contour)) != index
        _caught(name, Contour.through(contour.vertices[keep], contour.sweeps[keep]))


@some
@given(names, st.integers(0, 10**6), st.integers(2, 40))
def test_left_out_stretch(name: tuple[str, int], start: int, count: int) -> None:
    """Vertices dropped and the gap closed by a straight piece."""
    contour = _fit(name, straight=True)
    keep = (np.arange(len(contour)) - start) % len(contour) >= count
    _caught(name, Contour.through(contour.vertices[keep], contour.sweeps[keep]))


@some
@given(names, st.booleans(), st.floats(-4.0, 1.0), st.floats(0.0, TURN))
def test_shift_of_the_whole(
    name: tuple[str, int], straight: bool, size: float, angle: float
) -> None:
    contour = _fit(name, straight)
    step = 10.0**size * complex(np.cos(angle), np.sin(angle))
    moved = np.where(contour.sweeps != 0.0, contour.centres + step, 0.0)
    bound = _caught(name, Contour(contour.vertices + step, contour.sweeps, moved))
    # A closed curve has normals in all directions: somewhere the shift is all distance, or a
    # nearer part of the curve comes in between, which the first of its curvature bounds allow.
    assert bound >= 0.9 * abs(step) - TOLERANCE


@pytest.mark.parametrize("factor", [0.5, 0.99, 1.01, 2.0])
def test_scaled(factor: float) -> None:
    name = FLANKS[0]
    contour = _fit(name)
    scaled = Contour(factor * contour.vertices, contour.sweeps, factor * contour.centres)
    # 50 mm of base radius, 7 mm roller: the dwell lies at 43.2 mm from the axis.
    assert _caught(name, scaled) >= 43.0 * abs(factor - 1.0)


def test_foreign_contours_are_refused_or_far() -> None:
    name = ("setzhub", -1)
    for contour in (
        Contour.circle(40.0),
        Contour.circle(1.0, 100.0 + 0j),
        _fit(("ring", 1)),
        polyline(np.array([0j, 50.0, 50j])),
    ):
        try:
            bound = deviation(whole(flank(*name)), contour)
        except GeometryError:
            continue
        assert bound >= dense_flank(name).measured(contour, 4_000) - SAGITTA > 1.0


def test_twice_round_is_refused() -> None:
    contour = _fit(FLANKS[0])
    twice = Contour(
        np.tile(contour.vertices, 2), np.tile(contour.sweeps, 2), np.tile(contour.centres, 2)
    )
    with pytest.raises(GeometryError, match="once round"):
        deviation(whole(flank(*FLANKS[0])), twice)


def test_there_and_back_is_refused() -> None:
    """A detour along the curve itself and back again encloses nothing but is no outline."""
    contour = _fit(FLANKS[0], straight=True)
    vertices = np.concatenate((contour.vertices[:20], contour.vertices[18:10:-1]))
    vertices = np.concatenate((vertices, contour.vertices[11:]))
    with pytest.raises(GeometryError, match="once round"):
        deviation(whole(flank(*FLANKS[0])), polyline(vertices))


def test_what_runs_across_the_curve_is_refused_with_the_place() -> None:
    vertices = flank(*FLANKS[0]).point(np.linspace(0.0, TURN, 200, endpoint=False))
    astray = vertices.copy()
    astray[50] += 3.0 + 3.0j
    with pytest.raises(GeometryError, match="cannot be compared") as caught:
        deviation(whole(flank(*FLANKS[0])), polyline(astray))
    near = re.search(r"near X (\S+), Y (\S+) mm", str(caught.value))
    assert near is not None
    assert abs(complex(float(near[1]), float(near[2])) - vertices[50]) <= 5.0


@settings(some, max_examples=10)
@given(curves(), st.booleans(), st.integers(0, 10**6))
def test_found_again_however_it_is_run(curve: WorkingCurve, back: bool, start: int) -> None:
    fit = fit_arcs(whole(curve), TOLERANCE)
    contour = fit.contour.reversed() if back else fit.contour
    turned = Contour(
        np.roll(contour.vertices, start),
        np.roll(contour.sweeps, start),
        np.roll(contour.centres, start),
    )
    (run,) = locate(whole(curve), turned)
    angles = run.angles[:-1]
    assert np.all(np.diff(angles) > 0.0)
    assert angles[-1] - angles[0] < TURN
    assert 0.0 <= angles[0] < TURN
    # Vertices within the tolerance of their feet, which is why they are found.
    assert np.max(np.abs(run.starts - curve.point(angles))) <= TOLERANCE
    # Both bounds lie within the proof's 1 % above the same distance.
    assert deviation(whole(curve), turned) == pytest.approx(fit.deviation, rel=0.011, abs=1e-10)


def test_inches_for_millimetres_show() -> None:
    contour = _fit(FLANKS[0])
    small = Contour(contour.vertices / 25.4, contour.sweeps, contour.centres / 25.4)
    assert _caught(FLANKS[0], small) > 20.0


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6])
def test_flat_arcs_are_as_near_as_their_lines(bulge: float) -> None:
    """Flat arcs are off by their sagittas, without the rounding of circles up to 1e16 mm large."""
    path, lines = whole(flank(*FLANKS[0])), _fit(FLANKS[0], straight=True)
    flat = Contour.through(lines.vertices, np.full(len(lines), 4.0 * np.arctan(bulge)))
    sagitta = 0.5 * bulge * float(np.max(lines.lengths))
    before = deviation(path, lines)
    # The bound exceeds the distance by up to a hundredth.
    assert abs(deviation(path, flat) - before) <= 2.0 * sagitta + 0.01 * before


def test_what_moves_too_fast_to_be_compared_is_named() -> None:
    """20 mm in a ten-thousandth of a degree, on the flank of a knife edge."""
    law = LAWS["polynomial-345"]
    rise, fall = Move(Decimal("219.99988"), 20.0, law), Move(Decimal("0.00012"), 0.0, law)
    plan = MotionPlan((dwell(30), rise, dwell(40), fall, dwell(70)))
    knife = whole(WorkingCurve(PitchCurve(plan, TranslatingRoller(50.0, 0.0, 8.0), 1), 0.0))
    with pytest.raises(GeometryError, match=r"cannot be compared .* from 289\.9998") as caught:
        fit_polyline(knife, 1e-3)
    assert caught.value.key == "motion"
    assert "give it a longer span or a shorter way" in caught.value.message


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
