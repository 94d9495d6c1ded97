"""Transmission angle over the cam angle, with its limit."""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Size, grid
from camgeo.figure.marks import Line, Mark, Rule, over
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.figure.style import (
    CURVE,
    LIMIT_STYLE,
    MARGINS,
    diagram_angles,
    joint_marks,
    turn_axis,
)
from camgeo.files.product import Product

FINDING = "transmission-angle"
"""Name of the finding that carries the limit, in degrees."""

SIZE = (7.0, 3.6)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The transmission angle with the limit that the design is held to."""
    phi = diagram_angles(product.pictured.joints)
    angle = np.degrees(product.pictured.quantity("transmission_angle", phi))
    marks: list[Mark] = [Line(over(np.degrees(phi), angle), CURVE, "transmission angle")]
    limit = next((item.limit for item in product.findings if item.name == FINDING), None)
    if limit is not None:
        marks.append(Rule("y", limit, LIMIT_STYLE, f"limit {limit:g}°"))
    marks += joint_marks(product.pictured.joints)
    low = min(float(angle.min()), limit if limit is not None else 90.0)
    floor = max(0.0, 10.0 * float(np.floor(low / 10.0)) - 5.0)
    panel = Panel(
        grid(size, MARGINS)[0],
        turn_axis(),
        Axis((floor, 95.0), "transmission angle μ [°]"),
        tuple(marks),
        f"{product.name}: transmission angle",
        legend=Legend(entries(marks)),
    )
    return Figure(size, (panel,))
