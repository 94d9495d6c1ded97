"""The specification of a conjugate pair in one piece: two discs on one hub, with a spacer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from camgeo.mechanism.values import Length
from camgeo.numeric.checked import check_fields, one_of

MAIN: Final = "main"
RETURN: Final = "return"

DISCS: Final = (MAIN, RETURN)
"""Discs of a pair."""


@dataclass(frozen=True, slots=True)
class Pair:
    """How the discs of a conjugate pair stand on one hub.

    Attributes
    ----------
    gap : between the faces that look at each other [mm].
    spacer : diameter of the round body between them [mm].
    upper : which disc is above, one of `DISCS`.
    roller_width : of the wider roller, each in the middle of its disc [mm]; None if not known.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    gap: Length
    spacer: Length
    upper: Annotated[str, partial(one_of, choices=DISCS)] = MAIN
    roller_width: Length | None = None

    def __post_init__(self) -> None:
        check_fields(self, "part.pair.")
