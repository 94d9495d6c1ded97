"""A figure drawn by matplotlib, for tests of the layout."""

from __future__ import annotations

from matplotlib import rc_context
from matplotlib.figure import Figure as Page

from camgeo.pictures.model import Figure
from camgeo_export.plots import RC
from camgeo_export.plots import draw_page as page


def drawn(figure: Figure) -> Page:
    """The whole figure, with every part in its place but no pixel painted."""
    with rc_context(RC):
        made = page(figure)
        made.draw_without_rendering()
    return made
