"""What verify reports on files, as tests compare it."""

from __future__ import annotations

from functools import cache

from camgeo.design.product import Product
from camgeo.design.verify import Check, Reading, Verifier, failed, first_difference
from camgeo.design.writing import find_writer

TOLERANCE = 0.01
"""Of all these files [mm]."""

Checks = dict[tuple[str, str], Check]
"""By name, and by what the check is of."""


def checked(verifier: Verifier, product: Product, data: bytes, reading: Reading) -> Checks:
    checks = verifier.checks(product, data, reading, TOLERANCE)
    return {(check.name, check.of): check for check in checks}


class Held:
    """A product, by its identity."""

    def __init__(self, product: Product) -> None:
        self.product = product

    def __hash__(self) -> int:
        return id(self.product)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Held) and self.product is other.product


@cache
def written(name: str, held: Held) -> bytes:
    """What camgeo writes of a product in a format."""
    return find_writer(name).write(held.product, TOLERANCE).data


def faults(verifier: Verifier, product: Product, data: bytes) -> list[Check]:
    """The checks that fail on a file that should be one of ours, those of its origin included."""
    origin = verifier.origin(data)
    if origin.damage:
        return [failed("file", origin.damage)]
    checks = [
        Check("scene", value=origin.scene, ok=product.scene_hash.startswith(origin.scene or "-")),
        Check("tolerance", value=origin.tolerance, ok=origin.tolerance in (None, TOLERANCE)),
        *verifier.checks(product, data, Reading("file"), TOLERANCE),
    ]
    if origin.version == product.version:
        own = written(origin.format or verifier.format, Held(product))
        if difference := first_difference(verifier, data, own):
            checks.insert(0, failed("written again", difference.sentence))
    return [check for check in checks if check.ok is False]
