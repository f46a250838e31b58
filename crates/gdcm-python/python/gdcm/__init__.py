"""Gain-Delay Correction Method: match physics-based helicopter models to flight.

>>> import numpy as np, gdcm
>>> data = gdcm.example()
>>> fix = gdcm.analyze(data, phase="lead", reject="suggested")
>>> fix[10].net_gain["Q", "LON"]          # gain of LON -> Q in condition 10
>>> H = fix[10].response(np.geomspace(0.5, 12, 200))

Conventions are those of NumPy and python-control: arrays of responses are ``[output, input, omega]``,
frequencies are in rad/s, delays in seconds, airspeeds in knots; channels are named, and every value
is in the unit that its channel states. Errors are `gdcm.Error`, with the stable codes of the
program. `gdcm.main` is the program itself: its commands, and its window.
"""

from __future__ import annotations

import signal
import sys
import threading
from typing import Optional, Sequence

from . import _gdcm
from ._analysis import Analysis, Assessment, ChannelTable, ConditionResult, PairTable, Schedule
from ._analysis import ScheduledCorrection, analyze
from ._data import Condition, Dataset, assemble, example, example_records, load
from ._error import Error
from ._figure import Figure
from ._identification import Identification, IdentificationCaution, identify
from ._messages import Message
from ._models import Bands, Channel, FrequencyResponse, StateSpace

__version__: str = _gdcm.version

__all__ = [
    "Analysis",
    "Assessment",
    "Bands",
    "Channel",
    "ChannelTable",
    "Condition",
    "ConditionResult",
    "Dataset",
    "Error",
    "Figure",
    "FrequencyResponse",
    "Identification",
    "IdentificationCaution",
    "Message",
    "PairTable",
    "Schedule",
    "ScheduledCorrection",
    "StateSpace",
    "analyze",
    "assemble",
    "example",
    "example_records",
    "identify",
    "load",
    "main",
]


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the program `gdcm`: a command, or the window without one.

    Parameters
    ----------
    arguments
        Words of the command line without the name of the program; by default those of this
        process, ``sys.argv[1:]``.

    Returns
    -------
    int
        Exit status: 0 done; 1 no complete result; 2 the command line or a file is wrong.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    if threading.current_thread() is not threading.main_thread():
        return _gdcm.run(["gdcm", *words])
    # Ctrl+C ends the program or stops its work, as without Python, whose own handler would wait
    # for the next line of Python.
    before = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        return _gdcm.run(["gdcm", *words])
    finally:
        signal.signal(signal.SIGINT, before)
