"""Scenes with a second side, each small."""

from __future__ import annotations

from functools import cache
from typing import Final

from camgeo.design.design import Design
from camgeo.design.product import Product, product_sides
from camgeo.scene.scene import parse_scene

TOLERANCE: Final = 0.02

CAM: Final = """camgeo = 1
name = "both"
[cam]
rotation = "cw"
[follower]
kind = "translating-roller"
base_radius = 25
roller_radius = 8
offset = 3
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
stepover = 6
ramp_angle = 5
[[tool]]
number = 5
kind = "chamfer-mill"
diameter = 6
tip_angle = 90
spindle_speed = 3000
feed = 400
plunge_feed = 150
[output]
formats = ["gcode"]
"""

FACED: Final = """[stock]
shape = "round"
diameter = 70
top = 0.5
bottom = 2.5
[holding]
kind = "fixture"
through = 0.3
[second_side]
turned_about = "{about}"
retract_height = 4
[second_side.holding]
kind = "fixture"
through = 0
"""
"""A slice of a bar, faced free from the other side; both sequences are planned."""

FROM_BELOW: Final = """[stock]
length = 84
width = 76
centre = [3, -2]
bore = 18
[holding]
kind = "fixture"
through = 0.3
[[operation]]
kind = "chamfer"
boundary = "outline"
tool = 5
size = 0.4
[second_side]
turned_about = "{about}"
zero = "front-left"
zero_height = "blank-bottom"
[second_side.holding]
kind = "screws"
through = 0.3
[[second_side.holding.screw]]
place = [2, 1]
head_diameter = 24
height = 8
[[second_side.holding.screw]]
place = [36, 33]
head_diameter = 6
height = 3
[[second_side.operation]]
kind = "rough"
boundary = "outline"
tool = 4
allowance = 0.4
direction = "{direction}"
[[second_side.operation]]
kind = "finish"
boundary = "outline"
tool = 4
direction = "{direction}"
{compensation}
"""
"""A bored plate, of which one side is chamfered, and the outline is cut from the other."""

HALVES: Final = """[stock]
length = 84
width = 76
bore = 18
[holding]
kind = "fixture"
through = 0.3
[[operation]]
kind = "rough"
boundary = "outline"
tool = 4
allowance = 0.4
depth = 3.5
[[operation]]
kind = "finish"
boundary = "outline"
tool = 4
depth = 3.5
[second_side]
turned_about = "{about}"
[second_side.holding]
kind = "screws"
through = 0
[[second_side.holding.screw]]
place = [0, 0]
head_diameter = 24
height = 8
[[second_side.holding.screw]]
place = [36, 33]
head_diameter = 6
height = 3
[[second_side.operation]]
kind = "rough"
boundary = "outline"
tool = 4
allowance = 0.4
depth = 3
[[second_side.operation]]
kind = "finish"
boundary = "outline"
tool = 4
depth = 3
"""
"""An outline that each side cuts half of."""

MACHINE: Final = """[output.gcode]
machine = "{machine}"
clearance_height = 15
retract_height = 3
"""


def scene(tables: str, machine: str = "linuxcnc", **words: str) -> str:
    """The text of a scene."""
    given = {"about": "x", "direction": "climb", "compensation": "", **words}
    return CAM + tables.format(**given) + MACHINE.format(machine=machine)


@cache
def design(text: str) -> Design:
    """Of a scene's text."""
    return Design(parse_scene(text))


def second(text: str) -> Product:
    """The second side of its disc."""
    _, side = product_sides(design(text).disc)
    return side
