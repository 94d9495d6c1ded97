"""The page of the live designer, used by pointer, by keyboard and by its fields."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tests.judges.browsing import Visit, visit
from tests.judges.programs_of_others import Refusal
from tests.waiting import PATIENCE, ended

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator

TRIES, DROPPED = 120, 5.0
"""How often a file is asked for, and seconds after which its download has been dropped."""

TABS: Final = 600
"""Most elements from one to another with the Tab key."""

JOINTS: Final = ".handle[data-space='plan']"

PAINTED: Final = """(old) => {
  const { session } = camgeo;
  if (session.revision <= old || session.waits) return false;
  const first = session.revision;
  return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
    const turning = document.querySelector("#mechanism .turning");
    const view = turning?.ownerSVGElement.viewBox.baseVal;
    done(session.revision === first && {
      text: session.text,
      revision: first,
      faults: session.faults.length,
      size: view ? [view.width, view.height] : null,
      paths: [...(turning?.querySelectorAll("path") ?? [])].map((each) => each.getAttribute("d")),
    });
  })));
}"""
"""The text of the scene and what is painted of it in the same frame."""


@dataclass(frozen=True)
class Server:
    """A designer that runs.

    Attributes
    ----------
    host : its name and port.
    way : to its page, with the token.
    process : that serves.
    """

    host: str
    way: str
    process: subprocess.Popen[str]


@contextmanager
def serving(folder: Path, *words: str) -> Generator[Server]:
    """`camgeo design` in `folder`, with its journals beside that.

    Raises
    ------
    Refusal
        If it does not start.
    """
    call = [sys.executable, "-m", "camgeo", "design", *words, "--no-browser"]
    states = {"XDG_STATE_HOME": str(folder.parent / "states")}
    with subprocess.Popen(
        call, cwd=folder, env=os.environ | states, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True, start_new_session=True,
    ) as process:  # fmt: skip
        end = threading.Timer(PATIENCE, process.kill)
        end.start()
        try:
            lines = iter(process.stdout or ())
            found = (re.search(r"http://([\w.]+:\d+)(/\S+)", line) for line in lines)
            address = next((each for each in found if each), None)
            end.cancel()
            if address is None:
                raise Refusal("camgeo design does not start")
            yield Server(address[1], address[2], process)
        finally:
            end.cancel()
            process.terminate()
            ended(process)


@contextmanager
def shown(browser: Browser, host: str, way: str, **window: Any) -> Generator[DesignerPage]:
    """The page of a server; `window` is what playwright's `new_context` takes."""
    with visit(browser, host, way, **window) as found:
        found.ask("the first picture", "() => document.documentElement.dataset.ready === 'true'")
        yield DesignerPage(found)


