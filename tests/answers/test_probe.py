"""The result of `camgeo probe`, rendered as text, JSON and tables."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest

from camgeo.app.answers.answer import table, text
from camgeo.app.answers.probe import Probing, lift_table, probe
from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document

FOLDER = FIXTURES / "scenes"

STEP = Decimal(10)


def probed(name: str, ball: float = 0.0) -> Probing:
    return probe(Design(load_scene(FOLDER / f"{name}.toml")), step=STEP, ball=ball)


def test_a_ball_that_does_not_fit_breaks_a_limit() -> None:
    assert probed("setzhub", ball=1.0).exit_code == 0
    found = probed("setzhub", ball=60.0)
    assert found.exit_code == 1
    assert "BROKEN  ball" in text(found)
    (broken,) = (each for each in found.flanks[0].findings if each.severity == "broken")
    assert isinstance(broken, Finding)
    assert document(found)["flanks"][0]["findings"][0]["cam_angle_deg"] == pytest.approx(
        np.degrees(broken.cam_angle or 0.0)
    )


def test_lifts_are_those_of_the_value_table() -> None:
    design = Design(load_scene(FOLDER / "setzhub.toml"))
    found = probe(design, step=STEP)
    values = design.tabulated.table(STEP).columns
    for each in (table(found), lift_table(found)):
        assert np.array_equal(each.columns["phi [deg]"], values["phi [deg]"])
    assert np.array_equal(table(found).columns["psi [deg]"], values["psi [deg]"])
    assert np.array_equal(lift_table(found).columns["psi [deg]"], values["psi [deg]"])
    for axis in "xy":
        own = table(found).columns[f"{axis} [mm]"]
        assert own == pytest.approx(values[f"inner {axis} [mm]"], abs=1e-12)


def test_the_lift_curve_of_a_trimmed_cam_is_what_its_disc_makes() -> None:
    found = probed("swallow_tail")
    scene = load_scene(FOLDER / "swallow_tail.toml")
    demanded = Design(scene).drive.motion.jet(found.lift_curve[:, 0])[0]
    assert np.max(np.abs(found.lift_curve[:, 1] - demanded)) > 0.01
    assert found.flanks[0].count < 36
    assert "no point" in text(found)
