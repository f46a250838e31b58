//! A corrections file, key by key.

use serde::{Deserialize, Serialize};

use gdcm_core::schedule::DEFAULT_TOLERANCE_KT;
use gdcm_core::study::{ResponseNames, Settings, TurnedChannel};

use super::ByName;

/// A table `[output][input]` in the dataset's channel order; `None` (null) where a response has no such figure.
pub type Table = Vec<Vec<Option<f64>>>;

/// What an analysis found, as `corrections.json` holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Corrections {
    /// `gdcm-corrections`.
    pub format: String,
    /// Version of the format.
    pub version: u64,
    /// The program that wrote the file, with its version.
    pub software: String,
    /// The dataset analysed.
    pub dataset: DatasetLabel,
    /// Every setting that changes a result.
    pub settings: Settings<ResponseNames>,
    /// Channels whose models were turned; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signs: Vec<TurnedChannel>,
    /// Result of each condition that has one.
    pub conditions: Vec<ConditionCorrections>,
    /// Conditions without a result.
    #[serde(default)]
    pub failed: Vec<WithoutResult>,
    /// The gains as functions of airspeed; `None` where there is no schedule.
    pub schedule: Option<ScheduleUsed>,
    /// What the schedule is worth.
    pub assessment: Assessment,
    /// What follows from how sure the figures are; results of older programs do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<UncertaintyEntry>,
}

/// Which dataset was analysed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DatasetLabel {
    /// Its name.
    pub name: String,
    /// SHA-256 of its file, in hexadecimal.
    pub sha256: String,
}

/// The result of one condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConditionCorrections {
    /// Identity in the dataset.
    pub id: i64,
    /// Name for people.
    pub name: String,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Model that represents the physics bundle.
    pub physics_representative: String,
    /// Model that represents the identified bundle.
    pub identified_representative: String,
    /// Rejected models, physics first.
    pub rejected: Vec<String>,
    /// Why models are rejected, where the engineer has said so.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<ReasonEntry>,
    /// Physics models suggested as outliers, whatever is rejected.
    pub suggested_outliers: Vec<String>,
    /// Discontinuity ratio of each physics model, where it has one.
    pub discontinuity: ByName<Option<f64>>,
    /// Models that lack a measuring response which another model of their bundle has, and take no part.
    #[serde(default)]
    pub set_aside: Vec<SetAsideEntry>,
    /// Which files the models were made from, of those of which that is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SourceEntry>,
    /// Whether the condition enters the schedule.
    pub scheduled: bool,
    /// Whether it is held out of the schedule, to judge it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held_out: bool,
    /// Responses held in this condition, `[output, input]`: the constrained ones that are defined here.
    pub held: Vec<(String, String)>,
    /// Delta gain.
    #[serde(rename = "G")]
    pub delta_gain: Table,
    /// Delta delay \[s\].
    #[serde(rename = "D_s")]
    pub delta_delay_s: Table,
    /// Band delay \[s\] (M15.2); results of older programs do not have it.
    #[serde(rename = "D_band_s", default)]
    pub band_delay_s: Table,
    /// Least and greatest channel gain.
    pub gain_bounds: [f64; 2],
    /// Greatest channel delay \[s\].
    pub delay_upper_s: f64,
    /// Channel gains.
    pub gains: Channels,
    /// Channel delays \[s\].
    pub delays_s: Channels,
    /// Signed delays and lead filters, where leads were asked for (M15); `delays_s` then holds what is positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead: Option<Channels<LeadEntry>>,
    /// How good the gains are.
    pub gain_solution: GainOutcome,
    /// How good the delays are.
    pub delay_solution: DelayOutcome,
    /// `k_o k_i` of every response, output by output.
    pub net_gains: Vec<NetGain>,
    /// How sure the other figures are; results of older programs do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bars: Option<BarsEntry>,
    /// J of the representative physics model.
    #[serde(rename = "J")]
    pub cost: CostTables,
    /// What has to be known about the result.
    pub cautions: Vec<String>,
}

