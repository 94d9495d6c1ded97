"""The strategies by their names; a new one is a module here and a line below."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from camgeo.contour.fit import Effort
from camgeo.toolpath.cut import Cut
from camgeo.toolpath.moves import Move
from camgeo.toolpath.strategies import profile, slot

Strategy = Callable[[Cut, float, float, Effort], list[Move]]
"""The moves of a cut: by it, the safe height [mm], the tolerance of its path [mm] and the effort of
fitting. They begin and end with a traverse at the safe height."""

STRATEGIES: Final[Mapping[str, Strategy]] = MappingProxyType(
    {profile.NAME: profile.moves, slot.NAME: slot.moves}
)
