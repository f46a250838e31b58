//! How the phase is corrected: none, delay, delay or lead (M15).

use egui::{RichText, Ui};

use gdcm_core::response::LeadOrder;
use gdcm_core::study::{DelayFrom, Edit, LEAD_LIMITS, LEAD_POLES, PhaseCorrection, Setting};

use super::command::Command;
use super::number_field::{Entered, NumberField};
use super::palette::{Palette, SMALL_SIZE};
use super::settings_panel::choice_ui;
use super::state::State;

/// M15 in five lines.
const IN_SHORT: &str = "1  For each response, one straight line through the origin is fitted to the phase that is missing over the band: its \
                        slope is a delay or, where negative, a lead.\n\
                        2  Each channel gets one signed delay τ, so that the held responses get exactly theirs.\n\
                        3  A positive τ is a pure delay; a negative τ is a filter that acts as a faster servo or sensor put in \
                        place of a slower one.\n\
                        4  Then the gains are found as before, on what is left.\n\
                        5  The price is gain above the band: it is told in dB.";

/// The choice, and below it what belongs to it.
pub(super) fn phase_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = &state.study.settings;
    let (mut phase, mut from) = (settings.phase, settings.delay_from);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Phase").color(palette.dim_text)).on_hover_text(format!("Delay or lead:\n{IN_SHORT}"));
        let phases = [
            (PhaseCorrection::None, "none", "Gains alone"),
            (PhaseCorrection::Delay, "delay", "Each channel gets a delay, eq. (11) (the paper)"),
            (
                PhaseCorrection::Lead,
                "delay or lead",
                "Each channel gets one signed delay; a negative one is a filter that acts as a faster servo (M15)",
            ),
        ];
        choice_ui(ui, "Phase correction", &mut phase, &phases);
        if settings.phase == PhaseCorrection::Delay {
            ui.label(RichText::new("D from").size(SMALL_SIZE).color(palette.dim_text));
            let sources = [
                (DelayFrom::Median, "eq. (9)", "Median of Δφ/ω over the band (the paper)"),
                (DelayFrom::Band, "band", "Straight line of least squares through Δφ over the band (M15.2)"),
            ];
            choice_ui(ui, "D of the delays", &mut from, &sources);
        }
    });
    let changed = [
        (phase != settings.phase).then_some(Setting::Phase(phase)),
        (from != settings.delay_from).then_some(Setting::DelayFrom(from)),
    ];
    commands.extend(changed.into_iter().flatten().map(|setting| Command::from(Edit::Set(setting))));
    if settings.phase == PhaseCorrection::Lead {
        filters_ui(ui, state, palette, commands);
    }
}

/// What the lead filters have in common.
fn filters_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let lead = state.study.settings.lead;
    let mut order = lead.order;
    let hint =
        "Lag of every lead filter: 1/(n ω_B), ω_B the top of the band; smaller: less noise, and more lead in reach";
    let pole =
        NumberField { step: 0.05, ..NumberField::new("n of the lead filters", hint, LEAD_POLES[0]..=LEAD_POLES[1]) };
    let hint =
        "Greatest gain of one channel's filter far above the band (10 is 20 dB): it bounds the lead of a channel";
    let limit = NumberField {
        step: 0.1,
        ..NumberField::new("R_max of the lead filters", hint, LEAD_LIMITS[0]..=LEAD_LIMITS[1])
    };
    let small = |ui: &mut Ui, text: &str| ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
    let (pole, limit) = ui
        .horizontal(|ui| {
            small(ui, "Lead: order");
            let orders = [
                (LeadOrder::Second, "2", "Butterworth damping: the gain within the band stays"),
                (LeadOrder::First, "1", "(1 + as)/(1 + bs): the gain rises within the band"),
            ];
            choice_ui(ui, "Order of the lead filters", &mut order, &orders);
            small(ui, "n");
            let pole = pole.ui(ui, lead.pole);
            small(ui, "R_max");
            (pole, limit.ui(ui, lead.limit))
        })
        .inner;
    if order != lead.order {
        commands.push(Edit::Set(Setting::LeadOrder(order)).into());
    }
    take(pole, Setting::LeadPole, commands);
    take(limit, Setting::LeadLimit, commands);
}

fn take(entered: Entered, setting: fn(f64) -> Setting, commands: &mut Vec<Command>) {
    commands.extend(entered.value.map(|value| Command::from(Edit::Set(setting(value)))));
    commands.extend(entered.refusal.map(Command::Refuse));
    if entered.is_ended {
        commands.push(Command::EndEdit);
    }
}
