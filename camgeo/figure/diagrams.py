"""Diagrams of one panel over the cam angle: the curvature, and the transmission angle."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.check.judge import transmission_angle_limit
from camgeo.figure.layout import Size, limits
from camgeo.figure.marks import Line, Mark, Rule, Style, over
from camgeo.figure.model import Axis, Figure
from camgeo.figure.style import CURVE, LIMIT, LIMIT_STYLE, ZERO, diagram, diagram_angles
from camgeo.outline.path import Flank
from camgeo.product.product import Product
from camgeo.units import MM_PER

SIZE = (7.0, 3.6)

RATIO: Final = {Flank.INNER: 1.0, Flank.OUTER: -1.0}
"""The sign of the curvature that counts on a flank: the inner flank is too sharp where the pitch
curve is convex."""

RATIO_STYLE: Final = Style(LIMIT, 1.0, (1.2, 1.6))


def curvature(product: Product, size: Size = SIZE) -> Figure:
    """Curvature of the pitch curve with the limits of +-1/d, d the flanks' distance.

    Beyond these a flank has a cusp. Nearer to zero is the limit of r_R/r_K that the scene sets, on
    the side of each flank in use.
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
    limit, flanks = product.judgement.limits.radius_ratio, product.cam.contact.flanks
    if follower.roller_radius == 0.0:  # a knife edge or a face, which fits any radius
        flanks = ()
    ratios = [RATIO[flank] * limit * scale / follower.roller_radius for flank in flanks]
    for number, at in enumerate(ratios):
        label = "" if number else f"limit r$_R$/r$_K$ = {limit:g}"
        marks.append(Rule("y", at, RATIO_STYLE, label))
    shown = Axis(limits([kappa], [*cusps, *ratios, 0.0]), f"curvature κ [1/{product.unit}]")
    title = f"{product.name}: curvature of the {what}"
    return diagram(size, title, shown, [*marks, ZERO], joints)


def transmission_angle(product: Product, size: Size = SIZE) -> Figure:
    """The transmission angle with the limit of the design."""
    joints = product.cam.drive.joints
    phi = diagram_angles(joints)
    angle = np.degrees(product.cam.disc.pitch_curve.transmission_angle(phi))
    marks: list[Mark] = [Line(over(np.degrees(phi), angle), CURVE, "transmission angle")]
    limit = math.degrees(transmission_angle_limit(product.cam, product.judgement.limits))
    marks.append(Rule("y", limit, LIMIT_STYLE, f"limit {limit:g}°"))
    low = min(float(angle.min()), limit)
    floor = max(0.0, 10.0 * float(np.floor(low / 10.0)) - 5.0)
    shown = Axis((floor, 95.0), "transmission angle μ [°]")
    return diagram(size, f"{product.name}: transmission angle", shown, marks, joints)
