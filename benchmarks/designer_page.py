"""How quickly the live designer follows a drag, in Chromium: from input to painted frame.

`camgeo design` serves a copy of the scene; a joint of its motion plan, a handle of its mechanism
and a slider are each dragged with a pointer, a place every 16 ms. Reported are, for each:

- curves painted in a second of the drag;
- milliseconds from the input that asked for a curve to the frame that shows it: median and the
  95th percentile; of it, from the request to its answer, and from the answer to the frame;
- milliseconds of CPU of the page's main thread for a curve;
- milliseconds from the end of the drag to the frame with the findings.

Wall times say something on a quiet machine only: the load is reported with them. It needs
playwright and Chromium, as `tests/designer/test_page.py` does.

    python benchmarks/designer_page.py [--places 200] [--program chromium] [SCENE]
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import statistics
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from playwright.sync_api import CDPSession, Locator, Page, sync_playwright

ROOT: Final = Path(__file__).resolve().parents[1]
SETZHUB: Final = ROOT / "fixtures" / "scenes" / "setzhub.toml"

APART: Final = 16
"""Milliseconds between two places of a drag, as on a screen of 60 Hz."""

REACH: Final = 20
"""Places to one side before it goes back, a pixel apart."""

DRAGGED: Final = (
    ("joint", ".handle[data-space='plan'] >> nth=1"),
    ("base circle", ".handle.base-circle >> nth=0"),
    ("slider", ".field:has([data-key='follower.base_radius']) .slider"),
)


@contextmanager
def designer(scene: Path) -> Iterator[str]:
    """The address of a designer of a copy of the scene."""
    with TemporaryDirectory() as name:
        folder = Path(name, "scenes")
        shutil.copytree(scene.parent, folder)
        call = [sys.executable, "-m", "camgeo", "design", scene.name, "--no-browser"]
        environment = {**os.environ, "XDG_STATE_HOME": str(Path(name, "states"))}
        with subprocess.Popen(
            call, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
        ) as server:
            assert server.stdout is not None
            try:
                yield next(
                    found[0] for line in server.stdout if (found := re.search(r"http\S+", line))
                )
            finally:
                server.terminate()


def cpu(session: CDPSession) -> float:
    """Milliseconds that the page's main thread has worked."""
    found = session.send("Performance.getMetrics")["metrics"]
    return 1e3 * float(next(each["value"] for each in found if each["name"] == "TaskDuration"))


def drag(page: Page, session: CDPSession, what: Locator, places: int) -> dict[str, Any]:
    """Drag it to and fro, and what that took."""
    what.scroll_into_view_if_needed()
    box = what.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate("camgeo.timings.clear()")
    before = cpu(session)
    for place in range(places):
        off = abs((place + REACH) % (4 * REACH) - 2 * REACH) - REACH
        page.mouse.move(x + off, y + 0.5 * off)
        page.wait_for_timeout(APART)
    page.wait_for_function("() => !camgeo.session.waits")
    worked = cpu(session) - before
    changes = page.evaluate("camgeo.timings.changes")
    page.mouse.up()
    ended = page.evaluate("performance.now()")
    page.wait_for_function("(at) => camgeo.timings.findings.at(-1) > at", arg=ended, timeout=60_000)
    findings = page.evaluate("camgeo.timings.findings.at(-1)") - ended
    frames = sorted(each["painted"] - each["input"] for each in changes)
    wall = changes[-1]["painted"] - changes[0]["painted"]
    return {
        "curves a second": 1e3 * (len(changes) - 1) / wall,
        "input to frame, median": statistics.median(frames),
        "input to frame, 95 %": frames[int(0.95 * len(frames))],
        "answer": statistics.median(each["answered"] - each["sent"] for each in changes),
        "drawing": statistics.median(each["painted"] - each["answered"] for each in changes),
        "CPU of the page": worked / len(changes),
        "findings after the end": findings,
    }


def main() -> None:
    """Drag each of them, and print what that took."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scene", nargs="?", type=Path, default=SETZHUB)
    parser.add_argument("--places", type=int, default=200)
    parser.add_argument("--program", default=shutil.which("chromium") or "chromium")
    given = parser.parse_args()
    with designer(given.scene.resolve()) as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=given.program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 1000})
        page.goto(address)
        page.wait_for_function("() => window.camgeo && camgeo.session.findings")
        session = page.context.new_cdp_session(page)
        session.send("Performance.setTimeDomain", {"timeDomain": "threadTicks"})
        session.send("Performance.enable")
        for name, selector in DRAGGED:
            found = drag(page, session, page.locator(selector).first, given.places)
            print(f"{name}, load {os.getloadavg()[0]:.1f}:")
            for what, value in found.items():
                print(f"  {what}: {value:.1f}")
        browser.close()


if __name__ == "__main__":
    main()
