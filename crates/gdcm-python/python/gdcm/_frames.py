"""Data frames, where pandas is installed."""

from __future__ import annotations

import io
from typing import Any


def pandas() -> Any:
    """Return the package pandas.

    Raises an ImportError that names the caller if pandas is not installed.
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

    pandas 3.1 reads exactly without being asked, and warns if it is asked.
    """
    reader = pandas()
    version = tuple(int(part) for part in reader.__version__.split(".")[:2])
    if version < (3, 1):
        return reader.read_csv(io.BytesIO(table), float_precision="round_trip")
    return reader.read_csv(io.BytesIO(table))
