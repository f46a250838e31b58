//! Result files: `corrections.json`, `corrections.csv`, `assessment.csv`, and their checksums.

mod corrections;
mod uncertainty;

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use gdcm_method::correction::{Channel, ChannelCorrection, LeadPrice};
use gdcm_method::schedule::CostChange;
use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent};
use gdcm_model::dataset::{Condition, ConditionId, Pair};
use gdcm_model::number_format::full_precision;
use gdcm_model::response::LeadFilter;
use gdcm_plot::figure::all_channels;
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::assessment::not_assessed_text;

use super::export_contents::ExportContents;
use crate::csv_text::write_records;
use crate::file_error::FileError;
use crate::json_text::write_pretty;
use crate::output_set::{OutputSet, make_directory};

pub use corrections::corrections;
pub(crate) use corrections::without_empty;

const NAME: &str = "gdcm-corrections";
const VERSION: u64 = 1;

/// Names of the result files; the last contains the checksums of the others.
pub const RESULT_FILES: [&str; 4] = [
    "corrections.json",
    "corrections.csv",
    "assessment.csv",
    "corrections.sha256",
];

/// Returns the paths of the result files in a directory.
pub fn result_paths(directory: &Path) -> [PathBuf; 4] {
    RESULT_FILES.map(|name| directory.join(name))
}

/// Writes the results of the chosen conditions into a directory, created if missing: all files, or
/// none. The checksums come last and show whether the files belong together.
///
/// `sha256` is the hash of the dataset's file.
pub fn write_results(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, channels, responses, checksums] = result_paths(directory);
    outputs.check(&[&json, &channels, &responses, &checksums])?;
    make_directory(directory)?;
    outputs.add(&json, |file| {
        write_corrections(analysis, sha256, chosen, file)
    })?;
    outputs.add(&channels, |file| channel_table(analysis, chosen, file))?;
    outputs.add(&responses, |file| response_table(analysis, chosen, file))?;
    outputs.add_checksums(&checksums)?;
    outputs.persist()
}

/// Writes `corrections.json`: all results of the chosen conditions.
pub(crate) fn write_corrections(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    write_pretty(&corrections(analysis, sha256, chosen), file)
}

// The results as comma-separated values (RFC 4180), with a row for each condition and channel, or
// condition and response.

/// Results of a condition.
#[derive(Clone)]
struct Found<'a> {
    analysis: &'a Analysis,
    condition: &'a Condition,
    scheduled: Option<ChannelCorrection>,
    /// Contents of the correction and omitted parts, in words.
    contains: String,
}

/// A channel of a condition.
struct ChannelRow<'a> {
    found: Found<'a>,
    channel: Channel,
}

/// A response of a condition.
struct ResponseRow<'a> {
    found: Found<'a>,
    pair: Pair,
}

/// A column of the table of channels: its name, and its cell in a row.
type ChannelColumn = (&'static str, fn(&ChannelRow<'_>) -> String);
/// A column of the table of responses.
type ResponseColumn = (&'static str, fn(&ResponseRow<'_>) -> String);

