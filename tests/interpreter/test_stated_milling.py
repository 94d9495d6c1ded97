"""Programs of scenes that state blank, holding and tools: nothing is found in them, they verify."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo.milling.machine import load
from camgeo_export.gcode.measure import bench_of
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.run import run_bytes
from camgeo_export.verify.gcode import VERIFIER
from tests.long_form import LONG

TOLERANCE: Final = 0.02

CAM: Final = """camgeo = 1
name = "stated"
[cam]
rotation = "cw"
[follower]
kind = "translating-roller"
base_radius = 25
roller_radius = 8
[[motion]]
law = "polynomial-345"
span = 180
to = 8
[[motion]]
law = "polynomial-345"
span = 180
to = 0
[part]
thickness = 6
bore = 18
[[tool]]
number = 4
diameter = 10
flute_length = 12
spindle_speed = 3000
feed = 500
plunge_feed = 150
stepdown = 3
stepover = 3
ramp_angle = 3
coolant = "flood"
[output]
formats = ["gcode"]
[output.gcode]
clearance_height = 15
retract_height = 3
"""

SCREWED: Final = """[stock]
shape = "round"
diameter = 70
top = 1
bottom = 0
[holding]
kind = "screws"
through = 0.5
[[holding.screw]]
place = [0, 0]
head_diameter = 24
height = 8
since = "rough outline"
"""

TABBED: Final = """[holding]
kind = "tabs"
through = 0.3
count = 3
width = 5
height = 1.5
"""

SKINNED: Final = """[stock]
length = 80
width = 70
[holding]
kind = "onion-skin"
thickness = 0.2
"""

MACHINES: Final = ("linuxcnc", "haas", "heidenhain")

CHAMFERING: Final = ("linuxcnc", "fanuc", "heidenhain")

HELD: Final = {"screws": SCREWED, "tabs": TABBED, "onion-skin": SKINNED}


def product_of(folder: Path, held: str, machine: str) -> Product:
    path = folder / "scene.toml"
    path.write_text(f'{CAM}machine = "{machine}"\n{HELD[held]}', "utf-8")
    return Design(camgeo.load(path).scene).discs[0]


@pytest.mark.parametrize(
    ("held", "machine"),
    [
        (held, machine)
        for k, held in enumerate(HELD)
        for machine in (MACHINES if LONG else MACHINES[k : k + 1])
    ],
)
def test_programs_are_clean_and_verify(held: str, machine: str, tmp_path: Path) -> None:
    product, profile = product_of(tmp_path, held, machine), load(machine)
    data = WRITER.write(product, TOLERANCE).data
    bench = bench_of(product, profile)
    found = run_bytes(data, profile, bench)
    assert found.findings == ()
    assert {move.coolant for move in found.moves if move.kind != "rapid"} == {"flood"}
    assert WRITER.measure(product, data) <= TOLERANCE
    checks = VERIFIER.checks(product, data, Reading("a.nc"), TOLERANCE)
    assert [check for check in checks if check.ok is False] == []
    assert bench.stock_top == (1.0 if held == "screws" else 0.0)


def test_from_a_halt_the_cutter_comes_back_above_its_first_point(tmp_path: Path) -> None:
    """The operator may have moved it: no cut goes down before X and Y are said again."""
    text = WRITER.write(product_of(tmp_path, "screws", "linuxcnc"), TOLERANCE).data.decode()
    (halt,) = re.finditer(r"^M0$", text, re.MULTILINE)
    after = [line for line in text[halt.end() :].splitlines() if line.startswith("G0")]
    assert re.fullmatch(r"G0 Z15\.0+", after[0])
    assert re.fullmatch(r"G0 X\S+ Y\S+", after[1])
    assert re.fullmatch(r"G0 Z3\.0+", after[2])


@pytest.mark.parametrize("machine", ["linuxcnc", "haas", "sinumerik"])
def test_the_operator_comes_before_anything_is_switched_on(machine: str, tmp_path: Path) -> None:
    text = WRITER.write(product_of(tmp_path, "screws", machine), TOLERANCE).data.decode()
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
def test_strategies_of_roughing_are_clean_and_verify(
    strategy: str, machine: str, tmp_path: Path
) -> None:
    own = f'strategy = "{strategy}"\nstepdown = 7\nfeed = 1500'
    operations = [
        f'kind = "rough"\ntool = 4\nboundary = "outline"\nallowance = 0.2\n{own}',
        'kind = "finish"\ntool = 4\nboundary = "outline"',
    ]
    tables = "".join(f"[[operation]]\n{each}\n" for each in operations)
    path = tmp_path / "scene.toml"
    bored = SKINNED.replace("width = 70", "width = 70\nbore = 18")
    text = CAM.replace("[output]", f"{bored}{tables}[output]", 1)
    path.write_text(f'{text}machine = "{machine}"\n', "utf-8")
    product, profile = Design(camgeo.load(path).scene).discs[0], load(machine)
    data = WRITER.write(product, TOLERANCE).data
    assert run_bytes(data, profile, bench_of(product, profile)).findings == ()
    reading = Reading("a.nc")
    checks = VERIFIER.checks(product, data, reading, TOLERANCE)
    assert [check for check in checks if check.ok is False] == []


@pytest.mark.parametrize(
    ("name", "machine"),
    [
        (name, machine)
        for k, name in enumerate(EDGED)
        for machine in (CHAMFERING if LONG else CHAMFERING[k % 3 : k % 3 + 1])
    ],
)
def test_chamfers_are_clean_and_verify(name: str, machine: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f'{chamfered(name)}machine = "{machine}"\n', "utf-8")
    product, profile = Design(camgeo.load(path).scene).discs[0], load(machine)
    data = WRITER.write(product, TOLERANCE).data
    found = run_bytes(data, profile, bench_of(product, profile))
    assert found.findings == ()
    checks = VERIFIER.checks(product, data, Reading("a.nc"), TOLERANCE)
    assert [check for check in checks if check.ok is False] == []
    measured = [check.of for check in checks if check.name == "deviation"]
    for wall in EDGED[name][1]:
        assert any(of.startswith(f"chamfer {wall}") for of in measured)
