"""The kinds of followers and linkages, by the names that they have in scenes."""

from __future__ import annotations

from typing import Final

from camgeo.mechanism.declared import (
    four_bar,
    oscillating_flat,
    oscillating_roller,
    slider_crank,
    translating_flat,
    translating_roller,
)
from camgeo.mechanism.kind import FollowerKind, LinkageKind

FOLLOWERS: Final[dict[str, FollowerKind]] = {
    module.KIND.name: module.KIND
    for module in (translating_roller, oscillating_roller, translating_flat, oscillating_flat)
}

LINKAGES: Final[dict[str, LinkageKind]] = {
    module.KIND.name: module.KIND for module in (slider_crank, four_bar)
}
