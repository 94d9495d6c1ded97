"""All figures of all effects of many scenes are those of the record, see `tests.effects.recorded`.

What the figures have to be is held by the other modules here, each against a model of its own; the
record holds all of them, also where no other model would be worth it: places, limits, sentences,
stated errors, each column all round.
"""

from __future__ import annotations

import json
from typing import Any, Final

import pytest

from tests.effects.recorded import GROUPS, designs, differences, differs, leaves, record
from tests.thinned import share

DEAR: Final = ("press", "linked_press", "tappet", "camshaft_windup")
"""Motors and shafts before elastic trains, at seconds each; smaller ones are among the small."""


def off(group: str, *, dear: bool = False) -> list[str]:
    """Where results of a group are not those of the record; in a usual run, of a share of it."""
    some = [each for each in designs(group) if (each[0] in DEAR) is dear]
    return [off for each in share(some, 4) for off in differences(*each)]


def test_small_scenes_have_the_results_of_the_record() -> None:
    assert not off("small")


def test_mechanisms_of_all_kinds_have_the_results_of_the_record() -> None:
    assert not off("mechanisms")


def test_trimmed_discs_and_written_contours_have_the_results_of_the_record() -> None:
    assert not [each for name, made in designs("states") for each in differences(name, made)]


def test_the_scenes_of_effects_have_the_results_of_the_record() -> None:
    assert not off("fixtures")


@pytest.mark.long  # the kinds of effects are those of the small scenes
def test_dear_scenes_have_the_results_of_the_record() -> None:
    assert not off("fixtures", dear=True)


def test_the_record_has_no_scene_that_is_gone() -> None:
    assert list(record()) == [name for group in GROUPS for name, _ in designs(group)]


def test_each_difference_is_told() -> None:
    """Of a result with a finding and a column, each number and text off by more than may be."""
    kept = record()["windup"]["drive-torque"]
    assert not [*differs(kept, kept)]
    for way, _ in leaves(kept):
        if "size" not in way:  # the scale that bounds are compared with
            changed = json.loads(json.dumps(kept))
            change(changed, way)
            assert [*differs(changed, kept)], way


def change(of: Any, way: tuple[Any, ...]) -> None:
    for key in way[:-1]:
        of = of[key]
    old = of[way[-1]]
    of[way[-1]] = 1.01 * old + 1e-3 + abs(old) if isinstance(old, (int, float)) else f"{old}, other"
