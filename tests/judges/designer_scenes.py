"""A scene on the page of the designer: what is painted, saved and built is what its text says."""

from __future__ import annotations

import io
import re
import shutil
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.scene.scene import parse_scene
from camgeo.units import counted
from tests.hostile_scene import ALL_AT_ONCE, HOSTILE, hostile_design
from tests.judges.designer_page import JOINTS, DesignerPage
from tests.judges.painted import farthest, frame_of
from tests.judges.programs_of_others import Refusal

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
