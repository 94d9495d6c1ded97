"""Diagrams of one panel over the cam angle: the curvature, and the transmission angle."""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Size, limits
from camgeo.figure.marks import Line, Mark, Rule, over
from camgeo.figure.model import Axis, Figure
from camgeo.figure.style import CURVE, LIMIT_STYLE, ZERO, diagram, diagram_angles
from camgeo.product.product import Product
from camgeo.units import MM_PER

SIZE = (7.0, 3.6)

FINDING = "transmission-angle"
"""Name of the finding that carries the limit of that angle, in degrees."""


def curvature(product: Product, size: Size = SIZE) -> Figure:
    """Curvature of the pitch curve with the limits of +-1/d, d the flanks' distance.

    Beyond these a flank has a cusp.
    """
    disc, follower, joints = product.cam.disc, product.cam.follower, product.cam.drive.joints
    phi = diagram_angles(joints)
    scale = MM_PER[product.unit]
    kappa = disc.pitch_curve.curvature(phi) * scale
    what = "pitch curve" if follower.has_pitch_curve else "outline"
    marks: list[Mark] = [Line(over(np.degrees(phi), kappa), CURVE, what)]
    distance = disc.flank_distance
    cusps = [scale / distance, -scale / distance] if distance > 0.0 else []  # knife, face: none
    name = "r$_R$" if distance == follower.roller_radius else "(r$_R$ + c/2)"
    for cusp in cusps:
        label = f"cusp of a flank, ±1/{name}" if cusp > 0.0 else ""
        marks.append(Rule("y", cusp, LIMIT_STYLE, label))
    shown = Axis(limits([kappa], [*cusps, 0.0]), f"curvature κ [1/{product.unit}]")
    title = f"{product.name}: curvature of the {what}"
    return diagram(size, title, shown, [*marks, ZERO], joints)


def transmission_angle(product: Product, size: Size = SIZE) -> Figure:
    """The transmission angle with the limit of the design."""
    joints = product.cam.drive.joints
    phi = diagram_angles(joints)
    angle = np.degrees(product.cam.disc.pitch_curve.transmission_angle(phi))
    marks: list[Mark] = [Line(over(np.degrees(phi), angle), CURVE, "transmission angle")]
    limit = next((item.limit for item in product.findings if item.name == FINDING), None)
    if limit is not None:
        marks.append(Rule("y", limit, LIMIT_STYLE, f"limit {limit:g}°"))
    low = min(float(angle.min()), limit if limit is not None else 90.0)
    floor = max(0.0, 10.0 * float(np.floor(low / 10.0)) - 5.0)
    shown = Axis((floor, 95.0), "transmission angle μ [°]")
    return diagram(size, f"{product.name}: transmission angle", shown, marks, joints)
