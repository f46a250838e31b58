"""Keywords as options of the command line, which the program reads and checks."""

from __future__ import annotations

import os
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

Pair = Union[str, Tuple[str, str]]
"""A response: ``"Q/LON"`` or ``("Q", "LON")``, output first."""


def option(keyword: str) -> str:
    """Return the option of a keyword: "--gain-bounds" for "gain_bounds"."""
    return "--" + keyword.replace("_", "-")


def words_of(keyword: str, value: Any) -> List[str]:
    """Return a setting as words of the command line; none for None and False."""
    if value is None or value is False:
        return []
    if value is True:
        return [option(keyword)]
    if isinstance(value, str):
        return [f"{option(keyword)}={value}"]
    if isinstance(value, Iterable):
        return [option(keyword), *(number(item) for item in value)]
    return [f"{option(keyword)}={number(value)}"]


def number(value: Any) -> str:
    """Return a number as text from which the same number is read."""
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"expected a number, found {value!r}")
    return repr(value)


def path(value: Union[str, "os.PathLike[str]"]) -> str:
    """Return a path as text."""
    return os.fspath(value)


def pair(value: Pair) -> str:
    """Return a response as the command line names it: "Q/LON"."""
    if isinstance(value, str):
        return value
    output, input_ = value
    return f"{output}/{input_}"


def pairs(value: Union[Pair, Sequence[Pair]]) -> str:
    """Return responses as the command line lists them; "none" for an empty list."""
    if isinstance(value, str):
        return value
    listed = [value] if _is_pair(value) else list(value)
    return ",".join(pair(item) for item in listed) if listed else "none"  # type: ignore[arg-type]


def _is_pair(value: Any) -> bool:
    """Return whether a value is a single response ("Q", "LON"), not a list of "Q/LON"."""
    if not isinstance(value, tuple) or len(value) != 2:
        return False
    return all(isinstance(name, str) and "/" not in name for name in value)


def names(value: Union[str, Iterable[str]]) -> str:
    """Return names as the command line lists them."""
    return value if isinstance(value, str) else ",".join(value)


def repeated(keyword: str, value: Optional[Union[Any, Iterable[Any]]]) -> List[str]:
    """Return an option that may be repeated, once for each item."""
    if value is None:
        return []
    items = [value] if isinstance(value, (str, int, float, os.PathLike)) else list(value)
    return [f"{option(keyword)}={_item(item)}" for item in items]


def assigned(keyword: str, value: Optional[Mapping[str, Any]]) -> List[str]:
    """Return an option NAME=VALUE, once for each entry of a mapping."""
    if value is None:
        return []
    return [f"{option(keyword)}={name}={_item(item)}" for name, item in value.items()]


def _item(value: Any) -> str:
    return value if isinstance(value, str) else (
        os.fspath(value) if isinstance(value, os.PathLike) else number(value)
    )


def settings(values: Dict[str, Any]) -> List[str]:
    """Return settings as words of the command line."""
    listed: List[str] = []
    for keyword, value in values.items():
        listed.extend(words_of(keyword, value))
    return listed
