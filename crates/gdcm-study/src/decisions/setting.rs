//! Table of the settings, with name, key in files, command-line option, allowed values and window
//! control. It is used by undo, comparison of decisions, refusals, the report, the command line and
//! the window.

use gdcm_method::correction::delta::GainSource;
use gdcm_method::correction::{GainBounds, GainObjective};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::{DelayScheduling, ScheduleKind, ScheduledQuantity, SecondVariable};
use gdcm_model::dataset::band::{GREATEST_OMEGA, LEAST_OMEGA};
use gdcm_model::dataset::{Band, limits};
use gdcm_model::response::LeadOrder;

use super::edit_refusal::EditRefusal;
use super::setting_row::{Choice, Control, Digits, Kind, Place, Setting, Unit};
use super::settings::{
    CouplingCorrection, DEFAULT_COHERENCE, DelayFrom, PhaseCorrection, Settings,
};
use super::study::Study;

/// Returns a row with name, key, option, help and kind, and defaults for the rest.
const fn row([name, key, option]: [&'static str; 3], help: &'static str, kind: Kind) -> Setting {
    let control = Control {
        place: Place::Elsewhere,
        caption: "",
        label: name,
        step: 0.01,
        digits: Digits::Significant,
        applies: |_| true,
    };
    Setting {
        name,
        key,
        option,
        bare: None,
        help,
        unit: Unit {
            file: "",
            shown: "",
            scale: 1.0,
        },
        kind,
        control,
    }
}

impl Setting {
    const fn unit(self, file: &'static str, shown: &'static str, scale: f64) -> Self {
        Self {
            unit: Unit { file, shown, scale },
            ..self
        }
    }

    /// Sets the value of the option when it is given without an argument.
    const fn bare(self, word: &'static str) -> Self {
        Self {
            bare: Some(word),
            ..self
        }
    }

    /// Sets the place, caption and accessible name of the control.
    const fn at(self, place: Place, caption: &'static str, label: &'static str) -> Self {
        Self {
            control: Control {
                place,
                caption,
                label,
                ..self.control
            },
            ..self
        }
    }

    /// Sets the step for dragging, and the decimals, of the control.
    const fn digits(self, step: f64, digits: Digits) -> Self {
        Self {
            control: Control {
                step,
                digits,
                ..self.control
            },
            ..self
        }
    }

    const fn where_it(self, applies: fn(&Study) -> bool) -> Self {
        Self {
            control: Control {
                applies,
                ..self.control
            },
            ..self
        }
    }
}

const fn real(range: [f64; 2], get: fn(&Settings) -> f64, set: fn(&mut Settings, f64)) -> Kind {
    Kind::Number {
        range,
        whole: false,
        get,
        set,
    }
}

const fn whole(range: [f64; 2], get: fn(&Settings) -> f64, set: fn(&mut Settings, f64)) -> Kind {
    Kind::Number {
        range,
        whole: true,
        get,
        set,
    }
}

const fn choice(
    words: &'static [[&'static str; 3]],
    get: fn(&Settings) -> usize,
    set: fn(&mut Settings, usize),
) -> Kind {
    Kind::Choice { words, get, set }
}

/// Regularisation weight for the output gains, eq. (7); beyond its range the optimum is constant.
pub static ALPHA_GAIN: Setting = row(
    ["α of the gains", "alpha_gain", "--alpha"],
    "Weight that keeps the output gains, eq. (7), near 1; 0 is the limit α → 0",
    real(
        [0.0, 1e6],
        |of| of.alpha_gain,
        |of, alpha| of.alpha_gain = alpha,
    ),
)
.at(Place::Slider, "α gains", "α gains");

/// Regularisation weight for the output delays, eq. (11), or for all signed delays (M15.4).
pub static ALPHA_DELAY: Setting = row(
    ["α of the delays", "alpha_delay", "--alpha-delay"],
    "Weight that keeps the output delays, eq. (11), or all signed delays (M15) near 0; 0 is the limit α → 0",
    real([0.0, 1e6], |of| of.alpha_delay, |of, alpha| of.alpha_delay = alpha),
)
.at(Place::Slider, "α delays", "α delays");

