"""The judge of the designer's page passes one that is right, and refuses one that is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.app.designing import work
from camgeo.app.designing.edits import Changed, changed
from tests.designer.conftest import MISSING
from tests.judges import axe, browsing
from tests.judges.chromium_designer import DesignerPage, look, painted, shown, used
from tests.judges.programs_of_others import Refusal

if MISSING:
    pytest.skip(f"needs {', '.join(MISSING)}: the extra design", allow_module_level=True)
if browsing.missing():
    pytest.skip(browsing.missing(), allow_module_level=True)

from playwright.sync_api import Browser

from tests.designer.served import Served, computing, served

NAME: Final = "cam.toml"

COMMENT: Final = "  # seen from above"

SCENE: Final = f"""# A small cam.
camgeo = 1
name = "small"
[cam]
rotation = "ccw"{COMMENT}
[follower]
kind = "translating-roller"
base_radius = 30
roller_radius = 5
[[motion]]
dwell = 120
[[motion]]
law = "polynomial-345"
span = 120
to = 5
[[motion]]
law = "polynomial-345"
span = 120
to = 0
[part]
thickness = 5
bore = 10
[output]
formats = ["csv"]
"""

SHIFTED: Final = r"""() => {
  for (const each of document.querySelectorAll("#mechanism .turning path")) {
    const path = each.getAttribute("d");
    each.setAttribute("d", path.replace(/[\d.]+(?=Z|$)/g, (place) => Number(place) + 1));
  }
}"""
"""Moves one place of each curve by a point."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with browsing.driven(browsing.LONGEST) as program:
        yield program


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Served]:
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / NAME).write_text(SCENE, "utf-8")
    with served(folder, None, computing()) as each:
        yield each


@pytest.fixture
def page(browser: Browser, server: Served) -> Iterator[DesignerPage]:
    with shown(browser, server.host, f"/?token={server.keys.lend()}") as found:
        yield found


def run(browser: Browser, server: Served, script: str, **window: Any) -> None:
    """A visit of a page that runs a script which is not its own."""
    with shown(browser, server.host, f"/?token={server.keys.lend()}", **window) as found:
        found.visit.page.evaluate(script)


def test_a_right_page_passes(page: DesignerPage, server: Served) -> None:
    seen = used(page, server.desk.folder, NAME)
    assert (seen.scenes, seen.dragged, seen.files) == (1, 1, 2)
    assert 0.0 < seen.share < 1.0


def test_a_curve_that_is_painted_elsewhere_is_refused(page: DesignerPage, server: Served) -> None:
    page.open(NAME)
    painted(page, server.desk.folder / NAME)
    page.visit.page.evaluate(SHIFTED)
    with pytest.raises(Refusal, match=r"outline is not painted within 0\.0\d+ mm"):
        painted(page, server.desk.folder / NAME)


def test_a_file_with_another_byte_is_refused(
    page: DesignerPage, server: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    get = server.session.files.get

    def wrong(name: str, build: str) -> bytes | None:
        data = get(name, build)
        return data if data is None or name == "certificate.json" else data[:-2] + b"0\n"

    monkeypatch.setattr(server.session.files, "get", wrong)
    with pytest.raises(Refusal, match=r"small\.csv: not as camgeo build writes it"):
        used(page, server.desk.folder, NAME)


def test_a_lost_comment_is_refused(
    page: DesignerPage, server: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrong(*given: Any) -> Changed:
        found = changed(*given)
        return replace(found, text=found.text.replace(COMMENT, ""))

    monkeypatch.setattr(work, "changed", wrong)
    with pytest.raises(Refusal, match="a comment is lost"):
        used(page, server.desk.folder, NAME)


def test_a_request_to_another_host_is_refused(browser: Browser, server: Served) -> None:
    """The page's own policy does not even let it ask."""
    asked = "fetch('http://127.0.0.2:9/').catch(() => 0)"
    with pytest.raises(Refusal, match="Content Security Policy"):
        run(browser, server, asked)
    with pytest.raises(Refusal, match=r"it asks for http://127\.0\.0\.2:9/"):
        run(browser, server, asked, bypass_csp=True)


def test_an_error_on_the_console_is_refused(browser: Browser, server: Served) -> None:
    with pytest.raises(Refusal, match="error: spilt"):
        run(browser, server, "console.error('spilt')")


@pytest.mark.skipif(not axe.kept(), reason="axe-core is not there: npm ci")
def test_what_axe_finds_is_refused(page: DesignerPage) -> None:
    look(page.visit, 1280)
    page.visit.page.evaluate("document.querySelector('#save').textContent = ''")
    with pytest.raises(Refusal, match=r'button-name: <button.* id="save"'):
        look(page.visit, 1280)


def test_a_page_that_is_too_wide_is_refused(page: DesignerPage) -> None:
    page.visit.page.evaluate("document.body.style.width = '1300px'")
    with pytest.raises(Refusal, match="the page is 1300 px wide"):
        look(page.visit, 1280)


def test_what_does_not_come_is_not_waited_for(page: DesignerPage) -> None:
    with pytest.raises(Refusal, match=r"the moon: not within 0\.1 s"):
        page.visit.ask("the moon", "() => false", most=0.1)
    with pytest.raises(Refusal, match=r"the moon: not within 0\.1 s"):
        page.visit.until("the moon", lambda: False, 0.1)


def test_a_browser_that_does_not_answer_is_ended(browser: Browser) -> None:
    with (
        pytest.raises(Refusal, match="it has not ended within 3 s"),
        browsing.launched(browser.browser_type, 3.0) as other,
    ):
        other.new_page().evaluate("() => { for (;;); }")
