"""What all DXF files of ours have in common: their units, their origin, and the same bytes."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager

from ezdxf import options  # type: ignore[attr-defined] # exported, but not declared
from ezdxf.document import Drawing

from camgeo.product.product import Product, title_of
from camgeo.units import LengthUnit

INSUNITS: dict[LengthUnit, int] = {"mm": 4, "inch": 1}
MEASUREMENT: dict[LengthUnit, int] = {"mm": 1, "inch": 0}


@contextmanager
def fixed_metadata() -> Iterator[None]:
    """Drawings without time stamps and random identifiers, which ezdxf stamps on a file when
    creating and when writing it; its setting is restored.
    """
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def describe(document: Drawing, product: Product, tolerance: float) -> None:
    """Record the file's origin as custom document properties: no text enters the drawing."""
    properties = document.header.custom_vars
    properties.append("camgeo", product.version)
    properties.append("scene", product.scene_hash)
    properties.append("tolerance mm", repr(tolerance))
    if title_of(product) != product.name:
        properties.append("title", title_of(product))


def bytes_of(document: Drawing) -> bytes:
    """The document as a file; to be called with `fixed_metadata`."""
    # ezdxf declares the classes in use in the order of a set, which differs between runs.
    for kind in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(kind)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode(document.output_encoding)