/// Phase correction: none, by delays, or by signed delays that lead filters realise where negative.
pub static PHASE: Setting = row(
    ["phase correction", "phase", "--phase"],
    "How the phase is corrected: not at all, by delays, or by a delay or lead filter for each \
    channel",
    choice(
        &[
            ["none", "none", "Gains only"],
            [
                "delay",
                "delay",
                "Each channel gets a delay, eq. (11) (the paper)",
            ],
            [
                "lead",
                "delay or lead",
                "Each channel gets one signed delay; a negative delay becomes a lead filter, \
                which acts like a faster servo (M15)",
            ],
        ],
        |of| of.phase.index(),
        |of, index| of.phase = PhaseCorrection::ALL[index],
    ),
)
.at(Place::Top, "Phase", "Phase correction");

/// Source of the D to which the delays are fitted: median of phase over frequency, or line over the
/// band (M15.2).
pub static DELAY_FROM: Setting = row(
    ["delay estimate", "delay_from", "--delay-from"],
    "Definition of the D to which delays are fitted: median of phase over frequency, or straight \
    line over the band",
    choice(
        &[
            [
                "median",
                "median",
                "Median of Δφ/ω over the band, eq. (9) (the paper)",
            ],
            [
                "band",
                "line over the band",
                "Least-squares line through Δφ over the band (M15.2)",
            ],
        ],
        |of| of.delay_from.index(),
        |of, index| of.delay_from = DelayFrom::ALL[index],
    ),
)
.at(Place::Beside, "Delay estimate", "Delay estimate")
.where_it(|study| study.settings.phase == PhaseCorrection::Delay);

/// Order of the lead filters: 2 leaves the gain within the band nearly unchanged, 1 raises it
/// (M15.3).
pub static LEAD_ORDER: Setting = row(
    ["order of the lead filters", "lead.order", "--lead-order"],
    "Order of every lead filter (M15.3)",
    choice(
        &[
            [
                "2",
                "2",
                "Butterworth damping: leaves the gain within the band nearly unchanged",
            ],
            [
                "1",
                "1",
                "(1 + as)/(1 + bs): the gain rises within the band",
            ],
        ],
        |of| of.lead.order.index(),
        |of, index| of.lead.order = LeadOrder::ALL[index],
    ),
)
.at(Place::Line, "Lead: order", "Order of the lead filters")
.where_it(has_leads);

fn has_leads(study: &Study) -> bool {
    study.settings.phase == PhaseCorrection::Lead
}

/// Parameter `n` of the lead filters: their lag time constant is `1 / (n omega_B)` (M15.3).
pub static LEAD_POLE: Setting = row(
    ["n of the lead filters", "lead.n", "--lead-n"],
    "Parameter of the lag of every lead filter, 1/(n ω_B), where ω_B is the top of the band; a \
    smaller n gives less noise and permits more lead",
    real(
        [2.0, 10.0],
        |of| of.lead.pole,
        |of, pole| of.lead.pole = pole,
    ),
)
.at(Place::Beside, "n", "n of the lead filters")
.digits(0.05, Digits::Significant)
.where_it(has_leads);

/// Maximum gain of a lead filter at high frequency, as a factor; its range is 0 to 40 dB.
pub static LEAD_LIMIT: Setting = row(
    ["R_max of the lead filters", "lead.r_max", "--lead-r-max"],
    "Maximum gain of a channel's lead filter far above the band (10 is 20 dB); it limits the lead \
    of the channel",
    real(
        [1.0, 100.0],
        |of| of.lead.limit,
        |of, limit| of.lead.limit = limit,
    ),
)
.at(Place::Beside, "R_max", "R_max of the lead filters")
.digits(0.1, Digits::Significant)
.where_it(has_leads);

