"""Files of the same scenes, made where the last digits of numbers differ, and made elsewhere.

    python -m tests.end_to_end.repeats [--tolerance MM] [--setting NAME] [SCENE ...]

builds the scenes (by default all in fixtures that make files) in every format that they can be
written in: in a process like this one, and in one for each of `SETTINGS`, or of those named. A line
for each format says in how many files bytes differ, and by how much numbers do. The exit code is 1
if a promise of docs/robustness.md is broken.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

import camgeo
from camgeo.app.answers.verify import NUMBER
from camgeo.design.writing import find_writer, writer_names
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo_export.verify.dxf import VERIFIER as DXF
from camgeo_export.verify.gcode import VERIFIER as GCODE
from camgeo_export.verify.stl import VERIFIER as STL
from camgeo_export.verify.threemf import VERIFIER as THREEMF

ROOT: Final = Path(__file__).parents[2]

LENGTHS: Final = 1e-9
"""Largest difference [mm] of a coordinate between processors, and of the other numbers of a
drawing: bulges, knots, degrees."""

SHARE: Final = 1e-11
"""Largest difference of other numbers, in addition to `LENGTHS`, as a share of the largest in their
column, or in the certificate of themselves."""

ROWS: Final = 1e-12
"""Largest difference of an answer in a sweep, as a share of the largest magnitude in its column.

That is 4500 roundings: kernels that differ by four of them, and formulas that amplify these a
thousand times."""

PICTURES: Final = (".svg", ".png", ".pdf")
"""Files that may differ between processors."""

NUMPY: Final = {
    "NPY_DISABLE_CPU_FEATURES": " ".join(
        np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    )
}
"""Only the features that numpy was compiled to require."""

BLAS: Final = {"OPENBLAS_CORETYPE": "Prescott"}
"""OpenBLAS's kernels of 2004, with SSE3, in numpy and in scipy."""

LIBM: Final = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
"""glibc's functions without fused multiplication."""

ELSEWHERE: Final = {
    "PYTHONHASHSEED": "4",
    "TZ": "UTC+11",
    "LC_ALL": "de_DE.UTF-8",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}
"""Surroundings that must leave no trace, besides working directory, home and umask."""

SETTINGS: Final[dict[str, dict[str, str]]] = {
    "elsewhere": ELSEWHERE,
    "numpy": NUMPY,
    "blas": BLAS,
    "nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
    "libm": LIBM,
    "all": {**NUMPY, **BLAS, **LIBM},
}

REAL: Final = re.compile(r"-?\d+\.\d*(?:E-?\d+)?")

TOKENS: Final = {
    ".dxf": DXF.tokens, ".ngc": GCODE.tokens, ".stl": STL.tokens, ".3mf": THREEMF.tokens,
}  # fmt: skip

FLATNESS: Final = 1e-8
"""By how much the radius and the centre of an arc may differ, per square of the radius [1/mm]: as
much as bulges that differ by `LENGTHS` make of chords of half a millimetre."""


@dataclass(frozen=True)
class Content:
    """A file taken apart.

    Attributes
    ----------
    rest : everything but the numbers: entities, their kinds and their order.
    numbers : (n,) that may differ.
    allowed : (n,) how much each may.
    """

    rest: tuple[Any, ...]
    numbers: FloatArray
    allowed: FloatArray


def content(path: Path) -> Content:
    """A file of camgeo's, but a picture, taken apart."""
    others = {".csv": _table, ".step": _step, ".asc": _table, ".json": _certificate}
    data = path.read_bytes()
    return others[path.suffix](data) if path.suffix in others else _tokens(path.suffix, data)


def _tokens(suffix: str, data: bytes) -> Content:
    """Those that `camgeo verify` compares; what is no whole number is one that may differ."""
    rest, numbers = [], []
    for _, token in TOKENS[suffix](data):
        found = NUMBER.fullmatch(token)
        is_real = found is not None and not found[2].lstrip("+-").isdigit()
        rest.append(found[1] if found is not None and is_real else token)
        numbers += [float(found[2])] if found is not None and is_real else []
    return Content(tuple(rest), np.array(numbers), np.full(len(numbers), LENGTHS))


