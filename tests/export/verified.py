"""What verify reports on files, as tests compare it."""

from __future__ import annotations

from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading, Verifier

TOLERANCE = 0.01
"""Of all these files [mm]."""

Checks = dict[tuple[str, str], Check]
"""By name, and by what the check is of."""


def checked(verifier: Verifier, product: Product, data: bytes, reading: Reading) -> Checks:
    checks = verifier.checks(product, data, reading, TOLERANCE)
    return {(check.name, check.of): check for check in checks}


def faults(verifier: Verifier, product: Product, data: bytes) -> list[Check]:
    """The checks that fail on a file that should be one of ours, those of its origin included."""
    origin = verifier.origin(data)
    if origin.damage:
        return [Check("file", ok=False, note=origin.damage)]
    checks = verifier.checks(product, data, Reading("file", ours=origin.ours), TOLERANCE)
    named = Check(
        "scene", value=origin.scene, ok=product.scene_hash.startswith(origin.scene or "-")
    )
    stated = Check("tolerance", value=origin.tolerance, ok=origin.tolerance in (None, TOLERANCE))
    return [check for check in (named, stated, *checks) if check.ok is False]
