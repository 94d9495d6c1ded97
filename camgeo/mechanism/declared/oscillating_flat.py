"""The oscillating flat-faced follower, declared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.declared.faces import face_has_a_length
from camgeo.mechanism.kind import FollowerKind, Values

if TYPE_CHECKING:
    from camgeo.mechanism.oscillating_flat import OscillatingFlat


def build(values: Values) -> OscillatingFlat:
    """The follower of a table."""
    from camgeo.mechanism.oscillating_flat import OscillatingFlat

    return OscillatingFlat(
        pivot=values.point("pivot"),
        **values.lengths("base_radius", "face_offset"),
        **values.signs("arm_side"),
        **values.own_direction(),
        face=values.ends("face"),
    )


KIND: Final = FollowerKind(
    name="oscillating-flat",
    told="a flat face on a rocker.",
    unit="rad",
    touching="face",
    schema=schema_beside(__file__),
    build=build,
    sizes=(
        "pivot",
        "base_radius",
        "face_offset",
    ),
    rules=(face_has_a_length,),
)
