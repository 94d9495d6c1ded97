"""The slider-crank, declared: its slider drives a rocker, or a guided follower is its slider."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.kind import LinkageKind, Unit, Values

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage


def build(values: Values, unit: Unit) -> Linkage:
    """The linkage of a table, for a follower whose lift has that unit."""
    from camgeo.mechanism.slider_crank import SliderCrank

    inner = SliderCrank(
        **values.lengths("crank", "coupler"),
        deflection=values.angles("crank_deflection")["crank_deflection"],
        leans_away=values["crank_leans"] == "away",
        slider_side=values.signs("slider_side").get("slider_side", 1),
        **values.signs("stroke_direction"),
        branch=-values.signs("branch")["branch"],
        mirrored=bool(values.get("mirrored")),
    )
    if unit == "rad":
        return inner
    from camgeo.mechanism.crank_slider import CrankSlider  # few scenes have one

    return CrankSlider(inner)


KIND: Final = LinkageKind(
    name="slider-crank",
    told=(
        "with an oscillating follower the motion is the stroke of a slider; coupler and crank turn"
        " the rocker shaft. With a translating follower it is the angle of the crank [degrees],"
        " from its place at stroke 0, counter-clockwise; the slider carries the roller."
    ),
    members={"rad": "slider", "mm": "crank"},
    schema=schema_beside(__file__),
    build=build,
    templates=("slider-crank", "crank-slider"),
)
