"""Scenes that state blank, holding and tools, and what must hold for programs of ours."""

from __future__ import annotations

from functools import cache
from typing import Final

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.milling.machine import load
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from camgeo_export.interpreter.moves import Run
from camgeo_export.interpreter.run import run
from camgeo_export.verify.gcode import VERIFIER, bench_of

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


@cache
def product_of(text: str) -> Product:
    """The first disc of a scene."""
    return Design(parse_scene(text)).discs[0]


@cache
def written(text: str) -> bytes:
    """Its program."""
    return WRITER.write(product_of(text), TOLERANCE).data


def failing(product: Product, data: bytes, tolerance: float = TOLERANCE) -> list[Check]:
    """The checks that fail on a program, as of one of ours."""
    checks = VERIFIER.checks(product, data, Reading("a.nc"), tolerance)
    return [check for check in checks if check.ok is False]


def require_clean(product: Product, data: bytes) -> Run:
    """That nothing is found in a program, and it measures and verifies."""
    profile = load(product.milled.gcode.machine)
    found = run(data, profile, bench_of(product, profile))
    assert found.findings == ()
    assert WRITER.measure(product, data) <= TOLERANCE
    assert failing(product, data) == []
    return found
