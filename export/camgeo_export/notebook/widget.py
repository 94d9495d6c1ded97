"""The widget of notebooks: a turning mechanism and diagrams, drawn by the script of `browser`."""

from __future__ import annotations

import math
from typing import Any

import anywidget
import traitlets

from camgeo.app.designing.work import Recent, painted
from camgeo.design.design import Design
from camgeo_export.browser.bundles import bundle


class Viewer(anywidget.AnyWidget):
    """A design that turns.

    Attributes
    ----------
    data : what is drawn, figures and the mechanism as data.
    angle : the cam angle [degrees], at least 0 and below 360; set from Python or in the notebook.
    """

    _esm = bundle("viewer.js")

    data = traitlets.Dict().tag(sync=True)
    angle = traitlets.Float(0.0).tag(sync=True)

    def __init__(self, design: Design, **traits: Any) -> None:
        super().__init__(data=painted(design, Recent()), **traits)

    def show(self, design: Design) -> None:
        """Show another design instead, at the same cam angle."""
        self.data = painted(design, Recent())

    @traitlets.validate("angle")
    def _wrap_angle(self, proposal: dict[str, Any]) -> float:
        angle = proposal["value"]
        if not math.isfinite(angle):
            raise traitlets.TraitError(f"the angle is {angle}; allowed: a finite number of degrees")
        turned = angle % 360.0
        return turned if turned < 360.0 else 0.0  # the remainder of -1e-20 is 360
