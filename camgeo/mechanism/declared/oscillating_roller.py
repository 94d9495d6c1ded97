"""The oscillating roller follower, declared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.kind import FollowerKind, Values

if TYPE_CHECKING:
    from camgeo.mechanism.oscillating_roller import OscillatingRoller


def build(values: Values) -> OscillatingRoller:
    """The follower of a table."""
    from camgeo.mechanism.oscillating_roller import OscillatingRoller

    return OscillatingRoller(
        pivot=values.point("pivot"),
        **values.lengths("arm", "base_radius", "roller_radius"),
        **values.signs("arm_side"),
        **values.own_direction(),
    )


def build_return(main: OscillatingRoller, values: Values) -> OscillatingRoller:
    """The return roller on its lever."""
    from camgeo.mechanism.conjugate import return_on_lever  # few scenes have one

    angle = values.angles("arm_angle")
    return return_on_lever(main, **angle, **values.lengths("arm", "roller_radius"))


KIND: Final = FollowerKind(
    name="oscillating-roller",
    told="the roller sits on a rocker.",
    unit="rad",
    touching="roller",
    schema=schema_beside(__file__),
    build=build,
    sizes=(
        "pivot",
        "arm",
        "base_radius",
        "roller_radius",
        "return.arm",
        "return.roller_radius",
    ),
    build_return=build_return,
)
