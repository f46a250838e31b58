//! Corrected models of the conditions as matrices, with state names: for MATLAB, for `NumPy`, and
//! as `gdcm-models`.

use std::path::Path;
use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_method::correction;
use gdcm_method::correction::corrected_model::CorrectedModel;
use gdcm_method::correction::{ChannelCorrection, LeadPrice};
use gdcm_model::assembly::FoundModel;
use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::unchecked_dataset::ModelDraft;
use gdcm_model::dataset::{
    BundleKind, Channel, Condition, ConditionId, Dataset, Dynamics, Model, StateSpace,
};
use gdcm_model::units::{number, telling};
use gdcm_study::{Analysis, AssessedCorrection, ConditionAnalysis, CouplingCorrection};
use gdcm_words::caution::failure_text;

use super::matlab_struct::{Fields, cell_of_texts, matrix, records};
use super::{ExportFormat, ExportRequest, Exported, ExportedRole};
use crate::export_fault::ExportFault;
use crate::files::export_contents::{ExportContents, LeftOutPart, PartSource};
use crate::files::model_collection::{
    ContainingModel, bare_draft, labels, write_containing_models,
};
use crate::formats::mat;
use crate::formats::npy::write_npz;
use crate::formats::variables::{TextArray, Value, Variable};

/// Corrected models, in the format of the file extension.
pub(super) const STATE_SPACE: ExportFormat = ExportFormat {
    name: "state-space",
    extension: "mat",
    words: "Corrected models as state-space",
    options: &["--condition", "--model", "--correction", "--pade"],
    check_path: |path| ModelsFormat::of(path).map(drop),
    contents: |analysis, request| contents_of(analysis, request),
    export: |of| {
        let models = exported_models(of.analysis, of.request)?;
        let dataset = &of.analysis.study.dataset;
        let remarks = models.iter().map(ExportedModel::words).collect();
        let exported = match ModelsFormat::of(of.path)? {
            // Compressed: the matrices of delayed models are mostly zeros.
            ModelsFormat::Mat => {
                Exported::bytes(mat::write_packed(&[models_variable(&models, dataset)])?)
            }
            ModelsFormat::Npz => Exported::bytes(write_npz(&model_arrays(&models, dataset))?),
            ModelsFormat::Json => {
                let models = containing_models(&models, dataset);
                Exported::new(move |file| write_containing_models(&models, file))
            }
        };
        Ok(exported.with(remarks))
    },
};

/// Format of corrected models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelsFormat {
    Mat,
    Json,
    Npz,
}

impl ModelsFormat {
    fn of(path: &Path) -> Result<Self, ExportFault> {
        let extension = path
            .extension()
            .and_then(|extension| extension.to_str())
            .unwrap_or_default()
            .to_lowercase();
        match extension.as_str() {
            "mat" => Ok(Self::Mat),
            "json" => Ok(Self::Json),
            "npz" => Ok(Self::Npz),
            _ => Err(ExportFault::ModelsFormat),
        }
    }
}

/// A corrected model, ready to be written.
struct ExportedModel {
    condition: ConditionId,
    /// True airspeed of the condition \[kt\].
    airspeed_kt: f64,
    /// Name of the physics model.
    name: String,
    /// "scheduled" or "own".
    correction: &'static str,
    model: StateSpace,
    /// A name for each state.
    states: Vec<String>,
    /// Number of states for delays.
    delay_states: usize,
    /// Number of states for lead filters.
    lead_states: usize,
    /// Order of the approximants of its delays; 0 in discrete time, where delays are exact.
    pade_order: usize,
    /// Largest phase error of its approximants at the top of the band \[deg\].
    approximation_error_deg: f64,
    /// Largest phase \[deg\] there that delays of the condition's own correction would add, if the
    /// model is under a schedule without delays.
    left_out_deg: f64,
    /// Contents of the correction in it.
    contents: ExportContents,
    /// Top of the band of comparison \[rad/s\].
    band_top_rad_s: f64,
    /// Cost of its lead filters, with a description; `None` without lead filters.
    price: Option<(LeadPrice, String)>,
    /// Description of its couplings; empty without couplings.
    couplings: &'static str,
}

