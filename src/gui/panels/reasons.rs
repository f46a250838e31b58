//! Reasons for the displayed result: remarks, possible causes of a lag, leads, proof. They are
//! drawn in the right panel below the verdict, instead of result and matrix, so that no plot to
//! which they point is covered.
//!
//! A remark is a finding about the result, with a remedy if there is one. Leads are filters that
//! advance the phase (M15: docs/lead.md); couplings mix the inputs and feed outputs back to them
//! (M16: docs/couplings.md). The proof is a lower bound on the objective of the gains; the gap is
//! their relative difference.

use egui::{Align, Button, CollapsingHeader, Layout, Rect, RichText, Role, ScrollArea, Ui, vec2};

use gdcm_method::correction::sensitivity::kkt_residual;
use gdcm_method::correction::{GainObjective, Outcome, Quantity};
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::{telling, with_minus_sign};
use gdcm_model::units::s_to_ms;
use gdcm_study::decisions::setting_table;
use gdcm_study::results::coupling_remark_search::coupling_offer;
use gdcm_study::results::median_lags::MedianLag;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{ConditionAnalysis, Edit};
use gdcm_words::caution::failure_text;
use gdcm_words::derivation::ExplainTarget;
use gdcm_words::leads::lead_words;
use gdcm_words::remark::remark_text;
use gdcm_words::solution_details::details;

use super::advice::{INSPECT, USE_COUPLINGS, phase_step_label};
use super::derivation_sheet::value_label_ui;
use super::sign_reversal::sign_reversal_entry;
use super::suggested_runs_list::suggested_runs_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::offered_couplings;
use crate::gui::views::shown_remarks::remarks_shown;
use crate::gui::widgets::controls::{Asks, button_ui, named};
use crate::gui::widgets::escape_key::take_escape;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Tooltip on a button that decides for every condition.
const EVERYWHERE: &str = "In every condition; can be undone";

/// Possible cause of a common lag; removing the cause is better than correcting the lag.
struct Cause {
    title: &'static str,
    symptom: &'static str,
    /// Channels whose median lags distinguish this cause from others.
    compares: Option<ChannelSide>,
    /// View that shows the symptom.
    view: View,
}

const CAUSES: [Cause; 4] = [
    Cause {
        title: "Record clock",
        symptom: "Outputs stamped early, or inputs stamped late, make the physics model lag by the same \
            time in every response.",
        compares: None,
        view: View::Records,
    },
    Cause {
        title: "Integration and sampling",
        symptom: "A simulation that delays its outputs by one step lags by that step in every response.",
        compares: None,
        view: View::Error,
    },
    Cause {
        title: "Servos",
        symptom: "A servo model that is too slow lags in every response to its input, and in no other.",
        compares: Some(ChannelSide::Input),
        view: View::Channels,
    },
    Cause {
        title: "Sensors and their filters",
        symptom: "A sensor model that is too slow lags in every response at its output, and in no other.",
        compares: Some(ChannelSide::Output),
        view: View::Channels,
    },
];

/// Draws the reasons with their heading; Escape closes them.
pub fn reasons_inspector_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(Sheet::Reasons.title()).font(medium(BODY_SIZE)));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let close = named(ui.small_button("×"), Role::Button, "Close the sheet");
            if close.clicked() || take_escape(ui.ctx()) {
                commands.push(LayoutCommand::ShowSheet(None).into());
            }
        });
    });
    ui.add_space(4.0);
    ui.spacing_mut().item_spacing.y = 4.0;
    ScrollArea::vertical()
        .id_salt("reasons")
        .auto_shrink([false, false])
        .show(ui, |ui| reasons_ui(ui, state, palette, commands));
}

/// Draws the reasons for the displayed result, or why there is none:
///
/// 1. remarks with their remedies, worthwhile couplings, suggested runs;
/// 2. possible sources of a lag, if delays are not matched or leads are in use; the leads;
/// 3. the proof of optimality, the objectives, and details about the solution.
fn reasons_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let shown = match state.outcome() {
        Some(Ok(shown)) => shown,
        Some(Err(failure)) => {
            ui.label(failure_text(failure, state.dataset()));
            return;
        }
        None => {
            ui.label(state.results.absence());
            return;
        }
    };
    // Step 1.
    remarks_ui(ui, state, &remarks_shown(state, shown), palette, commands);
    couplings_offer_ui(ui, state, palette, commands);
    suggested_runs_ui(ui, state, palette, commands);
    // Step 2.
    if !shown.delays.matched || shown.has_leads() {
        causes_ui(ui, state, shown, palette, commands);
    }
    lead_ui(ui, state, shown, palette);
    // Step 3.
    section_ui(ui, "Proof");
    proof_ui(ui, shown, state.is_proving(shown), palette);
    objective_ui(ui, shown, palette, commands);
    for sentence in details(&state.study, shown) {
        ui.label(RichText::new(sentence).size(SMALL_SIZE));
    }
}

fn section_ui(ui: &mut Ui, title: &str) {
    ui.add_space(12.0);
    ui.label(RichText::new(title).font(medium(BODY_SIZE)));
}

fn causes_ui(
    ui: &mut Ui,
    state: &State,
    shown: &ConditionAnalysis,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    section_ui(ui, "Possible sources of a lag");
    for cause in CAUSES {
        ui.label(cause.title);
        ui.label(palette.small(cause.symptom));
        if let Some(side) = cause.compares {
            let lags = lag_words(state, shown, side);
            ui.label(palette.small(format!("Median lag of the physics model [ms]: {lags}")));
        }
        let button = Button::new(format!("Show {}", cause.view.name()));
        let show = LayoutCommand::ShowView(cause.view);
        button_ui(ui, button, "", show, commands);
        ui.add_space(4.0);
    }
}

