"""What scenes state of followers and linkages, and how both are drawn, for every template."""

from __future__ import annotations

import math
import re
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN

TEMPLATES: Final = Path(camgeo.__file__).parent / "scene" / "templates"

NAMES: Final = sorted(path.stem for path in TEMPLATES.glob("*.toml"))

SIGNS: Final = {"outward": 1, "inward": -1, "left": 1, "right": -1}

FIELDS: Final = {
    "crank_deflection": "deflection",
    "crank_leans": "leans_away",
    "kind": "",
    "contact": "",
    "side_clearance": "",
    "return": "",
    "yoke": "",
}
"""Keys whose field has another name, or that are none of the body's."""

ANGLES: Final = ("guide_angle", "lever_angle", "crank_deflection")

PHI: Final = np.random.default_rng(3).uniform(0.0, TURN, 6)


def text(name: str) -> str:
    return (TEMPLATES / f"{name}.toml").read_text(encoding="utf-8")


@cache
def design(name: str) -> Design:
    return Design(parse_scene(text(name)))


def stated(key: str, value: Any, mm: float) -> Any:
    """The value of a table in mm, radians and signs."""
    if key == "branch":  # the side of a crank's tip, clockwise first
        return {"cw": 1, "ccw": -1}[value]
    if key == "crank_leans":
        return value == "away"
    if key in ("arm_side", "lever_sense"):
        return {"ccw": 1, "cw": -1}[value]
    if isinstance(value, str):
        return SIGNS[value]
    if key in ANGLES:
        return math.radians(value)
    if isinstance(value, bool):
        return value
    if isinstance(value, tuple):
        ends = tuple(mm * float(each) for each in value)
        return ends if key == "face" else complex(*ends)
    return mm * float(value)


def inches(text: str) -> str:
    """The same figures, as inches."""
    return re.sub(r'^length = "mm"', 'length = "inch"', text, count=1, flags=re.MULTILINE)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mm", [1.0, 25.4])
def test_followers_and_linkages_have_what_the_scene_states(name: str, mm: float) -> None:
    scene = parse_scene(text(name) if mm == 1.0 else inches(text(name)))
    made = Design(scene)
    linkage: Any = made.drive.linkage
    bodies = [("follower", made.cam.follower)]
    if linkage is not None:
        bodies.append(("linkage", getattr(linkage, "inner", linkage)))
    for table, body in bodies:
        for key, value in scene.values[table].items():
            field = FIELDS.get(key, key)
            if field and not (key == "direction" and linkage is not None and body.pivot):
                expected = stated(key, value, mm)
                assert getattr(body, field) == pytest.approx(expected, rel=1e-15), key
    if linkage is not None and made.cam.lift_unit == "rad":
        rocker: Any = made.cam.follower
        assert rocker.direction is None
    follower = scene.values["follower"]
    assert made.cam.contact.value == follower.get("contact", "inner")
    assert made.cam.clearance == pytest.approx(mm * float(follower.get("side_clearance", 0)))
    if "return" in follower:
        other: Any = made.cams[1].follower
        for key, value in follower["return"].items():
            if key in ("offset", "roller_radius", "arm"):
                sign = -1.0 if key == "offset" else 1.0  # it looks the other way along its guide
                assert getattr(other, key) == pytest.approx(sign * mm * float(value), rel=1e-15)


def test_a_roller_without_a_radius_is_an_edge() -> None:
    assert design("knife-edge").cam.follower.has_edge
    for name in ("translating-roller", "oscillating-roller", "translating-flat"):
        assert not design(name).cam.follower.has_edge


# Pictures -----------------------------------------------------------------------------------------


def sketch_at(name: str, phi: float) -> MechanismSketch[complex]:
    return design(name).disc.pictured.mechanism_sketch(phi)


@pytest.mark.parametrize("name", NAMES)
def test_bodies_are_rigid_and_measure_what_the_scene_states(name: str) -> None:
    start = sketch_at(name, 0.0)
    size = float(np.max(np.abs(start.points)))
    pairs = [abs(b - a) for link in start.links for a, b in pairwise(link)]
    keys = [each.key for each in start.dimensions]
    assert len(set(keys)) == len(keys) >= 1
    for phi in map(float, PHI):
        found = sketch_at(name, phi)
        assert found.shafts == start.shafts
        lengths = [abs(b - a) for link in found.links for a, b in pairwise(link)]
        assert lengths == pytest.approx(pairs, abs=1e-11 * size)
        assert [each.key for each in found.dimensions] == keys
        for each in found.dimensions:
            tables, key = each.key.rpartition(".")[::2]
            table: Any = design(name).scene.values
            for part in tables.split("."):
                table = table[part]
            own = table.get(key, design(name).scene.values["follower"].get(key))
            wanted = [float(v) for v in (own if isinstance(own, tuple) else (own,))]
            assert list(each.value) == pytest.approx(wanted, abs=1e-10 * size), each.key
        for guide, first in zip(found.guides, start.guides, strict=True):
            assert guide.direction == first.direction
            assert abs(guide.direction) == pytest.approx(1.0)
            along = (guide.middle - first.middle) / first.direction
            assert abs(along.imag) <= 1e-11 * size
            ways = sorted(((at - first.middle) / first.direction).real for at in guide.travel)
            assert not ways or ways[0] - 1e-9 * size <= along.real <= ways[1] + 1e-9 * size


