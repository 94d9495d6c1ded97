"""Notebooks and reports: HTML in which every text stays a text, pictures, and the widget."""

from __future__ import annotations

import base64
import builtins
import hashlib
import io
import json
import re
from collections import Counter
from dataclasses import replace
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, cast
from unittest.mock import Mock

import matplotlib.figure
import numpy as np
import pytest
import traitlets
import trimesh

import camgeo
from camgeo.app.answers.answer import MARKS
from camgeo.app.answers.compare import compare
from camgeo.app.answers.laws import laws_of_all_tasks, laws_of_task
from camgeo.app.answers.refusal import refusal
from camgeo.app.answers.report import Report, report
from camgeo.app.answers.size import size
from camgeo.app.answers.sweep import Sweep, answer_of
from camgeo.app.answers.table import ValueTable, table_of_scene
from camgeo.app.answers.verify import FileVerdict, Verification, verify
from camgeo.app.cli.main import main
from camgeo.app.designing.work import Recent, painted
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
from camgeo.record import Displayed
from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.sweep.family import family_of
from camgeo.studies.sweep.sweep import sweep
from camgeo_export.browser.bundles import bundle
from camgeo_export.notebook.display import BADGES, FIRST_ROWS, LAST_ROWS
from camgeo_export.notebook.viewer import viewer
from camgeo_export.plots import Picture, page_bytes
from camgeo_export.report import DIGITS
from camgeo_export.report import render as page_of
from tests import kept
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, Page, harmless, hostile_design
from tests.imported import imported_anew
from tests.long_form import LONG

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
        replace(told, charts=(chart,), omissions=(text,)),
        replace(figure, texts=(Text(text, (0.5, 0.5), 8.0, "figure"),), rows=(), panels=()),
        refusal(SceneError([camgeo.Fault(text, text, text, text)], text)),
        Written((Path(text),), (FileReport(text, text, 1, 1e-3, 1e-4, {}, (wrong,)),)),
        Verification(
            (Path(text),),
            (
                FileVerdict(
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
    error = GeometryError("there is <no> such thing", key="follower", value="<b>")
    refuse = Mock(side_effect=error)
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
    assert page_bytes(made, ".svg") == picture.read_bytes()
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
    assert (state["data"], state["_esm"], state["angle"]) == (
        painted(translating, Recent()),
        bundle("viewer.js"),
        0.0,
    )
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
    cure = r'install it with `pip install "camgeo\[notebook\]"`'
    with (
        imported_anew("camgeo_export.notebook.widget".__eq__),
        pytest.raises(CamgeoError, match=cure),
    ):
        viewer(translating)
    assert translating._repr_html_() is not None
    assert translating.plot("motion") is not None


# Reports ------------------------------------------------------------------------------------------
# The page of a report: one file, the same bytes, nothing loaded, no text read as markup.


MOST = 2_000_000
"""Bytes of the page of a scene with all that it may have."""


@cache
def made(name: str) -> Report:
    return report(Design(load_scene(SCENES / f"{name}.toml")), quick=True)


def within(page: bytes, tag: str) -> list[str]:
    """What is in the elements of that name."""
    return re.findall(rf"<{tag}[^>]*>(.*?)</{tag}>", page.decode(), re.DOTALL)


def data(page: bytes) -> Any:
    return json.loads(within(page, "script")[0])


def test_the_page_of_setzhub_has_everything_in_one_small_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With price list and certificate, for which the files are made."""
    monkeypatch.setattr(
        "camgeo.app.answers.report.TOLERANCES", (1e-1, 1e-2)
    )  # finer ones take long
    coarse = {"output.tolerance": 0.05, "output.fit": "fast"}
    scene = load_scene(SCENES / "setzhub.toml")
    whole = report(Design(scene if LONG else scene.with_values(coarse)))
    assert whole.certificate is not None
    formats = {each["format"] for each in whole.certificate["files"]}
    assert formats == set(whole.scene.output.formats)
    assert whole.certified == whole.scene.made
    assert whole.prices is not None
    assert whole.prices.knee is not None
    assert not whole.omissions
    page = page_of(whole)
    assert len(page) < MOST
    found = Page(page.decode())
    identifiers = [each["id"] for _, each in found.elements if each.get("id")]
    assert len(set(identifiers)) == len(identifiers)
    wanted = {"mechanism", "prices", "chart-0", "solid-0", "certificate-section"}
    assert wanted <= set(identifiers)
    if LONG:
        assert page_of(report(Design(scene))) == page


def test_the_same_scene_gives_the_same_bytes(tmp_path: Path) -> None:
    scene = str(SCENES / "plate_translating.toml")
    pages = [tmp_path / "a.html", tmp_path / "b.html"]
    for page in pages:
        assert main(["report", scene, "--quick", "-o", str(page)]) == 0
    assert pages[0].read_bytes() == pages[1].read_bytes() == page_of(made("plate_translating"))


def test_pages_are_as_kept() -> None:
    """Without the data of charts and solids, which are those of the report."""
    names = ("plate_translating", "four_bar")
    pages = ((name, kept.elements(page_of(made(name)).decode())) for name in names)
    kept.compare("export/report.txt", pages)


def require_quiet(page: Page) -> None:
    """That a page of a report loads nothing, leads nowhere, and runs nothing of its elements."""
    for tag, attributes in page.elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")


def test_nothing_is_loaded_and_only_the_own_script_and_style_run() -> None:
    page = page_of(made("setzhub"))
    found = Page(page.decode())
    require_quiet(found)
    (policy,) = [each["content"] for tag, each in found.elements if each.get("http-equiv")]
    assert policy is not None
    assert policy.startswith("default-src 'none'; ")
    assert "unsafe" not in policy
    _, *scripts = within(page, "script")
    assert scripts == [bundle("report.js"), bundle("solid.js")]
    assert within(page, "style") == [bundle("report.css")]
    for kind, texts in (("script", scripts), ("style", [bundle("report.css")])):
        digests = [hashlib.sha256(text.encode()).digest() for text in texts]
        hashes = [f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests]
        assert f"; {kind}-src {' '.join(hashes)}; " in policy


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_texts_stay_texts(text: str) -> None:
    plain = made("plate_translating")
    (first, *_), (chart, *_) = plain.advised, plain.charts
    finding = replace(first.finding, name=text, sentence=text)
    figure = replace(chart.figure, texts=(Text(text, (0.5, 0.5), 8.0, "figure"),))
    wrong = replace(
        chart, title=text, figure=figure, readings=(replace(chart.readings[0], name=text),)
    )
    advice = replace(first, subject=text, finding=finding, step=text)
    page = page_of(replace(plain, advised=(advice,), charts=(wrong,), omissions=(text,)))
    usual = page_of(replace(plain, advised=(first,), omissions=("none",),
                           charts=(replace(chart, readings=chart.readings[:1]),)))  # fmt: skip
    found = Page(page.decode())
    assert found.outline == Page(usual.decode()).outline
    assert found.texts.count(text) >= 4
    assert data(page)["charts"][0]["figure"]["texts"][-1]["text"] == text


def test_the_solid_is_that_of_the_stl_file() -> None:
    """All corners, in single floats, as a body within the coarse tolerance has them."""
    found = made("setzhub")
    ((name, stl),) = found.solids.items()
    assert name == "setzhub.stl"
    (drawn,) = data(page_of(found))["solids"]
    places = np.frombuffer(base64.b64decode(drawn["places"]), "<f4").reshape(-1, 3)
    mesh = trimesh.load_mesh(io.BytesIO(stl), file_type="stl")
    assert len(places) == 3 * len(mesh.faces)
    assert np.array_equal([places.min(axis=0), places.max(axis=0)], mesh.bounds.astype("<f4"))


def test_a_part_without_thickness_has_no_solid_and_says_so() -> None:
    scene = load_scene(SCENES / "setzhub.toml")
    part = {key: value for key, value in scene.values["part"].items() if key != "thickness"}
    rest = {key: value for key, value in scene.values.items()
            if key in ("camgeo", "name", "cam", "motion", "follower", "linkage")}  # fmt: skip
    found = report(Design(Scene({**rest, "part": part})), quick=True)
    assert not found.solids
    assert within(page_of(found), "script")[1:] == [bundle("report.js")]
    assert any(each.startswith("solid: ") and "thickness" in each for each in found.omissions)


def test_numbers_of_diagrams_are_exact_enough_to_be_drawn() -> None:
    found = made("plate_translating")
    line = max(found.charts[0].figure.panels[-1].marks, key=lambda m: len(getattr(m, "points", ())))
    points = line.points  # type: ignore[union-attr]  # the mark with the most points
    panel = data(page_of(found))["charts"][0]["figure"]["panels"][-1]
    written = max((mark["points"] for mark in panel["marks"] if "points" in mark), key=len)
    assert len(written) == len(points)
    for mine, theirs in zip(written, points.tolist(), strict=True):
        assert mine == pytest.approx(theirs, rel=10.0 ** (1 - DIGITS))


def test_the_scripts_draw_every_kind_of_mark_that_reports_have() -> None:
    """One that they did not know would stop the page."""
    script = files("camgeo_export.browser").joinpath("src", "marks.ts").read_text("utf-8")
    known = set(re.findall(r"case \"(\w+)\":", script))
    assert known == {"line", "rule", "band", "area", "circle", "text"}
    drawn = data(page_of(made("cut_lobe")))
    marks = [*drawn["animation"]["turning"]]
    for chart in drawn["charts"]:
        marks += chart["figure"]["texts"]
        marks += [mark for panel in chart["figure"]["panels"] for mark in panel["marks"]]
    assert {mark["kind"] for mark in marks} <= known


# A scene of hostile texts: they stay texts in notebooks, and on the page of a report --------------


@pytest.mark.parametrize("text", [ALL_AT_ONCE, *(HOSTILE if LONG else ())])
def test_every_free_text_of_a_scene_stays_a_text(text: str, tmp_path: Path) -> None:
    design = hostile_design(text, tmp_path)
    found = report(design, quick=True)
    assert found.check.machining is not None
    assert text in {each.name for each in design.scene.milling.tools}  # type: ignore[union-attr]  # it has tools
    shown: list[Displayed] = [design, found.check, found, design.effect("inertia")]
    for each in shown:
        html = each._repr_html_()
        assert html is not None
        assert harmless(Page(html)), type(each)
        assert "alert(1)" not in repr(each)
    page = Page(page_of(found).decode())
    tags = Counter(tag for tag, _ in page.elements)
    scripts = 3 if found.solids else 2  # the data, what draws figures, what draws solids
    assert (tags["script"], tags["style"]) == (scripts, 1)
    require_quiet(page)


def test_a_page_that_escaped_nothing_would_be_found() -> None:
    assert not harmless(Page(f"<p>{ALL_AT_ONCE}</p>"))
    assert harmless(Page(f"<p>{escape(ALL_AT_ONCE)}</p>"))
    assert not harmless(Page('<img src="https://camgeo.example/x.png">'))
    assert not harmless(Page("<p onclick=alert(1)>"))
    assert harmless(Page('<img alt="a" src="data:image/png;base64,AA">'))
