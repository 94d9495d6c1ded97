"""The smallest cures: at each proposed value the finding is about to vanish. Each works when its
printed values are written into the scene at the keys that it names, and breaks no limit that held.

The scenes of fixtures/found are public reports: a remedy was denied, or a nearer one missed.
"""

from __future__ import annotations

import itertools
import math
import re
import tomllib
from dataclasses import replace
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import camgeo
from camgeo.cam.cam import Cam
from camgeo.check.cures.remedies import STEP, Cure, KeyChange, digits_for, longer_plan, offers_for
from camgeo.check.cures.search import NARROW, UNKNOWN, Discs, KnobSearch, first_root
from camgeo.check.disc import TRIM, check_standstill, check_undercut
from camgeo.check.finding import CONVEXITY, RETURN, UNDERCUT, Limits, rounded_beyond
from camgeo.check.judge import Judgement
from camgeo.check.machine import check_follower
from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.outline.outline import find_crossings
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.scene.keys import parse_path
from camgeo.scene.scene import Scene
from tests.cams import cam_of
from tests.draws.remedies import BAD, cases, complaints
from tests.findings import known
from tests.laws import LAWS
from tests.reference import hard_case, pitch_curve_of, stroke_of, thesis_params

NEAR = 1e-6
"""Share of the scale by which a limit is deliberately missed, ten times the step beyond it."""


ANY_ANGLE = Limits(transmission_angle=1e-6, radius_ratio=1.0)
"""With which only undercut is a fault."""


LENGTHS = ("base radius", "roller radius", "offset", "arm")


def cures(cams: tuple[Cam, ...]) -> tuple[Cure, ...]:
    return Judgement(cams[0].drive, cams, ANY_ANGLE, 0.01).cures


def margin(cams: tuple[Cam, ...]) -> float | None:
    """The smallest 1 + d kappa of the flanks in use; None where there is no mechanism."""
    (cam,) = cams
    if check_follower(cam.follower, runs_on_inner=cam.contact.runs_inside):
        return None
    try:
        kappa = curvature_extremes(cam.disc.pitch_curve).values
    except GeometryError:
        return None
    return min(float(np.min(1.0 + each * kappa)) for each in cam.distances)


def cam_on(curve: PitchCurve, contact: Any = "inner") -> Cam:
    follower, linkage = curve.follower, None
    assert isinstance(follower, TranslatingRoller | OscillatingRoller)
    if isinstance(curve.motion, LinkedMotion):
        linkage = curve.motion.linkage
    plan = stroke_of(curve)
    assert isinstance(plan, MotionPlan)
    return cam_of(plan, follower, curve.rotation, contact, linkage)


def hard(name: str, contact: str = "inner", **changes: float) -> Cam:
    params, _ = hard_case(name)
    return cam_on(pitch_curve_of({**params, **changes}), contact)


def enlarged(cam: Cam, by: float) -> Cam:
    """The cam with the largest roller that fits by its curvature, times `by`."""
    least = known(margin((cam,)))
    return cam.sized(roller_radius=cam.follower.roller_radius / (1.0 - least) * by)


def setzhub() -> Cam:
    return enlarged(cam_on(pitch_curve_of(thesis_params("T6_setzhub", -1))), 1.1)


def rocker(contact: Any = "inner") -> Cam:
    law = LAWS["modified-sine"]
    plan = MotionPlan(
        (
            Dwell(Decimal(40)),
            Move(Decimal(50), 0.4, law),
            Dwell(Decimal(80)),
            Move(Decimal(70), 0.0, law),
            Dwell(Decimal(120)),
        )
    )
    return enlarged(cam_of(plan, OscillatingRoller(-80 - 40j, 70.0, 50.0, 5.0), 1, contact), 1.2)


CASES: dict[str, Cam] = {
    "translating": hard("HC21c"),
    "barely": hard("HC21b"),
    "large roller": hard("HC20b", r_R=18),
    "ring": hard("HC20b", "outer", r_R=13),
    "groove": hard("HC20b", "groove", r_R=15),
    "rocker": rocker(),
    "rocker in a ring": rocker("outer"),
    "rocker in a groove": rocker("groove"),
    "linkage": setzhub(),
    "neck": hard("HC22"),
    "neck of a wide curve": hard("HC22b"),
}


@cache
def found_for(name: str) -> tuple[Cure, ...]:
    """The cures of a case, searched for once."""
    return cures((CASES[name],))


