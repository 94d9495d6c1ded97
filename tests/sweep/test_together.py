"""Designs that are answered at once: each has the bits that it has alone, whatever its mates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import camgeo
from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.together import alike, several
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.follower import RelativeJet
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import Scene, load_scene
from camgeo.scene.values import Value
from camgeo.studies.sweep.family import Family, Point
from camgeo.studies.sweep.rows import (
    TOGETHER,
    DesignReading,
    DesignRow,
    Work,
    alike_designs,
    compute_rows,
    parse_questions,
    read,
    read_together,
)
from tests.strategies import attack
from tests.sweep.families import FIXTURES, LAWS, family
from tests.sweep.test_rows import work_on

TEMPLATES: Final = Path(camgeo.__file__).parent / "scene" / "templates"

ASKED: Final = ("transmission-angle", "min:mu", "peak:kappa")

BY_CURVE: Final = {True: ("max:outer-x", "min:pitch-y"), False: ("max:contact-x", "peak:on-face")}
"""Columns that only some followers have, by whether they have a pitch curve."""

STEPS: Final = (1.0, 1.0005, 1.003, 0.9996, 1.001)
"""Small enough for every scene; large enough for other roots, and as many steps to them."""


BODIES: Final = ("follower", "linkage")


def numbers_of(scene: Scene) -> list[str]:
    """Keys of the numbers in [follower] and [linkage]."""
    found = []
    for body in BODIES:
        for key, value in scene.values.get(body, {}).items():
            if isinstance(value, tuple | list):
                found += [f"{body}.{key}[{place}]" for place in (1, 2)]
            elif isinstance(value, int | Decimal) and not isinstance(value, bool):
                found.append(f"{body}.{key}")
    return [key for key in found if key != "follower.side_clearance"]  # of the groove


COUPLERS: Final = "linkage.coupler=20,122.87,150,170"

CONTACTS: Final = "follower.contact=inner,outer"

SCENES: Final = {path.stem: load_scene(path) for path in sorted(TEMPLATES.glob("*.toml"))}

VARIED: Final = [(name, key) for name, scene in SCENES.items() for key in numbers_of(scene)]


def varied(scene: Scene, *keys: str) -> list[Design]:
    """Designs with other numbers at all `keys`, as far as the scene admits them."""
    found = []
    for step in STEPS:
        edits = {}
        for key in keys:
            body, _, within = key.partition(".")
            name, _, place = within.partition("[")
            value = scene.values[body][name]
            value = value[int(place.removesuffix("]")) - 1] if place else value
            edits[key] = float(value) * step
        found.append(Design(scene.with_values(edits)))
    return found


def check_alike(scene: Scene, *keys: str) -> None:
    """All are answered at once, nothing falls back, and with the bits of each alone."""
    first = Design(scene)
    own: tuple[str, ...] = BY_CURVE[first.cam.follower.has_pitch_curve]
    if "follower.roller_radius" in keys:
        own = own[1:]  # parallels at several distances are not one curve
    if "linkage" in scene.values:
        own += ("max:psi",) if first.cam.lift_unit == "rad" else ("max:s",)
    for asked in parse_questions(first, (*ASKED, *own)):
        designs = varied(scene, *keys)
        assert len({alike_designs(design) for design in designs}) == 1
        together = TOGETHER[asked.group](designs, asked)
        alone = [read(design, asked) for design in varied(scene, *keys)]
        assert repr(together) == repr(alone), (asked.word, keys)
        assert all(reading.value is not None for reading in alone)


@pytest.mark.parametrize(("body", "kinds"), [("follower", FOLLOWERS), ("linkage", LINKAGES)])
def test_every_kind_has_a_scene(body: str, kinds: Mapping[str, object]) -> None:
    found = {scene.values[body]["kind"] for scene in SCENES.values() if body in scene.values}
    assert found == set(kinds)


@pytest.mark.parametrize(("name", "key"), VARIED)
def test_one_number(name: str, key: str) -> None:
    check_alike(SCENES[name], key)


@pytest.mark.parametrize("name", SCENES)
def test_all_numbers(name: str) -> None:
    check_alike(SCENES[name], *numbers_of(SCENES[name]))


@cache
def mixed() -> tuple[Work, dict[Point, DesignRow]]:
    """Designs of two contacts and laws, some of them impossible, behind linkages of which one does
    not close, and crank and coupler are either the longer one: work, and rows alone.
    """
    found = family("follower.base_radius=-1,1.2,50,53.7,130", COUPLERS, CONTACTS, LAWS)
    asked = "transmission-angle", "peak:kappa", "peak:a", "peak:psi", "linkage-back-angle"
    work = work_on(found, *asked)
    alone = {point: work.rows([point])[0] for point in found.points()}
    assert {row.failed for row in alone.values()} == {True, False}
    return work, alone


@attack
@given(st.data())
def test_mates_do_not_matter(data: st.DataObject) -> None:
    """Any designs in any order, again and again, among them such as have no answer."""
    work, alone = mixed()
    points = data.draw(st.lists(st.sampled_from([*alone]), min_size=2, max_size=20))
    assert repr(compute_rows(work, points)) == repr(tuple(alone[point] for point in points))


@pytest.mark.parametrize("place", range(5))
def test_a_design_without_an_answer_leaves_the_others_theirs(
    place: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    speed = PitchCurve.speed

    def standing(curve: PitchCurve, relative: RelativeJet) -> FloatArray:
        if np.any(np.equal(curve.follower.base_radius, 50.0 + place)):
            raise GeometryError("the roller centre stands still")
        return speed(curve, relative)

    found = family("follower.base_radius=50:54:5")
    (asked,) = parse_questions(Design(found.scene), ["min:mu"])
    points = list(found.points())
    whole = [read(Design(found.design_scene(point)), asked) for point in points]
    monkeypatch.setattr(PitchCurve, "speed", standing)
    together = read_together([Design(found.design_scene(point)) for point in points], asked)
    assert together[place] == DesignReading(None, "", "the roller centre stands still")
    assert together[:place] + together[place + 1 :] == whole[:place] + whole[place + 1 :]


def test_designs_that_are_not_alike() -> None:
    """Whatever decides between formulas, or belongs to the drive, separates them."""
    lever, linked = SCENES["oscillating-roller"], family().scene
    for base, edits in (
        (lever, {"follower.direction": "inward"}),
        (lever, {"follower.arm_side": "cw"}),
        (lever, {"cam.rotation": "ccw"}),
        (lever, {"cam.speed": 91}),
        (lever, {"motion[2].to": 11}),
        (linked, {"linkage.mirrored": True, "follower.direction": "outward"}),
    ):
        other = base.with_values(edits)
        assert alike_designs(Design(other)) != alike_designs(Design(base)), edits
    numbers = {"follower.arm": 61.3, "linkage.coupler": 123}
    same = linked.with_values({**numbers, "limits.transmission_angle": 40})
    assert alike_designs(Design(same)) == alike_designs(Design(linked))


def test_zeros_of_both_signs_are_different_numbers() -> None:
    """A column is one number only if all its bits are the same."""
    guided = Design(load_scene(FIXTURES / "scenes" / "knife_edge.toml")).cam.follower
    signs = [type(guided)(50.0, 0.0, offset) for offset in (0.0, -0.0)]  # type: ignore[call-arg]  # a translating roller
    assert alike(signs[0]) == alike(signs[1])
    one = several(signs, np.array([1, 0, 1]))
    assert [math.copysign(1.0, each) for each in np.atleast_1d(one.offset)] == [-1.0, 1.0, -1.0]


def test_designs_of_one_motion_share_its_plan() -> None:
    """Whatever else varies between them; one that fails does not stand for the others."""
    found = family(
        "follower.base_radius=-1,50,51", "motion.2.law=no-such-law,cycloidal,modified-sine"
    )
    work = work_on(found, "transmission-angle")
    plans: dict[Value, list[MotionPlan]] = {}
    for point in found.points():
        try:
            scene = work.design_scene(point)
        except SceneError:
            continue
        own = found.design_scene(point)
        assert scene == own
        assert scene.to_toml() == own.to_toml()
        plans.setdefault(point[1], []).append(scene.plan)
    assert {law: len(each) for law, each in plans.items()} == {"cycloidal": 2, "modified-sine": 2}
    assert all(each[0] is each[1] for each in plans.values())
    assert plans["cycloidal"][0] is not plans["modified-sine"][0]


def test_families_of_any_size() -> None:
    """More designs than are computed at once."""
    found: Family = family("follower.base_radius=45:60:67")
    work = work_on(found, "transmission-angle")
    points = list(found.points())
    rows = compute_rows(work, points)
    assert [row.point for row in rows] == points
    for place in (0, 63, 64, 66):
        assert [rows[place]] == work.rows([points[place]])
