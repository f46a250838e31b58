"""Data frames, where pandas is installed."""

from __future__ import annotations

import io
from typing import Any


def pandas() -> Any:
    """Return the package pandas.

    Raises an ImportError if pandas is not installed; every caller is a `to_frame()`.
    """
    try:
        import pandas as found
    except ImportError as error:
        raise ImportError(
            "to_frame() needs pandas, which is not installed: pip install pandas"
        ) from error
    return found


def frame_of(table: bytes) -> Any:
    """Return a CSV table as a pandas data frame, in which no digit of a number is lost.

    From version 3.1 on, pandas reads exactly by default, and warns about the option.
    """
    reader = pandas()
    version = tuple(int(part) for part in reader.__version__.split(".")[:2])
    if version < (3, 1):
        return reader.read_csv(io.BytesIO(table), float_precision="round_trip")
    return reader.read_csv(io.BytesIO(table))