/// Returns the requested corrected models, in the dataset's order.
fn exported_models(
    analysis: &Analysis,
    request: &ExportRequest,
) -> Result<Vec<ExportedModel>, ExportFault> {
    let dataset = &analysis.study.dataset;
    analysis
        .asked_couplings()
        .map_err(|why| ExportFault::NoCouplings { why })?;
    if let Some(condition) = request
        .condition
        .filter(|&condition| dataset.condition(condition).is_none())
    {
        return Err(ExportFault::NoCondition { condition });
    }
    let asked =
        |condition: &&Arc<Condition>| request.condition.is_none_or(|id| id == condition.id());
    let conditions = dataset.conditions().iter().filter(asked);
    conditions
        .map(|condition| exported_model(analysis, request, condition))
        .collect()
}

/// Returns the contents of the requested models; empty if the study lacks the requested schedule.
fn contents_of(analysis: &Analysis, request: &ExportRequest) -> ExportContents {
    let dataset = &analysis.study.dataset;
    let conditions: Vec<ConditionId> = match request.condition {
        Some(condition) => vec![condition],
        None => dataset.ids().collect(),
    };
    let contents = ExportContents::of_models(analysis, request.correction, &conditions);
    contents.unwrap_or_else(|_| ExportContents::of_scheduled(analysis))
}

/// Returns the largest phase \[deg\] at `omega` \[rad/s\] of those delays of a condition's own
/// correction that an export omits.
fn left_out_phase_deg(contents: &ExportContents, omega: f64) -> f64 {
    let mut input_s = 0.0_f64;
    let mut output_s = 0.0_f64;
    for part in &contents.left_out {
        let LeftOutPart::Delay(delayed) = part else {
            continue;
        };
        for own in &delayed.delays {
            match delayed.channel {
                correction::Channel::Input(_) => input_s = input_s.max(own.delay_s),
                correction::Channel::Output(_) => output_s = output_s.max(own.delay_s),
            }
        }
    }
    (omega * (input_s + output_s)).to_degrees()
}

fn exported_model(
    analysis: &Analysis,
    request: &ExportRequest,
    condition: &Condition,
) -> Result<ExportedModel, ExportFault> {
    let id = condition.id();
    let model = model_of(analysis, &request.role, condition)?;
    let correction = correction_of(analysis, request.correction, condition)?;
    let Dynamics::StateSpace(dynamics) = &model.dynamics else {
        return Err(ExportFault::NoMatrices {
            condition: id,
            model: model.name.clone(),
        });
    };
    let corrected = analysis
        .corrected_model(condition, dynamics, &correction, request.pade)
        .map_err(|error| {
            let (inputs, outputs) = analysis.study.dataset.names_of_channels();
            let words = error.words(&inputs, &outputs);
            ExportFault::Model {
                condition: id,
                model: model.name.clone(),
                words,
            }
        })?;
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let price = correction.leads.as_ref().and_then(LeadPrice::of);
    let band_top_rad_s = analysis.study.settings.band.max();
    let is_sampled = dynamics.timing().sample_time_s.is_some();
    let contents = ExportContents::of_models(analysis, request.correction, &[id])
        .map_err(ExportFault::Schedule)?;
    Ok(ExportedModel {
        condition: id,
        airspeed_kt: condition.flight_state().airspeed_kt,
        name: model.name.clone(),
        correction: match request.correction {
            AssessedCorrection::Scheduled => "scheduled",
            AssessedCorrection::ScheduledWithoutLeads => "scheduled, without leads,",
            AssessedCorrection::ScheduleOfOthers => "of the other conditions",
            AssessedCorrection::Own => "own",
        },
        states: state_names(analysis, model, &corrected),
        delay_states: corrected
            .delay_states
            .iter()
            .map(|(_, states)| states)
            .sum(),
        lead_states: corrected.lead_states.iter().map(|(_, states)| states).sum(),
        pade_order: if is_sampled { 0 } else { request.pade.order() },
        approximation_error_deg: corrected.phase_error(band_top_rad_s).to_degrees(),
        left_out_deg: left_out_phase_deg(&contents, band_top_rad_s),
        contents,
        band_top_rad_s,
        price: price.map(|price| {
            let words = price.words(&inputs, &outputs);
            (price, words)
        }),
        couplings: couplings_words(analysis, dynamics),
        model: corrected.model,
    })
}

