"""Datasets: channels, conditions and models, from files or from arrays."""

from __future__ import annotations

import io
import json
import os
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _gdcm
from ._messages import Message, messages_of
from ._models import (
    Channel,
    Channels,
    Complexes,
    FrequencyResponse,
    StateSpace,
    channels_of,
    checked_omega,
    model_from_json,
    model_to_json,
    response_array,
)
from ._options import assigned, names, path, words_of

PathText = Union[str, "os.PathLike[str]"]


@dataclass
class Condition:
    """A flight condition with its models.

    Models are `StateSpace`, `FrequencyResponse` (identified models only), four matrices
    ``(A, B, C, D)``, or any object with A, B, C and D, such as `control.StateSpace`.

    Attributes
    ----------
    id : int
        Number of the condition.
    airspeed_kt : float
        True airspeed [kt].
    nominal
        Physics model at the trim of the condition.
    perturbed : dict
        Further physics models by name, linearised at neighbouring trims.
    identified : dict
        Models identified from flight, by name; the reference of the correction. A condition without
        identified models has no result.
    name : str
        Name for display; "condition ID" if empty.
    altitude, weight : str or None
        Labels, such as "low" and "high".
    altitude_ft, mass_kg : float or None
        Altitude [ft] and mass [kg].
    perturbations : dict
        Trim offsets of physics models from the trim of the condition, by model and coordinate:
        ``{"V+5kt": {"airspeed_kt": 5}}``.
    nominal_name : str
        Name of the nominal model.
    """

    id: int
    airspeed_kt: float
    nominal: Any
    perturbed: Dict[str, Any] = field(default_factory=dict)
    identified: Dict[str, Any] = field(default_factory=dict)
    name: str = ""
    altitude: Optional[str] = None
    altitude_ft: Optional[float] = None
    weight: Optional[str] = None
    mass_kg: Optional[float] = None
    perturbations: Dict[str, Dict[str, float]] = field(default_factory=dict)
    nominal_name: str = "nominal"

    def __repr__(self) -> str:
        return (
            f"<gdcm.Condition {self.id}: {self.airspeed_kt:g} kt, {1 + len(self.perturbed)} physics "
            f"and {len(self.identified)} identified models>"
        )

    def _to_json(self) -> Dict[str, Any]:
        physics = [self._physics_json(self.nominal_name, self.nominal, "nominal")]
        for name, model in self.perturbed.items():
            physics.append(self._physics_json(name, model, "perturbed"))
        identified = []
        for name, model in self.identified.items():
            where = f"condition {self.id}, identified model {name!r}"
            identified.append({"name": name, **model_to_json(model, where)})
        text: Dict[str, Any] = {
            "id": self.id,
            "name": self.name or f"condition {self.id}",
            "airspeed_kt": float(self.airspeed_kt),
            "physics_models": physics,
            "identified_models": identified,
        }
        for key in ("altitude", "altitude_ft", "weight", "mass_kg"):
            value = getattr(self, key)
            if value is not None:
                text[key] = value
        return text

    def _physics_json(self, name: str, model: Any, role: str) -> Dict[str, Any]:
        where = f"condition {self.id}, physics model {name!r}"
        text: Dict[str, Any] = {"name": name, "role": role, **model_to_json(model, where)}
        if name in self.perturbations:
            text["perturbation"] = {
                coordinate: float(value) for coordinate, value in self.perturbations[name].items()
            }
        return text

    @classmethod
    def _from_json(cls, text: Dict[str, Any]) -> Condition:
        nominal: Any = None
        nominal_name = "nominal"
        perturbed: Dict[str, Any] = {}
        perturbations: Dict[str, Dict[str, float]] = {}
        for model in text["physics_models"]:
            if "parameter" in model or "parameters" in model:
                continue
            if model.get("perturbation"):
                perturbations[model["name"]] = model["perturbation"]
            if model.get("role") == "nominal":
                nominal, nominal_name = model_from_json(model), model["name"]
            else:
                perturbed[model["name"]] = model_from_json(model)
        identified = {
            model["name"]: model_from_json(model) for model in text.get("identified_models", [])
        }
        return cls(
            id=text["id"],
            airspeed_kt=text["airspeed_kt"],
            nominal=nominal,
            perturbed=perturbed,
            identified=identified,
            name=text["name"],
            altitude=text.get("altitude"),
            altitude_ft=text.get("altitude_ft"),
            weight=text.get("weight"),
            mass_kg=text.get("mass_kg"),
            perturbations=perturbations,
            nominal_name=nominal_name,
        )


