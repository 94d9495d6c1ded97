"""Chromium shows setup sheets and reports: without a complaint, with all that is on the page."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from tests.judges.programs_of_others import Program, Refusal

if TYPE_CHECKING:
    pass

CHROMIUM: Final = Program("CAMGEO_CHROMIUM", "chromium", "chromium-browser", "google-chrome")

WIDTH, HEIGHT = 1000, 1400
"""Of its window [CSS px]: an upright sheet of paper."""

PROBE: Final = """<script>
const box = (e) => e.getBoundingClientRect();
const picture = box(document.querySelector("svg"));
document.body.dataset.camgeo = JSON.stringify({
  mode: document.compatMode,
  width: document.documentElement.scrollWidth,
  picture: [picture.width, picture.height],
  empty: [...document.querySelectorAll("h1, h2, dt, dd, li, p, th:not(:empty)")].filter(
    (e) => !e.innerText.trim() || !box(e).width).length,
  outside: [...document.querySelectorAll("svg text, svg g[id^=text]")].map(box).filter((b) =>
    b.left < picture.left - 1 || b.right > picture.right + 1 ||
    b.top < picture.top - 1 || b.bottom > picture.bottom + 1).length,
});
</script>"""
"""Measures the page where it is shown; the page itself allows no script."""

POLICY: Final = "default-src 'none'"


FAULTS: Final[dict[str, Callable[[dict[str, Any]], bool]]] = {
    "it is not shown by the standard": lambda shown: shown["mode"] != "CSS1Compat",
    "it is wider than the window": lambda shown: shown["width"] > WIDTH,
    "its picture is too small": lambda shown: min(shown["picture"]) < 0.2 * WIDTH,
    "a heading, an entry or a paragraph is empty": lambda shown: shown["empty"] > 0,
    "words of its picture are cut off": lambda shown: shown["outside"] > 0,
}
"""What may be wrong with what the probe has measured."""


SLOW: Final = "GL Driver Message (OpenGL, Performance"
"""What the browser's own drawing without a graphics card says of itself."""

SHEET: Final = 750
"""Height of what is printed on A4 [points], where it is as wide as a diagram."""

REPORT_PROBE: Final = (
    f"const SHEET = {SHEET};"
    """
const all = (what) => [...document.querySelectorAll(what)];
const turned = () => document.querySelector("#mechanism .turning")?.getAttribute("transform");
const places = () => all(".cursor").map((e) => e.getAttribute("x1")).join();
const before = [turned(), places()];
const field = document.getElementById("degrees");
field.value = "123.5";
field.dispatchEvent(new Event("input"));
document.body.dataset.camgeo = JSON.stringify({
  mode: document.compatMode,
  width: document.documentElement.scrollWidth,
  ready: document.documentElement.dataset.ready,
  turned: document.getElementById("mechanism") === null || turned() !== before[0],
  moved: places() !== before[1],
  slider: document.getElementById("angle").value,
  blank: all("figure").filter((e) => !e.querySelector("svg path, svg line, canvas")).length,
  empty: all("canvas").filter((e) => {
    const copy = Object.assign(document.createElement("canvas"), { width: 64, height: 40 });
    const plain = copy.getContext("2d");
    plain.drawImage(e, 0, 0, 64, 40);
    const grey = plain.getImageData(0, 0, 64, 40).data.filter((v, k) => k % 4 === 0 && v < 240);
    return grey.length < 64;
  }).length,
  uncut: all("[id^=chart-] > svg:not(.part)").filter((e) => {
    const parts = [...e.parentElement.querySelectorAll(".part")].map((p) => p.viewBox.baseVal);
    const found = parts.length ? parts : [e.viewBox.baseVal];
    const sum = found.reduce((high, each) => high + each.height, 0);
    const gone = Math.abs(sum - e.viewBox.baseVal.height);
    return found.some((each) => each.height > SHEET) || gone > 0.1;
  }).length,
  unnamed: all("svg:not([aria-label]), input:not([aria-label]):not(label input)").length,
  wrong: all("*").flatMap((e) => [...e.attributes]).filter(
    (a) => /NaN|undefined/.test(a.value)).length,
  strange: all("img, iframe, object, embed, link").length + all("script").length - 4 +
    (document.getElementById("solid-0") === null),
});
"""
)
"""Turns the cam of a report, and measures what is shown then."""

