"""Exact cutter paths: which parallel of the real outline the cutter's centre runs on."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.cam.contact import Contact
from camgeo.contour.contour import Contour
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.outline.envelope import Envelope
from camgeo.outline.path import Path
from camgeo.part.part import Part
from camgeo.part.spec import PartSpec

SAME = 2.0**-48
"""Radii that differ by less, as a share of them, are one: what a sum of two lengths rounds to."""


@dataclass(frozen=True, slots=True)
class CutterPath:
    """The closed path of the cutter's centre for one operation.

    Attributes
    ----------
    name : of the operation.
    path : the exact path, or None if it is `circle`.
    circle : the exact path of a bore.
    free_side : +1 if the lead-in comes from outside of the path (away from the cam axis), -1 from
        inside, 0 if the cutter fills the groove and plunges on the path itself.
    room : largest radius of the arcs that lead onto the path [mm].
    depth : to which is cut [mm], positive.
    note : what the person at the machine should know, or empty.
    """

    name: str
    path: Path | None
    circle: Contour | None
    free_side: int
    room: float
    depth: float
    note: str = ""


def cutter_paths(
    contact: Contact, inner: Path, outer: Path, part: Part, spec: PartSpec, tool_radius: float
) -> tuple[CutterPath, ...]:
    """The operations of a part, the bore first: it is cut while the blank is whole.

    `inner` and `outer` are the real outlines of the flanks, of which those of the contact are
    looked at. The cutter rolls round their corners on arcs.

    Raises
    ------
    GeometryError
        With the key of the scene, if the cutter does not fit or the thickness is missing.
    """
    if not part.thickness:
        raise GeometryError("milling needs the thickness of the part", key="part.thickness")
    paths: list[CutterPath] = []
    if spec.bore is not None and contact != "outer":
        radius = spec.bore / 2.0 - tool_radius
        if radius <= 0.0:
            raise GeometryError(
                f"the cutter must be smaller than the bore, {spec.bore:g} mm",
                key="output.gcode.tool_diameter",
                value=f"{2.0 * tool_radius:g}",
            )
        circle = Contour.circle(radius)
        note = "the keyway is left to be broached" if spec.keyway is not None else ""
        paths.append(CutterPath("bore", None, circle, -1, radius / 2.0, part.thickness, note))
    if contact == "inner":
        path = inner.offset(tool_radius)
        paths.append(CutterPath("outline", path, None, 1, tool_radius, part.thickness))
    elif contact == "outer":
        path = outer.offset(-tool_radius)
        paths.append(CutterPath("outline", path, None, -1, tool_radius, part.thickness))
    else:
        paths += _groove_paths(inner, outer, tool_radius, -part.layers[-1].z0)
    return tuple(paths)


def _groove_paths(inner: Path, outer: Path, tool_radius: float, depth: float) -> list[CutterPath]:
    """One round of a cutter as wide as the groove on the pitch curve, or one along each flank.

    What the roller sweeps where a flank is trimmed is wider than two rounds along what is left of
    the flanks; there only a cutter as wide as the groove clears it for certain.
    """
    curve = outer.stretches[0].curve
    pitch, half = curve.pitch, curve.distance
    like = "the roller" if half == pitch.follower.roller_radius else "the groove"
    side = half - tool_radius
    if abs(side) <= SAME * half:
        centre = Path(Envelope(WorkingCurve(pitch, 0.0)).elements)
        return [CutterPath("groove", centre, None, 0, 0.0, depth)]
    if side < 0.0 or 2.0 * tool_radius < half:
        raise GeometryError(
            f"the cutter of a groove must not be larger than {like}, and at least half as large,"
            f" so that two rounds clear it: from {half:g} to {2.0 * half:g} mm",
            key="output.gcode.tool_diameter",
            value=f"{2.0 * tool_radius:g}",
        )
    if not (inner.is_whole and outer.is_whole):
        raise GeometryError(
            f"a flank of the groove is trimmed or has a corner: only a cutter like {like},"
            f" {2.0 * half:g} mm, clears all that the roller passes over",
            key="output.gcode.tool_diameter",
            value=f"{2.0 * tool_radius:g}",
        )
    return [
        CutterPath("outer flank", outer.offset(-tool_radius), None, -1, side / 2.0, depth),
        CutterPath("inner flank", inner.offset(tool_radius), None, 1, side / 2.0, depth),
    ]
