"""Figures as the window draws them."""

from __future__ import annotations

import os
from typing import Any, Union

from . import _gdcm
from ._frames import frame_of


class Figure:
    """A figure, which a notebook displays as SVG.

    Attributes
    ----------
    title : str
        Title of the figure.
    svg : str
        The figure as SVG.
    """

    _figure: _gdcm.Figure

    def __init__(self, figure: _gdcm.Figure) -> None:
        self._figure = figure

    @property
    def title(self) -> str:
        """Title of the figure."""
        return self._figure.title

    @property
    def svg(self) -> str:
        """The figure as SVG."""
        return self._figure.bytes("svg").decode()

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, file: Union[str, "os.PathLike[str]"], *, force: bool = False) -> None:
        """Write the figure; the file extension selects the format: .svg, .png (300 dots per inch),
        .pdf, or .csv for the numbers. An existing file is replaced only with `force`."""
        self._figure.save(os.fspath(file), force)

    def to_frame(self) -> Any:
        """Return the numbers of all curves as a pandas data frame, one row for each point."""
        return frame_of(self._figure.bytes("csv"))

    def __repr__(self) -> str:
        return f"<gdcm.Figure {self.title!r}>"
