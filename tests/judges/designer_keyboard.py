"""A cam planned, edited, undone, saved and built on the designer's page, by the keyboard alone."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from tests.judges.designer_page import BUILT, JOINTS, DesignerPage
from tests.judges.designer_scenes import command, compare
from tests.judges.programs_of_others import Refusal

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
