"""Models as plain arrays: state-space and frequency responses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._error import Error

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class Channel:
    """An input or an output: its name, and the unit of its values."""

    name: str
    unit: str = ""
    description: str = ""


Channels = Union[Mapping[str, str], Sequence[Union[str, Tuple[str, str], Channel]]]
"""Channels as ``{"Q": "deg/s"}``, ``[("Q", "deg/s")]``, or `Channel` objects."""


@dataclass(frozen=True, eq=False)
class Bands:
    """Standard deviations of the response of an identified model, from which error bars are made.

    Attributes
    ----------
    omega : ndarray of float, shape (N,)
        Frequencies [rad/s], increasing.
    sd_db, sd_deg : ndarray of float, shape (p, m, N)
        Standard deviations of magnitude [dB] and phase [deg].
    """

    omega: Floats
    sd_db: Floats
    sd_deg: Floats

    def __post_init__(self) -> None:
        for values in ("omega", "sd_db", "sd_deg"):
            object.__setattr__(self, values, np.asarray(getattr(self, values), dtype=float))


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A linear model, ``x' = A x + B u``, ``y = C x + D u``.

    Inputs, outputs and delays are in the order and the units of the channels.

    Attributes
    ----------
    A, B, C, D : ndarray of float
        Shapes (n, n), (n, m), (p, n), (p, m) for n states, m inputs and p outputs.
    sample_time_s : float or None
        Sample time [s] of a model in discrete time, ``x[k+1] = A x[k] + B u[k]``; None in
        continuous time.
    input_delays_s, output_delays_s : ndarray of float or None
        Delays [s] of the channels, shapes (m,) and (p,), which the matrices do not contain.
    inputs, outputs, states : tuple of str
        Names; empty where unknown.
    name : str
        Name of the model.
    notes : tuple of str
        Description of the model, such as the accuracy of its Pade approximants.
    bands : Bands or None
        Standard deviations of an identified model.
    method : str
        Method of the identification; empty where unknown.
    """

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    sample_time_s: Optional[float] = None
    input_delays_s: Optional[Floats] = None
    output_delays_s: Optional[Floats] = None
    inputs: Tuple[str, ...] = ()
    outputs: Tuple[str, ...] = ()
    states: Tuple[str, ...] = ()
    name: str = ""
    notes: Tuple[str, ...] = ()
    bands: Optional[Bands] = None
    method: str = ""

    def __post_init__(self) -> None:
        for matrix in "ABCD":
            value = np.atleast_2d(np.asarray(getattr(self, matrix), dtype=float))
            object.__setattr__(self, matrix, value)
        for delays in ("input_delays_s", "output_delays_s"):
            value = getattr(self, delays)
            if value is not None:
                object.__setattr__(self, delays, np.atleast_1d(np.asarray(value, dtype=float)))

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.A.shape[0])

    @property
    def has_delays(self) -> bool:
        """Whether the model has delays beside its matrices."""
        delays = (self.input_delays_s, self.output_delays_s)
        return any(value is not None and bool(np.any(value)) for value in delays)

    def __repr__(self) -> str:
        outputs, inputs = self.D.shape
        time = "" if self.sample_time_s is None else f", sample time {self.sample_time_s} s"
        name = f" {self.name!r}" if self.name else ""
        return f"<gdcm.StateSpace{name}: order {self.order}, {outputs} x {inputs}{time}>"

    def to_control(self, pade: Optional[int] = None) -> Any:
        """Return the model as `control.StateSpace`, with the names of its channels.

        Parameters
        ----------
        pade
            Order of the Pade approximants of delays that the matrices do not contain. Needed only
            for a model in continuous time that has such delays.

        Raises
        ------
        ImportError
            The package `control` is not installed.
        """
        control = _control()
        labels: Dict[str, Any] = {}
        if self.inputs:
            labels["inputs"] = list(self.inputs)
        if self.outputs:
            labels["outputs"] = list(self.outputs)
        if self.name:
            labels["name"] = self.name
        dt = 0 if self.sample_time_s is None else self.sample_time_s
        if not self.has_delays:
            if self.states:
                labels["states"] = list(self.states)
            return control.ss(self.A, self.B, self.C, self.D, dt, **labels)
        if self.sample_time_s is not None:
            raise ValueError(
                "to_control() does not convert the delays of a discrete-time model; add them to its "
                "matrices as states"
            )
        if pade is None:
            raise ValueError(
                "the model has delays; give the order of their Pade approximants, for example pade=3"
            )
        plain = control.ss(self.A, self.B, self.C, self.D, dt)
        outputs, inputs = self.D.shape
        before = _delays(control, self.input_delays_s, inputs, pade)
        after = _delays(control, self.output_delays_s, outputs, pade)
        joined = control.series(before, plain, after)
        return control.ss(joined.A, joined.B, joined.C, joined.D, dt, **labels)


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """A measured frequency response.

    Attributes
    ----------
    omega : ndarray of float, shape (N,)
        Frequencies [rad/s], increasing.
    H : ndarray of complex, shape (p, m, N)
        Response of p outputs to m inputs, in the units of the channels; NaN where undefined.
    coherence : ndarray of float or None
        Coherence, shape (p, m, N); partial coherence with several inputs.
    valid_band_rad_s : ndarray of float or None, shape (p, m, 2)
        First and last trusted frequency of each response [rad/s].
    averages : float or None
        Number of independent averages in the estimate.
    window_s : float or None
        Window length of the estimate [s].
    sd_db, sd_deg : ndarray of float or None, shape (p, m, N)
        Standard deviations of magnitude [dB] and phase [deg]; of identifications only.
    """

    omega: Floats
    H: Complexes
    coherence: Optional[Floats] = None
    valid_band_rad_s: Optional[Floats] = None
    averages: Optional[float] = None
    window_s: Optional[float] = None
    sd_db: Optional[Floats] = None
    sd_deg: Optional[Floats] = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "omega", np.asarray(self.omega, dtype=float).ravel())
        response = np.asarray(self.H, dtype=complex)
        if response.ndim == 1:
            response = response[np.newaxis, np.newaxis, :]
        object.__setattr__(self, "H", response)

    def __repr__(self) -> str:
        outputs, inputs = self.H.shape[:2]
        return (
            f"<gdcm.FrequencyResponse: {outputs} x {inputs}, {self.omega.size} frequencies, "
            f"{self.omega[0]:.3g} to {self.omega[-1]:.3g} rad/s>"
        )