/// Why a model is rejected, in the engineer's words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReasonEntry {
    /// `physics` or `identified`.
    pub bundle: String,
    /// The model's name.
    pub model: String,
    /// The reason.
    pub why: String,
}

/// A model that takes no part in the comparison of its bundle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetAsideEntry {
    /// The model's name.
    pub model: String,
    /// Which model of which bundle lacks what.
    pub why: String,
}

/// One value for each channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channels<T = f64> {
    /// Of each input.
    pub inputs: ByName<T>,
    /// Of each output.
    pub outputs: ByName<T>,
}

/// The signed delay of a channel and, where it is negative, its lead filter `L(s) = (1 + sqrt(2) s/w1 + (s/w1)^2) / (1 + sqrt(2) s/w2 +
/// (s/w2)^2)`, of first order `(1 + s/w1) / (1 + s/w2)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadEntry {
    /// Signed delay \[s\].
    pub tau_s: f64,
    /// Lead time at low frequency \[s\].
    pub lead_s: Option<f64>,
    /// `w1` \[rad/s\].
    pub zero_rad_s: Option<f64>,
    /// `w2` \[rad/s\].
    pub lag_rad_s: Option<f64>,
    /// `20 log10 R`.
    pub gain_at_infinity_db: Option<f64>,
}

/// How good the gains are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GainOutcome {
    /// The objective of eq. (7).
    pub objective: f64,
    /// No gains inside the bounds have a lower objective.
    pub lower_bound: Option<f64>,
    /// Whether the objective is proven to be the least, to a relative gap of 1e-9.
    pub proven: bool,
    /// The relative gap between objective and lower bound.
    pub gap: f64,
    /// How many distinct local minima lie within 1 % of the objective, itself included.
    pub local_minima: usize,
    /// Whether every held response is held at its G.
    pub matched: bool,
    /// The responses that are not.
    pub unmatched: Vec<UnmatchedGainEntry>,
    /// Why not, what would help, and what holding costs.
    pub explanation: Explanation,
}

/// A response that could not be held at its G.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnmatchedGainEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// Net gain at which it is held instead.
    pub target: f64,
    /// Its G.
    pub wanted: f64,
    /// `20 log10 (target / wanted)`.
    pub short_db: f64,
    /// What is in the way, and what would help.
    pub why: String,
}

/// How good the delays are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DelayOutcome {
    /// The objective of eq. (11), or of M15.4 \[s²\].
    pub objective: f64,
    /// How far the answer is from what a minimum needs \[s\]; the program is convex, so that 0 is a proof.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kkt_residual_s: Option<f64>,
    /// Whether every held response is held at its D.
    pub matched: bool,
    /// The responses that are not.
    pub unmatched: Vec<UnmatchedDelayEntry>,
    /// Why not, what would help, and what holding costs.
    pub explanation: Explanation,
}

/// A response that could not be held at its D.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnmatchedDelayEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// Net delay at which it is held instead \[s\].
    pub target_s: f64,
    /// Its D \[s\].
    pub wanted_s: f64,
    /// Phase error that remains at the top of the band \[deg\].
    pub phase_left_deg: f64,
    /// What is in the way.
    pub why: String,
}

/// The net gain of a response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetGain {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// `k_o k_i`.
    pub gain: f64,
    /// How sure it is; results of older programs do not say it.
    #[serde(flatten)]
    pub bar: BarEntry,
}

/// J before and after a correction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CostTables {
    /// Before.
    pub uncorrected: CostTable,
    /// After.
    pub corrected: CostTable,
}

/// J in its two parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CostTable {
    /// The magnitude's part.
    pub mag: Table,
    /// The phase's part.
    pub phase: Table,
}

/// A condition without a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WithoutResult {
    /// Identity in the dataset.
    pub id: i64,
    /// Why there is none.
    pub why: String,
}

