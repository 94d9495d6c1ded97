"""Work that is turned over for its second side: how coordinates of part and machine correspond.

Cuts and moves are those of a part whose tools come from above, on both sides. For the second side
its heights are reflected (`Part.turned_over`), its X and Y are kept, so that all curves stay what
they are, exactly. On the machine the work has been turned by half a turn about X or Y: what lies
there is the mirror image of that part: arcs change their sense, left and right change places.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from camgeo.numeric.arrays import ComplexArray

X: Final = "x"
Y: Final = "y"

AXES: Final = (X, Y)
"""Axes of the machine about which work is turned over."""

NOT: Final = ""
"""In place of an axis: of the first side."""

OTHER: Final[Mapping[str, str]] = MappingProxyType(
    {"left": "right", "right": "left", "off": "off", "": ""}
)
"""What sides of a path are called in a mirror."""


HOW: Final[Mapping[str, str]] = MappingProxyType(
    {
        X: "turned over about X: what was in front is at the back",
        Y: "turned over about Y: what was on the left is on the right",
    }
)
"""What is done with the work, for the operator."""


def mirrored(place: complex, about: str) -> complex:
    """A place or a direction of the part as it lies on the machine, work turned over `about` an
    axis; and the other way round, for it is its own inverse.
    """
    # Adding 0 keeps a negative zero out of print.
    if about == X:
        return complex(place.real, 0.0 - place.imag)
    if about == Y:
        return complex(0.0 - place.real, place.imag)
    return place


def mirrored_all(places: ComplexArray, about: str) -> ComplexArray:
    """Places of the part as they lie on the machine, like `mirrored`."""
    if about == X:
        return places.conjugate()
    return -places.conjugate() if about == Y else places
