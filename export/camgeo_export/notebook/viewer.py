"""The mechanism in a notebook: a widget, if the library for widgets is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgeo.design.design import Design
from camgeo.errors import CamgeoError

if TYPE_CHECKING:
    from camgeo_export.notebook.widget import Viewer


def viewer(design: Design) -> Viewer:
    """The widget of a design, see `camgeo.design.design.Design.view`.

    Raises
    ------
    CamgeoError
        If anywidget is not installed.
    """
    try:
        from camgeo_export.notebook.widget import Viewer
    except ModuleNotFoundError as error:
        if error.name not in ("anywidget", "traitlets"):
            raise
        raise CamgeoError(
            "the view in a notebook needs anywidget, which is not installed; install it with"
            ' `pip install "camgeo[notebook]"`'
        ) from None
    return Viewer(design)
