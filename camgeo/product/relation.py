"""How the two discs of a conjugate pair stand to each other on their shaft.

Both outlines are in cam coordinates, the frame at cam angle 0, so the return disc is at 0 degrees
to the main one. Turned from there by a small angle d, it would hold the follower at s(phi + d)
where the main disc holds it at s(phi): the pair opens or squeezes by s' d, as travel of the
follower, and by the reach of the main roller times that, as travel of that roller.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.check.finding import Finding, held
from camgeo.numeric.arrays import FloatArray, Side, merged
from camgeo.numeric.extremes import Extreme, piecewise_highest
from camgeo.part.pair_spec import MAIN, Pair
from camgeo.part.spec import PartSpec
from camgeo.product.product import Product
from camgeo.units import TURN
from camgeo.wording import at_cam_angles, listed

ANGLE: Final = 0.0
"""Of the return disc to the main disc [degrees]."""

DISC_ANGLE: Final = "disc-angle"
ROLLER_WIDTH: Final = "roller-width"
"""Names of findings."""


def relation_of(disc: Product) -> tuple[Finding, ...]:
    """The findings on both discs together: of the pair in one piece, or of a main disc whose return
    disc is another piece; none of other discs, and if the scene states no part.
    """
    spec = disc.scene.part
    if not disc.others or spec is None:
        return ()
    if disc.is_pair:
        assert spec.pair is not None  # of which this is
        shown = _shown(spec)
        told = f"{in_one_piece(spec.pair)}{f'; {listed(shown)}' if shown else ''}"
        angle = Finding(DISC_ANGLE, "ok", told, ANGLE, unit="deg")
        return (angle, _room(disc, spec, spec.pair))
    return () if spec.pair is not None else (_of_two_pieces(disc, spec),)


def in_one_piece(pair: Pair) -> str:
    """How the discs stand to each other, in words."""
    side = "below" if pair.upper == MAIN else "above"
    return (
        f"both discs in one piece: the return disc at {ANGLE:g} deg to the main disc, {side} it,"
        f" with a gap of {pair.gap:.6g} mm"
    )


def _of_two_pieces(main: Product, spec: PartSpec) -> Finding:
    told = f"the return disc belongs at {ANGLE:g} deg to the main disc, as both are drawn"
    steepest, limit = _steepest(main), main.scene.limits.closing_error
    if steepest.value > 0.0:
        off = math.degrees(limit / steepest.value)
        play = f"the rollers have {limit:g} mm of play or squeeze"
        told = f"{told}; off by {off:.3g} deg, {play} {at_cam_angles(steepest.place)}"
    shown, bolts = _shown(spec), spec.bolt_circle
    doubt = ""
    if not shown:
        doubt = "nothing on the discs shows it: neither keyway, flat, mark nor bolt circle"
    elif len(shown) == 1 and bolts is not None and bolts.count > 1:
        doubt = f"the bolt holes fit in {bolts.count} positions, of which one is right"
    if doubt:
        return Finding(DISC_ANGLE, "warning", f"{told}; {doubt}", ANGLE, unit="deg")
    told = f"{told}; in line on both discs: {listed(shown)}"
    return Finding(DISC_ANGLE, "ok", told, ANGLE, unit="deg")


def _shown(spec: PartSpec) -> list[str]:
    """The features by which an angle is seen, each at the same place of both discs."""
    named = {
        "keyway": spec.keyway,
        "flat of the bore": spec.d_shaft,
        "timing mark": spec.mark,
        "first bolt hole": spec.bolt_circle,
    }
    return [
        f"{name} at {math.degrees(each.angle):g} deg"
        for name, each in named.items()
        if each is not None
    ]


def _steepest(main: Product) -> Extreme:
    """The largest travel of the main roller for each radian of the cam [mm], and where it is."""
    drive = main.cam.drive
    reach = abs(main.cam.follower.reach)

    def speed(phi: FloatArray, side: Side) -> FloatArray:
        found: FloatArray = reach * np.abs(drive.motion.jet(phi, side)[1])
        return found

    edges = merged(np.concatenate((drive.smooth_angles, [0.0, TURN])))
    return piecewise_highest(speed, edges)


def _room(main: Product, spec: PartSpec, pair: Pair) -> Finding:
    """How wide rollers may be before one reaches the other disc, or both reach each other."""
    assert spec.thickness is not None  # a pair has one
    one, other = (cam.follower for cam in main.judgement.cams)
    apart = abs(one.traced_point(0.0) - other.traced_point(0.0))
    near = apart <= one.roller_radius + other.roller_radius
    most = spec.thickness + (1.0 if near else 2.0) * pair.gap
    reached = "the rollers reach each other" if near else "one reaches the other disc"
    told = f"in the middle of their discs rollers may be {most:g} mm wide before {reached}"
    if pair.roller_width is None:
        return Finding(ROLLER_WIDTH, "ok", told, most, unit="mm")
    statement = f"rollers {pair.roller_width:g} mm wide; {told}"
    return held(ROLLER_WIDTH, statement, pair.roller_width, most, "mm")