def _control() -> Any:
    try:
        import control
    except ImportError as error:
        raise ImportError(
            "to_control() needs python-control, which is not installed: pip install control"
        ) from error
    return control


def _delays(control: Any, delays_s: Optional[Floats], count: int, order: int) -> Any:
    """Return the approximants of the delays of some channels, side by side."""
    blocks = []
    for index in range(count):
        delay_s = 0.0 if delays_s is None else float(delays_s[index])
        if delay_s == 0.0:
            blocks.append(control.ss([], [], [], [[1.0]]))
        else:
            numerator, denominator = control.pade(delay_s, order)
            blocks.append(control.tf2ss(numerator, denominator))
    return control.append(*blocks)


def channels_of(value: Channels) -> List[Channel]:
    """Return channels in any of the accepted forms."""
    if isinstance(value, Mapping):
        return [Channel(name, unit) for name, unit in value.items()]
    found = []
    for item in value:
        if isinstance(item, Channel):
            found.append(item)
        elif isinstance(item, str):
            found.append(Channel(item))
        else:
            name, unit = item
            found.append(Channel(name, unit))
    return found


def checked_omega(omega: ArrayLike) -> Floats:
    """Return frequencies [rad/s] as an array; an error unless all are finite and positive."""
    values = np.asarray(omega, dtype=float).ravel()
    if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
        raise Error("wrong-frequencies", "omega: expected finite frequencies above 0 rad/s")
    return values


def response_array(buffer: bytes, outputs: int, inputs: int, count: int) -> Complexes:
    """Return a response [output, input, omega] from the bytes of the program."""
    values: Complexes = np.frombuffer(buffer, dtype=np.complex128)
    return values.reshape(outputs, inputs, count).copy()


def _floats(value: Any) -> Any:
    return np.array(value, dtype=float)


def model_from_json(text: Dict[str, Any]) -> Union[StateSpace, FrequencyResponse]:
    """Read a model of a dataset, of identified models, or of corrected models."""
    measured = text.get("frequency_response")
    if measured is not None:
        return FrequencyResponse(
            omega=_floats(measured["omega_rad_s"]),
            H=_floats(measured["re"]) + 1j * _floats(measured["im"]),
            coherence=_optional(measured.get("coherence")),
            valid_band_rad_s=_optional(measured.get("valid_band_rad_s")),
            averages=measured.get("averages"),
            window_s=measured.get("window_s"),
        )
    return StateSpace(
        A=_matrix(text["A"]),
        B=_matrix(text["B"]),
        C=_matrix(text["C"]),
        D=_matrix(text["D"]),
        sample_time_s=text.get("sample_time_s"),
        input_delays_s=_optional(text.get("input_delays_s")),
        output_delays_s=_optional(text.get("output_delays_s")),
        inputs=_labels(text.get("inputs")),
        outputs=_labels(text.get("outputs")),
        states=tuple(text.get("states") or ()),
        name=text.get("name", ""),
        notes=tuple(text.get("notes") or ()),
        bands=_bands(text.get("bands")),
        method=text.get("method") or "",
    )


