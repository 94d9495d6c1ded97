"""Boundary values of a motion, as far as they are known, and the motion tasks that they make."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, Literal

from camgeo.errors import GeometryError
from camgeo.numeric import checked

Boundary = tuple[float | None, float | None]
"""Velocity s' and acceleration s'' at a point; None where it is free."""

FREE: Final[Boundary] = (None, None)


def over_span(values: Boundary, length: float) -> Boundary:
    """Values per rad as derivatives over the normalised span, which is `length` [rad] long."""
    velocity, acceleration = values
    return (
        None if velocity is None else velocity * length,
        None if acceleration is None else acceleration * length**2,
    )


def boundaries_of(key: str, given: Any, least: int, most: int) -> dict[int, Boundary]:
    """`given` by index of the point; GeometryError unless all are from `least` to `most`."""
    return {
        checked.whole(key, index, least, most): boundary_of(key, values)
        for index, values in checked.instance(key, given, Mapping, "boundaries by index").items()
    }


def boundary_of(key: str, values: Any) -> Boundary:
    """`values` as a boundary; GeometryError unless it is two numbers, or None where free."""
    if not isinstance(values, tuple | list) or len(values) != 2:
        raise GeometryError(
            "must be a velocity and an acceleration, None where free", key, checked.shown(values)
        )
    return checked.optional(key, values[0]), checked.optional(key, values[1])


End = Literal["R", "G", "U", "B"]

ENDS: Final[tuple[End, ...]] = ("R", "G", "U", "B")

TASKS: Final[tuple[str, ...]] = tuple(f"{start}-{end}" for start in ENDS for end in ENDS)
"""All sixteen pairs, "R-R" to "B-B" (VDI 2143-1, Tafel 1)."""

NAMES: Final[dict[End, str]] = {
    "R": "rest",
    "G": "constant velocity",
    "U": "turn",
    "B": "general motion",
}


def end_of(velocity: float, acceleration: float) -> End:
    """The class of an end with that velocity and acceleration, in any unit."""
    if velocity == 0.0:
        return "R" if acceleration == 0.0 else "U"
    return "G" if acceleration == 0.0 else "B"


def ends_of(task: str) -> tuple[str, str]:
    """The classes at the start and at the end of `task`, one of `TASKS`."""
    return task[0], task[-1]
