"""A scene that takes too long to compute, on the designer's page: it says so, and lives on."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from tests.judges.browsing import Visit, memory
from tests.judges.designer_page import JOINTS, DesignerPage, Server
from tests.judges.designer_scenes import design_of
from tests.judges.painted import farthest
from tests.judges.programs_of_others import Refusal

SEGMENTS: Final = 6000

SLOW: Final = "slow.toml"

GROWTH: Final = 500e6
"""Bytes by which memory may have grown afterwards."""


def slow_scene() -> str:
    """A scene of so many segments that its picture takes more than a minute."""
    head = (
        'camgeo = 1\nname = "slow"\n[cam]\nrotation = "ccw"\nspeed = 100\n[follower]\n'
        'kind = "translating-roller"\nbase_radius = 5000\nroller_radius = 5\n'
    )
    return head + "".join(
        f'[[motion]]\nlaw = "polynomial-345"\nspan = {360.0 / SEGMENTS!r}\nto = {1 - number % 2}\n'
        for number in range(SEGMENTS)
    )


def judged(page: DesignerPage, folder: Path, server: Server, browser: int, small: str) -> str:
    """Open and drag such a scene after a small one, then that one again; what came of it.

    Parameters
    ----------
    browser : number of its process.

    Raises
    ------
    Refusal
        If the page does not live, or says nothing, or memory grows.
    """
    (folder / SLOW).write_text(slow_scene(), "utf-8")
    page.open(small)
    before = memory(server.process.pid), memory(browser)
    page.choose(SLOW)
    told(page.visit, "camgeo.session.refused")
    refused = page.hold(JOINTS, (1, 1))  # of the last picture, which is still there
    page.let_go()
    if refused:
        raise Refusal("a drag is followed though there is no picture")
    told(page.visit, "camgeo.session.refused")
    page.open(small)
    found = page.painted()
    if found["faults"]:
        raise Refusal("a small scene after a slow one has faults")
    farthest(design_of(found["text"], folder / small), found)
    for what, old, new in zip(
        ("server", "browser"), before, (memory(server.process.pid), memory(browser)), strict=True
    ):
        if new > old + GROWTH:
            raise Refusal(f"the memory of the {what} has grown from {old:.2g} to {new:.2g} bytes")
    return f"{SEGMENTS} segments refused, the next scene there"


def told(visit: Visit, said: str) -> None:
    """Wait until the page says that something took too long; it answers all the while."""

    def is_told() -> bool:
        return "longer than" in visit.ask("an answer of the page", f"() => [{said}]")[0]

    visit.until("that a scene takes too long", is_told)
