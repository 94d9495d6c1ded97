"""Rules between what a scene states on printing and its part."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.scene.valid_values import Broken, ValidValues


def print_suits_the_part(values: ValidValues) -> Iterator[Broken]:
    """What is to be compensated is there."""
    if values.has("print", "bore_clearance") and values.lacks("part", "bore"):
        yield ("print", "bore_clearance"), "needs [part] bore"
    key = ("print", "key_clearance")
    if values.has(*key) and values.lacks("part", "keyway") and values.lacks("part", "d_shaft"):
        yield key, "needs [part] keyway, or d_shaft"
    place = ("print", "elephant_foot", "height")
    high, thickness = values.get(*place), values.get("part", "thickness")
    if high is not None and thickness is not None and not high < thickness:
        yield place, f"must be less than the thickness, {thickness:g}"
