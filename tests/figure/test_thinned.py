"""Thinned figures: nothing that is seen is lost."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgeo.app.designing.work import PAPER, READ, SEEN, thin_lines, thinned, thinned_turn
from camgeo.design.design import Design
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures import motion
from camgeo.pictures.mechanism import CHORDS, animation
from camgeo.pictures.model import Area, Figure, Line
from camgeo.pictures.motion import CURVE_POINTS
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests.test_architecture import ROOT

BOUND = 1.25 * READ
"""What thinning and rounding change of a diagram on paper [inch]."""

ROUNDING = 1e-12


def design(name: str) -> Design:
    return Design(load_scene(ROOT / f"fixtures/scenes/{name}.toml"))


def figures(of: Design) -> list[Figure]:
    first = motion.drive_figure(of.name, of.scene.unit, of.drive, of.scene.lift_unit)
    return [first, motion.curvature(of.disc), motion.transmission_angle(of.disc)]


def scales(figure: Figure) -> list[tuple[float, float]]:
    """Inches on paper per unit of both axes of each panel."""
    return [
        (
            (right - left) * figure.size[0] / (panel.x.limits[1] - panel.x.limits[0]),
            (high - low) * figure.size[1] / (panel.y.limits[1] - panel.y.limits[0]),
        )
        for panel in figure.panels
        for left, low, right, high in [panel.frame]
    ]


def apart(points: FloatArray, line: FloatArray) -> float:
    """The largest distance of `points` (n, 2) from a line."""
    return float(np.max(shapely.distance(shapely.points(points), shapely.linestrings(line))))


@st.composite
def lines(draw: st.DrawFn) -> list[np.ndarray]:
    """Lines of smooth stretches with jumps, kinks and points that coincide."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    found = []
    for _ in range(draw(st.integers(1, 3))):
        count = int(random.integers(CURVE_POINTS + 2, 600))
        t = np.linspace(0.0, 1.0, count)
        waves = [random.normal() * np.sin(random.uniform(1.0, 60.0) * t) for _ in range(3)]
        y = (
            np.sum(waves, axis=0)
            + random.normal() * (t > random.uniform())
            + np.abs(t - random.uniform())
        )
        again = int(random.integers(1, count))
        found.append(np.insert(t + 1j * y, again, (t + 1j * y)[again]))
    return found


@given(lines(), st.floats(1e-5, 1e-1))
def test_no_point_is_farther_off_than_allowed(found: list[np.ndarray], most: float) -> None:
    ends = np.cumsum([0, *map(len, found)])
    kept = thin_lines(np.concatenate(found), ends, most)
    assert np.all(np.diff(kept) > 0)
    for points, first in zip(found, ends[:-1].tolist(), strict=True):
        own = kept[(kept >= first) & (kept < first + len(points))] - first
        assert own[0] == 0
        assert own[-1] == len(points) - 1
        assert len(own) > CURVE_POINTS
        plane = np.column_stack((points.real, points.imag))
        assert apart(plane, plane[own]) <= most + ROUNDING


@pytest.mark.parametrize("name", ["setzhub", "straight_moves", "measured", "tappet", "knife_edge"])
def test_diagrams_look_the_same(name: str) -> None:
    for figure in figures(design(name)):
        for before, after, scale in zip(
            figure.panels, thinned(figure).panels, scales(figure), strict=True
        ):
            for one, other in zip(before.marks, after.marks, strict=True):
                if isinstance(one, Line) and len(one.points) > CURVE_POINTS:
                    assert isinstance(other, Line)
                    assert len(one.points) > len(other.points) > CURVE_POINTS
                    assert apart(one.points * scale, other.points * scale) <= BOUND
                    assert apart(other.points * scale, one.points * scale) <= BOUND


@pytest.mark.parametrize("name", ["setzhub", "shuttle", "points"])
@pytest.mark.parametrize("order", [0, 1])
def test_diagrams_show_the_exact_motion(name: str, order: int) -> None:
    """Between two of the points drawn at first a curve is off by h^2/8 times its second derivative,
    which the motion states.
    """
    of = design(name)
    figure = figures(of)[0]
    number, line = [
        (number, mark)
        for number, panel in enumerate(thinned(figure).panels)
        for mark in panel.marks
        if isinstance(mark, Line)
        and len(mark.points) > CURVE_POINTS
        and np.ptp(mark.points.T[0]) > 359
    ][order]
    phi = np.random.default_rng(1).uniform(0.0, TURN, 4000)
    jet = of.drive.plan.jet(phi)
    unit = 1.0 if of.drive.unit == "mm" else np.degrees(1.0)
    scale = scales(figure)[number]
    exact = np.column_stack((np.degrees(phi), jet[order] * unit)) * scale
    step = TURN / 1440.0
    chords = step**2 / 8.0 * np.max(np.abs(jet[order + 2])) * unit * scale[1]
    assert apart(exact, line.points * scale) <= BOUND + 1.01 * chords


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("name", ["setzhub", "groove", "trimmed_ring", "conjugate_lever", "tappet"])
def test_the_disc_shown_is_the_exact_one(name: str, moving: bool) -> None:
    """In a drag before it is judged, unless flanks are cut off."""
    of = design(name)
    turn = animation(of.disc, moving=moving)
    trimmed = any(of.cam.disc.outline(flank).is_trimmed for flank in of.cam.contact.flanks)
    assert ("findings" in vars(of.judgement)) is (not moving or trimmed)
    extent = turn.high - turn.low
    pixel = 1.25 * SEEN * max(extent.real, extent.imag) / PAPER
    base = of.cam.follower.base_radius
    rings = [
        shapely.LinearRing(ring)
        for mark in thinned_turn(turn).turning
        if isinstance(mark, Area)
        for ring in mark.rings
    ]
    phi = np.random.default_rng(2).uniform(0.0, TURN, 2000)
    for flank in of.cam.contact.flanks:
        outline = of.cam.disc.outline(flank)
        if outline.is_trimmed:
            continue
        at = of.cam.disc.curve(flank).point(phi)
        points = shapely.points(at.real, at.imag)
        off = np.min([shapely.distance(points, ring) for ring in rings], axis=0)
        assert np.max(off) <= CHORDS * base + pixel
