"""The result of `camgeo compare`, rendered as text, as JSON and as a picture."""

from __future__ import annotations

import pytest

from camgeo.app.answers.answer import figure, text
from camgeo.app.answers.check import check
from camgeo.app.answers.compare import Compare, compare, scene_labels
from camgeo.design.design import Design
from camgeo.errors import UnknownNameError
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document
from tests.sweep.families import SETZHUB

OTHER = SETZHUB.with_values({"follower.base_radius": 46, "name": "other", "limits.radius_ratio": 1})


def compared(*ask: str) -> Compare:
    return compare([("a", Design(SETZHUB)), ("b", Design(OTHER))], ask)


def test_findings_are_those_of_a_check_side_by_side() -> None:
    answer = compared()
    reported = document(answer)
    for number, scene in enumerate((SETZHUB, OTHER)):
        found = check(Design(scene)).everything
        for name in {each.name for each in found}:
            first = next(each for each in found if each.name == name)
            (line,) = (line for line in reported["findings"] if line["name"] == name)
            cell = line["values"][number]
            assert (cell["value"], cell["severity"]) == (first.value, first.severity)
    assert [each["verdict"] for each in reported["designs"]] == ["warning", "broken"]
    assert reported["keys"] == [
        {"key": "follower.base_radius", "values": ["50.199", "46"]},
        {"key": "limits.radius_ratio", "values": ["0.7", "1"]},
    ]


def test_only_what_is_asked_is_computed() -> None:
    answer = compared("transmission-angle", "peak:a")
    document(answer)
    assert [line.name for line in answer.lines] == ["transmission-angle", "peak:a"]
    for each in answer.designs:
        assert each.verdict == ""
        names = {run.name for run in each.design.ledger.runs}
        assert names <= {"motion", "pitch_curve", "time_course", "smooth_angles"}


def test_what_only_one_design_has() -> None:
    inch = Design(load_scene(FIXTURES / "scenes" / "inch.toml"))
    lever = Design(load_scene(FIXTURES / "effects" / "lever.toml"))
    answer = compare([("a", inch), ("b", lever)], ["peak:contact-force"])
    (line,) = answer.lines
    assert line.cells[0].reason == "has no such finding or column"
    assert isinstance(line.cells[1].value, float)
    assert "a: peak:contact-force: has no such finding or column" in text(answer)
    (line,) = compare([("a", inch), ("b", lever)], ["machining-time"]).lines
    assert line.cells[0].unit == "s"
    assert line.cells[1].reason == "tool: is not stated: machining-time needs a milling program"
    with pytest.raises(UnknownNameError, match="there is no finding"):
        compared("no-such-finding")


def test_a_scene_without_follower_is_compared_too() -> None:
    bare = SETZHUB.with_values({"follower": None, "linkage": None, "part": None, "tool": None,
                                "holding": None, "output": None, "limits": None})  # fmt: skip
    answer = compare([("a", Design(bare)), ("b", Design(SETZHUB))])
    document(answer)
    assert len(figure(answer).panels) == 4


def test_labels_tell_designs_apart() -> None:
    assert scene_labels(["a/x.toml", "b/y.toml"]) == ["x", "y"]
    assert scene_labels(["a/x.toml", "b/x.toml"]) == ["a/x.toml", "b/x.toml"]
