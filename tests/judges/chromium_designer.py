"""Chromium shows the live designer: every scene is edited and built, every view is looked at."""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.scene.scene import parse_scene
from camgeo.units import counted
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, hostile_design
from tests.judges import axe, browsing
from tests.judges.browsing import Visit, driven, memory, number_of, visit
from tests.judges.painted import farthest, frame_of
from tests.judges.programs_of_others import Refusal
from tests.waiting import PATIENCE, ended

# The page, used by pointer, by keyboard and by its fields -----------------------------------------


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


# Scenes: what is painted, saved and built is what the text says -----------------------------------


FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

FOLDERS: Final = ("scenes", "effects", "found", "milling", "pairs", "refused")
"""Of the fixtures, those with scenes."""

FIELDS: Final = ("follower.base_radius", "follower.roller_radius", "cam.speed")
"""Keys of which the first that there is gets another value."""

LARGER: Final = 1.01
"""By how much."""

WAYS: Final = ((1, 0), (-1, 0), (0, -1), (0, 1))
"""In which a joint is dragged, until the scene follows [pixels a step]."""

COMMENT: Final = re.compile(r"#.*")

MARKUP: Final = """() => {
  const all = (what) => [...document.querySelectorAll(what)];
  const own = ["designer.js", "solid.js"];
  const way = (each) => each.getAttribute("href") ?? each.getAttribute("action") ?? "";
  return {
    loaded: all("img, iframe, object, embed, base, link:not([href='designer.css'])").length,
    scripts: all("script").filter((each) =>
      each.textContent || !own.includes(each.getAttribute("src"))).length,
    led: all("a, area, form").filter((each) => /^\\s*javascript:/i.test(way(each))).length,
    heard: all("*").filter((each) =>
      each.getAttributeNames().some((name) => name.startsWith("on"))).length,
  };
}"""
"""What the page has that loads, runs, leads away or listens, and is not its own."""


@dataclass(frozen=True)
class Shown:
    """What has been seen of scenes.

    Attributes
    ----------
    scenes, dragged, files : how many.
    share : largest distance of a painted curve from the exact one, as a share of what is stated.
    """

    scenes: int = 0
    dragged: int = 0
    files: int = 0
    share: float = 0.0

    def __add__(self, other: Shown) -> Shown:
        return Shown(
            self.scenes + other.scenes,
            self.dragged + other.dragged,
            self.files + other.files,
            max(self.share, other.share),
        )

    def __str__(self) -> str:
        return (
            f"{counted(self.scenes, 'scene')}, {self.dragged} of them dragged, with curves within"
            f" {self.share:.2f} of what is stated, and {counted(self.files, 'file')} as camgeo"
            " build writes them"
        )


def workshop(folder: Path) -> list[str]:
    """Copy all fixture scenes into a folder; their names there."""
    folder.mkdir()
    for name in FOLDERS:
        for path in sorted((FIXTURES / name).iterdir()):
            if path.suffix == ".toml":
                shutil.copy(path, folder / f"{name}_{path.name}")
            elif path.is_file():
                shutil.copy(path, folder)
            else:
                shutil.copytree(path, folder / path.name)
    return sorted(path.name for path in folder.glob("*.toml"))


def hostile_scenes(folder: Path) -> list[str]:
    """Write scenes in which each text that is free stands for markup; their names."""
    names = []
    for number, text in enumerate((ALL_AT_ONCE, *HOSTILE)):
        name = f'hostile "><img src=x onerror=alert({number})>.toml'
        (folder / name).write_text(hostile_design(text, folder).scene.to_toml(), "utf-8")
        names.append(name)
    return names


def used(page: DesignerPage, folder: Path, name: str) -> Shown:
    """Open, edit, drag, undo, save and build one scene of a folder, and undo all.

    Raises
    ------
    Refusal
        If anything that is painted, saved or built is not what the text says.
    """
    try:
        return _used(page, folder, name)
    except Refusal as refusal:
        raise Refusal(f"{name}: {refusal}") from refusal


