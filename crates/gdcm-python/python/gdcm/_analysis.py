"""Analyses: gains, delays and leads of every condition, and their schedule."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Callable, Dict, Generic, Iterator, List, Mapping, Optional, Sequence
from typing import Tuple, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _gdcm
from ._data import Dataset
from ._error import Error
from ._figure import Figure
from ._frames import frame_of, pandas
from ._messages import Message, messages_of
from ._models import Complexes, Floats, StateSpace, checked_omega, model_from_json, response_array
from ._options import Pair, assigned, names, pair, pairs, path, repeated, settings

T = TypeVar("T")
Progress = Callable[[float, str], Any]
"""Called with the completed share (0 to 1) of the present step, and its name."""
PathText = Union[str, "os.PathLike[str]"]


class ChannelTable(Mapping[str, T], Generic[T]):
    """A value for each channel, by name: ``gains["LON"]``.

    `inputs` and `outputs` hold the two sides separately. Use them if an input and an output have the
    same name.
    """

    inputs: Dict[str, T]
    outputs: Dict[str, T]

    def __init__(self, inputs: Mapping[str, T], outputs: Mapping[str, T]) -> None:
        self.inputs = dict(inputs)
        self.outputs = dict(outputs)

    def __getitem__(self, channel: str) -> T:
        if channel in self.inputs and channel in self.outputs:
            raise KeyError(f"{channel} is an input and an output; use .inputs or .outputs")
        if channel in self.inputs:
            return self.inputs[channel]
        return self.outputs[channel]

    def __iter__(self) -> Iterator[str]:
        yield from self.inputs
        for channel in self.outputs:
            if channel not in self.inputs:
                yield channel

    def __len__(self) -> int:
        return len(set(self.inputs) | set(self.outputs))

    def __repr__(self) -> str:
        return f"ChannelTable(inputs={self.inputs!r}, outputs={self.outputs!r})"


class PairTable(Mapping[Tuple[str, str], T], Generic[T]):
    """A value for each response that has one: ``net_gain["Q", "LON"]``, output first.

    `array` has them all, ``[output, input]`` (a pair of numbers adds an axis of length 2), NaN where
    there is none.
    """

    outputs: Tuple[str, ...]
    inputs: Tuple[str, ...]

    def __init__(
        self,
        outputs: Sequence[str],
        inputs: Sequence[str],
        values: Mapping[Tuple[str, str], T],
    ) -> None:
        self.outputs = tuple(outputs)
        self.inputs = tuple(inputs)
        self._values = dict(values)

    def __getitem__(self, response: Tuple[str, str]) -> T:
        return self._values[response]

    def __iter__(self) -> Iterator[Tuple[str, str]]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    @property
    def array(self) -> Floats:
        """The values as an array, [output, input]."""
        example: Any = next(iter(self._values.values()), 0.0)
        shape = (len(self.outputs), len(self.inputs), *np.shape(example))
        array = np.full(shape, np.nan)
        for (output, input_), value in self._values.items():
            array[self.outputs.index(output), self.inputs.index(input_)] = value
        return array

    def __repr__(self) -> str:
        return f"PairTable({self._values!r})"


@dataclass(frozen=True)
class ScheduledCorrection:
    """The correction of the schedule at an airspeed.

    Attributes
    ----------
    gains : ChannelTable of float
        Gain of each channel.
    delays_s : ChannelTable of float
        Delay of each channel [s], not negative.
    leads : ChannelTable of dict, or None
        Lead filter of each channel (``tau_s``, ``lead_s``, ``zero_rad_s``, ``lag_rad_s``, ...);
        None without leads.
    """

    airspeed_kt: float
    gains: ChannelTable[float]
    delays_s: ChannelTable[float]
    leads: Optional[ChannelTable[Dict[str, Optional[float]]]]


class Schedule:
    """The correction over airspeed.

    `contents` is the part ``schedule`` of ``corrections.json``, with the coefficients.
    """

    contents: Dict[str, Any]

    def __init__(self, analysis: _gdcm.Analysis, contents: Dict[str, Any]) -> None:
        self._analysis = analysis
        self.contents = contents

    @property
    def airspeed_range_kt(self) -> Tuple[float, float]:
        """Lowest and highest airspeed of the scheduled conditions [kt]."""
        lowest, highest = self.contents["airspeed_range_kt"]
        return (lowest, highest)

    @property
    def degree(self) -> Optional[int]:
        """Degree of the polynomials of airspeed; None for a lookup table."""
        degree = self.contents["degree"]
        return None if degree is None else int(degree)

    @property
    def cautions(self) -> List[Message]:
        """Cautions about the schedule, to be checked."""
        found = []
        for note in self.contents.get("caution_notes", []):
            condition = note.get("condition")
            ids = () if condition is None else (condition,)
            found.append(Message(note["code"], note["text"], ids))
        return found

    def at(
        self,
        airspeed_kt: float,
        *,
        altitude_ft: Optional[float] = None,
        mass_kg: Optional[float] = None,
    ) -> ScheduledCorrection:
        """Return the correction at an airspeed [kt].

        Outside the range of the conditions' airspeeds, the correction at the nearest end applies. If
        the schedule has a second variable, give its value as `altitude_ft` or `mass_kg`; the default
        is the middle of its range.
        """
        second = self._second(altitude_ft, mass_kg)
        values = json.loads(self._analysis.schedule_at(float(airspeed_kt), second))
        return ScheduledCorrection(
            airspeed_kt=float(airspeed_kt),
            gains=_channel_table(values["gains"]),
            delays_s=_channel_table(values["delays_s"]),
            leads=None if values["lead"] is None else _channel_table(values["lead"]),
        )

    def _second(self, altitude_ft: Optional[float], mass_kg: Optional[float]) -> Optional[float]:
        given = {"altitude": altitude_ft, "mass": mass_kg}
        variable = self.contents.get("second_variable")
        name = None if variable is None else variable["variable"]
        for other, value in given.items():
            if value is not None and other != name:
                raise ValueError(f"the schedule does not depend on {other}; omit this argument")
        return None if name is None else given[name]

    def to_frame(self) -> Any:
        """Return gains and delays [s] at the scheduled airspeeds as a pandas data frame, indexed by
        airspeed [kt], with columns (quantity, channel)."""
        rows = {}
        for airspeed_kt in (row["airspeed_kt"] for row in self.contents["table"]):
            found = self.at(airspeed_kt)
            row = {("gain", channel): value for channel, value in found.gains.items()}
            if found.leads is None:
                delays: Dict[str, Any] = dict(found.delays_s)
            else:
                delays = {name: lead["tau_s"] for name, lead in found.leads.items()}
            row.update({("delay_s", channel): value for channel, value in delays.items()})
            rows[airspeed_kt] = row
        frame = pandas().DataFrame.from_dict(rows, orient="index")
        frame.index.name = "airspeed_kt"
        frame.columns = pandas().MultiIndex.from_tuples(frame.columns)
        return frame

    def __repr__(self) -> str:
        lowest, highest = self.airspeed_range_kt
        return f"<gdcm.Schedule: {lowest:g} to {highest:g} kt>"


class ConditionResult:
    """The result of a condition; matrices are ``[output, input]`` in the order of the dataset.

    `contents` is the condition's part of ``corrections.json``, with every value.

    Attributes
    ----------
    id : int
        Number of the condition.
    """

    contents: Dict[str, Any]

    def __init__(self, analysis: Analysis, contents: Dict[str, Any]) -> None:
        self._analysis = analysis
        self.contents = contents

    @property
    def id(self) -> int:
        """Number of the condition."""
        return int(self.contents["id"])

    @property
    def name(self) -> str:
        """Name of the condition."""
        return str(self.contents["name"])

    @property
    def airspeed_kt(self) -> float:
        """True airspeed [kt]."""
        return float(self.contents["airspeed_kt"])

    @property
    def physics_representative(self) -> str:
        """Name of the physics model that represents the bundle."""
        return str(self.contents["physics_representative"])

    @property
    def identified_representative(self) -> str:
        """Name of the identified model that represents the bundle."""
        return str(self.contents["identified_representative"])

    @property
    def rejected(self) -> List[str]:
        """Names of the rejected models."""
        return list(self.contents["rejected"])

    @property
    def suggested_outliers(self) -> List[str]:
        """Names of the physics models suggested as outliers."""
        return list(self.contents["suggested_outliers"])

    @property
    def discontinuity(self) -> Dict[str, float]:
        """Discontinuity ratio of each physics model by name."""
        return dict(self.contents["discontinuity"])

    @property
    def G(self) -> Floats:
        """Delta gain G of each response, shape (p, m): the gain that would match it; NaN if
        undefined."""
        return np.array(self.contents["G"], dtype=float)

    @property
    def D_s(self) -> Floats:
        """Delta delay D of each response [s], shape (p, m): the delay that would match it; NaN if
        undefined."""
        return np.array(self.contents["D_s"], dtype=float)

    @property
    def gain_bounds(self) -> Tuple[float, float]:
        """Lower and upper bound of the channel gains."""
        lower, upper = self.contents["gain_bounds"]
        return (lower, upper)

    @property
    def delay_upper_s(self) -> float:
        """Upper bound of the channel delays [s]."""
        return float(self.contents["delay_upper_s"])

    @property
    def gains(self) -> ChannelTable[float]:
        """Gain of each channel."""
        return _channel_table(self.contents["gains"])

    @property
    def gain_intervals(self) -> ChannelTable[Tuple[float, float]]:
        """Confidence interval of the gain of each channel, (low, high), at the confidence level of
        the analysis (`level`)."""
        return _intervals(self.contents["bars"]["gains"])

    @property
    def delays_s(self) -> ChannelTable[float]:
        """Delay of each channel [s]; negative for a lead."""
        leads = self.leads
        if leads is None:
            return _channel_table(self.contents["delays_s"])
        return ChannelTable(
            {channel: float(lead["tau_s"] or 0.0) for channel, lead in leads.inputs.items()},
            {channel: float(lead["tau_s"] or 0.0) for channel, lead in leads.outputs.items()},
        )

    @property
    def leads(self) -> Optional[ChannelTable[Dict[str, Optional[float]]]]:
        """Lead filter of each channel: ``tau_s``, ``lead_s`` [s], ``zero_rad_s``, ``lag_rad_s``
        [rad/s], gains in dB; None unless the phase is corrected by leads."""
        leads = self.contents.get("lead")
        return None if leads is None else _channel_table(leads)

    @property
    def net_gain(self) -> PairTable[float]:
        """Net gain of each response, the gain of its output times that of its input."""
        return self._pairs({_pair(row): row["gain"] for row in self.contents["net_gains"]})

    @property
    def net_gain_interval(self) -> PairTable[Tuple[float, float]]:
        """Confidence interval of each net gain, (low, high), at the confidence level of the analysis
        (`level`)."""
        return self._pairs(
            {
                _pair(row): (row["interval"][0], row["interval"][1])
                for row in self.contents["net_gains"]
                if row.get("interval") is not None
            }
        )

    @property
    def net_delay_s(self) -> PairTable[float]:
        """Net delay of each response [s], that of its output plus that of its input; negative for a
        lead."""
        delays = self.delays_s
        return self._pairs(
            {
                (output, input_): delay_o + delay_i
                for output, delay_o in delays.outputs.items()
                for input_, delay_i in delays.inputs.items()
            }
        )

    @property
    def J(self) -> Dict[str, Dict[str, Floats]]:
        """Cost of the physics representative: ``J["uncorrected"]["mag"]`` and ``["phase"]``,
        ``J["corrected"][...]``, arrays of shape (p, m); NaN where undefined."""
        return {
            state: {part: np.array(values, dtype=float) for part, values in parts.items()}
            for state, parts in self.contents["J"].items()
        }

    def response(
        self, omega: ArrayLike, *, model: str = "nominal", correction: str = "own"
    ) -> Complexes:
        """Return the response of the corrected physics model, [output, input, omega].

        Delays are exact, leads and couplings included.

        Parameters
        ----------
        omega : array of float
            Frequencies [rad/s].
        model : str
            "nominal", "representative", or the name of a physics model.
        correction : {"own", "scheduled"}
            Correction of the condition itself, or of the schedule at its airspeed.

        Returns
        -------
        ndarray of complex, shape (p, m, len(omega))
            In units of the output per unit of the input.
        """
        frequencies = checked_omega(omega)
        analysis = self._analysis
        buffer = analysis._analysis.response(
            self.id, model, _scheduled(correction), frequencies.tolist()
        )
        shape = (len(analysis.outputs), len(analysis.inputs), frequencies.size)
        return response_array(buffer, *shape)

    def state_space(
        self, pade: int = 2, *, model: str = "nominal", correction: str = "own"
    ) -> StateSpace:
        """Return the corrected physics model as matrices.

        Parameters
        ----------
        pade : int
            Order, 1 to 8, of the Pade approximants that replace the delays; the model's `notes` state
            their error. Delays of discrete-time models are exact.
        model, correction
            As for `response`.
        """
        text = self._analysis._analysis.model_json(self.id, model, _scheduled(correction), pade)
        found = model_from_json(json.loads(text)["models"][0])
        assert isinstance(found, StateSpace)
        return found

    def to_control(
        self, pade: int = 2, *, model: str = "nominal", correction: str = "own"
    ) -> Any:
        """Return the corrected physics model as `control.StateSpace`; see `state_space`."""
        return self.state_space(pade, model=model, correction=correction).to_control()

    def _pairs(self, values: Dict[Tuple[str, str], T]) -> PairTable[T]:
        return PairTable(self._analysis.outputs, self._analysis.inputs, values)

    def __repr__(self) -> str:
        return f"<gdcm.ConditionResult {self.id}: {self.name}>"


@dataclass(frozen=True)
class Assessment:
    """Change in the cost of a condition's nominal model due to the schedule.

    `dJ`, `dJ_mag` and `dJ_phase` have the shape (p, m); negative is better, NaN means undefined.
    """

    id: int
    model: str
    dJ: Floats
    dJ_mag: Floats
    dJ_phase: Floats


class Analysis:
    """The result of `gdcm.analyze`; ``fix[10]`` is the result of condition 10.

    All numbers are the same as in the file ``corrections.json`` of the command ``gdcm analyze``.
    """

    def __init__(self, analysis: _gdcm.Analysis) -> None:
        self._analysis = analysis
        self._corrections: Dict[str, Any] = json.loads(analysis.corrections_json())

    @property
    def corrections(self) -> Dict[str, Any]:
        """All results as in ``corrections.json``, documented in its reference."""
        return self._corrections

    @property
    def data(self) -> Dataset:
        """The dataset with the decisions of this analysis."""
        return Dataset._of(self._analysis.data())

    @property
    def inputs(self) -> Tuple[str, ...]:
        """Names of the inputs."""
        return tuple(channel["name"] for channel in self._corrections["inputs"])

    @property
    def outputs(self) -> Tuple[str, ...]:
        """Names of the outputs."""
        return tuple(channel["name"] for channel in self._corrections["outputs"])

    @property
    def settings(self) -> Dict[str, Any]:
        """Settings of the analysis, as in ``corrections.json``."""
        return dict(self._corrections["settings"])

    @property
    def ids(self) -> List[int]:
        """Numbers of the conditions that have a result."""
        return [condition["id"] for condition in self._corrections["conditions"]]

    @property
    def failed(self) -> List[Message]:
        """Conditions without a result, each with the reason."""
        return [
            Message(failure["code"], failure["why"], (failure["id"],))
            for failure in self._corrections["failed"]
        ]

    def __getitem__(self, condition: int) -> ConditionResult:
        for contents in self._corrections["conditions"]:
            if contents["id"] == condition:
                return ConditionResult(self, contents)
        for failure in self._corrections["failed"]:
            if failure["id"] == condition:
                raise Error(failure["code"], f"condition {condition}: {failure['why']}", status=1)
        raise KeyError(condition)

    def __iter__(self) -> Iterator[ConditionResult]:
        for contents in self._corrections["conditions"]:
            yield ConditionResult(self, contents)

    def __len__(self) -> int:
        return len(self._corrections["conditions"])

    @property
    def schedule(self) -> Schedule:
        """The correction over airspeed.

        Raises
        ------
        Error
            The analysis has no schedule ("no-schedule").
        """
        contents = self._corrections["schedule"]
        if contents is None:
            raise Error("no-schedule", "the analysis has no schedule", status=1)
        return Schedule(self._analysis, contents)

    @property
    def assessment(self) -> Dict[int, Assessment]:
        """Change in the cost due to the schedule, by condition."""
        found = {}
        for row in self._corrections["assessment"]["conditions"]:
            changes = {key: np.array(row[key], dtype=float) for key in ("dJ", "dJ_mag", "dJ_phase")}
            found[row["id"]] = Assessment(row["id"], row["model"], **changes)
        return found

    @property
    def uncertainty(self) -> Optional[Dict[str, Any]]:
        """Error bars and tests over all conditions, as in ``corrections.json``."""
        return self._corrections.get("uncertainty")

    @property
    def notes(self) -> List[Message]:
        """Assumptions made in the analysis."""
        return messages_of(self._analysis.messages).notes

    @property
    def cautions(self) -> List[Message]:
        """Cautions about the results, to be checked, each with its conditions."""
        before = messages_of(self._analysis.messages).cautions
        return before + messages_of(self._analysis.summary_messages).cautions

    @property
    def summary(self) -> str:
        """The summary that the command ``gdcm analyze`` prints."""
        return self._analysis.summary

    def to_frame(self, table: str = "channels") -> Any:
        """Return a table as a pandas data frame, with the columns of the CSV file.

        Parameters
        ----------
        table : {"channels", "responses"}
            A row for each condition and channel (``corrections.csv``), or for each condition and
            response (``assessment.csv``). Column names contain the units.
        """
        tables = ("channels", "responses")
        if table not in tables:
            raise ValueError(f"table: expected one of {tables}, found {table!r}")
        text = self._analysis.tables()[tables.index(table)]
        return frame_of(text)

    def figure(
        self,
        view: str,
        *,
        condition: Optional[int] = None,
        response: Union[Pair, Sequence[Pair], None] = None,
        channel: Union[str, Sequence[str], None] = None,
        delays: bool = False,
        over_conditions: bool = False,
        hide: Optional[Sequence[str]] = None,
        bars: bool = False,
        hertz: bool = False,
        model: Optional[Sequence[str]] = None,
        zeros: Optional[Pair] = None,
        muad: bool = False,
        width: str = "double",
        progress: Optional[Progress] = None,
    ) -> Figure:
        """Draw a figure as the window does; a notebook displays it.

        Parameters
        ----------
        view : str
            Name as in ``gdcm figure --view``: "bode", "error", "overview" (of one condition),
            "net-gain", "channels", "evidence", "airspeeds", "poles", and others.
        condition : int
            Condition, for the figures of a single condition.
        response
            Responses, ``("Q", "LON")`` or a list, or "on-axis", "off-axis", "all".
        channel
            Channels of the figure "channels": names, or "inputs", "outputs".
        delays, over_conditions
            Delays instead of gains; over conditions instead of airspeed.
        hide
            Models to omit: "perturbed", "identified", "rejected".
        bars, hertz, muad
            Error bars; frequencies in Hz; envelopes of unnoticeable added dynamics.
        model
            Models of each condition in the figure "airspeeds".
        zeros
            Response whose zeros are added to the figure "poles".
        width : {"single", "double"}
            Width on paper: one column (84 mm) or both (174 mm).
        progress : callable
            Called with the completed share and the name of the step.
        """
        words = [f"--view={view}", "--out=figure.svg", f"--width={width}"]
        words += settings(
            {
                "condition": condition,
                "delays": delays,
                "over_conditions": over_conditions,
                "bars": bars,
                "hertz": hertz,
                "muad": muad,
            }
        )
        words += [] if response is None else [f"--pair={pairs(response)}"]
        words += [] if channel is None else [f"--channel={names(channel)}"]
        words += [] if hide is None else [f"--hide={names(hide)}"]
        words += [] if model is None else [f"--model={names(model)}"]
        words += [] if zeros is None else [f"--zeros={pair(zeros)}"]
        return Figure(self._analysis.figure(words, progress))

    def save(self, file: PathText) -> None:
        """Save the study with its decisions, ``NAME.gdcm-study.json``, for the window and the
        commands. A dataset without a file is written to ``NAME.dataset.json.gz`` in the same folder.
        """
        self._analysis.save_study(path(file))

    def write_results(self, folder: PathText, *, force: bool = False) -> None:
        """Write the files of ``gdcm analyze`` into a folder, which is created if missing.

        Existing files are replaced only with `force`.
        """
        self._analysis.write_results(path(folder), force)

    def __repr__(self) -> str:
        name = self._corrections["dataset"]["name"]
        return f"<gdcm.Analysis of {name!r}: {len(self)} conditions>"


def analyze(
    data: Dataset,
    *,
    phase: Optional[str] = None,
    reject: Union[str, Sequence[Union[str, Tuple[int, str]]], None] = None,
    on: Union[Pair, Sequence[Pair], None] = None,
    band: Optional[Tuple[float, float]] = None,
    points: Optional[int] = None,
    alpha: Optional[float] = None,
    alpha_delay: Optional[float] = None,
    delay_from: Optional[str] = None,
    lead_order: Optional[int] = None,
    lead_n: Optional[float] = None,
    lead_r_max: Optional[float] = None,
    couplings: Optional[str] = None,
    physics: Optional[str] = None,
    parameter: Optional[Mapping[str, Union[str, float]]] = None,
    quantile: Optional[float] = None,
    gain_bounds: Union[str, Tuple[float, float], None] = None,
    delay_bound: Union[str, float, None] = None,
    agreement: Optional[float] = None,
    cost_average: Optional[str] = None,
    gain_objective: Optional[str] = None,
    gain_from: Optional[str] = None,
    level: Optional[float] = None,
    pooling: Optional[float] = None,
    coherence: Union[str, float, None] = None,
    averages: Union[str, float, None] = None,
    averaging_window: Union[str, float, None] = None,
    half_overlap: bool = False,
    degree: Union[str, int, None] = None,
    schedule_of: Optional[str] = None,
    schedule_delays: Optional[str] = None,
    tau_degree: Optional[int] = None,
    airspeed_tolerance: Optional[float] = None,
    second_variable: Optional[str] = None,
    hold_out: Optional[Sequence[int]] = None,
    sign: Optional[Mapping[str, Union[str, int]]] = None,
    attitude_command: Optional[Sequence[str]] = None,
    levels: Union[PathText, Sequence[PathText], None] = None,
    tolerances: Optional[PathText] = None,
    progress: Optional[Progress] = None,
) -> Analysis:
    """Correct the physics models of a dataset or a study so that they match flight.

    Every keyword is the option of ``gdcm analyze`` with the same name and overrides the decision of
    the study; None keeps it.

    Parameters
    ----------
    data : Dataset
        From `example`, `load`, `assemble`, or made from arrays.
    phase : {"none", "delay", "lead"}
        Correction of the phase: none, a delay in each channel, or a delay or lead filter in each.
    reject
        Models to reject, ``[(10, "nominal")]``, or "suggested" for the suggested outliers.
    on
        Responses to match, ``[("Q", "LON")]``; an empty list for none. By default those of the
        dataset.
    band : (float, float)
        Band of the comparison [rad/s].
    points : int
        Number of frequencies in the band.
    alpha, alpha_delay : float
        Weights that keep output gains near 1 and delays near 0.
    delay_from : {"median", "band"}
        Definition of the delta delay D: median of the phase difference divided by frequency, or
        slope of the line through the origin fitted to it over the band.
    lead_order, lead_n, lead_r_max
        Lead filters: order (1 or 2); n in the lag 1/(n omega_B), with omega_B the upper end of the
        band; greatest gain.
    couplings : {"none", "mixing", "feedback"}
        Correction of couplings.
    physics : {"off", "named", "all", "by-hand"}
        Named physics parameters to change in the physics models: none, those that need a change to
        agree with flight, all, or those in `parameter`.
    parameter : dict
        Changes of parameters set by hand, in their units: ``{"Ixx": "+4%"}``.
    quantile : float
        Quantile q, 0 to 0.5; the bounds are the quantiles q and 1 - q of the ratio of the identified
        to the physics responses over the band, and of their phase difference divided by frequency.
    gain_bounds : (float, float) or "auto"
        Least and greatest gain of a channel.
    delay_bound : float or "auto"
        Greatest delay of a channel [s].
    agreement : float
        Largest mismatch [dB] at which held gains that form a loop of responses still count as
        consistent.
    cost_average : {"median", "mean"}
        Average of squared errors over frequency.
    gain_objective : {"ratio", "dB"}
        Errors that the gains minimise: of the gain ratios, or in dB.
    gain_from : {"representatives", "mean"}
        Models from which G is computed: the two representatives, or the mean over all pairs of kept
        models.
    level : float
        Confidence level of error bars, 0.5 to 0.999.
    pooling : float
        Degrees of freedom that a condition borrows from the others.
    coherence : float, "on" or "off"
        Minimum coherence of measured responses that is used.
    averages, averaging_window
        Number of averages and window length [s] for measured responses whose files do not state
        them.
    half_overlap : bool
        Whether the windows of measured responses overlap by half.
    degree : {0, 1, 2, 3, "table"}
        Degree of the schedule in airspeed, or a lookup table.
    schedule_of : {"ln-k", "k"}
        Quantity regressed on airspeed: the logarithm of the gains, or the gains.
    schedule_delays : {"automatic", "always", "never"}
        Whether delays are scheduled.
    tau_degree : {0, 1, 2, 3}
        Degree in airspeed of the signed delays, if the phase is corrected by leads.
    airspeed_tolerance : float
        Airspeeds closer than this [kt] count as equal.
    second_variable : {"none", "altitude", "mass"}
        Second variable of the schedule.
    hold_out : sequence of int
        Conditions left out of the schedule and used to judge it.
    sign : dict
        Channels whose sign is reversed: ``{"NZ": -1}`` (in the identified models), ``{"NZ":
        "-1:physics"}``, ``{"NZ": "-1:all"}``; 1 restores the sign.
    attitude_command : sequence of str
        Outputs whose attitude the stick commands.
    levels
        Level boundaries for the requirements: files, or names such as "ads-33e-prf-yaw-tracking".
    tolerances
        File of the tolerances of time histories.
    progress : callable
        Called with the completed share (0 to 1) of the present step and its name, in the calling
        thread. An exception stops the work and is raised; so does Ctrl+C.

    Raises
    ------
    Error
        A keyword is wrong (`fields["option"]`), or no condition has a result ("no-result").
    """
    words = settings(
        {
            "phase": phase,
            "band": band,
            "points": points,
            "alpha": alpha,
            "alpha_delay": alpha_delay,
            "delay_from": delay_from,
            "lead_order": lead_order,
            "lead_n": lead_n,
            "lead_r_max": lead_r_max,
            "couplings": couplings,
            "physics": physics,
            "quantile": quantile,
            "gain_bounds": gain_bounds,
            "delay_bound": delay_bound,
            "agreement": agreement,
            "cost_average": cost_average,
            "gain_objective": gain_objective,
            "gain_from": gain_from,
            "level": level,
            "pooling": pooling,
            "coherence": coherence,
            "averages": averages,
            "averaging_window": averaging_window,
            "half_overlap": half_overlap,
            "degree": degree,
            "schedule_of": schedule_of,
            "schedule_delays": schedule_delays,
            "tau_degree": tau_degree,
            "airspeed_tolerance": airspeed_tolerance,
            "second_variable": second_variable,
        }
    )
    words += _rejections(reject)
    words += [] if on is None else [f"--on={pairs(on)}"]
    if hold_out is not None and len(hold_out) > 0:
        words.append("--hold-out=" + ",".join(str(int(condition)) for condition in hold_out))
    words += assigned("sign", sign) + assigned("parameter", parameter)
    words += [] if not attitude_command else [f"--attitude-command={names(attitude_command)}"]
    words += repeated("levels", levels) + repeated("tolerances", tolerances)
    return Analysis(_gdcm.Analysis(data._data, words, progress))


def _rejections(
    reject: Union[str, Sequence[Union[str, Tuple[int, str]]], None],
) -> List[str]:
    if reject is None:
        return []
    words = []
    for rejection in [reject] if isinstance(reject, str) else reject:
        if rejection == "suggested":
            words.append("--reject-suggested")
        elif isinstance(rejection, str):
            words.append(f"--reject={rejection}")
        else:
            condition, model = rejection
            words.append(f"--reject={int(condition)}:{model}")
    return words


def _scheduled(correction: str) -> bool:
    if correction not in ("own", "scheduled"):
        raise ValueError(f'correction: expected "own" or "scheduled", found {correction!r}')
    return correction == "scheduled"


def _pair(row: Mapping[str, Any]) -> Tuple[str, str]:
    return (row["output"], row["input"])


def _channel_table(values: Mapping[str, Mapping[str, Any]]) -> ChannelTable[Any]:
    return ChannelTable(values["inputs"], values["outputs"])


def _intervals(values: Mapping[str, Mapping[str, Any]]) -> ChannelTable[Tuple[float, float]]:
    halves = []
    for side in ("inputs", "outputs"):
        bars = values[side].items()
        halves.append(
            {name: tuple(bar["interval"]) for name, bar in bars if bar and bar.get("interval")}
        )
    return ChannelTable(*halves)