/// Lists median lags of the physics representative behind the identified one \[ms\]: "LON 66,
/// LAT −12".
fn lag_words(state: &State, shown: &ConditionAnalysis, side: ChannelSide) -> String {
    let mut entries = Vec::new();
    for MedianLag { channel, lag_s } in shown.median_lags(side) {
        let name = channel.name_in(state.dataset());
        let lag_ms = with_minus_sign(&telling(s_to_ms(lag_s), 0));
        entries.push(format!("{name} {lag_ms}"));
    }
    entries.join(", ")
}

/// Draws whether the gains are proven optimal, and the optimality gap.
fn proof_ui(ui: &mut Ui, shown: &ConditionAnalysis, is_proving: bool, palette: &Palette) {
    let outcome = shown.gains.proof.outcome;
    let words = match outcome {
        Outcome::NotProven { .. } if is_proving => {
            "A search for better gains is running; the displayed gains may still improve."
        }
        Outcome::NotProven { .. } => "Optimality is not proven.",
        Outcome::Proven { .. } => "Global optimum, proven by a lower bound.",
    };
    ui.label(palette.dim(format!("{words} Gap {:.0e}.", outcome.gap())));
}

/// Draws remarks as sentences, each with buttons for possible actions.
fn remarks_ui(
    ui: &mut Ui,
    state: &State,
    remarks: &[Remark],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    for remark in remarks {
        remark_ui(ui, state, palette, remark);
        if let Some(pair) = remark.suggested_exclusion() {
            let name = state.dataset().pair_name(pair);
            let button = ui.small_button("Ignore response");
            named(button, Role::Button, format!("Ignore {name}"))
                .on_hover_text("Removes the response from the objective, in every condition")
                .asks(Edit::Fit(pair, false), commands);
        }
        if let Some(sign) = remark.suggested_sign() {
            let (label, turn) = sign_reversal_entry(state, sign.channel, sign.role);
            let button = Button::new(label).small();
            button_ui(ui, button, EVERYWHERE, turn, commands);
        }
        if let Some(phase) = remark.suggested_phase() {
            let button = Button::new(phase_step_label(phase)).small();
            button_ui(
                ui,
                button,
                EVERYWHERE,
                setting_table::PHASE.to(phase),
                commands,
            );
        }
    }
}

fn objective_ui(
    ui: &mut Ui,
    shown: &ConditionAnalysis,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let unit = if shown.gains.quantity == Quantity::Gain(GainObjective::Decibel) {
        " dB²"
    } else {
        ""
    };
    let gains = format!("gain objective {:.4}{unit}", shown.gains.objective);
    let delays = format!("delay objective {:.4} s²", shown.delays.objective);
    let id = shown.condition.id();
    ui.horizontal_wrapped(|ui| {
        let label = value_label_ui(
            ui,
            palette.small(gains),
            ExplainTarget::GainObjective(id),
            commands,
        );
        label.on_hover_text(format!(
            "eq. (7) in docs/method.md: {}{unit}, lower bound {}{unit}",
            shown.gains.objective, shown.gains.proof.lower_bound
        ));
        let label = value_label_ui(
            ui,
            palette.small(delays),
            ExplainTarget::DelayObjective(id),
            commands,
        );
        let equation = if shown.has_leads() {
            "M15.4 in docs/lead.md"
        } else {
            "eq. (11) in docs/method.md"
        };
        label.on_hover_text(format!(
            "{equation}: {} s², global optimum (convex); KKT residual {:.0e} s",
            shown.delays.objective,
            kkt_residual(&shown.delay_problem, &shown.delays)
        ));
    });
}

/// Describes the lead in each constrained response and each filter's price; draws nothing without
/// leads.
fn lead_ui(ui: &mut Ui, state: &State, shown: &ConditionAnalysis, palette: &Palette) {
    if !shown.has_leads() {
        return;
    }
    let header = palette.small("Description of the leads");
    CollapsingHeader::new(header)
        .id_salt("leads")
        .default_open(true)
        .show(ui, |ui| {
            for sentence in lead_words(&state.study, shown, state.uncertainty().map(AsRef::as_ref))
            {
                ui.label(RichText::new(sentence).size(SMALL_SIZE));
            }
        });
}

/// Draws the off-axis benefit from worthwhile couplings, and the buttons that use and show them;
/// nothing if no couplings are worthwhile.
fn couplings_offer_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some((assessment, _)) = offered_couplings(state) else {
        return;
    };
    let couplings = assessment.couplings;
    if let Some(offer) = coupling_offer(assessment) {
        remark_ui(ui, state, palette, &Remark::Coupling(offer));
    }
    ui.horizontal(|ui| {
        let button = Button::new(USE_COUPLINGS).small();
        let use_them = setting_table::COUPLINGS.to(couplings);
        button_ui(ui, button, EVERYWHERE, use_them, commands);
        let show = LayoutCommand::ShowView(View::Couplings);
        button_ui(ui, Button::new(INSPECT), "", show, commands);
    });
}

fn remark_ui(ui: &mut Ui, state: &State, palette: &Palette, remark: &Remark) {
    let color = match remark.kind() {
        RemarkKind::Good => palette.good,
        RemarkKind::Caution | RemarkKind::Trouble => palette.warning,
    };
    let text = RichText::new(remark_text(remark, state.dataset())).size(SMALL_SIZE);
    let shown = ui.horizontal(|ui| {
        ui.add_space(8.0);
        ui.vertical(|ui| ui.label(text));
    });
    let rect = shown.response.rect;
    let bar = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
    ui.painter().rect_filled(bar, 1.0, color);
}