/// Correction of couplings and modes: none, mixing, or mixing and feedback (M16).
pub static COUPLINGS: Setting = row(
    ["couplings", "couplings", "--couplings"],
    "Correction of couplings and modes, common to all conditions and applied before the channel \
    correction: none, a mixing of the inputs, or a mixing and a feedback of outputs to inputs \
    (M16)",
    choice(
        &[
            [
                "none",
                "none",
                "Only gains, delays and leads of the channels (the paper)",
            ],
            [
                "mixing",
                "mixing",
                "Each input receives constant shares of the other inputs (M16)",
            ],
            [
                "feedback",
                "mixing and feedback",
                "Each input receives constant shares of the other inputs and of the outputs, \
                which also moves the modes (M16)",
            ],
        ],
        |of| of.couplings.index(),
        |of, index| of.couplings = CouplingCorrection::ALL[index],
    ),
)
.at(Place::Top, "Couplings", "Couplings");

/// Comparison band \[rad/s\].
pub static BAND: Setting = row(
    ["frequency band", "band_rad_s", "--band"],
    "Comparison band [rad/s]; in the window, its limits can also be dragged in the plot",
    Kind::Range {
        range: [LEAST_OMEGA, GREATEST_OMEGA],
        nothing: None,
        ends: ["Band from", "Band to"],
        get: |of| Some([of.band.min(), of.band.max()]),
        set: |of, ends| {
            let [min, max] = ends.unwrap_or([of.band.min(), of.band.max()]);
            of.band = Band::new(min, max)?;
            Ok(())
        },
    },
)
.unit("rad/s", "rad/s", 1.0)
.at(Place::Line, "Band", "Band");

/// Number of logarithmically spaced frequencies in the band.
pub static POINTS: Setting = row(
    ["number of frequencies", "points", "--points"],
    "Number of logarithmically spaced frequencies in the band",
    whole(
        [2.0, 5000.0],
        |of| of.points as f64,
        |of, points| of.points = points as usize,
    ),
)
.at(Place::Line, "Points", "Frequencies in the band")
.digits(1.0, Digits::Decimals(0));

/// Quantile from which the bounds are computed, at most the median.
pub static QUANTILE: Setting = row(
    ["bound quantile", "quantile", "--quantile"],
    "Bounds are this quantile, and its complement, of |H_ref|/|H_sim| and of Δφ/ω",
    real(
        [0.0, 0.5],
        |of| of.quantile,
        |of, quantile| of.quantile = quantile,
    ),
)
.unit("", "%", 100.0)
.at(Place::Beside, "bound quantile", "Bound quantile")
.digits(0.1, Digits::Decimals(1));

/// Manual gain bounds, -120 to 120 dB; no value restores the quantiles.
pub static GAIN_BOUNDS: Setting = row(
    ["gain bounds", "gain_bounds", "--gain-bounds"],
    "Minimum and maximum gain of every channel, common to all conditions; auto: from the \
    quantiles of each condition",
    Kind::Range {
        range: [1e-6, 1e6],
        nothing: Some(["auto", "by the quantile"]),
        ends: ["Lower gain bound", "Upper gain bound"],
        get: |of| of.gain_bounds.map(|bounds| [bounds.lower, bounds.upper]),
        set: |of, ends| {
            of.gain_bounds = ends.map(|[lower, upper]| GainBounds { lower, upper });
            Ok(())
        },
    },
)
.at(Place::Line, "Gain bounds", "Gain bounds")
.digits(0.002, Digits::Gain);

/// Manual upper delay bound \[s\]; no value restores the quantile.
pub static DELAY_UPPER: Setting = row(
    ["upper delay bound", "delay_upper_s", "--delay-bound"],
    "Maximum delay of every channel, common to all conditions; auto: from the quantiles of each \
    condition",
    Kind::Optional {
        range: [0.0, 1e3],
        nothing: ["auto", "by the quantile"],
        on: None,
        get: |of| of.delay_upper_s,
        set: |of, upper_s| of.delay_upper_s = upper_s,
    },
)
.unit("seconds", "ms", 1e3)
.at(Place::Line, "Delay bound", "Upper delay bound")
.digits(0.2, Digits::Decimals(1));

