"""What designs answer: what a check and a value table say, and nothing else is computed."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.check import check
from camgeo.check.judge import WORST_FIRST
from camgeo.design.design import Design
from camgeo.design.judged_part import PartAssessment
from camgeo.design.value_table import bare
from camgeo.errors import CamgeoError, GeometryError, UnknownNameError
from camgeo.lazy import Ledger
from camgeo.scene.scene import load_scene
from camgeo.studies.sweep.rows import (
    BY_GROUP,
    DesignReading,
    Question,
    Work,
    all_findings,
    hyphened,
    parse_questions,
    read,
)
from tests.findings import known
from tests.sweep.families import FIXTURES, SETZHUB, family

SCENES = [
    FIXTURES / name
    for name in (
        "scenes/setzhub.toml",
        "scenes/tappet.toml",
        "scenes/flat_rocker.toml",
        "scenes/conjugate_lever.toml",
        "scenes/feed.toml",
        "scenes/groove.toml",
        "scenes/four_bar.toml",
        "effects/lever.toml",
    )
]


@cache
def designed(path: Path) -> Design:
    """The design of a scene, computed once for all tests."""
    return Design(load_scene(path))


def answer(design: Design, word: str) -> DesignReading:
    (asked,) = parse_questions(design, [word])
    return read(design, asked)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_findings_are_those_of_a_check(path: Path) -> None:
    design = designed(path)
    first: dict[str, tuple[float | None, str]] = {}
    for finding in design.findings:
        first.setdefault(hyphened(finding.name), (finding.value, finding.unit))
    fresh = Design(design.scene)
    for name, (value, unit) in first.items():
        assert answer(fresh, name) == DesignReading(value if value is None else value + 0.0, unit)
    others = {name for names in BY_GROUP.values() for name in names}
    others -= {*first, *BY_GROUP["part"], *BY_GROUP["verdict"], *BY_GROUP["machining"]}
    for name in others:  # names of others have no value here, and are no failure
        found = answer(fresh, name)
        assert found.value is None
        assert found.reason in ("", "the scene has no [linkage]")


def test_names_of_groups_are_names_of_findings() -> None:
    """Of each group at least one name is found in a scene; no name is in two groups."""
    names = [name for each in BY_GROUP.values() for name in each]
    assert len(names) == len(set(names))


def test_the_part_is_that_of_a_check() -> None:
    design = Design(load_scene(FIXTURES / "scenes" / "hub_and_holes.toml"))
    found = {each.name: each.value for each in PartAssessment.from_disc(design.disc).findings}
    for name in ("largest-diameter", "mass", "smallest-wall", "wall-ratio"):
        if name in found:
            assert answer(design, name).value == found[name]
    assert answer(design, "diameter").value == found["largest-diameter"]
    assert answer(design, "diameter").unit == "mm"
    assert answer(design, "verdict").value in WORST_FIRST


def test_a_pair_in_one_piece_is_judged_as_by_a_check() -> None:
    design = Design(load_scene(FIXTURES / "pairs" / "conjugate_pair.toml"))
    assert all_findings(design) == [*check(Design(design.scene), machining=False).everything]


@pytest.mark.parametrize("name", ["scenes/conjugate_lever", "milling/steel_plate_cam"])
def test_the_machining_time_is_that_of_all_programs_of_a_check(name: str) -> None:
    design = Design(load_scene(FIXTURES / f"{name}.toml"))
    seconds = known(check(design).machining).seconds
    assert answer(Design(design.scene), "machining-time") == DesignReading(seconds, "s")


def test_a_machining_time_that_is_not_known() -> None:
    unknown = Design(SETZHUB.with_values({"output.gcode.machine": "haas"}))
    found = answer(unknown, "machining-time")
    assert found.value is None
    assert found.reason.startswith(
        'output.gcode.machine = "Haas": has a profile without [dynamics]'
    )
    short = answer(Design(SETZHUB.with_values({"tool[1].flute_length": 5})), "machining-time")
    assert "shorter than 12.5 mm" in short.reason
    with pytest.raises(GeometryError, match="tool: is not stated: machining-time needs"):
        answer(Design(load_scene(FIXTURES / "effects" / "lever.toml")), "machining-time")


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_extremes_of_columns_enclose_the_value_table(path: Path) -> None:
    design = designed(path)
    table = design.tabulated.table(1)
    for heading, column in list(table.columns.items())[1:]:
        name = hyphened(bare(heading))
        if name == "r_K":
            continue
        low, high, peak = (answer(design, f"{how}:{name}") for how in ("min", "max", "peak"))
        assert isinstance(low.value, float), low
        assert isinstance(high.value, float)
        size = max(abs(low.value), abs(high.value))
        slack = 1e-9 * max(size, 1e-300)
        assert low.value <= np.min(column) + slack
        assert high.value >= np.max(column) - slack
        assert peak.value == size
        assert f"[{high.unit}]" in heading or not high.unit


def test_a_closed_form() -> None:
    """Of a 3-4-5 polynomial, s'' is at most 10/sqrt(3) h / beta^2 (Wirsig, table of laws)."""
    found = answer(Design(SETZHUB), "peak:s''")
    beta = math.radians(80.0)
    assert found.value == pytest.approx(10.0 / math.sqrt(3.0) * 58.5 / beta**2, rel=1e-12)
    assert found.unit == "mm/rad^2"


def test_effects_answer_findings_and_columns() -> None:
    design = designed(FIXTURES / "effects" / "lever.toml")
    findings = {each.name: each.value for each in design.effects.findings("contact-force")}
    assert answer(design, "largest-contact-force").value == findings["largest-contact-force"]
    peak = answer(design, "peak:contact force")
    assert peak.value == pytest.approx(findings["largest-contact-force"], rel=1e-12)
    assert peak.unit == "N"


# Laziness -----------------------------------------------------------------------------------------


def computed(*ask: str, point: tuple[object, ...] = (50, "modified-sine")) -> set[str]:
    """What one design of a family computes to answer."""
    found = family()
    work = Work.for_family(found, parse_questions(Design(found.scene), ask))
    ledger = Ledger()
    (row,) = work.rows([point], ledger)  # type: ignore[list-item]  # values of a point
    assert not row.reason
    assert None not in row.values
    return {run.name for run in ledger.runs}


def test_only_what_is_asked_is_computed() -> None:
    assert computed("transmission-angle") == {"motion", "pitch_curve"}
    assert computed("largest-acceleration") <= {"time_course"}
    assert computed("peak:a") <= {"time_course", "motion", "smooth_angles"}
    assert "inner_outline" not in computed("peak:kappa", "transmission-angle")
    assert {"findings", "bends"} <= computed("radius-ratio-inner")
    milled = computed("machining-time")
    assert "toolpath" in milled
    assert not {"simulation", "engagement"} & milled
    lever = family(
        "follower.base_radius=20,21", scene=load_scene(FIXTURES / "effects" / "lever.toml")
    )
    work = Work.for_family(lever, parse_questions(Design(lever.scene), ["peak:spring-force"]))
    ledger = Ledger()
    work.rows([next(lever.points())], ledger)
    names = {run.name for run in ledger.runs if run.name.startswith("effects.")}
    assert names == {"effects.spring"}


def test_each_quantity_is_computed_once_for_all_questions() -> None:
    found = family()
    asked = parse_questions(
        Design(found.scene), ["transmission-angle", "min:mu", "diameter", "verdict"]
    )
    ledger = Ledger()
    Work.for_family(found, asked).rows([(50, "modified-sine")], ledger)
    names = [run.name for run in ledger.runs if run.name != "distances from outline"]
    assert len(names) == len(set(names))


# What has no answer -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "error", "message"),
    [
        (["transmission-angel"], UnknownNameError, 'did you mean "transmission-angle"?'),
        (["peak:muu"], UnknownNameError, 'there is no column "muu" (did you mean "mu"?)'),
        (["peak:contact-force"], UnknownNameError, 'there is no column "contact-force"'),
        ([], GeometryError, "names nothing"),
        (["mu"], GeometryError, 'ask for "peak:mu", "max:mu" or "min:mu"'),
        (["peak:r_K"], GeometryError, "ask for kappa"),
    ],
)
def test_what_has_no_single_value_is_refused(
    words: list[str], error: type[CamgeoError], message: str
) -> None:
    with pytest.raises(error, match=re.escape(message)):
        parse_questions(Design(SETZHUB), words)


def test_the_same_word_is_asked_once() -> None:
    words = [each.word for each in parse_questions(Design(SETZHUB), ["peak:mu", "peak: mu"])]
    assert words == ["peak:mu"]


def test_an_error_of_camgeo_is_a_reason_too(monkeypatch: pytest.MonkeyPatch) -> None:
    from camgeo.studies.sweep import rows

    def broken(_: Design, __: Question) -> DesignReading:
        raise ZeroDivisionError("of the test")

    monkeypatch.setitem(rows.ANSWERS, "angle", broken)
    found = answer(Design(SETZHUB), "transmission-angle")
    assert found == DesignReading(None, "", "internal error: ZeroDivisionError: of the test")


def test_no_disc_is_a_reason() -> None:
    """The linkage is beyond its dead centre: there is no transmission angle, and why."""
    found = family("motion.2.to=58.5,900")
    work = Work.for_family(
        found, parse_questions(Design(found.scene), ["transmission-angle", "diameter"])
    )
    good, bad = work.rows([*found.points()])
    assert not good.reason
    assert bad.values == (None, None)
    assert bad.failed
