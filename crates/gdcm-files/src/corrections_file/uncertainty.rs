//! How sure the figures are, key by key (M13).

use serde::{Deserialize, Serialize};

use gdcm_core::correction::Channel;
use gdcm_core::dataset::{ConditionId, Pair, PairTable};
use gdcm_core::study::{Analysis, ConditionUncertainty, Uncertainty};
use gdcm_core::uncertainty::{Bar, Scalar, VarianceDecomposition};

use super::names::{ByName, ChannelNames};

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
    pub gains: ChannelBars,
    /// Of each channel delay.
    pub delays_s: ChannelBars,
}

/// How sure a figure of each channel is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelBars {
    /// Of each input.
    pub inputs: ByName<Option<BarEntry>>,
    /// Of each output.
    pub outputs: ByName<Option<BarEntry>>,
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
    /// Times what the bundles explain.
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
    /// What neither makes: real, or model form.
    pub rest: f64,
    /// Its interval.
    pub rest_interval: Option<[f64; 2]>,
    /// Shares of trim, identification and rest in the variance.
    pub shares: Option<[f64; 3]>,
    /// Times what the bundles explain.
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

impl BarEntry {
    fn of(scalar: Scalar, bar: &Bar, level: f64) -> Self {
        let told = |interval: Option<[f64; 2]>| {
            interval.map(|ends| ends.map(|end| if scalar.is_delay() { end } else { end.exp() }))
        };
        Self {
            interval: told(bar.interval(level)),
            interval_identification: told(bar.inner_interval(level)),
            u_physics: bar.trim.map(|part| part.variance.sqrt()),
            u_identification: bar.identification.map(|part| part.variance.sqrt()),
            degrees_of_freedom: bar.degrees().filter(|degrees| degrees.is_finite()),
            left_in_band: None,
            remarks: bar.remarks().into_iter().map(str::to_owned).collect(),
        }
    }

    /// The bar of a net gain, with what one gain leaves over in the band.
    pub(super) fn of_net_gain(analysis: &Analysis, condition: ConditionId, pair: Pair) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        let bar = uncertainty.bar(condition, Scalar::NetGain(pair))?;
        let left_in_band = uncertainty.conditions.get(&condition)?.left_in_band[pair];
        Some(Self { left_in_band, ..Self::of(Scalar::NetGain(pair), bar, uncertainty.level) })
    }
}

impl BarsEntry {
    /// The bars of a condition's other figures.
    pub(super) fn of(analysis: &Analysis, condition: ConditionId, names: &ChannelNames) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        let of: &ConditionUncertainty = uncertainty.conditions.get(&condition)?;
        let entry = |scalar| of.bars[scalar].as_ref().map(|bar| BarEntry::of(scalar, bar, uncertainty.level));
        let table = |scalar: fn(Pair) -> Scalar| -> Vec<Vec<Option<BarEntry>>> {
            let (outputs, inputs) = (names.outputs.len(), names.inputs.len());
            let row = |output| (0..inputs).map(|input| entry(scalar(Pair::new(output, input)))).collect();
            (0..outputs).map(row).collect()
        };
        let channels = |scalar: fn(Channel) -> Scalar| ChannelBars {
            inputs: names.by_input(
                (0..names.inputs.len()).map(|input| entry(scalar(Channel::Input(input)))).collect::<Vec<_>>(),
            ),
            outputs: names.by_output(
                (0..names.outputs.len()).map(|output| entry(scalar(Channel::Output(output)))).collect::<Vec<_>>(),
            ),
        };
        let asks_band_delays = analysis.condition(condition)?.asks_band_delays();
        Some(Self {
            delta_gain: table(Scalar::Gain),
            delta_delay_s: table(Scalar::Delay),
            band_delay_s: if asks_band_delays { table(Scalar::BandDelay) } else { Vec::new() },
            gains: channels(Scalar::ChannelGain),
            delays_s: channels(Scalar::ChannelDelay),
        })
    }
}

