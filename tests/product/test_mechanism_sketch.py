"""The sketch of a mechanism: bodies stay rigid, roller and face lie where the cam holds them."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.sketch import MechanismSketch
from camgeo.scene.scene import load_scene
from camgeo.units import MM_PER, TURN
from tests.findings import known

SCENES = sorted((Path(__file__).resolve().parents[2] / "fixtures" / "scenes").glob("*.toml"))

ANGLES = np.random.default_rng(7).uniform(0.0, TURN, 7)

ROUNDING = 1e-12
"""Rounding of a point, as a share of the mechanism's size: some sines and sums."""


@pytest.fixture(params=SCENES, ids=lambda path: path.stem)
def design(request: pytest.FixtureRequest) -> Design:
    return Design(load_scene(request.param))


def lengths(sketch: MechanismSketch[complex]) -> list[float]:
    """Lengths of the links, from point to point."""
    return [abs(b - a) for link in sketch.links for a, b in pairwise(link)]


def test_links_keep_their_lengths_and_what_is_fixed_its_place(design: Design) -> None:
    """A guide stays, and holds its slider all the way."""
    start = design.disc.pictured.mechanism_sketch(0.0)
    size = max(abs(point) for point in start.points)
    for phi in ANGLES:
        sketch = design.disc.pictured.mechanism_sketch(float(phi))
        assert lengths(sketch) == pytest.approx(lengths(start), abs=ROUNDING * size)
        assert sketch.shafts == start.shafts
        for guide, first in zip(sketch.guides, start.guides, strict=True):
            way = (guide.middle - first.middle) * first.direction.conjugate()
            assert guide.direction == first.direction
            assert abs(way.imag) <= ROUNDING * size
            assert guide.travel == first.travel
            assert len(guide.travel) == 2 * guide.block
            ways = [((at - guide.middle) / guide.direction).real for at in guide.travel] or [0.0]
            assert min(ways) <= ROUNDING * size
            assert max(ways) >= -ROUNDING * size


def test_dimensions_are_the_scenes_own_wherever_the_cam_is(design: Design) -> None:
    """Each is measured between its ends, and is what the scene has at its key."""
    unit = MM_PER[design.scene.unit]
    for phi in (0.0, *map(float, ANGLES[:2])):
        sketch = design.disc.pictured.mechanism_sketch(phi)
        assert sketch.dimensions
        size = max(abs(point) for point in sketch.points)
        for each in sketch.dimensions:
            tables, key = each.key.rpartition(".")[::2]
            table: Any = design.scene.values
            for name in tables.split("."):
                table = table[name]
            # What a return roller does not state is as of the main one.
            stated = table.get(key, design.scene.values["follower"].get(key))
            stated = stated if isinstance(stated, list | tuple) else [stated]
            expected = [float(value) * unit for value in stated]
            assert list(each.value) == pytest.approx(expected, abs=10.0 * ROUNDING * size), each.key


def test_rollers_lie_on_the_pitch_curves_of_the_turned_discs(design: Design) -> None:
    discs = design.discs
    for phi in ANGLES:
        rollers = design.disc.pictured.mechanism_sketch(float(phi)).rollers
        for disc, (centre, radius) in zip(discs, rollers, strict=False):
            ((x, y),) = disc.pictured.curve("pitch", np.array([phi]))
            turned = complex(x, y) * cmath.exp(1j * design.cam.rotation * phi)
            assert abs(centre - turned) <= ROUNDING * abs(turned)
            assert radius == disc.cam.follower.roller_radius


def test_faces_touch_the_turned_disc(design: Design) -> None:
    pictured = design.disc.pictured
    outline = pictured.curve("pitch", np.linspace(0.0, TURN, 3601)) @ np.array([1.0, 1j])
    for phi in ANGLES:
        ((x, y),) = pictured.curve("pitch", np.array([phi]))
        turn = cmath.exp(1j * design.cam.rotation * phi)
        for number, (start, end) in enumerate(pictured.mechanism_sketch(float(phi)).faces):
            along = (end - start) / abs(end - start)
            outward = 1j * along if ((start * along.conjugate()).imag > 0.0) else -1j * along
            beyond = ((outline * turn - start) * outward.conjugate()).real
            assert np.max(beyond) <= ROUNDING * abs(start)
            contact = complex(x, y) * turn
            if number == 0:
                assert abs(((contact - start) * outward.conjugate()).real) <= 1e-9
                assert 0.0 < ((contact - start) * along.conjugate()).real < abs(end - start)
            else:  # the far side of a yoke, touched at a point between two of the outline's
                assert np.max(beyond) >= -1e-3


def test_the_far_angle_is_where_the_demanded_motion_is_farthest(design: Design) -> None:
    phi = np.linspace(0.0, TURN, 3601)
    strokes = np.abs(design.drive.plan.jet(phi)[0])
    far = design.drive.far_angle
    assert 0.0 <= far < TURN
    farthest = float(np.abs(design.drive.plan.jet(np.array([far]))[0, 0]))
    assert farthest >= float(strokes.max()) * (1.0 - ROUNDING)


def test_a_rod_reaches_through_its_guide_all_the_time() -> None:
    design = Design(load_scene(next(path for path in SCENES if path.stem == "plate_translating")))
    for phi in (0.0, design.drive.far_angle, *ANGLES):
        sketch = design.disc.pictured.mechanism_sketch(float(phi))
        ((foot, end),) = sketch.links
        (guide,) = sketch.guides
        along = [((p - guide.middle) / guide.direction).real for p in (foot, end)]
        assert along[0] < 0.0 < along[1]
        assert math.isclose(((end - foot) / guide.direction).imag, 0.0, abs_tol=1e-9)


FOLDER = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.mark.parametrize("name", ["tappet", "flat_rocker"])
def test_the_contact_lies_on_the_face_that_is_drawn(name: str) -> None:
    design = camgeo.load(FOLDER / f"{name}.toml")
    sketch = design.disc.pictured.follower_sketch
    start, end = known(sketch.face)
    contact = complex(*design.disc.pictured.curve("pitch", np.zeros(1))[0])
    share = (contact - start) / (end - start)
    assert abs(share.imag) <= 1e-14
    assert 0.0 < share.real < 1.0
    # As long as the scene says, that of a rocker on to the foot of its pivot.
    assert abs(end - start) == pytest.approx({"tappet": 20.0, "flat_rocker": 100.0}[name])
    foot = start if sketch.kind == "pivot" else contact
    assert abs(((sketch.end - foot) / (end - start)).real) <= 1e-14
