"""The page of a report: one file, the same bytes, nothing loaded, no text read as markup."""

from __future__ import annotations

import base64
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
from typing import Any

import numpy as np
import pytest
import trimesh

from camgeo.app.answers.report import Report, report
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.pictures.model import Text
from camgeo.record import Displayed
from camgeo.scene.scene import Scene, load_scene
from camgeo_export.browser.bundles import bundle
from camgeo_export.report import DIGITS, render
from tests import kept
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, Page, harmless, hostile_design
from tests.long_form import LONG

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

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
    assert not whole.left_out
    page = render(whole)
    assert len(page) < MOST
    found = Page(page.decode())
    identifiers = [each["id"] for _, each in found.elements if each.get("id")]
    assert len(set(identifiers)) == len(identifiers)
    wanted = {"mechanism", "prices", "chart-0", "solid-0", "certificate-section"}
    assert wanted <= set(identifiers)
    if LONG:
        assert render(report(Design(scene))) == page


def test_the_same_scene_gives_the_same_bytes(tmp_path: Path) -> None:
    scene = str(SCENES / "plate_translating.toml")
    pages = [tmp_path / "a.html", tmp_path / "b.html"]
    for page in pages:
        assert main(["report", scene, "--quick", "-o", str(page)]) == 0
    assert pages[0].read_bytes() == pages[1].read_bytes() == render(made("plate_translating"))


def test_pages_are_as_kept() -> None:
    """Without the data of charts and solids, which are those of the report."""
    names = ("plate_translating", "four_bar")
    pages = ((name, kept.elements(render(made(name)).decode())) for name in names)
    kept.compare("export/report.txt", pages)


def test_nothing_is_loaded_and_only_the_own_script_and_style_run() -> None:
    page = render(made("setzhub"))
    found = Page(page.decode())
    for tag, attributes in found.elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form")
        assert not {"src", "srcset", "style"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")
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
    page = render(replace(plain, advised=(replace(first, about=text, finding=finding, step=text),),
                          charts=(wrong,), left_out=(text,)))  # fmt: skip
    usual = render(replace(plain, advised=(first,), left_out=("none",),
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
    (drawn,) = data(render(found))["solids"]
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
    assert within(render(found), "script")[1:] == [bundle("report.js")]
    assert any(each.startswith("solid: ") and "thickness" in each for each in found.left_out)


def test_numbers_of_diagrams_are_exact_enough_to_be_drawn() -> None:
    found = made("plate_translating")
    line = max(found.charts[0].figure.panels[-1].marks, key=lambda m: len(getattr(m, "points", ())))
    points = line.points  # type: ignore[union-attr]  # the mark with the most points
    panel = data(render(found))["charts"][0]["figure"]["panels"][-1]
    written = max((mark["points"] for mark in panel["marks"] if "points" in mark), key=len)
    assert len(written) == len(points)
    for mine, theirs in zip(written, points.tolist(), strict=True):
        assert mine == pytest.approx(theirs, rel=10.0 ** (1 - DIGITS))


def test_the_scripts_draw_every_kind_of_mark_that_reports_have() -> None:
    """One that they did not know would stop the page."""
    script = files("camgeo_export.browser").joinpath("src", "marks.ts").read_text("utf-8")
    known = set(re.findall(r"case \"(\w+)\":", script))
    assert known == {"line", "rule", "band", "area", "circle", "text"}
    drawn = data(render(made("cut_lobe")))
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
    page = Page(render(found).decode())
    tags = Counter(tag for tag, _ in page.elements)
    scripts = 3 if found.solids else 2  # the data, what draws figures, what draws solids
    assert (tags["script"], tags["style"], tags["link"], tags["img"]) == (scripts, 1, 0, 0)
    for tag, attributes in page.elements:
        assert not any(name.startswith("on") or name == "src" for name in attributes)
        assert (attributes.get("href") or "#").startswith("#"), tag


def test_a_page_that_escaped_nothing_would_be_found() -> None:
    assert not harmless(Page(f"<p>{ALL_AT_ONCE}</p>"))
    assert harmless(Page(f"<p>{escape(ALL_AT_ONCE)}</p>"))
    assert not harmless(Page('<img src="https://camgeo.example/x.png">'))
    assert not harmless(Page("<p onclick=alert(1)>"))
    assert harmless(Page('<img alt="a" src="data:image/png;base64,AA">'))
