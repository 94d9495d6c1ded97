"""The views of the designer's page, narrow and wide, light and dark: axe finds nothing in any."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tests.judges import axe
from tests.judges.browsing import Visit
from tests.judges.designer_page import BUILT, JOINTS, DesignerPage
from tests.judges.programs_of_others import Refusal

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


def judged(page: DesignerPage, folder: Path, window: Window, *, everything: bool) -> int:
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