def _used(page: DesignerPage, folder: Path, name: str) -> Shown:
    file = folder / name
    before = file.read_text("utf-8")
    page.open(name)
    if page.text != before:
        raise Refusal("the text is not that of the file")
    share = painted(page, file)
    edit(page)
    edited = page.text
    if edited == before:
        raise Refusal("a value that was entered is not in the text")
    keep(before, edited)
    dragged = drag(page, file)
    share = max([share, *dragged])
    if dragged:
        page.press("Control+z")
        if page.text != edited:
            raise Refusal("to undo a drag does not give the text before it")
        page.press("Control+Shift+Z")
    share = max(share, painted(page, file))
    page.save()
    saved = file.read_text("utf-8")
    if saved != page.text:
        raise Refusal("the file is not the text that was saved")
    keep(before, saved)
    files = page.build()
    compare(files, command(file))
    back(page)
    if page.text != before:
        raise Refusal("to undo everything does not give the text that was opened")
    strange = page.visit.page.evaluate(MARKUP)
    if any(strange.values()):
        raise Refusal(f"the page has what is not its own: {strange}")
    return Shown(1, int(bool(dragged)), len(files), share)


def edit(page: DesignerPage) -> None:
    """Enter a value that the scene takes without a fault."""
    for key, value in page.values(FIELDS).items():
        if page.enter(key, f"{LARGER * value:.6g}"):
            if page.painted()["faults"] == 0:
                return
            page.press("Control+z")
    raise Refusal("no field takes a value")


def drag(page: DesignerPage, file: Path) -> list[float]:
    """Drag the first joint that can be; what `farthest` says of the picture while it is held.

    The picture then keeps its scale.
    """
    frame = frame_of(design_of(page.text, file))
    for number in range(page.visit.page.locator(JOINTS).count()):
        for way in WAYS:
            followed = page.hold(f"{JOINTS} >> nth={number}", way)
            found = page.painted()
            valid = followed and found["faults"] == 0
            share = [farthest(design_of(found["text"], file), found, frame)] if valid else []
            page.let_go()
            if valid:
                return share
            if followed:
                page.press("Control+z")
    return []


def design_of(text: str, file: Path) -> Design:
    """The design of a text, as of a file; Refusal if it has none."""
    try:
        return Design(parse_scene(text, str(file), file.parent))
    except CamgeoError as error:
        raise Refusal(f"the page shows no fault where there is one: {error}") from error


def painted(page: DesignerPage, file: Path) -> float:
    """What `farthest` says of the page and the exact curves of its text."""
    found = page.painted()
    if found["faults"]:
        raise Refusal("the page shows a fault where there is none")
    return farthest(design_of(found["text"], file), found)


def keep(before: str, after: str) -> None:
    """Refusal unless what stands behind each # of a scene is the same, in the same order."""
    if COMMENT.findall(before) != COMMENT.findall(after):
        raise Refusal("a comment is lost")


def command(file: Path) -> dict[str, bytes]:
    """The files that `camgeo build` of the command line makes of a scene, by their names."""
    with TemporaryDirectory() as name:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            main(["build", str(file), "-o", name])
        return {path.name: path.read_bytes() for path in Path(name).iterdir()}


def compare(found: Mapping[str, bytes], wanted: Mapping[str, bytes]) -> None:
    """Refusal unless both are the same files, byte for byte."""
    differing = [each for each in sorted({*found, *wanted}) if found.get(each) != wanted.get(each)]
    if differing:
        raise Refusal(f"{', '.join(differing)}: not as camgeo build writes it")


def back(page: DesignerPage) -> None:
    """Undo everything."""
    while page.visit.page.evaluate("camgeo.session.state.undo") is not None:
        page.press("Control+z")


# Views, narrow and wide, light and dark: axe finds nothing in any ---------------------------------


