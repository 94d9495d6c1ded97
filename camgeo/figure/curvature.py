"""Curvature of the pitch curve, and where a flank comes to a cusp."""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Size, grid, limits
from camgeo.figure.marks import Line, Mark, Rule, over
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.figure.style import (
    CURVE,
    LIMIT_STYLE,
    MARGINS,
    ZERO,
    diagram_angles,
    joint_marks,
    turn_axis,
)
from camgeo.files.product import Product
from camgeo.units import MM_PER

SIZE = (7.0, 3.6)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The curvature over the cam angle with the limits of +-1/d, d the flanks' distance."""
    phi = diagram_angles(product.pictured.joints)
    scale = MM_PER[product.unit]
    curvature = product.pictured.quantity("curvature", phi) * scale
    what = "outline" if product.pictured.is_flat else "pitch curve"
    marks: list[Mark] = [Line(over(np.degrees(phi), curvature), CURVE, what)]
    distance = product.pictured.flank_distance
    cusps = [scale / distance, -scale / distance] if distance > 0.0 else []  # knife, face: none
    name = "r$_R$" if distance == product.pictured.roller_radius else "(r$_R$ + c/2)"
    for cusp in cusps:
        label = f"cusp of a flank, ±1/{name}" if cusp > 0.0 else ""
        marks.append(Rule("y", cusp, LIMIT_STYLE, label))
    marks += [ZERO, *joint_marks(product.pictured.joints)]
    panel = Panel(
        grid(size, MARGINS)[0],
        turn_axis(),
        Axis(limits([curvature], [*cusps, 0.0]), f"curvature κ [1/{product.unit}]"),
        tuple(marks),
        f"{product.name}: curvature of the {what}",
        legend=Legend(entries(marks)),
    )
    return Figure(size, (panel,))
