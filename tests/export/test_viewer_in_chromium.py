"""The widget's script in Chromium: the cam angle goes both ways, and hostile texts stay texts.

Without Chromium or playwright these tests are skipped with a word, as is that of axe without
`npm ci` in `export/camgeo_export/browser`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

import camgeo
from camgeo.app.designing.work import Recent, painted
from camgeo_export.browser.bundles import bundle
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE
from tests.judges import axe
from tests.judges.chromium import CHROMIUM, launched
from tests.long_form import LONG
from tests.waiting import PATIENCE

pytest.importorskip("playwright", reason="needs playwright: pip install playwright")

from playwright.sync_api import Browser, Dialog, Page

pytestmark = pytest.mark.skipif(bool(CHROMIUM.absent()), reason=CHROMIUM.absent() or "is there")

ROOT: Final = Path(__file__).parents[2]
NOTEBOOK: Final = """async ([data, script]) => {
  const listeners = {};
  const told = (name) => (listeners[`change:${name}`] ?? []).slice().forEach((each) => each());
  window.state = { data, angle: 45 };
  window.saved = [];
  window.model = {
    get: (name) => state[name],
    set: (name, value) => { if (state[name] !== value) { state[name] = value; told(name); } },
    save_changes: () => saved.push(state.angle),
    on: (name, listener) => (listeners[name] ??= []).push(listener),
    off: (name, listener) => {
      listeners[name] = (listeners[name] ?? []).filter((each) => each !== listener);
    },
  };
  const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  window.end = (await import(address)).default.render({ model, el: output });
  window.view = output.lastElementChild.shadowRoot;
  window.listening = () => Object.values(listeners).flat().length;
}"""
"""A notebook, as the script sees it: a model, and an element for it."""

BODY: Final = '<body><main><h1>notebook</h1><div id="output"></div></main></body>'

FREE: Final = ("title", "sentence", "name", "low", "high", "text", "label", "note")
"""Keys of the data that hold texts to be read."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched() as program:
        yield program


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """One that ends without a complaint of the browser, and without a dialog."""
    wrong: list[str] = []

    def refuse(dialog: Dialog) -> None:
        wrong.append(dialog.message)
        dialog.dismiss()

    opened = browser.new_page(viewport={"width": 900, "height": 700})
    opened.set_default_timeout(1e3 * PATIENCE)
    opened.on("console", lambda message: wrong.append(message.text))
    opened.on("pageerror", lambda error: wrong.append(str(error)))
    opened.on("dialog", refuse)
    opened.set_content(f'<!DOCTYPE html><html lang="en"><title>notebook</title>{BODY}')
    yield opened
    opened.close()
    assert wrong == []


@cache
def data() -> dict[str, Any]:
    return painted(camgeo.load(ROOT / "fixtures" / "scenes" / "plate_translating.toml"), Recent())


def show(page: Page, drawn: dict[str, Any]) -> None:
    page.evaluate(NOTEBOOK, [drawn, bundle("viewer.js")])


def test_the_cam_angle_is_that_of_python_and_that_of_the_page(page: Page) -> None:
    show(page, data())
    field = "view.querySelector('input[type=number]')"
    turned = "view.querySelector('.turning').getAttribute('transform')"
    assert page.evaluate(f"{field}.value") == "45.0"
    before = page.evaluate(turned)
    page.evaluate("model.set('angle', 123.4)")
    assert page.evaluate(f"{field}.value") == "123.4"
    assert page.evaluate(turned) != before
    assert page.evaluate("saved") == []  # Python is not told what it has said
    page.evaluate(f"{field}.value = '210'; {field}.dispatchEvent(new Event('input'))")
    assert page.evaluate("[state.angle, saved]") == [210, [210]]
    play = "view.querySelector('button').click()"
    page.evaluate(f"window.began = performance.now(); {play}")
    page.wait_for_function("saved.length > 4")
    told, passed = page.evaluate("[saved.length - 1, performance.now() - began]")
    page.evaluate(play)
    assert told <= 1 + passed / 100  # ten times a second, not with each picture
    assert page.evaluate(f"state.angle.toFixed(1) === {field}.value")
    page.evaluate("model.set('data', { animation: null, charts: [] }); end()")
    assert page.evaluate("[output.childElementCount, listening()]") == [0, 0]


def test_each_diagram_has_its_extremes_as_a_table(page: Page) -> None:
    drawn = data()
    show(page, drawn)
    chosen = "view.querySelector('select[aria-label]')"
    for number, chart in enumerate(drawn["charts"]):
        page.evaluate(
            f"{chosen}.selectedIndex = {number}; {chosen}.dispatchEvent(new Event('change'))"
        )
        cells = page.evaluate("[...view.querySelectorAll('tbody td')].map((e) => e.textContent)")
        names = [each["name"] for each in chart["readings"]]
        assert cells[::5] == names
        assert cells[1::5] == [each["low"] for each in chart["readings"]]


def hostile(value: Any, text: str) -> Any:
    """The data with `text` in place of all that is read."""
    if isinstance(value, dict):
        return {
            key: text if key in FREE and isinstance(each, str) else hostile(each, text)
            for key, each in value.items()
        }
    return [hostile(each, text) for each in value] if isinstance(value, list) else value


def test_hostile_texts_stay_texts(page: Page) -> None:
    count = "[...view.querySelectorAll('*')].map((each) => each.tagName).join()"
    found = []
    show(page, hostile(data(), "plain"))
    for text in ("plain", ALL_AT_ONCE, *(HOSTILE if LONG else ())):
        page.evaluate("(data) => model.set('data', data)", hostile(data(), text))
        page.wait_for_timeout(50)  # for what would be loaded
        found.append(page.evaluate(count))
        assert page.evaluate("view.querySelector('tbody td').textContent") == text
        assert page.evaluate("view.querySelectorAll('[href], [src], [onload]').length") == 0
    assert len(set(found)) == 1


@pytest.mark.skipif(not axe.kept(), reason="axe is not there: npm ci")
def test_axe_finds_nothing(page: Page) -> None:
    show(page, data())
    page.evaluate(axe.script())
    violations = page.evaluate(
        "async () => (await axe.run(document)).violations.map((each) => each.id)"
    )
    assert violations == []
