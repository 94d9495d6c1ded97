"""Every reader of foreign files as one function: bytes in, a refusal or nothing out."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Final

import camgeo
from camgeo.app.answers.inspect import inspect_points, read_points
from camgeo.app.answers.replay import Reader
from camgeo.app.answers.verify import Reference, Wanted, read_certificate, verify_files
from camgeo.app.cli.import_ import import_project
from camgeo.design.linting import WorkData
from camgeo.design.product import Product
from camgeo.design.writing import find_writer
from camgeo.dynamics.effects.effect import DataFile
from camgeo.dynamics.effects.tables import read_load_table, read_motor
from camgeo.errors import CamgeoError
from camgeo.kinematics.tables import TwoColumns
from camgeo.kinematics.time_course import SpeedCurve
from camgeo.milling.machine import load
from camgeo.studies.inspection import Align
from camgeo_export.contour_csv import READER as CONTOUR
from camgeo_export.dxf.reader import READER as DRAWING
from camgeo_export.interpreter.run import LINTER

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

TOLERANCE: Final = 0.05

ENDINGS: Final = {
    "dxf": "dxf",
    "gcode": "ngc",
    "stl": "stl",
    "3mf": "3mf",
    "step": "step",
    "cut-svg": "cut.svg",
}
"""Of the files that `camgeo verify` measures, by their formats."""


class Crash(Exception):
    """The net below a reader caught an exception that the reader should not have raised."""


@cache
def product() -> Product:
    """The disc that files are compared with."""
    return camgeo.load(FIXTURES / "scenes" / "vorschub.toml").disc


@cache
def made(kind: str) -> bytes:
    """A good file of a format that camgeo writes."""
    return find_writer(kind).write(product(), TOLERANCE).data


def verified(data: bytes, kind: str) -> str:
    """Why `camgeo verify` does not pass a file; empty if it does."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"vorschub.{ENDINGS[kind]}")
        path.write_bytes(data)
        against = Reference([product()], TOLERANCE)
        try:
            (verdict,) = verify_files((path,), lambda *_: against, Wanted(TOLERANCE))
        except CamgeoError as error:
            return str(error)
    if verdict.crashed:
        raise Crash(verdict.checks[-1].note)
    return "; ".join(check.note or check.name for check in verdict.checks if check.ok is False)


def refusal(read: Callable[[], object]) -> str:
    """Why something is refused; empty if it is not."""
    try:
        read()
    except CamgeoError as error:
        return str(error)
    return ""


def replayed(data: bytes, reader: Reader) -> str:
    """Why `camgeo replay` does not take a contour."""
    told = partial(reader.read, layer=None, unit="mm", gap=1e-3, progress=lambda _: None)
    return refusal(lambda: told(data, "contour"))


def table(data: bytes, read: Callable[[bytes], object]) -> str:
    """Why a table is refused."""
    return refusal(lambda: read(data))


def inspected(data: bytes) -> str:
    """Why `camgeo inspect` refuses measured points, however they are aligned."""
    disc = product()

    def inspect(align: Align) -> None:
        points = read_points(data, "points.csv")
        inspect_points(disc, disc.cam.contact.main, points, "points.csv", align=align)

    return next(filter(None, (refusal(partial(inspect, each)) for each in Align)), "")


def scene(data: bytes) -> str:
    """Why a scene is refused."""
    return refusal(lambda: camgeo.Scene.from_text(data, folder=FIXTURES / "scenes"))


def machine(data: bytes) -> str:
    """Why a machine profile is refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "mill.toml")
        path.write_bytes(data)
        return refusal(lambda: load(str(path)))


def linted(data: bytes, profile: str) -> str:
    """Why `camgeo lint` refuses a program, or what it finds first."""
    found: list[object] = []
    machine = load(profile)
    return refusal(lambda: found.extend(LINTER.lint(data, machine, WorkData()).findings)) or (
        str(found[0]) if found else ""
    )


def certificate(data: bytes) -> str:
    """Why a certificate counts as damaged."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "certificate.json").write_bytes(data)
        found = read_certificate(Path(folder))
    assert found is not None
    return found.damage


READERS: Final[Mapping[str, Callable[[bytes], str]]] = {
    "dxf": partial(verified, kind="dxf"),
    "replay-dxf": partial(replayed, reader=DRAWING),
    "gcode": partial(verified, kind="gcode"),
    "lint": partial(linted, profile="linuxcnc"),
    "stl": partial(verified, kind="stl"),
    "3mf": partial(verified, kind="3mf"),
    "step": partial(verified, kind="step"),
    "cut-svg": partial(verified, kind="cut-svg"),
    "contour": partial(replayed, reader=CONTOUR),
    "inspect": inspected,
    "lifts": partial(table, read=partial(TwoColumns.of_lifts, file="lift.csv")),
    "speeds": partial(table, read=partial(SpeedCurve.read, file="speed.csv")),
    "loads": partial(table, read=lambda data: read_load_table(DataFile("load.csv", data))),
    "motor": partial(table, read=lambda data: read_motor(DataFile("motor.csv", data))),
    "scene": scene,
    "machine": machine,
    "certificate": certificate,
    "ocv": partial(table, read=lambda data: import_project(data, "project")),
}
"""Each returns why it refuses the bytes, or nothing."""


def good(name: str) -> bytes:
    """A file that the reader of that name takes."""
    folder = Path(camgeo.__file__).parent
    files: dict[str, Callable[[], bytes]] = {
        "replay-dxf": lambda: made("dxf"),
        "lint": lambda: made("gcode"),
        "inspect": lambda: "".join(
            f"{30 * math.cos(k / 3):.6f};{30 * math.sin(k / 3):.6f};{math.cos(k / 3):.6f};1\n"
            for k in range(19)
        ).encode(),
        "contour": lambda: b"x,y,bulge\n10,0,0.1\n0,10,0\n-10,0,0.5\n0,-10,0\n",
        "lifts": lambda: ("\n".join(f"{10 * k},{k * (36 - k)}" for k in range(37))).encode(),
        "speeds": lambda: (FIXTURES / "scenes" / "points_speed.csv").read_bytes(),
        "loads": lambda: (FIXTURES / "effects" / "linked_press_load.csv").read_bytes(),
        "motor": lambda: b"n [rpm];M [Nm]\n0;20\n500;12,5\n1000;0\n",
        "scene": lambda: (FIXTURES / "scenes" / "setzhub.toml").read_bytes(),
        "machine": lambda: (folder / "milling" / "machines" / "linuxcnc.toml").read_bytes(),
        "certificate": lambda: (
            b'{"scene": {"sha256": "' + b"0" * 64 + b'", "files": {"a.csv": "' + b"1" * 64 + b'"}},'
            b' "files": [{"file": "a.dxf", "sha256": "' + b"2" * 64 + b'", "tolerance_mm": 0.01}]}'
        ),
        "ocv": lambda: (FIXTURES / "reference" / "ocv" / "setzhub.ocv").read_bytes(),
    }
    return files.get(name, lambda: made(name))()
