"""What notebooks show: HTML in which every text stays a text, pictures, and the widget."""

from __future__ import annotations

import base64
import builtins
import json
import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final, cast

import matplotlib.figure
import numpy as np
import pytest
import traitlets

import camgeo
from camgeo.app.answers.answer import MARKS
from camgeo.app.answers.answer import text as render_text
from camgeo.app.answers.compare import compare
from camgeo.app.answers.laws import laws_of_all_tasks, laws_of_task
from camgeo.app.answers.refusal import refusal
from camgeo.app.answers.report import Report, report
from camgeo.app.answers.size import size
from camgeo.app.answers.sweep import Sweep, answer_of
from camgeo.app.answers.table import ValueTable, table_of_scene
from camgeo.app.answers.verify import Verdict, Verification, verify
from camgeo.app.cli.main import main
from camgeo.app.designing.painting import painted
from camgeo.app.designing.recent import Recent
from camgeo.check.finding import Finding, Findings, Severity
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.design.verify import Check as Checked
from camgeo.design.writing import FileReport
from camgeo.design.writing import Report as Written
from camgeo.errors import CamgeoError, GeometryError, SceneError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.comparison import Running
from camgeo.pictures.model import Text
from camgeo.pictures.plots import of_design
from camgeo.record import Displayed
from camgeo.studies.sweep.family import family_of
from camgeo.studies.sweep.sweep import sweep
from camgeo_export.browser.bundles import bundle
from camgeo_export.notebook.display import BADGES, FIRST_ROWS, LAST_ROWS
from camgeo_export.notebook.viewer import viewer
from camgeo_export.plots import Picture, render, saved
from tests import kept
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, Page, harmless, hostile_design
from tests.imported import imported_anew

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

PNG: Final = b"\x89PNG\r\n\x1a\n"


@cache
def design(name: str) -> Design:
    return camgeo.load(SCENES / f"{name}.toml")


@cache
def gathered() -> Report:
    return report(design("plate_translating"), quick=True)


@cache
def swept() -> Sweep:
    family = family_of(design("plate_translating").scene, ["motion.2.law=modified-sine,none"])
    return answer_of(sweep(family, ["transmission-angle"]))


def html(value: Displayed) -> str:
    found = value._repr_mimebundle_()["text/html"]
    assert isinstance(found, str)
    return found


def texts(value: Displayed) -> str:
    return " ".join(Page(html(value)).texts)


def written(text: str) -> list[Displayed]:
    """Objects of each kind that holds texts, with `text` as every one of them."""
    wrong = Finding(text, "broken", text, 1.0, 2.0, text, 0.0)
    told = gathered()
    found, one = told.check, told.table
    assert one is not None
    law = make_law("polynomial-345", "R-R")
    chart = replace(told.charts[0], title=text, readings=())
    figure = told.charts[0].figure
    span = swept().spans[0]
    return [
        wrong,
        Findings([wrong, replace(wrong, severity="ok")]),
        replace(one, names=(text,) * len(one.names)),
        ValueTable(replace(one, names=(text,) * len(one.names))),
        replace(law, name=text, parameters={text: 1.0}),
        replace(found, findings=Findings([wrong]), effects={text: (wrong,)}),
        replace(told, charts=(chart,), left_out=(text,)),
        replace(figure, texts=(Text(text, (0.5, 0.5), 8.0, "figure"),), rows=(), panels=()),
        refusal(SceneError([camgeo.Fault(text, text, text, text)], text)),
        Written((Path(text),), (FileReport(text, text, 1, 1e-3, 1e-4, {}, (wrong,)),)),
        Verification(
            (Path(text),),
            (
                Verdict(
                    text,
                    text,
                    "",
                    1,
                    ("", ""),
                    (1e-3, text),
                    (Checked(text, text, text, text, None, text, ok=False, note=text),),
                ),
            ),
        ),
        replace(
            swept(), reasons={text: 1}, failed=1, spans=(replace(span, word=text, units=(text,)),)
        ),
    ]


@cache
def plain_outlines() -> list[Any]:
    """Of the pages of the same objects with a plain text in them."""
    return [Page(html(value)).outline for value in written("plain")]


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_stay_texts(text: str) -> None:
    for value, plain in zip(written(text), plain_outlines(), strict=True):
        page = Page(html(value))
        assert harmless(page), type(value)
        assert page.outline == plain
        alternatives = [each["alt"] or "" for _, each in page.elements if "alt" in each]
        assert any(text in each for each in [*page.texts, *alternatives]) or "\u2028" in text


