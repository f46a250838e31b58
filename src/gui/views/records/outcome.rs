//! The outcome of an identification, with a button beside each caution that has a remedy.

use std::sync::Arc;

use egui::{Label, ProgressBar, RichText, Ui};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::simulation::Signal;
use gdcm_model::units::s_to_ms;
use gdcm_study::decisions::adopted_models::OfferedModels;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_sysid::diagnostics::model_doubts::HELD_OUT;
use gdcm_sysid::diagnostics::record_fault::{ContradictingRecord, RecordFault};
use gdcm_sysid::identification::{
    ChannelPreparation, Hold, Identification, IdentificationCaution, IdentificationError,
};
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::spectra::record_cautions::RecordCaution;
use gdcm_words::channel_time_skew::time_skew_text;

use super::frame_cache::{Source, kept};
use super::page::Page;
use super::record_list::{BAD, CHI_SQUARED};
use super::{ORDERS, REFERENCES, possible_references};
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Shows the progress of the identification, or its outcome.
pub(super) fn outcome_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    ui.add_space(6.0);
    if let Some([low, high]) = records.band {
        ui.label(palette.small(format!(
            "Band from {low:.2} to {high:.1} rad/s, not the study's"
        )));
        actions_ui(
            ui,
            vec![(
                "Use the study's band".to_owned(),
                RecordsCommand::SetBand(None).into(),
            )],
            commands,
        );
    }
    if let Some(job) = state.records.running(state.condition().id()) {
        let told = job.news();
        let (part, step) = if told.step.is_empty() {
            (
                0.0,
                state.records.under_way().map_or_else(String::new, |of| {
                    format!("Waits for condition {}", of.condition)
                }),
            )
        } else {
            let (done, total) = state.results.background.identification.unwrap_or((0, 0));
            (done as f32 / total.max(1) as f32, told.step)
        };
        ui.add(ProgressBar::new(part).desired_height(6.0));
        ui.label(palette.small(step));
        if told.first_model.is_some() {
            ui.label(palette.small("The first model is drawn; it is being refined"));
        }
        return;
    }
    match &records.found {
        None => {}
        Some((job, Err(why))) => {
            ui.add(Label::new(RichText::new(why.to_string()).color(palette.warning)).wrap());
            actions_ui(
                ui,
                band_action(why, job.request.options.band)
                    .into_iter()
                    .collect(),
                commands,
            );
        }
        Some((_, Ok(found))) => {
            if records.changed {
                ui.label(palette.small_warning("Out of date: records or settings changed"));
            }
            summary_ui(ui, found, palette);
            for caution in &found.cautions {
                let actions = actions(ui, records, caution);
                caution_ui(ui, (&caution.to_string(), actions), palette, commands);
            }
            late_channel_ui(ui, page, commands);
        }
    }
}

/// Shows a menu for the choice of models to use.
pub(super) fn offered_menu_ui(
    ui: &mut Ui,
    (text, hint): (&str, &str),
    take: impl FnOnce(OfferedModels),
) {
    let menu = ui.menu_button(text, |ui| {
        let choices = [
            ("The refined models", OfferedModels::REFINED),
            (
                "The refined models, and CT-PBSID (unrefined)",
                OfferedModels::WITH_UNREFINED,
            ),
            ("The measured response", OfferedModels::MEASURED),
        ];
        let chosen = choices
            .into_iter()
            .find(|(words, _)| ui.button(*words).clicked())?;
        ui.close();
        Some(chosen.1)
    });
    menu.response.on_hover_text(hint);
    if let Some(offered) = menu.inner.flatten() {
        take(offered);
    }
}

fn summary_ui(ui: &mut Ui, found: &Identification, palette: &Palette) {
    let order = found.refined.order().unwrap_or_default();
    ui.label(RichText::new(format!("CT-PBSID, refined: order {order}")).strong());
    let color = |is_good: bool| {
        if is_good {
            palette.text
        } else {
            palette.warning
        }
    };
    ui.horizontal_wrapped(|ui| {
        ui.label("χ²/dof");
        ui.label(RichText::new(format!("{:.2}", found.cost)).color(color(found.cost <= BAD)))
            .on_hover_text(CHI_SQUARED);
        if let Some((raw, moved)) = found.held_out_cost.zip(found.held_out_normalised) {
            ui.label("· held out");
            let text = RichText::new(format!("{moved:.2} ({raw:.2})")).color(color(moved <= HELD_OUT[1]));
            ui.label(text).on_hover_text(
                "The same over the records that were held out, where the model may move within its own uncertainty, and as it is: the \
                 sharp test. Up to 1.3 is good",
            );
        }
    });
    ui.label(palette.small(format!(
        "Laguerre pole {:.2} rad/s, past window {}; {} models in the bundle",
        found.laguerre_pole,
        found.past,
        1 + found.bundle.len(),
    )));
}

/// Shows a caution and its remedies.
fn caution_ui(
    ui: &mut Ui,
    (words, actions): (&str, Vec<Action>),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.add_space(3.0);
    ui.add(
        Label::new(
            RichText::new(format!("⚠ {words}"))
                .size(SMALL_SIZE)
                .color(palette.text),
        )
        .wrap(),
    );
    actions_ui(ui, actions, commands);
}