/// The gains as functions of airspeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduleUsed {
    /// `polynomial` or `table`.
    pub kind: String,
    /// `ln k` or `k`: what the figures of `inputs` and `outputs` give.
    pub of: String,
    /// Degree of the polynomial, which may be less than was asked for; `None` for a table.
    pub degree: Option<usize>,
    /// Airspeeds this close to the next one are one point of the table, and count as one for the degree \[kt\].
    #[serde(default = "default_tolerance_kt")]
    pub airspeed_tolerance_kt: f64,
    /// Mean airspeed of the scheduled conditions \[kt\].
    pub airspeed_mean_kt: f64,
    /// Half the range of their airspeeds \[kt\].
    pub airspeed_half_range_kt: f64,
    /// Least and greatest of their airspeeds \[kt\]; outside, the end value holds.
    pub airspeed_range_kt: [f64; 2],
    /// Of each input: coefficients in the scaled airspeed, lowest power first; or the table's figures, one for each airspeed of
    /// `table`.
    pub inputs: ByName<Vec<f64>>,
    /// Of each output, likewise.
    pub outputs: ByName<Vec<f64>>,
    /// What a second variable adds, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_variable: Option<ScheduledSecond>,
    /// The same of the delays \[s\], where they are scheduled.
    pub delays_s: Option<ScheduledDelays>,
    /// Coefficients of the signed delays \[s\] in the scaled airspeed, lowest power first, where leads were asked for (M15).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau_s: Option<ScheduledTaus>,
    /// The scheduled gains at the mean of each cluster of the conditions' airspeeds.
    pub table: Vec<ScheduledGains>,
    /// What has to be known about the schedule.
    #[serde(default)]
    pub cautions: Vec<String>,
}

fn default_tolerance_kt() -> f64 {
    DEFAULT_TOLERANCE_KT
}

/// What a second variable `z` adds to each figure: its coefficient times `(z - middle) / half_range`, `z` within the range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduledSecond {
    /// `altitude` or `mass`.
    pub variable: String,
    /// `ft` or `kg`.
    pub unit: String,
    /// Middle of the range of the scheduled conditions.
    pub middle: f64,
    /// Half of that range.
    pub half_range: f64,
    /// Coefficient of each input.
    pub inputs: ByName<f64>,
    /// Coefficient of each output.
    pub outputs: ByName<f64>,
}

/// Delays as functions of airspeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduledDelays {
    /// Of each input.
    pub inputs: ByName<Vec<f64>>,
    /// Of each output.
    pub outputs: ByName<Vec<f64>>,
    /// Upper bound of every delay at each airspeed of `table`, linear between \[s\]: scheduled delays are cut to 0 and to
    /// this. Results of older programs do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper_s: Option<Vec<f64>>,
}

/// Signed delays as functions of airspeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduledTaus {
    /// Of each input.
    pub inputs: ByName<Vec<f64>>,
    /// Of each output.
    pub outputs: ByName<Vec<f64>>,
    /// Least and greatest scheduled value \[s\]: what is outside is cut to them.
    pub bounds_s: [f64; 2],
}

/// The scheduled gains at one airspeed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduledGains {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Of each input.
    pub inputs: ByName<f64>,
    /// Of each output.
    pub outputs: ByName<f64>,
    /// The scheduled delays \[s\], where they are scheduled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delays_s: Option<Channels>,
    /// The scheduled signed delays and filters, where leads were asked for (M15).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead: Option<Channels<LeadEntry>>,
}

/// What the scheduled correction is worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assessment {
    /// Conditions assessed.
    pub conditions: Vec<ConditionAssessment>,
    /// Conditions left out.
    pub left_out: Vec<WithoutResult>,
}

