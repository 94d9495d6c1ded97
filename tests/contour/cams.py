"""Curves for the tests of contours: the fixture cams' flanks, and any valid cam."""

from __future__ import annotations

from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import camgeo
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import ComplexArray
from tests.laws import LAWS
from tests.long_form import LONG
from tests.measuring import Outline
from tests.reference import shift

TURN = 2.0 * np.pi

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

FLANKS = [("setzhub", -1), ("schnitt", -1), ("plate_translating", -1), ("ring", 1)]
"""Guides and rockers, with a linkage and without, on both sides of the roller; the curves of all
scenes are fitted by `tests.end_to_end.test_tolerances`."""

if LONG:
    FLANKS += [("vorschub", -1), ("querhub", -1), ("groove", 1)]

DENSE = 100_000

SMOOTH = ("polynomial-345", "inclined-sine", "modified-sine", "modified-trapezoid", "simple-sine")

STROKES = st.just(0.0) | st.floats(-0.5, -1e-3) | st.floats(1e-3, 1.0)
"""Shares of the largest stroke; a stroke of 1e-20 mm is a dwell by another name."""


@cache
def flank(scene: str, side: int) -> WorkingCurve:
    """Inner (-1) or outer (+1) working curve of a fixture scene."""
    design = camgeo.load(SCENES / f"{scene}.toml")
    return design.cam.disc.inner_curve if side < 0 else design.cam.disc.outer_curve


def translating(
    *segments: Dwell | Move, base: float = 40.0, roller: float = 8.0, rotation: int = 1
) -> WorkingCurve:
    """Inner working curve of a centric translating roller."""
    follower = TranslatingRoller(base, roller)
    return WorkingCurve(PitchCurve(MotionPlan(segments), follower, rotation), -roller)


def dwell(span: int) -> Dwell:
    return Dwell(Decimal(span))


def move(span: int, to: float, law: str = "polynomial-345") -> Move:
    return Move(Decimal(span), to, LAWS[law])


@st.composite
def curves(draw: st.DrawFn) -> WorkingCurve:
    """An offset of the pitch curve of any cam, regular everywhere with room to spare."""
    count = draw(st.integers(1, 3))
    spans = [draw(st.integers(30, 100)) for _ in range(count)]
    dwells = [draw(st.integers(0, 40)) for _ in range(count)]
    rest = 360 - sum(spans) - sum(dwells)
    assume(rest >= 0)
    oscillating = draw(st.booleans())
    size = 0.3 if oscillating else 20.0  # rad, mm
    segments: list[Dwell | Move] = [dwell(draw(st.integers(0, rest)))]
    for number, (span, pause) in enumerate(zip(spans, dwells, strict=True)):
        last = number == count - 1
        to = 0.0 if last else draw(STROKES) * size
        law = shift(LAWS[draw(st.sampled_from(SMOOTH))], draw(st.floats(0.35, 0.65)))
        segments += [Move(Decimal(span), to, law), dwell(pause)]
    left = 360 - int(sum(segment.span for segment in segments))
    segments.append(dwell(left))
    roller = draw(st.floats(4.0, 12.0))
    follower: TranslatingRoller | OscillatingRoller
    if oscillating:
        pivot = complex(draw(st.floats(-110.0, -70.0)), draw(st.floats(-90.0, -50.0)))
        base, direction = draw(st.floats(65.0, 80.0)), draw(st.sampled_from((1, -1)))
        follower = OscillatingRoller(pivot, 80.0, base, roller, 1, direction)
    else:
        offset = draw(st.floats(-15.0, 15.0))
        follower = TranslatingRoller(draw(st.floats(40.0, 70.0)), roller, offset)
    pitch = PitchCurve(MotionPlan(tuple(segments)), follower, draw(st.sampled_from((1, -1))))
    curve = WorkingCurve(pitch, draw(st.sampled_from((-1.0, 0.0, 1.0))) * roller)
    assume(np.min(curve.regularity(np.linspace(0.0, TURN, 2000))) > 0.1)
    return curve


def dense(curve: WorkingCurve) -> ComplexArray:
    """Points of the whole curve."""
    return curve.point(np.linspace(0.0, TURN, DENSE, endpoint=False))


def polyline(vertices: ComplexArray) -> Contour:
    """Straight pieces through `vertices`."""
    zero = np.zeros(len(vertices))
    return Contour(vertices, zero, zero.astype(np.complex128))


def outline(contour: Contour) -> Outline:
    """The contour as the tests' own measure takes it."""
    return Outline(contour.vertices, contour.ends, contour.sweeps, contour.centres)
