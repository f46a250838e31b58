//! How well models fit the records: in frequency, by record and output, and in time.

use std::sync::Arc;

use egui::{Color32, Grid, RichText, ScrollArea, Ui};

use crate::correction::{CorrectedModel, Pade};
use crate::dataset::{BundleKind, Dynamics, StateSpace};
use crate::executor::Sequential;
use crate::identification::{
    FlightRecord, Preparation, StateSpaceMatrices, Validation, ValidationSettings, prepare, validate,
};
use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{ChartLine, thinned};
use crate::view::state::State;

use super::bench::{ConditionRecords, RecordsCommand};
use super::kept::kept;
use super::record_list::{BAD, GOOD};

/// Theil's coefficient below which a model is a good one (M14, section 6).
const GOOD_THEIL: f64 = 0.25;

/// A model that can be compared with a record in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TimeModel {
    /// The recommended identified model.
    Identified,
    /// The physics representative.
    Physics,
    /// The same, corrected.
    Corrected,
}

impl TimeModel {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Identified, Self::Physics, Self::Corrected];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::Corrected => "corrected",
        }
    }

    fn color(self, palette: &Palette) -> Color32 {
        match self {
            Self::Identified => palette.accent,
            Self::Physics => palette.nominal,
            Self::Corrected => palette.corrected,
        }
    }
}

/// A model beside the record shown.
pub(super) struct Simulated {
    model: TimeModel,
    color: Color32,
    result: Arc<Result<Validation, String>>,
}

impl Simulated {
    /// The lines of an output, one a window, each from an initial state of its own.
    pub(super) fn lines(&self, output: usize) -> Vec<ChartLine> {
        let Ok(validation) = self.result.as_ref() else { return Vec::new() };
        let windows = validation.windows.iter().map(|window| {
            let at = |sample: usize| window.start_s + sample as f64 * window.sample_time_s;
            let values = window.simulated.column(output);
            let points = values.iter().enumerate().map(|(sample, value)| [at(sample), *value]).collect();
            let dashed = self.model == TimeModel::Physics;
            ChartLine { points: thinned(points, 1000), color: self.color, width: 1.3, dashed }
        });
        windows.collect()
    }
}

/// The models asked for beside the record shown.
pub(super) fn simulated(ui: &Ui, state: &State, records: &ConditionRecords, palette: &Palette) -> Vec<Simulated> {
    let row = records.rows.get(records.chosen);
    let Some(flight) = row.and_then(|row| row.flight.as_ref()) else { return Vec::new() };
    let of = |model: TimeModel| {
        let matrices = matrices(state, records, model)?;
        let numbers = matrices.a.iter().chain(&matrices.b).chain(&matrices.c).chain(&matrices.d);
        let numbers: Vec<u64> = numbers.map(|value| value.to_bits()).collect();
        let channels = format!("{:?}{:?}", records.inputs, records.outputs);
        let key = (Arc::as_ptr(flight) as usize, numbers, channels);
        let result = kept(ui, model.name(), key, || compared(flight, records, &matrices));
        Some(Simulated { model, color: model.color(palette), result })
    };
    let asked = TimeModel::ALL.into_iter().filter(|model| state.records.time_models.contains(model));
    asked.filter_map(of).collect()
}

/// A model against a record in time, as they are.
fn compared(
    flight: &FlightRecord,
    records: &ConditionRecords,
    matrices: &StateSpaceMatrices,
) -> Result<Validation, String> {
    let preparation =
        Preparation { inputs: records.inputs.clone(), outputs: records.outputs.clone(), ..Preparation::of(&[], &[]) };
    let prepared =
        prepare(std::slice::from_ref(flight), &preparation, &Sequential).map_err(|error| error.to_string())?;
    validate(matrices, &prepared.pieces, &ValidationSettings::unfiltered(), &Sequential)
        .map_err(|error| error.to_string())
}

/// The matrices of a model; none where it is not there, or is not one of continuous time.
fn matrices(state: &State, records: &ConditionRecords, model: TimeModel) -> Option<StateSpaceMatrices> {
    let plain = |of: &StateSpace| {
        let is_plain = of.timing().is_plain();
        is_plain.then(|| StateSpaceMatrices {
            a: of.a().clone(),
            b: of.b().clone(),
            c: of.c().clone(),
            d: of.d().clone(),
        })
    };
    if model == TimeModel::Identified {
        return Some(records.identification()?.refined.matrices.clone());
    }
    let shown = state.shown()?;
    let name = shown.representative_name(BundleKind::Physics);
    let physics = state.condition().model(BundleKind::Physics, name)?;
    let Dynamics::StateSpace(physics) = &physics.dynamics else { return None };
    match model {
        TimeModel::Corrected => plain(&CorrectedModel::of(physics, &shown.correction, Pade::default()).ok()?.model),
        TimeModel::Identified | TimeModel::Physics => plain(physics),
    }
}

