"""What a scene states of chamfers; `camgeo.part.bevels` makes them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Final

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, one_of
from camgeo.part.faces import BOTH, SIDES

KEY: Final = "part.chamfers"
"""Of their table in the scene."""


@dataclass(frozen=True, slots=True)
class Chamfer:
    """A chamfer of 45 degrees.

    Attributes
    ----------
    width : on the face, and along the wall [mm].
    edges : of which ends of the wall, one of `SIDES`.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    width: Length
    edges: Annotated[str, partial(one_of, choices=SIDES)] = BOTH

    def __post_init__(self) -> None:
        check_fields(self, f"{KEY}.")


@dataclass(frozen=True, slots=True)
class Chamfers:
    """The chamfers of a part, by what they run along; None for sharp edges.

    Attributes
    ----------
    outline : the flanks; of a groove only their upper edges.
    rim, bore : both ends.
    hub : the outer edge of each.
    bolt_circle, lightening_holes : the edges of the holes on the faces.
    """

    outline: Chamfer | None = None
    rim: Chamfer | None = None
    bore: Chamfer | None = None
    hub: Chamfer | None = None
    bolt_circle: Chamfer | None = None
    lightening_holes: Chamfer | None = None

    def on_one_side(self, side: str, *, hub: bool) -> Chamfers:
        """Those of a disc of a pair in one piece without its hub: where the other disc follows, and
        where there is a hub on its outer `side`, its bore has no edge.
        """
        bore = self.bore
        if bore is not None:
            bore = None if hub or bore.edges not in (side, BOTH) else replace(bore, edges=side)
        return replace(self, hub=None, bore=bore)
