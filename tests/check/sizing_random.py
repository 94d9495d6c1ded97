"""Random cams to be sized: wide and narrow lobes, with every kind of follower."""

from __future__ import annotations

import math
import random
from decimal import Decimal

from camgeo.cam.cam import Cam, Contact
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.cams import cam_of
from tests.laws import LAWS

SMOOTH = sorted(name for name in LAWS if name != "straight-line")
"""Laws without shocks."""

CONTACTS = [Contact.INNER, Contact.INNER, Contact.OUTER, Contact.GROOVE]


def roller_cam(seed: int) -> Cam:
    """Half of them have a lobe so high and narrow that its foot may be cut off."""
    draw = random.Random(seed)
    on_guide, narrow = draw.random() < 0.5, draw.random() < 0.5
    high = draw.uniform(40.0, 150.0) if narrow else draw.uniform(5.0, 30.0)
    stroke = high if on_guide else math.radians(draw.uniform(10.0, 45.0))
    plan = _plan(draw, stroke, (25.0, 60.0) if narrow else (50.0, 140.0))
    roller, rotation = draw.uniform(2.0, 20.0), draw.choice((1, -1))
    follower: Follower
    if on_guide:
        follower = TranslatingRoller(400.0, roller, 0.0, 1.1, draw.choice((1, -1)))
    else:
        arm, side = draw.uniform(60.0, 120.0), draw.choice((1, -1))
        pivot = complex(-1.2 * arm, 0.7 * arm)
        follower = OscillatingRoller(pivot, arm, arm, roller, side, draw.choice((1, -1)))
    return cam_of(plan, follower, rotation, draw.choice(CONTACTS))


def face_cam(seed: int) -> Cam:
    """The face has no stated length."""
    draw = random.Random(seed)
    on_guide = draw.random() < 0.4
    stroke = draw.uniform(3.0, 20.0) if on_guide else math.radians(draw.uniform(3.0, 18.0))
    plan, rotation = _plan(draw, stroke, (50.0, 140.0)), draw.choice((1, -1))
    follower: Follower
    if on_guide:
        follower = TranslatingFlat(300.0, 1.1, draw.choice((1, -1)))
    else:
        away, side = draw.uniform(60.0, 120.0), draw.choice((1, -1))
        follower = OscillatingFlat(
            complex(-0.8 * away, 0.6 * away), 0.5 * away, draw.uniform(-0.2, 0.2) * away, side,
            draw.choice((1, -1)),
        )  # fmt: skip
    return cam_of(plan, follower, rotation)


def _plan(draw: random.Random, stroke: float, spans: tuple[float, float]) -> MotionPlan:
    """A rest, a rise, a rest or none, and a return; half of them end with a second lobe."""
    rise, back = (Decimal(round(draw.uniform(*spans))) for _ in range(2))
    top, first = Decimal(draw.choice((0, 3, 30))), Decimal(12)
    moves: list[Dwell | Move] = [Dwell(first), Move(rise, stroke, _law(draw))]
    if top:
        moves.append(Dwell(top))
    moves.append(Move(back, 0.0, _law(draw)))
    rest = 360 - first - rise - top - back
    if draw.random() < 0.5 and rest > 80:
        part = Decimal(round(float(rest) * draw.uniform(0.3, 0.45)))
        moves += [Move(part, draw.uniform(0.2, 0.7) * stroke, _law(draw))]
        moves += [Move(part, 0.0, _law(draw))]
        rest -= 2 * part
    return MotionPlan((*moves, Dwell(rest)))


def _law(draw: random.Random) -> Law:
    return LAWS[draw.choice(SMOOTH)]
