"""Values are converted once: lengths to mm, angles to rad, speeds to rad/s."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from typing import Any

import pytest

from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell
from camgeo.milling.milling import GcodeSpec, Heights, Holding, MillingSpec, Stock, Tool
from camgeo.part.spec import Chamfer, Chamfers, Engraving, Hub, Keyway, Mark, PartSpec
from camgeo.scene.formats import csv, gcode
from camgeo.scene.formats.format import OutputSpec
from tests.findings import known
from tests.scene.scenes import GROOVE, LINKED, PLATE, ROCKER, loaded

TOOL = Tool(
    number=1,
    diameter=10.0,
    flute_length=22.0,
    spindle_speed=3000.0,
    feed=300.0,
    plunge_feed=100.0,
    stepdown=3.0,
)


def test_plate() -> None:
    scene = loaded(PLATE)
    assert (scene.name, scene.unit, scene.rotation, scene.contact) == ("plate", "mm", 1, "inner")
    assert scene.speed == pytest.approx(2.0 * math.pi, rel=1e-15)
    assert scene.follower == TranslatingRoller(50.0, 10.0, offset=12.0)
    assert scene.linkage is None
    assert scene.limits.transmission_angle == math.radians(60.0)
    assert scene.limits.radius_ratio == 0.7
    assert scene.part == PartSpec(thickness=12.0, bore=20.0, keyway=Keyway(6.0, 2.8, 0.0))
    assert scene.output.formats == ("dxf", "gcode", "stl", "3mf", "csv", "svg", "png")
    assert scene.output.tolerance == 0.001
    assert scene.output.options[gcode.FORMAT] == GcodeSpec()
    assert scene.milling == MillingSpec(
        tools=(TOOL,), stock=Stock(), holding=Holding(kind="fixture", through=0.5)
    )
    assert scene.output.options[csv.FORMAT].step == Decimal("0.5")


def test_motion() -> None:
    segments: Any = loaded(PLATE).plan.segments
    first, rise, second, fall, third = segments
    assert (first, second, third) == (Dwell(Decimal(30)), Dwell(Decimal(40)), Dwell(Decimal(70)))
    assert (rise.span, rise.to) == (Decimal(100), 20.0)
    assert (rise.law.name, rise.law.inflection) == ("modified-sine", 0.5)
    assert (fall.law.name, fall.law.inflection) == ("polynomial-345", 0.4)


def test_spans_stay_as_written() -> None:
    scene = loaded(PLATE, ("dwell = 40", "dwell = 39.9"), ("dwell = 70", "dwell = 70.1"))
    spans = [segment.span for segment in scene.plan.segments]
    assert spans == [Decimal(30), Decimal(100), Decimal("39.9"), Decimal(120), Decimal("70.1")]


def test_empty_dwells_keep_their_number() -> None:
    """The segments of the plan count as those of the scene do."""
    scene = loaded(PLATE, ("dwell = 40", "dwell = 0.0"), ("dwell = 70", "dwell = 110"))
    assert len(scene.plan.segments) == 5
    assert scene.plan.segments[2] == Dwell(Decimal(0))
    assert len(scene.plan.stretches) == 4


def test_rocker_moves_in_degrees() -> None:
    scene = loaded(ROCKER)
    assert scene.plan.segments[0].to == math.radians(25.0)  # type: ignore[union-attr]  # a move
    assert scene.follower == OscillatingRoller(complex(-96.0, -72.0), 80.0, 55.0, 10.0, 1, 1)
    assert scene.speed is None
    assert scene.part is None
    assert scene.output == OutputSpec()
    assert (scene.limits.transmission_angle, scene.limits.radius_ratio) == (None, 0.7)
    inward = loaded(ROCKER, ("arm = 80", 'arm = 80\narm_side = "cw"\ndirection = "inward"'))
    assert inward.follower == OscillatingRoller(complex(-96.0, -72.0), 80.0, 55.0, 10.0, -1, -1)


def test_linkage_moves_in_lengths() -> None:
    scene = loaded(LINKED)
    assert scene.plan.segments[0].to == 5.5  # type: ignore[union-attr]  # a move
    assert isinstance(scene.follower, OscillatingRoller)
    assert scene.follower.direction is None
    assert scene.linkage == SliderCrank(
        crank=42.0, coupler=75.38, deflection=math.radians(6.3), leans_away=True,
        slider_side=1, stroke_direction=1, branch=1, mirrored=False,
    )  # fmt: skip


def test_linkage_words() -> None:
    scene = loaded(
        LINKED,
        ('direction = "outward"\n', ""),
        ('leans = "away"', 'leans = "toward"\nslider_side = "right"\nmirrored = true'),
        ('"left"', '"right"'),
        ('branch = "cw"', 'branch = "ccw"'),
    )
    assert scene.linkage == SliderCrank(
        crank=42.0, coupler=75.38, deflection=math.radians(6.3), leans_away=False,
        slider_side=-1, stroke_direction=-1, branch=-1, mirrored=True,
    )  # fmt: skip


def test_direction_may_agree_with_the_linkage() -> None:
    loaded(LINKED)
    loaded(LINKED, ('"outward"', '"inward"'), ("crank = 42", "crank = 42\nmirrored = true"))


def test_groove() -> None:
    scene = loaded(GROOVE)
    assert scene.contact == "groove"
    assert scene.part == PartSpec(thickness=20.0, bore=25.0, rim=200.0, groove_depth=10.0)


def test_earlier_keys_state_one_tool() -> None:
    table = """tool_diameter = 8
