"""Scenes for the tests of the loader: valid ones, and ways to make them invalid."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from camgeo.errors import SceneError
from camgeo.scene.keys import KeyPath, spelled
from camgeo.scene.scene import Scene, parse_scene

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures" / "scenes"

MILLED = """\
[[tool]]
number = 1
diameter = 10
flute_length = 22
spindle_speed = 3000
feed = 300
plunge_feed = 100
stepdown = 3
[holding]
kind = "fixture"
through = 0.5
"""
"""Tables of a scene that is milled."""

PLATE = (
    """\
camgeo = 1
name = "plate"
[units]
length = "mm"
[cam]
rotation = "ccw"
speed = 60
[follower]
kind = "translating-roller"
base_radius = 50
roller_radius = 10
offset = 12
[[motion]]
dwell = 30
[[motion]]
law = "modified-sine"
span = 100
to = 20
[[motion]]
dwell = 40
[[motion]]
law = "polynomial-345"
span = 120
to = 0
inflection = 0.4
[[motion]]
dwell = 70
[limits]
transmission_angle = 60
radius_ratio = 0.7
[part]
thickness = 12
bore = 20
keyway = { width = 6, depth = 2.8 }
[output]
formats = ["dxf", "gcode", "stl", "3mf", "csv", "svg", "png"]
tolerance = 0.001
[output.dxf]
entity = "arcs"
[output.gcode]
machine = "linuxcnc"
[output.csv]
step = 0.5
"""
    + MILLED
)

ROCKER = """\
camgeo = 1
name = "rocker"
[cam]
rotation = "cw"
[follower]
kind = "oscillating-roller"
pivot = [-96, -72]
arm = 80
base_radius = 55
roller_radius = 10
[[motion]]
law = "polynomial-345"
span = 160
to = 25
[[motion]]
law = "cycloidal"
span = 200
to = 0
"""

LINKED = """\
camgeo = 1
name = "linked"
[cam]
rotation = "cw"
[follower]
kind = "oscillating-roller"
pivot = [-34.81, -84.39]
arm = 84.9
base_radius = 47.654
roller_radius = 9.5
direction = "outward"
[linkage]
kind = "slider-crank"
crank = 42
coupler = 75.38
crank_deflection = 6.3
crank_leans = "away"
stroke_direction = "left"
branch = "cw"
[[motion]]
law = "polynomial-345"
span = 160
to = 5.5
[[motion]]
law = "inclined-sine"
span = 200
to = 0
"""

GROOVE = (
    """\
camgeo = 1
name = "groove"
[cam]
rotation = "cw"
[follower]
kind = "translating-roller"
base_radius = 60
roller_radius = 8
contact = "groove"
[[motion]]
dwell = 360
[part]
thickness = 20
rim = 200
groove_depth = 10
bore = 25
[output]
formats = ["dxf", "stl", "gcode"]
"""
    + MILLED
)


def spoilt(scene: str, *changes: tuple[str, str]) -> str:
    """The scene with each first text, which stands in it once, replaced by the second."""
    for old, new in changes:
        assert scene.count(old) == 1, old
        scene = scene.replace(old, new)
    return scene


def loaded(scene: str, *changes: tuple[str, str]) -> Scene:
    """The scene, changed and loaded."""
    return parse_scene(spoilt(scene, *changes))


def refusal_by(make: Callable[..., object], *arguments: Any) -> SceneError:
    """The error that a function raises of these arguments."""
    with pytest.raises(SceneError) as caught:
        make(*arguments)
    return caught.value


def refusal_of(text: str, file: str = "", folder: pathlib.Path | None = None) -> SceneError:
    """What a text that is no valid scene is refused with."""
    return refusal_by(parse_scene, text, file, folder)


def values_in(tree: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """Every value of a tree with its path, tables and lists as well as single ones."""
    for step, value in tree.items() if isinstance(tree, Mapping) else enumerate(tree):
        yield (*path, step), value
        if isinstance(value, Mapping | list | tuple):
            yield from values_in(value, (*path, step))


def leaves(tree: Any) -> dict[str, Any]:
    """Single values by their keys as messages spell them."""
    return {
        spelled(path): value
        for path, value in values_in(tree)
        if not isinstance(value, Mapping | list | tuple)
    }