@pytest.mark.parametrize("name", NAMES)
def test_rollers_are_on_the_turned_discs_and_joints_at_the_ends_of_links(name: str) -> None:
    made = design(name)
    cams = made.cams
    for phi in map(float, PHI):
        found = sketch_at(name, phi)
        turn = np.exp(1j * made.cam.rotation * phi)
        ends = [point for link in found.links for point in (link[0], link[-1])]
        for cam, (centre, radius) in zip(cams, found.rollers, strict=False):
            on_curve = complex(cam.disc.pitch_curve.point(np.array([phi]))[0] * turn)
            assert abs(centre - on_curve) <= 1e-11 * abs(centre)
            assert radius == cam.follower.roller_radius
            assert min(abs(each - centre) for each in ends) <= 1e-9
        for joint in found.joints:
            assert sum(abs(each - joint) <= 1e-9 for each in ends) >= 1
        # Whatever is drawn is within the picture: rims of rollers, ends of faces, guides.
        points = found.points
        for centre, radius in found.rollers:
            for way in (1, 1j, -1, -1j):
                assert np.min(np.abs(points - (centre + radius * way))) <= 1e-9
        drawn = [*ends, *found.shafts, *found.joints, *(p for face in found.faces for p in face)]
        drawn += [guide.middle for guide in found.guides]
        drawn += [at for guide in found.guides for at in guide.travel]
        assert all(np.min(np.abs(points - each)) <= 1e-9 for each in drawn)


@pytest.mark.parametrize("name", NAMES)
def test_one_position_of_many_is_the_position_alone(name: str) -> None:
    many: MechanismSketch[Places] = design(name).disc.pictured.mechanism_sketches(PHI)
    for number, phi in enumerate(map(float, PHI)):
        found, alone = many.position(number), sketch_at(name, phi)
        assert len(found.points) == len(alone.points)
        assert found.points == pytest.approx(alone.points, abs=1e-12 * 200.0)
        for each, other in zip(found.dimensions, alone.dimensions, strict=True):
            assert (each.key, each.vector, each.negative) == (
                other.key, other.vector, other.negative
            )  # fmt: skip
            assert each.value == pytest.approx(other.value, abs=1e-10)


@pytest.mark.parametrize("angle", [90, 20])
@pytest.mark.parametrize("name", ["translating-roller", "translating-flat", "knife-edge"])
def test_a_rod_reaches_from_the_contact_through_its_guide(name: str, angle: int) -> None:
    """The guide is clear of the farthest place of the rod's foot, and the rod passes it always."""
    turned = Design(parse_scene(re.sub(r"guide_angle = \d+", f"guide_angle = {angle}", text(name))))
    way = np.exp(1j * math.radians(angle))
    feet = []
    for phi in (*np.linspace(0.0, TURN, 24),):
        found = turned.disc.pictured.mechanism_sketch(float(phi))
        (link,) = (each for each in found.links if len(each) == 2)
        (guide,) = found.guides
        assert not guide.block
        assert guide.direction == pytest.approx(way, rel=1e-14)
        foot, end = (complex(each) for each in link)
        assert ((end - foot) / way).imag == pytest.approx(0.0, abs=1e-9)
        along = [((each - guide.middle) / way).real for each in (foot, end)]
        assert along[0] < 0.0 < along[1]
        if not phi:  # at lift 0 it protrudes by three tenths of the base radius
            assert along[1] == pytest.approx(0.3 * turned.cam.follower.base_radius, rel=1e-12)
        feet.append(along[0])
    base = float(turned.cam.follower.base_radius)
    assert max(feet) == pytest.approx(-0.8 * base, rel=1e-3)


def test_a_yoke_shows_its_far_side_and_a_return_roller_its_bracket() -> None:
    """A bracket goes from one side of the disc to the other, clear of it."""
    for phi in map(float, PHI):
        found = sketch_at("constant-breadth", phi)
        assert len(found.faces) == 2
        (a, b), (c, d) = found.faces
        assert abs(((b - a) / (d - c)).imag) <= 1e-12
        normal = (b - a) / abs(b - a)
        assert abs(((c - a) / normal).imag) == pytest.approx(92.0, rel=1e-12)
        pair = sketch_at("conjugate-carriage", phi)
        assert len(pair.rollers) == 2
        disc = max(abs(centre) for centre, _ in pair.rollers)
        bracket = next(link for link in pair.links if len(link) == 4)
        assert {abs(bracket[0] - each) <= 1e-9 for each, _ in pair.rollers} == {True, False}
        assert {abs(bracket[3] - each) <= 1e-9 for each, _ in pair.rollers} == {True, False}
        straight = bracket[3] - bracket[0]
        for corner, end in ((bracket[1], bracket[0]), (bracket[2], bracket[3])):
            aside = (corner - end) / straight
            assert aside.real == pytest.approx(0.0, abs=1e-12)
            assert abs(corner - end) > disc
        assert bracket[2] - bracket[1] == pytest.approx(straight, rel=1e-12)
