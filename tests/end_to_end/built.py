"""A fixture scene built by the command line, and its part, computed independently."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from ezdxf.document import Drawing
from ezdxf.filemanagement import readfile

from camgeo.design import Design
from camgeo.formats import gcode
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.spec import PartSpec
from camgeo.toolpath.spec import GcodeSpec
from tests.end_to_end.exact import TURN, Flank, Kept, bore_area, bore_length, half_width
from tests.end_to_end.trimmed import kept_of, pitch_of
from tests.measuring import DensePath

SCENES = sorted((Path(__file__).parents[2] / "fixtures" / "scenes").glob("*.toml"))

DENSE = 60_000
"""Points of an exact boundary."""

CHORDS = 5e-6
"""Its chords [mm] lie h^2 kappa/8 off: h < 6e-3 on curves of at most 360 mm, kappa < 1 there. Near
a cusp kappa grows as h falls, so that h^2 kappa falls too."""


@dataclass(frozen=True)
class Exact:
    """One exact boundary of the part."""

    name: str
    points: ComplexArray
    area: float
    length: float
    corners: ComplexArray

    @cached_property
    def path(self) -> DensePath:
        return DensePath(self.points)


class Built:
    """The scene's design, and the folder into which `camgeo build` wrote its files."""

    def __init__(self, design: Design, folder: Path) -> None:
        self.design = design
        self.folder = folder

    def file(self, suffix: str) -> Path:
        return self.folder / f"{self.design.name}{suffix}"

    @property
    def tolerance(self) -> float:
        return self.design.scene.output.tolerance

    @property
    def spec(self) -> PartSpec:
        assert self.design.scene.part is not None
        return self.design.scene.part

    @property
    def thickness(self) -> float:
        assert self.spec.thickness is not None
        return self.spec.thickness

    @property
    def gcode(self) -> GcodeSpec:
        return self.design.disc.options[gcode.FORMAT]

    @cached_property
    def drawing(self) -> Drawing:
        """The DXF, read once by ezdxf."""
        return readfile(self.file(".dxf"))

    @cached_property
    def meshes(self) -> dict[str, trimesh.Trimesh]:
        """The solids by their suffixes, each read once."""
        found = {}
        for suffix in (".stl", ".3mf"):
            mesh: Any = trimesh.load_mesh(str(self.file(suffix)))
            assert isinstance(mesh, trimesh.Trimesh)
            found[suffix] = mesh
        return found

    @cached_property
    def certificate(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads((self.folder / "certificate.json").read_text())
        return document

    def deviation(self, suffix: str) -> float:
        """Deviation of a file in the certificate [mm]."""
        files = {record["file"]: record for record in self.certificate["files"]}
        return float(files[self.file(suffix).name]["deviation_mm"])

    @cached_property
    def _kept(self) -> dict[str, Kept]:
        wanted = {"inner": ["inner"], "outer": ["outer"], "groove": ["inner", "outer"]}
        sides = {"inner": -1, "outer": 1}
        return {name: kept_of(self.design, sides[name]) for name in wanted[self.design.cam.contact]}

    @property
    def is_trimmed(self) -> bool:
        """Whether the scene asks for a disc on which the follower does not make its motion."""
        return self.design.scene.limits.undercut == "trim"

    def flank(self, name: str, outward: float = 0.0) -> Flank:
        """What is left of the "inner" or "outer" flank; its parallel `outward` [mm] farther out."""
        side = -1.0 if name == "inner" else 1.0
        distance = side * half_width(self.design) + outward
        return Flank(self.design, distance, self._kept[name])

    @property
    def flanks(self) -> list[Flank]:
        """What is left of the flanks on which the roller runs."""
        return [self.flank(name) for name in self._kept]

    @cached_property
    def pitch(self) -> Flank:
        """The whole pitch curve."""
        return Flank(self.design, 0.0, pitch_of(self.design))

    @cached_property
    def through(self) -> list[Exact]:
        """Boundaries through the whole thickness."""
        boundaries = []
        if self.design.cam.contact == "inner":
            boundaries.append(self._flank("inner"))
        else:
            assert self.spec.rim is not None
            radius = self.spec.rim / 2.0
            circle = radius * np.exp(1j * np.linspace(0.0, TURN, DENSE, endpoint=False))
            area, length = math.pi * radius**2, TURN * radius
            boundaries.append(Exact("rim", circle, area, length, np.zeros(0, complex)))
        if self.design.cam.contact == "outer":
            boundaries.append(self._flank("outer"))
        elif self.spec.bore is not None:
            area, length = bore_area(self.spec), bore_length(self.spec)
            points, none = bore_points(self.spec), np.zeros(0, complex)
            boundaries.append(Exact("bore", points, area, length, none))
        return boundaries

    @cached_property
    def groove(self) -> list[Exact]:
        """Boundaries of the groove."""
        if self.design.cam.contact != "groove":
            return []
        return [self._flank("inner"), self._flank("outer")]

    def _flank(self, name: str) -> Exact:
        flank = self.flank(name)
        return Exact(name, flank.dense(DENSE), flank.area, flank.length, flank.corners)

    @cached_property
    def volume(self) -> float:
        """Exact volume [mm^3]."""
        body = self.through[0].area - sum(hole.area for hole in self.through[1:])
        depth = self.spec.groove_depth or 0.0
        sunk = self.groove[1].area - self.groove[0].area if self.groove else 0.0
        return body * self.thickness - sunk * depth

    @cached_property
    def length(self) -> float:
        """Length of all boundaries [mm]."""
        return sum(boundary.length for boundary in self.through + self.groove)


def bore_points(spec: PartSpec) -> ComplexArray:
    """Dense points of the bore, in the direction of growing angle; corners of the slot exact."""
    assert spec.bore is not None
    radius = spec.bore / 2.0
    if spec.keyway is None:
        circle: ComplexArray = radius * np.exp(1j * np.linspace(0.0, TURN, DENSE, endpoint=False))
        return circle
    half, bottom = spec.keyway.width / 2.0, radius + spec.keyway.depth
    opening = math.asin(half / radius)
    arc = radius * np.exp(1j * np.linspace(opening, TURN - opening, DENSE))
    slot = np.array([bottom - 1j * half, bottom + 1j * half])
    turned: ComplexArray = np.concatenate((arc, slot)) * np.exp(1j * spec.keyway.angle)
    return turned