tool_number = 3
spindle_speed = 2500.5
feed = 200
plunge_feed = 50
pass_depth = 1.5
safe_height = 2
"""
    tables = PLATE[PLATE.index("[[tool]]") : PLATE.index("[holding]")]
    scene = loaded(PLATE, ('machine = "linuxcnc"\n', table), (tables, ""))
    assert scene.output.options[gcode.FORMAT].heights == Heights(2.0, 2.0)
    assert known(scene.milling).earlier
    assert known(scene.milling).tools == (
        Tool(
            number=3, diameter=8.0, spindle_speed=2500.5, feed=200.0, plunge_feed=50.0,
            stepdown=1.5, plunges=True,
        ),
    )  # fmt: skip


def test_features_of_a_part() -> None:
    hub = "[part.hub]\ndiameter = 14\nheight = 0.5\n"
    mark = "[part.mark]\nradius = 1.2\nwidth = 0.1\ndepth = 0.02\nangle = 90\n"
    keyway = 'bore = 12\nkeyway = { standard = "DIN 6885-1", angle = 30 }'
    keyway += '\nchamfers = { outline = { width = 0.5, edges = "upper" } }'
    scene = loaded(
        PLATE, ('"mm"', '"inch"'), ("bore = 20\n", ""),
        ("keyway = { width = 6, depth = 2.8 }", f"{keyway}\n{hub}{mark}"),
    )  # fmt: skip
    assert scene.part == PartSpec(
        12 * 25.4,
        12 * 25.4,
        Keyway(70.0, 14.4, math.radians(30.0)),
        hub=Hub(14 * 25.4, 0.5 * 25.4),
        mark=Mark(1.2 * 25.4, 0.1 * 25.4, 0.02 * 25.4, angle=math.radians(90.0)),
        chamfers=Chamfers(outline=Chamfer(0.5 * 25.4, "upper")),
    )


def test_texts_of_a_part() -> None:
    """The first one has the name of the scene."""
    texts = (
        "[[part.engraving]]\nheight = 0.2\ndepth = 0.01\nradius = 0.75\n"
        '[[part.engraving]]\ntext = "Ø8"\nheight = 0.1\ndepth = 0.01\nradius = 0.5\nangle = 90\n'
        'along = "straight"\nturn = 45\n'
    )
    scene = loaded(PLATE, ('"mm"', '"inch"'), ("[limits]", f"{texts}[limits]"))
    assert known(scene.part).engraving == (
        Engraving("plate", 0.2 * 25.4, 0.01 * 25.4, 0.75 * 25.4),
        Engraving(
            "Ø8", 0.1 * 25.4, 0.01 * 25.4, 0.5 * 25.4, math.radians(90.0), "straight",
            turn=math.radians(45.0),
        ),
    )  # fmt: skip


def test_inches() -> None:
    scene = loaded(
        PLATE, ('"mm"', '"inch"'), ("tolerance = 0.001", "tolerance = 0.0001"),
        ("step = 0.5", "step = 0.25"),
    )  # fmt: skip
    assert scene.unit == "inch"
    assert scene.follower == TranslatingRoller(50 * 25.4, 10 * 25.4, offset=12 * 25.4)
    assert scene.part == PartSpec(12 * 25.4, 20 * 25.4, Keyway(6 * 25.4, 2.8 * 25.4))
    assert scene.output.tolerance == 0.0001 * 25.4
    # The default height of traverses is millimetres, whatever the scene's unit.
    assert scene.output.options[gcode.FORMAT] == GcodeSpec()
    assert known(scene.milling).tools == (
        replace(
            TOOL, diameter=254.0, flute_length=22 * 25.4, feed=300 * 25.4, plunge_feed=100 * 25.4,
            stepdown=3 * 25.4,
        ),
    )  # fmt: skip
    assert known(scene.milling).holding == Holding(kind="fixture", through=0.5 * 25.4)
    assert scene.output.options[csv.FORMAT].step == Decimal("0.25")
    assert scene.speed == loaded(PLATE).speed