def test_what_notebooks_show_is_as_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Objects of each kind, without what is in their pictures."""
    monkeypatch.setattr("camgeo_export.plots.render", lambda *_: PNG)
    running = Running(12.0, 1.0, 25.0)
    shown: list[Displayed] = [
        design("cut_lobe").findings, gathered(), swept(),
        laws_of_task("R-R", {}),
        laws_of_task("R-R", {}, ["modified-sine"], running=running),
        laws_of_all_tasks(), compare([(name, design(name)) for name in ("cut_lobe", "tappet")]),
        table_of_scene(design("tappet")), size(design("tappet")), *written("a text"),
    ]  # fmt: skip
    pages = ((type(each).__name__, kept.elements(html(each))) for each in shown)
    kept.compare("export/notebook.txt", pages)


def test_a_design_shows_its_cam_what_it_states_and_what_is_wrong() -> None:
    one = design("cut_lobe")
    page = Page(html(one))
    (image,) = [each for tag, each in page.elements if tag == "img"]
    png = base64.b64decode((image["src"] or "").partition(",")[2])
    assert png == one._repr_mimebundle_()["image/png"] == one._repr_png_()
    assert png == one.plot("cam")._repr_png_()
    assert image["alt"] == "Cam of cut_lobe"
    told = texts(one)
    assert all(finding.sentence in told for finding in one.findings)
    assert "follower: kind = translating-roller, base_radius = " in told


def motion_alone() -> Design:
    values = design("plate_translating").scene.values
    alone = {key: values[key] for key in ("camgeo", "name", "cam", "motion")}
    return Design(camgeo.Scene(alone))


def test_a_motion_alone_is_shown_by_its_diagrams() -> None:
    alone = motion_alone()
    page = Page(html(alone))
    assert [each["alt"] for tag, each in page.elements if tag == "img"] == [
        "Motion of plate_translating"
    ]
    assert repr(alone) == "Design('plate_translating', no follower)"


def test_what_cannot_be_shown_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> Any:
        raise GeometryError("there is <no> such thing", key="follower", value="<b>")

    one = design("plate_translating")
    monkeypatch.setattr("camgeo.pictures.plots.of_design", refuse)
    assert "there is <no> such thing" in texts(one)
    assert "image/png" not in one._repr_mimebundle_()
    assert one._repr_png_() is None
    monkeypatch.setattr("camgeo_export.notebook.display._findings", refuse)
    assert "there is <no> such thing" in texts(one)


def test_a_verdict_is_told_by_sign_and_word_in_colours_of_its_own() -> None:
    unlimited = {"figure": 1.0, "note": None}
    for verdict, (sign, style) in BADGES.items():
        found = Finding("a", "ok", "b", unlimited.get(verdict))
        if verdict not in unlimited:
            found = replace(found, severity=cast("Severity", verdict), limit=2.0)
        assert f"{sign} {MARKS[verdict]} " in texts(found)
        colours = dict(re.findall(r"(background|color):(#[0-9a-f]{3,6})", style))
        assert colours.keys() in ({"background", "color"}, set())
        if colours:
            assert contrast(colours["background"], colours["color"]) >= 4.5
    assert "next step" not in texts(Finding("a", "ok", "b"))
    assert "next step" in texts(Finding("transmission-angle", "broken", "b"))


def contrast(one: str, other: str) -> float:
    """Of two colours, see WCAG 2, relative luminance."""

    def luminance(colour: str) -> float:
        digits = colour[1:] if len(colour) == 7 else "".join(2 * each for each in colour[1:])
        parts = np.array([int(digits[k : k + 2], 16) / 255.0 for k in (0, 2, 4)])
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize(
    "count", [0, 1, FIRST_ROWS + LAST_ROWS + 1, FIRST_ROWS + LAST_ROWS + 2, 360]
)
def test_a_table_shows_its_beginning_and_its_end(count: int) -> None:
    values = np.arange(2.0 * count).reshape(count, 2) - 1.0 / 3.0
    page = html(Table(("a [mm]", "b"), values))
    rows = re.findall(r"<tr>(.*?)</tr>", page)[1:]
    assert len(rows) == min(count, FIRST_ROWS + LAST_ROWS + 1)
    cells = [re.findall("<td>(.*?)</td>", row) for row in rows]
    for row, cell in zip([*values[:1], *values[-1:]], [*cells[:1], *cells[-1:]], strict=True):
        assert cell == [f"{each:.6g}" for each in row]
    assert (["⋮", "⋮"] in cells) == (count > FIRST_ROWS + LAST_ROWS + 1)
    assert f"{count} row" in page


def test_laws_of_a_move_have_its_peaks_too() -> None:
    move = Running(speed=3.0 * math.pi, span=math.radians(90.0), stroke=40.0)
    found = laws_of_task("R-R", {}, ["modified-sine", "straight-line"], running=move)
    told = texts(found)
    assert "a [mm/s^2]" in told
    assert "7960.3" in told  # S (omega/Phi)^2 C_a, C_a = 5.528
    assert render_text(found) in told


def test_written_files_are_shown_with_what_is_proved(tmp_path: Path) -> None:
    one = design("plate_translating")
    found = one.write(tmp_path, ["dxf", "csv"])
    told = texts(found)
    for each in found.files:
        assert f"{each.name} {each.format} {each.size:,}" in told
    assert f"{found.files[0].deviation:.3g} 0.001" in told
    assert str(tmp_path) in told
    passed = verify(found.paths[:-1], scene=SCENES / "plate_translating.toml")
    assert texts(passed).count("✓ pass") == 2
    drawing = tmp_path / "broken.dxf"
    drawing.write_bytes(found.paths[0].read_bytes()[:-20])
    assert "✗ FAIL broken.dxf" in texts(verify((drawing,)))


def test_a_sweep_is_shown_row_by_row() -> None:
    rows = re.findall(r"<tr>(.*?)</tr>", html(swept()))
    assert len(rows) == 3
    assert "motion[2].law" in rows[0]
    assert "modified-sine" in rows[1]
    assert "none" in rows[2]
    assert "must be" in rows[2]
    many = replace(swept(), count=1_000)
    assert "<table" not in html(many)
    assert "least" in texts(many)


def test_answers_with_a_picture_show_it() -> None:
    found = size(design("plate_translating"))
    assert "present design" in texts(found)
    png = found._repr_png_()
    assert png is not None
    assert png.startswith(PNG)
    assert table_of_scene(design("plate_translating"), 30)._repr_png_() is None


def test_plots_are_those_of_the_command(tmp_path: Path) -> None:
    scene = str(SCENES / "plate_translating.toml")
    picture = tmp_path / "a.svg"
    assert main(["plot", scene, "motion", "curvature", "-o", str(picture)]) == 0
    made = design("plate_translating").plot("motion", "curvature")
    assert isinstance(made, matplotlib.figure.Figure)
    assert isinstance(made, Picture)
    made.savefig(tmp_path / "b.png")
    assert (tmp_path / "b.png").read_bytes().startswith(PNG)
    assert saved(made, ".svg") == picture.read_bytes()
    data, told = made._repr_mimebundle_()
    assert data["image/png"] == made._repr_png_()
    assert told["image/png"]["width"] == 7.0 * 96.0
    figure, names = of_design(design("plate_translating"), ("motion", "curvature"))
    assert names == ["motion", "curvature"]
    assert render(figure, ".svg") == picture.read_bytes()
    with pytest.raises(SceneError, match='did you mean "motion"'):
        design("plate_translating").plot("motions")
    with pytest.raises(SceneError, match="names no effect"):
        design("plate_translating").plot("effects")


def test_a_bundle_goes_into_a_notebook_file() -> None:
    bundle = design("plate_translating").findings._repr_mimebundle_()
    assert json.loads(json.dumps(dict(bundle))) == bundle


# The widget: what it hands to its script, and that it is asked for --------------------------------


@pytest.fixture
def translating() -> Design:
    return design("plate_translating")


def test_a_view_has_what_is_drawn_and_the_script_that_draws_it(translating: Design) -> None:
    view = translating.view()
    state = view.get_state()
    assert state["data"] == painted(translating, Recent())
    assert state["_esm"] == bundle("viewer.js")
    assert state["angle"] == 0.0
    assert len(json.dumps(state["data"], allow_nan=False)) < 200_000
    assert "application/vnd.jupyter.widget-view+json" in view._repr_mimebundle_()[0]


def test_its_angle_is_shared_and_within_a_turn(translating: Design) -> None:
    view = translating.view()
    seen: list[float] = []
    view.observe(lambda change: seen.append(change["new"]), "angle")
    for given, within in (
        (123.4, 123.4),
        (360.0, 0.0),
        (-90.0, 270.0),
        (-1e-20, 0.0),
        (725.0, 5.0),
    ):
        view.angle = given
        assert view.angle == within
    view.set_state({"angle": 45.5})  # as the notebook does
    assert view.angle == 45.5
    assert seen == [123.4, 0.0, 270.0, 0.0, 5.0, 45.5]
    for wrong in (float("nan"), float("inf"), "north"):
        with pytest.raises(traitlets.TraitError):
            view.angle = wrong
    assert view.angle == 45.5


def test_another_design_is_shown_at_the_same_angle(translating: Design) -> None:
    view = translating.view()
    view.angle = 30.0
    larger = Design(translating.scene.with_values({"follower.base_radius": 80}))
    view.show(larger)
    assert view.angle == 30.0
    assert view.data == painted(larger, Recent()) != painted(translating, Recent())


def test_a_motion_alone_has_its_diagrams() -> None:
    data = motion_alone().view().data
    assert data["animation"] is None
    assert [each["name"] for each in data["charts"]] == ["motion"]


def test_texts_of_a_scene_are_data_for_a_script_that_makes_no_markup(tmp_path: Path) -> None:
    view = hostile_design(ALL_AT_ONCE, tmp_path).view()
    assert json.loads(json.dumps(view.data)) == view.data
    for word in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("):
        assert word not in bundle("viewer.js")


def test_without_the_library_the_command_that_brings_it_is_named(
    translating: Design, monkeypatch: pytest.MonkeyPatch
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
        viewer(translating)
    assert translating._repr_html_() is not None
    assert translating.plot("motion") is not None
