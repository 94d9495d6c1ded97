"""The picture of the shock spectra: its curves are those of the effect."""

from __future__ import annotations

from functools import cache
from typing import TypeVar

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.pictures.effects import spectrum_figure
from camgeo.pictures.model import Line, Rule, Text
from camgeo.pictures.plots import SPECTRUM, of_design
from camgeo.scene.scene import load_scene, parse_scene
from camgeo_export.plots import render
from tests.answers.documents import FIXTURES

PRESS = FIXTURES / "effects" / "press.toml"


Kind = TypeVar("Kind", Line, Rule)


def marks(design: Design, kind: type[Kind]) -> list[Kind]:
    (row,) = of_design(design, [SPECTRUM])[0].rows
    return [each for each in row.panels[0].marks if isinstance(each, kind)]


@cache
def steady() -> Design:
    """The press at the constant speed that it states, where both moves take as long."""
    text = PRESS.read_text(encoding="utf-8")
    return Design(parse_scene(f'{text}\n[state]\nspeed = "stated"\n'))


def test_curves_are_those_of_the_effect_and_equal_ones_are_drawn_once() -> None:
    design = steady()
    lines = {each.label: each for each in marks(design, Line)}
    found = design.effect(SPECTRUM)
    assert len(found.spectra) == 2  # both by one law
    where = "40 to 150° and 200 to 310°"
    for of, word in (
        (found.spectra[0].residual, "residual"),
        (found.spectra[1].largest, "largest"),
    ):
        points = lines[f"{word}, {where}"].points[::40]
        assert points[:, 1] == pytest.approx(100.0 * of(points[:, 0]), rel=1e-6)
    largest, remains = lines[f"largest, {where}"].points, lines[f"residual, {where}"].points
    assert np.all(largest[:, 1] >= remains[:, 1])


def test_the_train_of_the_scene_is_marked_at_the_natural_periods_of_each_move() -> None:
    design = steady()
    (rule,) = (each for each in marks(design, Rule) if each.axis == "x")
    # 110 degrees at 240 rev/min, and the frequency that the scene states
    frequency = design.scene.effects["vibration"]["natural_frequency"] / (2.0 * np.pi)
    assert rule.at == pytest.approx(110.0 / 360.0 / (240.0 / 60.0) * frequency, rel=1e-9)
    assert f"{frequency:.4g} Hz" in rule.label


def test_a_scene_without_the_effect_has_no_such_picture() -> None:
    with pytest.raises(SceneError, match="shock-spectrum"):
        of_design(Design(load_scene(FIXTURES / "effects" / "lever.toml")), [SPECTRUM])


def test_a_motion_without_a_move_from_rest_to_rest_says_so() -> None:
    drawn = spectrum_figure("swing", (), 10.0)
    (panel,) = drawn.panels
    (words,) = panel.marks
    assert isinstance(words, Text)
    assert words.text == "no move is from rest to rest"
    assert (panel.bare, words.at, panel.x.limits, panel.y.limits) == (
        True, (0.5, 0.5), (0.0, 1.0), (0.0, 1.0),
    )  # fmt: skip
    assert render(drawn, ".svg").startswith(b"<?xml")