/// Describes the parts of a model besides the correction of its channels.
fn couplings_words(analysis: &Analysis, dynamics: &StateSpace) -> &'static str {
    let has_delays =
        !StateSpace::timing(dynamics).is_plain() && dynamics.timing().sample_time_s.is_none();
    match (
        analysis.fitted_couplings(),
        analysis.study.settings.couplings,
    ) {
        (None, _) => "",
        (Some(_), CouplingCorrection::MixingAndFeedback) if has_delays => {
            "; with mixing and feedback of the model, its own delays inside the loop as Pade approximants"
        }
        (Some(_), CouplingCorrection::MixingAndFeedback) => "; with mixing and feedback, exact",
        (Some(_), _) => "; with mixing, exact",
    }
}

fn model_of<'c>(
    analysis: &Analysis,
    role: &ExportedRole,
    condition: &'c Condition,
) -> Result<&'c Model, ExportFault> {
    let bundle = condition.bundle(BundleKind::Physics);
    let name = match role {
        ExportedRole::Nominal => return Ok(&bundle[condition.nominal()]),
        ExportedRole::Representative => {
            result_of(analysis, condition)?.representative_name(BundleKind::Physics)
        }
        ExportedRole::Named(name) => name,
    };
    let missing = || ExportFault::NoModel {
        condition: condition.id(),
        model: name.to_owned(),
    };
    condition
        .model(BundleKind::Physics, name)
        .ok_or_else(missing)
}

fn correction_of(
    analysis: &Analysis,
    which: AssessedCorrection,
    condition: &Condition,
) -> Result<ChannelCorrection, ExportFault> {
    match which {
        AssessedCorrection::Own => Ok(result_of(analysis, condition)?.correction.clone()),
        AssessedCorrection::Scheduled | AssessedCorrection::ScheduledWithoutLeads => {
            let schedule = analysis
                .schedule
                .as_ref()
                .map_err(|error| ExportFault::Schedule(*error))?;
            let correction = schedule.at_state(condition.flight_state());
            Ok(if which == AssessedCorrection::Scheduled {
                correction
            } else {
                correction.without_leads()
            })
        }
        AssessedCorrection::ScheduleOfOthers => {
            let schedule = analysis
                .schedule_without(condition.id())
                .map_err(ExportFault::Schedule)?;
            Ok(schedule.at_state(condition.flight_state()))
        }
    }
}

fn result_of<'a>(
    analysis: &'a Analysis,
    condition: &Condition,
) -> Result<&'a ConditionAnalysis, ExportFault> {
    let without = |why: String| ExportFault::NoResult {
        condition: condition.id(),
        why,
    };
    match analysis.conditions.get(&condition.id()) {
        Some(Ok(result)) => Ok(result),
        Some(Err(failure)) => Err(without(failure_text(failure, &analysis.study.dataset))),
        None => Err(without("it has no result".to_owned())),
    }
}

