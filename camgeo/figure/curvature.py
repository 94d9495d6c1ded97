"""Curvature of the pitch curve, and where a flank comes to a cusp."""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Size, limits
from camgeo.figure.marks import Line, Mark, Rule, over
from camgeo.figure.model import Axis, Figure
from camgeo.figure.style import CURVE, LIMIT_STYLE, ZERO, diagram, diagram_angles
from camgeo.files.product import Product
from camgeo.units import MM_PER

SIZE = (7.0, 3.6)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The curvature over the cam angle with the limits of +-1/d, d the flanks' distance."""
    disc, follower, joints = product.cam.disc, product.cam.follower, product.cam.drive.joints
    phi = diagram_angles(joints)
    scale = MM_PER[product.unit]
    curvature = disc.pitch_curve.curvature(phi) * scale
    what = "pitch curve" if follower.has_pitch_curve else "outline"
    marks: list[Mark] = [Line(over(np.degrees(phi), curvature), CURVE, what)]
    distance = disc.flank_distance
    cusps = [scale / distance, -scale / distance] if distance > 0.0 else []  # knife, face: none
    name = "r$_R$" if distance == follower.roller_radius else "(r$_R$ + c/2)"
    for cusp in cusps:
        label = f"cusp of a flank, ±1/{name}" if cusp > 0.0 else ""
        marks.append(Rule("y", cusp, LIMIT_STYLE, label))
    shown = Axis(limits([curvature], [*cusps, 0.0]), f"curvature κ [1/{product.unit}]")
    title = f"{product.name}: curvature of the {what}"
    return diagram(size, title, shown, [*marks, ZERO], joints)
