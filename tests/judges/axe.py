"""axe-core, which looks for what keeps people from using a page; found where npm has put it."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.judges.browsing import Visit
from tests.judges.node import BROWSER, INSTALL, NPM

FILE: Final = Path("node_modules", "axe-core", "axe.min.js")

RUN: Final = """async () => {
  const found = await axe.run(document);
  return { told: found.violations.map((each) => `${each.id}: ${each.nodes[0].html}`) };
}"""
"""All rules that it has switched on, of any severity."""


def kept() -> bool:
    """Whether npm has put it there."""
    return (BROWSER / FILE).exists()


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    if kept() or not NPM.absent():
        return ""
    return f"no axe-core in {BROWSER.name}/node_modules (npm ci), and {NPM.absent()}"


@cache
def script() -> str:
    """Its text: that of the locked version, which npm fetches if it is not there yet."""
    if kept():
        return (BROWSER / FILE).read_text("utf-8")
    with TemporaryDirectory() as name:
        for each in ("package.json", "package-lock.json", ".npmrc"):
            shutil.copy(BROWSER / each, name)
        NPM.run(INSTALL, Path(name))
        return Path(name, FILE).read_text("utf-8")


def violations(visit: Visit) -> list[str]:
    """What it finds on a page, each with the first place."""
    if not visit.page.evaluate("'axe' in window"):
        visit.page.evaluate(script())
    told: list[str] = visit.ask("an answer of axe", RUN)["told"]
    return told