each_case = pytest.mark.parametrize("name", CASES)


def is_good(cam: Cam) -> bool:
    """Verdict of the checks, without the code under test; an impossible mechanism fails."""
    try:
        curve = cam.disc.pitch_curve
        bends = curvature_extremes(curve)
    except GeometryError:
        return False
    flanks = [flank for _, flank in cam.disc.flanks]
    found = [each for flank in flanks for each in check_undercut(flank, "any", bends)]
    if check_standstill(curve) or any(finding.severity != "ok" for finding in found):
        return False
    return not any(find_crossings(flank) for flank in flanks)


def turned(cam: Cam, cure: Cure, value: float) -> Cam:
    return cam.sized(**{cure.key.removeprefix("follower."): value})


def applied(cam: Cam, cure: Cure) -> Cam:
    """The cam with the changes of the motion that a cure names, and with no others."""
    assert cure.new_value is not None
    segments = list(cam.drive.plan.segments)
    for change in (KeyChange(cure.key, cure.old_value, cure.new_value), *cure.also):
        number = int(change.key.partition("[")[2].partition("]")[0]) - 1
        segment = segments[number]
        what = change.key.rpartition(".")[2]
        assert (what == "dwell") == isinstance(segment, Dwell)
        if what == "law":
            assert isinstance(segment, Move)
            assert segment.law.name == change.old_value
            law = make_law(str(change.new_value), "R-R")
            segments[number] = replace(segment, law=law)
        else:
            assert segment.span == change.old_value
            assert isinstance(change.new_value, Decimal)
            segments[number] = replace(segment, span=change.new_value)
    return cam.moved(MotionPlan(tuple(segments)))


def by_knob(found: tuple[Cure, ...]) -> dict[str, Cure]:
    return {cure.knob: cure for cure in found}


def check_lengths(cam: Cam, found: tuple[Cure, ...]) -> None:
    """The finding is gone at the proposed value and beyond, and remains just short of it."""
    for cure in found:
        if cure.knob not in LENGTHS or cure.new_value is None:
            continue
        old, limit, reported = cure.old_value, cure.limit, cure.new_value
        assert isinstance(old, float)
        assert isinstance(limit, float)
        assert isinstance(reported, float)
        assert is_good(turned(cam, cure, reported)), cure
        assert abs(reported - limit) <= 0.03 * abs(limit - old) + 1e-12 * abs(limit), cure
        scale = cam.follower.base_radius if cure.knob == "offset" else old
        assert cure.cost == pytest.approx(abs(limit - old) / scale, rel=1e-12)
        step = math.copysign(NEAR * scale, limit - old)
        assert is_good(turned(cam, cure, limit + step)), cure
        if abs(limit - old) > 2.0 * abs(step):
            assert not is_good(turned(cam, cure, limit - step)), cure


@each_case
def test_each_length_is_at_its_limit(name: str) -> None:
    check_lengths(CASES[name], found_for(name))


@each_case
def test_a_longer_segment_is_the_shortest_that_cures(name: str) -> None:
    cam = CASES[name]
    cure = by_knob(found_for(name))["longer segment"]
    assert cure.works, cure.sentence
    assert isinstance(cure.new_value, Decimal)
    longer = applied(cam, cure)
    assert is_good(longer)
    # One step less of all the moves, and of the dwells what is left over.
    shorter = {
        number: after.span - 2 * STEP
        for number, (before, after) in enumerate(
            zip(cam.drive.plan.segments, longer.drive.plan.segments, strict=True)
        )
        if after.span > before.span
    }
    plan = known(longer_plan(cam.drive.plan, shorter))
    assert not is_good(cam.moved(plan))
    assert cure.old_value in [cam.drive.plan.segments[number].span for number in shorter]


@each_case
def test_another_law_cures_and_none_does_it_for_less(name: str) -> None:
    cam = CASES[name]
    cure = by_knob(found_for(name))["other law"]
    if cure.works:
        assert is_good(applied(cam, cure))
    number = int(cure.key.partition("[")[2].partition("]")[0]) - 1
    move = cam.drive.plan.segments[number]
    assert isinstance(move, Move)
    assert move.law.name == cure.old_value
    changed = [change.key for change in cure.also]
    for offer in offers_for(cam.drive.plan, number):
        if changed or (cure.cost is not None and offer.growth >= cure.cost):
            continue  # not where several moves change at once
        segments = list(cam.drive.plan.segments)
        segments[number] = replace(move, law=offer.law)
        assert not is_good(cam.moved(MotionPlan(tuple(segments)))), offer.law.name


