"""The result of `camgeo check`, rendered as text and as JSON."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import text, verdict_on
from camgeo.app.answers.build import build
from camgeo.app.answers.check import Check, check
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.milling.plan import engagement_findings
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, SCENES, UNHELD, document, explained
from tests.long_form import LONG

SETZHUB = FIXTURES / "scenes" / "setzhub.toml"


def lines_of(found: Check) -> list[str]:
    return text(found).splitlines()


@cache
def checked(scene: Path) -> tuple[Design, Check, str]:
    """The design of a scene, the answer and its text."""
    design = explained(scene)[0]
    found = check(design)
    return design, found, text(found)


KINDS = (
    "inch",
    "groove",
    "four_bar",
    "cut_lobe",
    "yoke",
    "conjugate_lever",
    "global_undercut",
    "drop",
)
CHOSEN = [path for path in SCENES if LONG or path.stem in KINDS]
"""Scenes of each kind; all of them in the long form."""

by_scene = pytest.mark.parametrize("scene", CHOSEN, ids=lambda path: path.stem)


@by_scene
def test_every_effect_is_reported_in_finite_numbers(scene: Path) -> None:
    design, found, shown = checked(scene)
    assert list(found.effects) == list(design.scene.effects)
    for name, findings in found.effects.items():
        assert f"\n{name}:\n" in shown
        for each in findings:
            assert each.sentence
            assert each.value is None or math.isfinite(each.value)
    assert "nan" not in shown.lower().replace("resonan", "").replace("dominan", "")
    every = [*found.findings, *(each for many in found.effects.values() for each in many)]
    bad = any(each.severity in ("broken", "no-disc") for each in every)
    assert found.exit_code == (1 if bad else 0)


@pytest.mark.parametrize(
    "scene", [each for each in CHOSEN if each.parent.name == "scenes"], ids=lambda path: path.stem
)
def test_fixtures_keep_their_limits(scene: Path) -> None:
    design, found, shown = checked(scene)
    trimmed = design.scene.limits.undercut == "trim"
    assert found.exit_code == (1 if trimmed else 0)
    # What a trimmed cam breaks is that it undercuts, and what comes with it.
    broken = [line.split()[1] for line in shown.splitlines() if line.startswith("BROKEN")]
    assert bool(broken) == trimmed
    stated = (
        *("undercut-", "global-undercut-", "lobe-", "lost-stroke-", "radius-ratio-"),
        *("tangent-closure", "shock"),
    )
    assert all(name.startswith(stated) for name in broken)
    assert "NO DISC" not in shown


def test_text_asks_for_no_outline_that_the_findings_do_not_need(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(*_: object) -> None:
        raise AssertionError("an outline")

    monkeypatch.setattr("camgeo.app.answers.check._remains", refused)
    found = check(Design(load_scene(SETZHUB)))
    assert text(found)
    with pytest.raises(AssertionError, match="an outline"):
        document(found)


@pytest.mark.parametrize("name", ["near_dead_centre", "dead_centre"])
def test_text_and_document_agree_on_a_linkage_near_a_dead_centre(name: str) -> None:
    """Near the limit the roller is harmless; at it there is no disc, and the rest is unknown."""
    found = check(Design(load_scene(FIXTURES / "found" / f"{name}.toml")))
    reported, dead = document(found), name == "dead_centre"
    worst = {each.name for each in found.findings if each.severity == "no-disc"}
    assert worst == ({"dead-centre"} if dead else set())
    assert text(found).count("NO DISC") == len(worst)
    remains = reported["discs"][name]["inner"]
    if dead:
        assert remains is None
        return
    (ratio,) = (each for each in found.findings if each.name == "radius-ratio-inner")
    assert "smallest r_K 26.8722 mm" in ratio.sentence
    assert remains["left_out_deg"] == []


def test_a_sound_program_is_said_to_be_one() -> None:
    found = check(Design(load_scene(FIXTURES / "milling" / "groove_flanks.toml")))
    assert found.machining is not None
    (program,) = found.machining.programs.values()
    assert program.findings == ()
    assert "milling: simulated, nothing found" in text(found).splitlines()


def test_a_program_that_cannot_be_planned_is_the_fault_of_its_scene() -> None:
    """As of other invalid scenes: file, line, key, value, what is wrong; exit code 2."""
    design = camgeo.loads(SETZHUB.read_text().replace("flute_length = 22", "flute_length = 5"))
    found = check(design)
    assert found.machining is not None
    (program,) = found.machining.programs.values()
    (fault,) = program.faults
    assert (fault.key, fault.value) == ("tool[1].flute_length", "5")
    assert fault.line == 1 + design.scene.to_toml().splitlines().index("flute_length = 5")
    assert "shorter than 12.5 mm" in fault.message
    assert program.operations is None
    assert found.exit_code == 2
    assert any(line.startswith("INVALID") and str(fault) in line for line in lines_of(found))
    (reported,) = document(found)["machining"]["programs"].values()
    assert reported["faults"][0]["line"] == fault.line


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("width = 200", "width = 200\nbore = 20", "stock.bore"),
        ("stepdown = 3", "stepdown = 3\nstick_out = 22\nramp_angle = 0.0001", "tool[1].ramp_angle"),
        ('machine = "linuxcnc"', "clearance_height = 0.5", "output.gcode.clearance_height"),
        (
            'kind = "fixture"\n',
            'kind = "tabs"\ncount = 90\nwidth = 4\nheight = 2\n',
            "holding.count",
        ),
    ],
)
def test_faults_of_planning_name_their_keys(old: str, new: str, key: str) -> None:
    text = SETZHUB.read_text()
    text = text.replace(
        "through = 0.5", "through = 0.5\n[stock]\ntop = 1\nlength = 200\nwidth = 200"
    )
    text = text.replace("stepdown = 3", "stepdown = 3\nstepover = 4")
    assert text.count(old) == 1
    found = check(camgeo.loads(text.replace(old, new)))
    assert found.machining is not None
    ((fault,),) = (each.faults for each in found.machining.programs.values())
    assert fault.key == key
    assert fault.line is not None
    assert found.exit_code == 2


def test_a_program_that_must_not_be_run_is_broken() -> None:
    """Clamps on the ring hold the blank, and not the core that is cut out of it."""
    found = check(camgeo.loads(UNHELD))
    (line,) = (each for each in lines_of(found) if each.startswith("BROKEN"))
    assert "a core of" in line
    assert "nothing holds it" in line
    assert found.exit_code == 1


def test_the_engagement_of_what_clears_a_bore() -> None:
    """A bore of 24 mm is cleared by a cutter of 10; with a tighter limit the path is as it was."""
    source = FIXTURES / "scenes" / "conjugate_lever.toml"
    scene = load_scene(source).with_values({"stock.bore": 2.0, "tool[1].stepover": 2.0})
    found = check(Design(scene))
    assert found.machining is not None
    for (name, program), reported in zip(
        found.machining.programs.items(),
        document(found)["machining"]["programs"].values(),
        strict=True,
    ):
        (bore,) = program.roughing
        assert bore.operation == "rough bore"
        assert bore.largest <= bore.limit
        assert reported["roughing"][0]["largest_deg"] == pytest.approx(math.degrees(bore.largest))
        assert f"rough bore: {bore.sentence}" in text(found), name
        assert list(engagement_findings([bore])) == []
        (steep,) = engagement_findings([replace(bore, limit=0.5 * bore.largest)])
        assert steep.severity == "warning"
        assert steep.value == pytest.approx(math.degrees(bore.largest))


DISC = """
camgeo = 1
name = "disc"
cam = { rotation = "ccw" }
follower = { kind = "translating-roller", base_radius = 50, roller_radius = 10 }
motion = [{ law = "polynomial-345", span = 180, to = 8 },
          { law = "polynomial-345", span = 180, to = 0 }]
