//! What came of an identification, in words, with a button beside each caution that something can be done about.

use std::sync::Arc;

use egui::{Label, ProgressBar, RichText, Ui};

use crate::view::{Command, Palette, SMALL_SIZE};
use gdcm_core::dataset::{BundleKind, ChannelRemedy, ChannelSide};
use gdcm_core::identification::{
    ChannelPreparation, HELD_OUT, Hold, Identification, IdentificationCaution, IdentificationError, RecordCaution,
    RecordFault, Signal,
};
use gdcm_core::study::{ChannelTimeSkew, OfferedModels};
use gdcm_core::units::s_to_ms;

use super::{BAD, CHI_SQUARED, ConditionRecords, Page, RecordsCommand, Source, kept};

/// How far the identification is, or what came of it.
pub(super) fn outcome_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page { state, records, palette } = page;
    ui.add_space(6.0);
    let with_records = state.records.conditions.values().filter(|of| of.used_rows().next().is_some()).count();
    if with_records > 1 && state.records.running.is_empty() {
        let all = format!("Identify all {with_records} conditions");
        if ui.button(all).on_hover_text("One after the other, beside the live answer").clicked() {
            commands.push(RecordsCommand::IdentifyAll.into());
        }
        let found = state.records.conditions.values().filter(|of| of.identification().is_some()).count();
        if found > 1 {
            let hint = "In place of the identified models of these conditions; one step to undo";
            let take = format!("Use the models of {found} conditions");
            offered_menu_ui(ui, (&take, hint), |offered| commands.push(RecordsCommand::TakeAll(offered).into()));
        }
    }
    if let Some([low, high]) = records.band {
        ui.label(palette.small(format!("Band from {low:.2} to {high:.1} rad/s, not the study's")));
        actions_ui(ui, vec![("Use the study's band".to_owned(), RecordsCommand::SetBand(None))], commands);
    }
    if let Some(job) = state.records.running(state.condition().id()) {
        let told = job.told();
        let (part, step) = if told.step.is_empty() {
            (
                0.0,
                state
                    .records
                    .under_way()
                    .map_or_else(String::new, |of| format!("Waits for condition {}", of.condition)),
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
            actions_ui(ui, band_action(why, job.request.options.band).into_iter().collect(), commands);
        }
        Some((_, Ok(found))) => {
            if records.changed {
                ui.label(palette.small_warning("Out of date: records or settings changed"));
            }
            summary_ui(ui, found, palette);
            for caution in &found.cautions {
                caution_ui(ui, (&caution.to_string(), actions(records, caution)), palette, commands);
            }
            late_channel_ui(ui, page, commands);
        }
    }
}