/// Returns state names: "LON lead 1" and "LON delay 1" of the inputs, the model's own names, "Q
/// delay 1" and "Q lead 1" of the outputs.
fn state_names(analysis: &Analysis, model: &Model, corrected: &CorrectedModel) -> Vec<String> {
    let dataset = &analysis.study.dataset;
    let of_channels = |channels: &[Channel], what: &str, counts: &[usize]| -> Vec<String> {
        let of = |(channel, &count): (&Channel, &usize)| {
            let name = channel.name.clone();
            (1..=count)
                .map(move |place| format!("{name} {what} {place}"))
                .collect::<Vec<_>>()
        };
        channels.iter().zip(counts).flat_map(of).collect()
    };
    let mut names = of_channels(dataset.inputs(), "lead", &corrected.lead_states.inputs);
    names.extend(of_channels(
        dataset.inputs(),
        "delay",
        &corrected.delay_states.inputs,
    ));
    let mut last = of_channels(dataset.outputs(), "delay", &corrected.delay_states.outputs);
    last.extend(of_channels(
        dataset.outputs(),
        "lead",
        &corrected.lead_states.outputs,
    ));
    let own = corrected.model.order() - names.len() - last.len();
    names.extend((0..own).map(|state| model.state_name(state)));
    names.extend(last);
    names
}

impl ExportedModel {
    /// Returns the largest phase error \[deg\] at the top of the band against the condition's own
    /// correction of delays, as far as it is caused by the export: by approximants and omitted
    /// delays.
    fn phase_error_deg(&self) -> f64 {
        self.approximation_error_deg + self.left_out_deg
    }

    /// Describes the model and its accuracy in one line.
    fn words(&self) -> String {
        let Self {
            condition,
            name,
            correction,
            ..
        } = self;
        let price = self
            .price
            .as_ref()
            .map(|(_, words)| format!("; {words}"))
            .unwrap_or_default();
        let delays = self.delay_words();
        let left_out = self.left_out_words();
        let couplings = self.couplings;
        format!(
            "condition {condition}, model {name}, {correction} correction: {delays}{left_out}{couplings}{price}"
        )
    }

    /// Returns the gain at ten times the band \[dB\] that the leads of the most expensive response
    /// add; 0 without leads.
    fn gain_above_band_db(&self) -> f64 {
        let most = |gains_db: &[f64]| gains_db.iter().copied().fold(0.0, f64::max);
        self.price.as_ref().map_or(0.0, |(price, _)| {
            most(&price.gains_db.inputs) + most(&price.gains_db.outputs)
        })
    }

    /// Describes omitted delays of the condition's own correction and their phase at the top of the
    /// band; empty without them.
    fn left_out_words(&self) -> String {
        if self.left_out_deg == 0.0 {
            return String::new();
        }
        let left_out = telling(self.left_out_deg, 3);
        let top = number(self.band_top_rad_s);
        format!(
            "; the delays of the condition's own correction are left out, up to {left_out} deg at {top} rad/s"
        )
    }

    /// Describes the parts in it and their accuracy; no accuracy is stated for delays that are not
    /// in it.
    fn delay_words(&self) -> String {
        let has_delays = self.contents.delays != PartSource::None;
        if self.pade_order == 0 && self.lead_states > 0 {
            return format!(
                "gains and delays exact, lead filters by Tustin's rule, phase error up to {} deg at {} rad/s",
                bound_words(self.approximation_error_deg),
                number(self.band_top_rad_s)
            );
        }
        if self.lead_states > 0 && self.delay_states == 0 {
            return "gains and lead filters exact".to_owned();
        }
        if self.pade_order == 0 || self.delay_states == 0 {
            return match (has_delays, self.delay_states) {
                (true, _) => "gains and delays exact",
                (false, 0) => "gains exact, without delays",
                // In discrete time: whole samples.
                (false, _) => "gains and the model's own delays exact",
            }
            .to_owned();
        }
        format!(
            "{} exact, {} by Pade approximants of order {}, phase error up to {} deg at {} rad/s",
            if self.lead_states > 0 {
                "gains and lead filters"
            } else {
                "gains"
            },
            if has_delays {
                "delays"
            } else {
                "the model's own delays"
            },
            self.pade_order,
            bound_words(self.approximation_error_deg),
            number(self.band_top_rad_s)
        )
    }
}

