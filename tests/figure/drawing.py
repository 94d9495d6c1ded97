"""A figure drawn by matplotlib, for tests of what lies where."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.figure import Figure as Page

from camgeo.figure.model import Figure
from camgeo_export.plots.render import RC, page


def drawn(figure: Figure) -> Page:
    """All of it, with every part in its place; no pixel is painted."""
    with rc_context(RC):
        made = page(figure)
        made.draw_without_rendering()
    return made
