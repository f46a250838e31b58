//! Words for couplings: a diagnosis first, then the benefit, then the cost (M16.4); and tables of
//! the same figures (M16.5).

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix};

use gdcm_method::couplings::coupling_effects::{
    FeedbackShare, MixingShare, cyclic_inputs, feedback_shares, mixing_shares,
};
use gdcm_method::couplings::{LEAST_CONDITIONS, LoopMargin, Unknown};
use gdcm_model::dataset::{Channel, ConditionId, Dataset, Pair};
use gdcm_model::units::{number, signed, telling};

use super::couplings_assessment::{
    AxisCost, CouplingCost, CouplingEntry, CouplingsAssessment, UnstablePole,
};
use super::remark::{Remark, RemarkKind};
use super::table::Table;
use crate::decisions::settings::CouplingCorrection;

/// Number of entries reported of each matrix, largest first.
const TOLD: usize = 3;
/// Shares below this are negligible.
const NOTHING: f64 = 0.005;

/// Returns the remark that a study requests couplings and has none, so that all results are without
/// them.
pub fn no_couplings(why: &str) -> Remark {
    Remark::new(
        RemarkKind::Trouble,
        format!("No couplings: {why}. Everything here is without them."),
    )
}

impl CouplingsAssessment {
    /// Returns all remarks: the diagnosis, the benefit of couplings, and the cautions.
    pub fn remarks(&self, dataset: &Dataset) -> Vec<Remark> {
        let diagnosis = self
            .diagnosis(dataset)
            .into_iter()
            .map(|text| Remark::new(RemarkKind::Good, text));
        diagnosis.chain(self.consequences(dataset)).collect()
    }

    /// Returns the benefit, the cost, and the cautions.
    pub fn consequences(&self, dataset: &Dataset) -> Vec<Remark> {
        let price = self
            .price(dataset)
            .map(|text| Remark::new(RemarkKind::Good, text));
        self.verdict()
            .into_iter()
            .chain(price)
            .chain(self.cautions(dataset))
            .collect()
    }

    /// Interprets the largest significant entries: "LAT takes 4.7 % of LON: as a swashplate phase
    /// of 2.7°"; "PED follows NY by 1.2 % per m/s²: directional stiffness that the physics model
    /// does not have".
    pub fn diagnosis(&self, dataset: &Dataset) -> Vec<String> {
        let airspeed_kt = self.mean_airspeed_kt();
        let is_told =
            |entries: &DMatrix<CouplingEntry>, place: (usize, usize)| !entries[place].is_within_bar;
        let is_rate = |output: usize| is_rate(&dataset.outputs()[output]);
        let mixing = self.mixing(airspeed_kt);
        let feedback = self.feedback();
        let matrices = self.fitted.matrices();
        let cyclic = cyclic_inputs(dataset.on_axis(), is_rate);
        let mixed = mixing_shares(&matrices.normalised_mixing(airspeed_kt), cyclic);
        let mixed = mixed
            .into_iter()
            .filter(|of| is_told(&mixing, (of.to, of.from)) && of.share.abs() >= NOTHING);
        let fed = feedback_shares(&self.fitted.problem, matrices).into_iter();
        let fed = fed.filter(|of| is_told(&feedback, (of.input, of.output)) && of.share >= NOTHING);
        let mixed = mixed.take(TOLD).map(|of| mixing_words(dataset, &of));
        mixed
            .chain(fed.take(TOLD).map(|of| feedback_words(dataset, &of)))
            .collect()
    }

    /// Judges from J of conditions left out whether couplings are worthwhile.
    fn verdict(&self) -> Vec<Remark> {
        let cost = self.deciding_cost();
        let ([Some(others), Some(without)], on_axis) = (
            [cost.with.others, cost.without.others],
            cost.with.on_axis.zip(cost.without.on_axis),
        ) else {
            return Vec::new();
        };
        let where_from = if self.costs.left_out.is_some() {
            "conditions left out"
        } else {
            "the schedule"
        };
        let text = format!(
            "Off the axis, J of {where_from} is {} without couplings and {} with {}{}.",
            telling(without, 1),
            telling(others, 1),
            self.couplings.name(),
            on_axis.map_or_else(String::new, |(with, without)| {
                format!(
                    "; on the axis {} and {}",
                    telling(without, 1),
                    telling(with, 1)
                )
            })
        );
        let mut remarks = vec![Remark::new(RemarkKind::Good, text)];
        if !cost.is_worth_it() {
            let text = format!(
                "Off the axis, J of {where_from} is not at least a tenth less with {}: switch the couplings off.",
                self.couplings.name()
            );
            remarks.push(Remark::new(RemarkKind::Caution, text));
        }
        remarks
    }