def test_laws_offered_keep_the_joints_and_make_no_jerk() -> None:
    plan = CASES["translating"].drive.plan
    offers = offers_for(plan, 1)
    assert len(offers) > 3
    assert [offer.growth for offer in offers] == sorted(offer.growth for offer in offers)
    for offer in offers:
        for end in (offer.law.start, offer.law.end):
            assert (end.velocity, end.acceleration) == (0.0, 0.0), offer.law.name


@each_case
def test_the_cheapest_comes_first_and_what_does_not_work_last(name: str) -> None:
    costs = [math.inf if cure.cost is None else cure.cost for cure in found_for(name)]
    assert costs == sorted(costs)
    assert min(costs) >= 0.0
    for cure in found_for(name):
        assert cure.works == (cure.cost is not None) == (cure.new_value is not None)
        assert cure.sentence
        assert cure.works or not cure.also
    assert len(by_knob(found_for(name))) == 5


def test_the_roller_is_that_of_the_reference() -> None:
    _, expected = hard_case("HC21a")
    cure = by_knob(found_for("translating"))["roller radius"]
    assert cure.limit == pytest.approx(float(expected["rho_min"]), rel=1e-12)
    assert "at most 14.1365 mm instead of 14.8433 mm" in cure.sentence


@pytest.mark.parametrize(("name", "axis"), [("neck", 50), ("neck of a wide curve", 51)])
def test_the_roller_of_a_neck_is_half_its_width(name: str, axis: int) -> None:
    """Both cams are mirror images of themselves, so that half a neck is a distance from an axis."""
    plan, base = CASES[name].drive.plan, CASES[name].follower.base_radius
    rise = plan.segments[1]
    assert isinstance(rise, Move)
    with mpmath.workdps(30):

        def half_width(phi: Any) -> Any:
            z = (phi - 10) / 40
            lift = rise.to * z**3 * (10 - 15 * z + 6 * z**2)
            return (base + lift) * mpmath.sin(mpmath.radians(axis - phi))

        flat = mpmath.findroot(lambda phi: mpmath.diff(half_width, phi), 14)
        narrow = half_width(flat)
        assert mpmath.diff(half_width, flat, 2) > 0
    cure = by_knob(found_for(name))["roller radius"]
    assert cure.limit == pytest.approx(float(narrow), rel=1e-12)


def test_a_cusp_is_cured_by_no_change_at_all() -> None:
    cam = hard("HC21a")
    found = by_knob(cures((cam,)))
    for knob, upward in (("base radius", True), ("roller radius", False)):
        cure = found[knob]
        assert isinstance(cure.new_value, float)
        assert cure.limit is not None
        assert known(cure.cost) < 1e-9
        assert (" at most " in cure.sentence) != upward
        assert is_good(turned(cam, cure, cure.new_value))
        step = NEAR * cure.limit
        assert is_good(turned(cam, cure, cure.limit + (step if upward else -step)))


def test_no_mechanism_has_no_cure() -> None:
    assert margin((hard("HC20b", r_R=26),)) is None, "the roller covers the cam axis"
    assert cures((hard("HC20b", r_R=26),)) == ()
    plan = CASES["translating"].drive.plan
    locked = cam_of(plan, TranslatingRoller(25.0, 15.0, offset=25.0))
    assert margin((locked,)) is None
    with pytest.raises(GeometryError, match="offset must not exceed"):
        CASES["translating"].sized(offset=26.0)


class Roller:
    """A size of which the search knows nothing but a verdict."""

    start = 10.0
    scale = 10.0

    def make(self, value: float) -> Discs:
        return Discs([hard("HC20b", r_R=value)])

    def worst(self, _: float, __: Any) -> None:
        return None


def test_a_limit_that_is_no_root_is_enclosed() -> None:
    counts = []
    for by in (
        lambda x: x**3 - 7.123**3,
        lambda x: math.expm1(x - 7.123),
        lambda x: math.copysign(math.inf, x - 7.123),
    ):
        asked = list[float]()

        def judged(value: float, by: Any = by, asked: list[float] = asked) -> dict[str, float]:
            asked.append(value)
            return {"steady": -1.0, "tried": by(value)}

        limit = known(KnobSearch(Roller(), 1e-3, (), judged).nearest())
        assert 7.123 - NARROW * 10.0 <= limit <= 7.123
        counts.append(len(asked))
    *measured, unmeasured = counts
    assert max(measured) < 0.75 * unmeasured, "how far it is beyond shortens the search"
    assert KnobSearch(Roller(), 1e-3, (), lambda _: UNKNOWN).nearest() is None
    assert KnobSearch(Roller(), 10.0, (), lambda _: {}).nearest() is None, "there is no way to go"


