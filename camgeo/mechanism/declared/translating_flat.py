"""The translating flat-faced follower, declared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.declared.faces import face_has_a_length
from camgeo.mechanism.kind import FollowerKind, Values

if TYPE_CHECKING:
    from camgeo.mechanism.translating_flat import TranslatingFlat


def build(values: Values) -> TranslatingFlat:
    """The follower of a table."""
    from camgeo.mechanism.translating_flat import TranslatingFlat

    return TranslatingFlat(
        **values.lengths("base_radius"),
        **values.angles("guide_angle"),
        **values.signs("direction"),
        face=values.ends("face"),
    )


KIND: Final = FollowerKind(
    name="translating-flat",
    told="a flat face square across a straight guide.",
    unit="mm",
    touching="face",
    schema=schema_beside(__file__),
    build=build,
    sizes=("base_radius",),
    rules=(face_has_a_length,),
)
