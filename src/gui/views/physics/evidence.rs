//! Evidence for the selected parameter, the parameters' effect on the correction, and cautions
//! about the diagnosis.
//!
//! The terms are those of docs/physics.md (M18.3, M18.4): *explained* is the share of the misfit
//! that a parameter removes in conditions left out of its fit, alone or when added to the
//! parameters before it; *learned* is the share of the prior variance that the data remove; the
//! prior is the *plausible* standard deviation of the change. The interval about a value has
//! several sources; their shares of its variance are listed.

use egui::{Label, RichText, ScrollArea, Ui};

use gdcm_method::physics::intervals::ValueVariance;
use gdcm_model::number_format::{decimals, signed};
use gdcm_study::Edit;
use gdcm_study::decisions::physics_settings::ParameterDecision;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{DiagnosedParameter, PhysicsFindings};
use gdcm_words::Table;
use gdcm_words::couplings::NARROW_COST_COLUMNS;
use gdcm_words::physics::{
    change_text, channel_delay_table, diagnosis_cautions, left_out_lines, parameter_text,
    paste_block, physics_cost_table, pull_lines, rerun_text,
};

use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::number_entry::number_entry_ui;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::tables::{Sorting, TableLook, table_grid_ui};

/// Number field width \[pt\].
const FIELD_WIDTH: f32 = 70.0;

/// Draws the evidence in the right panel, below the verdict.
pub fn physics_evidence_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(Some(Ok(assessment))) = state.physics() else {
        ui.label(palette.dim("No diagnosis of physics parameters"));
        return;
    };
    let Some(findings) = &assessment.applied.findings else {
        ui.label(palette.dim("All values are set by hand"));
        return;
    };
    let selected = state.selected_parameter(findings);
    ScrollArea::vertical()
        .id_salt("evidence for a parameter")
        .auto_shrink(false)
        .show(ui, |ui| {
            let evidence = Evidence {
                state,
                assessment,
                findings,
                selected,
                palette,
            };
            evidence.parameter_ui(ui, commands);
            evidence.effect_ui(ui, commands);
            evidence.cautions_ui(ui);
            evidence.paste_ui(ui, commands);
        });
}

struct Evidence<'a> {
    state: &'a State,
    assessment: &'a PhysicsAssessment,
    findings: &'a PhysicsFindings,
    /// Index among the parameters that are switched on.
    selected: usize,
    palette: &'a Palette,
}

impl Evidence<'_> {
    fn heading_ui(&self, ui: &mut Ui, text: &str) {
        ui.add_space(10.0);
        ui.label(RichText::new(text).font(medium(BODY_SIZE)));
    }

    fn sentence_ui(&self, ui: &mut Ui, text: &str) {
        ui.add(Label::new(self.palette.small(text)).wrap());
    }

    /// Draws the selected parameter: its value, the evidence for it (shares explained and learned,
    /// strongest correlation, sources of its variance), and the fields for its prior and value.
    fn parameter_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let (Some(parameter), Some(diagnosis)) = (
            self.findings.parameters.get(self.selected),
            self.findings.diagnosis.parameters.get(self.selected),
        ) else {
            return;
        };
        let diagnosed = DiagnosedParameter {
            parameter,
            diagnosis,
        };
        self.heading_ui(ui, &parameter.name);
        if !parameter.description.is_empty() {
            self.sentence_ui(ui, &parameter.description);
        }
        let value = change_text(parameter, diagnosed.change(), diagnosed.half_width());
        ui.label(RichText::new(value).font(medium(BODY_SIZE)));
        self.sentence_ui(ui, &parameter_text(diagnosed));
        let table = evidence_table(&diagnosed, self.findings);
        self.table_ui(ui, &table, commands);
        self.fields_ui(ui, &diagnosed, commands);
    }

    /// Draws the fields for the plausible standard deviation and for a value set by hand.
    fn fields_ui(
        &self,
        ui: &mut Ui,
        diagnosed: &DiagnosedParameter<'_>,
        commands: &mut Vec<Command>,
    ) {
        let name = &diagnosed.parameter.name;
        let decisions = &self.state.study.settings.physics_parameters;
        ui.horizontal(|ui| {
            ui.label(self.palette.small("plausible ±"));
            let label = format!("Plausible change of {name}");
            let shown = gdcm_model::units::number(diagnosed.parameter.plausible_sd);
            if let Some(plausible_sd) =
                number_entry_ui(ui, &label, &shown, "", FIELD_WIDTH, commands)
            {
                commands.push(decision(name, ParameterDecision::PlausibleSd(plausible_sd)));
            }
            ui.label(self.palette.small(&diagnosed.parameter.unit));
            ui.label(self.palette.small("by hand"));
            let label = format!("Change of {name} by hand");
            let shown = match decisions.by_hand.get(name) {
                Some(change) => gdcm_model::units::number(*change),
                None => String::new(),
            };
            if let Some(change) = number_entry_ui(ui, &label, &shown, "", FIELD_WIDTH, commands) {
                commands.push(decision(name, ParameterDecision::Value(change)));
            }
        });
    }

    /// Draws mean J and the channel delays with unchanged and with changed parameters.
    fn effect_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let name = self.assessment.correction.name();
        self.heading_ui(ui, &format!("Effect of {name} on the correction"));
        let costs = Table {
            title: "Mean J without and with physics parameters".to_owned(),
            columns: NARROW_COST_COLUMNS.map(str::to_owned).to_vec(),
            ..physics_cost_table(self.assessment)
        };
        self.table_ui(ui, &costs, commands);
        if self.has_delays() {
            let (inputs, outputs) = self.state.dataset().input_and_output_names();
            let delays = channel_delay_table(self.assessment, &inputs, &outputs);
            self.table_ui(ui, &delays, commands);
        }
    }

    /// Returns whether any channel has a delay or a lead, with unchanged or with changed
    /// parameters.
    fn has_delays(&self) -> bool {
        let Some(mean) = self.assessment.mean_delays_s() else {
            return false;
        };
        [&mean.without, &mean.with].into_iter().any(|channels| {
            let mut delays_s = channels.inputs.iter().chain(&channels.outputs);
            delays_s.any(|delay_s| *delay_s != 0.0)
        })
    }

    fn cautions_ui(&self, ui: &mut Ui) {
        let mut cautions = diagnosis_cautions(self.findings);
        cautions.extend(left_out_lines(&self.findings.left_out));
        if !cautions.is_empty() {
            self.heading_ui(ui, "Cautions");
            for caution in cautions {
                let text = self.palette.small_warning(format!("⚠ {caution}"));
                ui.add(Label::new(text).wrap());
            }
        }
        self.heading_ui(ui, "Most influential conditions");
        for line in pull_lines(self.findings) {
            self.sentence_ui(ui, &line);
        }
        if !self.assessment.reruns.is_empty() {
            self.heading_ui(ui, "Reruns at proposed values");
            for check in &self.assessment.reruns {
                self.sentence_ui(ui, &rerun_text(check));
            }
        }
    }

    /// Draws the button that copies the values for the input of the physics model.
    fn paste_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        if self.assessment.applied.values.is_empty() {
            return;
        }
        ui.add_space(10.0);
        let block = paste_block(&self.assessment.applied);
        let hint = "A line for each parameter: name, change from nominal, unit";
        let copy = OutputCommand::CopyText(block);
        let button = egui::Button::new("Copy the values for the physics model");
        button_ui(ui, button, hint, copy, commands);
    }

    fn table_ui(&self, ui: &mut Ui, table: &Table, commands: &mut Vec<Command>) {
        if table.rows.is_empty() {
            return;
        }
        ui.add_space(6.0);
        ui.push_id(&table.title, |ui| {
            ScrollArea::horizontal().show(ui, |ui| {
                let mut unsorted = Sorting::default();
                table_grid_ui(
                    ui,
                    table,
                    &mut unsorted,
                    &TableLook::PLAIN,
                    self.palette,
                    commands,
                );
            });
        });
    }
}

