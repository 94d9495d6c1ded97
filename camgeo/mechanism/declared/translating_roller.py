"""The translating roller follower, declared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.kind import FollowerKind, Values

if TYPE_CHECKING:
    from camgeo.mechanism.translating_roller import TranslatingRoller


def build(values: Values) -> TranslatingRoller:
    """The follower of a table."""
    from camgeo.mechanism.translating_roller import TranslatingRoller

    return TranslatingRoller(
        **values.lengths("base_radius", "roller_radius", "offset"),
        **values.angles("guide_angle"),
        **values.signs("direction"),
    )


def build_return(main: TranslatingRoller, values: Values) -> TranslatingRoller:
    """The return roller on its carriage."""
    from camgeo.mechanism.conjugate import return_on_carriage  # few scenes have one

    return return_on_carriage(main, **values.lengths("spacing", "offset", "roller_radius"))


KIND: Final = FollowerKind(
    name="translating-roller",
    told="the roller moves along a straight guide.",
    unit="mm",
    touching="roller",
    schema=schema_beside(__file__),
    build=build,
    sizes=(
        "base_radius",
        "roller_radius",
        "offset",
        "return.spacing",
        "return.offset",
        "return.roller_radius",
    ),
    build_return=build_return,
)