/// Shows a caution about a channel with the same delay in all records, which only a physics model
/// can reveal.
fn late_channel_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some((job, Ok(found))) = &records.found else {
        return;
    };
    let dataset = state.dataset();
    let condition = state.condition();
    let Some(physics) = condition
        .bundle(BundleKind::Physics)
        .get(condition.nominal())
    else {
        return;
    };
    let sources: [Source; 2] = [Arc::clone(found) as _, Arc::clone(condition) as _];
    let of_condition =
        || ChannelTimeSkew::of_condition(&found.measured, job.request.options.band, condition);
    let Some(late) = *kept(ui, "late channel", &sources, (), of_condition) else {
        return;
    };
    let Some(signal) = late.signal(dataset) else {
        return;
    };
    let words = time_skew_text(&late, &signal.name, &physics.name);
    caution_ui(
        ui,
        (&words, vec![taken_out(records, &signal, late.delay_s)]),
        palette,
        commands,
    );
}

/// Removes a delay from a channel, in addition to the delay already removed when it was found.
fn taken_out(records: &ConditionRecords, signal: &Signal, delay_s: f64) -> Action {
    let known = records
        .found
        .as_ref()
        .and_then(|(job, _)| job.request.options.preparation.channel(signal));
    let delay_s = known.map_or(0.0, |channel| channel.delay_s) + delay_s;
    let text = format!("Remove {:.0} ms from {}", s_to_ms(delay_s), signal.name);
    (
        text,
        RecordsCommand::SetDelay(signal.clone(), delay_s).into(),
    )
}

/// Removes a fault from a record, in addition to earlier remedies.
fn put_right(records: &ConditionRecords, of: &ContradictingRecord) -> Option<Action> {
    let ContradictingRecord {
        record,
        name,
        fault,
    } = of;
    let row = records.row_of_record(*record)?;
    let fault = fault.as_ref()?;
    let mut layout = records.rows[row].layout.clone();
    let signal = |(index, channel): (usize, &ChannelPreparation)| {
        let role = ChannelSide::Output;
        let name = channel.name.clone();
        Signal { role, index, name }
    };
    let outputs: Vec<Signal> = records.outputs.iter().enumerate().map(signal).collect();
    let mut after = |(signal, remedy): (Signal, ChannelRemedy)| {
        let used = layout.channel_mut(signal.role, signal.index)?;
        Some((signal, used.remedy.then(remedy)))
    };
    let remedies: Vec<(Signal, ChannelRemedy)> = fault
        .remedies(&outputs)
        .into_iter()
        .filter_map(&mut after)
        .collect();
    let words = match fault {
        RecordFault::OutputsLate(delay_s) => format!(
            "Remove {:.0} ms from the outputs of {name}",
            s_to_ms(*delay_s)
        ),
        RecordFault::Late(signal, delay_s) => {
            format!("Remove {:.0} ms from {signal} of {name}", s_to_ms(*delay_s))
        }
        RecordFault::Gain(signal, factor) if *factor < 0.0 => format!("Turn {signal} of {name}"),
        RecordFault::Gain(signal, factor) => format!("Multiply {signal} of {name} by {factor:.2}"),
    };
    Some((words, RecordsCommand::SetRemedies(row, remedies).into()))
}

/// Label and command of a button.
type Action = (String, Command);

fn actions_ui(ui: &mut Ui, actions: Vec<Action>, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        for (text, command) in actions {
            ui.small_button(text).asks(command, commands);
        }
    });
}

/// Proposes another band if an identification without a model needs one.
fn band_action(why: &IdentificationError, [lowest, highest]: [f64; 2]) -> Option<Action> {
    match why {
        IdentificationError::TooShort { enough, .. } if *enough < highest => {
            Some(narrower([*enough, highest]))
        }
        IdentificationError::SampledTooSlowly { limit, .. } if *limit > lowest => {
            Some(narrower([lowest, *limit]))
        }
        _ => None,
    }
}

fn narrower(band: [f64; 2]) -> Action {
    let text = format!("Identify from {:.2} to {:.1} rad/s", band[0], band[1]);
    (text, RecordsCommand::SetBand(Some(band)).into())
}

