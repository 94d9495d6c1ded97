"""Undercut is found even where the known extremes of the curvature do not show it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

import camgeo
from camgeo.errors import GeometryError
from camgeo.geometry.outline.cusps import sure_bends, undercut_ranges
from camgeo.geometry.outline.outline import backward_angles
from camgeo.geometry.pieces import Extremes, curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import frozen
from camgeo.units import TURN
from tests.draws.trimmed import drawn, miss
from tests.reference import hard_case, inner_of, pitch_curve_of
from tests.strategies import attack, signs, wild_pitch_curves


def ends_only(bends: Extremes, curve: PitchCurve) -> Extremes:
    """The extremes, reduced to those at breaks."""
    kept = np.isin(np.mod(bends.phi, 2.0 * math.pi), np.mod(curve.breaks, 2.0 * math.pi))
    kept[[0, -1]] = True
    return Extremes(frozen(bends.phi[kept], np.float64), frozen(bends.values[kept], np.float64))


@pytest.mark.parametrize("case", ["HC21b", "HC21c"])
def test_a_missed_extreme_is_found(case: str) -> None:
    """Of HC21b's loop of 0.029 degrees not one sample of 257 a piece need be inside."""
    params, expected = hard_case(case)
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    blind = ends_only(curvature_extremes(flank.pitch), flank.pitch)
    assert undercut_ranges(flank, blind) == [], "the extremes left do not show the loop"
    ((start, end),) = undercut_ranges(flank, sure_bends(flank, blind))
    assert math.degrees(start) == pytest.approx(float(expected["cusp1_phi_deg"]), abs=1e-9)
    assert math.degrees(end) == pytest.approx(float(expected["cusp2_phi_deg"]), abs=1e-9)


@attack
@given(wild_pitch_curves(), signs())
def test_blind_to_all_extremes_it_finds_the_same_ranges(pitch: PitchCurve, side: int) -> None:
    flank = WorkingCurve(pitch, side * pitch.follower.roller_radius)
    try:
        bends = curvature_extremes(pitch)
        seen = undercut_ranges(flank, bends)
        found = undercut_ranges(flank, sure_bends(flank, ends_only(bends, pitch)))
    except GeometryError:  # Z' = 0
        return
    margins = 1.0 + flank.distance * bends.values
    if np.min(np.abs(margins)) < 1e-6:
        return  # a range that only just is one may be found or not
    assert len(found) == len(seen)
    for one, other in zip(sorted(found), sorted(seen), strict=True):
        assert one == pytest.approx(other, abs=1e-9)


def test_where_nothing_is_missing_nothing_is_added() -> None:
    params, _ = hard_case("HC21c")
    flank = inner_of(pitch_curve_of({"kappa": 1, **params}))
    bends = curvature_extremes(flank.pitch)
    assert sure_bends(flank, bends) is bends


TABLE = """
camgeo = 1
name = "noisy"
[cam]
rotation = "cw"
[follower]
{follower}
base_radius = 45
[[motion]]
law = "table"
span = 360
file = "lift.csv"
[output]
formats = ["csv"]
"""


def noisy(folder: Path, follower: str, step: float, noise: float) -> PitchCurve:
    """The pitch curve of a table with rows every `step` degrees that are off by `noise` mm."""
    phi = np.arange(0.0, 360.0, step)
    lift = 10.0 * (1.0 - np.cos(np.radians(phi)))
    lift += np.random.default_rng(39).normal(0.0, noise, len(phi))
    rows = zip([*phi, 360.0], [*lift, lift[0]] - np.min(lift), strict=True)
    (folder / "lift.csv").write_text("".join(f"{a:.6g},{s:.9f}\n" for a, s in rows), "utf-8")
    (folder / "s.toml").write_text(TABLE.format(follower=follower), "utf-8")
    return camgeo.load(folder / "s.toml").cam.disc.pitch_curve


def ranges_of(negative: np.ndarray) -> int:
    return int(np.count_nonzero(negative & ~np.roll(negative, 1)))


DENSE = np.linspace(0.0, TURN, 360_001)[:-1]


def inside(ranges: list[tuple[float, float]]) -> np.ndarray:
    """(n,) which of `DENSE` are inside."""
    found = np.zeros(len(DENSE), dtype=np.bool_)
    for start, end in ranges:
        found |= (DENSE - start) % TURN < (end - start) % TURN
    return found


@pytest.mark.parametrize("step", [0.5, 1.0])
def test_every_range_of_a_noisy_table_is_found(step: float, tmp_path: Path) -> None:
    """A hundred ranges of undercut, of which the known extremes show none."""
    kind = 'kind = "translating-roller"\nroller_radius = 14'
    pitch = noisy(tmp_path, kind, step, 8e-3 * step**2)
    flank = WorkingCurve(pitch, -14.0)
    blind = ends_only(curvature_extremes(pitch), pitch)
    found = undercut_ranges(flank, sure_bends(flank, blind))
    undercut = 1.0 - 14.0 * pitch.curvature(DENSE) < 0.0
    assert len(found) == ranges_of(undercut) > 10
    assert np.array_equal(inside(found), undercut)


def test_every_range_in_which_a_face_turns_back_is_found(tmp_path: Path) -> None:
    pitch = noisy(tmp_path, 'kind = "translating-flat"', 1.0, 5e-3)
    found = backward_angles(pitch, 1.0)
    lift = pitch.motion.jet(DENSE)
    back = 45.0 + lift[0] + lift[2] < 0.0
    assert len(found) == ranges_of(back) > 80
    assert np.array_equal(inside(found), back)


@pytest.mark.parametrize("number", [5, 7, 22, 23, 77])
def test_what_remains_of_a_noisy_table_is_clear_of_the_follower(
    number: int, tmp_path: Path
) -> None:
    """Drawn cases in which ranges of undercut, or their crossings, were once lost."""
    assert miss(*drawn(np.random.default_rng([7, number]), tmp_path)) == ""
