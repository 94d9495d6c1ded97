"""A scene of hostile texts: they stay texts in notebooks, and on the page of a report."""

from __future__ import annotations

from collections import Counter
from html import escape
from pathlib import Path

import pytest

from camgeo.app.answers.report import report
from camgeo.record import Displayed
from camgeo_export.report import render
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, Page, harmless, hostile_design
from tests.long_form import LONG


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
