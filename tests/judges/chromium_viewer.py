"""Chromium runs the viewer of notebooks, which draws with the modules that all pages share."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any, Final

from camgeo_export.browser.bundles import bundle
from tests.judges.chromium import measured

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
