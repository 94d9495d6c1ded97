"""What pages draw in place is what they draw anew, and is what the data say."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
import shapely

from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import Axis, Figure, Line, Panel, Style, figure_data, over
from camgeo_export.browser.bundles import bundle
from tests.judges.chromium import CHROMIUM, measured
from tests.judges.files import reports

pytestmark = pytest.mark.skipif(bool(CHROMIUM.absent()), reason=CHROMIUM.absent() or "is there")

SIDE = 10.0
"""Of a figure [inch]; its panel, of side 1, fills it."""

POINT = 1.0 / (72.0 * SIDE)
"""The length of a point in such a panel."""

SEEN = 0.03
"""By how many points a written line may pass a point of its curve (course.ts)."""


def curves() -> list[FloatArray]:
    """Smooth, straight, with corners and steps, turning back, closed, at random."""
    t = np.linspace(0.0, 1.0, 1500)
    random = np.random.default_rng(1)
    return [
        over(t, 0.5 + 0.4 * np.sin(9.0 * t)),
        over(t, 0.2 + 0.5 * t),
        over(t, np.where(t < 0.5, 0.1, 0.9)),
        over(t, 0.5 + 0.3 * np.abs(np.sin(20.0 * t))),
        over(0.5 + 0.4 * np.sin(40.0 * t), np.full_like(t, 0.3)),
        over(0.5 + 0.4 * np.cos(2.0 * np.pi * t), 0.5 + 0.4 * np.sin(2.0 * np.pi * t)),
        over(random.random(300), random.random(300)),
        0.5 + np.cumsum(random.normal(0.0, 0.5 * POINT, (1500, 2)), axis=0),
        over(t, 0.5 + random.normal(0.0, SEEN * POINT, t.size)),
    ]


def figure(lines: list[FloatArray]) -> dict[str, Any]:
    marks = tuple(Line(points, Style("#000000")) for points in lines)
    panel = Panel((0.0, 0.0, 1.0, 1.0), Axis((0.0, 1.0)), Axis((0.0, 1.0)), marks, bare=True)
    return {"figure": figure_data(Figure((SIDE, SIDE), (panel,))), "sentence": "<img src=x>"}


def drawn(path: str) -> list[FloatArray]:
    """The strokes of a path, in the coordinates of the panel."""
    found = []
    for stroke in path.split("M")[1:]:
        points = np.array(re.findall(r"-?[\d.]+", stroke), np.float64).reshape(-1, 2)
        found.append(over(points[:, 0] * POINT, 1.0 - points[:, 1] * POINT))
    return found


def test_curves_are_drawn_as_the_data_say() -> None:
    lines = curves()
    gaps = over(np.linspace(0.0, 1.0, 9), [0.1, 0.2, np.nan, 0.3, 0.5, 0.1, np.nan, np.nan, 0.2])
    answer = shown([{"animation": None, "charts": [figure([*lines, gaps])]}])
    assert (answer["differing"], answer["images"]) == ([0, 0], 0)
    assert "<img src=x>" in answer["texts"]
    rounding = 0.5 * np.hypot(0.01, 0.01)
    *paths, last = answer["paths"]
    assert [stroke[0, 0] for stroke in drawn(last)] == pytest.approx([0.0, 0.375, 1.0])
    assert [stroke[-1, 0] for stroke in drawn(last)] == pytest.approx([0.125, 0.625, 1.0])
    for path, points in zip(paths, lines, strict=True):
        (stroke,) = drawn(path)
        apart = shapely.distance(shapely.LineString(stroke), shapely.points(points))
        assert apart.max() < (SEEN + 2.0 * rounding) * POINT
        ends = np.abs(stroke[[0, -1]] - points[[0, -1]])
        assert ends.max() < 0.0051 * POINT


def test_drawings_are_redrawn_in_place(tmp_path: Path) -> None:
    """Each mechanism and diagram after each other, as in a viewer of its own."""
    texts = [path.read_text("utf-8") for path in reports(tmp_path, ["setzhub", "groove"])]
    pattern = re.compile(r'id="data">(.*?)</script>', re.DOTALL)
    found = [json.loads(pattern.findall(text)[0]) for text in texts]
    datas = [
        {"animation": each["animation"], "charts": [chart]}
        for each in found
        for chart in each["charts"][:3]
    ]
    answer = shown(datas)
    assert answer["differing"] == [0] * 2 * len(datas)


# -- chromium viewer -------------------------------------------------------------------------------
# Chromium runs the viewer of notebooks, which draws with the modules that all pages share.


PROBE: Final = """
const datas = JSON.parse(document.getElementById("data").textContent);
function shown(data) {
  const holder = document.body.appendChild(document.createElement("div"));
  const calls = new Map();
  const model = {
    get: (name) => (name === "data" ? data : 0),
    set: () => {},
    save_changes: () => {},
    on: (event, call) => calls.set(event, call),
    off: (event) => calls.delete(event),
  };
  const remove = viewer.render({ model, el: holder });
  return {
    redraw(other) { data = other; calls.get("change:data")(); },
    root: holder.firstChild.shadowRoot,
    ended() { remove(); return !calls.size && !holder.firstChild; },
  };
}
const tree = (e) => [e.tagName, [...e.attributes].map((a) => `${a.name}=${a.value}`).sort(),
  e.children.length ? [...e.children].map(tree) : e.textContent];
const picture = (view) => [...view.root.querySelectorAll("svg, figcaption")].map((e) =>
  JSON.stringify(tree(e)).replace(/clip-\\d+/g, "clip"));
const view = shown(datas[0]);
const differing = [];
for (const data of [...datas, ...datas]) {
  view.redraw(data);
  const fresh = shown(data);
  const [mine, other] = [picture(view), picture(fresh)];
  differing.push(mine.filter((each, k) => each !== other[k]).length);
  if (!fresh.ended()) differing.push(-1);
}
document.body.dataset.camgeo = JSON.stringify({
  differing,
  paths: [...view.root.querySelectorAll("path")].map((e) => e.getAttribute("d")),
  texts: view.root.textContent,
  images: view.root.querySelectorAll("img, script").length,
});
"""
"""Shows all data in one viewer, one after the other, and each in a viewer of its own."""


def shown(datas: Sequence[Any]) -> dict[str, Any]:
    """What the probe finds; of `paths`, `texts` and `images` those of the last of `datas`."""
    script, count = re.subn(
        r"export\{(\w+) as default\};\s*$", r"var viewer=\1;", bundle("viewer.js")
    )
    assert count == 1
    data = json.dumps(datas).replace("<", "\\u003c")
    page = (
        '<!DOCTYPE html><html><meta charset="utf-8"><body>'
        f'<script type="application/json" id="data">{data}</script>'
        f"<script>{script}</script><script>{PROBE}</script></body></html>"
    )
    answer, _ = measured("the viewer", page)
    return answer
