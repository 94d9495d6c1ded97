"""The result of `camgeo report`: readings of diagrams, next steps, what is left out."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from camgeo.app.answers.report import OTHERWISE, Report, next_step, report
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.pictures.model import Axis, Figure, Line, Panel, Style, over
from camgeo.pictures.motion import readings
from camgeo.pictures.plots import Chart
from camgeo.scene.scene import Scene, load_scene, parse_scene
from camgeo.units import TURN
from tests.answers.documents import FIXTURES, document

NO_FOLLOWER = """
camgeo = 1
name = "motion-only"
[cam]
rotation = "ccw"
[[motion]]
to = 10
span = 120
law = "straight-line"
[[motion]]
to = 0
span = 240
law = "straight-line"
"""


@cache
def of(name: str) -> Report:
    return report(Design(load_scene(FIXTURES / f"{name}.toml")), quick=True)


def test_extremes_are_those_of_the_motion() -> None:
    """Of all drawn points, a quarter of a degree apart, and of both ends of the linkage."""
    found = of("scenes/four_bar")
    motion = next(chart for chart in found.charts if chart.title.startswith("motion"))
    drive = Design(found.scene).drive
    phi = np.linspace(0.0, TURN, 36001)[:-1]
    jets = np.degrees([*drive.plan.jet(phi), *drive.motion.jet(phi)])
    assert len(motion.readings) == len(jets)
    for each, values in zip(motion.readings, jets, strict=True):
        size = np.abs(values).max()
        assert each.low == pytest.approx(values.min(), abs=1e-4 * size)
        assert each.high == pytest.approx(values.max(), abs=1e-4 * size)


def test_what_is_infinite_is_said_to_be() -> None:
    """A straight line has no acceleration but at its ends; its document has no number there."""
    found = report(Design(parse_scene(NO_FOLLOWER)), quick=True)
    assert found.animation is None
    (motion,) = found.charts
    assert motion.readings[2].high == math.inf
    assert "∞" in motion.sentence
    assert document(found)["charts"][0]["readings"][2]["high"] is None
    assert any("no follower" in each for each in found.omissions)


def test_what_is_left_out_is_told_in_a_line() -> None:
    scene = load_scene(FIXTURES / "scenes" / "groove.toml")
    values = {key: scene.values[key] for key in ("camgeo", "name", "cam", "motion", "follower")}
    part = {"bore": 10, "rim": scene.values["part"]["rim"]}
    found = report(Design(Scene({**values, "part": part})), quick=True)
    (solid,) = [each for each in found.omissions if each.startswith("solid: ")]
    assert "thickness" in solid
    assert "groove_depth" in solid
    assert "\n" not in solid


def test_a_sentence_names_the_first_curves_and_how_many_more() -> None:
    points = over(np.linspace(0.0, 360.0, 721), np.sin(np.linspace(0.0, TURN, 721)))
    panel = Panel(
        (0.0, 0.0, 1.0, 1.0),
        Axis((0.0, 360.0)),
        Axis((-1.0, 1.0), "force [N]"),
        tuple(Line(points, Style("black"), f"curve {k}") for k in range(6)),
    )
    drawn = Figure((1.0, 1.0), (panel,))
    found = readings(drawn)
    assert [each.name for each in found] == [f"curve {k} [N]" for k in range(6)]
    told = Chart("", drawn, found).sentence
    assert told.startswith("curve 0 [N] from −1 at 270.0° to 1 at 90.0°; ")
    assert told.endswith("; 2 more in the table.")


def test_a_cure_that_works_is_the_next_step_for_undercut() -> None:
    found = of("refused/undercut_tappet")
    assert any(cure.works for cure in found.check.cures)
    undercut = Finding("convexity", "no-disc", "it undercuts")
    works = next(cure.sentence for cure in found.check.cures if cure.works)
    assert works[1:] in next_step(undercut, found.check.cures)
    assert "Enlarge the base radius" in next_step(undercut, ())
    other = Finding("transmission-angle", "broken", "it is small")
    assert works[1:] not in next_step(other, found.check.cures)


def test_a_return_disc_has_the_next_steps_of_any_other() -> None:
    main, other = (Finding(f"{disc}transmission-angle", "broken", "") for disc in ("", "return: "))
    assert next_step(other, ()) == next_step(main, ()) != OTHERWISE["broken"]


@pytest.mark.parametrize("severity", ["warning", "broken", "no-disc", "invalid"])
def test_findings_of_others_have_a_next_step_too(severity: str) -> None:
    finding = Finding("noise", severity, "loud")  # type: ignore[arg-type]  # one of Severity
    assert next_step(finding, ()) == OTHERWISE[severity]  # type: ignore[index]  # likewise
    assert OTHERWISE["ok"] == ""
