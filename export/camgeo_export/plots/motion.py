"""Motion diagram: the lift and its derivatives over the cam angle."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo.units import MM_PER
from camgeo_export.plots.style import LINE, diagram_angles, frame, over_cam_angle

MARKS = {"s": "", "s1": "′", "s2": "″", "s3": "‴"}

size = (7.0, 7.5)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw s, s', s'', s''' one above the other, the joints of the motion plan marked."""
    phi = diagram_angles(product.joints)
    scale, unit, symbol = (
        (1.0 / MM_PER[product.unit], product.unit, "s")
        if product.lift_unit == "mm"
        else (np.degrees(1.0), "°", "ψ")
    )
    panels = figure.subplots(
        len(MARKS), 1, sharex=True, gridspec_kw={**frame(figure), "hspace": 0.08}
    )
    for index, (what, mark) in enumerate(MARKS.items()):
        axes = panels[index]
        axes.plot(np.degrees(phi), product.quantity(what, phi) * scale, color=LINE)
        power = ("", "/rad", "/rad²", "/rad³")[index]
        axes.set_ylabel(f"{symbol}{mark} [{unit}{power}]")
        over_cam_angle(axes, product.joints, label=what == "s3")
        # aligned across the panels, whatever the width of their numbers
        axes.yaxis.set_label_coords(-0.075, 0.5)
    panels[0].set_title(f"{product.name}: motion")
