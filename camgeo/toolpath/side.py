"""What a scene states on the second side of a milling job; imports nothing that computes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Final

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, one_of
from camgeo.toolpath.holding import Holding
from camgeo.toolpath.spec import AXIS, CORNERS, HEIGHTS, PART_TOP, GcodeSpec
from camgeo.toolpath.tool import Text
from camgeo.toolpath.turning import AXES

OWN_KEYS: Final = ("zero", "zero_height", "work_offset", "clearance_height", "retract_height")
"""Keys of `[output.gcode]` that the second side states for itself."""

OWN_TABLES: Final = ("holding", "operation")
"""Tables that it has for itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondSide:
    """How `[second_side]` is set up, in mm: as the work lies when it has been turned over.

    Attributes
    ----------
    turned_about : axis of the machine about which it is turned over.
    holding : then.
    zero, zero_height, work_offset : of its program.
    clearance_height, retract_height : of traverses, above the face of the part that lies up; None
        for those of the first side.

    Raises
    ------
    GeometryError
        With the key in `second_side`, if a value is invalid.
    """

    turned_about: Annotated[str, partial(one_of, choices=AXES)]
    holding: Holding
    zero: Annotated[str, partial(one_of, choices=(AXIS, *CORNERS))] = AXIS
    zero_height: Annotated[str, partial(one_of, choices=HEIGHTS)] = PART_TOP
    work_offset: Text = ""
    clearance_height: Length | None = None
    retract_height: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "second_side.")

    def program(self, first: GcodeSpec) -> GcodeSpec:
        """What its program is asked for, beside what that of the `first` side is; raises
        GeometryError with the key in `second_side`.
        """
        given = {key: getattr(self, key) for key in OWN_KEYS}
        try:
            return replace(
                first, **{key: value for key, value in given.items() if value is not None}
            )
        except GeometryError as error:
            raise of_second_side(error) from error


def of_second_side(error: GeometryError) -> GeometryError:
    """The same with the key of the second side, if it has one of its own."""
    head, _, rest = error.key.partition(".")
    if head.partition("[")[0] in OWN_TABLES:
        return GeometryError(error.message, f"second_side.{error.key}", error.value)
    _, _, name = rest.partition(".")
    if head == "output" and name in OWN_KEYS:
        return GeometryError(error.message, f"second_side.{name}", error.value)
    return error
