"""3MF: the part as a body for printing, or a plate with several bodies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Length
from camgeo.numeric.checked import check_fields, instance, instance_from_table, one_of, value_text
from camgeo.record import stored_schema
from camgeo.scene.formats.format import BODY, Format, Values


class PlateBody(StrEnum):
    """Bodies that may lie on a plate."""

    CAM = "cam"
    RETURN_CAM = "return-cam"
    ROLLER = "roller"
    RETURN_ROLLER = "return-roller"
    TEST_RING = "test-ring"


TABLE: Final = ("output", "3mf")


@dataclass(frozen=True, slots=True)
class ThreeMfSpec:
    """`[output.3mf]`: what lies on the plate.

    Attributes
    ----------
    plate : names of bodies, in their order on the plate; empty for a file with the disc alone.
    gap : between the circles about the bodies [mm].
    roller_width : of the rollers [mm]; None for that of a pair in one piece, or the
        thickness of the disc.
    roller_bore : diameter of their bores [mm]; None for none.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    plate: tuple[str, ...] = ()
    gap: Length = 5.0
    roller_width: Length | None = None
    roller_bore: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "output.3mf.")
        for name in instance("output.3mf.plate", self.plate, tuple, "a tuple of names"):
            one_of("output.3mf.plate", name, [body.value for body in PlateBody])
        if len(set(self.plate)) < len(self.plate):
            raise GeometryError(
                "must name each body only once", "output.3mf.plate", value_text(self.plate)
            )


def what_lies_on_the_plate_exists(values: Values) -> Iterator[tuple[str, str]]:
    """The scene has the discs, rollers and bores of the plate, and rollers for their options."""
    plate = values.get(*TABLE, "plate") or ()
    rollers = [name for name in plate if name in (PlateBody.ROLLER, PlateBody.RETURN_ROLLER)]
    key = ("follower", "roller_radius")
    if rollers and values.valid("follower") and values.lacks(*key):
        yield "plate", f'cannot hold "{rollers[0]}": the follower has no roller'
    elif PlateBody.ROLLER in plate and values.get(*key) == 0:
        yield "plate", f'cannot hold "{PlateBody.ROLLER}": the follower is a knife edge'
    for name in (PlateBody.RETURN_CAM, PlateBody.RETURN_ROLLER):
        if name in plate and values.lacks("follower", "return"):
            yield "plate", f'needs [follower.return] for "{name}"'
    if PlateBody.RETURN_CAM in plate and values.get("part", "pair") is not None:
        one_piece = f'it is one piece with "{PlateBody.CAM}", by [part.pair]'
        yield "plate", f'cannot hold "{PlateBody.RETURN_CAM}": {one_piece}'
    if PlateBody.TEST_RING in plate and values.lacks("part", "bore"):
        yield "plate", f'needs [part] bore for "{PlateBody.TEST_RING}"'
    for option in ("roller_width", "roller_bore"):
        if values.get(*TABLE, option) is not None and not rollers:
            yield option, "needs a roller on the plate"
    if values.get(*TABLE, "gap") is not None and not plate:
        yield "gap", "needs plate"
    bore, radius = values.get(*TABLE, "roller_bore"), values.get(*key)
    if bore is not None and radius is not None and not bore < 2.0 * radius:
        yield "roller_bore", f"must be less than the diameter of the roller, {2.0 * radius:g}"


NEEDS, RULES = BODY

FORMAT: Final = Format(
    "3mf",
    ".3mf",
    partial(instance_from_table, ThreeMfSpec),
    stored_schema(__file__),
    ("follower", *NEEDS),
    (*RULES, what_lies_on_the_plate_exists),
)
