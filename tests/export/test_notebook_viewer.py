"""The widget of notebooks: what it hands to its script, and that it is asked for."""

from __future__ import annotations

import builtins
import json
from pathlib import Path
from typing import Any, Final

import pytest
import traitlets

import camgeo
from camgeo.app.designing.painting import painted
from camgeo.app.designing.recent import Recent
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo_export.browser.bundles import bundle
from camgeo_export.notebook.viewer import viewer
from tests.hostile_scene import ALL_AT_ONCE, hostile_design
from tests.imported import imported_anew

SCENES: Final = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.fixture
def design() -> Design:
    return camgeo.load(SCENES / "plate_translating.toml")


def test_a_view_has_what_is_drawn_and_the_script_that_draws_it(design: Design) -> None:
    view = design.view()
    state = view.get_state()
    assert state["data"] == painted(design, Recent())
    assert state["_esm"] == bundle("viewer.js")
    assert state["angle"] == 0.0
    assert len(json.dumps(state["data"], allow_nan=False)) < 200_000
    assert "application/vnd.jupyter.widget-view+json" in view._repr_mimebundle_()[0]


def test_its_angle_is_shared_and_within_a_turn(design: Design) -> None:
    view = design.view()
    seen: list[float] = []
    view.observe(lambda change: seen.append(change["new"]), "angle")
    for given, kept in ((123.4, 123.4), (360.0, 0.0), (-90.0, 270.0), (-1e-20, 0.0), (725.0, 5.0)):
        view.angle = given
        assert view.angle == kept
    view.set_state({"angle": 45.5})  # as the notebook does
    assert view.angle == 45.5
    assert seen == [123.4, 0.0, 270.0, 0.0, 5.0, 45.5]
    for wrong in (float("nan"), float("inf"), "north"):
        with pytest.raises(traitlets.TraitError):
            view.angle = wrong
    assert view.angle == 45.5


def test_another_design_is_shown_at_the_same_angle(design: Design) -> None:
    view = design.view()
    view.angle = 30.0
    larger = Design(design.scene.with_values({"follower.base_radius": 80}))
    view.show(larger)
    assert view.angle == 30.0
    assert view.data == painted(larger, Recent()) != painted(design, Recent())


def test_a_motion_alone_has_its_diagrams() -> None:
    values = dict(camgeo.load(SCENES / "plate_translating.toml").scene.values)
    kept = {key: values[key] for key in ("camgeo", "name", "cam", "motion")}
    data = Design(camgeo.Scene(kept)).view().data
    assert data["animation"] is None
    assert [each["name"] for each in data["charts"]] == ["motion"]


def test_texts_of_a_scene_are_data_for_a_script_that_makes_no_markup(tmp_path: Path) -> None:
    view = hostile_design(ALL_AT_ONCE, tmp_path).view()
    assert json.loads(json.dumps(view.data)) == view.data
    for word in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("):
        assert word not in bundle("viewer.js")


def test_without_the_library_the_command_that_brings_it_is_named(
    design: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = builtins.__import__

    def without(name: str, *given: Any, **named: Any) -> Any:
        if name.split(".")[0] == "anywidget":
            raise ModuleNotFoundError("No module named 'anywidget'", name="anywidget")
        return found(name, *given, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    cure = r'`pip install "camgeo\[notebook\]"` brings it'
    with (
        imported_anew("camgeo_export.notebook.widget".__eq__),
        pytest.raises(CamgeoError, match=cure),
    ):
        viewer(design)
    assert design._repr_html_() is not None
    assert design.plot("motion") is not None
