"""The closed shell of a part: a face for each piece of a wall, and the flat faces with their holes.

Neighbours share their edges, which each uses once in either direction.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from camgeo.contour.contour import Contour
from camgeo.contour.simple import winding_number
from camgeo.errors import GeometryError
from camgeo.part.bands import Band
from camgeo.part.part import Level, Part
from camgeo_export.step.geometry import Ends, Pen, Strand
from camgeo_export.step.slopes import posts_of, row_of, surface_of
from camgeo_export.step.text import DERIVED, Ref, flag


@dataclass(frozen=True, slots=True)
class Ring:
    """A boundary of the part as the file has it.

    Attributes
    ----------
    strands : its pieces, one after the other, with the material on their left.
    contour : of lines and arcs, the same or close to it; shows what lies inside.
    """

    strands: tuple[Strand, ...]
    contour: Contour


@dataclass(frozen=True, slots=True)
class FlatFace:
    """A flat face by the names of its boundaries: the outer one first, then those of its holes."""

    names: tuple[str, ...]
    upwards: bool


def flat_faces(level: Level, rings: dict[str, Ring]) -> list[FlatFace]:
    """The faces at one height: each between a ring and those that lie next inside it.

    Along a boundary that ends here the face looks upwards on the side of the material, along one
    that begins it looks downwards there.
    """
    ends = {each.name for each in level.below}
    holes = {each.name for each in level.boundaries if each.hole}
    names = [each.name for each in level.boundaries]
    around = {name: _around(name, names, rings) for name in names}
    found = []
    for name in names:
        if len(around[name]) % 2 == 0:
            within = [one for one in names if around[one] == {*around[name], name}]
            found.append(FlatFace((name, *within), upwards=(name in ends) != (name in holes)))
    return found


def _around(name: str, names: Sequence[str], rings: dict[str, Ring]) -> set[str]:
    """The names of the rings around one of them."""
    place = complex(rings[name].contour.vertices[0])
    return {one for one in names if one != name and winding_number(rings[one].contour, place)}


def require_one_body(part: Part, faces: dict[float, list[FlatFace]]) -> None:
    """Raise GeometryError if walls do not connect all flat faces, given by their heights."""
    groups: dict[tuple[float, FlatFace], set[tuple[float, FlatFace]]] = {}
    for z, flat in faces.items():
        groups |= {(z, face): {(z, face)} for face in flat}
    for bands in courses_of(part):
        feet = (bands[0].z0, bands[0].lower.name), (bands[-1].z1, bands[-1].upper.name)
        ends = ((z, _face_of(faces[z], name)) for z, name in feet)
        one, other = (groups[each] for each in ends)
        if one is not other:
            one |= other
            groups |= dict.fromkeys(other, one)
    if len({id(group) for group in groups.values()}) > 1:
        message = "a STEP file holds one body without closed cavities, which this part is not"
        raise GeometryError(message, key="part")


def _face_of(faces: Iterable[FlatFace], name: str) -> FlatFace:
    return next(face for face in faces if name in face.names)


def courses_of(part: Part) -> list[list[Band]]:
    """The bands of each wall, from its lower to its upper end."""
    found: list[list[Band]] = []
    for band in part.bands:
        if found and found[-1][-1].wall is band.wall and found[-1][-1].z1 == band.z0:
            found[-1].append(band)
        else:
            found.append([band])
    return found


class Shell:
    """Adds the faces of a part, its lowest one at Z = 0."""

    def __init__(self, pen: Pen, part: Part, rings: dict[str, Ring]) -> None:
        self.pen = pen
        self.part = part
        self.rings = rings
        self.bottom = part.levels[0].z
        self.edges: dict[tuple[str, float], list[Ref]] = {}
        self.faces: list[Ref] = []

    def add(self) -> Ref:
        """The shell; raises GeometryError if it would be several."""
        flat = {level.z: flat_faces(level, self.rings) for level in self.part.levels}
        require_one_body(self.part, flat)
        for bands in courses_of(self.part):
            if len(bands) == 1:
                self._wall(bands[0])
            else:
                self._bevelled(bands)
        for level in self.part.levels:
            ends = {each.name for each in level.below}
            for face in flat[level.z]:
                self._flat(level, face, ends)
        return self.pen.file.add("CLOSED_SHELL", "", self.faces)

    def _bevelled(self, bands: Sequence[Band]) -> None:
        """The faces of a wall with chamfers, from below, and all edges between them."""
        ends = [(bands[0].lower.name, bands[0].z0), *((each.upper.name, each.z1) for each in bands)]
        rows = [row_of(self.pen, self.rings[name].strands, z - self.bottom) for name, z in ends]
        for band, (lower, upper) in zip(bands, pairwise(rows), strict=True):
            edge = band.upper if band.lower is band.wall else band.lower
            posts = posts_of(self.pen, lower, upper)
            for k in range(len(posts)):
                after = (k + 1) % len(posts)
                around = [
                    (lower.edges[k], True),
                    (posts[after], True),
                    (upper.edges[k], False),
                    (posts[k], False),
                ]
                surface, outwards = surface_of(self.pen, lower, upper, k)
                self._face(edge.name, [self._loop(around)], surface, outwards)
        for end, row in zip(ends, rows, strict=True):
            self.edges[end] = row.edges

    def _wall(self, wall: Band) -> None:
        """The faces along a boundary, and the edges above and below."""
        name, file = wall.wall.name, self.pen.file
        strands = self.rings[name].strands
        heights = (wall.z0 - self.bottom, wall.z1 - self.bottom)
        points = [[self.pen.point(each.start, z) for each in strands] for z in heights]
        feet, heads = ([file.add("VERTEX_POINT", "", each) for each in row] for row in points)
        posts = [
            file.add("EDGE_CURVE", "", feet[k], heads[k], self.pen.post(point), flag(True))
            for k, point in enumerate(points[0])
        ]
        lower, upper = [], []
        for k, strand in enumerate(strands):
            after = (k + 1) % len(strands)
            ends = [Ends(z, row[k], row[after]) for z, row in zip(heights, points, strict=True)]
            piece = self.pen.piece(strand, *ends)
            below, above = piece.curves
            same = flag(piece.same)
            lower.append(file.add("EDGE_CURVE", "", feet[k], feet[after], below, same))
            upper.append(file.add("EDGE_CURVE", "", heads[k], heads[after], above, same))
            around = [
                (lower[k], True),
                (posts[after], True),
                (upper[k], False),
                (posts[k], False),
            ]
            self._face(name, [self._loop(around)], piece.surface, piece.outwards)
        self.edges |= {(name, wall.z0): lower, (name, wall.z1): upper}

    def _flat(self, level: Level, face: FlatFace, ends: set[str]) -> None:
        """One flat face; its walls have the edges of rings that end here in reverse."""
        loops = []
        for name in face.names:
            edges = [(edge, name in ends) for edge in self.edges[name, level.z]]
            loops.append(self._loop(edges if name in ends else edges[::-1]))
        surface = self.pen.level_plane(level.z - self.bottom, upwards=face.upwards)
        self._face(level.name, loops, surface, same=True)

    def _loop(self, edges: Iterable[tuple[Ref, bool]]) -> Ref:
        file = self.pen.file
        uses = [
            file.add("ORIENTED_EDGE", "", DERIVED, DERIVED, edge, flag(forward))
            for edge, forward in edges
        ]
        return file.add("EDGE_LOOP", "", uses)

    def _face(self, name: str, loops: list[Ref], surface: Ref, same: bool) -> None:
        kinds = ["FACE_OUTER_BOUND", *["FACE_BOUND"] * (len(loops) - 1)]
        bounds = [
            self.pen.file.add(kind, "", loop, flag(True))
            for kind, loop in zip(kinds, loops, strict=True)
        ]
        self.faces.append(self.pen.file.add("ADVANCED_FACE", name, bounds, surface, flag(same)))
