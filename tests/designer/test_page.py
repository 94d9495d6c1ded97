"""The page of the designer in Chromium: what a person does with it, by pointer and by keyboard.

Without Chromium or playwright these tests are skipped with a word, as is that of axe without
`npm ci` in `export/camgeo_export/browser`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.app.designing.children import Job, Refused
from camgeo.scene.toml import template
from tests.designer.served import Served, computing, served
from tests.judges import axe
from tests.judges.browsing import LONGEST, driven
from tests.judges.chromium import CHROMIUM, SLOW
from tests.judges.chromium_designer import planned, shown
from tests.waiting import PATIENCE

pytest.importorskip("playwright", reason="needs playwright: pip install playwright")

from playwright.sync_api import Browser, ConsoleMessage, Page

pytestmark = pytest.mark.skipif(bool(CHROMIUM.absent()), reason=CHROMIUM.absent() or "is there")

ROOT: Final = Path(__file__).parents[2]
SETZHUB: Final = ROOT / "fixtures" / "scenes" / "setzhub.toml"
VORSCHUB: Final = SETZHUB.with_name("vorschub.toml")

WIDTHS: Final = (375, 1440, 2560)
"""Of windows [CSS px]: a telephone, a laptop, a large screen."""

VIOLATIONS: Final = """async () => {
  const found = await axe.run(document);
  return found.violations.map((each) => `${each.id}: ${each.nodes[0].html}`);
}"""

PASTE: Final = """(text) => {
  const data = new DataTransfer();
  data.setData("text/plain", text);
  const area = document.getElementById("text-area");
  area.select();
  const given = { clipboardData: data, bubbles: true, cancelable: true };
  if (area.dispatchEvent(new ClipboardEvent("paste", given))) throw new Error("not taken");
}"""
"""Pastes a text over all that is there, as Ctrl+V does."""

SIZES: Final = """(all) => all.map((each) => each.getBoundingClientRect())
  .map(({ width, height }) => Math.min(width, height))"""
"""The smaller size of each handle [CSS px]."""

HIDDEN: Final = """() => new Promise((done) => setTimeout(() => {
  const handles = [...document.querySelectorAll("[data-space=mechanism]")];
  const hit = handles.map((each) => {
    const { x, y, width, height } = each.getBoundingClientRect();
    const places = [[0.5, 0.5], [0.2, 0.2], [0.8, 0.2], [0.2, 0.8], [0.8, 0.8]];
    return places.map(([a, b]) => [x + a * width, y + b * height])
      .every(([u, v]) => document.elementFromPoint(u, v) === each);
  });
  done([handles.length, handles.filter((_, k) => !hit[k]).map((each) => each.dataset.name)]);
}, 100))"""
"""How many handles the mechanism has, and which of them are covered, once they are laid out."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with driven(LONGEST) as program:
        yield program


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Served]:
    """One with the Setzhub cam."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "cam.toml").write_bytes(SETZHUB.read_bytes())
    with served(folder, "cam.toml", computing()) as each:
        yield each


@pytest.fixture
def page(browser: Browser, server: Served) -> Iterator[Page]:
    """The designer, which says nothing on the console and asks nothing of other hosts."""
    context = browser.new_context(viewport={"width": WIDTHS[1], "height": 900})
    context.set_default_timeout(1e3 * PATIENCE)
    opened = context.new_page()
    said: list[str] = []
    opened.on("console", lambda message: said.append(_said(message)))
    opened.on("pageerror", lambda error: said.append(str(error)))
    strange: list[str] = []
    opened.on("request", lambda asked: strange.append(asked.url))
    opened.goto(f"http://{server.host}/?token={server.keys.lend()}")
    opened.wait_for_selector("html[data-ready=true]")
    opened.wait_for_function("() => camgeo.session.findings !== null")
    yield opened
    context.close()
    assert not [each for each in said if each]
    assert not [each for each in strange if not each.startswith(f"http://{server.host}/")]


def _said(message: ConsoleMessage) -> str:
    return "" if SLOW in message.text else f"{message.type}: {message.text}"


def settled(page: Page, revision: int = 0) -> int:
    """The revision that is painted, once it is later than `revision` and nothing waits."""
    page.wait_for_function(
        "(old) => camgeo.session.revision > old && !camgeo.session.waits", arg=revision
    )
    return int(page.evaluate("camgeo.session.revision"))


def test_a_keyboard_plans_edits_undoes_saves_and_builds(browser: Browser, server: Served) -> None:
    """The pointer is used in `tests/judges/test_designer.py`."""
    with shown(browser, server.host, f"/?token={server.keys.lend()}") as found:
        planned(found, server.desk.folder)


@pytest.mark.skipif(not axe.kept(), reason="axe-core is not there: npm ci")
def test_axe_finds_nothing_and_every_width_holds_it(page: Page) -> None:
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        page.emulate_media(color_scheme="dark" if width == WIDTHS[0] else "light")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.evaluate(axe.script())
        assert page.evaluate(VIOLATIONS) == []


def test_texts_of_a_scene_stay_texts(page: Page, server: Served) -> None:
    old = settled(page, -1)
    hostile = '</script><img src=x onerror="camgeo.bad = 1">'
    page.get_by_label("scene, name", exact=True).fill(hostile)
    page.keyboard.press("Enter")
    settled(page, old)
    written = hostile.replace('"', '\\"')
    page.wait_for_function(
        "(text) => document.getElementById('text-area').value.includes(text)", arg=written
    )
    page.wait_for_selector("#faults:not([hidden])")
    assert page.evaluate("[camgeo.bad ?? null, document.images.length]") == [None, 0]


def test_what_draws_solids_is_loaded_when_one_is_shown(page: Page) -> None:
    assert page.locator("script[src='solid.js']").count() == 0
    page.click("#show-solid")
    page.wait_for_selector("#solid canvas[data-view]")
    assert page.locator("script[src='solid.js']").count() == 1


def test_handles_do_not_cover_each_other(page: Page) -> None:
    """Rim and centre of a roller that is small on the screen, and a crank that meets the centre."""
    page.set_viewport_size({"width": WIDTHS[0], "height": 900})
    for path, count in ((SETZHUB, 6), (VORSCHUB, 6)):
        old = settled(page, -1)
        text = path.read_text("utf-8") + "\n"
        page.evaluate("(text) => camgeo.session.write(text, 'test')", text)
        settled(page, old)
        page.locator("#mechanism .picture").scroll_into_view_if_needed()
        assert round(min(page.eval_on_selector_all(".handle", SIZES)), 3) >= 24.0
        assert page.evaluate(HIDDEN) == [count, []]


def test_what_is_built_again_is_listed_again(page: Page) -> None:
    """Links to the files of an earlier build lead nowhere."""
    boxes = page.locator(".build input")
    for name in ("csv", "svg"):
        for box in boxes.all():
            box.set_checked(box.get_attribute("value") == name)
        page.click("#build-files")
        page.wait_for_selector(f".build a[download$='.{name}']")
        assert page.locator(".build a[download]").count() == 2  # with the certificate


def test_a_scene_with_faults_is_not_told_to_be_well(page: Page) -> None:
    verdict = page.locator("a.verdict")
    text = page.locator("#text-area")
    stated = text.input_value()
    old = settled(page, -1)
    text.fill(stated.replace("roller_radius = 7", "roller_radius = -7"))
    old = settled(page, old)
    assert verdict.inner_text() == "✗ The scene has a fault."
    assert verdict.get_attribute("href") == "#text"
    text.fill(stated)
    settled(page, old)
    page.wait_for_selector("a.verdict.warning")  # its keyway is to be broached
    assert verdict.get_attribute("href") == "#findings"


def test_what_is_no_verdict_has_no_sign_of_one(page: Page) -> None:
    """A figure and a note stand among what is kept, without its sign and its colour."""
    shown = page.locator(".finding strong")
    told = {each.rpartition(" ")[::2] for each in shown.all_text_contents()}
    signs = {("✓", "ok"), ("!", "warning"), ("=", "figure"), ("–", "note")}
    assert {("✓", "ok"), ("=", "figure")} <= told <= signs
    assert set(page.locator(".severity.ok").all_text_contents()) == {"✓ ok"}


def test_a_scene_that_only_its_findings_refuse_is_red_at_its_field(page: Page) -> None:
    """A compression spring on a rocker without ends: its curves have no fault."""
    old = settled(page, -1)
    text = template("oscillating-roller") + "[effects.spring]\nstiffness = 5\npreload = 200\n"
    page.evaluate("(text) => camgeo.session.write(text, 'test')", text)
    settled(page, old)
    verdict = page.locator("a.verdict")
    assert verdict.get_attribute("class") in ("verdict waiting", "verdict invalid")
    page.wait_for_selector("a.verdict.invalid")
    assert verdict.inner_text() == "✗ The scene has a fault."
    field = page.locator("[data-key='effects.spring.anchor']")
    assert field.get_attribute("aria-invalid") == "true"
    line = text[: text.index("[effects.spring]\nstiffness = 5")].count("\n") + 1
    page.wait_for_function(
        "(line) => document.getElementById('faults').textContent.includes(`Line ${line}`)", arg=line
    )


def test_findings_that_do_not_come_are_not_green(browser: Browser, tmp_path: Path) -> None:
    folder, inner = tmp_path / "slow", computing()
    folder.mkdir()
    (folder / "cam.toml").write_bytes(SETZHUB.read_bytes())

    def slow(job: Job, most: float) -> Mapping[str, Any]:
        if job.kind == "findings":
            raise Refused(f"findings: took longer than {most:g} s")
        return inner(job, most)

    with served(folder, "cam.toml", slow) as server:
        opened = browser.new_page()
        opened.set_default_timeout(1e3 * PATIENCE)
        opened.goto(f"http://{server.host}/?token={server.keys.lend()}")
        opened.wait_for_selector("a.verdict.unknown")
        assert "took longer than 60 s" in opened.locator("a.verdict").inner_text()
        assert opened.locator(".findings .sentence").inner_text().startswith("There is no verdict")
        opened.close()


def test_a_long_text_is_pasted_at_once(page: Page, server: Served) -> None:
    """The browser's own way of pasting takes a minute for it."""
    old = settled(page, -1)
    text = SETZHUB.read_text("utf-8") + "# a line\n" * 3000
    page.evaluate(PASTE, text)
    settled(page, old)
    assert server.desk.text == text
