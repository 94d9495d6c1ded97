"""Every remedy works when its printed values are written into the scene at the keys it names, is
the nearest one, and breaks no limit that held.

The scenes of fixtures/found are public reports: a remedy was denied, or a nearer one missed."""

from __future__ import annotations

import itertools
import math
import tomllib
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import camgeo
from camgeo.check.cures.search import Change, Cure
from camgeo.check.finding import CONVEXITY, RETURN, UNDERCUT
from camgeo.check.judge import TRIM
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.kinematics.laws import FAMILIES
from camgeo.scene.keys import path_of
from camgeo.scene.scene import Scene
from tests.draws.remedies import BAD, cases, complaints
from tests.long_form import examples
from tests.strategies import SMOOTH, attack

REFUSED = Path(__file__).parents[2] / "fixtures" / "refused"


Tables = dict[str, Any]


SHAPES = {
    key for family in FAMILIES.values() for taken in family.parameters.values() for key in taken
}
"""Keys that belong to a law: a different law takes its default parameters."""


FLAT = """
[follower]
kind = "oscillating-flat"
pivot = [-90, 20]
base_radius = 40.1
face_offset = 5.3
arm_side = "cw"
"""


def undercut(design: Design) -> list[str]:
    """The findings of undercut that are not ok."""
    return [
        each.name
        for each in design.findings
        if each.severity != "ok"
        and each.name.removeprefix(f"{RETURN}: ").startswith((*UNDERCUT, CONVEXITY))
    ]


def applied(scene: Scene, cure: Cure) -> Scene:
    """The scene, changed only at the cure's keys, where it holds the values that the cure
    replaces."""
    assert cure.value_to is not None
    edits: dict[str, Any] = {}
    for change in (Change(cure.key, cure.value_from, cure.value_to), *cure.also):
        path = path_of(change.key)
        assert path is not None
        *above, last = path
        table: Any = scene.values
        for step in above:
            table = table[step] if isinstance(step, int) else table.get(step, {})
        present = table.get(last)
        if isinstance(present, Decimal):
            assert not isinstance(change.value_from, str)
            assert float(present) == pytest.approx(float(change.value_from), rel=1e-15), change.key
        edits[change.key] = change.value_to
        if last == "law":
            stem = change.key.removesuffix("law")
            edits |= {f"{stem}{shape}": None for shape in SHAPES & {*table}}
    return scene.with_values(edits)


def check_cures(values: Tables) -> tuple[Cure, ...]:
    scene = Scene(values)
    found = Design(scene).judgement.cures
    for cure in found:
        if not cure.works:
            assert not cure.also
            continue
        value = cure.value_to
        if isinstance(value, float):
            unit = values.get("units", {}).get("length", "mm")
            assert cure.unit == unit
            assert f" {value:g} {unit}" in cure.sentence or repr(value) in cure.sentence
        elif isinstance(value, Decimal):
            assert f"{cure.key} {value.normalize():f} deg" in cure.sentence
        try:
            other = Design(applied(scene, cure))
        except SceneError as error:
            pytest.fail(f"{cure.sentence}: {error}")
        assert not undercut(other), cure.sentence
    return found


def loaded(name: str) -> Tables:
    """The tables of a refused scene, numbers as they are written."""
    text = (REFUSED / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text, parse_float=Decimal)


def test_a_rest_of_zero_length_keeps_its_number() -> None:
    found = {cure.knob: cure for cure in check_cures(loaded("lobe_after_no_rest"))}
    longer = found["longer segment"]
    keys = {longer.key, *(change.key for change in longer.also)}
    assert keys == {"motion[1].dwell", "motion[2].span", "motion[4].span", "motion[5].dwell"}


def test_a_return_disc_that_undercuts_alone_is_cured() -> None:
    values = loaded("return_undercut")
    assert {name.partition(":")[0] for name in undercut(Design(Scene(values)))} == {RETURN}
    works = {cure.key for cure in check_cures(values) if cure.works}
    assert works >= {"follower.base_radius", "follower.return.roller_radius"}


def test_both_rollers_of_a_pair_are_cured_together() -> None:
    values = loaded("return_undercut")
    values["follower"]["roller_radius"] = 58
    found = {cure.knob: cure for cure in check_cures(values)}
    cure = found["roller radius"]
    assert {cure.key, *(change.key for change in cure.also)} == {
        "follower.roller_radius", "follower.return.roller_radius"
    }  # fmt: skip


def test_what_only_trimming_makes_is_refused_with_its_key() -> None:
    """A drop over one degree, whose shocks no roller can follow."""
    values = loaded("drop")
    design = Design(Scene(values))
    with pytest.raises(camgeo.CamgeoError, match="shock") as caught:
        design.judgement.require_outline(design.cam)
    assert TRIM in str(caught.value)
    values["limits"]["undercut"] = "trim"
    design = Design(Scene(values))
    design.judgement.require_outline(design.cam)
    assert not any(TRIM in finding.sentence for finding in design.findings)