SIZES: Final = ((375, 800), (1440, 900), (2560, 1300))
"""Of a telephone, a laptop and a large screen [CSS px]."""

SCHEMES: Final = ("light", "dark")

SETZHUB: Final = "scenes_setzhub.toml"
UNDERCUT: Final = "refused_undercut_tappet.toml"
EFFECTS: Final = "effects_press.toml"

FAULTY: Final = 'camgeo = 1\n[cam]\nrotation = "up"\n[follower]\nkind = "translating-roller"\n'
"""A scene with several faults."""

DIALOGS: Final = ("save-as", "open", "new")
"""Buttons that open one."""

UNFOLD: Final = """() => {
  document.querySelectorAll("details:not([open])").forEach((each) => each.open = true);
  document.querySelector("#diagrams").scrollIntoView();
}"""
"""Shows what is folded, and the diagrams, which are drawn when they are seen."""


@dataclass(frozen=True)
class Window:
    """A window of the browser: its size [CSS px] and the colours that its user prefers."""

    width: int
    height: int
    scheme: str

    def __str__(self) -> str:
        return f"{self.width} px, {self.scheme}"

    @property
    def context(self) -> dict[str, Any]:
        """What playwright's `new_context` takes."""
        size = {"width": self.width, "height": self.height}
        return {"viewport": size, "color_scheme": self.scheme}


def windows(*, everything: bool) -> list[Window]:
    """All of them, or a dark narrow one and a light wider one."""
    found = [Window(*size, scheme) for size in SIZES for scheme in SCHEMES]
    return found if everything else found[1:3]


def views_judged(page: DesignerPage, folder: Path, window: Window, *, everything: bool) -> int:
    """How many views there are; Refusal if there is anything against one of them."""
    count = 0
    for name in views(page, folder, everything=everything):
        try:
            look(page.visit, window.width)
            page.visit.check()
        except Refusal as refusal:
            raise Refusal(f"{name}, {window}: {refusal}") from refusal
        count += 1
    return count


def look(visit: Visit, width: int) -> None:
    """Refusal if axe finds anything on a page, or it is wider than its window."""
    visit.drawn()
    wide = visit.page.evaluate("document.documentElement.scrollWidth")
    if wide > width:
        raise Refusal(f"the page is {wide} px wide")
    if found := axe.violations(visit):
        raise Refusal("; ".join(found))


def views(page: DesignerPage, folder: Path, *, everything: bool) -> Iterator[str]:
    """Go from view to view, and name the one that is shown."""
    if everything and not page.visit.page.evaluate("camgeo.session.text"):
        yield "no scene"
    page.open(SETZHUB)
    page.visit.page.locator(JOINTS).first.click()
    page.visit.page.evaluate(UNFOLD)
    yield "a scene"
    for name in DIALOGS if everything else DIALOGS[:1]:
        yield from dialog(page, f"#{name}")
    if everything:
        yield from dialog(page, "button.laws:visible >> nth=0")
        yield from made(page)
        yield from compared(page)
        yield from changed_on_disk(page, folder / SETZHUB)
        page.open(EFFECTS)
        page.visit.page.evaluate(UNFOLD)
        yield "effects"
    page.open(UNDERCUT)
    yield "findings"
    page.write(FAULTY)
    yield "faults"
    page.press("Control+z")  # what is not saved comes back when the scene is opened again


def dialog(page: DesignerPage, of: str) -> Iterator[str]:
    """The dialog that a button opens."""
    page.visit.page.click(of)
    page.visit.ask(f"a dialog of {of}", "() => !!document.querySelector('dialog[open]')")
    yield f"the dialog of {of}"
    page.visit.page.keyboard.press("Escape")
    page.visit.ask("its end", "() => !document.querySelector('dialog[open]')")


