"""A fixture scene built by the command line, and its part, computed independently."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np
import trimesh
from ezdxf.document import Drawing
from ezdxf.filemanagement import readfile

from camgeo.design.design import Design
from camgeo.part.spec import PartSpec
from tests.end_to_end.exact import Flank, Kept, half_width
from tests.end_to_end.features import DENSE, Exact, Span, spans
from tests.end_to_end.trimmed import kept_of, pitch_of

SCENES = sorted((Path(__file__).parents[2] / "fixtures" / "scenes").glob("*.toml"))


class _Area(Protocol):
    """What has an area, of either sign, and a centroid."""

    @property
    def area(self) -> float: ...

    @property
    def centroid(self) -> complex: ...


Item = TypeVar("Item", bound=_Area)

Other = TypeVar("Other", bound=_Area)

CHORDS = 5e-6
"""Its chords [mm] lie h^2 kappa/8 off: h < 6e-3 on curves of at most 360 mm, kappa < 1 there. Near
a cusp kappa grows as h falls, so that h^2 kappa falls too."""


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

    def record(self, suffix: str) -> dict[str, Any]:
        """What the certificate states of a file."""
        name = self.file(suffix).name
        found: dict[str, Any] = next(r for r in self.certificate["files"] if r["file"] == name)
        return found

    def deviation(self, suffix: str) -> float:
        """Deviation of a file in the certificate [mm]."""
        return float(self.record(suffix)["deviation_mm"])

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
    def spans(self) -> list[Span]:
        """All boundaries of the part with their heights."""
        flanks = {name: self._flank(name) for name in self._kept}
        return spans(self.spec, flanks, self.design.cam.contact)

    @property
    def boundaries(self) -> list[Exact]:
        return [span.exact for span in self.spans]

    @property
    def heights(self) -> list[float]:
        """Of all flat faces above the lowest one [mm]."""
        return sorted({z for span in self.spans for z in (span.low, span.high)})

    @property
    def height(self) -> float:
        """From the lowest face to the highest [mm]."""
        return self.heights[-1]

    def section(self, height: float) -> list[Exact]:
        """The boundaries at a height between flat faces [mm]."""
        return [span.exact for span in self.spans if span.low < height < span.high]

    def _flank(self, name: str) -> Exact:
        flank = self.flank(name)
        return Exact(name, flank.dense(DENSE), flank.area, flank.length, flank.corners)

    @property
    def volume(self) -> float:
        """Exact volume [mm^3]."""
        return sum(span.volume for span in self.spans)

    @property
    def length(self) -> float:
        """Length of all boundaries [mm]."""
        return sum(boundary.length for boundary in self.boundaries)


def paired(found: Sequence[Item], wanted: Sequence[Other]) -> list[tuple[Item, Other]]:
    """Each of `wanted` with what is nearest to it in area and centroid among `found`, each of
    which must be taken once; the largest first.
    """
    assert len(found) == len(wanted)
    left, pairs = list(found), []
    for one in sorted(wanted, key=lambda each: -abs(each.area)):
        size = abs(one.area)
        off = [
            abs(abs(each.area) - size) / math.sqrt(size) + abs(each.centroid - one.centroid)
            for each in left
        ]
        pairs.append((left.pop(int(np.argmin(off))), one))
    return pairs