/// Returns the command for a decision about a parameter.
fn decision(name: &str, decision: ParameterDecision) -> Command {
    Edit::DecideParameter {
        name: name.to_owned(),
        decision,
    }
    .into()
}

/// Tabulates a parameter's diagnosis; a row is omitted if its quantity is undefined, as for a value
/// set by hand.
fn evidence_table(diagnosed: &DiagnosedParameter<'_>, findings: &PhysicsFindings) -> Table {
    let diagnosis = diagnosed.diagnosis;
    let mut table = Table::new("Evidence", ["quantity", "value"]);
    // The ratio is the share of the misfit that remains.
    if let Some(remaining_share) = diagnosis.ratio_alone {
        let percent = decimals(100.0 * (1.0 - remaining_share), 0);
        table.row(["explained alone".to_owned(), format!("{percent} %")]);
    }
    // The gain is the share of the misfit that the parameter's step removes.
    if let (Some(step), Some(explained_share)) = (diagnosis.step, diagnosis.gain) {
        let percent = decimals(100.0 * explained_share, 1);
        table.row([
            "explained when added".to_owned(),
            format!("{percent} %, step {step}"),
        ]);
    }
    if let Some(learned) = diagnosis.learned {
        let percent = decimals(100.0 * learned, 0);
        table.row(["learned from the data".to_owned(), format!("{percent} %")]);
    }
    if let Some(share) = diagnosis.channels_can_take {
        let percent = decimals(100.0 * share, 0);
        table.row(["imitated by channels".to_owned(), format!("{percent} %")]);
    }
    if let Some(pair) = diagnosis.strongest_pair {
        let [first, second] = pair
            .parameters
            .map(|index| &findings.parameters[index].name);
        let other = if *first == diagnosed.parameter.name {
            second
        } else {
            first
        };
        let correlation = signed(pair.correlation, 2);
        table.row([
            "strongest correlation".to_owned(),
            format!("{correlation}, {other}"),
        ]);
    }
    if let Some(variance) = diagnosis.variance {
        for (source, percent) in variance_shares(variance) {
            table.row([
                format!("variance from {source}"),
                format!("{} %", decimals(percent, 0)),
            ]);
        }
    }
    table
}

/// Returns each source's share of the value's variance \[%\]: leaving out a condition, an output,
/// an input or a third of the band (jackknife), and the prior (M18.3). A source with a single
/// member is omitted; the list is empty if the variance is zero.
fn variance_shares(variance: ValueVariance) -> Vec<(&'static str, f64)> {
    let total = variance.total();
    let sources = [
        ("conditions", variance.condition),
        ("outputs", variance.output),
        ("inputs", variance.input),
        ("parts of the band", variance.band),
        ("the prior", Some(variance.prior)),
    ];
    let mut shares = Vec::new();
    for (source, variance) in sources {
        if let Some(variance) = variance
            && total > 0.0
        {
            shares.push((source, 100.0 * variance / total));
        }
    }
    shares
}
