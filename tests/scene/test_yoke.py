"""`[follower.yoke]`: what it asks for, what it refuses, and the cam between its sides."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.scene.scene import parse_scene
from tests.scene.scenes import refusal_of

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TEXT = (SCENES / "constant_breadth.toml").read_text(encoding="utf-8")

PLATE = (SCENES / "plate_translating.toml").read_text(encoding="utf-8")

YOKE = "[follower.yoke]\nbreadth = 66\n"

EVEN = "[[motion]]\ndwell = 20\n[[motion]]\nlaw = 'modified-sine'\nspan = 160\nto = 20\n"
EVEN += "[[motion]]\ndwell = 20\n[[motion]]\nlaw = 'modified-sine'\nspan = 160\nto = 0\n"


def closing(text: str) -> camgeo.Finding:
    """The finding of the yoke."""
    found = {each.name: each for each in Design(parse_scene(text)).findings}
    return found["closing-error"]


def on_rollers(yoke: str = "[follower.yoke]\n", offset: str = "") -> str:
    """The plate cam of the fixtures with an even motion and a yoke on rollers."""
    head, _, rest = PLATE.partition("[[motion]]")
    tail = rest[rest.index("[part]") :]
    return head.replace("offset = 12\n", offset) + yoke + EVEN + tail


def test_the_written_contour_has_the_breadth_in_every_direction() -> None:
    design = Design(parse_scene(TEXT))
    points = design.disc.drawn.part.boundaries[0].arcs(1e-3).contour.points(1e-5)
    ways = np.exp(1j * np.linspace(0.0, math.pi, 181))
    heights = (points[:, None] * np.conj(ways)).real
    widths = np.max(heights, axis=0) - np.min(heights, axis=0)
    # Each side within the tolerance and the chords of its points.
    assert np.max(np.abs(widths - 66.0)) <= 2.0 * (1e-3 + 1e-5)


def test_rollers_of_a_yoke_are_as_far_apart_on_the_pitch_curve() -> None:
    design = Design(parse_scene(on_rollers()))
    phi = np.linspace(0.0, math.pi, 37)
    points = [
        x + 1j * y
        for x, y in (design.disc.pictured.curve("pitch", angle).T for angle in (phi, phi + math.pi))
    ]
    assert np.abs(points[0] - points[1]) == pytest.approx(design.cam.yoke_breadth, rel=1e-14)
    assert design.cam.yoke_breadth == pytest.approx(120.0)
    assert closing(on_rollers()).severity == "ok"


def test_a_wrong_breadth_is_reported_with_its_error() -> None:
    finding = closing(TEXT.replace("breadth = 66", "breadth = 66.05"))
    assert finding.severity == "broken"
    assert finding.value == pytest.approx(0.05)
    limited = TEXT.replace("breadth = 66", "breadth = 66.05").replace(
        "[part]", "[limits]\nclosing_error = 0.06\n[part]"
    )
    assert closing(limited).severity == "ok"


def test_a_motion_that_does_not_undo_itself_is_reported() -> None:
    text = TEXT.replace("dwell = 50", "dwell = 40", 1).replace("span = 130", "span = 140", 1)
    finding = closing(text)
    assert finding.severity == "broken"
    assert finding.value is not None
    assert finding.value > 0.1


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        (on_rollers(offset="offset = 12\n"), "follower.offset = 12: must be 0 for a yoke"),
        (
            on_rollers("[follower.yoke]\n[follower.return]\nspacing = 150\n"),
            "contradicts [follower.return]",
        ),
        (
            on_rollers().replace('contact = "inner"', 'contact = "outer"'),
            'belongs to contact "inner": the yoke stands astride',
        ),
        (TEXT.replace("breadth = 66", "breadth = -1"), "follower.yoke.breadth = -1"),
        (TEXT.replace(YOKE, "yoke = 3\n"), "must be a table, headed [follower.yoke]"),
        (
            on_rollers() + "[effects.lift-off]\nbacklash = 0.1\n[effects.inertia]\nmass = 1\n",
            "effects.lift-off.backlash = 0.1: is not for a yoke, [follower.yoke], whose play",
        ),
        (
            PLATE + "[limits]\nclosing_error = 0.01\n",
            "it needs [follower.return] or [follower.yoke]",
        ),
    ],
)
def test_what_does_not_go_with_a_yoke_is_refused(text: str, reported: str) -> None:
    assert reported in str(refusal_of(text))


def test_for_a_refused_effect_nothing_missing_is_reported() -> None:
    table = "[effects.roller-spin]\nmoment_of_inertia = 1e-5\ntraction = 0.1\n"
    (fault,) = refusal_of(TEXT + table).faults
    assert fault.key == "effects.roller-spin"
    assert fault.message.startswith("is for roller followers")


def test_a_rocker_has_no_yoke() -> None:
    text = (SCENES / "shuttle.toml").read_text(encoding="utf-8")
    with pytest.raises(SceneError, match="yoke"):
        parse_scene(text.replace("roller_radius = 10", "roller_radius = 10\nyoke = {}"))