def made(page: DesignerPage) -> Iterator[str]:
    """Files, sizes and a solid."""
    visit = page.visit
    visit.page.click("#find-sizes")
    visit.ask("the smallest cam", "() => !!camgeo.session.sized")
    visit.page.click("#show-solid")
    solid = "() => !!document.querySelector('#solid canvas[data-view]')"
    visit.ask("the solid", solid)
    visit.page.click("#build-files")
    visit.ask("the end of building", BUILT, page.revision)
    yield "files, sizes and a solid"


def compared(page: DesignerPage) -> Iterator[str]:
    """A variant beside a pinned one."""
    page.visit.page.click("#pin")
    page.visit.ask("a pinned variant", "() => camgeo.session.pinned !== null")
    page.enter("follower.base_radius", "51")
    yield "a pinned variant"
    page.visit.page.click("#pin")
    page.visit.ask("no pinned variant", "() => camgeo.session.pinned === null")
    page.press("Control+z")


def changed_on_disk(page: DesignerPage, file: Path) -> Iterator[str]:
    """A file that another program has changed, and the question whether to overwrite it."""
    before = file.read_bytes()
    file.write_bytes(b"# changed\n" + before)
    page.visit.ask("word of a changed file", "() => camgeo.session.state.disk === 'changed'")
    yield "a file changed on disk"
    page.visit.page.keyboard.press("Control+s")
    page.visit.ask("the question about it", "() => !!document.querySelector('dialog[open]')")
    yield "the dialog about a changed file"
    page.visit.page.keyboard.press("Escape")
    file.write_bytes(before)
    page.visit.ask("word of the file", "() => camgeo.session.state.disk === 'same'")


# A cam planned, edited, undone, saved and built by the keyboard alone -----------------------------


FILE: Final = "planned by keys.toml"

OPEN: Final = "() => !!document.querySelector('dialog[open]')"


def planned(page: DesignerPage, folder: Path) -> None:
    """Plan a scene from a template, and build it.

    Raises
    ------
    Refusal
        If there is no way to something, or the files are not those of the command line.
    """
    keys = page.visit.page.keyboard
    page.tab_to("#new")
    keys.press("Enter")
    page.visit.ask("templates", OPEN)
    page.tab_to("dialog[open] select")
    keys.type("translating roller")
    page.tab_to("dialog[open] button[type=submit]")
    page.press("Enter")
    segments = page.text.count("[[motion]]")
    page.tab_to(f"{JOINTS}:last-of-type")
    expect(page, "ArrowLeft", "an arrow key moves no joint")
    keys.press("Enter")  # on to the exact fields
    keys.press("Control+a")
    keys.type("301.5")
    expect(page, "Enter", "an exact place moves no joint")
    page.tab_to("tr[data-segment='1'] button.laws")
    keys.press("Enter")
    page.visit.ask("laws", OPEN)
    page.tab_to("[data-law]:not([aria-pressed='true'])")
    expect(page, "Enter", "no law is taken")
    page.tab_to("tr[data-segment='1'] [data-action='split']")
    expect(page, "Enter", "nothing is split")
    if page.text.count("[[motion]]") != segments + 1:
        raise Refusal("a segment that is split is not two")
    expect(page, "Control+z", "nothing is undone")
    page.tab_to("[data-key='follower.roller_radius']")
    keys.type("7.5")
    expect(page, "Enter", "no value is taken")
    keys.press("Control+s")
    page.visit.ask("the question for a name", OPEN)
    keys.press("Control+a")
    keys.type(FILE)
    keys.press("Enter")
    page.visit.ask("the saving", "() => camgeo.session.state.saved")
    if (folder / FILE).read_text("utf-8") != page.text or "roller_radius = 7.5" not in page.text:
        raise Refusal("what was planned is not in the file")
    page.tab_to("#build-files")
    keys.press("Enter")
    page.visit.ask("an end of building", BUILT, page.revision)
    compare(page.built(), command(folder / FILE))


def expect(page: DesignerPage, key: str, otherwise: str) -> None:
    """Press a key that changes the text; Refusal if it does not."""
    before = page.text
    page.press(key)
    if page.text == before:
        raise Refusal(otherwise)


