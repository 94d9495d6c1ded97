"""Random tables under rollers and flat faces: what remains, against all places of the follower.

    python -m tests.draws.trimmed [--count N] [--seed HEX] [--rows FILE]

Rows every 0.25 to 5 degrees are off by noise, some by a single bad row, so that the roller cuts off
up to hundreds of stretches, many a hundredth of a degree wide. A point of the flank is on the disc
if the roller covers it nowhere, or the face passes it everywhere: here it is put to 36,000 places.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

import camgeo
from camgeo.errors import CamgeoError
from tests.draws.run import Case, parser_of, run_cases

TURN: Final = 2.0 * np.pi

PLACES: Final = 36_000
"""Of the roller in a turn; every eighth is that of a point of the flank."""

COVERED: Final = 1e-6
"""A point [mm] deeper in a roller than the places resolve: half of 8 um, squared, over 3 mm."""

WINDOW: Final = 2000
"""Places before and after a point's own: 20 degrees, for sides farther apart do not meet here."""

PARTS: Final = np.linspace(0.0, 1.0, 201)
"""Places in a range that is cut off, in which the flank runs back: no two sides meet far apart."""

SCENE: Final = """
camgeo = 1
name = "drawn"
[cam]
rotation = "{rotation}"
[follower]
base_radius = 45
{follower}
[[motion]]
law = "table"
span = 360
file = "lift.csv"
[output]
formats = ["csv"]
"""


def drawn(rng: np.random.Generator, folder: Path) -> tuple[Path, float | None, float, int]:
    """A scene, with the roller's radius, None for a flat face, the offset [mm] and sigma."""
    step = float(rng.choice([0.25, 0.5, 1.0, 2.0, 5.0]))
    phi = np.arange(0.0, 360.0, step)
    moved = np.radians(np.clip((phi - 60.0) * 1.8, 0.0, 360.0))
    wave = rng.integers(3)
    lift = [10.0 - 10.0 * np.cos(np.radians(phi)), 6.0 - 6.0 * np.cos(2.0 * np.radians(phi)),
            10.0 - 10.0 * np.cos(moved)][wave]  # fmt: skip
    lift = lift + rng.normal(0.0, step**2 * 10.0 ** rng.uniform(-3.5, -1.7), len(phi))
    if rng.random() < 0.5:
        lift[rng.integers(len(phi))] += rng.uniform(-0.2, 0.2) * min(step, 1.0)
    rows = zip([*phi, 360.0], [*lift, lift[0]] - np.min(lift), strict=True)
    (folder / "lift.csv").write_text("".join(f"{a:.6g},{s:.9f}\n" for a, s in rows), "utf-8")
    roller, offset = float(rng.choice([3.0, 8.0, 14.0, 20.0])), float(rng.choice([0.0, 5.0, -8.0]))
    sense = int(rng.choice([-1, 1]))
    rotation = "ccw" if sense > 0 else "cw"
    path = folder / "scene.toml"
    kind = f'kind = "translating-roller"\nroller_radius = {roller}\noffset = {offset}'
    is_face = rng.random() < 0.4
    follower = 'kind = "translating-flat"' if is_face else kind
    path.write_text(SCENE.format(rotation=rotation, follower=follower), "utf-8")
    return path, None if is_face else roller, offset, sense


def miss(path: Path, roller: float | None, offset: float, sense: int) -> str:
    """What is wrong with what remains; "" if nothing is."""
    cam = camgeo.load(path).cam
    try:
        outline = cam.disc.outline("inner")
    except CamgeoError as error:
        return f"refused: {error}"

    def flank(angles: np.ndarray) -> tuple[np.ndarray, ...]:
        """What the follower is at, its lift [mm], points of the flank, and which way it goes."""
        lift, velocity = cam.drive.motion.jet(angles)[:2]
        ray = 1j * np.exp(-1j * sense * angles)
        if roller is None:
            points = ray * (45.0 + lift - 1j * sense * velocity)
            return ray, lift, points, -1j * sense * ray
        height = np.sqrt(45.0**2 - offset**2)
        centre = ray * (height + lift - 1j * offset)
        way = ray * velocity - 1j * sense * centre
        inward = 1j * way / np.abs(way)
        points = centre + roller * inward * -np.sign((inward * centre.conj()).real)
        return centre, lift, points, way

    phi = np.arange(PLACES) * (TURN / PLACES)
    own = np.arange(0, PLACES, 8)
    at = phi[own] + 1e-5
    held, lift, _, _ = flank(phi)
    points = flank(at)[2]
    held, lift = (np.concatenate((e[-WINDOW:], e, e[:WINDOW])) for e in (held, lift))
    room = np.full(len(own), np.inf)
    for step in range(2 * WINDOW + 1):
        one = held[own + step]
        if roller is None:
            left = 45.0 + lift[own + step] - (one.conj() * points).real
        else:
            left = np.abs(points - one) - roller
        np.minimum(room, left, out=room)
    dropped = np.zeros(len(own), dtype=np.bool_)
    for start, end in outline.dropped:
        dropped |= (at - start) % TURN < end - start
        _, _, inside, way = flank(start + (end - start) * PARTS)
        if np.all((np.diff(inside) * way[:-1].conj()).real > 0.0):
            return f"dropped from {np.degrees(start):.6f} deg though it runs forward there"
    kept = ~dropped & (room < -COVERED)
    return f"kept but covered at {np.degrees(at[kept][0]):.6f} deg" if np.any(kept) else ""


def misses(count: int, seed: int) -> Iterator[Case]:
    """Each case and its miss."""
    for number in range(count):
        with tempfile.TemporaryDirectory() as folder:
            missed = miss(*drawn(np.random.default_rng([seed, number]), Path(folder)))
        yield f"{number}", [missed] if missed else []


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 300), lambda asked: misses(asked.count, asked.seed)))