/// Describes an upper bound of a phase error \[deg\]; values below a thousandth of a degree are not
/// distinguished.
fn bound_words(error_deg: f64) -> String {
    /// The smallest bound that is reported.
    const LEAST_DEG: f64 = 1e-3;
    let bound_deg = if error_deg > 0.0 {
        error_deg.max(LEAST_DEG)
    } else {
        0.0
    };
    format!("{bound_deg:.3}")
}

/// Returns the models with the names "condition 10, nominal"; their notes describe the changes and
/// the accuracy.
fn found_models(models: &[ExportedModel], dataset: &Dataset) -> Vec<FoundModel> {
    let found = |model: &ExportedModel| FoundModel {
        draft: ModelDraft {
            matrices: matrices(model).map(|(_, of)| Some(of.clone())),
            timing: model.model.timing().clone(),
            states: model.states.clone(),
            ..bare_draft(
                format!("condition {}, {}", model.condition, model.name),
                Origin::Perturbed { perturbation: None },
            )
        },
        inputs: labels(dataset.inputs()),
        outputs: labels(dataset.outputs()),
        facts: Facts {
            condition: Some(model.condition.0),
            airspeed_kt: Some(model.airspeed_kt),
            ..Facts::default()
        },
        notes: vec![model.words()],
    };
    models.iter().map(found).collect()
}

/// Returns the same models, each with its block `contains`.
fn containing_models(models: &[ExportedModel], dataset: &Dataset) -> Vec<ContainingModel> {
    let mut containing = Vec::new();
    for (model, exported) in found_models(models, dataset).into_iter().zip(models) {
        containing.push(ContainingModel {
            model,
            contains: exported.contents.json(dataset),
        });
    }
    containing
}

/// Returns the variable `models`: one record for each model, with the properties of MATLAB's `ss`:
/// `ss(m.A, m.B, m.C, m.D, m.Ts)`.
fn models_variable(models: &[ExportedModel], dataset: &Dataset) -> Variable {
    let names =
        |channels: &[Channel]| cell_of_texts(channels.iter().map(|channel| channel.name.clone()));
    let units =
        |channels: &[Channel]| cell_of_texts(channels.iter().map(|channel| channel.unit.clone()));
    let record = |model: &ExportedModel| {
        let mut fields = Fields::default();
        for (name, values) in matrices(model) {
            fields.add(name, array(values));
        }
        fields.add("InputName", names(dataset.inputs()));
        fields.add("OutputName", names(dataset.outputs()));
        fields.add("InputUnit", units(dataset.inputs()));
        fields.add("OutputUnit", units(dataset.outputs()));
        fields.add("StateName", cell_of_texts(model.states.iter().cloned()));
        for (name, metric) in METRICS {
            fields.add(name, Value::number(metric(model)));
        }
        fields.add("model", Value::text(&model.name));
        fields.add("correction", Value::text(model.correction));
        let mut contains = Fields::default();
        for (name, source) in model.contents.parts() {
            contains.add(name, Value::text(source.word()));
        }
        contains.add(
            "left_out",
            cell_of_texts(model.contents.left_out_words(dataset)),
        );
        fields.add("contains", contains.record());
        fields
    };
    Variable {
        name: "models".to_owned(),
        value: records(models.iter().map(record).collect()),
    }
}

