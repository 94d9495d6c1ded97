"""docs/mechanisms.md shows every mechanism, with what its scene and the code give."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from camgeo.scene.toml import MECHANISMS
from tests.pages import page_maker

DOCS = Path(__file__).resolve().parents[1] / "docs"

MAKER = page_maker("mechanisms_page")

PAGE = (DOCS / "mechanisms.md").read_text(encoding="utf-8")


# Compared by `.ci/full`; below is what a reader would miss.
@pytest.mark.long
def test_the_page_is_made_from_its_texts_scenes_and_code() -> None:
    assert MAKER.page() == PAGE, "run python docs/mechanisms_page.py"


def test_every_mechanism_of_camgeo_new_has_its_section_and_picture() -> None:
    assert sorted(MAKER.MECHANISMS) == sorted(MECHANISMS)
    heads = re.findall(r"^## (.+)$", PAGE, flags=re.MULTILINE)
    assert [head for head in heads if head in MAKER.MECHANISMS] == list(MAKER.MECHANISMS)
    shown = re.findall(r"\(images/(mechanism-[a-z-]+\.png)\)", PAGE)
    assert shown == [f"mechanism-{name}.png" for name in MAKER.MECHANISMS]
    for name in shown:
        assert (DOCS / "images" / name).read_bytes().startswith(b"\x89PNG")


def test_no_text_is_left_out() -> None:
    texts = {path.stem for path in (DOCS / "mechanisms").glob("*.md")}
    assert texts == {"conventions", *MAKER.MECHANISMS, *MAKER.LATER}
