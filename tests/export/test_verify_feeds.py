"""Feeds of single moves: the contact runs at the tool's feed, no faster and no slower."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.product.product import Product
from camgeo.toolpath.machine import names
from camgeo.verifying.verification import Check, Reading
from camgeo_export.gcode.writer import WRITER
from camgeo_export.verify.gcode import VERIFIER

SCENES = Path(__file__).resolve().parents[2] / "fixtures" / "scenes"

TOLERANCE = 0.01


@cache
def made(name: str, machine: str = "linuxcnc") -> tuple[Product, str]:
    text = (SCENES / f"{name}.toml").read_text().replace("linuxcnc", machine)
    disc = camgeo.loads(text).disc
    return disc, WRITER.write(disc, TOLERANCE).data.decode()


def wrong(disc: Product, text: str) -> list[Check]:
    found = VERIFIER.checks(disc, text.encode(), Reading("a.ngc", True), TOLERANCE)
    return [check for check in found if check.ok is False]


@pytest.mark.parametrize("machine", names())
def test_all_feeds_of_a_program_are_right(machine: str) -> None:
    assert wrong(*made("setzhub", machine)) == []


def test_every_single_feed_is_held() -> None:
    """A tenth less or more in any one block; the next one states its own again."""
    disc, text = made("swallow_tail")
    lines = text.splitlines()
    feeds: list[tuple[int, float]] = []
    at = 0.0
    for number, line in enumerate(lines):
        at = float(word[1]) if (word := re.search(r" F([\d.]+)$", line)) else at
        if re.match(r"G[123] ", line):
            feeds.append((number, at))
    moves = [number for number, _ in feeds]
    held = 0
    for number, feed in feeds[:: len(feeds) // 24]:
        for share in (0.9, 1.1):
            changed = lines.copy()
            following = next((k for k in moves if k > number), None)
            changed[number] = re.sub(r" F[\d.]+$", "", lines[number]) + f" F{share * feed:.2f}"
            if following is not None:
                own = re.search(r" F[\d.]+$", lines[following])
                changed[following] += "" if own else f" F{feed:g}"
            found = wrong(disc, "\n".join(changed) + "\n")
            assert [check.name for check in found] in (["feed"], ["plunge feed"]), lines[number]
            assert found[0].note == f"line {number + 1}"
            held += 1
    assert held >= 40


@pytest.mark.parametrize("name", ["setzhub", "groove"])
def test_the_side_of_the_wall_decides(name: str) -> None:
    """Inner arcs at the feed of outer ones cut too fast, outer ones at that of inner too slowly."""
    disc, text = made(name)
    flat = re.sub(r"( F)[\d.]+", lambda found: f"{found[1]}300", text)
    (first, *_) = (check for check in wrong(disc, flat) if check.name == "feed")
    assert float(str(first.value)) > float(str(first.expected))
