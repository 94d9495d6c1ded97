"""Licenses of all that is required at run time: none is the GPL or AGPL, and the page of notices
names the rest of that family."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, PathDistribution, distribution
from pathlib import Path
from typing import Final

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT: Final = Path(__file__).resolve().parents[1]

NOTICES: Final = (ROOT / "NOTICES.md").read_text("utf-8")

FAMILY: Final = {
    "GPL": re.compile(r"\bA?GPL(?![- ]compatible)|\b(?:GNU|Affero)\s+General\s+Public"),
    "LGPL": re.compile(r"\bLGPL|\b(?:Lesser|Library)\s+General\s+Public", re.IGNORECASE),
}
"""How the licenses are written out; "LGPL" does not match as "GPL"."""

WHOLE: Final = re.compile(r"GNU LESSER GENERAL PUBLIC LICENSE.*?END OF TERMS", re.DOTALL)
"""The LGPL itself, which speaks of the GPL."""

TEXTS: Final = re.compile(r"licen[cs]e|copying|notice", re.IGNORECASE)
"""Names of files that hold terms."""

LONGEST: Final = 100
"""Characters of a license's name; a longer field is its text, with those of what it carries."""


def required(name: str) -> dict[str, Distribution]:
    """A distribution and all that it requires here at run time, by their names."""
    found: dict[str, Distribution] = {}
    waiting = [Requirement(name)]
    asked = set()
    while waiting:
        requirement = waiting.pop()
        key = canonicalize_name(requirement.name)
        found.setdefault(key, distribution(key))
        for extra in {"", *requirement.extras}:
            if (key, extra) in asked:
                continue
            asked.add((key, extra))
            needs = (Requirement(each) for each in found[key].requires or ())
            waiting += [
                each for each in needs if not each.marker or each.marker.evaluate({"extra": extra})
            ]
    return found


def stated(one: Distribution) -> list[str]:
    """The licenses that its metadata states, each of which applies."""
    head = one.metadata
    if "License-Expression" in head:
        return re.split(r"\s+AND\s+", re.sub("[()]", "", head["License-Expression"]))
    classifiers = [each for each in head.get_all("Classifier", []) if each.startswith("License ::")]
    named = head["License"].strip() if "License" in head else ""
    return classifiers or ([named] if named and len(named) <= LONGEST else [])


def imposed(license_: str, kind: str) -> bool:
    """Whether a license is of the `kind` whichever of its alternatives is chosen."""
    alternatives = re.split(r"\s+OR\s+", license_)
    return all(FAMILY[kind].search(each) and " WITH " not in each for each in alternatives)


def told(name: str, notices: str) -> str:
    """What the page says of a package: its rows, and sentences that begin with its notice."""
    rows = [row for row in notices.splitlines() if row.startswith("| ")]
    there = [row for row in rows if name in re.split(r"[ ,]+", row.split("|")[1].strip())]
    return "\n".join([*there, *re.findall(rf"The notice of {re.escape(name)} .*", notices)])


def carried(one: Distribution) -> Iterator[str]:
    """Names of shared libraries that a wheel carries in its `.libs` folder."""
    for path in one.files or ():
        if path.parts[0].endswith(".libs") and ".so" in path.name:
            yield re.sub(r"(-[0-9a-f]{8})*(-\d[\d.]*)?\.so.*", "", path.name)


def faults(packages: Iterable[Distribution], notices: str) -> list[str]:
    """What is wrong with the licenses of packages, or missing in the notices."""
    found = []
    for one in packages:
        name = canonicalize_name(one.metadata["Name"])
        licenses = stated(one)
        if not licenses:
            found.append(f"{name} states no license")
        found += [f"{name} is under {each}" for each in licenses if imposed(each, "GPL")]
        page = told(name, notices)
        texts = {"its metadata": "\n".join(licenses)}
        for path in one.files or ():
            if TEXTS.search(path.name) and path.suffix not in (".py", ".pyi", ".pyc"):
                text = Path(str(path.locate())).read_text("utf-8", errors="replace")
                texts[path.name] = WHOLE.sub("LGPL", text)
        for kind, pattern in FAMILY.items():
            where = sorted(file for file, text in texts.items() if pattern.search(text))
            if where and not pattern.search(page):
                found.append(f"{name}: {', '.join(where)} speaks of the {kind}, not the notices")
        for library in sorted(set(carried(one))):
            if not re.search(rf"`{re.escape(library)}|\b{re.escape(library)}\b", page):
                found.append(f"{name}: {library} is not in the notices")
    return found


