"""What is told of jobs, against independent sweeps of their programs."""

from __future__ import annotations

import random
import re
from pathlib import Path
from unittest.mock import patch

import pytest
import shapely

import camgeo
from camgeo.app.answers.check import check
from camgeo.design.milled import MilledDisc
from tests.draws.jobs import Job, Told, drawn, misses, polygons, read, swept

FRAME = (Path(__file__).parents[2] / "fixtures" / "found" / "loose_frame.toml").read_text("utf-8")

PLATE = "length = 150\nwidth = 150"

STEEL = 7.85e-6
"""Density [kg/mm^3]."""


def job(number: int) -> Job:
    """One of those that a fixed seed draws."""
    source = random.Random(39)
    return [drawn(source) for _ in range(number + 1)][number]


@pytest.mark.parametrize("number", [5, 9, 31])
def test_a_sweep_of_the_program_finds_the_same(number: int) -> None:
    """A gouge with a rest; pieces and a rest; waste on a fixture."""
    found = misses(job(number))
    assert found is not None
    ours, different = found
    assert different == []
    assert ours != Told()


@pytest.mark.parametrize(
    ("blank", "outline"),
    [
        (PLATE, shapely.box(-75.0, -75.0, 75.0, 75.0)),
        ('shape = "round"\ndiameter = 170', shapely.Point(0.0, 0.0).buffer(85.0, 256)),
        ('shape = "round"\ndiameter = 130', shapely.Point(0.0, 0.0).buffer(65.0, 256)),
    ],
)
def test_waste_that_nothing_holds_comes_loose(
    blank: str, outline: shapely.Polygon, tmp_path: Path
) -> None:
    """A frame, a ring, a crescent: what the slot leaves of the blank beside the part."""
    text = FRAME.replace(PLATE, blank)
    with patch.object(MilledDisc, "safe", lambda *_: ()):  # it must not be run
        camgeo.loads(text).write(tmp_path, ["gcode"])
    (rough, *_) = read((tmp_path / "steel120.ngc").read_text())
    left = outline - swept(rough.moves, -11.99, 6.0)
    middle = shapely.Point(20.0, 0.0)  # of the part, beside its bore
    (waste,) = (each for each in polygons(left) if not each.contains(middle))
    found = check(camgeo.loads(text))
    assert found.machining is not None
    (loose,) = (each for each in found.machining.findings if each.name == "loose")
    assert (loose.severity, found.exit_code) == ("broken", 1)
    assert loose.value == pytest.approx(12.0 * waste.area, rel=1e-3)
    mass = re.search(r"mm\^3, ([\d.]+) kg", loose.sentence)
    assert mass is not None
    assert float(mass[1]) == pytest.approx(STEEL * 12.0 * waste.area, rel=6e-3)  # three digits
    assert "nothing holds it at X " in loose.sentence


@pytest.mark.parametrize(
    ("stated", "operation"),
    [("", ""), ('until = "outline"\n', "outline"), ('since = "outline"\n', "rough outline")],
)
def test_a_screw_holds_while_it_is_there(stated: str, operation: str) -> None:
    """On a corner of the frame; where it comes too late, or goes too early, that comes loose."""
    screw = f"[[holding.screw]]\nplace = [68, 68]\nhead_diameter = 10\nheight = 8\n{stated}"
    found = check(camgeo.loads(FRAME.replace("[[tool]]", f"{screw}[[tool]]", 1))).machining
    assert found is not None
    told = [each.sentence for each in found.findings if each.name == "loose"]
    assert [each.partition(":")[0] for each in told] == [operation] * bool(operation)
