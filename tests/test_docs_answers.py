"""docs/answers.md describes the documents of all answers."""

from __future__ import annotations

from pathlib import Path

from camgeo.app.answers.answer import schema_of
from tests.pages import page_maker

PAGE = Path(__file__).resolve().parents[1] / "docs" / "answers.md"


def test_the_page_is_made_from_the_schemas() -> None:
    assert page_maker("answers_page").page() == PAGE.read_text(encoding="utf-8"), (
        "run python docs/answers_page.py"
    )


def test_the_schemas_that_are_shipped_are_those_of_the_answers() -> None:
    maker = page_maker("answers_page")
    for name in maker.packages():
        assert maker.schema_file(name).read_text(encoding="utf-8") == maker.schema_text(name), (
            "run python docs/answers_page.py"
        )


def test_every_key_stands_on_the_page() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in page_maker("answers_page").packages():
        schema = schema_of(name)
        section = text.partition(f"## `{schema['properties']['schema']['const']}`\n")[2]
        for key in schema["properties"].keys() - {"schema", "version", "camgeo"}:
            assert f"| `{key}` |" in section or f"| `({key})` |" in section