/// Maximum mismatch around a loop \[dB\] up to which constrained gains count as consistent.
pub static AGREEMENT: Setting = row(
    ["loop tolerance", "agreement_db", "--agreement"],
    "Maximum mismatch around a loop of held gains up to which they count as consistent",
    real(
        [0.0, 3.0],
        |of| of.agreement_db,
        |of, tolerance| of.agreement_db = tolerance,
    ),
)
.unit("dB", "dB", 1.0)
.at(Place::Line, "Loop tolerance", "Loop tolerance");

/// Average over frequency in J: median or mean.
pub static COST_AVERAGE: Setting = row(
    ["average in J", "cost_average", "--cost-average"],
    "How squared errors are averaged over frequency in J",
    choice(
        &[
            [
                "median",
                "J median",
                "J uses the median over frequency (the paper)",
            ],
            [
                "mean",
                "J mean",
                "J uses the mean over frequency (Tischler)",
            ],
        ],
        |of| of.cost_average.index(),
        |of, index| of.cost_average = CostAverage::ALL[index],
    ),
)
.at(Place::Line, "Method", "Average in J");

/// Gain objective: squared errors of the ratios, eq. (7), or squared errors in dB.
pub static GAIN_OBJECTIVE: Setting = row(
    [
        "objective of the gains",
        "gain_objective",
        "--gain-objective",
    ],
    "Objective that the gains minimise",
    choice(
        &[
            [
                "ratio",
                "ratio",
                "Gains minimise squared errors of the ratios, eq. (7)",
            ],
            [
                "dB",
                "dB",
                "Gains minimise squared errors in dB: a factor and its inverse count alike",
            ],
        ],
        |of| of.gain_objective.index(),
        |of, index| of.gain_objective = GainObjective::ALL[index],
    ),
)
.at(Place::Beside, "", "Objective of the gains");

/// Models from which G is computed: the two representatives, or all pairs of kept models.
pub static GAIN_SOURCE: Setting = row(
    ["source of G", "gain_from", "--gain-from"],
    "Source of G: the two representatives, or the mean over all pairs of kept models",
    choice(
        &[
            [
                "representatives",
                "representatives",
                "G of the two representatives (the paper)",
            ],
            [
                "mean",
                "mean of pairs",
                "G is the mean of ln G over all pairs of kept models",
            ],
        ],
        |of| of.gain_source.index(),
        |of, index| of.gain_source = GainSource::ALL[index],
    ),
)
.at(Place::Line, "G from", "Source of G");

/// Confidence level of all error bars, intervals and tests.
pub static LEVEL: Setting = row(
    ["confidence level", "error_bars.level", "--level"],
    "Level of every error bar, interval and test",
    real(
        [0.5, 0.999],
        |of| of.uncertainty.level,
        |of, level| of.uncertainty.level = level,
    ),
)
.unit("", "%", 100.0)
.at(Place::Line, "Confidence level", "Confidence level")
.digits(0.5, Digits::Decimals(1));

/// Maximum degrees of freedom that the identification part of a condition's error bar borrows from
/// the other conditions.
pub static POOLING: Setting = row(
    [
        "pooling (degrees of freedom borrowed)",
        "error_bars.prior_degrees",
        "--pooling",
    ],
    "Maximum degrees of freedom that the identification part of a condition's error bar borrows \
    from the other conditions; 0 uses the condition's own data only",
    real(
        [0.0, 100.0],
        |of| of.uncertainty.prior_degrees,
        |of, degrees| of.uncertainty.prior_degrees = degrees,
    ),
)
.at(
    Place::Beside,
    "pooling",
    "Pooling (degrees of freedom borrowed)",
)
.digits(0.1, Digits::Significant);

/// Minimum coherence of the frequencies that count in J, G and D.
pub static COHERENCE: Setting = row(
    ["coherence threshold", "coherence_threshold", "--coherence"],
    "Minimum coherence γ² of the frequencies of measured responses that count: off, on (0.6), or \
    a value; off: every frequency counts alike",
    Kind::Optional {
        range: [0.0, 1.0],
        nothing: ["off", "not used"],
        on: Some(DEFAULT_COHERENCE),
        get: |of| of.coherence_threshold,
        set: |of, least| of.coherence_threshold = least,
    },
)
.at(Place::Line, "Coherence", "Least coherence")
.where_it(|study| study.settings.coherence_threshold.is_some() || study.dataset.has_coherence());

