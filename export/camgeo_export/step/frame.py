"""What a STEP file has around its solid: header, product, units and uncertainty, by AP242."""

from __future__ import annotations

from camgeo.product.product import Product
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.step.text import DERIVED, NONE, Entities, Ref, Typed, Value, Word, spelled

SCHEMA = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"
"""Its first edition, which programs have read for longest."""

FIXED_DATE = "1970-01-01T00:00:00"
"""The time stamp: the file's bytes depend only on its content."""

UNCERTAINTY = 1e-7
"""Distance [mm] within which ends meet: the accuracy of CAD programs, far above that of doubles."""


def header(product: Product, tolerance: float) -> list[str]:
    """The lines of the header; the description states the origin."""
    description = (
        f"camgeo {product.version}",
        f"scene {product.scene_hash}",
        f"tolerance {tolerance!r} mm",
    )
    system, nobody = f"camgeo {product.version}", ("",)
    name = (f"{product.name}.step", FIXED_DATE, nobody, nobody, system, "camgeo", "")
    records: list[tuple[str, tuple[Value, ...]]] = [
        ("FILE_DESCRIPTION", (description, "2;1")),
        ("FILE_NAME", name),
        ("FILE_SCHEMA", ((SCHEMA,),)),
    ]
    lines = [f"{kind}{spelled(values)};" for kind, values in records]
    return ["ISO-10303-21;", "HEADER;", *lines, "ENDSEC;", "DATA;"]


END = ["ENDSEC;", "END-ISO-10303-21;"]


def add_product(file: Entities, name: str) -> Ref:
    """The product of the name and its definition; gives what shapes are attached to."""
    context = file.add("APPLICATION_CONTEXT", "managed model based 3d engineering")
    file.add(
        "APPLICATION_PROTOCOL_DEFINITION",
        "international standard",
        "ap242_managed_model_based_3d_engineering",
        2014,
        context,
    )
    discipline = file.add("PRODUCT_CONTEXT", "", context, "mechanical")
    product = file.add("PRODUCT", name, name, "", (discipline,))
    file.add("PRODUCT_RELATED_PRODUCT_CATEGORY", "part", "", (product,))
    version = file.add("PRODUCT_DEFINITION_FORMATION", "", "", product)
    stage = file.add("PRODUCT_DEFINITION_CONTEXT", "part definition", context, "design")
    definition = file.add("PRODUCT_DEFINITION", "design", "", version, stage)
    return file.add("PRODUCT_DEFINITION_SHAPE", "", "", definition)


def add_context(file: Entities, unit: LengthUnit) -> Ref:
    """Units and uncertainty of a representation."""
    length = _length_unit(file, unit)
    angle = file.complex(
        ("NAMED_UNIT", (DERIVED,)),
        ("PLANE_ANGLE_UNIT", ()),
        ("SI_UNIT", (NONE, Word(".RADIAN."))),
    )
    solid_angle = file.complex(
        ("NAMED_UNIT", (DERIVED,)),
        ("SI_UNIT", (NONE, Word(".STERADIAN."))),
        ("SOLID_ANGLE_UNIT", ()),
    )
    uncertainty = file.add(
        "UNCERTAINTY_MEASURE_WITH_UNIT",
        Typed("LENGTH_MEASURE", UNCERTAINTY / MM_PER[unit]),
        length,
        "distance_accuracy_value",
        "ends and edges meet within it",
    )
    return file.complex(
        ("GEOMETRIC_REPRESENTATION_CONTEXT", (3,)),
        ("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", ((uncertainty,),)),
        ("GLOBAL_UNIT_ASSIGNED_CONTEXT", ((length, angle, solid_angle),)),
        ("REPRESENTATION_CONTEXT", ("", "3D")),
    )


def _length_unit(file: Entities, unit: LengthUnit) -> Ref:
    millimetre = file.complex(
        ("LENGTH_UNIT", ()),
        ("NAMED_UNIT", (DERIVED,)),
        ("SI_UNIT", (Word(".MILLI."), Word(".METRE."))),
    )
    if unit == "mm":
        return millimetre
    exponents = file.add("DIMENSIONAL_EXPONENTS", 1.0, *(0.0,) * 6)
    factor = Typed("LENGTH_MEASURE", MM_PER[unit])
    measure = file.add("LENGTH_MEASURE_WITH_UNIT", factor, millimetre)
    return file.complex(
        ("CONVERSION_BASED_UNIT", (unit.upper(), measure)),
        ("LENGTH_UNIT", ()),
        ("NAMED_UNIT", (exponents,)),
    )
