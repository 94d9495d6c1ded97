"""The feed of the cutter's centre for a feed at its contact with the wall."""

from __future__ import annotations


def centre_feed(feed: float, radius: float, tool_radius: float, *, inside: bool) -> float:
    """Feed of the centre [mm/min] for at most `feed` at the contact.

    Along a wall around the arc's centre at `radius` + `tool_radius` (`inside`), the contact runs
    faster than the centre in this ratio, so the centre is slowed. Along a wall that it runs around
    the outside of, the contact is the slower of the two, and the feed stays.

    Parameters
    ----------
    radius : of the centre's arc [mm], above 0.
    """
    return feed * radius / (radius + tool_radius) if inside else feed
