"""Time and error of frequency responses: gdcm beside python-control, SciPy and NumPy.

    python compare_with_python.py DIRECTORY

Started by compare_with_python.sh, which installs the packages, has `cargo bench --bench responses`
write the models and the values of gdcm to DIRECTORY, and allows one thread.
"""

import importlib.util
import json
import platform
import sys
import timeit
import warnings
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from unittest import mock

import control
import numpy as np
import scipy

# The shortest run counts: other programs can only lengthen a run.
RUNS = 50
# Each refinement divides the error by about 1e16 / condition number, down to that of a long double.
REFINEMENTS = 4


@dataclass
class Model:
    """A state-space model and the points `s = j omega` at which its response is wanted."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    s: np.ndarray

    def resolvents(self):
        """`s I - A` at each point."""
        matrices = np.empty((len(self.s), *self.a.shape), complex)
        matrices[:] = -self.a
        np.einsum("kii->ki", matrices)[:] += self.s[:, None]
        return matrices

    def control(self):
        """Return the model as a python-control system."""
        return control.ss(self.a, self.b, self.c, self.d)


# Methods. Each takes a model and returns the timed function, which computes an array
# [frequency, output, input]. As in gdcm, the time includes reducing the model; it excludes
# converting the model into the form that a package accepts.


def control_slycot(model):
    """python-control with slycot: Hessenberg form (Laub), TB05AD of SLICOT.

    Calling the system would do the same, but silently change to `control_alone` if slycot failed.
    """
    system = model.control()
    return lambda: np.moveaxis(system.slycot_laub(model.s), -1, 0)


def control_alone(model):
    """python-control without slycot: a dense solution at each frequency."""
    system = model.control()

    def run():
        with mock.patch.dict(sys.modules, {"slycot": None}):
            return np.moveaxis(system(model.s), -1, 0)

    return run


def scipy_solve(model):
    """SciPy: dense solutions at all frequencies in one call, which also estimates conditions."""
    return lambda: model.c @ scipy.linalg.solve(model.resolvents(), model.b) + model.d


def scipy_freqresp(model):
    """`scipy.signal.freqresp`: one input and one output at a time, by poles, zeros and gain."""
    outputs, inputs = model.d.shape

    def pair(output, column):
        row = slice(output, output + 1)
        column = slice(column, column + 1)
        system = scipy.signal.StateSpace(
            model.a, model.b[:, column], model.c[row], model.d[row, column]
        )
        return scipy.signal.freqresp(system, model.s.imag)[1]

    def run():
        rows = [[pair(output, column) for column in range(inputs)] for output in range(outputs)]
        return np.moveaxis(np.array(rows), -1, 0)

    return run


def numpy_solve(model):
    """NumPy: dense solutions at all frequencies in one call."""
    return lambda: model.c @ np.linalg.solve(model.resolvents(), model.b) + model.d


def numpy_modal(model):
    """NumPy: a sum over the eigenvalues, inaccurate if the eigenvectors are nearly dependent."""

    def run():
        poles, vectors = np.linalg.eig(model.a)
        left, right = model.c @ vectors, np.linalg.solve(vectors, model.b)
        residues = np.einsum("ik,kj->kij", left, right).reshape(len(poles), -1)
        values = (1 / (model.s[:, None] - poles)) @ residues
        return values.reshape(-1, *model.d.shape) + model.d

    return run


METHODS = {
    "python-control with slycot": control_slycot,
    "python-control without slycot": control_alone,
    "SciPy, linalg.solve in one batch": scipy_solve,
    "SciPy, signal.freqresp by pairs": scipy_freqresp,
    "NumPy, linalg.solve in one batch": numpy_solve,
    "NumPy, modal": numpy_modal,
}


def accurate(model):
    """The response by iterative refinement: solutions in doubles, residuals in long doubles.

    Where a long double is only a double (macOS on ARM), it is no better than the others.
    """
    matrices = model.resolvents()
    # No rounding: each part of an entry is zero, an entry of -A, or a frequency.
    long_matrices = matrices.astype(np.clongdouble)
    states = np.zeros((len(model.s), *model.b.shape), np.clongdouble)
    for _ in range(REFINEMENTS):
        residual = model.b - long_matrices @ states
        states += np.linalg.solve(matrices, residual.astype(complex))
    return model.c.astype(np.longdouble) @ states + model.d


def largest_relative_error(found, exact):
    """The largest difference over frequencies and entries, relative to the largest value."""
    return np.max(np.abs(found - exact)) / np.max(np.abs(exact))


def read(path):
    """A model from the bench, and the time, the instruction set and the values of gdcm."""
    content = json.loads(path.read_text())
    model = Model(*(np.array(content[key]) for key in "abcd"), 1j * np.array(content["omega"]))
    values = np.array(content["re"]) + 1j * np.array(content["im"])
    return model, content["microseconds"], content["instruction_set"], values


def measure(method, model):
    """The values of a method and its microseconds for each frequency."""
    run = method(model)
    seconds = min(timeit.repeat(run, number=1, repeat=RUNS))
    return run(), seconds * 1e6 / len(model.s)


def compare(path, methods):
    """Print the table of one model."""
    model, gdcm_microseconds, instruction_set, values = read(path)
    exact = accurate(model)
    outputs, inputs = model.d.shape
    print(f"\n{len(model.a)} states, {outputs} x {inputs}, {len(model.s)} frequencies")
    print(f"{'':34}{'us a frequency':>15}{'to gdcm':>10}{'relative error':>16}")

    def line(name, found, microseconds):
        ratio = microseconds / gdcm_microseconds
        error = largest_relative_error(found, exact)
        print(f"{name:34}{microseconds:15.2f}{ratio:10.1f}{error:16.1e}", flush=True)

    line(f"gdcm, {instruction_set}", values, gdcm_microseconds)
    for name, method in methods.items():
        line(name, *measure(method, model))


def main():
    """Print the versions and a table for each model, the smallest first."""
    methods = dict(METHODS)
    packages = ["numpy", "scipy", "control", "slycot"]
    if importlib.util.find_spec("slycot") is None:
        del methods["python-control with slycot"]
        packages.remove("slycot")
    # SciPy warns that polynomials of high degree are badly conditioned; the table shows the errors.
    warnings.simplefilter("ignore", scipy.signal.BadCoefficients)
    print("Python", platform.python_version(), *(f"{name} {version(name)}" for name in packages))
    files = Path(sys.argv[1]).glob("*-states.json")
    for path in sorted(files, key=lambda path: int(path.name.split("-")[0])):
        compare(path, methods)


if __name__ == "__main__":
    main()