@given(
    middle=st.floats(0.05, 0.95),
    half=st.floats(-5.0, -1.5).map(lambda exponent: 10.0**exponent),
    far=st.sampled_from([1.0, 100.0]),
    waves=st.floats(0.0, 3.0),
)
def test_no_narrow_window_of_a_margin_is_missed(
    middle: float, half: float, far: float, waves: float
) -> None:
    """The margin is above 0 between two roots as near to each other as 2e-5 of the range only."""
    middle, half = far * middle, far * half * middle

    def margin_at(x: Any) -> Any:
        return (half**2 - (x - middle) ** 2) * (2.0 + np.sin(math.tau * waves * x / far))

    assert first_root(margin_at, 0.0, far, 1.0) == pytest.approx(middle - half, rel=1e-9)
    assert first_root(lambda x: margin_at(x) - 3.0 * half**2, 0.0, far, 1.0) is None


def test_what_cannot_be_cured_says_so() -> None:
    """The dwell at the smallest radius: r_R is larger than it whatever else changes."""
    dwell = MotionPlan((Dwell(Decimal(180)), Dwell(Decimal(180))))
    assert cures((cam_of(dwell, TranslatingRoller(25.0, 24.0)),)) == ()
    found = by_knob(cures((hard("HC22"),)))
    assert found["offset"].sentence == "no other offset between -22 and 22 mm removes it"
    assert found["other law"].sentence == "no other motion[2].law removes it at these sizes"


@pytest.mark.parametrize(("more", "works"), [(14.99, True), (15.01, False), (33.0, False)])
def test_two_moves_grow_as_long_as_the_rest_between_them_has_room(more: float, works: bool) -> None:
    """Of 30 degrees each, and 30 at rest. The roller is the radius of curvature over a longer move,
    so that is the least that both need; the rest gives 15 to each. A move by nothing is no rest."""
    law = LAWS["polynomial-345"]
    needed = 30 + Decimal(str(more))
    still = Move(Decimal(270), 0.0, law)
    longer = MotionPlan((Move(needed, 100.0, law), Move(90 - needed, 0.0, law), still))
    bends = curvature_extremes(PitchCurve(longer, TranslatingRoller(40.0, 1.0), 1))
    inside = (bends.phi > 1e-6) & (bends.phi < math.radians(float(needed)) - 1e-6)
    tightest = float(np.max(bends.values[inside]))
    moves = (Move(Decimal(30), 100.0, law), Dwell(Decimal(30)), Move(Decimal(30), 0.0, law), still)
    cam = cam_of(MotionPlan(moves), TranslatingRoller(40.0, 1.0 / tightest))
    cure = by_knob(cures((cam,)))["longer segment"]
    assert cure.works == works, cure.sentence
    if not works:
        assert (cure.key, cure.old_value, cure.cost) == ("motion[1].span", 30, None)
        assert "too little room" in cure.sentence
        return
    first, rest, second, _ = applied(cam, cure).drive.plan.segments
    assert 0 <= first.span - needed <= 2 * STEP
    assert second.span == first.span
    assert rest.span == 90 - 2 * first.span
    assert cure.cost == pytest.approx(more / 30.0, rel=1e-6)
    assert {cure.key, *(each.key for each in cure.also)} == {
        "motion[1].span", "motion[2].dwell", "motion[3].span"
    }  # fmt: skip


def test_undercut_in_a_rest_or_in_a_turn_is_no_matter_of_span_or_law() -> None:
    dwell = MotionPlan(
        (
            Dwell(Decimal(60)),
            Move(Decimal(120), -20.0, LAWS["polynomial-345"]),
            Dwell(Decimal(60)),
            Move(Decimal(120), 0.0, LAWS["polynomial-345"]),
        )
    )
    cam = cam_of(dwell, TranslatingRoller(50.0, 32.0))
    found = by_knob(cures((cam,)))
    # That of the rest, or a little less: the check cannot decide on the smallest arcs.
    assert found["roller radius"].limit == pytest.approx(30.0, rel=1e-4)
    for knob in ("longer segment", "other law"):
        assert not found[knob].works
        assert "from rest to rest" in found[knob].sentence
        assert "motion[3]" in found[knob].sentence


