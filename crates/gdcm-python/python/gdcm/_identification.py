"""Identification of models from flight records."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _gdcm
from ._data import Dataset
from ._frames import pandas
from ._messages import Message, messages_of
from ._models import Complexes, FrequencyResponse, StateSpace, checked_omega, model_from_json
from ._models import response_array
from ._options import assigned, names, path, repeated, settings

PathText = Union[str, "os.PathLike[str]"]
ChannelNames = Union[str, Sequence[str], Mapping[str, str]]
"""Channels: names, each with a unit and a column if necessary (``"Q [deg/s]=pitch_rate"``), or a
mapping from names to columns."""


@dataclass(frozen=True)
class IdentificationCaution:
    """A doubt about identified models.

    Attributes
    ----------
    code : str
        Stable code, such as "not-swept" or "feedback"; the reference lists them.
    text : str
        The text, which may change.
    channel : str or None
        Affected channel.
    pair : (str, str) or None
        Affected response, output first.
    records : tuple of str
        Affected records; empty for all.
    band_rad_s : (float, float) or None
        Affected frequencies [rad/s]; for "band-narrowed" and "order-limit", the narrower band that
        is suggested.
    """

    code: str
    text: str
    channel: Optional[str] = None
    pair: Optional[Tuple[str, str]] = None
    records: Tuple[str, ...] = ()
    band_rad_s: Optional[Tuple[float, float]] = None

    def __str__(self) -> str:
        return f"{self.code}: {self.text}"


class Identification:
    """Models identified from flight records, the result of `gdcm.identify`.

    `contents` has every value, as documented for ``identified.json``.
    """

    contents: Dict[str, Any]

    def __init__(self, identification: _gdcm.Identification) -> None:
        self._identification = identification
        self.contents = json.loads(identification.json())

    @property
    def model(self) -> StateSpace:
        """The recommended model, in the units of the channels; continuous time."""
        return self.models[0]

    @property
    def models(self) -> List[StateSpace]:
        """All models: the recommended one, the unrefined one, those of neighbouring orders, and those
        fitted without one record each."""
        found = []
        for text in self.contents["models"]:
            model = model_from_json(text)
            assert isinstance(model, StateSpace)
            found.append(model)
        return found

    @property
    def order(self) -> int:
        """Order of the recommended model."""
        return int(self.contents["models"][0]["order"])

    @property
    def chi2_dof(self) -> float:
        """chi2/dof of the fit, its cost per degree of freedom; 1 if only noise remains."""
        return float(self.contents["validation"]["fit_per_dof"])

    @property
    def held_out_chi2_dof(self) -> Optional[float]:
        """chi2/dof of the held-out records for the model as it is; None without such records."""
        value = self.contents["validation"]["held_out_per_dof"]
        return None if value is None else float(value)

    @property
    def inputs(self) -> Tuple[str, ...]:
        """Names of the inputs."""
        return self.model.inputs

    @property
    def outputs(self) -> Tuple[str, ...]:
        """Names of the outputs."""
        return self.model.outputs

    @property
    def cautions(self) -> List[IdentificationCaution]:
        """Doubts about the models."""
        found = []
        for text in self.contents["cautions"]:
            band = text["band_rad_s"]
            pair = text["pair"]
            found.append(
                IdentificationCaution(
                    code=text["code"],
                    text=text["text"],
                    channel=text["channel"],
                    pair=None if pair is None else (pair[0], pair[1]),
                    records=tuple(text["records"]),
                    band_rad_s=None if band is None else (band[0], band[1]),
                )
            )
        return found

    @property
    def notes(self) -> List[Message]:
        """Assumptions made while the records were read and prepared."""
        return messages_of(self._identification.messages).notes

    @property
    def reading(self) -> List[Message]:
        """Cautions about the files of the records."""
        return messages_of(self._identification.messages).cautions

    @property
    def measured(self) -> FrequencyResponse:
        """Measured response with its standard deviations; `coherence` is the partial coherence."""
        measured = self.contents["measured"]

        def values(key: str) -> Any:
            return np.array(measured[key], dtype=float)

        return FrequencyResponse(
            omega=values("omega_rad_s"),
            H=values("re") + 1j * values("im"),
            coherence=values("partial_coherence"),
            sd_db=values("sd_db"),
            sd_deg=values("sd_deg"),
        )

    @property
    def poles(self) -> Complexes:
        """Poles of the recommended model [rad/s]."""
        poles = [complex(pole["re"], pole["im"]) for pole in self.contents["poles"]]
        return np.array(poles, dtype=complex)

    def response(self, omega: ArrayLike, model: Optional[str] = None) -> Complexes:
        """Return the response of a model, [output, input, omega].

        Parameters
        ----------
        omega : array of float
            Frequencies [rad/s].
        model : str
            Name of one of `models`; by default the recommended one.

        Returns
        -------
        ndarray of complex, shape (p, m, len(omega))
            In units of the output per unit of the input.
        """
        frequencies = checked_omega(omega)
        buffer = self._identification.response(model, frequencies.tolist())
        outputs, inputs = self.model.D.shape
        return response_array(buffer, outputs, inputs, frequencies.size)

    def to_control(self) -> Any:
        """Return the recommended model as `control.StateSpace`."""
        return self.model.to_control()

    def put_into(self, data: Dataset, condition: int, *, take: str = "refined") -> Dataset:
        """Return a dataset in which these models are the identified models of a condition.

        Parameters
        ----------
        data : Dataset
            A dataset with the same channels, in the same order and units.
        condition : int
            Number of the condition.
        take : {"refined", "with-unrefined", "measured"}
            The recommended model with its variants, these and the unrefined one, or the measured
            response alone.
        """
        return Dataset._of(self._identification.put_into(data._data, condition, take))

    def save(self, file: PathText, *, force: bool = False) -> None:
        """Write ``identified.json``; an existing file is replaced only with `force`."""
        self._identification.save(path(file), force)

    def to_frame(self) -> Any:
        """Return the measured response as a pandas data frame, a row for each response and
        frequency: output, input, omega_rad_s, magnitude_db, phase_deg, sd_db, sd_deg, coherence."""
        measured = self.measured
        assert measured.coherence is not None
        assert measured.sd_db is not None and measured.sd_deg is not None
        rows: List[Dict[str, Any]] = []
        for row, output in enumerate(self.outputs):
            for column, input_ in enumerate(self.inputs):
                for index, omega in enumerate(measured.omega):
                    value = measured.H[row, column, index]
                    rows.append(
                        {
                            "output": output,
                            "input": input_,
                            "omega_rad_s": omega,
                            "magnitude_db": 20.0 * np.log10(np.abs(value)),
                            "phase_deg": np.degrees(np.angle(value)),
                            "sd_db": measured.sd_db[row, column, index],
                            "sd_deg": measured.sd_deg[row, column, index],
                            "coherence": measured.coherence[row, column, index],
                        }
                    )
        return pandas().DataFrame(rows)

    def __repr__(self) -> str:
        return (
            f"<gdcm.Identification: order {self.order}, chi2/dof "
            f"{self.chi2_dof:.2f}, {len(self.cautions)} cautions>"
        )


def identify(
    records: Union[PathText, Sequence[PathText]],
    *,
    inputs: ChannelNames,
    outputs: ChannelNames,
    band: Tuple[float, float],
    time: Optional[str] = None,
    sample_rate: Optional[float] = None,
    resample: Optional[float] = None,
    topic: Optional[Mapping[str, str]] = None,
    held: Optional[Sequence[str]] = None,
    part: Optional[Sequence[str]] = None,
    hold_out: Union[PathText, Sequence[PathText], None] = None,
    delay: Optional[Mapping[str, float]] = None,
    unit: Optional[Mapping[str, str]] = None,
    factor: Optional[Mapping[str, float]] = None,
    reference: Optional[ChannelNames] = None,
    order: Union[int, Sequence[int], None] = None,
    past: Union[int, Sequence[int], None] = None,
    pole: Union[float, Sequence[float], None] = None,
    progress: Optional[Callable[[float, str], Any]] = None,
) -> Identification:
    """Identify models from flight records at one condition.

    Every keyword is the option of ``gdcm identify`` with the same name.

    Parameters
    ----------
    records
        Files, or folders with their subfolders: text, MATLAB, NumPy, JSON, zip, flight logs.
    inputs, outputs
        Channels: ``["LON"]``, ``["Q [deg/s]=pitch_rate"]``, or ``{"Q": "pitch_rate"}``.
    band : (float, float)
        Band to identify [rad/s].
    time, sample_rate
        Time column, or samples per second of records without one.
    resample : float
        Sample rate [Hz] of all records, with the same low-pass filter for every channel; by default
        only topics with their own time stamps are resampled.
    topic : dict
        Location of channels in logs: ``{"Q": "vehicle_angular_velocity.xyz[1]"}``.
    held : sequence of str
        Inputs that keep their logged value until the next sample (sample and hold).
    part : sequence of str
        Parts of the records to use, in seconds: ``["29:58"]``, ``["+5:+34"]``.
    hold_out
        Records for validation only; by default those named as validation.
    delay : dict
        Known delays of channels [s], positive if logged late.
    unit, factor : dict
        Units and factors of the samples of channels, which override the files.
    reference
        Recorded reference signals that drove the control loop.
    order, past, pole
        Model orders, past windows and Laguerre poles [rad/s] to search; by default those that the
        records support.
    progress : callable
        Called with the completed share (0 to 1) and the name of the step, in the calling thread.
        An exception stops the work and is raised; so does Ctrl+C.

    Raises
    ------
    Error
        Records cannot be used ("unclear-records", with the reasons in `errors`), no model was found
        ("no-models"), or no input is identified ("nothing-identified").
    """
    single = isinstance(records, (str, os.PathLike))
    listed: List[Any] = [records] if single else list(records)  # type: ignore[arg-type]
    words = [f"--inputs={_channels(inputs)}", f"--outputs={_channels(outputs)}", "--out=."]
    words += settings(
        {"band": band, "time": time, "sample_rate": sample_rate, "resample": resample}
    )
    words += assigned("topic", topic) + repeated("held", held) + repeated("part", part)
    words += repeated("hold_out", hold_out)
    words += assigned("delay", delay) + assigned("unit", unit) + assigned("factor", factor)
    words += [] if reference is None else [f"--reference={_channels(reference)}"]
    words += repeated("order", order) + repeated("past", past) + repeated("pole", pole)
    words += ["--", *(path(record) for record in listed)]
    return Identification(_gdcm.Identification(words, progress))


def _channels(value: ChannelNames) -> str:
    if isinstance(value, Mapping):
        return ",".join(f"{name}={column}" for name, column in value.items())
    return names(value)