/// Number of averages assumed for measured responses that do not state it.
pub static AVERAGES: Setting = row(
    [
        "averages of measured responses",
        "error_bars.averages",
        "--averages",
    ],
    "Number of independent averages of measured responses whose files do not state it",
    Kind::Optional {
        range: limits::AVERAGES,
        nothing: ["auto", "as stated in the files"],
        on: None,
        get: |of| of.uncertainty.averages,
        set: |of, averages| of.uncertainty.averages = averages,
    },
);

/// Window length assumed for measured responses that do not state it \[s\].
pub static WINDOW: Setting = row(
    [
        "windows of measured responses",
        "error_bars.window_s",
        "--averaging-window",
    ],
    "Length of the windows of measured responses whose files do not state it",
    Kind::Optional {
        range: limits::WINDOW_S,
        nothing: ["auto", "as stated in the files"],
        on: None,
        get: |of| of.uncertainty.window_s,
        set: |of, window_s| of.uncertainty.window_s = window_s,
    },
)
.unit("seconds", "s", 1.0);

/// Whether windows are assumed to overlap by half for measured responses that do not state it.
pub static HALF_OVERLAP: Setting = row(
    [
        "windows overlap",
        "error_bars.half_overlap",
        "--half-overlap",
    ],
    "Assumes that the windows of measured responses overlap by half, if their files do not state \
    it",
    Kind::Flag {
        words: ["not", "by half"],
        get: |of| of.uncertainty.half_overlap,
        set: |of, overlap| of.uncertainty.half_overlap = overlap,
    },
);

/// Form of the schedule in airspeed: a polynomial of degree 0 to 3, or a lookup table.
pub static SCHEDULE: Setting = row(
    ["schedule", "schedule.kind", "--degree"],
    "Degree of the schedule's polynomial in airspeed, 0 to 3, or a lookup table",
    choice(
        &[
            ["0", "constant", "Polynomial of degree 0 in airspeed"],
            ["1", "degree 1", "Polynomial of degree 1 in airspeed"],
            ["2", "degree 2", "Polynomial of degree 2 in airspeed"],
            ["3", "degree 3", "Polynomial of degree 3 in airspeed"],
            [
                "table",
                "table",
                "Mean of each cluster of airspeeds, with linear interpolation between them",
            ],
        ],
        |of| of.schedule.kind.index(),
        |of, index| of.schedule.kind = ScheduleKind::ALL[index],
    ),
)
.at(Place::Top, "Schedule", "Schedule");

/// Scheduled quantity: `ln k`, or the gain itself.
pub static SCHEDULED_QUANTITY: Setting = row(
    ["scheduled quantity", "schedule.of", "--schedule-of"],
    "Quantity regressed on airspeed: ln k, or the gain k itself",
    choice(
        &[
            [
                "ln-k",
                "of ln k",
                "Regresses ln k: the product of two scheduled gains is the schedule of their \
                product",
            ],
            ["k", "of k", "Regresses the gain k itself"],
        ],
        |of| of.schedule.quantity.index(),
        |of, index| of.schedule.quantity = ScheduledQuantity::ALL[index],
    ),
)
.at(Place::Beside, "", "Scheduled quantity");

/// Whether the schedule has delays too: never, always, or automatically (M11).
pub static SCHEDULE_DELAYS: Setting = row(
    ["delays over airspeed", "schedule_delays", "--schedule-delays"],
    "Schedule the delays of the channels too, clamped to their bounds (M11); without a value: always",
    choice(
        &[
            [
                "automatic",
                "delays automatic",
                "Delays are scheduled with the gains if a held response has a net delay above 0.5 \
                ms in a scheduled condition",
            ],
            ["always", "delays too", "Delays are scheduled with the gains"],
            ["never", "no delays", "Gains only (the paper)"],
        ],
        |of| of.schedule_delays.index(),
        |of, index| of.set_delay_scheduling(DelayScheduling::ALL[index]),
    ),
)
.bare("always")
.at(Place::Line, "Over airspeed", "Schedule of delays")
.where_it(|study| !has_leads(study));