/// Returns the remedies of a caution; empty if only another flight helps.
fn actions(ui: &Ui, records: &ConditionRecords, caution: &IdentificationCaution) -> Vec<Action> {
    let show = |text: &str, page| (text.to_owned(), RecordsCommand::Show(page).into());
    let order = || {
        (
            "Say an order…".to_owned(),
            RecordsCommand::ShowAdvanced(ORDERS).into(),
        )
    };
    match caution {
        IdentificationCaution::Records(caution) => actions_on_records(records, caution),
        IdentificationCaution::UnlikeRecord { name, .. }
        | IdentificationCaution::Inadequate { record: name, .. } => {
            leave_out(records, name).into_iter().collect()
        }
        IdentificationCaution::Contradiction { records: of, .. } => {
            let mended = of.iter().filter_map(|of| put_right(records, of));
            mended
                .chain(of.iter().filter_map(|of| leave_out(records, &of.name)))
                .collect()
        }
        IdentificationCaution::Short {
            lowest, periods, ..
        } => longer(records, lowest / periods).into_iter().collect(),
        IdentificationCaution::BandNotShown { shown: band, .. }
        | IdentificationCaution::OrderLimit { narrower: band, .. } => vec![narrower(*band)],
        IdentificationCaution::NotSwept { .. } | IdentificationCaution::MovedTogether { .. } => {
            vec![show("Show the inputs", RecordsPage::Inputs)]
        }
        IdentificationCaution::Feedback { .. } => by_reference(ui, records),
        IdentificationCaution::LeavesPoints { output, input, .. } => {
            let pair = Pair {
                output: output.index,
                input: input.index,
            };
            vec![
                (
                    format!("Show {output}/{input}"),
                    Command::Selection(SelectionCommand::FocusPair(pair)),
                ),
                order(),
            ]
        }
        IdentificationCaution::HeldOut {
            records: held_out, ..
        } => held_out
            .iter()
            .flat_map(|name| {
                fit_too(records, name)
                    .into_iter()
                    .chain(leave_out(records, name))
            })
            .collect(),
        IdentificationCaution::Unstable { .. } => {
            vec![show("Show its poles", RecordsPage::Poles), order()]
        }
        _ => Vec::new(),
    }
}

/// Returns the remedies of a caution about the records themselves.
fn actions_on_records(records: &ConditionRecords, caution: &RecordCaution) -> Vec<Action> {
    let inputs = || {
        (
            "Show the inputs".to_owned(),
            RecordsCommand::Show(RecordsPage::Inputs).into(),
        )
    };
    let columns = || {
        (
            "Say its column and factor…".to_owned(),
            RecordsCommand::Show(RecordsPage::Columns).into(),
        )
    };
    match caution {
        RecordCaution::SampleHold { signal, hold_s, .. } => {
            let hold_s = *hold_s;
            let set = |text: &str, hold| {
                (
                    text.to_owned(),
                    RecordsCommand::SetHold(signal.clone(), hold).into(),
                )
            };
            let command = (signal.role == ChannelSide::Input).then(|| {
                set(
                    &format!("{} is a held command", signal.name),
                    Hold::Command { hold_s },
                )
            });
            let others = [
                set(
                    &format!("{} is a slow sensor", signal.name),
                    Hold::FreshSamples,
                ),
                set(&format!("{} is right as it is", signal.name), Hold::Acts),
            ];
            command.into_iter().chain(others).collect()
        }
        RecordCaution::AtLimit { record, .. } | RecordCaution::Stuck { record, .. } => {
            leave_out(records, record).into_iter().collect()
        }
        RecordCaution::MovedTogether { .. } => vec![inputs()],
        RecordCaution::UnlikelyUnit { .. } | RecordCaution::Copy { .. } => vec![columns()],
        _ => Vec::new(),
    }
}

/// Leaves a record out if another one remains for the fit.
fn leave_out(records: &ConditionRecords, name: &str) -> Option<Action> {
    let (index, _) = records
        .used_rows()
        .find(|(_, row)| row.table.name == name)?;
    let is_other = |(at, row): (usize, &LaidOutRecord)| at != index && !row.guess.held_out;
    let text = || format!("Leave {name} out");
    records
        .used_rows()
        .any(is_other)
        .then(|| (text(), RecordsCommand::SetUsed(index, false).into()))
}

/// Includes a held-out record in the fit.
fn fit_too(records: &ConditionRecords, name: &str) -> Option<Action> {
    let (index, _) = records
        .used_rows()
        .find(|(_, row)| row.table.name == name)?;
    Some((
        format!("Fit {name} too"),
        RecordsCommand::SetHeldOut(index, false).into(),
    ))
}

/// Proposes a band whose lowest frequency has five periods in the longest record; the frequency
/// `once` \[rad/s\] has one period.
fn longer(records: &ConditionRecords, once: f64) -> Option<Action> {
    /// Slightly more than five, so that rounding does not repeat the caution.
    const PERIODS: f64 = 5.001;
    let (job, _) = records.found.as_ref()?;
    let [_, highest] = job.request.options.band;
    (PERIODS * once < highest).then(|| narrower([PERIODS * once, highest]))
}

/// Maximum number of references with their own button.
const MOST_REFERENCES: usize = 3;

/// Proposes the references suggested by column names, and the list of all columns.
fn by_reference(ui: &Ui, records: &ConditionRecords) -> Vec<Action> {
    let possible = possible_references(ui, records);
    let named = possible
        .iter()
        .filter(|(_, is_named)| *is_named)
        .take(MOST_REFERENCES);
    let take = |(name, _): &(String, bool)| {
        (
            format!("By way of {name}"),
            RecordsCommand::SetReferences(vec![name.clone()]).into(),
        )
    };
    let other = (
        "Say a reference…".to_owned(),
        RecordsCommand::ShowAdvanced(REFERENCES).into(),
    );
    named
        .map(take)
        .chain([other].into_iter().filter(|_| !possible.is_empty()))
        .collect()
}
