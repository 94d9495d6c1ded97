"""Transmission angle over the cam angle, with its limit."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure, SubFigure

from camgeo.files.product import Product
from camgeo_export.plots.style import LIMIT, LINE, diagram_angles, frame, over_cam_angle

FINDING = "transmission-angle"
"""Name of the finding that carries the limit, in degrees."""

size = (7.0, 3.6)


def draw(product: Product, figure: Figure | SubFigure) -> None:
    """Draw the transmission angle with the limit that the design is held to."""
    phi = diagram_angles(product.joints)
    axes = figure.subplots(gridspec_kw=frame(figure))
    angle = np.degrees(product.quantity("transmission_angle", phi))
    axes.plot(np.degrees(phi), angle, color=LINE, label="transmission angle")
    limit = next((item.limit for item in product.findings if item.name == FINDING), None)
    if limit is not None:
        axes.axhline(limit, color=LIMIT, linestyle="--", linewidth=1.0, label=f"limit {limit:g}°")
    over_cam_angle(axes, product.joints)
    low = min(float(angle.min()), limit if limit is not None else 90.0)
    axes.set_ylim(max(0.0, 10.0 * np.floor(low / 10.0) - 5.0), 95.0)
    axes.set_ylabel("transmission angle μ [°]")
    axes.set_title(f"{product.name}: transmission angle")
    axes.legend(loc="best")