# A scene that takes too long to compute: the page says so, and lives on ---------------------------


SEGMENTS: Final = 6000

SLOW: Final = "slow.toml"

GROWTH: Final = 500e6
"""Bytes by which memory may have grown afterwards."""


def slow_scene() -> str:
    """A scene of so many segments that its picture takes more than a minute."""
    head = (
        'camgeo = 1\nname = "slow"\n[cam]\nrotation = "ccw"\nspeed = 100\n[follower]\n'
        'kind = "translating-roller"\nbase_radius = 5000\nroller_radius = 5\n'
    )
    return head + "".join(
        f'[[motion]]\nlaw = "polynomial-345"\nspan = {360.0 / SEGMENTS!r}\nto = {1 - number % 2}\n'
        for number in range(SEGMENTS)
    )


def slow_scene_refused(
    page: DesignerPage, folder: Path, server: Server, browser: int, small: str
) -> str:
    """Open and drag such a scene after a small one, then that one again; what came of it.

    Parameters
    ----------
    browser : number of its process.

    Raises
    ------
    Refusal
        If the page does not live, or says nothing, or memory grows.
    """
    (folder / SLOW).write_text(slow_scene(), "utf-8")
    page.open(small)
    before = memory(server.process.pid), memory(browser)
    page.choose(SLOW)
    told(page.visit, "camgeo.session.refused")
    refused = page.hold(JOINTS, (1, 1))  # of the last picture, which is still there
    page.let_go()
    if refused:
        raise Refusal("a drag is followed though there is no picture")
    told(page.visit, "camgeo.session.refused")
    page.open(small)
    found = page.painted()
    if found["faults"]:
        raise Refusal("a small scene after a slow one has faults")
    farthest(design_of(found["text"], folder / small), found)
    for what, old, new in zip(
        ("server", "browser"), before, (memory(server.process.pid), memory(browser)), strict=True
    ):
        if new > old + GROWTH:
            raise Refusal(f"the memory of the {what} has grown from {old:.2g} to {new:.2g} bytes")
    return f"{SEGMENTS} segments refused, the next scene there"


def told(visit: Visit, said: str) -> None:
    """Wait until the page says that something took too long; it answers all the while."""

    def is_told() -> bool:
        return "longer than" in visit.ask("an answer of the page", f"() => [{said}]")[0]

    visit.until("that a scene takes too long", is_told)


# The judge ----------------------------------------------------------------------------------------


FEW: Final = "effects_groove_lever.toml"
"""The scene of the small form, which is soon built; with it is one that is hostile."""

FEW_LONGEST, EVERY_LONGEST = 3600.0, 36000.0
"""Seconds after which the browser is ended, in the small form and in the long one."""


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return browsing.missing() or axe.missing()


def judge(*, everything: bool) -> str:
    """What has been looked at: a few scenes and views, or everything; Refusal if it is wrong."""
    most = EVERY_LONGEST if everything else FEW_LONGEST
    with TemporaryDirectory() as name, driven(most) as browser:
        folder = Path(name, "scenes")
        scenes, hostile = workshop(folder), hostile_scenes(folder)
        names = [*scenes, *hostile] if everything else [FEW, hostile[0]]
        seen, views, told = Shown(), 0, []
        with serving(folder) as server:
            for window in windows(everything=everything):
                with shown(browser, server.host, server.way, **window.context) as page:
                    views += views_judged(page, folder, window, everything=everything)
            with shown(browser, server.host, server.way) as page:
                for each in names:
                    seen += used(page, folder, each)
            if everything:
                with shown(browser, server.host, server.way) as page:
                    planned(page, folder)
                    told.append("one is planned by the keyboard alone")
                with shown(browser, server.host, server.way) as page:
                    number = number_of(browser)
                    told.append(slow_scene_refused(page, folder, server, number, FEW))
    told.insert(0, f"{seen}; {views} views")
    return "; ".join(told)
