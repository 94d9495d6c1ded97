"""How a blank is held while it is milled; imports nothing that computes."""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Final

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Angle, Length, Place, Radius
from camgeo.milling.tool import Text, Truth
from camgeo.numeric.checked import check_fields, finite, hold, instance, instances, one_of, whole

if TYPE_CHECKING:
    from camgeo.geometry.contour.contour import Contour
    from camgeo.numeric.arrays import ComplexArray
    from camgeo.part.part import Boundary


TABS: Final = "tabs"
SCREWS: Final = "screws"
ONION_SKIN: Final = "onion-skin"
CLAMPS: Final = "clamps"
FIXTURE: Final = "fixture"

HOLDINGS: Final = (TABS, SCREWS, ONION_SKIN, CLAMPS, FIXTURE)

MOST_TABS: Final = 100

TabCount = Annotated[int, partial(whole, least=1, most=MOST_TABS)]


@dataclass(frozen=True, slots=True)
class Tabs:
    """Bridges that a through-cut leaves between part and waste.

    Attributes
    ----------
    count : evenly spaced along the wall.
    width : of each along the wall [mm].
    height : above the lower face of the part [mm]; in a cut, above its last depth.

    Raises
    ------
    GeometryError
        With the key in `holding`, if a value is invalid.
    """

    count: TabCount
    width: Length
    height: Length

    def __post_init__(self) -> None:
        check_fields(self, "holding.")


@dataclass(frozen=True, slots=True)
class Obstacle:
    """What no cutter may touch: an upright body below `top` [mm], above the upper face of the part.

    Attributes
    ----------
    name : for messages.
    outline : around it.
    top : its height; 0 is the upper face of the part.
    """

    name: str
    outline: Boundary
    top: float

    def __post_init__(self) -> None:
        from camgeo.part.part import require_boundary

        instance("holding", self.name, str, "a text")
        require_boundary(self.outline)
        hold(self, top=finite("holding.height", self.top, "mm"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Clamp:
    """A clamp on the blank, a rectangle, or a screw, a circle.

    Attributes
    ----------
    place : of its centre, seen from the cam axis [mm].
    length, width : along its own x and y [mm]; of a circle both are its diameter.
    height : of its top above the upper face of the part [mm].
    angle : of its x from that of the cam [rad].
    round : whether it is a circle.
    since : name of the operation before which it is set; empty if it is there from the start.
    until : name of the operation before which it is taken away; empty if it stays.
    called : its place in messages, where that is not its own; None for its own.

    Raises
    ------
    GeometryError
        With the key in `clamp`, if a value is invalid.
    """

    place: Place
    length: Length
    width: Length
    height: Length
    angle: Angle = 0.0
    round: Truth = False
    since: Text = ""
    until: Text = ""
    called: Place | None = None

    def __post_init__(self) -> None:
        check_fields(self, "clamp.")

    def turned_over(self, about: str) -> Clamp:
        """One that is stated as work turned over lies, in the part's coordinates."""
        place = mirrored(self.place, about)
        return replace(self, place=place, angle=-self.angle, called=self.place)

    @property
    def what(self) -> str:
        """In a word."""
        return "screw" if self.round else "clamp"

    @property
    def obstacle(self) -> Obstacle:
        """What cutters must clear."""
        from camgeo.geometry.contour.contour import Contour
        from camgeo.part.boundaries import ExactBoundary

        name = f"{self.what} at {_places(self.place if self.called is None else self.called)} mm"
        if self.round:
            contour = Contour.circle(self.length / 2.0, self.place)
        else:
            half = 0.5 * complex(self.length, self.width)
            contour = rectangle(half, self.place, cmath.exp(1j * self.angle))
        return Obstacle(name, ExactBoundary(self.what, hole=False, exact=contour), self.height)


@dataclass(frozen=True, slots=True, kw_only=True)
class Holding:
    """How the blank is held, and what becomes of the part when it is cut out of it.

    Attributes
    ----------
    kind : "tabs"; "screws" through the part, onto what lies below; "onion-skin", a skin below the
        part that is removed later; "clamps" on the part; "fixture", from below: vacuum, tape, soft
        jaws, a longer blank in a chuck.
    through : how far through-cuts go below the lower face of the part [mm].
    tabs : of kind "tabs".
    skin : thickness of an onion skin [mm].
    clamps : and screws, of any kind.

    Raises
    ------
    GeometryError
        With the key in `holding`, if a value is invalid, missing, or belongs to another kind.
    """

    kind: Annotated[str, partial(one_of, choices=HOLDINGS)]
    through: Radius = 0.0
    tabs: Tabs | None = None
    skin: Length | None = None
    clamps: tuple[Clamp, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self, "holding.")
        given = instance("holding.clamps", self.clamps, tuple, "a tuple of clamps")
        hold(self, clamps=instances("holding.clamps", given, (Clamp,), "clamps"))
        own = {"tabs": TABS, "skin": ONION_SKIN}
        for key, kind in own.items():
            if (getattr(self, key) is not None) != (self.kind == kind):
                message = "is missing" if self.kind == kind else f'belongs to kind "{kind}"'
                raise GeometryError(message, f"holding.{key}")
        if self.kind in (CLAMPS, SCREWS) and not self.clamps:
            what = self.kind.removesuffix("s")
            raise GeometryError(
                f"needs [[holding.{what}]] at least once", "holding.kind", self.kind
            )

    def turned_over(self, about: str) -> Holding:
        """The same with clamps in the part's coordinates, which are stated as the work lies."""
        return replace(self, clamps=tuple(each.turned_over(about) for each in self.clamps))


def rectangle(half: complex, centre: complex, along: complex = 1.0 + 0j) -> Contour:
    """Around a `centre` [mm], counter-clockwise, half as long and as wide as `half` [mm] says; its
    length lies `along` a direction, of size 1.
    """
    import numpy as np

    from camgeo.geometry.contour.contour import Contour

    corners = np.array([-half, half.conjugate(), half, -half.conjugate()])
    return Contour.polygon(centre + corners * along)


def _places(place: complex) -> str:
    return f"{place.real:g}, {place.imag:g}"


# -- turning --------------------------------------------------------------------------------------
# Work that is turned over for its second side: how coordinates of part and machine correspond.
#
# Cuts and moves are those of a part whose tools come from above, on both sides. For the second side
# its heights are reflected (`Part.turned_over`), its X and Y are kept, so that all curves stay what
# they are, exactly. On the machine the work has been turned by half a turn about X or Y: what lies
# there is the mirror image of that part: arcs change their sense, left and right change places.


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
