//! Settings table: name, key in files, command-line option, allowed values and place of the window
//! control. Undo, decision comparison, refusals, the report, the command line and the window use
//! it. The table contains the words for values ("delays too"), the crate `gdcm-words` the controls'
//! captions and help texts. `setting.rs` explains two rows and every field:
//!
//! ```text
//! bare              argument that the option has if none is given
//! Words::new(a, b)  word on the command line, word in a sentence and in the window
//! nothing, on       the words for no value; the number that the argument "on" sets
//! place             Slider, Top: above the settings table of the window;  Line: in it
//!                   Beside: on the previous setting's line;  Elsewhere: outside the panel
//! ```
//!
//! A value outside its range is refused (`docs/limits.md`); a range is not a recommendation. The
//! step of a control is the change in the displayed value for each point dragged.

use gdcm_method::correction::delta::GainSource;
use gdcm_method::correction::{GainBounds, GainObjective};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::{DelayScheduling, ScheduleKind, ScheduledQuantity, SecondVariable};
use gdcm_model::dataset::limits;
use gdcm_model::response::LeadOrder;

use super::edit_refusal::EditRefusal;
use super::physics_settings::PhysicsCorrection;
use super::setting::{Control, Digits, Kind, Place, Setting, Unit, Words};
use super::setting_value::Choice;
use super::settings::{
    CouplingCorrection, DEFAULT_COHERENCE, DelayFrom, PhaseCorrection, Settings,
};
use super::study::Study;

/// Control outside the settings panel, always applicable.
const DEFAULT_CONTROL: Control = Control {
    place: Place::Elsewhere,
    step: 0.01,
    digits: Digits::Significant,
    applies: |_| true,
};

/// Fields that most settings share; every setting has its own name, key, option and kind.
const DEFAULT: Setting = Setting {
    name: "",
    key: "",
    option: "",
    bare: None,
    unit: Unit {
        file: "",
        shown: "",
        scale: 1.0,
    },
    kind: Kind::Flag {
        no: "",
        yes: "",
        get: |_| false,
        set: |_, _| {},
    },
    control: DEFAULT_CONTROL,
};

