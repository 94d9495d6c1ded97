"""Transmission angle over the cam angle, with its limit."""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Size
from camgeo.figure.marks import Line, Mark, Rule, over
from camgeo.figure.model import Axis, Figure
from camgeo.figure.style import CURVE, LIMIT_STYLE, diagram, diagram_angles
from camgeo.files.product import Product

FINDING = "transmission-angle"
"""Name of the finding that carries the limit, in degrees."""

SIZE = (7.0, 3.6)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The transmission angle with the limit that the design is held to."""
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