def _step(data: bytes) -> Content:
    text = data.decode("ascii")
    lines = dict(line[1:].split("=", 1) for line in text.splitlines() if line.startswith("#"))
    more = dict.fromkeys(lines, 0.0)  # what is allowed in addition, by the numbers of entities
    for number, line in lines.items():
        kind, _, values = line.partition("(")
        if kind in ("CIRCLE", "CYLINDRICAL_SURFACE"):
            axes, radius = re.findall(r"#(\d+),(.*)\)", values)[0]
            centre, _, first = re.findall(r"#(\d+)", lines[axes])
            flatness = FLATNESS * float(radius)
            more |= {number: flatness * float(radius), first: flatness}
            more[centre] = flatness * float(radius)
    numbers: list[float] = []
    allowed: list[float] = []
    for number, line in lines.items():
        found = [float(value) for value in REAL.findall(line)]
        numbers += found
        allowed += [LENGTHS + more[number]] * len(found)
    return Content((REAL.sub("#", text),), np.array(numbers), np.array(allowed))


def _table(data: bytes) -> Content:
    rows = [line.split(",") for line in data.decode().splitlines()]
    heading = [] if rows[0][0].lstrip("-")[0].isdigit() else rows.pop(0)
    values = np.array(rows, dtype=np.float64)
    size = np.max(np.where(np.isfinite(values), np.abs(values), 0.0), axis=0)
    of_lengths = [name.endswith(("[mm]", "[inch]")) and "r_K" not in name for name in heading]
    other = ~np.array(of_lengths, dtype=np.bool_) if heading else np.zeros(len(size), np.bool_)
    allowed = np.broadcast_to(LENGTHS + np.where(other, SHARE * size, 0.0), values.shape)
    return Content((heading, values.shape), values.ravel(), allowed.ravel())


def _certificate(data: bytes) -> Content:
    rest: list[Any] = []
    numbers: list[float] = []

    def walk(value: Any, path: str) -> None:
        if isinstance(value, dict):
            for key, inside in value.items():
                if key not in ("sha256", "bytes"):
                    walk(inside, f"{path}/{key}")
        elif isinstance(value, list):
            for number, inside in enumerate(value):
                walk(inside, f"{path}/{number}")
        elif isinstance(value, float):
            rest.append(path)
            numbers.append(value)
        else:
            rest.append((path, value))

    walk(json.loads(data), "")
    found = np.array(numbers)
    return Content(tuple(rest), found, LENGTHS + SHARE * np.abs(found))


@dataclass(frozen=True)
class Difference:
    """What differs between two files of one name.

    Attributes
    ----------
    file : name.
    bytes_differ : whether anything does.
    entities_differ : whether anything but the last digits of numbers does; never of a picture.
    farthest : largest difference of a number.
    excess : the largest difference as a multiple of what is allowed.
    """

    file: str
    bytes_differ: bool = False
    entities_differ: bool = False
    farthest: float = 0.0
    excess: float = 0.0

    @property
    def broken(self) -> bool:
        """Whether a promise about other processors is broken."""
        return self.entities_differ or not self.excess <= 1.0


def difference(one: Path, other: Path) -> Difference:
    """What differs between two files."""
    if not other.exists():
        return Difference(one.name, bytes_differ=True, entities_differ=True)
    if one.read_bytes() == other.read_bytes():
        return Difference(one.name)
    if one.suffix in PICTURES:
        return Difference(one.name, bytes_differ=True)
    return compared(one.name, content(one), content(other))


def compared(name: str, here: Content, there: Content) -> Difference:
    """What differs between two contents of the file `name` that are not equal."""
    if here.rest != there.rest or len(here.numbers) != len(there.numbers):
        return Difference(name, bytes_differ=True, entities_differ=True)
    same = here.numbers == there.numbers
    with np.errstate(invalid="ignore"):  # two infinite radii
        apart = np.where(same, 0.0, np.abs(here.numbers - there.numbers))
    farthest, excess = np.max(apart, initial=0.0), np.max(apart / here.allowed, initial=0.0)
    return Difference(name, True, False, float(farthest), float(excess))


