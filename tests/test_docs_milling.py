"""docs/milling.md is made from its texts, the scenes and what camgeo says and writes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]

MAKER = page_maker("milling_page")

PAGE = (ROOT / "docs" / "milling.md").read_text(encoding="utf-8")


def without_sizes(page: str) -> str:
    """Without the bytes of files: processors round the last digits of coordinates differently, and
    a trailing 0 is not written.
    """
    return re.sub(r" +[\d,]+ bytes", " bytes", page)


@pytest.mark.long  # the page against what stands there; its jobs are proved in milled scenes
def test_the_page_is_made_by_its_script() -> None:
    assert without_sizes(MAKER.page()) == without_sizes(PAGE), "run python docs/milling_page.py"


def test_every_job_stands_on_it_with_its_pictures_and_readme_names_it() -> None:
    jobs = {path.stem for path in (ROOT / "fixtures" / "milling").glob("*.toml")}
    assert {scene for scene, _ in MAKER.JOBS} == jobs
    shown = re.findall(r"\(images/(milling-[a-z]+)\.png\)", PAGE)
    assert shown == list(MAKER.PICTURES)
    for name in shown:
        assert (ROOT / "docs" / "images" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "(docs/milling.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_no_text_is_left_out() -> None:
    texts = {path.stem for path in (ROOT / "docs" / "milling").glob("*.md")}
    assert texts == set(MAKER.PARTS)
