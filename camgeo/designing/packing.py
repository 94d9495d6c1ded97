"""Pictures as JSON data, their long lists of numbers packed: digits take longer to write and to
read than all else that is done for a frame of a drag.
"""

from __future__ import annotations

from base64 import b64encode
from typing import Any, Final

import numpy as np

from camgeo.figure.animation import Animation
from camgeo.figure.model import Figure, data_of, listed
from camgeo.numeric.arrays import FloatArray

FEWEST: Final = 32
"""Numbers that are packed; fewer are a list."""

APART: Final = 1e-6
"""By which packed numbers may be off, relative to the extent of theirs along each axis."""

ROUNDING: Final = 2.0**-24
LEAST: Final = 2.0**-150
"""Most by which a single float is off, relative to its value and at all."""

LARGEST: Final = float(np.finfo(np.float32).max)
"""Beyond it there is no single float."""


def packed(picture: Figure | Animation) -> dict[str, Any]:
    """As `picture.to_data()`, with long arrays packed: in `numbers`, in base 64, all of them as
    binary numbers in the order of the array, of the type `packed`, "f4" or "f8", the lowest byte
    first; `shape` is that of the array. A gap is not a number.
    """
    data: dict[str, Any] = data_of(picture, _packed)
    return data


def _packed(array: FloatArray) -> Any:
    if array.size < FEWEST:
        return listed(array)
    rows = array.reshape(-1, array.shape[-1] if array.ndim > 1 else 1)
    low, high = np.fmin.reduce(rows), np.fmax.reduce(rows)  # leave gaps out
    size = np.maximum(-low, high)
    fine = np.maximum(ROUNDING * size, LEAST) <= APART * (high - low)
    kind = "f4" if bool(np.all(fine & (size <= LARGEST))) else "f8"
    text = b64encode(array.astype(f"<{kind}").tobytes()).decode("ascii")
    return {"packed": kind, "shape": list(array.shape), "numbers": text}