    /// Returns the offer to a study without these couplings; `None` where they are not worthwhile,
    /// or no condition was left out.
    pub fn offer(&self) -> Option<String> {
        let cost = self.costs.left_out.filter(CouplingCost::is_worth_it)?;
        Some(format!(
            "With {} off-axis J of conditions left out would be {} in place of {}.",
            self.couplings.name(),
            telling(cost.with.others?, 1),
            telling(cost.without.others?, 1)
        ))
    }

    /// Describes the effect of the couplings above the band, and the pole shifts in it.
    fn price(&self, dataset: &Dataset) -> impl Iterator<Item = String> {
        let above = self
            .conditions
            .iter()
            .filter_map(|(id, of)| Some((*id, of.most_changed_above_band(dataset.on_axis())?)));
        let above = above
            .max_by(|a, b| a.1.1.total_cmp(&b.1.1))
            .filter(|(_, (_, change_db))| change_db.is_finite());
        let top = self.omega.last().copied().unwrap_or_default();
        let above = above.map(|(id, (pair, change_db))| {
            format!(
                "Above the band, at {} rad/s, the couplings change {} most of the on-axis responses: by {} dB of it (condition {id}).",
                number(top),
                dataset.pair_name(pair),
                signed(change_db, 0)
            )
        });
        let bars = "Error bars of gains, delays and leads are those under these couplings: a swap of models does not fit them again.";
        above
            .into_iter()
            .chain(self.farthest_pole())
            .chain(std::iter::once(bars.to_owned()))
    }

    fn farthest_pole(&self) -> Option<String> {
        let in_band = |omega: f64| (self.band.min()..=self.band.max()).contains(&omega);
        let moved = self
            .conditions
            .iter()
            .flat_map(|(id, of)| of.poles.iter().flatten().map(|shift| (*id, shift)));
        let moved = moved.filter_map(|(id, shift)| {
            let before = shift.before.filter(|before| in_band(before.norm()))?;
            Some((id, before, shift.after, shift.distance_rad_s()?))
        });
        let (id, before, after, distance_rad_s) = moved.max_by(|a, b| a.3.total_cmp(&b.3))?;
        (distance_rad_s > 0.0).then(|| {
            format!(
                "Poles within the band move by up to {} rad/s: from {} to {} (condition {id}).",
                telling(distance_rad_s, 2),
                pole_words(before),
                pole_words(after)
            )
        })
    }

    /// Returns the cautions to read before the couplings are used.
    pub fn cautions(&self, dataset: &Dataset) -> Vec<Remark> {
        let caution = |text: String| Remark::new(RemarkKind::Caution, text);
        let mut remarks: Vec<Remark> = self.unstable_words();
        remarks.extend(self.ringing_words().map(caution));
        if self.want_leads > 0 && self.couplings == CouplingCorrection::MixingAndFeedback {
            remarks.push(caution(format!(
                "In {} all held responses want lead, which no channel gives: the feedback takes its place, with large entries and \
                 poles far from where they were. Correct the phase by leads first.",
                counted(self.want_leads)
            )));
        }
        let conditions = self.fitted.problem.conditions.len();
        if conditions < LEAST_CONDITIONS {
            remarks.push(caution(format!(
                "Couplings of {}: three are needed for error bars and for J of conditions left out.",
                counted(conditions)
            )));
        }
        let fit = &self.fitted.fit;
        if !fit.not_fed_back.is_empty() {
            let names = fit
                .not_fed_back
                .iter()
                .map(|&output| dataset.outputs()[output].name.as_str());
            remarks.push(caution(format!(
                "{} cannot be fed back: some input has no response of it in any condition.",
                names.collect::<Vec<_>>().join(", ")
            )));
        }
        remarks.extend(undetermined_words(dataset, &fit.undetermined).map(caution));
        let failed = self
            .conditions
            .iter()
            .filter_map(|(id, of)| Some((*id, of.poles.as_ref().err()?)));
        remarks.extend(
            failed.map(|(id, why)| caution(format!("Condition {id}: poles are not known: {why}."))),
        );
        let refused = self
            .conditions
            .iter()
            .flat_map(|(id, of)| of.refused.iter().map(move |refused| (*id, refused)));
        remarks.extend(refused.map(|(id, (model, why))| {
            caution(format!(
                "Condition {id}, {model}: what the couplings do to it is not known: {why}."
            ))
        }));
        remarks.extend(self.partly_left_out().map(caution));
        remarks
    }