@pytest.mark.parametrize(
    ("extra", "known"),
    [
        ("", {"numpy", "shapely", "pillow", "tzdata"}),
        ("[design]", {"starlette", "uvicorn", "websockets", "anyio"}),
        ("[notebook]", {"anywidget", "ipywidgets", "ipython", "traitlets"}),
        ("[cluster]", {"dask", "distributed", "tornado", "cloudpickle"}),
    ],
)
def test_nothing_required_is_under_the_gpl_and_the_notices_are_complete(
    extra: str, known: set[str]
) -> None:
    packages = required(f"camgeo{extra}")
    assert known <= packages.keys()
    assert not {"pytest", "lib3mf"} & packages.keys()
    del packages["camgeo"]
    assert faults(packages.values(), NOTICES) == []


def test_the_locked_packages_are_those_that_are_looked_at() -> None:
    lock = (ROOT / "requirements.lock").read_text("utf-8")
    locked = set(re.findall(r"(?m)^([a-z0-9-]+)==", lock))
    assert locked == required("camgeo").keys() - {"camgeo"}


def fake(folder: Path, head: str, files: dict[str, str]) -> Distribution:
    """A distribution of that metadata and those files."""
    info = folder / "thing-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.4\nName: thing\nVersion: 1.0\n{head}\n")
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    (info / "RECORD").write_text("".join(f"{name},,\n" for name in files))
    return PathDistribution(info)


GNU = "License :: OSI Approved :: GNU"
LESSER = "GNU LESSER GENERAL PUBLIC LICENSE\nunlike the GNU General Public License\nEND OF TERMS"
ROW = "| thing | libgeos | LGPL 2.1 | shared |"


@pytest.mark.parametrize(("head", "files", "notices", "fault"), [
    ("License-Expression: MIT", {}, "", ""),
    ("License-Expression: GPL-3.0-or-later", {}, "", "is under GPL"),
    ("License-Expression: MIT AND (AGPL-3.0-only)", {}, "", "is under AGPL"),
    ("License-Expression: GPL-2.0-only", {}, "| thing | | GPL |", "is under GPL"),
    ("License-Expression: MIT OR GPL-2.0-only", {}, "| thing | | MIT, or GPL |", ""),
    ("License-Expression: MIT OR GPL-2.0-only", {}, "", "metadata speaks of the GPL"),
    ("License: GNU Affero General Public License", {}, "", "is under GNU Affero"),
    (f"Classifier: {GNU} General Public License v3 (GPLv3)", {}, "", "is under License"),
    (f"Classifier: {GNU} Library or Lesser General Public License (LGPL)", {}, "", "of the LGPL"),
    (f"Classifier: {GNU} Library or Lesser General Public License (LGPL)", {}, ROW, ""),
    ("License: BSD", {"thing/COPYING": "this is GPL-compatible"}, "", ""),
    ("License: BSD", {"thing/COPYING": LESSER}, "", "COPYING speaks of the LGPL"),
    ("License: BSD", {"thing/COPYING": LESSER}, ROW.replace("thing", "things"), "of the LGPL"),
    ("License: BSD", {"thing/COPYING": LESSER}, ROW, ""),
    ("License: BSD", {"thing.libs/libgeos-0a1b2c3d.so.3.14": ""}, "", "libgeos is not in"),
    ("License: BSD", {"thing.libs/libgeos-0a1b2c3d.so.3.14": ""}, ROW, ""),
    ("", {}, "", "states no license"),
])  # fmt: skip
def test_a_package_of_another_license_is_found(
    head: str, files: dict[str, str], notices: str, fault: str, tmp_path: Path
) -> None:
    found = faults([fake(tmp_path, head, files)], notices)
    assert found == [] if not fault else fault in " ".join(found)


def carried_by_script(text: str) -> list[str]:
    """Rows of the notices for the packages in a script for browsers, which has their licenses."""
    pattern = r"^It contains (\S+) [\d.]+ \((.*)\)\n\n(.*\n){,5}Permission is hereby granted"
    found = re.findall(pattern, text, re.MULTILINE)
    return [rf"^\| {re.escape(name)} \|.*\| {re.escape(terms)} \|$" for name, terms, _ in found]


def test_packages_in_scripts_for_browsers_are_in_the_notices() -> None:
    folder = ROOT / "export" / "camgeo_export" / "browser" / "bundle"
    texts = [path.read_text("utf-8") for path in folder.iterdir()]
    rows = [row for text in texts for row in carried_by_script(text)]
    assert len(rows) == sum(text.count("It contains ") for text in texts) > 0
    assert all(re.search(row, NOTICES, re.MULTILINE) for row in rows)
    assert all(row.endswith(r"MIT \|$") for row in rows)