/// Degree of the polynomials for the signed delays.
pub static TAU_DEGREE: Setting = row(
    [
        "degree of the signed delays",
        "schedule.tau_degree",
        "--tau-degree",
    ],
    "Degree of the polynomial of signed delays in airspeed; 0 assumes that lags of servos and \
    sensors do not depend on airspeed (M15.5)",
    choice(
        &[
            [
                "0",
                "τ constant",
                "One signed delay for all airspeeds: lags of servos and sensors do not depend on \
                airspeed (M15.5)",
            ],
            ["1", "τ degree 1", "Polynomial of degree 1 in airspeed"],
            ["2", "τ degree 2", "Polynomial of degree 2 in airspeed"],
            ["3", "τ degree 3", "Polynomial of degree 3 in airspeed"],
        ],
        |of| of.schedule.tau_degree,
        |of, degree| of.schedule.tau_degree = degree,
    ),
)
.at(
    Place::Line,
    "Over airspeed",
    "Schedule of the signed delays",
)
.where_it(has_leads);

/// Maximum difference between consecutive airspeeds that count as equal \[kt\].
pub static AIRSPEED_TOLERANCE: Setting = row(
    [
        "airspeed tolerance",
        "schedule.airspeed_tolerance_kt",
        "--airspeed-tolerance",
    ],
    "Maximum difference between consecutive airspeeds that count as one, for the lookup \
    table and for the permitted degree",
    real(
        [0.0, 100.0],
        |of| of.schedule.airspeed_tolerance_kt,
        |of, tolerance_kt| of.schedule.airspeed_tolerance_kt = tolerance_kt,
    ),
)
.unit("kt", "kt", 1.0)
.at(Place::Line, "One airspeed", "Airspeed tolerance")
.digits(0.1, Digits::Decimals(1));

/// Scheduling variable besides airspeed: none, altitude or mass.
pub static SECOND_VARIABLE: Setting = row(
    [
        "second variable",
        "schedule.second_variable",
        "--second-variable",
    ],
    "Schedule gains with a second variable in addition to airspeed",
    choice(
        &[
            ["none", "airspeed only", "Airspeed only, as in the paper"],
            [
                "altitude",
                "and altitude",
                "Recommended only if the Evidence view shows that it is needed",
            ],
            [
                "mass",
                "and mass",
                "Recommended only if the Evidence view shows that it is needed",
            ],
        ],
        |of| of.schedule.second.index(),
        |of, index| of.schedule.second = <Option<SecondVariable>>::ALL[index],
    ),
)
.at(
    Place::Line,
    "Scheduled over",
    "Second variable of the schedule",
);

/// Every setting except the constrained and ignored responses, in display order.
pub static SETTINGS: [&Setting; 29] = [
    &ALPHA_GAIN,
    &ALPHA_DELAY,
    &PHASE,
    &DELAY_FROM,
    &LEAD_ORDER,
    &LEAD_POLE,
    &LEAD_LIMIT,
    &COUPLINGS,
    &BAND,
    &POINTS,
    &QUANTILE,
    &GAIN_BOUNDS,
    &DELAY_UPPER,
    &AGREEMENT,
    &COST_AVERAGE,
    &GAIN_OBJECTIVE,
    &GAIN_SOURCE,
    &LEVEL,
    &POOLING,
    &COHERENCE,
    &SCHEDULE,
    &SCHEDULED_QUANTITY,
    &SECOND_VARIABLE,
    &AIRSPEED_TOLERANCE,
    &SCHEDULE_DELAYS,
    &TAU_DEGREE,
    &AVERAGES,
    &WINDOW,
    &HALF_OVERLAP,
];

impl Settings {
    /// Checks every value against the range of its setting.
    ///
    /// # Errors
    /// The first setting with an invalid value, and why the value is refused.
    pub fn check(&self) -> Result<(), (&'static Setting, EditRefusal)> {
        for setting in SETTINGS {
            setting
                .check(setting.value(self))
                .map_err(|refusal| (setting, refusal))?;
        }
        Ok(())
    }
}