    /// Lists the newly unstable poles of the representatives, and of the other kept models; poles
    /// in the band first.
    fn unstable_words(&self) -> Vec<Remark> {
        let remark = |is_representative: bool| {
            let poles: Vec<&UnstablePole> = self
                .unstable
                .iter()
                .filter(|of| of.is_representative == is_representative)
                .collect();
            let is_in_band = poles.iter().map(|of| of.is_in_band).max()?;
            let whose = if is_representative {
                "physics representatives"
            } else {
                "other kept physics models"
            };
            let places = unstable_places(&poles);
            let text = match poles.len() {
                1 => {
                    format!("A pole of the {whose} is newly unstable with the couplings: {places}.")
                }
                count => format!(
                    "{count} poles of {whose} are newly unstable with the couplings: {places}."
                ),
            };
            Some(Remark::new(
                if is_in_band {
                    RemarkKind::Trouble
                } else {
                    RemarkKind::Caution
                },
                text,
            ))
        };
        [true, false].into_iter().filter_map(remark).collect()
    }

    /// Names a condition whose omission leaves no couplings, and the number of such conditions.
    fn partly_left_out(&self) -> Option<String> {
        let all = self.fitted.problem.conditions.len();
        let known = self.left_out_fits.len();
        (all >= LEAST_CONDITIONS && known < all).then(|| {
            format!(
                "J of conditions left out and the bars of the couplings rest on {known} of {all} conditions: without each of the others \
                 no couplings or no schedule are found."
            )
        })
    }

    fn ringing_words(&self) -> Option<String> {
        let margins = self
            .conditions
            .iter()
            .filter_map(|(id, of)| Some((*id, of.margin?)));
        let (id, margin): (ConditionId, LoopMargin) =
            margins.min_by(|a, b| a.1.least.total_cmp(&b.1.least))?;
        margin.is_close_to_ringing().then(|| {
            format!(
                "The loop is close to ringing at {} rad/s: the least singular value of I − K H is {} (condition {id}).",
                telling(margin.omega_rad_s, 1),
                telling(margin.least, 2)
            )
        })
    }
}

/// Counts conditions: "1 condition", "11 conditions".
fn counted(conditions: usize) -> String {
    format!(
        "{conditions} condition{}",
        if conditions == 1 { "" } else { "s" }
    )
}

/// Returns whether a channel is an angular rate, by its unit.
fn is_rate(channel: &Channel) -> bool {
    ["deg/s", "rad/s", "°/s"].contains(&channel.unit.trim())
}

/// Returns whether a channel is an acceleration, by its unit.
fn is_acceleration(channel: &Channel) -> bool {
    matches!(
        channel.unit.trim(),
        "g" | "m/s^2" | "m/s²" | "m/s2" | "ft/s^2" | "ft/s²" | "ft/s2"
    )
}

/// Describes a mixing entry: "LAT takes 4.7 % of LON: as a swashplate phase of 2.7°".
fn mixing_words(dataset: &Dataset, of: &MixingShare) -> String {
    let [to, from] = [of.to, of.from].map(|input| &dataset.inputs()[input]);
    let share = if to.unit == from.unit {
        format!("{} % of {}", percent(of.share), from.name)
    } else {
        format!(
            "{} {} per {} of {}",
            telling(of.share, 3).replace('-', "−"),
            to.unit,
            from.unit,
            from.name
        )
    };
    let phase = of.swashplate_phase_deg.filter(|_| to.unit == from.unit);
    let phase = phase.map_or_else(String::new, |phase| {
        format!(
            ": as a swashplate phase of {}°",
            telling(phase, 1).replace('-', "−")
        )
    });
    format!("{} takes {share}{phase}.", to.name)
}

/// Describes a feedback entry: "PED follows NY by 1.2 % per m/s²: directional stiffness that the
/// physics model does not have".
fn feedback_words(dataset: &Dataset, of: &FeedbackShare) -> String {
    let input = &dataset.inputs()[of.input];
    let output = &dataset.outputs()[of.output];
    let is_of = |output: usize| dataset.on_axis()[Pair::new(output, of.input)];
    let has_rate =
        (0..dataset.outputs().len()).any(|at| is_of(at) && is_rate(&dataset.outputs()[at]));
    let meaning = match (is_of(of.output), has_rate) {
        (true, true) if is_acceleration(output) => "directional stiffness",
        (true, _) if is_rate(output) => "damping",
        _ => "a coupling",
    };
    // A share is meaningful only between channels with the same unit.
    let moved = &dataset.inputs()[of.moved];
    let share = if moved.unit == input.unit {
        format!("{} % of {}", percent(of.share), moved.name)
    } else {
        format!(
            "{} {} per {} of {}",
            telling(of.share, 3),
            input.unit,
            moved.unit,
            moved.name
        )
    };
    format!(
        "{} follows {} by {} {} per {}, up to {share} at {} rad/s: {meaning} that the physics model does not have right.",
        input.name,
        output.name,
        telling(of.entry, 3).replace('-', "−"),
        input.unit,
        output.unit,
        telling(of.omega_rad_s, 1)
    )
}