@pytest.mark.parametrize(
    ("value", "digits", "upward", "reported"),
    [
        (28.30001, 6, True, "28.3001"),
        (28.39999, 6, False, "28.3999"),
        (-4.3503841, 6, False, "-4.35039"),
        (-4.3503841, 6, True, "-4.35038"),
        (999999.5, 6, True, "1000000"),
        (25.0, 6, True, "25"),
        (0.0, 6, True, "0"),
    ],
)
def test_lengths_are_rounded_to_the_safe_side(
    value: float, digits: int, upward: bool, reported: str
) -> None:
    assert rounded_beyond(value, digits, upward=upward) == reported


@given(old=st.floats(1e-3, 1e3), change=st.floats(1e-9, 10.0), upward=st.booleans())
def test_the_rounded_length_is_beyond_the_limit_by_little(
    old: float, change: float, upward: bool
) -> None:
    limit = old * (1.0 + change) if upward else old / (1.0 + change)
    assume(limit != old)
    reported = float(rounded_beyond(limit, digits_for(old, limit), upward=upward))
    beyond = reported - limit if upward else limit - reported
    # To the last digit printed, a hundredth of the change; the text is rounded once more.
    assert -math.ulp(limit) <= beyond <= 0.011 * abs(limit - old) + 1e-15 * old


@pytest.mark.parametrize("contact", [pytest.param("inner", marks=pytest.mark.long), "groove"])
def test_without_room_for_a_roller_the_radius_of_curvature_is_given(contact: Any) -> None:
    law = LAWS["polynomial-345"]
    rise, fall = Move(Decimal("0.0001"), 0.4, law), Move(Decimal(70), 0.0, law)
    plan = MotionPlan((rise, Dwell(Decimal(80)), fall, Dwell(Decimal("209.9999"))))
    cam = cam_of(plan, OscillatingRoller(-80 - 40j, 70.0, 50.0, 8.0), 1, contact)
    reason = r"no smaller .*: the smallest radius of curvature is 3\.\d+e-08 mm"
    assert re.fullmatch(reason, by_knob(cures((cam,)))["roller radius"].sentence)
    played = replace(cam, clearance=1.0) if contact == "groove" else cam
    beside = ", beside a play of 1 mm" if contact == "groove" else ""
    assert re.fullmatch(reason + beside, by_knob(cures((played,)))["roller radius"].sentence)


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


def rewritten(scene: Scene, cure: Cure) -> Scene:
    """The scene, changed only at the cure's keys, where it holds the values that the cure
    replaces."""
    assert cure.new_value is not None
    edits: dict[str, Any] = {}
    for change in (KeyChange(cure.key, cure.old_value, cure.new_value), *cure.also):
        path = known(parse_path(change.key))
        *above, last = path
        table: Any = scene.values
        for step in above:
            table = table[step] if isinstance(step, int) else table.get(step, {})
        present = table.get(last)
        if isinstance(present, Decimal):
            assert not isinstance(change.old_value, str)
            assert float(present) == pytest.approx(float(change.old_value), rel=1e-15), change.key
        edits[change.key] = change.new_value
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
        value = cure.new_value
        if isinstance(value, float):
            unit = values.get("units", {}).get("length", "mm")
            assert cure.unit == unit
            assert f" {value:g} {unit}" in cure.sentence or repr(value) in cure.sentence
        elif isinstance(value, Decimal):
            assert f"{cure.key} {value.normalize():f} deg" in cure.sentence
        try:
            other = Design(rewritten(scene, cure))
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
    assert offset.sentence == "no other offset between -22 and 22 inch removes it"


FIXTURES = Path(__file__).parents[2] / "fixtures"


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
    assert not bad(with_value(design, cure.key, cure.new_value))
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
            left = bad(with_value(broken, cure.key, cure.new_value))
            assert not any(name.startswith(cure.fault.replace(" ", "-")) for name in left)
            assert left < bad(broken)


def test_a_remedy_keeps_the_bore_inside_the_disc() -> None:
    """With 54.5 mm the return disc does not undercut, and is smaller than its bore."""
    design = camgeo.load(FIXTURES / "refused" / "return_undercut.toml")
    cure = works(design, "undercut", "base radius")
    assert cure.breaks == ()
    assert with_value(design, cure.key, cure.new_value).discs[1].drawn.part is not None
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