def differences(one: Path, other: Path) -> list[Difference]:
    """The differences of all files in the folder `one`."""
    return [difference(path, other / path.name) for path in sorted(one.iterdir())]


def scenes() -> list[Path]:
    """All scenes in fixtures that are valid."""
    folders = ("scenes", "effects", "found")
    return sorted(path for name in folders for path in (ROOT / "fixtures" / name).glob("*.toml"))


def make(scene: Path, folder: Path, tolerance: float | None = None) -> None:
    """Write a scene into `folder` in every format that it allows; nothing if its cam has no
    outline.
    """
    design = camgeo.load(scene)
    lacks = {name: find_writer(name).format.lacking for name in writer_names()}
    formats = [name for name, lacking in lacks.items() if not lacking(design.disc.values)]
    with suppress(GeometryError):
        design.write(folder, formats, tolerance=tolerance)


def make_in_child(
    given: Sequence[Path], folder: Path, setting: dict[str, str], tolerance: float | None = None
) -> None:
    """`make` the files of scenes, each in a folder of its stem, in another process with another
    home, umask and working directory.
    """
    command = ["tests.end_to_end.repeats", "--into", str(folder)]
    command += ["--tolerance", str(tolerance)] if tolerance else []
    run_elsewhere([*command, *map(str, given)], folder.with_name(f"{folder.name}-home"), setting)


def run_elsewhere(command: Sequence[str], home: Path, setting: dict[str, str]) -> None:
    """Run a module, with its arguments, in another process with a `home` of its own, which is also
    its working directory, and another umask.
    """
    home.mkdir(parents=True)
    path = os.pathsep.join((str(ROOT), os.environ.get("PYTHONPATH", "")))
    subprocess.run(
        [sys.executable, "-m", *command],
        env={**os.environ, "HOME": str(home), "PYTHONPATH": path, **setting},
        cwd=home, umask=0o077, check=True, stdout=subprocess.DEVNULL,
    )  # fmt: skip


def _line(found: list[Difference]) -> str:
    """One line on the differences in a format."""
    changed = sum(each.bytes_differ for each in found)
    entities = [each.file for each in found if each.entities_differ]
    farthest = max(found, key=lambda each: each.farthest)
    excess = max(each.excess for each in found)
    text = f"{len(found):4} files, bytes differ in {changed:3}"
    if changed and Path(farthest.file).suffix not in PICTURES:
        text += f", numbers by {farthest.farthest:.1e} ({farthest.file}), {excess:.3f} of allowed"
    return text + (f"; OTHER ENTITIES in {', '.join(entities)}" if entities else "")


def main() -> int:
    """The table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--tolerance", metavar="MM", type=float)
    parser.add_argument("--setting", choices=SETTINGS, action="append")
    parser.add_argument("--into", metavar="FOLDER", type=Path, help="build only, into a folder")
    parser.add_argument("scenes", metavar="SCENE", nargs="*", type=Path)
    arguments = parser.parse_args()
    given = [scene.resolve() for scene in arguments.scenes] or scenes()
    if arguments.into:
        for scene in given:
            make(scene, arguments.into / scene.parent.name / scene.stem, arguments.tolerance)
        return 0
    bad, show = 0, sys.stdout.write
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        build = functools.partial(make_in_child, given, tolerance=arguments.tolerance)
        build(work / "here", {})
        folders = [each for each in (work / "here").glob("*/*") if any(each.iterdir())]
        for name in arguments.setting or SETTINGS:
            setting = SETTINGS[name]
            build(work / name, setting)
            show(f"{name}: {' '.join(f'{key}={value}' for key, value in setting.items())}\n")
            found = [
                each
                for folder in sorted(folders)
                for each in differences(folder, work / name / folder.relative_to(work / "here"))
            ]
            for suffix in sorted({Path(each.file).suffix for each in found}):
                kind = [each for each in found if Path(each.file).suffix == suffix]
                show(f"  {suffix:6}{_line(kind)}\n")
            same = name == "elsewhere"
            bad += sum(each.bytes_differ if same else each.broken for each in found)
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