fn percent(share: f64) -> String {
    telling(100.0 * share, 1).replace('-', "−")
}

/// Locates unstable poles, grouped by condition: "in the band condition 4, slow at 2 rad/s;
/// condition 1, 8 models at 0.143 to 0.149 rad/s".
fn unstable_places(poles: &[&UnstablePole]) -> String {
    let mut places: BTreeMap<(bool, ConditionId), Vec<&UnstablePole>> = BTreeMap::new();
    poles.iter().for_each(|of| {
        places
            .entry((!of.is_in_band, of.condition))
            .or_default()
            .push(of)
    });
    let place = |((is_beyond, condition), of): (&(bool, ConditionId), &Vec<&UnstablePole>)| {
        let omega = || of.iter().map(|of| of.pole.norm());
        let [least, most] = [
            omega().fold(f64::INFINITY, f64::min),
            omega().fold(0.0, f64::max),
        ]
        .map(|at| telling(at, 3));
        let models = match of.as_slice() {
            of if of.iter().all(|of| of.is_representative) => String::new(),
            [one] => format!(", {}", one.model),
            of => format!(", {} models", of.len()),
        };
        let at = if least == most {
            least
        } else {
            format!("{least} to {most}")
        };
        format!(
            "{}condition {condition}{models} at {at} rad/s",
            if *is_beyond { "" } else { "in the band " }
        )
    };
    places.iter().map(place).collect::<Vec<_>>().join("; ")
}

/// Formats a pole: "−0.30 ± 1.20j rad/s".
fn pole_words(pole: Complex<f64>) -> String {
    let imaginary = pole.im.abs();
    let imaginary = if imaginary > 0.0 {
        format!(" ± {}j", telling(imaginary, 2))
    } else {
        String::new()
    };
    format!("{}{imaginary} rad/s", signed(pole.re, 3))
}

fn undetermined_words(dataset: &Dataset, unknowns: &[Unknown]) -> Option<String> {
    let (inputs, outputs) = dataset.names_of_channels();
    let name = |unknown: &Unknown| match *unknown {
        Unknown::Mixing { to, from, .. } => format!("{} of {}", inputs[to], inputs[from]),
        Unknown::Feedback { input, output } => format!("{} of {}", inputs[input], outputs[output]),
    };
    let names: Vec<String> = unknowns.iter().map(name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "No response says anything of these entries, which stay as without couplings: {}.",
            names.join(", ")
        )
    })
}

impl CouplingsAssessment {
    /// Returns the heading: "mixing and feedback of 11 conditions; its least-squares problem is
    /// solved to 3e-16".
    pub fn heading(&self) -> String {
        format!(
            "{} fitted to {}; the normal equations of the last solve hold to {:.0e}",
            self.couplings.name(),
            counted(self.fitted.problem.conditions.len()),
            self.fitted.fit.residual
        )
    }

    /// Returns the table of J on-axis and off-axis, without and with couplings.
    pub fn cost_table(&self) -> Table {
        let columns = [
            "mean J",
            "on-axis, without",
            "on-axis, with",
            "others, without",
            "others, with",
        ];
        let mut table = Table::new("", columns);
        let costs = &self.costs;
        let cell =
            |cost: Option<f64>| cost.map_or_else(|| "-".to_owned(), |cost| format!("{cost:.1}"));
        let mut row = |name: &str, without: AxisCost, with: AxisCost| {
            let cells = [without.on_axis, with.on_axis, without.others, with.others].map(cell);
            table.row(std::iter::once(name.to_owned()).chain(cells));
        };
        row("uncorrected", costs.uncorrected, AxisCost::default());
        row("own correction", costs.own.without, costs.own.with);
        row("scheduled", costs.scheduled.without, costs.scheduled.with);
        if let Some(left_out) = costs.left_out {
            row("condition left out", left_out.without, left_out.with);
        }
        table
    }

