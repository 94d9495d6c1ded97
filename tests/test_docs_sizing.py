"""docs/sizing.md has what its script computes, and its picture is there."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.pages import page_maker

DOCS = Path(__file__).resolve().parents[1] / "docs"


@pytest.mark.long
# That sizes are right is tested in tests/check, what `camgeo size` says in tests/answers/test_size.
def test_the_page_is_made_by_its_script() -> None:
    written = (DOCS / "sizing.md").read_text(encoding="utf-8")
    assert page_maker("sizing_page").page() == written, "run python docs/sizing_page.py"


def test_the_page_has_its_pictures_and_readme_the_page() -> None:
    maker = page_maker("sizing_page")
    for picture in (maker.PICTURE, maker.OF_FACE):
        assert f"(images/{picture.name})" in (DOCS / "sizing.md").read_text(encoding="utf-8")
        assert picture.read_bytes().startswith(b"<?xml")
    assert "(docs/sizing.md)" in (DOCS.parent / "README.md").read_text(encoding="utf-8")