const CHANNEL_COLUMNS: [ChannelColumn; 23] = [
    ("condition", |row| row.found.condition.id().to_string()),
    ("airspeed_kt", |row| {
        row.found.condition.flight_state().airspeed_kt.to_string()
    }),
    ("kind", |row| {
        if matches!(row.channel, Channel::Input(_)) {
            "input"
        } else {
            "output"
        }
        .to_owned()
    }),
    ("channel", |row| row.name()),
    ("gain", |row| {
        full_precision(row.found.own().map(|own| own.gain(row.channel)))
    }),
    ("delay_s", |row| {
        full_precision(row.found.own().map(|own| own.pure_delay_s(row.channel)))
    }),
    ("scheduled_gain", |row| {
        full_precision(row.found.scheduled.as_ref().map(|of| of.gain(row.channel)))
    }),
    ("scheduled_delay_s", |row| {
        full_precision(
            row.found
                .scheduled
                .as_ref()
                .map(|of| of.pure_delay_s(row.channel)),
        )
    }),
    ("tau_s", |row| full_precision(row.tau_s(row.found.own()))),
    ("lead_s", |row| {
        full_precision(row.filter().map(LeadFilter::lead_s))
    }),
    ("zero_rad_s", |row| {
        full_precision(row.filter().map(LeadFilter::zero_rad_s))
    }),
    ("lag_rad_s", |row| {
        full_precision(row.filter().map(LeadFilter::lag_rad_s))
    }),
    ("gain_at_infinity_db", |row| {
        full_precision(row.filter().map(LeadFilter::gain_at_infinity_db))
    }),
    ("scheduled_tau_s", |row| {
        full_precision(row.tau_s(row.found.scheduled.as_ref()))
    }),
    ("gain_low", |row| {
        row.found.end(Scalar::ChannelGain(row.channel), 0)
    }),
    ("gain_high", |row| {
        row.found.end(Scalar::ChannelGain(row.channel), 1)
    }),
    ("delay_low_s", |row| {
        row.found.end(Scalar::ChannelDelay(row.channel), 0)
    }),
    ("delay_high_s", |row| {
        row.found.end(Scalar::ChannelDelay(row.channel), 1)
    }),
    ("u_gain_physics", |row| {
        row.found
            .deviation(Scalar::ChannelGain(row.channel), |bar| bar.trim)
    }),
    ("u_gain_identification", |row| {
        row.found
            .deviation(Scalar::ChannelGain(row.channel), |bar| bar.identification)
    }),
    ("gain_above_band_db", |row| {
        full_precision(row.price().map(|price| price.gains_db[row.channel]))
    }),
    ("not_valid_above_rad_s", |row| {
        full_precision(row.price().map(|price| price.limit_rad_s))
    }),
    ("contains", |row| row.found.contains.clone()),
];

const RESPONSE_COLUMNS: [ResponseColumn; 34] = [
    ("condition", |row| row.found.condition.id().to_string()),
    ("airspeed_kt", |row| {
        row.found.condition.flight_state().airspeed_kt.to_string()
    }),
    ("output", |row| {
        row.found.analysis.study.dataset.outputs()[row.pair.output]
            .name
            .clone()
    }),
    ("input", |row| {
        row.found.analysis.study.dataset.inputs()[row.pair.input]
            .name
            .clone()
    }),
    ("on_axis", |row| {
        row.found.analysis.study.dataset.on_axis()[row.pair].to_string()
    }),
    ("held", |row| {
        row.found
            .result()
            .is_some_and(|result| result.held()[row.pair])
            .to_string()
    }),
    ("G", |row| {
        full_precision(
            row.found
                .result()
                .and_then(|result| result.wanted_gain(row.pair)),
        )
    }),
    ("D_s", |row| {
        full_precision(
            row.found
                .result()
                .and_then(|result| result.comparison.delta.delay_s[row.pair]),
        )
    }),
    ("net_gain", |row| {
        full_precision(row.found.own().map(|own| own.net_gain(row.pair)))
    }),
    ("net_delay_s", |row| {
        full_precision(row.found.own().map(|own| own.net_delay_s(row.pair)))
    }),
    ("scheduled_net_gain", |row| {
        full_precision(row.found.scheduled.as_ref().map(|of| of.net_gain(row.pair)))
    }),
    ("scheduled_net_delay_s", |row| {
        full_precision(
            row.found
                .scheduled
                .as_ref()
                .map(|of| of.net_delay_s(row.pair)),
        )
    }),
    ("J_mag_uncorrected", |row| {
        full_precision(row.change().map(|change| change.uncorrected.magnitude))
    }),
    ("J_phase_uncorrected", |row| {
        full_precision(row.change().map(|change| change.uncorrected.phase))
    }),
    ("J_mag_scheduled", |row| {
        full_precision(row.change().map(|change| change.corrected.magnitude))
    }),
    ("J_phase_scheduled", |row| {
        full_precision(row.change().map(|change| change.corrected.phase))
    }),
    ("dJ_mag", |row| {
        full_precision(row.change().map(|change| change.magnitude()))
    }),
    ("dJ_phase", |row| {
        full_precision(row.change().map(|change| change.phase()))
    }),
    ("dJ", |row| {
        full_precision(row.change().map(|change| change.total()))
    }),
    ("left_out", |row| row.left_out()),
    ("D_band_s", |row| {
        full_precision(
            row.found
                .result()
                .and_then(|result| result.comparison.delta.band_delay_s[row.pair]),
        )
    }),
    ("held_out", |row| {
        row.found
            .analysis
            .study
            .choice(row.found.condition.id())
            .held_out
            .to_string()
    }),
    ("G_low", |row| row.found.end(Scalar::Gain(row.pair), 0)),
    ("G_high", |row| row.found.end(Scalar::Gain(row.pair), 1)),
    ("D_low_s", |row| row.found.end(Scalar::Delay(row.pair), 0)),
    ("D_high_s", |row| row.found.end(Scalar::Delay(row.pair), 1)),
    ("net_gain_low", |row| {
        row.found.end(Scalar::NetGain(row.pair), 0)
    }),
    ("net_gain_high", |row| {
        row.found.end(Scalar::NetGain(row.pair), 1)
    }),
    ("u_net_gain_physics", |row| {
        row.found
            .deviation(Scalar::NetGain(row.pair), |bar| bar.trim)
    }),
    ("u_net_gain_identification", |row| {
        row.found
            .deviation(Scalar::NetGain(row.pair), |bar| bar.identification)
    }),
    ("degrees_of_freedom", |row| {
        full_precision(
            row.found
                .bar(Scalar::NetGain(row.pair))
                .and_then(Bar::degrees_of_freedom),
        )
    }),
    ("left_in_band", |row| row.left_in_band()),
    ("D_band_low_s", |row| {
        row.found.end(Scalar::BandDelay(row.pair), 0)
    }),
    ("D_band_high_s", |row| {
        row.found.end(Scalar::BandDelay(row.pair), 1)
    }),
];