OF_REPORTS: Final[dict[str, Callable[[dict[str, Any]], bool]]] = {
    "it is not shown by the standard": lambda shown: shown["mode"] != "CSS1Compat",
    "it is wider than the window": lambda shown: shown["width"] > WIDTH,
    "its script did not reach its end": lambda shown: shown.get("ready") != "true",
    "the cam does not turn": lambda shown: not shown["turned"],
    "the cursors do not move": lambda shown: not shown["moved"],
    "the slider does not follow": lambda shown: float(shown["slider"]) != 123.5,
    "a figure is blank": lambda shown: shown["blank"] > 0,
    "a solid is not drawn": lambda shown: shown["empty"] > 0,
    "a diagram does not fit on paper": lambda shown: shown["uncut"] > 0,
    "a picture or a field has no name": lambda shown: shown["unnamed"] > 0,
    "it has places that are no numbers": lambda shown: shown["wrong"] > 0,
    "it has elements that are not its own": lambda shown: shown["strange"] != 0,
}
"""What may be wrong with what the probe of reports has measured."""


def judge(page: Path) -> None:
    """Refusal if it finds fault with a setup sheet."""
    text = page.read_text("utf-8")
    if POLICY not in text:
        raise Refusal(f"{page.name} may load what it likes")
    text = text.replace(POLICY, f"{POLICY}; script-src 'unsafe-inline'")
    _judge(page, text.replace("</body>", f"{PROBE}</body>"), FAULTS)


def judge_report(page: Path) -> None:
    """Refusal if it finds fault with a report, whose policy lets only its own script run."""
    text = page.read_text("utf-8")
    if POLICY not in text or "unsafe" in text.partition("<title>")[0]:
        raise Refusal(f"{page.name} may run or load what it likes")
    digest = base64.b64encode(hashlib.sha256(REPORT_PROBE.encode()).digest()).decode()
    text = text.replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    _judge(page, text.replace("</body>", f"<script>{REPORT_PROBE}</script></body>"), OF_REPORTS)


def _judge(page: Path, text: str, wrong: dict[str, Callable[[dict[str, Any]], bool]]) -> None:
    """Refusal if the page, which measures itself, is not shown or has one of these faults."""
    shown, said = measured(page.name, text)
    faults = re.findall(r":CONSOLE[:(]\d+\)?\] (.*)", said)
    faults = [fault for fault in faults if SLOW not in fault]
    faults += [fault for fault, is_there in wrong.items() if is_there(shown)]
    if faults:
        raise Refusal(f"{page.name}: {'; '.join(faults)}: {shown}")


def measured(name: str, text: str) -> tuple[dict[str, Any], str]:
    """What a page says of itself in `data-camgeo`, and what the browser says; Refusal if the page,
    of that name, is not shown."""
    with TemporaryDirectory() as folder:
        copy = Path(folder, "page.html")
        copy.write_text(text, "utf-8")
        call = ["--headless", "--no-sandbox", "--disable-gpu"]
        call += ["--enable-unsafe-swiftshader"]  # WebGL without a graphics card
        call += [f"--user-data-dir={folder}/profile", "--enable-logging=stderr", "--dump-dom"]
        call += [f"--window-size={WIDTH},{HEIGHT}", copy.as_uri()]
        said = CHROMIUM.run(call, Path(folder))
    match = re.search(r'data-camgeo="([^"]*)"', said)
    if match is None:
        raise Refusal(f"{name} is not shown: {said[-300:].strip()}")
    return json.loads(html.unescape(match[1])), said
