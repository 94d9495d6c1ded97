"""Every remedy works when its printed values are written into the scene at the keys it names, is
the nearest one, and breaks no limit that held.

The scenes of fixtures/found are public reports: a remedy was denied, or a nearer one missed."""

from __future__ import annotations

import itertools
import tomllib
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

import camgeo
from camgeo.check.cures.remedies import Change, Cure
from camgeo.check.disc import TRIM
from camgeo.check.finding import CONVEXITY, RETURN, UNDERCUT
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.kinematics.laws import FAMILIES
from camgeo.scene.keys import path_of
from camgeo.scene.scene import Scene
from tests.draws.remedies import BAD, cases, complaints
from tests.findings import known

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
        path = known(path_of(change.key))
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


def test_a_scene_in_inches_gets_its_cure_in_inches() -> None:
    values = loaded("lobe_after_no_rest")
    values["units"] = {"length": "inch"}
    found = check_cures(values)
    assert {cure.unit for cure in found if cure.works} == {"inch", "deg"}
    # Lengths that have no cure are stated in inches too.
    (offset,) = (cure for cure in found if cure.knob == "offset")
    assert (offset.works, offset.unit) == (False, "inch")
    assert offset.sentence == "no other offset between -22 and 22 inch cures it"


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
    other = with_value(design, cure.key, cure.value_to)
    assert other.discs[1].drawn.part is not None
    short = with_value(design, cure.key, known(cure.limit) + 1e-3)
    with pytest.raises(camgeo.CamgeoError, match="bore"):
        _ = short.discs[1].drawn.part
    # No smaller roller leaves room for it, which is said.
    roller = works(design, "undercut", "roller radius")
    assert roller.breaks == ("part",)
    assert "breaks part (part.bore = 24: the bore reaches" in roller.sentence


def test_no_remedy_of_a_drawn_mechanism_is_denied_or_beaten() -> None:
    for values in itertools.islice(cases(8), 2):
        assert [*complaints(values)] == []
