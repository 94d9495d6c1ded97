"""What notebooks show: HTML in which every text stays a text, and pictures."""

from __future__ import annotations

import base64
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
from camgeo.app.answers.verify import Verification, verify
from camgeo.app.cli.main import main
from camgeo.check.finding import Finding, Findings, Severity
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.design.verify import Check as Checked
from camgeo.design.verify import Verdict
from camgeo.design.writing import FileReport
from camgeo.design.writing import Report as Written
from camgeo.errors import GeometryError, SceneError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.laws.comparison import Running
from camgeo.pictures.model import Text
from camgeo.record import Displayed
from camgeo.studies.sweep.family import family_of
from camgeo.studies.sweep.sweep import sweep
from camgeo_export.notebook.display import BADGES, FIRST_ROWS, LAST_ROWS
from camgeo_export.plots import Picture, render
from tests import kept
from tests.hostile_scene import HOSTILE, Page, harmless

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


@pytest.mark.long  # the test above has its page, those below its picture
def test_a_design_shows_its_cam_what_it_states_and_what_is_wrong() -> None:
    one = design("cut_lobe")
    bundle = one._repr_mimebundle_()
    page = Page(html(one))
    (image,) = [each for tag, each in page.elements if tag == "img"]
    png = base64.b64decode((image["src"] or "").partition(",")[2])
    assert png == bundle["image/png"] == one._repr_png_()
    assert png == one.plot("cam")._repr_png_()
    assert image["alt"] == "Cam of cut_lobe"
    told = texts(one)
    for finding in one.findings:
        assert finding.sentence in told
    assert "follower: kind = translating-roller, base_radius = " in told
    wrong = [each for each in one.findings if each.severity != "ok"]
    assert told.index(wrong[0].sentence) < told.index("ok the" if "ok the" in told else " ok")


def test_a_motion_alone_is_shown_by_its_diagrams(tmp_path: Path) -> None:
    values = {key: value for key, value in design("plate_translating").scene.values.items()
              if key in ("camgeo", "name", "cam", "motion")}  # fmt: skip
    alone = Design(camgeo.Scene(values))
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


@pytest.mark.long  # test_what_notebooks_show_is_as_kept has such a page
def test_laws_are_shown_with_their_values_and_curves() -> None:
    law = make_law("modified-sine", "R-R")
    assert "modified-sine" in texts(law)
    assert "1.7596" in texts(law)  # C_v, VDI 2143-1, Tafel 4
    several = html(laws_of_task("R-R", {}, ["straight-line", "scca"]))
    assert "unbounded" in several
    assert several.count("<img") == 1
    tasks = laws_of_all_tasks()
    assert "rest to rest" in texts(tasks)
    assert "image/png" not in tasks._repr_mimebundle_()


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


@pytest.mark.long  # test_what_notebooks_show_is_as_kept has such a page
def test_designs_side_by_side_have_what_differs_and_their_findings() -> None:
    small = Design(design("plate_translating").scene.with_values({"follower.base_radius": 30}))
    found = compare([("as it is", design("plate_translating")), ("small", small)])
    page = html(found)
    (head, *rows) = [
        [Page(cell).texts for cell in re.findall(r"<t[hd].*?>(.*?)</t[hd]>", row)]
        for row in re.findall(r"<tr>(.*?)</tr>", page)
    ]
    assert head == [[], ["as it is"], ["small"]]
    assert [["follower.base_radius"], ["50"], ["30"]] in rows
    assert [["verdict"], ["✓ ok"], ["✗ BROKEN"]] in rows
    (angle,) = [row for row in rows if row[0] == ["transmission-angle"]]
    assert angle[1] == ["63.0337 deg"]
    assert angle[2][-1] == "✗ BROKEN"
    assert page.count("<img") == 1


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
    from camgeo.pictures.plots import of_design
    from camgeo_export.plots import saved

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
