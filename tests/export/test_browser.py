"""Scripts for browsers are those that their sources give, and the widget's runs in Chromium.

Without Chromium or playwright those of the widget are skipped with a word, as is that of axe
without `npm ci` in `export/camgeo_export/browser`.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

import camgeo
from camgeo.app.designing.work import Recent, painted
from camgeo_export.browser.bundles import bundle
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE
from tests.judges import axe
from tests.judges.browsing import LONGEST, driven
from tests.judges.chromium import CHROMIUM
from tests.long_form import LONG
from tests.waiting import PATIENCE

# Bundles, as far as it can be seen without node ---------------------------------------------------


ROOT = Path(__file__).parents[2]

BROWSER = ROOT / "export" / "camgeo_export" / "browser"

BUNDLES = sorted(path.name for path in (BROWSER / "bundle").iterdir())

HEADER = re.compile(
    r"/\* Made by build\.mjs from:\n(?P<sources>.*)\nsources (?P<of_sources>\w{64})\n"
    r"bundle (?P<of_bundle>\w{64})\n(?P<licenses>.*?)\*/\n(?P<body>.*)",
    re.DOTALL,
)


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def faults(folder: Path, text: str) -> list[str]:
    """What is wrong with a bundle whose sources are in a folder."""
    match = HEADER.fullmatch(text)
    if match is None:
        return ["it has no header"]
    names = match["sources"].split("\n")
    gone = [f"{name} is gone" for name in names if not (folder / name).is_file()]
    if gone:
        return gone
    known = "".join(f"{name} {sha256((folder / name).read_bytes())}\n" for name in names)
    found = []
    if sha256(known.encode()) != match["of_sources"]:
        found.append("it is older than its sources: npm run build")
    if sha256(match["body"].encode()) != match["of_bundle"]:
        found.append("it has been changed by hand, or by a merge: npm run build")
    return found


@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_is_that_of_its_sources(name: str) -> None:
    assert faults(BROWSER, bundle(name)) == []


def test_each_source_is_in_a_bundle() -> None:
    """But those of types alone, which leave nothing to be run."""
    named = {each for name in BUNDLES for each in bundle(name).partition("*/")[0].split("\n")}
    sources = {path.relative_to(BROWSER).as_posix() for path in (BROWSER / "src").rglob("*.ts")}
    unnamed = [(BROWSER / each).read_text("utf-8") for each in sources - named]
    running = re.compile(r"^(export )?(async )?(const|let|function|class) |^\w.*\(", re.MULTILINE)
    assert not [text for text in unnamed if running.search(text)]


def test_stale_bundles_are_found(tmp_path: Path) -> None:
    name = "designer.js"
    kept = shutil.ignore_patterns("node_modules", "bundle")
    shutil.copytree(BROWSER, tmp_path, ignore=kept, dirs_exist_ok=True)
    text = bundle(name)
    assert faults(tmp_path, text) == []
    assert "by hand" in faults(tmp_path, f"{text};")[0]
    assert faults(tmp_path, "alert(1)") == ["it has no header"]
    main = tmp_path / "src" / "designer" / "main.ts"
    main.write_text(main.read_text("utf-8") + "\n", "utf-8")
    assert "older" in faults(tmp_path, text)[0]
    main.unlink()
    assert faults(tmp_path, text) == ["src/designer/main.ts is gone"]


@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_can_stand_in_a_page(name: str) -> None:
    """It ends no script element, makes no text into markup or code, and loads nothing."""
    text = bundle(name)
    assert not re.search(r"</script|<!--", text, re.IGNORECASE)
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", text)
    spaces = ("2000/svg", "1999/xhtml", "1999/xlink")  # names of languages, not places
    known = "|".join(re.escape(f"www.w3.org/{each}") for each in spaces)
    assert not re.search(rf"https?://(?!{known})", text)


def test_packages_are_of_stated_versions_from_no_stated_place() -> None:
    """Exact versions with their hashes, from whichever registry is in use."""
    stated = json.loads((BROWSER / "package.json").read_text("utf-8"))
    lock = json.loads((BROWSER / "package-lock.json").read_text("utf-8"))
    packages = {**stated["dependencies"], **stated["devDependencies"]}
    for name, version in packages.items():
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)
        assert lock["packages"][f"node_modules/{name}"]["version"] == version
    for name, each in lock["packages"].items():
        assert "resolved" not in each
        assert not name or each["integrity"].startswith("sha512-")


# The widget's script: the cam angle goes both ways, and hostile texts stay texts ------------------


if TYPE_CHECKING:
    from playwright.sync_api import Browser, Dialog, Page

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

NOTEBOOK_BODY: Final = '<body><main><h1>notebook</h1><div id="output"></div></main></body>'

FREE: Final = ("title", "sentence", "name", "low", "high", "text", "label", "note")
"""Keys of the data that hold texts to be read."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    pytest.importorskip("playwright", reason="needs playwright: pip install playwright")
    if reason := CHROMIUM.absent():
        pytest.skip(reason)
    with driven(LONGEST) as program:
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
    opened.set_content(f'<!DOCTYPE html><html lang="en"><title>notebook</title>{NOTEBOOK_BODY}')
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
        assert (cells[::5], cells[1::5]) == (names, [each["low"] for each in chart["readings"]])


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