impl SplitEntry {
    fn of(split: &VarianceDecomposition, level: f64) -> Self {
        Self {
            degrees_of_freedom: split.freedom,
            scatter: split.scatter.sqrt(),
            physics: split.trim.sqrt(),
            identification: split.identification.sqrt(),
            rest: split.rest().sqrt(),
            rest_interval: split.rest_interval(level),
            shares: split.shares(),
            ratio: split.ratio(),
            p: split.p(),
        }
    }
}

impl UncertaintyEntry {
    /// What follows from the bars of an analysis, where they are there.
    pub(super) fn of(analysis: &Analysis, names: &ChannelNames) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        Some(Self {
            level: uncertainty.level,
            differences: differences(uncertainty, names),
            scatter: scatter(uncertainty, names),
            schedule_band: bands(analysis, uncertainty, names),
            second_variable: second_variables(uncertainty, names),
        })
    }
}

fn differences(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<DifferenceEntry> {
    let entry = |of: &gdcm_core::study::AirspeedDifference| {
        let (output, input) = names.pair(of.pair);
        DifferenceEntry {
            output,
            input,
            conditions: of.conditions.map(|id| id.0),
            airspeed_kt: of.airspeed_kt,
            delta: of.difference.delta,
            u: of.difference.deviation,
            degrees_of_freedom: of.difference.degrees.filter(|degrees| degrees.is_finite()),
            ratio: of.difference.ratio(),
            p: of.difference.p(),
            p_holm: of.p_holm,
            words: of.words(uncertainty.level),
        }
    };
    uncertainty.differences.iter().map(entry).collect()
}

fn scatter(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<ScatterEntry> {
    let entry = |of: &gdcm_core::study::PairScatter| {
        let (output, input) = names.pair(of.pair);
        let split = |split: &Option<VarianceDecomposition>| {
            split.as_ref().map(|split| SplitEntry::of(split, uncertainty.level))
        };
        ScatterEntry {
            output,
            input,
            same_airspeed: split(&of.same_airspeed),
            about_schedule: split(&of.about_schedule),
        }
    };
    uncertainty.scatter.iter().map(entry).collect()
}

fn bands(analysis: &Analysis, uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<ScheduleBandEntry> {
    let (Ok(schedule), Some(bands)) = (&analysis.schedule, &uncertainty.bands) else { return Vec::new() };
    let airspeed_kt = schedule.airspeeds.clusters_kt();
    let pairs: PairTable<bool> = analysis.study.dataset.measuring_pairs();
    let entry = |pair: Pair| {
        let (output, input) = names.pair(pair);
        let widths = airspeed_kt.iter().map(|&airspeed| bands.at(schedule, Scalar::NetGain(pair), airspeed));
        let widths: Vec<_> = widths.collect::<Option<_>>()?;
        Some(ScheduleBandEntry {
            output,
            input,
            fit: airspeed_kt.iter().map(|&airspeed| schedule.at(airspeed).net_gain(pair).value().ln()).collect(),
            confidence: widths.iter().map(|widths| widths.confidence).collect(),
            scatter: widths.iter().map(|widths| widths.scatter).collect(),
            airspeed_kt: airspeed_kt.clone(),
        })
    };
    pairs.marked().filter_map(entry).collect()
}

fn second_variables(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<SecondVariableEntry> {
    let entry = |of: &gdcm_core::study::SecondVariableTest| {
        let (output, input) = names.pair(of.pair);
        let effect = of.effect.as_ref().ok();
        SecondVariableEntry {
            output,
            input,
            variable: of.variable.name().to_owned(),
            effect: effect.map(|effect| effect.effect),
            visible: effect.map(|effect| effect.visible),
            p: effect.map(|effect| effect.p),
            p_holm: of.p_holm,
            left_out_without: effect.and_then(|effect| effect.left_out_without),
            left_out_with: effect.and_then(|effect| effect.left_out_with),
            needed: of.needed,
            words: of.words(),
        }
    };
    uncertainty.second_variables.iter().map(entry).collect()
}
