"""Node makes the scripts for browsers anew: their types are right, their bytes the same."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.judges.programs_of_others import Program, Refusal

NODE: Final = Program("CAMGEO_NODE", "node")
NPM: Final = Program("CAMGEO_NPM", "npm")

INSTALL: Final = ["ci", "--ignore-scripts", "--no-audit", "--no-fund"]

BROWSER: Final = Path(__file__).parents[2] / "export" / "camgeo_export" / "browser"


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return NODE.absent() or NPM.absent()


def differing(kept: Path, made: Path) -> list[str]:
    """Names of files that are in one folder only, or not the same in both."""
    data = [{path.name: path.read_bytes() for path in folder.iterdir()} for folder in (kept, made)]
    return sorted(name for name in data[0] | data[1] if data[0].get(name) != data[1].get(name))


def judge(sources: Path = BROWSER) -> int:
    """How many bundles there are; Refusal if one is not what the locked packages make of them."""
    with TemporaryDirectory() as name:
        copy = Path(name, "browser")
        shutil.copytree(sources, copy, ignore=shutil.ignore_patterns("node_modules", "bundle"))
        NPM.run(INSTALL, copy)
        NPM.run(["run", "check"], copy)
        NODE.run(["build.mjs"], copy)
        wrong = differing(sources / "bundle", copy / "bundle")
        if wrong:
            raise Refusal(f"{', '.join(wrong)}: not what the sources give, npm run build")
        return len(list((copy / "bundle").iterdir()))