/// Which models are drawn beside the record.
pub(super) fn time_models_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("response to the same inputs of:").size(SMALL_SIZE).color(palette.dim_text));
        for model in TimeModel::ALL {
            let mut shown = state.records.time_models.contains(&model);
            let text = RichText::new(format!("{} model", model.name())).size(SMALL_SIZE).color(model.color(palette));
            let hint = "In windows of 10 s, or shorter where the model is unstable, each from an initial state and offsets of its own";
            if ui.checkbox(&mut shown, text).on_hover_text(hint).changed() {
                commands.push(RecordsCommand::ShowTimeModel(model, shown).into());
            }
        }
    });
}

/// Tables of the fit: by record, by output, and in time.
pub(super) fn fit_ui(
    ui: &mut Ui,
    state: &State,
    records: &ConditionRecords,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ScrollArea::vertical().id_salt("fit").auto_shrink(false).show(ui, |ui| {
        if let Some(found) = records.identification() {
            ui.label(RichText::new("In frequency: J per degree of freedom; 1 is what noise explains").strong());
            Grid::new("fit of records").num_columns(3).striped(true).show(ui, |ui| {
                for fit in &found.record_fits {
                    let name = found.record_uses.get(fit.record).map_or("", |of| of.record.as_str());
                    ui.label(name);
                    ui.label(cost_text(fit.cost, palette));
                    ui.label(if fit.held_out { "held out" } else { "" });
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            Grid::new("fit of outputs").num_columns(2).striped(true).show(ui, |ui| {
                for (output, cost) in state.dataset().outputs().iter().zip(&found.output_costs) {
                    ui.label(&output.name);
                    ui.label(cost_text(*cost, palette));
                    ui.end_row();
                }
            });
        } else {
            ui.label(RichText::new("Nothing was identified yet: choose Identify above.").color(palette.dim_text));
        }
        ui.add_space(10.0);
        time_ui(ui, state, records, palette, commands);
    });
}

fn cost_text(cost: f64, palette: &Palette) -> RichText {
    let color = match cost {
        cost if cost <= GOOD => palette.good,
        cost if cost <= BAD => palette.text,
        _ => palette.warning,
    };
    RichText::new(format!("{cost:.2}")).color(color)
}

/// Fit and Theil's coefficient of each model asked for, of the record shown.
fn time_ui(ui: &mut Ui, state: &State, records: &ConditionRecords, palette: &Palette, commands: &mut Vec<Command>) {
    let name = records.rows.get(records.chosen).map_or("", |row| row.table.name.as_str());
    ui.label(RichText::new(format!("In time: {name}, fit in % and Theil's coefficient")).strong());
    time_models_ui(ui, state, palette, commands);
    let models = simulated(ui, state, records, palette);
    Grid::new("fit in time").num_columns(1 + 2 * models.len()).striped(true).show(ui, |ui| {
        ui.label("");
        for model in &models {
            ui.label(RichText::new(model.model.name()).color(model.color));
            ui.label("");
        }
        ui.end_row();
        for (index, output) in state.dataset().outputs().iter().enumerate() {
            ui.label(&output.name);
            for model in &models {
                let figures = model.result.as_ref().as_ref().ok();
                let figure = |of: Option<&Option<f64>>| of.copied().flatten();
                let fit = figures.and_then(|of| figure(of.fit_percent.get(index)));
                let theil = figures.and_then(|of| figure(of.theil.get(index)));
                ui.label(fit.map_or("–".to_owned(), |fit| format!("{fit:.1} %")));
                let color =
                    theil.map_or(palette.dim_text, |of| if of < GOOD_THEIL { palette.good } else { palette.warning });
                ui.label(RichText::new(theil.map_or("–".to_owned(), |of| format!("{of:.3}"))).color(color));
            }
            ui.end_row();
        }
    });
    for model in &models {
        if let Err(why) = model.result.as_ref() {
            ui.label(RichText::new(format!("{}: {why}", model.model.name())).color(palette.warning));
        }
    }
    let text = "A fit in time hardly tells models apart: rank them by the cost of what was held out.";
    ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
}
