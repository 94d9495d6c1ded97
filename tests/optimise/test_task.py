"""What is sought, as texts of the command line say it."""

from __future__ import annotations

import pytest

from camgeo.errors import CamgeoError
from camgeo.studies.optimise.optimise import task_of
from tests.sweep.families import SETZHUB

RANGE = "follower.base_radius=40:60"


def test_objectives_and_limits_are_named_as_findings_and_columns_are() -> None:
    found = task_of(
        SETZHUB,
        [RANGE],
        least=["diameter", "peak: a"],
        largest=["transmission angle"],
        keep=["transmission-angle >= 4.2e1", "max:mu<=80"],
        ignore=["radius-ratio-inner"],
    )
    assert [str(limit) for limit in found.limits] == ["transmission-angle >= 42", "max:mu <= 80"]
    assert [(goal.question.word, goal.sense) for goal in found.goals] == [
        ("diameter", "least"), ("peak:a", "least"), ("transmission-angle", "largest")]  # fmt: skip
    # What is asked twice is computed once.
    assert [each.word for each in found.questions] == [
        "diameter", "peak:a", "transmission-angle", "max:mu"]  # fmt: skip
    assert not found.matters("transmission-angle")
    assert not found.matters("radius-ratio-inner")
    assert found.matters("undercut-inner")
    assert not task_of(SETZHUB, [RANGE], least=["diameter"], ignore=["limits"]).matters("mass")


def test_margins_are_relative_and_negative_beyond() -> None:
    (least,), (most,), (nought,) = (
        task_of(SETZHUB, [RANGE], least=["diameter"], keep=[text]).limits
        for text in ("diameter>=50", "diameter<=50", "diameter<=0")
    )
    assert (least.margin(60.0), most.margin(60.0)) == (0.2, -0.2)
    assert (least.margin(50.0), most.margin(50.0)) == (0.0, 0.0)
    assert nought.margin(3.0) == -3.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({}, "names no objective"),
        ({"least": ["diametre"]}, 'did you mean "diameter"'),
        ({"least": ["verdict"]}, "is a word"),
        ({"least": ["peak:aa"]}, "peak:aa|column"),
        ({"least": ["diameter"], "largest": ["diameter"]}, "names an objective twice"),
        ({"least": ["max:s", "min:s", "peak:s", "peak:v", "peak:a", "diameter"]}, "more than 5"),
        ({"least": ["diameter"], "keep": ["diameter"]}, "must be NAME>=NUMBER"),
        ({"least": ["diameter"], "keep": ["diameter>=x"]}, "must be NAME>=NUMBER"),
        ({"least": ["diameter"], "keep": ["diameter<=inf"]}, "must be NAME>=NUMBER"),
        ({"least": ["diameter"], "keep": ["diameter>3"]}, "must be NAME>=NUMBER"),
        ({"least": ["diameter"], "ignore": ["transmision-angle"]}, "did you mean"),
        ({"least": ["diameter"], "vary": ["follower.base_radis=1:2"]}, "did you mean"),
        ({"least": ["diameter"], "vary": ["follower.base_radius=5:5"]}, "is an empty range"),
        ({"least": ["diameter"], "vary": []}, "nothing varies"),
    ],
)
def test_wrong_tasks(words: dict[str, list[str]], message: str) -> None:
    vary = words.pop("vary", [RANGE])
    with pytest.raises(CamgeoError, match=message):
        task_of(SETZHUB, vary, **words)
