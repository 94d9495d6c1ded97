"""Scripts for browsers are those that their sources give, as far as it can be seen without node."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from pathlib import Path

import pytest

from camgeo_export.browser.bundles import bundle

ROOT = Path(__file__).parents[2]

BROWSER = ROOT / "export" / "camgeo_export" / "browser"

BUNDLES = sorted(path.name for path in (BROWSER / "bundle").iterdir())

HEADER = re.compile(
    r"/\* Made by build\.mjs from:\n(?P<sources>.*)\nsources (?P<of_sources>\w{64})\n"
    r"bundle (?P<of_bundle>\w{64})\n(?P<licenses>.*?)\*/\n(?P<body>.*)",
    re.DOTALL,
)


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def faults(folder: Path, text: str) -> list[str]:
    """What is wrong with a bundle whose sources are in a folder."""
    match = HEADER.fullmatch(text)
    if match is None:
        return ["it has no header"]
    names = match["sources"].split("\n")
    gone = [f"{name} is gone" for name in names if not (folder / name).is_file()]
    if gone:
        return gone
    known = "".join(f"{name} {sha256((folder / name).read_bytes())}\n" for name in names)
    found = []
    if sha256(known.encode()) != match["of_sources"]:
        found.append("it is older than its sources: npm run build")
    if sha256(match["body"].encode()) != match["of_bundle"]:
        found.append("it has been changed by hand, or by a merge: npm run build")
    return found


@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_is_that_of_its_sources(name: str) -> None:
    assert faults(BROWSER, bundle(name)) == []


def test_each_source_is_in_a_bundle() -> None:
    """But those of types alone, which leave nothing to be run."""
    named = {each for name in BUNDLES for each in bundle(name).partition("*/")[0].split("\n")}
    sources = {path.relative_to(BROWSER).as_posix() for path in (BROWSER / "src").rglob("*.ts")}
    unnamed = [(BROWSER / each).read_text("utf-8") for each in sources - named]
    running = re.compile(r"^(export )?(async )?(const|let|function|class) |^\w.*\(", re.MULTILINE)
    assert not [text for text in unnamed if running.search(text)]


def test_stale_bundles_are_found(tmp_path: Path) -> None:
    name = "designer.js"
    kept = shutil.ignore_patterns("node_modules", "bundle")
    shutil.copytree(BROWSER, tmp_path, ignore=kept, dirs_exist_ok=True)
    text = bundle(name)
    assert faults(tmp_path, text) == []
    assert "by hand" in faults(tmp_path, f"{text};")[0]
    assert faults(tmp_path, "alert(1)") == ["it has no header"]
    main = tmp_path / "src" / "designer" / "main.ts"
    main.write_text(main.read_text("utf-8") + "\n", "utf-8")
    assert "older" in faults(tmp_path, text)[0]
    main.unlink()
    assert faults(tmp_path, text) == ["src/designer/main.ts is gone"]


@pytest.mark.parametrize("name", BUNDLES)
def test_a_bundle_can_stand_in_a_page(name: str) -> None:
    """It ends no script element, makes no text into markup or code, and loads nothing."""
    text = bundle(name)
    assert not re.search(r"</script|<!--", text, re.IGNORECASE)
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", text)
    spaces = ("2000/svg", "1999/xhtml", "1999/xlink")  # names of languages, not places
    known = "|".join(re.escape(f"www.w3.org/{each}") for each in spaces)
    assert not re.search(rf"https?://(?!{known})", text)


def test_packages_are_of_stated_versions_from_no_stated_place() -> None:
    """Exact versions with their hashes, from whichever registry is in use."""
    stated = json.loads((BROWSER / "package.json").read_text("utf-8"))
    lock = json.loads((BROWSER / "package-lock.json").read_text("utf-8"))
    packages = {**stated["dependencies"], **stated["devDependencies"]}
    for name, version in packages.items():
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)
        assert lock["packages"][f"node_modules/{name}"]["version"] == version
    for name, each in lock["packages"].items():
        assert "resolved" not in each
        assert not name or each["integrity"].startswith("sha512-")
