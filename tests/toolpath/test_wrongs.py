"""What is said of scenes whose milling is refused or doubtful, and of programs run otherwise."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import pytest

from tests.toolpath.programs import TOLERANCE, milled, rounded, toolpath
from tests.toolpath.test_programs import same
from tests.toolpath.wrongs import FILE, REFUSED, RUN, WAYS, flawed, refusal, shifted

DEEPER = ("a second side, faced free", "a second side, the other half")
"""Programs that may run lower: of one the cutter is seen to go too deep no more, see below, and the
first side has cut there already.
"""


@cache
def kept() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text("utf-8"))
    return found


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_said_of_a_scene(name: str) -> None:
    """The key that is at fault, its value, what is allowed; or what is told of the program."""
    assert not list(same(rounded(refusal(name)), kept()["refused"][name], name))
    assert kept()["refused"].keys() == set(REFUSED)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", RUN)
def test_a_program_that_is_run_otherwise(name: str, way: str) -> None:
    """What the cutter runs into, what is left, where and how much; the good program has none."""
    found = flawed(name, way)
    assert not list(same(rounded(found), kept()[name][way], f"{name}: {way}"))
    wrong = [each for each in found if not each["watched"]]
    last = toolpath(name).operations[-1]
    if way in ("lower", "far aside") and name not in DEEPER:
        assert wrong
    for each in wrong:
        if each["name"] == "depth":
            assert each["value"] < each["limit"]
        if way == "aside" and each["operation"] == last.name and each["name"] == "gouge":
            assert each["value"] == pytest.approx(0.05, abs=0.02)


@pytest.mark.xfail(
    strict=True,
    reason="the depth of a gouge is taken at the corners of the area that is cut away, which all"
    " lie on the edge of the part if that is all of it",
)
def test_a_face_that_is_milled_too_deep_is_told() -> None:
    """By half of the part's thickness, all over."""
    name = "planned, from a round blank"
    deep = shifted(toolpath(name), 0, (0.0, 0.0, -3.0))
    assert "gouge" in [each.name for each in milled(name).flaws(deep, TOLERANCE)]


@pytest.mark.xfail(
    strict=True,
    reason="the thickness of a rest is taken at its corners, which all lie beside the wall",
)
def test_a_bore_that_is_not_cut_is_told_with_its_size() -> None:
    found = refusal("a slot of that width")[1]
    (rest,) = [each for each in found if each["name"] == "rest"]
    assert rest["value"] == pytest.approx(10.0, abs=0.1)
