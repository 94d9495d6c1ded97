"""Rules between what a scene states on printing and its part."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.part.faces import BOTH, LOWER
from camgeo.scene.valid_values import Broken, ValidValues


def print_suits_the_part(values: ValidValues) -> Iterator[Broken]:
    """What is to be compensated is there."""
    if values.has("print", "bore_clearance") and values.lacks("part", "bore"):
        yield ("print", "bore_clearance"), "needs [part] bore"
    key = ("print", "key_clearance")
    if values.has(*key) and values.lacks("part", "keyway") and values.lacks("part", "d_shaft"):
        yield key, "needs [part] keyway, or d_shaft"
    place = ("print", "elephant_foot", "height")
    lowest, what = values.get("part", "thickness"), "thickness"
    if values.get("part", "hub", "side") in (LOWER, BOTH):
        lowest, what = values.get("part", "hub", "height"), "height of the lower hub"
    high = values.get(*place)
    if high is not None and lowest is not None and not high < lowest:
        yield place, f"must be less than the {what}, {lowest:g}"
