"""The result of `camgeo size`, rendered as text, JSON and picture."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from camgeo.app.answers.answer import figure, text
from camgeo.app.answers.size import BAD, CamSize, size, sized_scene
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"


@cache
def with_arm() -> CamSize:
    """A sizing with another arm; which one is best is a matter of `tests.check.test_sizing`."""
    return size(Design(load_scene(SETZHUB)), arms=(40.0, 40.0))


def test_what_cannot_be_met_is_reported_in_the_same_way() -> None:
    found = size(Design(load_scene(SETZHUB)), transmission_angle=math.radians(80.0))
    reported = document(found)
    assert (reported["smallest"], reported["active"], found.exit_code) == (None, [], 1)
    assert reported["infeasible"] in text(found).splitlines()
    assert reported["nearest"]["transmission_angle_deg"] < 80.0
    with pytest.raises(GeometryError, match="only at the exact limit"):
        sized_scene(found)


def test_the_scene_with_the_answer_keeps_what_was_required() -> None:
    found = with_arm()
    assert "all but the present design have an arm of 40.0000 mm" in text(found)
    written = sized_scene(found)
    again = size(Design(written))
    assert again.present is not None
    assert found.best.written is not None
    assert again.present.follower == found.best.written.follower
    assert again.present.follower.arm == 40.0
    assert again.present.transmission_angle.value >= found.best.sizing.angle
    # On the side that was found, only the last digit is left to be gained.
    assert again.best is again.scene_side
    assert again.best.written is not None
    assert again.best.written.base_radius == again.present.base_radius


@pytest.mark.parametrize("name", ["schnitt", "setzhub", "flat_rocker"])
def test_both_sides_of_a_rocker_are_reported(name: str) -> None:
    design = Design(load_scene(FIXTURES / "scenes" / f"{name}.toml"))
    found = size(design)
    own, other = document(found)["sides"]
    assert (own["arm_side"], other["arm_side"]) in (("ccw", "cw"), ("cw", "ccw"))
    follower: Any = design.cam.follower
    assert (own["arm_side"] == "ccw") == (follower.arm_side > 0)
    best = min(own, other, key=lambda side: side["smallest"]["base_radius_mm"])
    assert document(found)["written"] == best["written"]
    assert ("follower.arm_side" in text(found)) == (best is other)
    edits = {"follower.arm_side": other["arm_side"]}
    if design.scene.linkage is not None:  # it moves the roller the other way there
        edits |= {"follower.direction": None}
    turned = design.scene.with_values(edits)
    mirrored = size(Design(turned))
    assert document(mirrored)["sides"][0]["written"] == other["written"]
    assert document(mirrored)["written"] == best["written"]
    json.dumps(figure(found).to_data(), allow_nan=False)


def test_what_is_proved_is_reported() -> None:
    exact = size(Design(load_scene(FIXTURES / "scenes" / "querhub.toml")))
    bounded = size(Design(load_scene(FIXTURES / "scenes" / "groove.toml")))
    for found, word in ((exact, "exactly"), (bounded, "it is proved that nothing below")):
        proof = document(found)["proof"]
        assert word in text(found)
        assert proof["exact"] is (found is exact)
        limit = document(found)["smallest"]["base_radius_mm"]
        assert proof["none_below_mm"] <= limit <= document(found)["written"]["base_radius_mm"]
        assert proof["none_below_mm"] == pytest.approx(limit, rel=0.0 if found is exact else 1e-3)


def test_a_side_that_is_only_bounded_leaves_the_answer_bounded() -> None:
    """An exact answer on one side does not rule out a smaller cam on the other."""
    found = size(Design(load_scene(FIXTURES / "scenes" / "querhub.toml")))
    own, other = found.sides
    assert found.proof.exact
    near = replace(other.sizing, none_below=0.9 * own.base_radius, reach=1000.0)
    doubtful = replace(found, sides=(own, replace(other, sizing=near)))
    assert not doubtful.proof.exact
    assert doubtful.proof.none_below == near.none_below
    assert "it is proved that nothing below" in text(doubtful)


def test_the_face_of_a_follower_is_made_long_enough() -> None:
    """On the smaller cam the contact runs farther out; a guided face is long enough here."""
    found = size(Design(load_scene(FIXTURES / "scenes" / "flat_rocker.toml")))
    reported = document(found)
    low, high = reported["written"]["contact_mm"]
    assert reported["face_mm"][0] == 60.0 < low
    assert high <= reported["face_mm"][1] < high + 0.01
    assert "needs follower.face = [60.0, 103.31]" in text(found)
    follower: Any = sized_scene(found).follower
    assert follower.face == tuple(reported["face_mm"])
    assert "face_mm" not in document(size(Design(load_scene(FIXTURES / "scenes" / "tappet.toml"))))


def test_a_yoke_and_a_return_disc_go_with_the_sizes() -> None:
    """The yoke closes as before, and the return disc of a carriage stays as it is."""
    before = Design(load_scene(FIXTURES / "scenes" / "constant_breadth.toml"))
    found = size(before, radius_of_curvature=4.0)
    after = Design(sized_scene(found))
    (old, new) = (
        next(each.value for each in one.findings if each.name == "closing-error")
        for one in (before, after)
    )
    assert found.remarks == ()
    assert new == pytest.approx(old, abs=1e-9)
    pair = Design(load_scene(FIXTURES / "scenes" / "conjugate_carriage.toml"))
    smaller = Design(sized_scene(size(pair)))
    one, other = pair.cams[1].follower, smaller.cams[1].follower
    assert other.base_radius == pytest.approx(one.base_radius, abs=1e-4)
    assert other.offset == pytest.approx(one.offset, abs=1e-4)


def test_faults_of_a_return_disc_are_reported() -> None:
    """On the smaller cam the return arm reaches the line of centres, or its disc fails."""
    design = Design(load_scene(FIXTURES / "scenes" / "conjugate_lever.toml"))
    found = size(design)
    reported = {each["name"] for each in document(found)["remarks"]}
    left = [each.name for each in Design(sized_scene(found)).findings if each.severity in BAD]
    assert reported == set(left)
    assert all(name.startswith("return: ") for name in reported)
    assert reported
    assert "camgeo check finds in that scene: return disc:" in text(found)


def test_a_yoke_of_rollers_keeps_its_offset_of_0() -> None:
    scene = load_scene(FIXTURES / "scenes" / "constant_breadth.toml")
    rolling = scene.with_values(
        {
            "follower.kind": "translating-roller",
            "follower.roller_radius": 4,
            "follower.face": None,
            "follower.yoke.breadth": 62,
        }
    )
    found = size(Design(rolling))
    assert found.best.written is not None
    assert found.best.written.follower.offset == 0.0
    assert found.best.sizing.answer is not None
    after = Design(sized_scene(found))
    assert not [each for each in after.findings if each.severity in BAD and "clos" not in each.name]


def test_a_linkage_that_locks_is_infeasible_at_any_size() -> None:
    found = size(Design(load_scene(FIXTURES / "found" / "dead_centre.toml")))
    assert found.exit_code == 1
    assert found.best.infeasible is not None
    assert "infeasible at any size: crank and coupler come into line" in found.best.infeasible
    assert found.best.infeasible in text(found).splitlines()
    assert document(found)["written"] is None
    json.dumps(figure(found).to_data(), allow_nan=False)


@pytest.mark.parametrize(
    ("scene", "remarks"),
    [
        ("found/near_dead_centre", {"linkage-transmission-angle"}),
        ("scenes/straight_moves", {"tangent-closure", "lost-stroke-inner"}),
    ],
)
def test_what_no_size_cures_is_a_remark(scene: str, remarks: set[str]) -> None:
    """The transmission angle of a linkage; corners of the pitch curve by jumps of the velocity."""
    found = size(Design(load_scene(FIXTURES / f"{scene}.toml")))
    assert found.best.written is not None
    assert {each.name for each in found.remarks} == remarks


def test_a_limit_that_cannot_be_rounded_is_reported() -> None:
    found = with_arm()
    sides = tuple(replace(each, rounded=None) for each in found.sides)
    none = replace(found, sides=sides)
    assert none.exit_code == 1
    assert "no sizes near this limit pass the checks" in text(none)
    assert document(none)["written"] is None
    assert document(none)["smallest"] is not None