/// Returns `corrections.csv`: the channel gains (ratios) and delays \[s\] of the chosen conditions,
/// and the scheduled ones at the same airspeed; if leads were requested, the signed delays and the
/// filters of the negative ones. A missing value is an empty cell. With couplings, a column for
/// each input and each output follows, with their shares in an input (M16).
pub(crate) fn channel_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let channels = all_channels(&analysis.study.dataset);
    let rows = conditions(analysis, chosen).flat_map(|found| {
        let row = move |&channel: &Channel| ChannelRow {
            found: found.clone(),
            channel,
        };
        channels.iter().map(row)
    });
    let couplings = analysis.fitted_couplings().is_some();
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let mixed = inputs.iter().map(|name| format!("mixing_{name}"));
    let fed_back = outputs.iter().map(|name| format!("feedback_{name}"));
    let heading = CHANNEL_COLUMNS.iter().map(|(name, _)| (*name).to_owned());
    let heading: Vec<String> = heading
        .chain(mixed.chain(fed_back).filter(|_| couplings))
        .collect();
    let cells = |row: ChannelRow<'_>| -> Vec<String> {
        CHANNEL_COLUMNS
            .iter()
            .map(|(_, cell)| cell(&row))
            .chain(row.coupling_cells())
            .collect()
    };
    write_records(file, std::iter::once(heading).chain(rows.map(cells)))
}

/// Returns `assessment.csv`: G, D \[s\], net gains and J of the nominal model before and under the
/// scheduled correction, of every response of the chosen conditions. A missing value is an empty
/// cell; `left_out` gives the reason why a condition is not assessed, `D_band_s` is the band delay
/// (M15.2). Each bar belongs to the value with its name.
pub(crate) fn response_table(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let pairs: Vec<Pair> = analysis.study.dataset.on_axis().pairs().collect();
    let rows = conditions(analysis, chosen).flat_map(|found| {
        let row = move |&pair: &Pair| ResponseRow {
            found: found.clone(),
            pair,
        };
        pairs.iter().map(row)
    });
    let heading = RESPONSE_COLUMNS.map(|(name, _)| name.to_owned());
    write_records(
        file,
        std::iter::once(heading)
            .chain(rows.map(|row| RESPONSE_COLUMNS.map(|(_, cell)| cell(&row)))),
    )
}

