"""The result of `camgeo check`, rendered as text and as JSON."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.answer import findings_summary, text
from camgeo.app.answers.check import Check, check
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.errors import SceneError
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
        assert bore.finding is None
        steep = replace(bore, limit=0.5 * bore.largest).finding
        assert steep is not None
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


def test_the_part_of_a_disc_is_weighed_and_compared_with_its_limits() -> None:
    found = check(camgeo.loads(f"{DISC}limits = {{ diameter = 95.9, mass = 0.6 }}\n{SOLID}"))
    part = found.parts["disc"]
    assert part.body is not None
    assert part.body.inertia is not None
    assert [each.name for each in part.findings if each.severity == "broken"] == [
        "largest-diameter"
    ]
    assert found.exit_code == 1
    reported = document(found)["parts"]["disc"]
    assert reported["diameter_mm"] == part.diameter == pytest.approx(96.0, rel=1e-15)
    assert (
        reported["body"]
        | {
            "centre_mm": part.body.solid.centre.tolist(),
            "density_kg_per_m3": pytest.approx(7850.0),
            "mass_kg": part.body.mass,
            "axial_inertia_kg_mm2": part.body.axial_inertia,
            "inertia_kg_mm2": part.body.inertia.tolist(),
        }
        == reported["body"]
    )
    assert "largest diameter 96 mm at cam angle 180 deg" in text(found)


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


def test_findings_are_counted_in_words() -> None:
    kept, warned, broken = (Finding("a", each, "") for each in ("ok", "warning", "broken"))
    assert findings_summary([kept]) == "1 finding: all limits are kept"
    assert findings_summary([kept, warned]) == "2 findings: 1 warning"
    assert findings_summary([warned, broken, warned]) == "3 findings: 1 BROKEN, 2 warnings"
