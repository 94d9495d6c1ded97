"""What verify reports on a file is a continuous function of the numbers in it."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo_export.dxf.writer import WRITER
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.threemf.writer import MODEL_PATH
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.dxf import VERIFIER
from camgeo_export.verify.gcode import VERIFIER as GCODE_VERIFIER
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.export.stub_product import StubProduct
from tests.export.verified import TOLERANCE, Checks, checked
from tests.packages import repacked

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

STEPS = (1e-12, 1e-9, 1e-6, 1e-3)

COORDINATES = ("10", "20", "11", "21")

BULGE = "42"

LONGEST = 40.0
"""Length of a piece [mm]: its middle moves by half of it times the change of the bulge."""

SLACK = 0.015
"""Fraction by which a proved bound may exceed a deviation from a curve."""

EACH = 2
"""Numbers of each kind that are moved by each step."""

ECCENTRIC = StubProduct()


@cache
def disc(scene: str, entity: str) -> Product:
    text = (SCENES / f"{scene}.toml").read_text("utf-8")
    return camgeo.loads(f'{text}\n[output.dxf]\nentity = "{entity}"\n').disc


@cache
def drawing(scene: str, entity: str) -> tuple[str, ...]:
    """The lines of the scene's drawing, made with half of the tolerance."""
    return tuple(WRITER.write(disc(scene, entity), 0.5 * TOLERANCE).data.decode().split("\n"))


def places(lines: tuple[str, ...], codes: tuple[str, ...]) -> list[int]:
    """Indices of the values of the groups `codes` in the entities."""
    start = lines.index("ENTITIES")
    return [k + 1 for k in range(start + 1, len(lines) - 1, 2) if lines[k].strip() in codes]


def verified(scene: str, entity: str, lines: list[str]) -> Checks:
    reading = Reading(f"{scene}.dxf")
    return checked(VERIFIER, disc(scene, entity), "\n".join(lines).encode(), reading)


def deviations(checks: Checks) -> dict[str, float]:
    found = {of: check.value for (name, of), check in checks.items() if name == "deviation"}
    assert all(isinstance(value, float) for value in found.values())
    return {of: float(value or 0.0) for of, value in found.items()}


KINDS = [("setzhub", "arcs"), ("setzhub", "spline"), ("plate_translating", "polyline")]


@pytest.mark.parametrize(("scene", "entity"), KINDS)
@pytest.mark.parametrize("step", STEPS)
def test_a_moved_number_moves_the_deviation_by_no_more(
    scene: str, entity: str, step: float
) -> None:
    """Except for the slack of the bound where the exact curve is not made of arcs."""
    lines = drawing(scene, entity)
    before = deviations(verified(scene, entity, list(lines)))
    chance = random.Random(f"{scene} {step}")
    numbers = [(k, 1.0) for k in chance.sample(places(lines, COORDINATES), EACH)]
    bulges = places(lines, (BULGE,)) if entity == "arcs" else []
    numbers += [(k, LONGEST) for k in chance.sample(bulges, min(EACH, len(bulges)))]
    for place, lever in numbers:
        moved = list(lines)
        moved[place] = repr(float(moved[place]) + step)
        after = deviations(verified(scene, entity, moved))
        assert after.keys() == before.keys()
        for name, value in after.items():
            allowed = 4.0 * lever * step + SLACK * max(value, before[name])
            assert abs(value - before[name]) <= allowed + 1e-12, (lines[place - 1], lines[place])


@pytest.mark.parametrize(("scene", "entity"), KINDS)
@pytest.mark.parametrize("decimals", [3, 4, 5, 6])
def test_rounded_numbers_pass_while_within_the_tolerance(
    scene: str, entity: str, decimals: int
) -> None:
    """Tangent pieces are no longer tangent then, but turn by no more than the tolerance permits."""
    lines = list(drawing(scene, entity))
    for place in places(tuple(lines), (*COORDINATES, BULGE)):
        lines[place] = repr(round(float(lines[place]), decimals))
    checks = verified(scene, entity, lines)
    found = deviations(checks)
    within = {of for of, value in found.items() if value <= TOLERANCE}
    assert within == found.keys() or decimals == 3
    for (_, of), check in checks.items():
        assert check.ok is not False or of not in within, check


@cache
def package() -> bytes:
    return THREEMF.write(disc("setzhub", "arcs"), 0.5 * TOLERANCE).data


def with_numbers(change: Callable[[float], float]) -> bytes:
    """The package with each coordinate of its vertices changed."""

    def moved(path: str, text: str) -> str:
        number = r'\b([xyz])="([^"]+)"'
        if path != MODEL_PATH:
            return text
        return re.sub(number, lambda found: f'{found[1]}="{change(float(found[2]))!r}"', text)

    return repacked(package(), moved)


def verified_package(data: bytes) -> Checks:
    reading = Reading("setzhub.3mf")
    return checked(THREEMF_VERIFIER, disc("setzhub", "arcs"), data, reading)


@pytest.mark.parametrize("step", [1e-12, 1e-9, 1e-6, 1e-3])
def test_moved_vertices_of_a_solid(step: float) -> None:
    """Faces and walls are flat and upright within the tolerance, not to the last digit."""
    chance = random.Random(f"solid {step}")
    before = deviations(verified_package(package()))
    checks = verified_package(with_numbers(lambda value: value + chance.uniform(-step, step)))
    assert all(check.ok is not False for check in checks.values())
    for name, value in deviations(checks).items():
        # Faces that were alike before are reported together; now each is reported by itself.
        of = name if name in before else name.replace("upper", "lower")
        assert abs(value - before[of]) <= 2.0 * step + SLACK * value


@pytest.mark.parametrize("decimals", [3, 4, 5, 6])
def test_rounded_vertices_of_a_solid(decimals: int) -> None:
    checks = verified_package(with_numbers(lambda value: round(value, decimals)))
    assert all(check.ok is not False for check in checks.values())


@cache
def program() -> tuple[str, ...]:
    """The lines of a program made with half of the tolerance."""
    return tuple(GCODE.write(ECCENTRIC, 0.5 * TOLERANCE).data.decode().splitlines())


def verified_program(lines: list[str]) -> Checks:
    reading = Reading("eccentric.ngc")
    return checked(GCODE_VERIFIER, ECCENTRIC, "\n".join(lines).encode(), reading)


@pytest.mark.parametrize("step", STEPS)
def test_moved_ends_of_a_program(step: float) -> None:
    """One after the other, also the point where a path closes, which it need not do exactly."""
    lines = program()
    first = next(k for k, line in enumerate(lines) if line.startswith("G1 Z"))
    before = deviations(verified_program(list(lines)))
    for place in range(first + 1, first + 15):
        moved = list(lines)
        moved[place] = re.sub(
            r"X([-.\d]+)", lambda found: f"X{float(found[1]) + step:.15f}", moved[place]
        )
        checks = verified_program(moved)
        # These have more decimals than a controller reads.
        others = [check for check in checks.values() if check.name != "frame"]
        assert step > 1e-4 or all(check.ok is not False for check in others)
        after = deviations(checks)
        # A path that differs at one depth is reported by itself.
        assert {name.partition(",")[0] for name in after} == before.keys()
        for name, value in after.items():
            assert abs(value - before[name.partition(",")[0]]) <= 10.0 * step + 1e-12
