"""Programs of scenes that state blank, holding and tools: nothing is found in them, they verify."""

from __future__ import annotations

import re
from typing import Final

import pytest

from camgeo.design.verify import Reading
from camgeo.errors import SceneError
from camgeo.milling.machine import load
from camgeo.scene.scene import parse_scene
from camgeo_export.verify.gcode import VERIFIER, bench_of
from tests.interpreter.stated import (
    CAM,
    SCREWED,
    SKINNED,
    TABBED,
    TOLERANCE,
    product_of,
    require_clean,
    written,
)
from tests.long_form import LONG

MACHINES: Final = ("linuxcnc", "haas", "heidenhain")

CHAMFERING: Final = ("linuxcnc", "fanuc", "heidenhain")

HELD: Final = {"screws": SCREWED, "tabs": TABBED, "onion-skin": SKINNED}


def held_by(held: str, machine: str) -> str:
    return f'{CAM}machine = "{machine}"\n{HELD[held]}'


@pytest.mark.parametrize(
    ("held", "machine"),
    [
        (held, machine)
        for k, held in enumerate(HELD)
        for machine in (MACHINES if LONG else MACHINES[k : k + 1])
    ],
)
def test_programs_are_clean_and_verify(held: str, machine: str) -> None:
    text = held_by(held, machine)
    product = product_of(text)
    found = require_clean(product, written(text))
    assert {move.coolant for move in found.moves if move.kind != "rapid"} == {"flood"}
    bench = bench_of(product, load(machine))
    assert bench.stock_top == (1.0 if held == "screws" else 0.0)


def test_from_a_halt_the_cutter_comes_back_above_its_first_point() -> None:
    """The operator may have moved it: no cut goes down before X and Y are said again."""
    text = written(held_by("screws", "linuxcnc")).decode()
    (halt,) = re.finditer(r"^M0$", text, re.MULTILINE)
    after = [line for line in text[halt.end() :].splitlines() if line.startswith("G0")]
    assert re.fullmatch(r"G0 Z15\.0+", after[0])
    assert re.fullmatch(r"G0 X\S+ Y\S+", after[1])
    assert re.fullmatch(r"G0 Z3\.0+", after[2])


@pytest.mark.parametrize("machine", ["linuxcnc", "haas", "sinumerik"])
def test_the_operator_comes_before_anything_is_switched_on(machine: str) -> None:
    text = written(held_by("screws", machine)).decode()
    _, _, operation = text.lower().partition("operation rough outline")
    before, halt, after = operation.partition("m0\n")
    assert halt
    assert "set the screw" in before
    assert "m5" in before
    assert not re.search(r"\bm(3|7|8)\b", before)
    assert re.search(r"\bm3\b.*\bm8\b", after, re.DOTALL)


POINTED: Final = """[[tool]]
number = 5
kind = "chamfer-mill"
diameter = 8
tip_angle = 90
spindle_speed = 6000
feed = 800
plunge_feed = 150
[holding]
kind = "fixture"
through = 0.5
"""

EDGED: Final = {
    "plate": (CAM, ("bore", "outline"), 0.5),
    "groove": (
        CAM.replace("roller_radius = 8", 'roller_radius = 8\ncontact = "groove"').replace(
            "thickness = 6", "thickness = 10\nrim = 110\ngroove_depth = 5"
        ),
        ("bore", "outer flank", "inner flank"),
        0.3,
    ),
}
"""Scenes, the walls whose edges are chamfered, and the size of the chamfers."""


def chamfered(name: str) -> str:
    """Each wall roughed and finished, and its edge chamfered."""
    text, walls, size = EDGED[name]
    operations = [
        f'kind = "{kind}"\ntool = 4\nboundary = "{wall}"\nallowance = {left}'
        for kind, left in (("rough", 0.2), ("finish", 0))
        for wall in walls
    ]
    operations += [
        f'kind = "chamfer"\ntool = 5\nsize = {size}\nboundary = "{wall}"' for wall in walls
    ]
    tables = "".join(f"[[operation]]\n{each}\n" for each in operations)
    return text.replace("[output]", f"{POINTED}{tables}[output]", 1)


@pytest.mark.parametrize(
    ("strategy", "machine"),
    [("trochoidal", "linuxcnc"), ("trochoidal", "heidenhain"), ("spiral", "fanuc")],
)
def test_strategies_of_roughing_are_clean_and_verify(strategy: str, machine: str) -> None:
    own = f'strategy = "{strategy}"\nstepdown = 7\nfeed = 1500'
    rough = f'kind = "rough"\ntool = 4\nboundary = "outline"\nallowance = 0.2\n{own}'
    finish = 'kind = "finish"\ntool = 4\nboundary = "outline"'
    bored = SKINNED.replace("width = 70", "width = 70\nbore = 18")
    tables = f"{bored}[[operation]]\n{rough}\n[[operation]]\n{finish}\n[output]"
    text = f'{CAM.replace("[output]", tables, 1)}machine = "{machine}"\n'
    data = written(text)
    require_clean(product_of(text), data)


@pytest.mark.parametrize(
    ("name", "machine"),
    [
        (name, machine)
        for k, name in enumerate(EDGED)
        for machine in (CHAMFERING if LONG else CHAMFERING[k % 3 : k % 3 + 1])
    ],
)
def test_chamfers_are_clean_and_verify(name: str, machine: str) -> None:
    text = f'{chamfered(name)}machine = "{machine}"\n'
    product, data = product_of(text), written(text)
    require_clean(product, data)
    checks = VERIFIER.checks(product, data, Reading("a.nc"), TOLERANCE)
    measured = " ".join(check.of for check in checks if check.name == "deviation")
    assert [wall for wall in EDGED[name][1] if f"chamfer {wall}" not in measured] == []


OPERATIONS: Final = """[[operation]]
kind = "rough"
boundary = "outline"
tool = 4
allowance = 0.3
[[operation]]
kind = "finish"
boundary = "outline"
tool = 4
"""

WRONG: Final = (
    (f'machine = "grbl"\ncompensation = "wear"\n{TABBED}',
     'output.gcode.compensation = "wear": must be one of "computed" for Grbl'),
    (f'compensation = "worn"\n{TABBED}',
     'compensation = "worn": must be one of "computed", "wear", "control"'),
    (TABBED + OPERATIONS.replace("allowance = 0.3", 'compensation = "wear"'),
     'operation[1].compensation = "wear": belongs to kind "finish"'),
    (f'{TABBED}{OPERATIONS}compensation = "worn"\n', "operation[2].compensation"),
    (f'machine = "grbl"\n{TABBED}{OPERATIONS}compensation = "control"\n',
     'operation[2].compensation = "control": must be one of "computed" for Grbl'),
    (f'zero = "left"\n{TABBED}',
     'output.gcode.zero = "left": must be one of "axis", "front-left"'),
    (f'zero_height = "top"\n{TABBED}',
     'output.gcode.zero_height = "top": must be one of "part-top"'),
)  # fmt: skip
"""What stands in a scene, and its fault."""


@pytest.mark.parametrize(("tables", "fault"), WRONG)
def test_wrong_values_are_refused_with_their_key(tables: str, fault: str) -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(f"{CAM}{tables}")
    assert [str(each) for each in caught.value.faults if fault in str(each)], str(caught.value)
