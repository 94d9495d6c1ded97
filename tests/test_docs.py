"""The documentation agrees with the code."""

from __future__ import annotations

import itertools
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.cli.main import parser
from camgeo.scene.scene import parse_scene
from camgeo.scene.schema import whole_schema
from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]

PAGES = sorted((*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("fixtures/**/*.md")))

READ = [page for page in PAGES if page.parent in (ROOT, ROOT / "docs") or "fixtures" in page.parts]
"""Without the texts that other pages are made of."""


def test_the_page_of_the_scene_file_is_made_from_the_schema() -> None:
    written = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    assert page_maker("scene_page").page() == written, "run python docs/scene_page.py"
    schema = (ROOT / "docs" / "scene.schema.json").read_text(encoding="utf-8")
    assert page_maker("scene_page").editors_schema() == schema, "run python docs/scene_page.py"


def keys_of(node: Any, definitions: dict[str, Any], path: str = "") -> Iterator[str]:
    """The keys of a node of the schema, with those of all its kinds and of the tables in it."""
    if not isinstance(node, dict):
        return
    if "$ref" in node:
        yield from keys_of(definitions[node["$ref"].rpartition("/")[2]], definitions, path)
    if "x-as" in node:  # the page refers to the table whose keys it has
        return
    for kind in (*node.get("allOf", ()), node.get("then"), node.get("else"), node.get("items")):
        yield from keys_of(kind, definitions, path)
    for key, inner in node.get("properties", {}).items():
        yield f"{path}{key}"
        yield from keys_of(inner, definitions, f"{path}{key}.")


def test_every_key_of_the_schema_stands_on_the_page_of_the_scene_file() -> None:
    shown, table = set(), ""
    for line in (ROOT / "docs" / "scene.md").read_text(encoding="utf-8").splitlines():
        if heading := re.match(r"## `\[+([a-z0-9._-]+)\]+`", line):
            table = f"{heading[1]}."
            shown.add(heading[1])
        elif row := re.match(r"\| `([a-z0-9_.]+)` \| .", line):
            shown.add(table + row[1])
    schema = whole_schema()
    assert shown == set(keys_of(schema, schema["$defs"]))


def gaps(text: str) -> Iterator[str]:
    """Tables without rows, and headings with nothing below them, of a page in Markdown."""
    lines = [line for line in re.sub(r"(?ms)^```.*?^```", "code", text).splitlines() if line]
    for line, below in itertools.pairwise([*lines, "# end"]):
        if re.fullmatch(r"\|[-| :]+\|", line) and not below.startswith("|"):
            yield f"table without rows above {below!r}"
        level = len(line) - len(line.lstrip("#"))
        if level and re.match(rf"#{{1,{level}}} ", below):
            yield f"nothing below {line!r}"


