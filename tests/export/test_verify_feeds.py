"""Feeds of single moves: the contact runs at the tool's feed, no faster and no slower."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading
from camgeo.milling.machine import names
from camgeo_export.gcode.writer import WRITER
from camgeo_export.verify.gcode import VERIFIER
from tests.long_form import examples
from tests.toolpath import programs

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
    for number, feed in feeds[:: examples(2, long=1) * (len(feeds) // 24)]:
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
    assert held >= 20


@pytest.mark.parametrize("name", ["setzhub", "groove"])
def test_the_side_of_the_wall_decides(name: str) -> None:
    """Inner arcs at the feed of outer ones cut too fast, outer ones at that of inner too slowly."""
    disc, text = made(name)
    flat = re.sub(r"( F)[\d.]+", lambda found: f"{found[1]}300", text)
    (first, *_) = (check for check in wrong(disc, flat) if check.name == "feed")
    assert float(str(first.value)) > float(str(first.expected))


@pytest.mark.parametrize("climb", [True, False])
def test_only_the_way_back_of_a_loop_runs_at_the_feed(climb: bool) -> None:
    """Of each loop the first part cuts, slowed, as the wall lies around it, and the second leads
    back through the air: any feed from the slowed one up to the tool's is right there, none above.
    """
    loops = programs.operation(
        "rough", "outline", allowance=0.3, strategy="trochoidal", stepdown=6.3,
        direction="climb" if climb else "conventional",
    )  # fmt: skip
    words = f"{programs.PASSES}\nengagement = 80"
    text = programs.scene(programs.mill(1, 12, words), programs.FIXTURE, loops, part="")
    disc = camgeo.loads(text).disc
    program = WRITER.write(disc, TOLERANCE).data.decode()
    assert wrong(disc, program) == []
    lines, feed, arcs = program.split("\n"), 0.0, []
    for number, line in enumerate(lines):
        found = re.search(r"F([\d.]+)", line)
        feed = float(found[1]) if found else feed
        centre = re.search(r"I(\S+) J(\S+)", line)
        if line.startswith(("G2", "G3")) and centre and "Z" not in line:
            radius = math.hypot(float(centre[1]), float(centre[2]))
            arcs.append((number, radius, feed))
    inner = [each for each in arcs if each[1] < 3.5]  # loops, whose radius is half the cutter's
    (way,) = {lines[number][:2] for number, _, _ in inner}
    assert way == ("G3" if climb else "G2")
    back = [number for number, _, own in inner if own == 500.0]
    ahead = [number for number, _, own in inner if own < 250.0]
    assert len(back) + len(ahead) == len(inner)
    assert len(back) > 20
    assert len(ahead) > len(back)

    def with_feed(number: int, own: float) -> list[tuple[str, str]]:
        """The checks that fail where one block has its own feed and all after it their old ones."""
        before = next(each for place, _, each in inner if place == number)
        changed = lines.copy()
        changed[number] = re.sub(r" F[\d.]+", "", lines[number]) + f" F{own:g}"
        after = next(k for k in range(number + 1, len(lines)) if lines[k].startswith("G"))
        if "F" not in lines[after]:
            changed[after] += f" F{before:g}"
        return [(each.name, each.note) for each in wrong(disc, "\n".join(changed))]

    slow = min(own for _, _, own in inner)
    for number in (back[3], back[len(back) // 2]):
        assert with_feed(number, 0.5 * (slow + 500.0)) == []
        assert with_feed(number, 501.0) == [("feed", f"line {number + 1}")]
        assert with_feed(number, 0.9 * slow) == [("feed", f"line {number + 1}")]
    for number in (ahead[3], ahead[len(ahead) // 2 + 1]):
        for own in (1.02 * slow, 500.0, 0.98 * slow):
            assert with_feed(number, own) == [("feed", f"line {number + 1}")]
