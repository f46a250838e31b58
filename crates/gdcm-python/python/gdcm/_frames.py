"""Data frames, where pandas is installed."""

from __future__ import annotations

from typing import Any


def pandas() -> Any:
    """Return the package pandas, or raise an ImportError that says what needs it."""
    try:
        import pandas as found
    except ImportError as error:
        raise ImportError(
            "to_frame() needs pandas, which is not installed: pip install pandas"
        ) from error
    return found