/// Change of J of one condition's nominal model under the scheduled correction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConditionAssessment {
    /// Identity in the dataset.
    pub id: i64,
    /// The model assessed.
    pub model: String,
    /// Change of J.
    #[serde(rename = "dJ")]
    pub total: Table,
    /// Change of its magnitude part.
    #[serde(rename = "dJ_mag")]
    pub magnitude: Table,
    /// Change of its phase part.
    #[serde(rename = "dJ_phase")]
    pub phase: Table,
}

/// Which file a model was made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceEntry {
    /// `physics` or `identified`.
    pub bundle: String,
    /// The model's name.
    pub model: String,
    /// The file, relative to the dataset's.
    pub file: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// The variable in it, or the flight record.
    pub variable: Option<String>,
    /// When the model was made.
    pub made: Option<String>,
    /// What else is known of it.
    pub note: Option<String>,
    /// Names of the flight records that it was identified from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<String>,
}

/// What explains one optimum.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Each smallest set of held responses and bounds that cannot hold together.
    pub conflicts: Vec<ConflictEntry>,
    /// Each loop of held responses that disagrees by no more than the tolerance, and counts as agreeing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub agreeing: Vec<ConflictEntry>,
    /// Single changes after which everything held can be held; absent where nothing is in the way.
    pub remedy: Option<RemedyEntry>,
    /// What each held response and each active bound costs, the most expensive first.
    pub sensitivities: Vec<SensitivityEntry>,
}

/// A smallest set of held responses and bounds that cannot hold together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConflictEntry {
    /// What is in the way: `upper_bound`, `lower_bound`, `both_bounds`, `lead`, `loop` or `unclear`.
    pub kind: String,
    /// The held responses, `[output, input]`, of which one must be freed.
    pub entries: Vec<(String, String)>,
    /// The channels whose bounds are in the way.
    pub channels: Vec<String>,
    /// By how much: a product or ratio of gains, a sum or difference of delays \[s\], or the mismatch of a loop \[dB or s\].
    pub figure: Option<f64>,
    /// Upper bound that would resolve it.
    pub upper: Option<f64>,
    /// Lower bound that would resolve it.
    pub lower: Option<f64>,
    /// The same in words.
    pub words: String,
}

/// Single changes after which everything held can be held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RemedyEntry {
    /// This upper bound.
    pub upper: Option<f64>,
    /// This lower bound.
    pub lower: Option<f64>,
    /// Freeing any one of these, `[output, input]`.
    pub free: Vec<(String, String)>,
}

/// The multiplier of a held response or an active bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensitivityEntry {
    /// `held`, `lower_bound` or `upper_bound`.
    pub restraint: String,
    /// The held response, `[output, input]`.
    pub entry: Option<(String, String)>,
    /// The channel on its bound.
    pub channel: Option<String>,
    /// Change of the objective for each dB (gains) or ms (delays) by which it is raised.
    pub per_unit: f64,
    /// The same as a share of the objective.
    pub share_per_unit: f64,
}

/// How sure one figure is. Of a gain the intervals are factors and the deviations those of its natural logarithm; of a delay \[s\].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BarEntry {
    /// The whole bar; none where the bundles have no spread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// The inner bar, for the physics model chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_identification: Option<[f64; 2]>,
    /// What not knowing the trim flown makes; none where it is not included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub u_physics: Option<f64>,
    /// What the identification makes; none where it is not included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub u_identification: Option<f64>,
    /// Degrees of freedom of both together; none where there is no spread, or where it is taken as known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees_of_freedom: Option<f64>,
    /// Half the width from the 16 % to the 84 % quantile, over the band, of what one gain leaves over \[ln\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_in_band: Option<f64>,
    /// What is not included, and where the identification part comes from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
}

