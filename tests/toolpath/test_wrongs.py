"""What is said of scenes whose milling is refused or doubtful, and of programs run otherwise."""

from __future__ import annotations

import pytest

from tests.kept import compare_documents
from tests.thinned import WHOLE, share
from tests.toolpath.programs import TOLERANCE, milled, toolpath
from tests.toolpath.wrongs import REFUSED, RUN, WAYS, flawed, refusal, shifted

DEEPER = ("a second side, the other half",)
"""Programs that may run lower: the first side has cut there already."""


def test_what_is_said_of_scenes_is_as_kept() -> None:
    """The key that is at fault, its value, what is allowed; or what is told of the program."""
    said = {name: refusal(name) for name in share(REFUSED, 3)}
    compare_documents("toolpath/refused", said, whole=WHOLE)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", RUN)
def test_a_program_that_is_run_otherwise_is_as_kept(name: str, way: str) -> None:
    """What the cutter runs into, what is left, where and how much; the good program has none."""
    found = flawed(name, way)
    compare_documents(f"toolpath/run otherwise/{name}, {way}", {way: found})
    wrong = [each for each in found if not each["watched"]]
    last = toolpath(name).operations[-1]
    if way in ("lower", "far aside") and name not in DEEPER:
        assert wrong
    for each in wrong:
        if each["name"] == "depth":
            assert each["value"] < each["limit"]
        if way == "aside" and each["operation"] == last.name and each["name"] == "gouge":
            assert each["value"] == pytest.approx(0.05, abs=0.02)


def test_a_face_that_is_milled_too_deep_is_told() -> None:
    """By half of the part's thickness, all over."""
    name = "planned, from a round blank"
    deep = shifted(toolpath(name), 0, (0.0, 0.0, -3.0))
    assert "gouge" in [each.name for each in milled(name).flaws(deep, TOLERANCE)]


def test_a_bore_that_is_not_cut_is_told_with_its_size() -> None:
    found = refusal("a slot of that width")[1]
    (rest,) = [each for each in found if each["name"] == "rest"]
    assert rest["value"] == pytest.approx(10.0, abs=0.1)