/// A button that asks which of the models are taken.
pub(super) fn offered_menu_ui(ui: &mut Ui, (text, hint): (&str, &str), take: impl FnOnce(OfferedModels)) {
    let menu = ui.menu_button(text, |ui| {
        let choices = [
            ("The refined models", OfferedModels::REFINED),
            ("The refined models, and CT-PBSID (unrefined)", OfferedModels::WITH_UNREFINED),
            ("The measured response", OfferedModels::MEASURED),
        ];
        let chosen = choices.into_iter().find(|(words, _)| ui.button(*words).clicked())?;
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
    let color = |is_good: bool| if is_good { palette.text } else { palette.warning };
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

/// A caution in its words, and what can be done about it.
fn caution_ui(ui: &mut Ui, (words, actions): (&str, Vec<Action>), palette: &Palette, commands: &mut Vec<Command>) {
    ui.add_space(3.0);
    ui.add(Label::new(RichText::new(format!("⚠ {words}")).size(SMALL_SIZE).color(palette.text)).wrap());
    actions_ui(ui, actions, commands);
}

/// A channel that is late in all records alike, which only a physics model can tell.
fn late_channel_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page { state, records, palette } = page;
    let Some((job, Ok(found))) = &records.found else { return };
    let (dataset, condition) = (state.dataset(), state.condition());
    let Some(physics) = condition.bundle(BundleKind::Physics).get(condition.nominal()) else { return };
    let sources: [Source; 2] = [Arc::clone(found) as _, Arc::clone(condition) as _];
    let of_condition = || ChannelTimeSkew::of_condition(&found.measured, job.request.options.band, condition);
    let Some(late) = *kept(ui, "late channel", &sources, (), of_condition) else { return };
    let Some(signal) = late.signal(dataset) else { return };
    let words = late.words(&signal.name, &physics.name);
    caution_ui(ui, (&words, vec![taken_out(records, &signal, late.delay_s)]), palette, commands);
}

/// Takes a delay out of a channel, beside what had been taken out of it when that was found.
fn taken_out(records: &ConditionRecords, signal: &Signal, delay_s: f64) -> Action {
    let known = records.found.as_ref().and_then(|(job, _)| job.request.options.preparation.channel(signal));
    let delay_s = known.map_or(0.0, |channel| channel.delay_s) + delay_s;
    let text = format!("Remove {:.0} ms from {}", s_to_ms(delay_s), signal.name);
    (text, RecordsCommand::SetDelay(signal.clone(), delay_s))
}

/// Takes what is wrong with a record out of it, besides what had been taken out.
fn put_right(records: &ConditionRecords, record: usize, name: &str, fault: &RecordFault) -> Option<Action> {
    let row = records.row_of_record(record)?;
    let mut layout = records.rows[row].layout.clone();
    let signal = |(index, channel): (usize, &ChannelPreparation)| {
        let (role, name) = (ChannelSide::Output, channel.name.clone());
        Signal { role, index, name }
    };
    let outputs: Vec<Signal> = records.outputs.iter().enumerate().map(signal).collect();
    let mut after = |(signal, remedy): (Signal, ChannelRemedy)| {
        let used = layout.channel_mut(signal.role, signal.index)?;
        Some((signal, used.remedy.then(remedy)))
    };
    let remedies: Vec<(Signal, ChannelRemedy)> = fault.remedies(&outputs).into_iter().filter_map(&mut after).collect();
    let words = match fault {
        RecordFault::OutputsLate(delay_s) => format!("Remove {:.0} ms from the outputs of {name}", s_to_ms(*delay_s)),
        RecordFault::Late(signal, delay_s) => format!("Remove {:.0} ms from {signal} of {name}", s_to_ms(*delay_s)),
        RecordFault::Gain(signal, factor) if *factor < 0.0 => format!("Turn {signal} of {name}"),
        RecordFault::Gain(signal, factor) => format!("Multiply {signal} of {name} by {factor:.2}"),
    };
    Some((words, RecordsCommand::SetRemedies(row, remedies)))
}

/// What a button says, and what it asks for.
type Action = (String, RecordsCommand);

fn actions_ui(ui: &mut Ui, actions: Vec<Action>, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        for (text, command) in actions {
            if ui.small_button(text).clicked() {
                commands.push(command.into());
            }
        }
    });
}

/// Another band, where that is what an identification without a model needs.
fn band_action(why: &IdentificationError, [lowest, highest]: [f64; 2]) -> Option<Action> {
    match why {
        IdentificationError::TooShort { enough, .. } if *enough < highest => Some(narrower([*enough, highest])),
        IdentificationError::SampledTooSlowly { limit, .. } if *limit > lowest => Some(narrower([lowest, *limit])),
        _ => None,
    }
}

fn narrower(band: [f64; 2]) -> Action {
    let text = format!("Identify from {:.2} to {:.1} rad/s", band[0], band[1]);
    (text, RecordsCommand::SetBand(Some(band)))
}

fn actions(records: &ConditionRecords, caution: &IdentificationCaution) -> Vec<Action> {
    let leave_out = |record: usize, name: &str| {
        let row = records.row_of_record(record);
        row.map(|row| (format!("Leave {name} out"), RecordsCommand::SetUsed(row, false)))
    };
    match caution {
        IdentificationCaution::UnlikeRecord { record, name, .. } => leave_out(*record, name).into_iter().collect(),
        IdentificationCaution::Contradiction { records: of, fault, .. } => {
            let mended = of.last().zip(fault.as_ref());
            let mended = mended.and_then(|((record, name), fault)| put_right(records, *record, name, fault));
            mended.into_iter().chain(of.iter().filter_map(|(record, name)| leave_out(*record, name))).collect()
        }
        IdentificationCaution::BandNotShown { shown: band, .. }
        | IdentificationCaution::OrderLimit { narrower: band, .. } => vec![narrower(*band)],
        IdentificationCaution::Records(RecordCaution::SampleHold { signal, hold_s, .. }) => {
            let hold_s = *hold_s;
            let set = |text: &str, hold| (text.to_owned(), RecordsCommand::SetHold(signal.clone(), hold));
            let command = (signal.role == ChannelSide::Input)
                .then(|| set(&format!("{} is a held command", signal.name), Hold::Command { hold_s }));
            let others = [
                set(&format!("{} is a slow sensor", signal.name), Hold::FreshSamples),
                set(&format!("{} is right as it is", signal.name), Hold::Acts),
            ];
            command.into_iter().chain(others).collect()
        }
        _ => Vec::new(),
    }
}