/// How sure the figures of one condition are, besides its net gains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BarsEntry {
    /// Of each G, `[output][input]`.
    #[serde(rename = "G")]
    pub delta_gain: Vec<Vec<Option<BarEntry>>>,
    /// Of each D.
    #[serde(rename = "D_s")]
    pub delta_delay_s: Vec<Vec<Option<BarEntry>>>,
    /// Of each band delay, where the channels were asked for those (M15.2).
    #[serde(rename = "D_band_s", default, skip_serializing_if = "Vec::is_empty")]
    pub band_delay_s: Vec<Vec<Option<BarEntry>>>,
    /// Of each channel gain.
    pub gains: Channels<Option<BarEntry>>,
    /// Of each channel delay.
    pub delays_s: Channels<Option<BarEntry>>,
}

/// What follows from the bars of all conditions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UncertaintyEntry {
    /// Level of every interval and test.
    pub level: f64,
    /// Differences of on-axis net gains of conditions at equal airspeed.
    pub differences: Vec<DifferenceEntry>,
    /// What the scatter of each on-axis net gain is made of.
    pub scatter: Vec<ScatterEntry>,
    /// The scheduled on-axis net gains with their bands.
    pub schedule_band: Vec<ScheduleBandEntry>,
    /// Whether the schedule needs a second variable.
    pub second_variable: Vec<SecondVariableEntry>,
}

/// The difference of a net gain between two conditions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DifferenceEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// The two conditions.
    pub conditions: [i64; 2],
    /// Their airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Difference of the logarithms.
    pub delta: f64,
    /// What both bundles make of it, as a standard deviation.
    pub u: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: Option<f64>,
    /// Factor by which it exceeds what is expected.
    pub ratio: Option<f64>,
    /// How likely that is where there is no difference.
    pub p: Option<f64>,
    /// The same after Holm's correction over all differences.
    pub p_holm: Option<f64>,
    /// In words.
    pub words: String,
}

/// What the scatter of a net gain is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScatterEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// At equal airspeed.
    pub same_airspeed: Option<SplitEntry>,
    /// About the schedule.
    pub about_schedule: Option<SplitEntry>,
}

/// A scatter split into its parts, standard deviations of the natural logarithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SplitEntry {
    /// Degrees of freedom.
    pub degrees_of_freedom: usize,
    /// The scatter.
    pub scatter: f64,
    /// What not knowing the trims makes.
    pub physics: f64,
    /// What the identification makes.
    pub identification: f64,
    /// What neither makes: a physical effect, or a model-form error.
    pub rest: f64,
    /// Its interval.
    pub rest_interval: Option<[f64; 2]>,
    /// Shares of trim, identification and rest in the variance.
    pub shares: Option<[f64; 3]>,
    /// Factor by which it exceeds what is expected.
    pub ratio: Option<f64>,
    /// How likely that is where they explain all.
    pub p: Option<f64>,
}

/// A scheduled net gain with its bands, as natural logarithms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScheduleBandEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// Airspeeds \[kt\].
    pub airspeed_kt: Vec<f64>,
    /// The scheduled `ln k_o k_i`.
    pub fit: Vec<f64>,
    /// Half-width of the confidence band.
    pub confidence: Vec<f64>,
    /// Half-width of the scatter band.
    pub scatter: Vec<f64>,
}

/// Whether the schedule of a net gain needs a second variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondVariableEntry {
    /// The output's name.
    pub output: String,
    /// The input's name.
    pub input: String,
    /// `altitude` or `mass`.
    pub variable: String,
    /// Effect on the logarithm from the lowest to the highest value; none where it cannot be told.
    pub effect: Option<f64>,
    /// An effect smaller than plus or minus this could not have been seen.
    pub visible: Option<f64>,
    /// How likely so great an effect is where there is none.
    pub p: Option<f64>,
    /// The same after Holm's correction.
    pub p_holm: Option<f64>,
    /// Leave-one-condition-out error without the variable, rms.
    pub left_out_without: Option<f64>,
    /// The same with it.
    pub left_out_with: Option<f64>,
    /// Whether it is needed.
    pub needed: bool,
    /// In words.
    pub words: String,
}
