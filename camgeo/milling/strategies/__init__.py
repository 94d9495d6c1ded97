"""Milling strategies: each makes the moves of a cut. A new one is a function and a line below.

Each begins with a traverse at the clearance height above its first point, and ends at that height.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from camgeo.geometry.contour.contour import Effort
from camgeo.milling.cut import Cut
from camgeo.milling.milling import Heights
from camgeo.milling.moves import Move
from camgeo.milling.strategies.around import profile, slot
from camgeo.milling.strategies.clear import clear, moat
from camgeo.milling.strategies.marks import drill, engrave, letters
from camgeo.milling.strategies.trochoid import trochoid

Strategy = Callable[[Cut, Heights, float, Effort], list[Move]]
"""Gives the moves of a cut from it, the heights of traverses, the tolerance of its path [mm] and
the effort of fitting."""

STRATEGIES: Final[Mapping[str, Strategy]] = MappingProxyType(
    {
        "profile": profile,
        "slot": slot,
        "face": clear,
        "bore": clear,
        "rough": clear,
        "drill": drill,
        "trochoid": trochoid,
        "moat": moat,
        "engrave": engrave,
        "letters": letters,
    }
)
