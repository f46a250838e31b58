"""Writes a state-space model for gdcm: one file a model, in a folder named by its condition.

    export_model(sys, "models/c03_045kt_high/roll+5.npz", input_units=["%"] * 4, output_units=["deg/s"] * 3 + ["m/s^2"] * 3)

`sys` is a StateSpace of python-control, or of SciPy (which has no names). No such script is needed for .mat files, and for arrays A,
B, C and D that are saved by numpy.savez already.
"""

import numpy as np


def export_model(sys, path, input_units=(), output_units=(), input_names=(), output_names=()):
    """Writes A, B, C, D, the sample time, and names and units of the channels as far as they are known."""
    step = getattr(sys, "dt", None)
    if step is True:
        raise ValueError("the model has no sample time: set sys.dt to seconds")
    np.savez(
        path,
        A=np.asarray(sys.A, dtype=float),
        B=np.asarray(sys.B, dtype=float),
        C=np.asarray(sys.C, dtype=float),
        D=np.asarray(sys.D, dtype=float),
        Ts=float(step or 0.0),
        inputs=list(input_names or getattr(sys, "input_labels", [])),
        outputs=list(output_names or getattr(sys, "output_labels", [])),
        input_units=list(input_units),
        output_units=list(output_units),
    )
