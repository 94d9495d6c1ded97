"""A cam as value tables tell it."""

from __future__ import annotations

from typing import Protocol

from camgeo.files.table import Table


class Tabulated(Protocol):
    """What tables tell of a cam; `camgeo.views.tabulated.TabulatedCam` is one."""

    def table(self) -> Table:
        """The value table, in the scene's unit and degrees."""
