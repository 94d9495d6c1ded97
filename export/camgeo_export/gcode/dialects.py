"""The words of a block in the dialects of controllers: ISO's G words, and klartext."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Protocol

Coordinates = Sequence[tuple[str, str]]
"""Axes with their printed coordinates."""


class Dialect(Protocol):
    """How blocks of moves are spelled; coordinates are printed already."""

    @property
    def signed(self) -> bool:
        """Whether coordinates have a plus sign."""

    def rapid(self, end: Coordinates) -> str:
        """A traverse to `end`."""

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """A straight cut; `feed` is empty where it goes on, `switch` are the words of the
        controller's compensation that it switches.
        """

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """A circular cut, in one block or two."""


class Iso:
    """G and M words; the centre is written as I and J."""

    signed: Final = False

    def rapid(self, end: Coordinates) -> str:
        """As G0."""
        return _spelled("G0", _words(end))

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """As G1."""
        return _spelled("G1", switch, _words(end), _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """As G3 or G2."""
        own = [("IJ"["XY".index(axis)], value) for axis, value in centre]
        return [_spelled("G3" if ccw else "G2", _words(end), _words(own), _feed(feed))]


class Klartext:
    """Heidenhain's conversational blocks; the centre has a block of its own."""

    signed: Final = True

    def __init__(self) -> None:
        self._centre = ""
        self._side = "R0"

    def rapid(self, end: Coordinates) -> str:
        """As L with FMAX."""
        return _spelled("L", _words(end), "R0 FMAX")

    def line(self, end: Coordinates, feed: str, switch: str = "") -> str:
        """As L, which repeats the side of the compensation."""
        self._side = switch or self._side
        return _spelled("L", _words(end), self._side, _feed(feed))

    def arc(self, end: Coordinates, centre: Coordinates, feed: str, *, ccw: bool) -> list[str]:
        """As C, behind a CC for another centre."""
        found = []
        if (block := _spelled("CC", _words(centre))) != self._centre:
            found.append(block)
            self._centre = block
        found.append(_spelled("C", _words(end), "DR+" if ccw else "DR-", _feed(feed)))
        return found


def dialect(name: str) -> Dialect:
    """That of a machine profile."""
    return Klartext() if name == "klartext" else Iso()


def _words(coordinates: Coordinates) -> str:
    return " ".join(axis + value for axis, value in coordinates)


def _feed(feed: str) -> str:
    return f"F{feed}" if feed else ""


def _spelled(*parts: str) -> str:
    return " ".join(part for part in parts if part)