def test_gaps_of_a_page_are_found() -> None:
    page = "# a\n\n## b\n\n| key |\n|---|\n\n## c\n\n## d\n\n```\n# no heading\n```\n"
    assert list(gaps(page)) == ["table without rows above '## c'", "nothing below '## c'"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_no_table_and_no_section_is_empty(page: Path) -> None:
    assert list(gaps(page.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize("page", READ, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_of_a_page_lead_to_files_and_headings(page: Path) -> None:
    for link in re.findall(r"\]\((?!https?:)([^)\s]+)\)", page.read_text(encoding="utf-8")):
        name, _, anchor = link.partition("#")
        target = page.parent / name if name else page
        assert target.is_file(), link
        if anchor:
            heads = re.findall(r"^#+ (.+)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            slugs = {re.sub(r"[^\w -]", "", head).lower().replace(" ", "-") for head in heads}
            assert anchor in slugs, link


def test_every_picture_is_one_and_stands_on_a_page() -> None:
    pictures = {path for path in (ROOT / "docs" / "images").rglob("*") if path.is_file()}
    shown = {
        page.parent / name
        for page in READ
        for name in re.findall(r"\]\(([^)\s]+\.(?:svg|png))\)", page.read_text(encoding="utf-8"))
    }
    assert pictures == shown
    assert all(path.read_bytes().startswith((b"<?xml", b"\x89PNG")) for path in pictures)


def test_effects_that_a_pair_cannot_have_are_listed_from_the_rules() -> None:
    """Those that a conjugate pair has are in a fixture, and not among those that it has not."""
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    (barred,) = set(re.findall(r"Conjugate cams.* Not with (.*)\. \|", page))
    assert barred == (
        "[effects.friction] guide_length and guide_overhang, [effects.reactions] bearings,"
        " [effects.roller-spin], [effects.balance]"
    )
    scene = parse_scene((ROOT / "fixtures" / "effects" / "conjugate_lever.toml").read_text("utf-8"))
    assert {"friction", "contact-force", "lift-off", "contact-pressure"} <= scene.effects.keys()


@pytest.mark.parametrize(
    "page",
    [
        "README.md",
        *(f"docs/{name}.md" for name in ("answers", "notebook", "optimise", "sweep", "tolerance")),
    ],
)
def test_the_python_of_a_page_runs(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "fixtures").symlink_to(ROOT / "fixtures")
    shutil.copy(ROOT / "fixtures" / "scenes" / "setzhub.toml", tmp_path / "my-cam.toml")
    monkeypatch.chdir(tmp_path)
    code = (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(compile(code, page, "exec"), {})
    assert page != "README.md" or all(
        (tmp_path / "out" / f"setzhub.{suffix}").is_file() for suffix in ("dxf", "3mf")
    )


def test_the_scene_lines_of_the_readme_are_a_valid_scene() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    heart = readme.split("```toml\n")[1].split("```")[0]
    scene = parse_scene(heart)
    assert scene.follower is not None
    assert scene.follower.base_radius == 50.0


def test_the_readme_is_short_and_links_pages_that_exist() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert readme.count("\n") <= 120
    linked = re.findall(r"\]\(([^)#]+)\)", readme)
    assert linked
    assert [name for name in linked if not (ROOT / name).is_file()] == []
    pages = {f"docs/{page.name}" for page in (ROOT / "docs").glob("*.md")}
    assert pages - set(linked) == set()


def test_contributing_names_modules_that_are_there() -> None:
    """By their paths, or dotted, with or without camgeo in front and a name behind."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    there = {
        f"/{path.relative_to(ROOT).with_suffix('').as_posix().removesuffix('/__init__')}": path
        for path in ROOT.glob("[a-z]*/**/*.py")
    }
    paths = [
        name.removesuffix(".py").removesuffix("/__init__")
        for name in re.findall(r"`([\w./]+\.py)`", text)
    ]
    dotted = re.findall(r"`((?:camgeo\.\w+|check|mechanism|numeric)\.[\w.]+)`", text)
    named = [*paths, *(name.replace(".", "/") for name in dotted)]
    lost = []
    for name in named:
        module, _, own = name.rpartition("/")
        inside = (path for each, path in there.items() if module and each.endswith(f"/{module}"))
        if not (
            "NAME" in name
            or any(each.endswith(f"/{name}") for each in there)
            or any(re.search(rf"\b{own}\b", path.read_text("utf-8")) for path in inside)
        ):
            lost.append(name)
    assert len(named) > 20
    assert lost == []


def test_every_figure_names_its_machine_and_a_command_that_is_there() -> None:
    page = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
    head, *sections = page.split("\n## ")
    machines = re.findall(r"^\| (\w[^|]*) \| ", head, flags=re.MULTILINE)[1:]
    rows = [row for each in sections for row in each.splitlines() if row.startswith("| ")]
    rows = [row for row in rows if not row.startswith("| what | found |")]
    assert rows
    for row in rows:
        assert row.split("|")[-3].strip() in machines
        (script,) = re.findall(r"python (benchmarks/\w+\.py)[^|]*` \|$", row)
        assert (ROOT / script).is_file()


def test_the_commands_of_the_readme_are_commands() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    listed = readme.split("```sh\ncamgeo new")[1].split("```")[0]
    shown = re.findall(r"^camgeo ([a-z-]+) ([^#\n]*)", listed, flags=re.MULTILINE)
    assert len(shown) >= 4
    for command, words in shown:
        parser([command]).parse_args([command, *words.split()])


def test_the_rooms_are_drawn_from_the_code() -> None:
    maker = page_maker("architecture_page")
    assert maker.picture() in maker.PAGE.read_text("utf-8"), "run python docs/architecture_page.py"