class Dataset:
    """A dataset; if it was loaded from a study, with the decisions of that study.

    Parameters
    ----------
    conditions : sequence of Condition
        The flight conditions.
    inputs, outputs
        Channels with their units, in the order of the rows and columns of the matrices:
        ``{"LON": "%"}`` or ``[("LON", "%")]``.
    band : (float, float)
        Band of the comparison [rad/s].
    on_axis : sequence of (output, input), optional
        Responses that the correction matches; by default none.
    name, description : str
        Texts for display.

    Raises
    ------
    Error
        The arrays do not form a dataset; `code` and `fields["place"]` state the fault and its place.
    """

    _data: _gdcm.Data
    _contents: Optional[Dict[str, Any]]
    _conditions: Optional[Dict[int, Condition]]

    def __init__(
        self,
        conditions: Sequence[Condition],
        *,
        inputs: Channels,
        outputs: Channels,
        band: Tuple[float, float],
        on_axis: Optional[Sequence[Tuple[str, str]]] = None,
        name: str = "dataset",
        description: str = "",
    ) -> None:
        lowest, highest = band
        contents: Dict[str, Any] = {
            "format": "gdcm-dataset",
            "version": 1,
            "name": name,
            "inputs": [_channel_json(channel) for channel in channels_of(inputs)],
            "outputs": [_channel_json(channel) for channel in channels_of(outputs)],
            "on_axis": [[output, input_] for output, input_ in on_axis or []],
            "frequency_band": {"min": float(lowest), "max": float(highest), "unit": "rad/s"},
            "conditions": [condition._to_json() for condition in conditions],
        }
        if description:
            contents["description"] = description
        self._set(_gdcm.Data.from_json(json.dumps(contents), f"({name})"))

    def _set(self, data: _gdcm.Data) -> None:
        self._data = data
        self._contents = None
        self._conditions = None

    @classmethod
    def _of(cls, data: _gdcm.Data) -> Dataset:
        dataset = cls.__new__(cls)
        dataset._set(data)
        return dataset

    @classmethod
    def from_dict(cls, contents: Mapping[str, Any]) -> Dataset:
        """Make a dataset from the contents of a dataset file; lists may be NumPy arrays."""
        text = json.dumps(contents, default=_plain)
        return cls._of(_gdcm.Data.from_json(text, f"({contents.get('name', 'dataset')})"))

    @property
    def contents(self) -> Dict[str, Any]:
        """The contents of the dataset file, as documented in the reference of the format."""
        if self._contents is None:
            self._contents = json.loads(self._data.dataset_json())
        return self._contents

    @property
    def name(self) -> str:
        """Name of the dataset."""
        return str(self.contents["name"])

    @property
    def source(self) -> str:
        """Path of the file, or a description in parentheses."""
        return self._data.source

    @property
    def inputs(self) -> Tuple[Channel, ...]:
        """Inputs, in the order of the columns of the matrices."""
        return _channels(self.contents["inputs"])

    @property
    def outputs(self) -> Tuple[Channel, ...]:
        """Outputs, in the order of the rows of the matrices."""
        return _channels(self.contents["outputs"])

    @property
    def band(self) -> Tuple[float, float]:
        """Band of the comparison [rad/s]."""
        band = self.contents["frequency_band"]
        return (band["min"], band["max"])

    @property
    def on_axis(self) -> List[Tuple[str, str]]:
        """Responses (output, input) that a new study matches."""
        return [(output, input_) for output, input_ in self.contents.get("on_axis") or []]

    @property
    def conditions(self) -> Dict[int, Condition]:
        """Conditions by id, with their models as arrays.

        Physics models with a changed named parameter are left out; they are in `contents`.
        """
        if self._conditions is None:
            conditions = [Condition._from_json(text) for text in self.contents["conditions"]]
            self._conditions = {condition.id: condition for condition in conditions}
        return self._conditions

    @property
    def notes(self) -> List[Message]:
        """Assumptions made while the files were read."""
        return messages_of(self._data.messages).notes

    @property
    def cautions(self) -> List[Message]:
        """Cautions about the files, to be checked."""
        return messages_of(self._data.messages).cautions

    @property
    def rules(self) -> Optional[Dict[str, Any]]:
        """Rules by which the models were assembled; None for a dataset that was not assembled."""
        rules = bytes(self._data.rules)
        return json.loads(rules) if rules else None

    def response(
        self,
        condition: int,
        omega: ArrayLike,
        model: Optional[str] = None,
        *,
        bundle: str = "physics",
    ) -> Complexes:
        """Return the response of a model, [output, input, omega]; delays are exact.

        Parameters
        ----------
        condition : int
            Number of the condition.
        omega : array of float
            Frequencies [rad/s].
        model : str
            Name of the model; by default the nominal physics model, or the first identified one.
        bundle : {"physics", "identified"}
            The bundle that contains the model.

        Returns
        -------
        ndarray of complex, shape (p, m, len(omega))
            In units of the output per unit of the input; NaN where the model has no response.
        """
        if bundle not in ("physics", "identified"):
            raise ValueError(f'bundle: expected "physics" or "identified", found {bundle!r}')
        frequencies = checked_omega(omega)
        if model is None:
            found = self.conditions[condition]
            model = found.nominal_name if bundle == "physics" else next(iter(found.identified))
        buffer = self._data.response(condition, bundle, model, frequencies.tolist())
        return response_array(buffer, len(self.outputs), len(self.inputs), frequencies.size)

    def save(self, file: PathText, *, force: bool = False) -> None:
        """Write the dataset, compressed if the name ends in ".gz". If it ends in ".gdcm-study.json",
        write the study, and its dataset into the same folder if the dataset has no file yet.

        An existing dataset is replaced only with `force`.
        """
        if path(file).endswith(".gdcm-study.json"):
            self._data.save_study(path(file))
        else:
            self._data.save_dataset(path(file), force)

    def __repr__(self) -> str:
        names_of = ", ".join(channel.name for channel in self.outputs)
        inputs = ", ".join(channel.name for channel in self.inputs)
        count = len(self.contents["conditions"])
        return f"<gdcm.Dataset {self.name!r}: {count} conditions, {inputs} -> {names_of}>"


