"""The documentation says what the code does."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.pages import page_maker

ROOT = Path(__file__).resolve().parents[1]


def test_the_page_of_the_scene_file_is_made_from_the_schema() -> None:
    written = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    assert page_maker("scene_page").page() == written, "run python docs/scene_page.py"


def test_the_python_lines_of_the_readme_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    code = readme.split("```python\n")[1].split("```")[0]
    code = code.replace('"out"', repr(str(tmp_path / "out")))
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    exec(compile(code, "README.md", "exec"), names)
    assert (tmp_path / "out" / "setzhub.dxf").is_file()
    assert (tmp_path / "out" / "setzhub.3mf").is_file()


def test_the_scene_lines_of_the_readme_are_a_valid_scene() -> None:
    from camgeo.scene.load import parse_scene

    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    heart = readme.split("```toml\n")[1].split("```")[0]
    scene = parse_scene('camgeo = 1\nname = "readme"\n[cam]\nrotation = "ccw"\n' + heart)
    assert scene.follower.base_radius == 50.0