def test_a_flat_face_is_moved_out() -> None:
    values = loaded("undercut_tappet")
    (cure,) = check_cures(values)
    assert (cure.key, cure.also) == ("follower.base_radius", ())
    values["limits"]["undercut"] = "trim"
    assert check_cures(values) == (cure,)
    values["follower"] = tomllib.loads(FLAT, parse_float=Decimal)["follower"]
    values["motion"][3]["span"], values["motion"][4]["dwell"] = 50, 180
    for place in (1, 3):
        values["motion"][place]["to"] *= Decimal("0.6")
    (cure,) = check_cures(values)
    assert [change.key for change in cure.also] == ["follower.face_offset"]


@st.composite
def motions(draw: st.DrawFn, stroke: float) -> list[Tables]:
    """Rests, some of zero length, and moves between 0 and `stroke`, mostly from rest to rest."""
    count = draw(st.integers(1, 3))
    laws = st.sampled_from([*SMOOTH, "polynomial-345", "auto"])
    found: list[Tables] = []
    free = 360
    for number in range(2 * count):
        last = number == 2 * count - 1
        if draw(st.integers(0, 3)):
            rest = draw(st.integers(0, 40))
            found.append({"dwell": rest + Decimal(draw(st.sampled_from(["0", "0.25"])))})
        elif draw(st.booleans()):
            found.append({"dwell": 0})
        to = 0.0 if last else draw(st.floats(0.2, 1.0)) * stroke * (number % 2 == 0)
        move: Tables = {"law": draw(laws), "span": draw(st.integers(15, 50)), "to": to}
        if draw(st.integers(0, 3)) == 0 and "inflection" in FAMILIES.get(
            move["law"], FAMILIES["polynomial-345"]
        ).parameters.get("R-R", ()):
            move["inflection"] = draw(st.floats(0.3, 0.7))
        found.append(move)
    taken = sum(
        (Decimal(each["dwell"] if "dwell" in each else each["span"]) for each in found), Decimal(0)
    )
    assume(taken < free)
    found.append({"dwell": free - taken})
    return found


@st.composite
def flat_scenes(draw: st.DrawFn) -> Tables:
    """A scene with a flat face, often undercut."""
    base = draw(st.floats(10.0, 60.0))
    follower: Tables = {"kind": "translating-flat", "base_radius": base}
    stroke = 25.0
    if draw(st.booleans()):
        stroke = 18.0
        follower["kind"] = "oscillating-flat"
        follower["pivot"] = [-draw(st.floats(1.3, 2.0)) * base, 0.3 * base]
        follower["face_offset"] = draw(st.floats(-0.1, 0.3)) * base
    return {
        "camgeo": 1,
        "name": "drawn",
        "cam": {"rotation": draw(st.sampled_from(["ccw", "cw"]))},
        "follower": follower,
        "motion": draw(motions(stroke)),
        "limits": {"undercut": draw(st.sampled_from(["refuse", "trim"]))},
    }


@st.composite
def scenes(draw: st.DrawFn) -> Tables:
    """A scene with a roller on one disc or two, or with a flat face, often undercut."""
    if draw(st.integers(0, 4)) == 0:
        return draw(flat_scenes())
    kind = draw(st.sampled_from(["translating-roller", "oscillating-roller"]))
    base = draw(st.floats(30.0, 60.0))
    roller = draw(st.floats(3.0, 0.8 * base))
    follower: Tables = {"kind": kind, "base_radius": base, "roller_radius": roller}
    if kind == "translating-roller":
        stroke = 25.0
        follower["offset"] = draw(st.floats(-0.5, 0.5)) * base
    else:
        stroke = 18.0
        distance = draw(st.floats(1.3, 1.8)) * base
        angle = draw(st.floats(0.0, math.tau))
        follower["pivot"] = [distance * math.cos(angle), distance * math.sin(angle)]
        follower["arm"] = draw(st.floats(0.8, 1.2)) * distance
        follower["arm_side"] = draw(st.sampled_from(["ccw", "cw"]))
    values: Tables = {
        "camgeo": 1,
        "name": "drawn",
        "cam": {"rotation": draw(st.sampled_from(["ccw", "cw"]))},
        "follower": follower,
        "motion": draw(motions(stroke)),
        "limits": {"transmission_angle": 1, "radius_ratio": 1},
    }
    contact = draw(st.sampled_from(["inner", "inner", "outer", "groove", "pair", "pair"]))
    if contact != "pair":
        follower["contact"] = contact
        if contact != "inner":
            values["part"] = {"rim": 400.0}
        return values
    second: Tables = {}
    if draw(st.booleans()):
        second["roller_radius"] = draw(st.floats(3.0, 0.8 * base))
    if kind == "translating-roller":
        second["spacing"] = base * draw(st.floats(1.6, 2.2)) + stroke
        if draw(st.booleans()):
            second["offset"] = draw(st.floats(-0.3, 0.3)) * base
    else:
        second["arm_angle"] = draw(st.floats(60.0, 110.0)) * (
            1.0 if follower["arm_side"] == "cw" else -1.0
        )
    follower["return"] = second
    return values