/// A metric of a model, and its name.
type Metric = (&'static str, fn(&ExportedModel) -> f64);

const METRICS: [Metric; 8] = [
    ("Ts", sample_time_s),
    ("condition", |model| model.condition.0 as f64),
    ("airspeed_kt", |model| model.airspeed_kt),
    ("pade_order", |model| model.pade_order as f64),
    ("phase_error_deg", ExportedModel::phase_error_deg),
    ("band_top_rad_s", |model| model.band_top_rad_s),
    ("not_valid_above_rad_s", |model| {
        model
            .price
            .as_ref()
            .map_or(f64::INFINITY, |(price, _)| price.limit_rad_s)
    }),
    ("gain_above_band_db", ExportedModel::gain_above_band_db),
];

/// A part of a correction by its name, and its source.
type ContainedPart = (&'static str, fn(&ExportContents) -> PartSource);

const CONTAINED: [ContainedPart; 4] = [
    ("gains", |contents| contents.gains),
    ("delays", |contents| contents.delays),
    ("leads", |contents| contents.leads),
    ("couplings", |contents| contents.couplings),
];

/// Returns the same as arrays, the only type of `NumPy`: for model 0 `A_0`, `B_0`, `C_0`, `D_0` and
/// `StateName_0`; one entry for each model in the others.
fn model_arrays(models: &[ExportedModel], dataset: &Dataset) -> Vec<Variable> {
    let variable = |name: String, value: Value| Variable { name, value };
    let mut variables = Vec::new();
    for (place, model) in models.iter().enumerate() {
        let named = matrices(model)
            .map(|(name, values)| variable(format!("{name}_{place}"), array(values)));
        variables.extend(named);
        variables.push(variable(
            format!("StateName_{place}"),
            row_of_texts(model.states.iter()),
        ));
    }
    for (name, channels) in [("Input", dataset.inputs()), ("Output", dataset.outputs())] {
        let names = row_of_texts(channels.iter().map(|channel| &channel.name));
        let units = row_of_texts(channels.iter().map(|channel| &channel.unit));
        variables.extend([
            variable(format!("{name}Name"), names),
            variable(format!("{name}Unit"), units),
        ]);
    }
    for (name, metric) in METRICS {
        let values = models.iter().map(metric).collect();
        variables.push(variable(name.to_owned(), matrix(1, models.len(), values)));
    }
    variables.push(variable(
        "model".to_owned(),
        row_of_texts(models.iter().map(|model| &model.name)),
    ));
    let corrections = models.iter().map(|model| model.correction);
    variables.push(variable("correction".to_owned(), row_of_texts(corrections)));
    for (name, source) in CONTAINED {
        let words = models.iter().map(|model| source(&model.contents).word());
        variables.push(variable(format!("contains_{name}"), row_of_texts(words)));
    }
    let left_out = models
        .iter()
        .map(|model| model.contents.left_out_words(dataset).join("; "));
    variables.push(variable(
        "contains_left_out".to_owned(),
        row_of_texts(left_out),
    ));
    variables
}

/// Returns MATLAB's `Ts` \[s\]: 0 in continuous time.
fn sample_time_s(model: &ExportedModel) -> f64 {
    model.model.timing().sample_time_s.unwrap_or(0.0)
}

fn matrices(model: &ExportedModel) -> [(&'static str, &DMatrix<f64>); 4] {
    let of = &model.model;
    [("A", of.a()), ("B", of.b()), ("C", of.c()), ("D", of.d())]
}

fn array(values: &DMatrix<f64>) -> Value {
    // Both are stored by columns.
    matrix(values.nrows(), values.ncols(), values.as_slice().to_vec())
}

fn row_of_texts<T: ToString>(texts: impl Iterator<Item = T>) -> Value {
    let texts: Vec<String> = texts.map(|text| text.to_string()).collect();
    Value::Text(TextArray {
        shape: vec![1, texts.len()],
        texts,
    })
}

#[cfg(test)]
mod tests {
    use gdcm_model::progress::Unobserved;
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
    use gdcm_study::decisions::setting;
    use gdcm_study::{Engine, PhaseCorrection, Study};

    use super::*;
    use crate::files::dataset_file::embedded_example;
    use crate::formats::zip_files::read_npz;
    use crate::reading_budget::ReadingBudget;

    #[test]
    fn a_delay_that_the_schedule_leaves_out_is_named_and_counts_as_an_error_of_phase() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let models = exported_models(&analysis, &ExportRequest::default()).unwrap();
        let nx = correction::Channel::Output(3);
        for model in &models {
            let id = model.condition;
            let own_s = analysis.condition(id).unwrap().correction.pure_delay_s(nx);
            let [LeftOutPart::Delay(left_out)] = &model.contents.left_out[..] else {
                assert!(
                    model.contents.left_out.is_empty() && own_s < 5e-5,
                    "condition {id}: {own_s} s"
                );
                assert_eq!(model.phase_error_deg(), 0.0);
                assert!(
                    model.words().contains("gains exact, without delays"),
                    "{}",
                    model.words()
                );
                continue;
            };
            assert_eq!((id, left_out.channel), (ConditionId(4), nx));
            let phase_deg = (12.0 * own_s).to_degrees();
            assert!(
                (model.phase_error_deg() - phase_deg).abs() < 1e-9 && phase_deg > 0.1,
                "{phase_deg}"
            );
            assert!(
                model.words().contains("are left out, up to"),
                "{}",
                model.words()
            );
        }
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let own = exported_models(&analysis, &own).unwrap();
        assert!(
            own.iter()
                .all(|model| model.contents.left_out.is_empty() && model.left_out_deg == 0.0)
        );
        assert!(
            own.iter()
                .all(|model| model.contents.delays == PartSource::Own)
        );
    }

    #[test]
    fn numpy_and_matlab_get_the_same_matrices_and_names() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let models = exported_models(&analysis, &ExportRequest::default()).unwrap();
        let meter = ReadingBudget::new(1 << 28);
        let arrays = read_npz(
            &write_npz(&model_arrays(&models, &study.dataset)).unwrap(),
            &meter,
        )
        .unwrap();
        let bytes = mat::write_packed(&[models_variable(&models, &study.dataset)]).unwrap();
        let [
            Variable {
                value: Value::Struct(records),
                ..
            },
        ] = &mat::read(&bytes, &meter).unwrap()[..]
        else {
            panic!("one struct array")
        };
        for (place, model) in models.iter().enumerate() {
            for name in ["A", "B", "C", "D"] {
                let found = arrays
                    .iter()
                    .find(|array| array.name == format!("{name}_{place}"))
                    .unwrap();
                assert_eq!(
                    found.value,
                    records.field(name).unwrap()[place],
                    "{name} of model {place}"
                );
            }
            assert_eq!(records.field("A").unwrap()[place], array(model.model.a()));
            let names = arrays
                .iter()
                .find(|array| array.name == format!("StateName_{place}"))
                .unwrap();
            assert_eq!(names.value, row_of_texts(model.states.iter()));
        }
        let airspeeds = arrays
            .iter()
            .find(|array| array.name == "airspeed_kt")
            .unwrap();
        let values = models.iter().map(|model| model.airspeed_kt).collect();
        assert_eq!(airspeeds.value, matrix(1, models.len(), values));
    }

    #[test]
    fn a_corrected_model_with_couplings_has_the_response_of_the_analysis() {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        study
            .apply(&setting::PHASE.to(PhaseCorrection::None))
            .unwrap();
        study
            .apply(&setting::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
            .unwrap();
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let own = ExportRequest {
            correction: AssessedCorrection::Own,
            ..ExportRequest::default()
        };
        let grid = FrequencyGrid::logarithmic(study.settings.band, 12);
        for model in exported_models(&analysis, &own).unwrap() {
            assert!(
                model.words().contains("with mixing and feedback, exact"),
                "{}",
                model.words()
            );
            let result = analysis.condition(model.condition).unwrap();
            let bundle = result.condition.bundle(BundleKind::Physics);
            let physics =
                FrequencyResponse::of(&bundle[result.condition.nominal()].dynamics, &grid);
            let coupled = result.coupled_response(&physics);
            let found = FrequencyResponse::of(&Dynamics::StateSpace(model.model.clone()), &grid);
            for (pair, curve) in coupled.curves().iter() {
                let gain = result.correction.net_gain(pair);
                let largest = curve.iter().map(|value| value.norm()).fold(0.0, f64::max) * gain;
                for (found, expected) in found.curve(pair).iter().zip(curve) {
                    // Both close the loop, one in states, the other at each frequency.
                    assert!(
                        (found - expected * gain).norm() <= 1e-9 * largest,
                        "{pair:?} of {}",
                        model.condition
                    );
                }
            }
        }
    }
}