    /// Returns the mixing at the mean airspeed, and the feedback where there is one: for each input
    /// (row), the share of each input and output. An entry within its error bar is in brackets.
    pub fn matrix_tables(&self, dataset: &Dataset) -> Vec<Table> {
        let airspeed_kt = self.mean_airspeed_kt();
        let (inputs, outputs) = dataset.names_of_channels();
        let bars = if self.left_out_fits.is_empty() {
            String::new()
        } else {
            format!(
                ", ± bar of {} %, in brackets within it",
                number(100.0 * self.level)
            )
        };
        let mixing = format!(
            "Mixing at {} kt: share of each input that an input takes{bars}",
            telling(airspeed_kt, 0)
        );
        let mut tables = vec![matrix_table(
            mixing,
            &inputs,
            &inputs,
            &self.mixing(airspeed_kt),
        )];
        let feedback = self.feedback();
        if feedback.iter().any(|entry| entry.value != 0.0) {
            let of_unit = |(name, channel): (&String, &gdcm_model::dataset::Channel)| {
                format!("{name} [{}]", channel.unit)
            };
            let to: Vec<String> = inputs.iter().zip(dataset.inputs()).map(of_unit).collect();
            let from: Vec<String> = outputs.iter().zip(dataset.outputs()).map(of_unit).collect();
            let title = format!("Feedback: units of an input for each unit of an output{bars}");
            tables.push(matrix_table(title, &to, &from, &feedback));
        }
        tables
    }

    /// Returns the poles of each condition's physics representative before and after, largest shift
    /// first.
    pub fn pole_table(&self) -> Table {
        let columns = [
            "condition",
            "before [rad/s]",
            "after [rad/s]",
            "moved by [rad/s]",
        ];
        let mut table = Table::new(
            "Poles of the physics representatives, without couplings and with them",
            columns,
        );
        let pole = |of: nalgebra::Complex<f64>| {
            let imaginary = if of.im == 0.0 {
                String::new()
            } else {
                format!(" ± {}j", telling(of.im.abs(), 3))
            };
            format!("{}{imaginary}", telling(of.re, 3).replace('-', "−"))
        };
        for (id, of) in &self.conditions {
            let mut shifts: Vec<_> = of.poles.iter().flatten().collect();
            shifts.sort_by(|a, b| {
                b.distance_rad_s()
                    .unwrap_or(0.0)
                    .total_cmp(&a.distance_rad_s().unwrap_or(0.0))
            });
            for shift in shifts {
                let moved = shift
                    .distance_rad_s()
                    .map_or_else(|| "-".to_owned(), |distance| telling(distance, 3));
                let before = shift.before.map_or_else(|| "-".to_owned(), pole);
                table.row([id.to_string(), before, pole(shift.after), moved]);
            }
        }
        table
    }
}

fn matrix_table(
    title: String,
    to: &[String],
    from: &[String],
    entries: &DMatrix<CouplingEntry>,
) -> Table {
    let mut table = Table::new(
        title,
        std::iter::once("to".to_owned()).chain(from.iter().cloned()),
    );
    for (row, name) in to.iter().enumerate() {
        let cells = (0..from.len()).map(|column| entry_words(&entries[(row, column)]));
        table.row(std::iter::once(name.clone()).chain(cells));
    }
    table
}

/// Formats an entry: "0.047 ± 0.011", in brackets where it is within its error bar.
fn entry_words(entry: &CouplingEntry) -> String {
    let value = telling(entry.value, 3).replace('-', "−");
    let bar = entry.half_width.filter(|half_width| *half_width > 0.0);
    let text = bar.map_or_else(
        || value.clone(),
        |bar| format!("{value} ± {}", telling(bar, 3)),
    );
    if entry.is_within_bar && entry.value != 0.0 {
        format!("({text})")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::dataset::DatasetHeader;

    use super::*;
    use crate::results::couplings_tests::EXAMPLE;

    #[test]
    fn a_share_of_a_stick_in_another_unit_is_no_percentage() {
        let old = &EXAMPLE.dataset;
        let share = FeedbackShare {
            input: 2,
            output: 5,
            entry: 0.092,
            share: 0.106,
            moved: 0,
            condition: ConditionId(1),
            omega_rad_s: 0.5,
        };
        let words = feedback_words(old, &share);
        assert!(
            words.contains("up to 10.6 % of LON at 0.5 rad/s"),
            "{words}"
        );
        let mut inputs = old.inputs().to_vec();
        inputs[0].unit = "inch".into();
        let header = DatasetHeader {
            name: old.name().into(),
            description: String::new(),
            inputs,
            outputs: old.outputs().to_vec(),
            on_axis: old.on_axis().clone(),
            band: old.band(),
        };
        let conditions = old.conditions().iter().map(|of| (**of).clone()).collect();
        let words = feedback_words(&Dataset::new(header, conditions).unwrap(), &share);
        assert!(
            words.contains("up to 0.106 % per inch of LON at 0.5 rad/s"),
            "{words}"
        );
    }
}
