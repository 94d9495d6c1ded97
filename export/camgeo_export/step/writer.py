"""STEP, AP242: the part as one solid between cylinders and planes, or splines drawn out.

Its walls follow the same lines, arcs or splines as the drawing, its edges are shared, and faces
have the names of the part's boundaries and levels. The lower face is at Z = 0.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.contour.spline import Arc
from camgeo.formats.step import FORMAT
from camgeo.numeric.quadrature import gauss, nodes_beside
from camgeo.part.bands import Band
from camgeo.part.part import Part
from camgeo.product.product import Product, bodies_of, title_of
from camgeo.reading import INSTANCES
from camgeo.units import MM_PER
from camgeo.wording import counted
from camgeo.writing.writer import Written
from camgeo_export.apart import of_contours, require_apart
from camgeo_export.errors import FileError
from camgeo_export.part21.measure import measure
from camgeo_export.step.frame import END, add_context, add_product, header
from camgeo_export.step.geometry import Pen, Strand
from camgeo_export.step.rings import edge_of, ring_of
from camgeo_export.step.shell import Ring, Shell
from camgeo_export.step.slopes import parallel
from camgeo_export.step.text import Entities

ENTITIES = 20
"""Entities of a file for each piece of a wall, at least."""


class StepWriter:
    """Writes a STEP file."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The solid, in the unit of the product, within `tolerance` [mm].

        Raises GeometryError with the key of a height that the scene does not give or that is within
        the tolerance, or with "part" if walls are; FileError if the file would be larger
        than `camgeo.reading` allows.
        """
        part = product.drawn.part
        part.require_steps(tolerance)
        rings = {each.name: ring_of(each, product, tolerance) for each in part.boundaries}
        for bevel in part.bevels:
            if bevel.edge.name not in rings:
                rings[bevel.edge.name] = edge_of(bevel, rings[bevel.boundary.name])
        _limit(sum(len(rings[band.wall.name].strands) for band in part.bands))
        contours = {name: ring.contour for name, ring in rings.items()}
        require_apart(part, of_contours(contours, tolerance), tolerance)
        file = Entities()
        shape = add_product(file, title_of(product))
        context = add_context(file, product.unit)
        pen = Pen(file, MM_PER[product.unit])
        shell = Shell(pen, part, rings)
        solid = file.add("MANIFOLD_SOLID_BREP", title_of(product), shell.add())
        representation = file.add(
            "ADVANCED_BREP_SHAPE_REPRESENTATION", title_of(product), (pen.axes(0.0), solid), context
        )
        file.add("SHAPE_DEFINITION_REPRESENTATION", shape, representation)
        text = "\n".join([*header(product, tolerance), *file.lines, *END, ""])
        return Written(text.encode("ascii"), _facts(part, rings, len(shell.faces)))

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or the pair that it is one piece with."""
        return bodies_of(product)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the solid back, without what wrote it, and measure it against the exact curves
        [mm].
        """
        return measure(product, data)


def _limit(pieces: int) -> None:
    """Raise FileError if a solid with walls of so many pieces would not be read back."""
    if ENTITIES * pieces > INSTANCES:
        raise FileError(
            f"the solid would have walls of {counted(pieces, 'piece')}, of {ENTITIES} entities"
            f" each; at most {INSTANCES:,} are allowed in a STEP file that is read; a larger"
            " tolerance needs fewer"
        )


def _facts(part: Part, rings: dict[str, Ring], faces: int) -> dict[str, int | float | str]:
    """How many faces there are, of which kinds the pieces of walls are, and the volume."""
    bands = [(band, rings[band.wall.name].strands) for band in part.bands]
    pieces = {upright: [each for band, own in bands if band.is_upright == upright for each in own]
                for upright in (True, False)}  # fmt: skip
    bent, cones = (
        sum(1 for each in pieces[upright] if isinstance(each, Arc) and each.sweep)
        for upright in (True, False)
    )
    splines = sum(not isinstance(each, Arc) for each in pieces[True])
    volumes = [_area(band, own) * (band.z1 - band.z0) for band, own in bands]
    counts: dict[str, int | float | str] = {"faces": faces, "cylinders": bent}
    counts |= {"cones": cones} if cones else {}
    counts |= {"splines": splines} if splines else {}
    planes = faces - bent - cones - splines
    return counts | {"planes": planes, "volume_mm3": math.fsum(volumes)}


def _area(band: Band, strands: tuple[Strand, ...]) -> float:
    """Mean of the area within a band [mm^2] over its height; of a chamfer by Simpson's rule, exact
    for the squares of lengths, and beside mitred corners like `camgeo.part.mass`.
    """
    whole = math.fsum(strand.moment for strand in strands)
    if band.is_upright:
        return whole

    def within(share: float) -> float:
        moved = parallel(strands, share * band.width, band.wall.name)
        return math.fsum(strand.moment for strand in moved)

    if (radius := band.wall.corner_radius) is None:
        return (whole + 4.0 * within(0.5) + within(1.0)) / 6.0
    nodes = nodes_beside(-1.0 - radius / band.width)
    shares, _, weights = gauss(np.zeros(1), np.ones(1), nodes)
    return 0.5 * math.fsum(
        weight * within(share) for weight, share in zip(weights, shares[0], strict=True)
    )


WRITER = StepWriter()
