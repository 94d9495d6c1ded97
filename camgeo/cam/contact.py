"""On which flank of the disc the follower runs."""

from __future__ import annotations

from typing import Literal

Contact = Literal["inner", "outer", "groove"]


def flank_distances(contact: Contact, half: float) -> dict[str, float]:
    """Signed distance [mm] of each flank in use from the pitch curve, by its name.

    `half` is the distance of either flank [mm], positive outward: the inner one lies at -half.
    """
    every = {"inner": -half, "outer": half}
    return {name: way for name, way in every.items() if contact in (name, "groove")}
