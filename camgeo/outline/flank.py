"""The two flanks that a roller can run on."""

from __future__ import annotations

from enum import StrEnum


class Flank(StrEnum):
    """A flank by its name: the inner one bounds a disc, the outer one a hole."""

    INNER = "inner"
    OUTER = "outer"

    @property
    def sign(self) -> int:
        """Of its distance from the pitch curve; also the way in which a roller is pressed on it."""
        return -1 if self is Flank.INNER else 1
