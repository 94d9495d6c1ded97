"""Panels one below the other, each as high as its own content needs."""

from __future__ import annotations

from camgeo.figure.layout import Size, box
from camgeo.figure.marks import Mark
from camgeo.figure.model import Axis, Frame, Panel

TURN_DEGREES = (0.0, 360.0)


class Strips:
    """Frames from the top of a figure downwards, between two margins [inch]."""

    def __init__(self, size: Size, left: float, right: float) -> None:
        self.width, self.height = size
        self.left = left
        self.across = self.width - left - right
        self.left_over = self.height

    def skip(self, height: float) -> None:
        """Leave `height` [inch] free."""
        self.left_over -= height

    def frame(self, height: float) -> Frame:
        """The next frame, `height` [inch] high."""
        self.left_over -= height
        return box(
            self.left / self.width,
            self.left_over / self.height,
            self.across / self.width,
            height / self.height,
        )

    def words(self, height: float, marks: list[Mark]) -> Panel:
        """A strip without axes, over one turn in degrees, its height 1."""
        x, y = Axis(TURN_DEGREES), Axis((0.0, 1.0))
        return Panel(self.frame(height), x, y, tuple(marks), bare=True)
