//! Models found in files, with the engineer's rules applied to them: the entry point of this
//! folder.
//!
//! The problems are described in `problem_lines.rs`, the cautions in `position_caution.rs`.
//!
//! A [`Part`] is a model found in a file, with its row (its place in the dataset: condition, role,
//! trim) and its channels matched to the dataset's; [`Rules`] are the engineer's entries.

use std::path::Path;

use super::assembled_draft::dataset_draft;
use super::found_model::FoundModel;
use super::indexed_part::{parts_by_condition, parts_in_use};
use super::part::Part;
use super::problem::{Problem, ProblemKind};
use super::problem_search::{channel_problems, condition_problems, part_problems};
use super::proposed_rows::proposed_rows;
use super::question_scope::set_scopes;
use super::rules::Rules;
use crate::dataset::Dataset;
use crate::dataset::dataset_draft::DatasetDraft;
use crate::names::RowRole;

/// Models found in files, each with its place in the dataset, and the open problems.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    rules: Rules,
    parts: Vec<Part>,
    problems: Vec<Problem>,
}

impl Default for Assembly {
    /// Returns an assembly without models.
    fn default() -> Self {
        Self::new(Vec::new(), Rules::default())
    }
}

impl Assembly {
    /// Applies the rules to models.
    ///
    /// 1. Propose a row for each model.
    /// 2. Match each model's channels.
    /// 3. Collect the problems.
    pub fn new(models: Vec<FoundModel>, rules: Rules) -> Self {
        let rows = proposed_rows(&models, &rules);
        let mut parts = Vec::with_capacity(models.len());
        for (found, row) in models.into_iter().zip(rows) {
            parts.push(Part::new(found, row, &rules));
        }
        let problems = find_problems(&parts, &rules);
        Self {
            rules,
            parts,
            problems,
        }
    }

    /// Assembles the same models under other rules.
    pub fn with_rules(&self, rules: Rules) -> Self {
        let models = self.parts.iter().map(|part| part.found.clone()).collect();
        Self::new(models, rules)
    }

    /// Returns the rules that were applied.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Returns the models in the order in which they were found.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the open problems; empty if the dataset can be built.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Returns the dataset, or `None` while there are problems. Relative file names for models and
    /// flight records are prefixed with `folder`, the path from the dataset's folder to the files.
    pub fn dataset(&self, folder: &str) -> Option<Dataset> {
        if !self.problems.is_empty() {
            return None;
        }
        let mut draft = dataset_draft(&self.rules, &self.parts);
        if !folder.is_empty() {
            prefix_files(&mut draft, folder);
        }
        let (dataset, _) = draft.checked().ok()?;
        Some(dataset)
    }

    /// Returns the conditions without an identified model, in ascending order.
    pub fn without_reference(&self) -> Vec<i64> {
        let mut without = Vec::new();
        for (condition, parts) in parts_by_condition(&self.parts) {
            let has_reference = parts
                .iter()
                .any(|part| part.part.row.role == Some(RowRole::Identified));
            if !has_reference {
                without.push(condition);
            }
        }
        without
    }
}

/// Finds all problems in the dataset's channels, in each model and in each condition, with their
/// scopes. If there are none, checks the dataset draft as a whole.
fn find_problems(parts: &[Part], rules: &Rules) -> Vec<Problem> {
    let mut problems = channel_problems(rules);
    let in_use = parts_in_use(parts);
    if in_use.is_empty() {
        problems.push(Problem::in_dataset(ProblemKind::NoModels));
    }
    for part in in_use {
        for kind in part_problems(part.part, rules) {
            problems.push(Problem::in_part(part.index, kind));
        }
    }
    for (condition, parts) in parts_by_condition(parts) {
        problems.extend(condition_problems(condition, &parts, rules));
    }
    set_scopes(&mut problems, parts, rules);
    if problems.is_empty()
        && let Err(error) = dataset_draft(rules, parts).checked()
    {
        let text = format!("{}: {}", error.place, error.fault);
        problems.push(Problem::in_dataset(ProblemKind::Dataset(text)));
    }
    problems
}

