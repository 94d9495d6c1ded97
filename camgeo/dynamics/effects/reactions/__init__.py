"""Effect `reactions`: forces in the bearings of follower and camshaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.dynamics.effects.effect import ELASTIC, GIVEN_SPEED, ONE_DISC, STIFF_SHAFT, Effect, Only
from camgeo.dynamics.effects.results import CONTACT_FORCE, GRAVITY, INERTIA, SPRING
from camgeo.errors import GeometryError
from camgeo.record import schema_beside


@dataclass(frozen=True, slots=True)
class Bearings:
    """The table ``[effects.reactions]``.

    Attributes
    ----------
    bearings : places of both bearings of the camshaft along its axis, from the middle plane of the
        disc [mm]; None if they are not stated.
    """

    bearings: tuple[float, float] | None = None


def parse(table: Mapping[str, Any]) -> Bearings:
    """The data of the table; GeometryError with key "bearings" if both are at one place."""
    if "bearings" not in table:
        return Bearings()
    first, second = table["bearings"]
    if first == second:
        raise GeometryError(
            "must be at two places", key="bearings", value=f"[{first:g}, {second:g}]"
        )
    return Bearings((first, second))


EFFECT: Final = Effect(
    name="reactions",
    title="forces in guide, pivot, pins and camshaft bearings",
    compute="camgeo.dynamics.effects.reactions.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    rules=(Only(ONE_DISC, "bearings"),),
    needs=(CONTACT_FORCE,),
    uses=(INERTIA, GRAVITY, SPRING),
    numerical=True,
    refined_by=(ELASTIC, GIVEN_SPEED, STIFF_SHAFT),
)