def example(*, real: bool = False) -> Dataset:
    """Return the example of the program: a simulated helicopter at eleven conditions.

    With `real`, a quadrotor with its published physics model and models from two flights.
    """
    return Dataset._of(_gdcm.Data.example(real))


def example_records(
    folder: PathText, condition: Optional[int] = None, *, real: bool = False
) -> List[Path]:
    """Write the flight records of the example into a folder, which is created if missing.

    Parameters
    ----------
    folder
        Folder of the CSV files; files of the same names are replaced.
    condition
        Condition 3 or 10 of the example (1 or 2 of the real aircraft); by default both.

    Returns
    -------
    list of Path
        The files, by name.
    """
    Path(folder).mkdir(parents=True, exist_ok=True)
    written = []
    with zipfile.ZipFile(io.BytesIO(_gdcm.example_records(real))) as archive:
        for name in sorted(archive.namelist()):
            if condition is not None and not name.startswith(f"cond{condition:02d}_"):
                continue
            target = Path(folder) / Path(name).name
            target.write_bytes(archive.read(name))
            written.append(target)
    return written


def load(
    file: PathText, *, dataset: Optional[PathText] = None, strict: bool = False
) -> Dataset:
    """Open a dataset or a study.

    Parameters
    ----------
    file
        Dataset (``.json``, ``.json.gz``) or study (``.gdcm-study.json``).
    dataset
        The study's dataset, if it has moved.
    strict
        Whether a dataset that has changed since the study was saved is an error, instead of
        cautions.
    """
    return Dataset._of(
        _gdcm.Data.load(path(file), None if dataset is None else path(dataset), strict)
    )


def assemble(
    folders: Union[PathText, Sequence[PathText]],
    *,
    rules: Optional[PathText] = None,
    headings: Optional[Sequence[str]] = None,
    sign: Optional[Mapping[str, Any]] = None,
    unit: Optional[Mapping[str, str]] = None,
    factor: Optional[Mapping[str, Any]] = None,
    sample_time: Optional[float] = None,
) -> Dataset:
    """Make a dataset from folders with model files: MATLAB, NumPy, JSON, text.

    Parameters
    ----------
    folders
        Folders with their subfolders, or files.
    rules
        File of rules for the files; by default rules are proposed from names and contents.
    headings
        Column headings for tables without headings: ``["omega [rad/s]", "mag [dB]"]``.
    sign, unit, factor
        Declarations by channel, for the identified models or as in the command:
        ``sign={"NZ": -1}``, ``unit={"LON": "in:physics"}``, ``factor={"LON": 8}``.
    sample_time
        Sample time [s] of models that state none; 0 for continuous time.

    Raises
    ------
    Error
        Files cannot be read, or items are missing ("incomplete-rules"); `errors` then lists them,
        each with its code.
    """
    single = isinstance(folders, (str, os.PathLike))
    listed: List[Any] = [folders] if single else list(folders)  # type: ignore[arg-type]
    words = ["--out=(memory)"]
    words += [] if rules is None else [f"--rules={path(rules)}"]
    words += [] if headings is None else [f"--headings={names(headings)}"]
    words += assigned("sign", sign) + assigned("unit", unit) + assigned("factor", factor)
    words += words_of("sample_time", sample_time)
    words += ["--", *(path(folder) for folder in listed)]
    return Dataset._of(_gdcm.Data.assemble(words))


def _channel_json(channel: Channel) -> Dict[str, str]:
    text = {"name": channel.name, "unit": channel.unit}
    if channel.description:
        text["description"] = channel.description
    return text


def _channels(texts: Sequence[Dict[str, str]]) -> Tuple[Channel, ...]:
    return tuple(
        Channel(text["name"], text["unit"], text.get("description") or "") for text in texts
    )


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(
        f"expected numbers, texts, lists, dicts or NumPy arrays, found {type(value).__name__}"
    )


__all__ = [
    "Condition",
    "Dataset",
    "FrequencyResponse",
    "StateSpace",
    "assemble",
    "example",
    "example_records",
    "load",
]