/// Prefixes the relative file names of models and flight records with a folder.
fn prefix_files(draft: &mut DatasetDraft, folder: &str) {
    for condition in &mut draft.conditions {
        for model in condition
            .physics
            .iter_mut()
            .chain(&mut condition.identified)
        {
            if let Some(source) = &mut model.source
                && let Some(file) = &mut source.file
            {
                prefix_file(file, folder);
            }
        }
        for record in &mut condition.records {
            prefix_file(&mut record.file, folder);
        }
    }
}

fn prefix_file(file: &mut String, folder: &str) {
    if !Path::new(file).is_absolute() {
        *file = format!("{folder}/{file}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::found_model::Facts;
    use crate::assembly::position_caution::PositionCaution;
    use crate::assembly::proposed_rules::proposed_rules;
    use crate::assembly::row_rule::RowRule;
    use crate::assembly::test_models::{at_airspeed, found_model, measured_model};
    use crate::dataset::PhysicsParameter;
    use crate::dataset::channel::ChannelSide;
    use crate::dataset::dataset_draft::ModelDraft;
    use crate::dataset::physics_parameter::ParameterChange;
    use crate::names::ChannelRule;

    #[test]
    fn the_same_response_in_two_files_is_a_problem() {
        let rule = |name: &str| ChannelRule {
            unit: "%".into(),
            unit_in_files: Some("%".into()),
            ..ChannelRule::named(name)
        };
        let rules = Rules {
            inputs: vec![rule("LON")],
            outputs: vec![rule("Q"), rule("P")],
            ..Rules::default()
        };
        let measured_in = |file: &str| {
            let mut model = found_model(file, None, Facts::default());
            model.draft = ModelDraft {
                source: model.draft.source,
                ..measured_model(&[3.0, 4.0])
            };
            model
        };
        let codes = |files: [&str; 2]| -> Vec<&str> {
            let assembly = Assembly::new(files.map(measured_in).to_vec(), rules.clone());
            assembly
                .problems()
                .iter()
                .map(|problem| problem.kind.code())
                .collect()
        };
        assert!(codes(["c1/frf_q_lon.csv", "c1/frf_q_lon_run2.csv"]).contains(&"response-twice"));
        assert!(!codes(["c1/frf_q_lon.csv", "c1/frf_p_lon.csv"]).contains(&"response-twice"));
        assert!(codes(["c1/frf_q_lon.csv", "c1/frf_r_ped.csv"]).contains(&"response-unmatched"));
    }

    #[test]
    fn an_airspeed_that_contradicts_the_folder_is_a_problem_until_a_rule_decides() {
        let contradictions = |assembly: &Assembly| -> Vec<ProblemKind> {
            let kinds = assembly
                .problems()
                .iter()
                .map(|problem| problem.kind.clone());
            kinds
                .filter(|kind| matches!(kind, ProblemKind::NameContradiction { .. }))
                .collect()
        };
        let models = vec![found_model("c1_090kt/nominal.mat", None, at_airspeed(70.0))];
        let assembly = Assembly::new(models, Rules::default());
        let expected = ProblemKind::NameContradiction {
            field: "airspeed_kt".into(),
            of_file: 70.0,
            of_name: 90.0,
        };
        assert_eq!(contradictions(&assembly), [expected]);
        let mut rules = Rules::default();
        rules
            .rows
            .entry("c1_090kt/nominal.mat".into())
            .or_default()
            .airspeed_kt = Some(70.0);
        assert_eq!(contradictions(&assembly.with_rules(rules)), []);
        let rounded = Assembly::new(
            vec![found_model("c1_090kt/nominal.mat", None, at_airspeed(90.3))],
            Rules::default(),
        );
        assert_eq!(contradictions(&rounded), []);
    }

    #[test]
    fn runs_of_named_parameters_are_assembled_beside_the_bundle() {
        let models = vec![
            found_model("c1/nominal.mat", None, at_airspeed(70.0)),
            found_model("c1/Ixx+5%.mat", None, at_airspeed(70.0)),
            found_model("c1/nominal Ixx-5%.mat", None, at_airspeed(70.0)),
            found_model("c1/wake.mat", None, at_airspeed(70.0)),
        ];
        let mut rules = proposed_rules("", &models);
        rules.parameters.push(PhysicsParameter {
            name: "Ixx".into(),
            unit: "%".into(),
            plausible_sd: Some(4.0),
            description: String::new(),
        });
        let wake = RowRule {
            parameter: Some(ParameterChange {
                name: "wake".into(),
                delta: 0.25,
                unit: "1".into(),
            }),
            ..RowRule::default()
        };
        rules.rows.insert("c1/wake.mat".into(), wake);
        let assembly = Assembly::new(models, rules);
        let draft = dataset_draft(&assembly.rules, &assembly.parts);
        assert_eq!(draft.parameters[0].plausible_sd, Some(4.0));
        let moved: Vec<Option<(String, f64)>> = draft.conditions[0]
            .physics
            .iter()
            .map(|model| {
                let [change] = model.moved.as_ref()?.changes() else {
                    return None;
                };
                Some((change.name.clone(), change.delta))
            })
            .collect();
        let ixx = |delta| Some(("Ixx".to_owned(), delta));
        assert_eq!(
            moved,
            [None, ixx(5.0), ixx(-5.0), Some(("wake".to_owned(), 0.25))]
        );
    }

    #[test]
    fn a_file_with_several_airspeeds_holds_several_conditions() {
        let mut models = Vec::new();
        for (file, airspeeds) in [
            ("physics.mat", [60.0, 80.0]),
            ("flight/identified.npz", [80.0, 60.0]),
        ] {
            for (page, airspeed_kt) in airspeeds.into_iter().enumerate() {
                models.push(found_model(
                    file,
                    Some(&format!("(:,:,{})", page + 1)),
                    at_airspeed(airspeed_kt),
                ));
            }
        }
        let assembly = Assembly::new(models, Rules::default());
        let rows: Vec<(Option<i64>, Option<RowRole>)> = assembly
            .parts()
            .iter()
            .map(|part| (part.row.condition, part.row.role))
            .collect();
        let nominal = Some(RowRole::Nominal);
        let identified = Some(RowRole::Identified);
        assert_eq!(
            rows,
            [
                (Some(1), nominal),
                (Some(2), nominal),
                (Some(2), identified),
                (Some(1), identified)
            ]
        );
    }

    #[test]
    fn channels_matched_by_position_are_a_caution_and_marked_in_the_dataset() {
        let models = vec![
            found_model("c1_90kt/nominal.mat", None, at_airspeed(90.0)),
            found_model("c1_90kt/identified.mat", None, at_airspeed(90.0)),
        ];
        let mut rules = proposed_rules("", &models);
        for channel in rules.inputs.iter_mut().chain(&mut rules.outputs) {
            (channel.unit, channel.unit_in_files) = ("deg".into(), Some("deg".into()));
        }
        let assembly = Assembly::new(models, rules.clone());
        let cautions = assembly.cautions();
        let both = vec![ChannelSide::Input, ChannelSide::Output];
        assert_eq!(
            cautions,
            [PositionCaution {
                sides: both.clone(),
                parts: vec![0, 1]
            }]
        );
        assert_eq!(cautions[0].code(), "channels-by-position");
        let dataset = assembly.dataset("").unwrap();
        let source = dataset.conditions()[0].bundle(crate::dataset::BundleKind::Physics)[0]
            .source
            .clone()
            .unwrap();
        assert_eq!(source.by_position, both);
        for key in ["c1_90kt/nominal.mat", "c1_90kt/identified.mat"] {
            let row = rules.rows.entry(key.into()).or_default();
            (row.inputs, row.outputs) =
                (Some(vec!["input 1".into()]), Some(vec!["output 1".into()]));
        }
        assert_eq!(assembly.with_rules(rules).cautions(), []);
    }
}