/// Regularisation weight for the output gains, eq. (7); beyond its range the optimum is constant.
pub static ALPHA_GAIN: Setting = Setting {
    name: "α of the gains",
    key: "alpha_gain",
    option: "--alpha",
    kind: Kind::Number {
        range: [0.0, 1e6],
        whole: false,
        get: |settings| settings.alpha_gain,
        set: |settings, alpha| settings.alpha_gain = alpha,
    },
    control: Control {
        place: Place::Slider,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Regularisation weight for the output delays, eq. (11), or for all signed delays (M15.4).
pub static ALPHA_DELAY: Setting = Setting {
    name: "α of the delays",
    key: "alpha_delay",
    option: "--alpha-delay",
    kind: Kind::Number {
        range: [0.0, 1e6],
        whole: false,
        get: |settings| settings.alpha_delay,
        set: |settings, alpha| settings.alpha_delay = alpha,
    },
    control: Control {
        place: Place::Slider,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Phase correction: none, by delays, or by signed delays that lead filters realise where negative.
pub static PHASE: Setting = Setting {
    name: "phase correction",
    key: "phase",
    option: "--phase",
    kind: Kind::Choice {
        words: &[
            Words::new("none", "none"),
            Words::new("delay", "delay"),
            Words::new("lead", "delay or lead"),
        ],
        get: |settings| settings.phase.index(),
        set: |settings, index| settings.phase = PhaseCorrection::ALL[index],
    },
    control: Control {
        place: Place::Top,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Definition of the D to which the delays are fitted: median of `Delta phi / omega`, or slope of a
/// line through `Delta phi` over the band (M15.2).
pub static DELAY_FROM: Setting = Setting {
    name: "delay estimate",
    key: "delay_from",
    option: "--delay-from",
    kind: Kind::Choice {
        words: &[
            Words::new("median", "median"),
            Words::new("band", "line over the band"),
        ],
        get: |settings| settings.delay_from.index(),
        set: |settings, index| settings.delay_from = DelayFrom::ALL[index],
    },
    control: Control {
        place: Place::Line,
        applies: |study| study.settings.phase == PhaseCorrection::Delay,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Lead filter order: 2 leaves the gain within the band nearly unchanged, 1 raises it (M15.3).
pub static LEAD_ORDER: Setting = Setting {
    name: "order of the lead filters",
    key: "lead.order",
    option: "--lead-order",
    kind: Kind::Choice {
        words: &[Words::new("2", "2"), Words::new("1", "1")],
        get: |settings| settings.lead.order.index(),
        set: |settings, index| settings.lead.order = LeadOrder::ALL[index],
    },
    control: Control {
        place: Place::Line,
        applies: has_leads,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

fn has_leads(study: &Study) -> bool {
    study.settings.phase == PhaseCorrection::Lead
}

/// Lead filter parameter `n`: the lag time constant is `1 / (n omega_B)`, where `omega_B` is the
/// band's upper end (M15.3).
pub static LEAD_POLE: Setting = Setting {
    name: "n of the lead filters",
    key: "lead.n",
    option: "--lead-n",
    kind: Kind::Number {
        range: [2.0, 10.0],
        whole: false,
        get: |settings| settings.lead.pole,
        set: |settings, pole| settings.lead.pole = pole,
    },
    control: Control {
        place: Place::Beside,
        step: 0.05,
        digits: Digits::Significant,
        applies: has_leads,
    },
    ..DEFAULT
};

/// Maximum lead filter gain at high frequency, as a factor; its range is 0 to 40 dB.
pub static LEAD_LIMIT: Setting = Setting {
    name: "R_max of the lead filters",
    key: "lead.r_max",
    option: "--lead-r-max",
    kind: Kind::Number {
        range: [1.0, 100.0],
        whole: false,
        get: |settings| settings.lead.limit,
        set: |settings, limit| settings.lead.limit = limit,
    },
    control: Control {
        place: Place::Beside,
        step: 0.1,
        digits: Digits::Significant,
        applies: has_leads,
    },
    ..DEFAULT
};

/// Correction for couplings and modes: none, mixing, or mixing and feedback (M16).
pub static COUPLINGS: Setting = Setting {
    name: "couplings",
    key: "couplings",
    option: "--couplings",
    kind: Kind::Choice {
        words: &[
            Words::new("none", "none"),
            Words::new("mixing", "mixing"),
            Words::new("feedback", "mixing and feedback"),
        ],
        get: |settings| settings.couplings.index(),
        set: |settings, index| settings.couplings = CouplingCorrection::ALL[index],
    },
    control: Control {
        place: Place::Top,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Physics parameters that move the physics models: none, those that the diagnosis names, all, or
/// values set by hand (M18.5).
pub static PHYSICS: Setting = Setting {
    name: "physics parameters",
    key: "physics",
    option: "--physics",
    kind: Kind::Choice {
        words: &[
            Words::new("off", "off"),
            Words::new("named", "the named ones"),
            Words::new("all", "all"),
            Words::new("by-hand", "set by hand"),
        ],
        get: |settings| settings.physics.index(),
        set: |settings, index| settings.physics = PhysicsCorrection::ALL[index],
    },
    control: Control {
        place: Place::Top,
        applies: has_runs,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

fn has_runs(study: &Study) -> bool {
    let conditions = study.dataset.conditions();
    conditions
        .iter()
        .any(|condition| !condition.moved_models().is_empty())
}

/// Comparison band \[rad/s\].
pub static BAND: Setting = Setting {
    name: "frequency band",
    key: "band_rad_s",
    option: "--band",
    unit: Unit {
        file: "rad/s",
        shown: "rad/s",
        scale: 1.0,
    },
    kind: Kind::Band {
        get: |settings| settings.band,
        set: |settings, band| settings.band = band,
    },
    control: Control {
        place: Place::Line,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Number of logarithmically spaced frequencies in the band.
pub static POINTS: Setting = Setting {
    name: "number of frequencies",
    key: "points",
    option: "--points",
    kind: Kind::Number {
        range: [2.0, 5000.0],
        whole: true,
        get: |settings| settings.points as f64,
        set: |settings, points| settings.points = points as usize,
    },
    control: Control {
        place: Place::Line,
        step: 1.0,
        digits: Digits::Decimals(0),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Quantile from which the bounds are computed, at most the median.
pub static QUANTILE: Setting = Setting {
    name: "bound quantile",
    key: "quantile",
    option: "--quantile",
    unit: Unit {
        file: "",
        shown: "%",
        scale: 100.0,
    },
    kind: Kind::Number {
        range: [0.0, 0.5],
        whole: false,
        get: |settings| settings.quantile,
        set: |settings, quantile| settings.quantile = quantile,
    },
    control: Control {
        place: Place::Beside,
        step: 0.1,
        digits: Digits::Decimals(1),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Gain bounds set by hand, -120 to 120 dB; without them, they are computed from [`QUANTILE`].
pub static GAIN_BOUNDS: Setting = Setting {
    name: "gain bounds",
    key: "gain_bounds",
    option: "--gain-bounds",
    kind: Kind::Range {
        range: [1e-6, 1e6],
        nothing: Words::new("auto", "by the quantile"),
        get: |settings| {
            settings
                .gain_bounds
                .map(|bounds| [bounds.lower, bounds.upper])
        },
        set: |settings, ends| {
            settings.gain_bounds = ends.map(|[lower, upper]| GainBounds { lower, upper });
        },
    },
    control: Control {
        place: Place::Line,
        step: 0.002,
        digits: Digits::Gain,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Upper delay bound \[s\] set by hand; without it, the bound is computed from [`QUANTILE`].
pub static DELAY_UPPER: Setting = Setting {
    name: "upper delay bound",
    key: "delay_upper_s",
    option: "--delay-bound",
    unit: Unit {
        file: "seconds",
        shown: "ms",
        scale: 1e3,
    },
    kind: Kind::Optional {
        range: [0.0, 1e3],
        nothing: Words::new("auto", "by the quantile"),
        on: None,
        get: |settings| settings.delay_upper_s,
        set: |settings, upper_s| settings.delay_upper_s = upper_s,
    },
    control: Control {
        place: Place::Line,
        step: 0.2,
        digits: Digits::Decimals(1),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Maximum mismatch \[dB\] up to which constrained gains around a loop count as consistent (M8:
/// docs/method.md). A *loop* is a closed chain of responses; each shares a channel with the next.
pub static AGREEMENT: Setting = Setting {
    name: "loop tolerance",
    key: "agreement_db",
    option: "--agreement",
    unit: Unit {
        file: "dB",
        shown: "dB",
        scale: 1.0,
    },
    kind: Kind::Number {
        range: [0.0, 3.0],
        whole: false,
        get: |settings| settings.agreement_db,
        set: |settings, tolerance| settings.agreement_db = tolerance,
    },
    control: Control {
        place: Place::Line,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Average over frequency in J: median or mean.
pub static COST_AVERAGE: Setting = Setting {
    name: "average in J",
    key: "cost_average",
    option: "--cost-average",
    kind: Kind::Choice {
        words: &[
            Words::new("median", "J median"),
            Words::new("mean", "J mean"),
        ],
        get: |settings| settings.cost_average.index(),
        set: |settings, index| settings.cost_average = CostAverage::ALL[index],
    },
    control: Control {
        place: Place::Line,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Gain objective: squared errors of the ratios, eq. (7), or squared errors in dB.
pub static GAIN_OBJECTIVE: Setting = Setting {
    name: "objective of the gains",
    key: "gain_objective",
    option: "--gain-objective",
    kind: Kind::Choice {
        words: &[Words::new("ratio", "ratio"), Words::new("dB", "dB")],
        get: |settings| settings.gain_objective.index(),
        set: |settings, index| settings.gain_objective = GainObjective::ALL[index],
    },
    control: Control {
        place: Place::Beside,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Models from which G is computed: the two representatives, or all pairs of kept physics and
/// identified models.
pub static GAIN_SOURCE: Setting = Setting {
    name: "source of G",
    key: "gain_from",
    option: "--gain-from",
    kind: Kind::Choice {
        words: &[
            Words::new("representatives", "representatives"),
            Words::new("mean", "mean of pairs"),
        ],
        get: |settings| settings.gain_source.index(),
        set: |settings, index| settings.gain_source = GainSource::ALL[index],
    },
    control: Control {
        place: Place::Line,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Confidence level for all error bars, intervals and tests.
pub static LEVEL: Setting = Setting {
    name: "confidence level",
    key: "error_bars.level",
    option: "--level",
    unit: Unit {
        file: "",
        shown: "%",
        scale: 100.0,
    },
    kind: Kind::Number {
        range: [0.5, 0.999],
        whole: false,
        get: |settings| settings.uncertainty.level,
        set: |settings, level| settings.uncertainty.level = level,
    },
    control: Control {
        place: Place::Line,
        step: 0.5,
        digits: Digits::Decimals(1),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Maximum degrees of freedom that the identification part in a condition's error bar borrows from
/// the other conditions.
pub static POOLING: Setting = Setting {
    name: "pooling (degrees of freedom borrowed)",
    key: "error_bars.prior_degrees",
    option: "--pooling",
    kind: Kind::Number {
        range: [0.0, 100.0],
        whole: false,
        get: |settings| settings.uncertainty.prior_degrees,
        set: |settings, degrees| settings.uncertainty.prior_degrees = degrees,
    },
    control: Control {
        place: Place::Beside,
        step: 0.1,
        digits: Digits::Significant,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Minimum coherence at which a frequency counts in J, G and D.
pub static COHERENCE: Setting = Setting {
    name: "coherence threshold",
    key: "coherence_threshold",
    option: "--coherence",
    kind: Kind::Optional {
        range: [0.0, 1.0],
        nothing: Words::new("off", "not used"),
        on: Some(DEFAULT_COHERENCE),
        get: |settings| settings.coherence_threshold,
        set: |settings, least| settings.coherence_threshold = least,
    },
    control: Control {
        place: Place::Line,
        applies: |study| {
            study.settings.coherence_threshold.is_some() || study.dataset.has_coherence()
        },
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Number of averages assumed for measured responses that do not state it.
pub static AVERAGES: Setting = Setting {
    name: "averages of measured responses",
    key: "error_bars.averages",
    option: "--averages",
    kind: Kind::Optional {
        range: limits::AVERAGES,
        nothing: Words::new("auto", "as stated in the files"),
        on: None,
        get: |settings| settings.uncertainty.averages,
        set: |settings, averages| settings.uncertainty.averages = averages,
    },
    ..DEFAULT
};

/// Window length assumed for measured responses that do not state it \[s\].
pub static WINDOW: Setting = Setting {
    name: "windows of measured responses",
    key: "error_bars.window_s",
    option: "--averaging-window",
    unit: Unit {
        file: "seconds",
        shown: "s",
        scale: 1.0,
    },
    kind: Kind::Optional {
        range: limits::WINDOW_S,
        nothing: Words::new("auto", "as stated in the files"),
        on: None,
        get: |settings| settings.uncertainty.window_s,
        set: |settings, window_s| settings.uncertainty.window_s = window_s,
    },
    ..DEFAULT
};

/// Whether the windows of measured responses are taken to overlap by half.
pub static HALF_OVERLAP: Setting = Setting {
    name: "windows overlap",
    key: "error_bars.half_overlap",
    option: "--half-overlap",
    kind: Kind::Flag {
        no: "no",
        yes: "by half",
        get: |settings| settings.uncertainty.half_overlap,
        set: |settings, overlap| settings.uncertainty.half_overlap = overlap,
    },
    ..DEFAULT
};

/// The schedule's form in airspeed: a polynomial of degree 0 to 3, or a lookup table.
pub static SCHEDULE: Setting = Setting {
    name: "schedule",
    key: "schedule.kind",
    option: "--degree",
    kind: Kind::Choice {
        words: &[
            Words::new("0", "constant"),
            Words::new("1", "degree 1"),
            Words::new("2", "degree 2"),
            Words::new("3", "degree 3"),
            Words::new("table", "table"),
        ],
        get: |settings| settings.schedule.kind.index(),
        set: |settings, index| settings.schedule.kind = ScheduleKind::ALL[index],
    },
    control: Control {
        place: Place::Top,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Scheduled quantity: `ln k`, or the gain itself.
pub static SCHEDULED_QUANTITY: Setting = Setting {
    name: "scheduled quantity",
    key: "schedule.of",
    option: "--schedule-of",
    kind: Kind::Choice {
        words: &[Words::new("ln-k", "of ln k"), Words::new("k", "of k")],
        get: |settings| settings.schedule.quantity.index(),
        set: |settings, index| settings.schedule.quantity = ScheduledQuantity::ALL[index],
    },
    control: Control {
        place: Place::Beside,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Whether the schedule has delays too: never, always, or automatically (M11).
pub static SCHEDULE_DELAYS: Setting = Setting {
    name: "delays over airspeed",
    key: "schedule_delays",
    option: "--schedule-delays",
    bare: Some("always"),
    kind: Kind::Choice {
        words: &[
            Words::new("automatic", "delays automatic"),
            Words::new("always", "delays too"),
            Words::new("never", "no delays"),
        ],
        get: |settings| settings.schedule_delays.index(),
        // Also sets the flag for earlier program versions.
        set: |settings, index| settings.set_delay_scheduling(DelayScheduling::ALL[index]),
    },
    control: Control {
        place: Place::Line,
        applies: |study| !has_leads(study),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Degree of the schedule's polynomials for the signed delays.
pub static TAU_DEGREE: Setting = Setting {
    name: "degree of the signed delays",
    key: "schedule.tau_degree",
    option: "--tau-degree",
    kind: Kind::Choice {
        words: &[
            Words::new("0", "τ constant"),
            Words::new("1", "τ degree 1"),
            Words::new("2", "τ degree 2"),
            Words::new("3", "τ degree 3"),
        ],
        get: |settings| settings.schedule.tau_degree,
        set: |settings, degree| settings.schedule.tau_degree = degree,
    },
    control: Control {
        place: Place::Line,
        applies: has_leads,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Maximum difference between consecutive airspeeds that count as equal \[kt\].
pub static AIRSPEED_TOLERANCE: Setting = Setting {
    name: "airspeed tolerance",
    key: "schedule.airspeed_tolerance_kt",
    option: "--airspeed-tolerance",
    unit: Unit {
        file: "kt",
        shown: "kt",
        scale: 1.0,
    },
    kind: Kind::Number {
        range: [0.0, 100.0],
        whole: false,
        get: |settings| settings.schedule.airspeed_tolerance_kt,
        set: |settings, tolerance_kt| settings.schedule.airspeed_tolerance_kt = tolerance_kt,
    },
    control: Control {
        place: Place::Line,
        step: 0.1,
        digits: Digits::Decimals(1),
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Scheduling variable besides airspeed: none, altitude or mass.
pub static SECOND_VARIABLE: Setting = Setting {
    name: "second variable",
    key: "schedule.second_variable",
    option: "--second-variable",
    kind: Kind::Choice {
        words: &[
            Words::new("none", "airspeed only"),
            Words::new("altitude", "airspeed and altitude"),
            Words::new("mass", "airspeed and mass"),
        ],
        get: |settings| settings.schedule.second.index(),
        set: |settings, index| settings.schedule.second = <Option<SecondVariable>>::ALL[index],
    },
    control: Control {
        place: Place::Line,
        ..DEFAULT_CONTROL
    },
    ..DEFAULT
};

/// Every setting except the constrained and ignored responses and the decisions about physics
/// parameters, in display order: a control placed [`Place::Beside`] joins the line of the control
/// before it.
pub static SETTINGS: [&Setting; 30] = [
    &ALPHA_GAIN,
    &ALPHA_DELAY,
    &PHASE,
    &DELAY_FROM,
    &LEAD_ORDER,
    &LEAD_POLE,
    &LEAD_LIMIT,
    &PHYSICS,
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
    /// Checks every value against its setting's range.
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