def test_a_scene_in_inches_gets_its_cure_in_inches() -> None:
    values = loaded("lobe_after_no_rest")
    values["units"] = {"length": "inch"}
    found = check_cures(values)
    assert {cure.unit for cure in found if cure.works} == {"inch", "deg"}
    # Lengths that have no cure are stated in inches too.
    (offset,) = (cure for cure in found if cure.knob == "offset")
    assert (offset.works, offset.unit) == (False, "inch")
    assert offset.sentence == "no other offset between -22 and 22 inch cures it"


@settings(attack, max_examples=examples(2, long=200))
@given(scenes(), st.sampled_from(["mm", "inch"]))
def test_every_cure_cures_when_applied_as_printed(values: Tables, unit: str) -> None:
    values["units"] = {"length": unit}
    try:
        design = Design(Scene(values))
        assume(undercut(design))
    except SceneError:
        assume(False)
    check_cures(values)


FIXTURES = Path(__file__).parents[2] / "fixtures"


NEAR = 1e-6
"""Share of the base radius."""


def bad(design: Design) -> set[str]:
    return {each.name for each in design.findings if each.severity in BAD}


def works(design: Design, fault: str, knob: str) -> Cure:
    found = {(each.fault, each.knob): each for each in design.judgement.cures}
    assert found[fault, knob].works, found[fault, knob].sentence
    return found[fault, knob]


def with_value(design: Design, key: str, value: Any) -> Design:
    return Design(design.scene.with_values({key: value}))


@pytest.mark.parametrize(
    ("name", "knob", "nearest", "known"),
    [
        ("cure_window", "base radius", 22.62, 67.86),  # up to about 89 mm
        ("cure_skips_window", "offset", 16.787, -9.456),  # down to -15 mm, then from -48 mm on
        ("cure_offset_denied", "offset", 4.186, 0.0),
    ],
)
def test_the_nearest_window_is_found(name: str, knob: str, nearest: float, known: float) -> None:
    design = camgeo.load(FIXTURES / "found" / f"{name}.toml")
    assert not bad(with_value(design, f"follower.{knob.replace(' ', '_')}", known))
    cure = works(design, "undercut", knob)
    assert cure.limit is not None
    assert min(nearest, known) <= cure.limit <= max(nearest, known)
    assert not bad(with_value(design, cure.key, cure.value_to))
    short = cure.limit + NEAR * design.cam.follower.base_radius * (1 if known < nearest else -1)
    assert bad(with_value(design, cure.key, short))


def test_a_radius_ratio_and_an_angle_have_remedies() -> None:
    design = camgeo.load(FIXTURES / "scenes" / "plate_translating.toml")
    limits = {"limits.transmission_angle": 70.0, "limits.radius_ratio": 0.15}
    broken = Design(design.scene.with_values(limits))
    assert bad(broken) == {"transmission-angle", "radius-ratio-inner"}
    assert {each.fault for each in broken.judgement.cures} == {"transmission angle", "radius ratio"}
    for cure in broken.judgement.cures:
        if cure.works and cure.knob not in ("longer segment", "other law"):
            left = bad(with_value(broken, cure.key, cure.value_to))
            assert not any(name.startswith(cure.fault.replace(" ", "-")) for name in left)
            assert left < bad(broken)


def test_a_remedy_keeps_the_bore_inside_the_disc() -> None:
    """With 54.5 mm the return disc does not undercut, and is smaller than its bore."""
    design = camgeo.load(FIXTURES / "refused" / "return_undercut.toml")
    cure = works(design, "undercut", "base radius")
    assert cure.breaks == ()
    assert cure.limit is not None
    other = with_value(design, cure.key, cure.value_to)
    assert other.discs[1].drawn.part is not None
    short = with_value(design, cure.key, cure.limit + 1e-3)
    with pytest.raises(camgeo.CamgeoError, match="bore"):
        _ = short.discs[1].drawn.part
    # No smaller roller leaves room for it, which is said.
    roller = works(design, "undercut", "roller radius")
    assert roller.breaks == ("part",)
    assert "breaks part (part.bore = 24: the bore reaches" in roller.sentence


def test_no_remedy_of_a_drawn_mechanism_is_denied_or_beaten() -> None:
    for values in itertools.islice(cases(8), 2):
        assert [*complaints(values)] == []