def _bands(text: Optional[Dict[str, Any]]) -> Optional[Bands]:
    if text is None:
        return None
    return Bands(text["omega_rad_s"], text["sd_db"], text["sd_deg"])


def _optional(value: Any) -> Any:
    return None if value is None else _floats(value)


def _matrix(value: Any) -> Any:
    return _floats(value)


def _labels(value: Optional[Sequence[Any]]) -> Tuple[str, ...]:
    found = []
    for label in value or ():
        found.append(label if isinstance(label, str) else label["name"])
    return tuple(found)


def model_to_json(model: Any, where: str) -> Dict[str, Any]:
    """Return a model as in a dataset file.

    `model` is a `StateSpace`, a `FrequencyResponse`, four matrices, or any object with matrices A,
    B, C, D (`control.StateSpace`, `scipy.signal.StateSpace`) or with `omega` and `frdata`
    (`control.FrequencyResponseData`). `where` names it in errors.
    """
    if isinstance(model, FrequencyResponse):
        return {"frequency_response": _measured_json(model, where)}
    if isinstance(model, StateSpace):
        return _matrices_json(model, where)
    if all(hasattr(model, matrix) for matrix in "ABCD"):
        return _matrices_json(_from_object(model, where), where)
    if hasattr(model, "omega") and (hasattr(model, "frdata") or hasattr(model, "fresp")):
        values = model.frdata if hasattr(model, "frdata") else model.fresp
        measured = FrequencyResponse(omega=model.omega, H=values)
        return {"frequency_response": _measured_json(measured, where)}
    try:
        a, b, c, d = model
    except (TypeError, ValueError):
        raise TypeError(
            f"{where}: expected matrices A, B, C, D, an object that has them, or a "
            f"gdcm.FrequencyResponse; found {type(model).__name__}"
        ) from None
    return _matrices_json(StateSpace(a, b, c, d), where)


def _from_object(model: Any, where: str) -> StateSpace:
    """Return an object with matrices as a model; its sample time is `dt`, as in control and scipy."""
    dt = getattr(model, "dt", None)
    if dt is True:
        raise Error(
            "sample-time",
            f"{where}: the discrete-time model has no sample time; set its dt in seconds",
        )
    sample_time_s = None if dt is None or dt == 0 else float(dt)
    states = getattr(model, "state_labels", None)
    return StateSpace(
        model.A, model.B, model.C, model.D, sample_time_s=sample_time_s, states=tuple(states or ())
    )


def _matrices_json(model: StateSpace, where: str) -> Dict[str, Any]:
    text: Dict[str, Any] = {}
    states = model.A.shape[0] if model.A.size else 0
    if states:
        for matrix in "ABCD":
            text[matrix] = _numbers(getattr(model, matrix), f"{where}, {matrix}")
    else:
        outputs, inputs = model.D.shape
        text.update(A=[], B=[], C=[[] for _ in range(outputs)])
        text["D"] = _numbers(model.D, f"{where}, D")
    if len(model.states) == states and states:
        text["states"] = list(model.states)
    if model.bands is not None:
        text["bands"] = {
            "omega_rad_s": _numbers(model.bands.omega, f"{where}, bands"),
            "sd_db": _numbers(model.bands.sd_db, f"{where}, bands"),
            "sd_deg": _numbers(model.bands.sd_deg, f"{where}, bands"),
        }
    if model.method:
        text["method"] = model.method
    if model.sample_time_s is not None:
        text["sample_time_s"] = float(model.sample_time_s)
    if model.input_delays_s is not None:
        text["input_delays_s"] = _numbers(model.input_delays_s, f"{where}, input delays")
    if model.output_delays_s is not None:
        text["output_delays_s"] = _numbers(model.output_delays_s, f"{where}, output delays")
    return text


def _measured_json(model: FrequencyResponse, where: str) -> Dict[str, Any]:
    response = f"{where}, response"
    text: Dict[str, Any] = {
        "omega_rad_s": _numbers(model.omega, f"{where}, omega"),
        "re": _numbers(model.H.real, response),
        "im": _numbers(model.H.imag, response),
    }
    if model.coherence is not None:
        text["coherence"] = _numbers(model.coherence, f"{where}, coherence")
    if model.valid_band_rad_s is not None:
        text["valid_band_rad_s"] = _numbers(model.valid_band_rad_s, f"{where}, valid band")
    if model.averages is not None:
        text["averages"] = float(model.averages)
    if model.window_s is not None:
        text["window_s"] = float(model.window_s)
    return text


def _numbers(values: ArrayLike, where: str) -> List[Any]:
    array = np.asarray(values, dtype=float)
    if not np.all(np.isfinite(array)):
        raise Error("number-not-finite", f"{where}: expected finite numbers", fields={"place": where})
    listed: List[Any] = array.tolist()
    return listed
