"""Changes of a scene's text."""

from __future__ import annotations

import pathlib
import tomllib
from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.app.answers.size import size
from camgeo.app.designing.edits import changed
from camgeo.errors import CamgeoError, SceneError
from camgeo.scene.scene import parse_scene
from camgeo.scene.values import document, with_edits
from tests.designing.scenes import CHOSEN, FILES, FIXTURES, SETZHUB, TEXT, design, name_of
from tests.scene.scenes import leaves


def exact(text: str) -> dict[str, Any]:
    return tomllib.loads(text, parse_float=Decimal)


def comments(text: str) -> list[str]:
    return [line.partition("#")[2] for line in text.splitlines() if "#" in line]


@pytest.mark.parametrize("file", CHOSEN, ids=name_of)
def test_a_number_is_edited_and_set_back(file: pathlib.Path) -> None:
    text, own = file.read_bytes().decode(), design(file)
    numbers = {k: v for k, v in leaves(own.scene.values).items() if type(v) in (int, Decimal)}
    for key, value in sorted(numbers.items())[FILES.index(file) % 5 :: 9]:
        other = value + 1 if isinstance(value, int) else value * Decimal("1.01")
        there = changed(text, str(file), None, {"edits": {key: other}}, own)
        assert comments(there.text) == comments(text)
        assert changed(there.text, str(file), None, {"edits": {key: value}}).text in (
            text,
            text.replace("4e-6", str(Decimal("4e-6"))),  # the same number, spelled in full
        )
        if "motion" in key:
            continue  # the spans beside it change too
        assert exact(there.text) == with_edits(exact(text), {key: other})
        if there.scene is not None:
            assert there.scene == own.scene.with_values({key: other})
            assert there.scene == parse_scene(there.text, folder=file.parent)
            assert there.scene.to_toml() == there.text


@pytest.mark.parametrize(
    ("edits", "label"),
    [
        ({"motion[2].to": 40}, "segment 2 to 40 mm"),
        ({"follower.pivot": [1, 2.5]}, "pivot [1, 2.5] mm"),
        ({"follower.pivot[1]": -40.5}, "pivot 1 -40.5 mm"),
        ({"linkage.mirrored": True}, "mirrored on"),
        ({"linkage.crank_deflection": 30}, "crank deflection 30°"),
        ({"limits.radius_ratio": None}, "radius ratio removed"),
        ({"name": "x" * 200}, f"name {'x' * 75}..."),
        ({"part.bore": 1, "part.rim": 2, "name": "b"}, "bore 1 mm, rim 2 mm and 1 more"),
    ],
)
def test_a_label_names_the_change(edits: dict[str, Any], label: str) -> None:
    assert changed(TEXT, "", None, {"edits": edits}).label == label


def test_the_scene_may_be_wrong_before_and_after() -> None:
    found = changed(TEXT, "", None, {"edits": {"follower.roller_radius": "big"}}, design(SETZHUB))
    assert found.scene is None
    again = changed(found.text, "", None, {"edits": {"follower.roller_radius": Decimal("7.0")}})
    assert again.text == TEXT


def test_the_next_segment_gives_what_a_span_takes() -> None:
    found = changed(TEXT, "", None, {"edits": {"motion[2].span": 90.5}}, design(SETZHUB))
    motion = exact(found.text)["motion"]
    assert (motion[1]["span"], motion[2]["dwell"]) == (Decimal("90.5"), Decimal("9.5"))
    last = changed(TEXT, "", None, {"edits": {"motion[5].dwell": 50}})
    assert exact(last.text)["motion"][3]["span"] == 100
    with pytest.raises(
        SceneError, match="leaves no room for the neighbouring segment: -20 degrees"
    ):
        changed(TEXT, "", None, {"edits": {"motion[2].span": 120}})
    # Who sets both knows what he wants, and so does who repairs.
    both = changed(TEXT, "", None, {"edits": {"motion[2].span": 90, "motion[4].span": 80}})
    assert [both.text.count(each) for each in ("span = 90", "span = 80", "dwell = 20")] == [1] * 3
    broken = TEXT.replace("dwell = 20", "dwell = 21")
    assert changed(broken, "", None, {"edits": {"motion[3].dwell": 20}}).text == TEXT


def test_a_handle_that_cannot_be_there_stays() -> None:
    """The triangle of pivot, cam axis and roller does not close."""
    with pytest.raises(SceneError) as caught:
        changed(TEXT, str(SETZHUB), None, {"handle": "pivot", "to": [500, 0]}, design(SETZHUB))
    assert caught.value.faults[0].key == "follower.base_radius"


def test_a_cure_is_applied() -> None:
    file = FIXTURES / "refused" / "lobe_after_no_rest.toml"
    own = design(file)
    cures = own.judgement.cures
    assert any(each.works for each in cures)
    for number, cure in enumerate(cures):
        if not cure.works:
            with pytest.raises(SceneError):
                changed(file.read_text("utf-8"), str(file), None, {"cure": number}, own)
            continue
        found = changed(file.read_text("utf-8"), str(file), None, {"cure": number}, own)
        assert found.scene is not None, cure
        assert comments(found.text) == comments(file.read_text("utf-8"))


