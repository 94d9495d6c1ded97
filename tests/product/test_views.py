"""Views of a design: small, and each computed only for its reader."""

from __future__ import annotations

import json
import math
import pickle
import subprocess
import sys
from dataclasses import fields
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.design.drawn import DrawnDisc
from camgeo.design.milled import MilledDisc
from camgeo.design.pictured import PicturedCam
from camgeo.design.product import Product
from camgeo.design.value_table import TabulatedCam
from camgeo.record import Pickled
from tests.export.stub_product import StubProduct
from tests.part.parts import refused

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"

VIEWS = {
    "drawn": DrawnDisc,
    "milled": MilledDisc,
    "tabulated": TabulatedCam,
    "pictured": PicturedCam,
}

MOST = 15
"""Public members of a view."""

READERS = {"csv": {"tabulated"}, "dxf": {"drawn"}, "gcode": {"drawn", "milled"}}
"""Formats, and the views that are computed for them."""


def members(of: type) -> set[str]:
    return {name for name in vars(of) if not name.startswith("_")}


@pytest.mark.parametrize("view", VIEWS.values())
def test_a_view_is_small(view: type) -> None:
    answers = members(view) - {each.name for each in fields(view)} - members(Pickled)
    assert 0 < len(answers) <= MOST


@pytest.mark.parametrize("name", ["drawn", "milled", "tabulated"])
def test_the_stub_of_writers_gives_all_of_a_view(name: str) -> None:
    view = VIEWS[name]
    answers = members(view) - {each.name for each in fields(view)} - members(Pickled)
    assert answers <= {*members(StubProduct), *(each.name for each in fields(StubProduct))}


def test_a_product_is_small() -> None:
    assert len(members(Product) - {each.name for each in fields(Product)}) <= MOST


@pytest.mark.parametrize("name", READERS)
def test_a_writer_is_computed_its_own_view_and_no_other(name: str) -> None:
    code = (
        "import camgeo, json, sys; from camgeo.design.writing import find_writer;"
        f"find_writer({name!r}).write(camgeo.load(sys.argv[1]).disc, 0.01);"
        "print(json.dumps([n for n in sys.modules if n.startswith('camgeo.design.')]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(SCENE)], capture_output=True, text=True, check=True
    )
    modules = {view: VIEWS[view].__module__ for view in VIEWS}
    loaded = set(json.loads(done.stdout))
    assert {view for view in VIEWS if modules[view] in loaded} == READERS[name]


def test_views_travel_in_pickles_and_answer_the_same() -> None:
    design = camgeo.load(SCENE)
    drawn, milled, tabulated, pictured = pickle.loads(
        pickle.dumps(
            (design.disc.drawn, design.disc.milled, design.tabulated, design.disc.pictured)
        )
    )
    assert len(drawn.part.boundaries) == len(design.disc.drawn.part.boundaries)
    assert milled.toolpath(0.01).operations[0].cut.name == design.disc.milled.cuts[0].name
    step = Decimal(30)
    assert np.array_equal(tabulated.table(step).values, design.tabulated.table(step).values)
    phi = np.linspace(0.0, 6.0, 7)
    assert np.array_equal(pictured.curve("inner", phi), design.disc.pictured.curve("inner", phi))


@pytest.mark.parametrize(
    "step", [*map(Decimal, ("0", "-1", "NaN", "100")), 0, -1.0, 91, math.inf, "1", True]
)
def test_a_table_has_a_step_of_the_scene_s_range(step: Any) -> None:
    with refused("output.csv.step", "must be a number from 0.001 to 90 "):
        camgeo.load(SCENE).tabulated.table(step)


@pytest.mark.parametrize("step", [0.2, np.float64(0.2), Fraction(1, 5), 30, np.int64(30)])
def test_a_table_takes_any_number_as_its_step(step: Any) -> None:
    """0.2 is the decimal number 0.2, so the last row is exactly at 359.8 degrees."""
    tabulated = camgeo.load(SCENE).tabulated
    exact = Decimal("0.2") if step < 1 else Decimal(30)
    assert np.array_equal(tabulated.table(step).values, tabulated.table(exact).values)
