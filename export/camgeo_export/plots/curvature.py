"""Curvature of the pitch curve, and where a flank comes to a cusp."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo.units import MM_PER
from camgeo_export.plots.style import LIMIT, LINE, diagram_angles, frame, over_cam_angle

size = (7.0, 3.6)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the curvature over the cam angle with the limits of +-1/d, d the flanks' distance."""
    phi = diagram_angles(product.joints)
    scale = MM_PER[product.unit]
    axes = figure.subplots(gridspec_kw=frame(figure))
    curvature = product.quantity("curvature", phi) * scale
    what = "outline" if product.is_flat else "pitch curve"
    axes.plot(np.degrees(phi), curvature, color=LINE, label=what)
    distance = product.flank_distance
    name = "r$_R$" if distance == product.roller_radius else "(r$_R$ + c/2)"
    for sign in (1.0, -1.0) if distance > 0.0 else ():  # knife edge and flat face have none
        label = f"cusp of a flank, ±1/{name}" if sign > 0.0 else None
        axes.axhline(
            sign * scale / distance, color=LIMIT, linestyle="--", linewidth=1.0, label=label
        )
    axes.axhline(0.0, color="black", linewidth=0.5)
    over_cam_angle(axes, product.joints)
    axes.set_ylabel(f"curvature κ [1/{product.unit}]")
    axes.set_title(f"{product.name}: curvature of the {what}")
    axes.legend(loc="best")