@pytest.mark.parametrize("name", ["scenes/setzhub", "scenes/conjugate_carriage"])
def test_sizes_are_applied(name: str) -> None:
    file = FIXTURES / f"{name}.toml"
    own = design(file)
    sized = size(own).edits
    assert sized
    found = changed(file.read_text("utf-8"), str(file), None, {"sized": sized})
    assert found.label.startswith("sized: ")
    assert parse_scene(found.text, folder=file.parent) == own.scene.with_values(sized)


ODD = [
    "", "a=1\n[b]\nc=nan\nd=inf\n[follower]\nroller_radius=3", "\ufeffa=1", "a = \ud800", "a=",
    "a.b=1\na.c=2\n[x.y]\nz=1\n[x]\nw=2\n[a2]\n[x.q]\nr=1", "motion=3\nfollower=3\neffects=3\n",
    'follower.roller_radius = 3\nfollower.kind="x"\n', "[[follower]]\nkind=1\n[[follower]]\n",
    "[[motion]]\ndwell=360\n[follower]\n[[motion2]]\n[follower.return]\nx=1\n", "linkage=[]",
    "motion=[\n {dwell=180}, # a\n {dwell=180}] # b\n", "d=1979-05-27T07:32:00Z\n[follower]\n",
    "x=-0.0\ny=1e400\n[follower]\nroller_radius=1_000.5\n", "a=" + "[" * 17 + "]" * 17,
    "'quoted key'=1\n[\"a.b\"]\nc=1\n[follower]\nroller_radius=0x10\n",
    'follower = {roller_radius = 3, kind="x"}\n', "[motion]\n", "x = " + "9" * 5000,
    "[a]\n[a.b]\n[c]\n[a.d]\nx=1\n[follower]\nroller_radius=1\n[a.e]\n", TEXT[:700],
]  # fmt: skip
"""Texts that are TOML or nearly, and no scenes."""

ASKED: list[dict[str, Any]] = [
    {}, {"other": 1}, {"edits": 3}, {"edits": {}}, {"edits": {"a": 1}, "cure": 0}, {"sized": {}},
    {"edits": {"follower.roller_radius": 8}}, {"edits": {"follower.roller_radius": None}},
    {"edits": {"motion[1].dwell": 90}}, {"edits": {"x.y.z": [1, {"a": 2}]}}, {"cure": 0},
    {"edits": {"name": '"\n</script>\u2028'}}, {"edits": {"name": float("nan")}}, {"cure": -1},
    {"edits": {"name": float("inf")}}, {"edits": {"name": 10**30}}, {"edits": {"name": "\ud800"}},
    {"edits": {"name": [None]}}, {"edits": {"": 1}}, {"edits": {"a" * 2000: 1}}, {"cure": "x"},
    {"edits": {"a..b": 1}}, {"edits": {3: 1}}, {"edits": {'"\\u0000"': 1}}, {"handle": None},
    {"edits": {".".join("abcdefghijklmnopqrs"): 1}}, {"handle": "pivot", "to": [1, 1]},
    {"segment": 3}, {"segment": {}}, {"segment": {"action": "insert", "at": 0}},
    {"segment": {"action": "remove", "at": 0}}, {"segment": {"action": "to-move", "at": 1}},
    {"segment": {"action": "split", "at": 0}}, {"segment": {"action": "up", "at": True}},
    {"table": 3}, {"table": {"key": "follower", "kind": "oscillating-flat"}}, {"effect": 3},
    {"table": {"key": "linkage", "kind": "four-bar"}}, {"table": {"key": [], "kind": {}}},
    {"table": {"key": "linkage", "kind": None}}, {"effect": {"name": "spring", "on": True}},
    {"effect": {"name": "spring", "on": False}}, {"effect": {"name": [], "on": True}},
]  # fmt: skip
"""Changes that can be asked of them, many of them none."""


@pytest.mark.parametrize("text", ODD, ids=range(len(ODD)))
def test_nothing_but_the_declared_errors_leaves(text: str) -> None:
    for arguments in ASKED:
        try:
            found = changed(text, "scene.toml", FIXTURES, arguments)
        except CamgeoError:
            continue
        assert exact(found.text) is not None
        assert 0 < len(found.label) < 200


def test_a_text_has_the_size_of_a_scene() -> None:
    with pytest.raises(SceneError, match="larger than 2,000,000 bytes"):
        changed(TEXT, "", None, {"edits": {"name": "x" * 2_000_000}})


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_changed_texts_are_changed_or_refused(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(FILES)).read_text("utf-8")
    start = data.draw(st.integers(0, len(text)))
    pieces = st.sampled_from(
        ["", "[", "]", "=", '"', "#", "\n", "3", "[[motion]]\n", "{}", ",", "."]
    )
    text = text[:start] + data.draw(pieces) + text[start + data.draw(st.integers(0, 30)) :]
    arguments = data.draw(st.sampled_from(ASKED))
    try:
        found = changed(text, "", FIXTURES / "scenes", arguments)
    except CamgeoError:
        return
    document(found.text.encode())