"""
"""A disc from 40 to 48 mm."""

SOLID = "part = { thickness = 12, bore = 20 }\neffects.balance = { density = 7850 }\n"


def test_mass_properties_of_the_part_of_each_disc() -> None:
    design = camgeo.loads(DISC + SOLID)
    found = check(design)
    (part,) = found.parts.values()
    assert part.diameter == pytest.approx(96.0, rel=1e-15)
    assert part.body is not None
    balance = design.effect("balance")
    assert part.body.mass == pytest.approx(1e3 * balance.mass, rel=1e-9)
    centre = part.body.solid.centre
    assert complex(*centre[:2]) == pytest.approx(balance.centre, rel=1e-9)
    reported = document(found)["parts"]["disc"]
    assert reported["diameter_mm"] == part.diameter
    assert reported["body"]["centre_mm"] == centre.tolist()
    assert reported["body"]["density_kg_per_m3"] == pytest.approx(7850.0)
    assert reported["body"]["mass_kg"] == part.body.mass
    inertia = part.body.inertia
    assert inertia is not None
    assert reported["body"]["inertia_kg_mm2"] == inertia.tolist()
    (layer,) = reported["layers"]
    assert (layer["z0_mm"], layer["z1_mm"]) == (-12.0, 0.0)
    assert layer["area_mm2"] * 12.0 == pytest.approx(part.body.solid.volume, rel=1e-12)
    told = text(found)
    assert "largest diameter 96 mm at cam angle 180 deg" in told
    assert "smallest wall 30 mm, between outline and bore" in told


@pytest.mark.parametrize(("limits", "broken"), [
    ("diameter = 96", []), ("diameter = 95.9", ["largest-diameter"]),
    ("mass = 0.6", []), ("mass = 0.5", ["mass"]),
])  # fmt: skip
def test_diameter_and_mass_are_held_to_their_limits(limits: str, broken: list[str]) -> None:
    found = check(camgeo.loads(f"{DISC}limits = {{ {limits} }}\n{SOLID}"))
    (part,) = found.parts.values()
    wrong = [each for each in part.findings if each.severity == "broken"]
    assert [each.name for each in wrong] == broken
    assert found.exit_code == (1 if broken else 0)
    name = {"diameter": "largest-diameter", "mass": "mass"}[limits.split()[0]]
    (limited,) = (each for each in part.findings if each.name == name)
    assert limited.value is not None
    assert limited.limit is not None
    assert (limited.value > limited.limit) == bool(broken)
    assert f"{limited.limit:g} {limited.unit}" in limited.sentence


@pytest.mark.parametrize(
    ("limit", "name", "severity", "said", "code"),
    [
        ("", "wall-ratio", "warning", r"wall beside its hole 6 mm, .*, below 10%, 6\.8 mm", 0),
        ("limits = { wall = 5 }", "smallest-wall", "ok", "at least 5 mm", 0),
        ("limits = { wall = 7 }", "smallest-wall", "broken", "below 7 mm", 1),
    ],
)
def test_a_thin_wall_is_told(
    limit: str, name: str, severity: str, said: str, code: int, tmp_path: Path
) -> None:
    """A bore of 68 mm in a disc that comes as near as 40 mm, when it is checked and when built."""
    design = camgeo.loads(f"{DISC}{limit}\npart = {{ thickness = 12, bore = 68 }}\n")
    judged, built = check(design), build(design, tmp_path, ["stl"])
    (part,) = judged.parts.values()
    for findings in (part.findings, built.findings):
        found = [each for each in findings if each.name == name]
        assert [each.severity for each in found] == [severity][: len(found)]
        assert all(re.search(said, each.sentence) for each in found)
        assert len(found) == (0 if findings is built.findings and severity == "ok" else 1)
    assert (judged.exit_code, built.exit_code) == (code, code)
    assert built.files


def test_a_set_screw_that_no_file_has_is_told() -> None:
    hub = "hub = { diameter = 40, height = 8 }, set_screw = { diameter = 5, height = 4 }"
    found = check(camgeo.loads(f"{DISC}part = {{ thickness = 12, bore = 20, {hub} }}\n"))
    (part,) = found.parts.values()
    (told,) = (each for each in part.findings if each.severity == "warning")
    assert told.name == "set-screw"
    assert "5 mm in diameter, 4 mm above the face of the disc" in told.sentence
    assert found.exit_code == 0


def test_a_limit_of_the_mass_needs_thickness_and_density() -> None:
    with pytest.raises(SceneError) as error:
        camgeo.loads(DISC + "limits.mass = 2\n")
    assert [each.key for each in error.value.faults] == ["limits.mass", "limits.mass"]
    shown = str(error.value)
    assert "needs [part] thickness" in shown
    assert "needs [part] material or density" in shown


def test_findings_of_a_design_compute_no_part() -> None:
    design = camgeo.loads(f"{DISC}limits = {{ diameter = 10 }}\n{SOLID}")
    assert {each.severity for each in design.findings} <= {"ok", "warning"}
    assert "discs" not in design.__dict__


@pytest.mark.parametrize("keys", ["density = 7850", 'material = "steel"'])
def test_the_part_has_its_density_without_an_effect(keys: str) -> None:
    """One density, wherever it is stated; files do not depend on it, and so neither their hash."""
    plain = f"{DISC}[part]\nthickness = 12\nbore = 20\n"
    scenes = [
        camgeo.loads(text)
        for text in (DISC + SOLID, f"{plain}{keys}\n", f"{plain}{keys}\n[effects.balance]\n")
    ]
    by_effect, *others = (next(iter(check(each).parts.values())).body for each in scenes)
    assert by_effect is not None
    for each in others:
        assert each is not None
        assert each.mass == pytest.approx(by_effect.mass, rel=1e-15)
    assert scenes[2].effect("balance").mass == pytest.approx(1e-3 * (by_effect.mass or 0.0))
    assert len({each.scene.made for each in (*scenes, camgeo.loads(plain))}) == 1
    assert len({each.scene.identity for each in (*scenes, camgeo.loads(plain))}) == 4


def test_density_of_the_effect_is_that_of_the_part() -> None:
    text = f"{DISC}part = {{ thickness = 12, density = 1410 }}\neffects.balance = {{ %s }}\n"
    design = camgeo.loads(text % "")
    (part,) = check(design).parts.values()
    assert part.body is not None
    assert part.body.mass == pytest.approx(1e3 * design.effect("balance").mass, rel=1e-9)
    same = camgeo.loads(text % 'material = "pom"')
    assert same.effect("balance").mass == pytest.approx(design.effect("balance").mass, rel=1e-12)
    for stated in ("density = 1411", 'material = "steel"'):
        with pytest.raises(SceneError) as error:
            camgeo.loads(text % stated)
        (fault,) = error.value.faults
        assert fault.key == f"effects.balance.{stated.split()[0]}"
        assert "contradicts [part], where the density is 1410 kg/m^3" in fault.message
    with pytest.raises(SceneError, match="there is no material wood"):
        camgeo.loads(f'{DISC}part = {{ material = "wood" }}\n')


def test_each_disc_of_a_conjugate_pair_has_its_mass() -> None:
    """The effect `balance` is for a single disc; the density of the part needs no effect."""
    found = check(Design(load_scene(FIXTURES / "scenes" / "conjugate_lever.toml")))
    text = {"part.density": 2700.0}
    weighed = check(Design(found.scene.with_values(text)))
    for part in weighed.parts.values():
        assert part.body is not None
        assert part.body.mass == pytest.approx(2.7e-6 * part.body.solid.volume, rel=1e-12)
        assert "mass" in [each.name for each in part.findings]
    assert len(weighed.parts) == 2


def test_findings_are_counted_in_words() -> None:
    kept, warned, broken = (Finding("a", each, "") for each in ("ok", "warning", "broken"))
    assert verdict_on([kept]) == "1 finding: all limits are kept"
    assert verdict_on([kept, warned]) == "2 findings: 1 warning"
    assert verdict_on([warned, broken, warned]) == "3 findings: 1 BROKEN, 2 warnings"