fn conditions<'a>(
    analysis: &'a Analysis,
    chosen: &BTreeSet<ConditionId>,
) -> impl Iterator<Item = Found<'a>> {
    let conditions = analysis.study.dataset.conditions();
    let chosen = conditions
        .iter()
        .filter(|condition| chosen.contains(&condition.id()));
    let contents = ExportContents::of_results(analysis);
    let mut contains = contents.words();
    for words in contents.left_out_words(&analysis.study.dataset) {
        contains.push_str(&format!("; left out: {words}"));
    }
    chosen.map(move |condition| {
        let contains = contains.clone();
        let scheduled = analysis
            .schedule
            .as_ref()
            .ok()
            .map(|schedule| schedule.at_state(condition.flight_state()));
        Found {
            analysis,
            condition,
            scheduled,
            contains,
        }
    })
}

impl Found<'_> {
    fn result(&self) -> Option<&ConditionAnalysis> {
        self.analysis.condition(self.condition.id())
    }

    /// Returns the condition's own correction.
    fn own(&self) -> Option<&ChannelCorrection> {
        self.result().map(|result| &result.correction)
    }

    fn bar(&self, scalar: Scalar) -> Option<&Bar> {
        self.analysis
            .uncertainty
            .as_ref()?
            .bar(self.condition.id(), scalar)
    }

    /// Returns the lower (0) or upper (1) end of the total interval; for a gain as a ratio.
    fn end(&self, scalar: Scalar, end: usize) -> String {
        let level = self
            .analysis
            .uncertainty
            .as_ref()
            .map(|uncertainty| uncertainty.level);
        let ends = self
            .bar(scalar)
            .zip(level)
            .and_then(|(bar, level)| bar.interval(level));
        full_precision(ends.map(|ends| {
            if scalar.is_delay() {
                ends[end]
            } else {
                ends[end].exp()
            }
        }))
    }

    /// Returns the standard deviation of a component of an interval.
    fn deviation(
        &self,
        scalar: Scalar,
        component: fn(&Bar) -> Option<VarianceComponent>,
    ) -> String {
        full_precision(
            self.bar(scalar)
                .and_then(component)
                .map(|component| component.variance.sqrt()),
        )
    }
}

impl ChannelRow<'_> {
    fn name(&self) -> String {
        let (inputs, outputs) = self.found.analysis.study.dataset.names_of_channels();
        self.channel.name(&inputs, &outputs)
    }

    fn tau_s(&self, of: Option<&ChannelCorrection>) -> Option<f64> {
        of?.leads.as_ref().map(|leads| leads.taus_s[self.channel])
    }

    /// Returns the weights of each input and of each output in an input; empty without couplings.
    fn coupling_cells(&self) -> Vec<String> {
        let Some(fitted) = self.found.analysis.fitted_couplings() else {
            return Vec::new();
        };
        let matrices = fitted.matrices();
        let airspeed_kt = self.found.condition.flight_state().airspeed_kt;
        let mixing = matrices.normalised_mixing(airspeed_kt);
        let feedback = matrices.feedback();
        match self.channel {
            Channel::Input(to) => {
                let taken = (0..mixing.ncols()).map(|from| mixing[(to, from)]);
                taken
                    .chain((0..feedback.ncols()).map(|of| feedback[(to, of)]))
                    .map(|value| full_precision(Some(value)))
                    .collect()
            }
            Channel::Output(_) => vec![String::new(); mixing.ncols() + feedback.ncols()],
        }
    }

    fn price(&self) -> Option<LeadPrice> {
        LeadPrice::of(self.found.own()?.leads.as_ref()?)
    }

    fn filter(&self) -> Option<LeadFilter> {
        self.found.own()?.lead(self.channel)
    }
}

impl ResponseRow<'_> {
    fn change(&self) -> Option<CostChange> {
        self.found
            .analysis
            .assessment
            .get(&self.found.condition.id())?
            .as_ref()
            .ok()?[self.pair]
    }

    fn left_out(&self) -> String {
        match self
            .found
            .analysis
            .assessment
            .get(&self.found.condition.id())
        {
            Some(Err(why)) => not_assessed_text(why, &self.found.analysis.study.dataset),
            _ => String::new(),
        }
    }

    fn left_in_band(&self) -> String {
        let uncertainty = self.found.analysis.uncertainty.as_ref();
        full_precision(
            uncertainty.and_then(|of| {
                of.conditions.get(&self.found.condition.id())?.left_in_band[self.pair]
            }),
        )
    }
}
