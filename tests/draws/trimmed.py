"""Random tables under a roller: what remains of the flank, against all places of the roller.

    python -m tests.draws.trimmed [--count N] [--seed HEX] [--rows FILE]

Rows every 0.25 to 5 degrees are off by noise, some by a single bad row, so that the roller cuts off
up to hundreds of stretches, many a hundredth of a degree wide. A point of the flank is on the disc
if the roller covers it nowhere: here it is put to 36,000 places.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

import camgeo
from camgeo.errors import CamgeoError
from tests.seeds import add_commit_seed

TURN: Final = 2.0 * np.pi

PLACES: Final = 36_000
"""Of the roller in a turn; every eighth is that of a point of the flank."""

COVERED: Final = 1e-6
"""A point [mm] deeper in a roller than the places resolve: half of 8 um, squared, over 3 mm."""

WINDOW: Final = 2000
"""Places before and after a point's own: 20 degrees, for sides farther apart do not meet here."""

SCENE: Final = """
camgeo = 1
name = "drawn"
[cam]
rotation = "{rotation}"
[follower]
kind = "translating-roller"
base_radius = 45
roller_radius = {roller}
offset = {offset}
[[motion]]
law = "table"
span = 360
file = "lift.csv"
[output]
formats = ["csv"]
"""


def drawn(rng: np.random.Generator, folder: Path) -> tuple[Path, float, float, int]:
    """A scene, with roller radius and offset [mm] and sigma."""
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
    text = SCENE.format(rotation=rotation, roller=roller, offset=offset)
    path.write_text(text, "utf-8")
    return path, roller, offset, sense


def miss(path: Path, roller: float, offset: float, sense: int) -> str:
    """What is wrong with what remains; "" if nothing is."""
    cam = camgeo.load(path).cam
    try:
        outline = cam.disc.outline("inner")
    except CamgeoError as error:
        return f"refused: {error}"
    phi = np.arange(PLACES) * (TURN / PLACES)
    own = np.arange(0, PLACES, 8)
    at = phi[own] + 1e-5
    height = np.sqrt((45.0 + roller) ** 2 - offset**2)

    def centre(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Roller centres in the cam [mm], and how they go on [mm/rad]."""
        lift = cam.drive.motion.jet(angles)
        turn = np.exp(-1j * sense * angles)
        there = offset + 1j * (height + lift[0])
        return there * turn, (1j * lift[1] - 1j * sense * there) * turn

    centres, _ = centre(phi)
    there, way = centre(at)
    inward = 1j * way / np.abs(way)
    inward *= -np.sign((inward * there.conj()).real)
    points = there + roller * inward
    around = np.concatenate((centres[-WINDOW:], centres, centres[:WINDOW]))
    gap = np.full(len(own), np.inf)
    for step in range(2 * WINDOW + 1):
        np.minimum(gap, np.abs(points - around[own + step]), out=gap)
    gap -= roller
    dropped = np.zeros(len(own), dtype=np.bool_)
    for start, end in outline.dropped:
        dropped |= (at - start) % TURN < end - start
    kept, lost = ~dropped & (gap < -COVERED), dropped & (gap > COVERED)
    if np.any(kept):
        return f"kept but covered at {np.degrees(at[kept][0]):.6f} deg"
    if np.any(lost) and not outline.lobes:
        return f"dropped but clear at {np.degrees(at[lost][0]):.6f} deg"
    return ""


def misses(count: int, seed: int) -> Iterator[tuple[int, str]]:
    """The number of each case and its miss."""
    for number in range(count):
        with tempfile.TemporaryDirectory() as folder:
            yield number, miss(*drawn(np.random.default_rng([seed, number]), Path(folder)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--rows", type=Path)
    add_commit_seed(parser)
    wanted = parser.parse_args()
    rows = list(misses(wanted.count, wanted.seed))
    found = [f"{number}: {what}" for number, what in rows if what]
    if wanted.rows is not None:
        wanted.rows.write_text("".join(f"{number}\t{what}\n" for number, what in rows), "utf-8")
    print(f"seed {wanted.seed:08x}, {len(rows)} cases, {len(found)} misses", *found, sep="\n")
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
