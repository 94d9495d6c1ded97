"""What followers, linkages and parts are made of, checked where it comes in.

Lengths in mm and angles in rad. Each function returns the value as it is kept, or raises
`GeometryError` with the key, the value and what is allowed.
"""

from __future__ import annotations

import math
import sys
from functools import partial
from numbers import Real
from typing import Annotated, Any, Final

from camgeo.errors import GeometryError
from camgeo.numeric.checked import SMALLEST, instance, number, one_of, point, shown
from camgeo.units import TURN

RADIANS: Final = "radians"


def length(key: str, value: Any) -> float:
    """A length above 0 [mm]."""
    return number(key, value, above=0.0, unit="mm")


def any_size(key: str, value: Any) -> float:
    """A number above 0, of any size that a double has: of formulas that take ratios alone."""
    real = isinstance(value, Real) and not isinstance(value, bool)
    if not (real and 0.0 < value <= sys.float_info.max):
        raise GeometryError("must be a positive number", key, shown(value))
    return float(value)


def radius(key: str, value: Any) -> float:
    """A length [mm] that may be 0."""
    found = number(key, value, least=0.0, unit="mm")
    if 0.0 < found < SMALLEST:
        raise GeometryError(f"must be 0, or at least {SMALLEST:g}", key, shown(value))
    return found


def coordinate(key: str, value: Any) -> float:
    """A length of either sign [mm]."""
    return number(key, value, unit="mm")


def place(key: str, value: Any) -> complex:
    """A point x + i y [mm]."""
    return point(key, value, "mm")


def angle(key: str, value: Any, low: float = -TURN, high: float = TURN) -> float:
    """An angle from `low` to `high` [rad], a turn either way at most."""
    return number(key, value, least=low, most=high, unit=RADIANS)


def right_angle(key: str, value: Any) -> float:
    """An angle above 0 up to a right one [rad]."""
    return number(key, value, above=0.0, most=0.5 * math.pi, unit=RADIANS)


def sense(key: str, value: Any) -> int:
    """+1 or -1."""
    return one_of(key, value, (1, -1))


def truth(key: str, value: Any) -> bool:
    """True or False, and no number."""
    return instance(key, value, bool, "true or false")


def able(key: str, value: Any, method: str, what: str) -> None:
    """GeometryError unless `value` has the `method` that makes it `what`."""
    if isinstance(value, type) or not hasattr(value, method):
        raise GeometryError(f"must be {what}", key, shown(value))


# As types of fields, see `camgeo.numeric.checked.check_fields`.
Length = Annotated[float, length]
AnySize = Annotated[float, any_size]
Radius = Annotated[float, radius]
Coordinate = Annotated[float, coordinate]
Place = Annotated[complex, place]
Angle = Annotated[float, angle]
AcuteAngle = Annotated[float, partial(angle, low=-0.5 * math.pi, high=0.5 * math.pi)]
RightAngle = Annotated[float, right_angle]
Sense = Annotated[int, sense]
Truth = Annotated[bool, truth]