@dataclass(frozen=True)
class DesignerPage:
    """The page, with one scene at a time.

    Attributes
    ----------
    visit : the page in its window.
    """

    visit: Visit

    @property
    def revision(self) -> int:
        """The last one whose whole picture has come."""
        return self.visit.heard.get("curves", -1)

    @property
    def refusals(self) -> int:
        """How many changes have been refused."""
        return self.visit.heard.get("refused", 0)

    def settle(self, after: int) -> None:
        """Wait for picture, fields and findings of a later revision than `after`, and none to come.

        A drag is answered with what moves alone: fields and text follow when it has paused.
        """
        heard = self.visit.heard
        kinds = ("curves", "state", "findings")
        self.visit.until(
            f"picture and findings after revision {after}",
            lambda: heard.get("curves", -1) > after and len({heard.get(k) for k in kinds}) == 1,
        )
        self.visit.ask("the end of all changes", "() => !camgeo.session.waits")
        self.visit.drawn()

    def changed(self, before: int, refusals: int) -> bool:
        """Wait for the answer to a change; False if it is refused, or changes nothing."""
        heard = self.visit.heard
        self.visit.until(
            "an answer to a change",
            lambda: self.refusals > refusals or max(
                heard.get("curves", -1), heard.get("moved", -1)) > before
            or not self.visit.page.evaluate("camgeo.session.waits"),
        )  # fmt: skip
        if self.refusals > refusals or max(heard["curves"], heard.get("moved", -1)) <= before:
            return False
        self.settle(before)
        return True

    def painted(self, after: int = -1) -> dict[str, Any]:
        """The text and what is painted of it; see `PAINTED`."""
        found: dict[str, Any] = self.visit.ask("a picture of the text", PAINTED, after)
        return found

    @property
    def text(self) -> str:
        """The text in the editor, once it is that of the scene."""
        same = "() => document.getElementById('text-area').value === camgeo.session.text"
        self.visit.ask("the text beside the picture", same)
        return self.visit.page.input_value("#text-area")

    # -- what a user does --------------------------------------------------------------------------

    def open(self, name: str) -> None:
        """Open a scene of the folder."""
        before = self.revision
        self.choose(name)
        self.settle(before)

    def choose(self, name: str) -> None:
        """Ask for a scene of the folder, and wait for nothing."""
        page = self.visit.page
        page.click("#open")
        page.select_option("dialog[open] select", name)
        page.click("dialog[open] button[type=submit]")

    def write(self, text: str) -> None:
        """Replace the text of the scene by another one, as in its editor."""
        before = self.revision
        self.visit.page.fill("#text-area", text)
        self.settle(before)

    def enter(self, key: str, value: str) -> bool:
        """Enter a value in the field of a key; whether that changes the scene."""
        page, before, refusals = self.visit.page, self.revision, self.refusals
        field = page.locator(f"#sizes [data-key='{key}']")
        self.reveal(f"#sizes [data-key='{key}']")
        field.fill(value)
        page.keyboard.press("Enter")
        return self.changed(before, refusals)

    def reveal(self, what: str) -> None:
        """Open whatever is folded around an element."""
        self.visit.page.locator(what).first.evaluate(
            "(at) => { for (; at; at = at.parentElement?.closest('details')) at.open = true; }"
        )

    def values(self, keys: Sequence[str]) -> dict[str, float]:
        """Those of these keys that have fields with numbers in them, and their values."""
        script = """(keys) => Object.fromEntries(keys.map((key) => [key, document.querySelector(
          `#sizes input[type=number][data-key="${key}"]`)?.valueAsNumber])
          .filter(([, value]) => Number.isFinite(value)))"""
        found: dict[str, float] = self.visit.page.evaluate(script, list(keys))
        return found

    def hold(self, handle: str, way: tuple[int, int]) -> bool:
        """Drag a handle by some pixels without letting it go; whether that changes the scene."""
        page, before, refusals = self.visit.page, self.revision, self.refusals
        place = page.locator(handle).first
        place.scroll_into_view_if_needed()
        page.evaluate("document.activeElement.blur()")
        box = place.bounding_box()
        if box is None:
            raise Refusal(f"{handle} is not to be seen")
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(1, 9):
            page.mouse.move(x + way[0] * step, y + way[1] * step)
            page.wait_for_timeout(16)
        return self.changed(before, refusals)

    def let_go(self) -> None:
        """End a drag."""
        self.visit.page.mouse.up()
        self.visit.ask("the end of a drag", "() => !document.querySelector('.dragged')")

    def press(self, keys: str) -> None:
        """Press keys that change the scene."""
        before = self.revision
        self.visit.page.keyboard.press(keys)
        self.settle(before)

    def tab_to(self, what: str) -> None:
        """Go on with the Tab key until an element has the focus.

        Raises
        ------
        Refusal
            If there is no way to it.
        """
        for _ in range(TABS):
            self.visit.page.keyboard.press("Tab")
            if self.visit.page.evaluate("(what) => document.activeElement.matches(what)", what):
                return
        raise Refusal(f"there is no way to {what} by the keyboard")

    def save(self) -> None:
        """Save the scene to its file."""
        self.visit.page.keyboard.press("Control+s")
        self.visit.ask("the saving", "() => camgeo.session.state.saved")

    def build(self) -> dict[str, bytes]:
        """Build the scene's formats; the files as they are downloaded."""
        self.visit.page.click("#build-files")
        return self.built()

    def built(self) -> dict[str, bytes]:
        """The files of the present revision, downloaded once they are built."""
        page = self.visit.page
        self.visit.ask("an end of building", BUILT, self.revision)
        self.visit.drawn()
        links = page.locator(".build a[download]")
        return dict(self.downloaded(links.nth(k)) for k in range(links.count()))

    def downloaded(self, link: Locator) -> tuple[str, bytes]:
        """Name and contents of a file behind a link; Chromium drops some of many downloads."""
        from playwright.sync_api import TimeoutError as Late  # where there is no playwright, too

        for _ in range(TRIES):
            try:
                with self.visit.page.expect_download(timeout=1e3 * DROPPED) as download:
                    link.click()
            except Late:
                continue
            return download.value.suggested_filename, Path(download.value.path()).read_bytes()
        raise Refusal(f"{link.get_attribute('download')} is not downloaded")


BUILT: Final = "(least) => camgeo.session.busy === '' && camgeo.session.built?.revision >= least"
