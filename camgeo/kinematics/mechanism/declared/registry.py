"""The kinds of followers and linkages, by the names that they have in scenes.

The class that a kind builds is imported when it is built; its schema is NAME.json in this folder.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from camgeo.kinematics.mechanism.values import FollowerKind, LinkageKind, Values
from camgeo.record import stored_schema

if TYPE_CHECKING:
    from camgeo.kinematics.mechanism.linkage import Linkage
    from camgeo.units import LiftUnit


def _face_has_a_length(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The rule that a face must end beyond where it begins."""
    face = table.get("face")
    if face is not None and not face[0] < face[1]:
        yield "face", "must end beyond where it begins, [from, to]"


def _slider_crank(values: Values, unit: LiftUnit) -> Linkage:
    """A slider-crank: its slider drives a rocker, or is the carriage of a guided follower."""
    from camgeo.kinematics.mechanism.linkages import SliderCrank

    slider_crank = values.build(
        SliderCrank,
        leans_away=values.table["crank_leans"] == "away",
        slider_side=values.sign("slider_side", "left"),
    )
    if unit == "rad":
        return slider_crank
    from camgeo.kinematics.mechanism.linkages import (
        SliderDrivenCrank,  # few scenes have one
    )

    return SliderDrivenCrank(slider_crank)


def _four_bar(values: Values, _: LiftUnit) -> Linkage:
    """A four-bar linkage, which drives rockers only."""
    from camgeo.kinematics.mechanism.linkages import FourBar

    return values.build(FourBar, lever_sense=values.sign("lever_sense", "ccw"))


FOLLOWERS: Final = {
    kind.name: kind
    for kind in (
        FollowerKind(
            name="translating-roller",
            description="the roller moves along a straight guide.",
            unit="mm",
            touching="roller",
            schema=stored_schema(__file__, "translating_roller"),
            class_path="rollers:TranslatingRoller",
            sizes=(
                "base_radius",
                "roller_radius",
                "offset",
                "return.spacing",
                "return.offset",
                "return.roller_radius",
            ),
            return_maker="rollers:return_on_carriage",
        ),
        FollowerKind(
            name="oscillating-roller",
            description="the roller sits on a rocker.",
            unit="rad",
            touching="roller",
            schema=stored_schema(__file__, "oscillating_roller"),
            class_path="rollers:OscillatingRoller",
            sizes=(
                "pivot",
                "arm",
                "base_radius",
                "roller_radius",
                "return.arm",
                "return.roller_radius",
            ),
            return_maker="rollers:return_on_lever",
        ),
        FollowerKind(
            name="translating-flat",
            description="a flat face square to a straight guide.",
            unit="mm",
            touching="face",
            schema=stored_schema(__file__, "translating_flat"),
            class_path="flat:TranslatingFlat",
            sizes=("base_radius",),
            rules=(_face_has_a_length,),
        ),
        FollowerKind(
            name="oscillating-flat",
            description="a flat face on a rocker.",
            unit="rad",
            touching="face",
            schema=stored_schema(__file__, "oscillating_flat"),
            class_path="flat:OscillatingFlat",
            sizes=("pivot", "base_radius", "face_offset"),
            rules=(_face_has_a_length,),
        ),
    )
}

LINKAGES: Final = {
    kind.name: kind
    for kind in (
        LinkageKind(
            name="slider-crank",
            description=(
                "with an oscillating follower the motion is the stroke of a slider; coupler and"
                " crank turn the rocker shaft. With a translating follower it is the angle of the"
                " crank [degrees], from its position at stroke 0, counter-clockwise; the slider"
                " carries the roller."
            ),
            members={"rad": "slider", "mm": "crank"},
            schema=stored_schema(__file__, "slider_crank"),
            build=_slider_crank,
            templates=("slider-crank", "slider-driven-crank"),
        ),
        LinkageKind(
            name="four-bar",
            description=(
                "the motion is the angle of a lever [degrees]; coupler and crank turn the rocker"
                " shaft."
            ),
            members={"rad": "lever"},
            schema=stored_schema(__file__, "four_bar"),
            build=_four_bar,
            templates=("four-bar",),
        ),
    )
}
