//! Models found in files, the rules about them, and what both make.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::*;
use crate::dataset::{Dataset, DatasetDraft, Origin, ResponseDraft};

/// One model, and what it is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The model as its file gave it.
    pub found: FoundModel,
    /// What it is to be.
    pub row: Row,
    /// Its inputs in the dataset's order.
    pub inputs: ChannelMatch,
    /// Its outputs in the dataset's order.
    pub outputs: ChannelMatch,
    /// The sample time that is said of it \[s\], as the file has none; 0 of a continuous-time model.
    pub sample_time_s: Option<f64>,
}

/// Models found in files, and what the rules make of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    rules: Rules,
    parts: Vec<Part>,
    problems: Vec<Problem>,
}

impl Default for Assembly {
    /// One without models.
    fn default() -> Self {
        Self::new(Vec::new(), Rules::default())
    }
}

impl Assembly {
    /// What `rules` make of `models`.
    pub fn new(models: Vec<FoundModel>, rules: Rules) -> Self {
        let rows = rows(&models, &rules);
        let with_row = models.into_iter().zip(rows);
        let parts = with_row.map(|(found, row)| part_of(found, row, &rules)).collect();
        let mut assembly = Self { rules, parts, problems: Vec::new() };
        assembly.problems = assembly.find_problems();
        assembly
    }

    /// The same models under other rules.
    pub fn with_rules(&self, rules: Rules) -> Self {
        Self::new(self.parts.iter().map(|part| part.found.clone()).collect(), rules)
    }

    /// The rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// The models, in the order in which they were found.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What is still to be said; nothing where the dataset can be made.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// A problem in words, with the model that has it.
    pub fn words(&self, problem: &Problem) -> String {
        match problem.part {
            Some(part) => format!("{}: {}", self.parts[part].found.key(), problem.kind),
            None => problem.kind.to_string(),
        }
    }

    /// The problems in words, those of many models once: with the first model that has it, and how many others do.
    pub fn told(&self) -> Vec<(Option<usize>, String)> {
        let mut kinds: Vec<(&Problem, usize)> = Vec::new();
        for problem in &self.problems {
            match kinds.iter_mut().find(|(known, _)| known.kind == problem.kind) {
                Some((_, count)) => *count += 1,
                None => kinds.push((problem, 1)),
            }
        }
        let words = |(problem, count): (&Problem, usize)| {
            let others = match count - 1 {
                0 => String::new(),
                1 => " (and 1 other model)".to_owned(),
                others => format!(" (and {others} other models)"),
            };
            (problem.part, format!("{}{others}", self.words(problem)))
        };
        kinds.into_iter().map(words).collect()
    }

    /// The dataset; none while there are problems. Models and flight records name their files with `folder` before them, which
    /// leads to the files from where the dataset is to lie.
    pub fn dataset(&self, folder: &str) -> Option<Dataset> {
        if !self.problems.is_empty() {
            return None;
        }
        let mut draft = self.draft();
        for condition in &mut draft.conditions {
            let models = condition.physics.iter_mut().chain(&mut condition.identified);
            let of_models = models.filter_map(|model| model.source.as_mut()?.file.as_mut());
            let of_records = condition.records.iter_mut().map(|record| &mut record.file);
            for file in of_models.chain(of_records).filter(|file| !folder.is_empty() && !Path::new(file).is_absolute())
            {
                *file = format!("{folder}/{file}");
            }
        }
        draft.checked().ok().map(|(dataset, _)| dataset)
    }

    fn draft(&self) -> DatasetDraft {
        merged(&self.rules, &self.parts)
    }

    /// The models that are taken.
    fn taken(&self) -> impl Iterator<Item = (usize, &Part)> {
        self.parts.iter().enumerate().filter(|(_, part)| !part.row.left_out)
    }

    fn find_problems(&self) -> Vec<Problem> {
        let mut problems = self.channel_problems();
        if self.taken().next().is_none() {
            problems.push(Problem::of_all(ProblemKind::NoModels));
        }
        for (index, part) in self.taken() {
            let said = self.rules.rows.get(&part.found.key());
            if part.row.role != Some(RowRole::Identified) && said.is_none_or(|said| said.perturbation.is_none()) {
                let unread = part.row.unread.iter().cloned();
                problems.extend(unread.map(|part| Problem::of(index, ProblemKind::TrimPart { part })));
            }
            problems.extend(row_problems(part).into_iter().map(|kind| Problem::of(index, kind)));
            let of_channels = part.inputs.problems.iter().chain(&part.outputs.problems);
            problems.extend(of_channels.map(|kind| Problem::of(index, kind.clone())));
        }
        problems.extend(self.condition_problems());
        if problems.is_empty()
            && let Err(error) = self.draft().checked()
        {
            problems.push(Problem::of_all(ProblemKind::Dataset(format!("{}: {}", error.place, error.fault))));
        }
        problems
    }

    fn channel_problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        for (side, channels) in [("inputs", &self.rules.inputs), ("outputs", &self.rules.outputs)] {
            if channels.is_empty() {
                problems.push(Problem::of_all(ProblemKind::NoChannels(side)));
            }
            let without = channels.iter().filter(|channel| channel.unit.trim().is_empty());
            problems.extend(without.map(|channel| Problem::of_all(ProblemKind::NoUnit(channel.name.clone()))));
        }
        problems
    }

    fn condition_problems(&self) -> Vec<Problem> {
        let mut conditions: BTreeMap<i64, Vec<(usize, &Part)>> = BTreeMap::new();
        for (index, part) in self.taken() {
            if let Some(condition) = part.row.condition {
                conditions.entry(condition).or_default().push((index, part));
            }
        }
        conditions.iter().flat_map(|(condition, parts)| problems_of_condition(*condition, parts)).collect()
    }
}

fn part_of(found: FoundModel, row: Row, rules: &Rules) -> Part {
    let said = rules.rows.get(&found.key());
    let labels = |labels: &[ChannelLabel], names: Option<&Vec<String>>| -> Vec<ChannelLabel> {
        let named = |(index, label): (usize, &ChannelLabel)| ChannelLabel {
            name: names.and_then(|names| names.get(index)).cloned().or_else(|| label.name.clone()),
            unit: label.unit.clone(),
        };
        labels.iter().enumerate().map(named).collect()
    };
    let inputs = labels(&found.inputs, said.and_then(|said| said.inputs.as_ref()));
    let outputs = labels(&found.outputs, said.and_then(|said| said.outputs.as_ref()));
    // A measured response may be one of several files that belong together.
    let partial = found.draft.response.is_some();
    let signs = rules.signs_of(&found.key(), row.role);
    let matched = |side, labels: &[ChannelLabel], channels: &[ChannelRule]| {
        ChannelMatch::of(side, labels, channels, (&rules.units, &signs), partial)
    };
    let mut channels = [matched("input", &inputs, &rules.inputs), matched("output", &outputs, &rules.outputs)];
    let names = said.map_or([None, None], |said| [said.inputs.as_ref(), said.outputs.as_ref()]);
    let counts = [("input", inputs.len()), ("output", outputs.len())];
    for ((of_side, names), (side, found)) in channels.iter_mut().zip(names).zip(counts) {
        if let Some(names) = names.filter(|names| names.len() != found) {
            of_side.problems.push(ProblemKind::Names { side, said: names.len(), found });
        }
    }
    let [inputs, outputs] = channels;
    let sample_time_s = said.and_then(|said| said.sample_time_s).or(rules.sample_time_s);
    let sample_time_s = sample_time_s.filter(|_| found.draft.timing.sample_time_s.is_none() && !partial);
    Part { found, row, inputs, outputs, sample_time_s }
}

/// What names, contents and rules say of each model.
fn rows(models: &[FoundModel], rules: &Rules) -> Vec<Row> {
    let mut rows: Vec<Row> = models.iter().map(|model| proposed_row(model, models, rules)).collect();
    number_conditions(models, &mut rows);
    propose_nominal(&mut rows);
    for (model, row) in models.iter().zip(&mut rows) {
        if let Some(said) = rules.rows.get(&model.key()) {
            said.apply(row);
        }
    }
    rows
}

fn proposed_row(model: &FoundModel, all: &[FoundModel], rules: &Rules) -> Row {
    let facts = &model.facts;
    let mut row = Row {
        condition: facts.condition,
        airspeed_kt: facts.airspeed_kt,
        altitude_ft: facts.altitude_ft,
        mass_kg: facts.mass_kg,
        ..Row::default()
    };
    let path = without_extension(model.file());
    let name = if model.variable().is_empty() { path.clone() } else { format!("{path}#{}", model.variable()) };
    for pattern in &rules.patterns {
        pattern.read(&name, &mut row);
    }
    // What else a hyphen and a number may be ("rev-3") is not asked about.
    if !row.perturbation.is_empty() {
        row.unread = unread_offsets(name.rsplit('/').next().unwrap_or(&name), &rules.patterns);
    }
    if let Origin::Identified { method, .. } = &model.draft.origin {
        row.role = row.role.or(Some(RowRole::Identified));
        row.method = row.method.or_else(|| method.clone());
    }
    if row.role.is_none() && model.response().is_some() {
        row.role = Some(RowRole::Identified);
    }
    if row.role.is_none() && !row.perturbation.is_empty() {
        row.role = Some(RowRole::Perturbed);
    }
    if row.name.is_empty() {
        row.name = usual_name(model, all, rules, &path);
    }
    row
}

/// The file's name without its folder; the variable beside it where the file holds several models; "measured" of a response that
/// is one part of a model.
fn usual_name(model: &FoundModel, all: &[FoundModel], rules: &Rules, path: &str) -> String {
    let is_part = model.inputs.len() * model.outputs.len() < rules.inputs.len() * rules.outputs.len();
    if model.response().is_some() && is_part {
        return "measured".to_owned();
    }
    let stem = path.rsplit('/').next().unwrap_or(path);
    let several = all.iter().filter(|other| other.file() == model.file()).count() > 1;
    match (several, model.variable()) {
        (true, variable) if !variable.is_empty() => variable.to_owned(),
        _ if stem.is_empty() => model.draft.name.clone(),
        _ => stem.to_owned(),
    }
}

fn without_extension(file: &str) -> String {
    let file = file.replace('\\', "/");
    let file = file.strip_suffix(".gz").unwrap_or(&file);
    Path::new(file).with_extension("").to_string_lossy().into_owned()
}

/// Where no name says a number, each folder is a condition, in the order of their names.
fn number_conditions(models: &[FoundModel], rows: &mut [Row]) {
    if rows.iter().any(|row| row.condition.is_some()) {
        return;
    }
    let folder = |model: &FoundModel| match without_extension(model.file()).rsplit_once('/') {
        Some((folder, _)) => folder.to_owned(),
        None => String::new(),
    };
    let folders: BTreeSet<String> = models.iter().map(folder).collect();
    for (model, row) in models.iter().zip(rows) {
        row.condition = folders.iter().position(|of| *of == folder(model)).map(|index| index as i64 + 1);
    }
}

/// The only physics model of a condition at no perturbed trim is nominal.
fn propose_nominal(rows: &mut [Row]) {
    let conditions: BTreeSet<i64> = rows.iter().filter_map(|row| row.condition).collect();
    for condition in conditions {
        let of = |row: &&mut Row| row.condition == Some(condition);
        let has_nominal = rows.iter_mut().filter(of).any(|row| row.role == Some(RowRole::Nominal));
        let mut open: Vec<&mut Row> = rows.iter_mut().filter(of).filter(|row| row.role.is_none()).collect();
        if let ([row], false) = (open.as_mut_slice(), has_nominal) {
            row.role = Some(RowRole::Nominal);
        }
    }
}

fn row_problems(part: &Part) -> Vec<ProblemKind> {
    let mut problems = Vec::new();
    if part.row.condition.is_none() {
        problems.push(ProblemKind::NoCondition);
    }
    match part.row.role {
        None => problems.push(ProblemKind::NoRole),
        Some(role @ (RowRole::Nominal | RowRole::Perturbed)) if part.found.response().is_some() => {
            problems.push(ProblemKind::MeasuredPhysics(role));
        }
        Some(_) => {}
    }
    problems.extend(part.sample_time_s.is_none().then(|| missing_sample_time(part)).flatten());
    problems
}

/// Asks for the sample time of a model without one whose poles lie as those of discrete time do: all inside the unit circle, or as
/// little outside as an unstable mode of a helicopter is, and half of them or more (and at least two) near 1. In continuous time the
/// latter grow within a second.
fn missing_sample_time(part: &Part) -> Option<ProblemKind> {
    /// Real part of a pole near 1, and the magnitude of one that is outside by little.
    const NEAR: f64 = 0.5;
    const OUTSIDE: f64 = 1.05;
    let a =
        part.found.draft.matrices[0].as_ref().filter(|a| a.is_square() && a.iter().all(|entry| entry.is_finite()))?;
    // The sum of such poles is positive, that of a damped model in continuous time is not: it costs nothing to know.
    if part.found.draft.timing.sample_time_s.is_some() || a.nrows() < 2 || a.trace() <= 0.0 {
        return None;
    }
    let poles = a.complex_eigenvalues();
    let near = poles.iter().filter(|pole| pole.re > NEAR).count();
    let is_discrete = poles.iter().all(|pole| pole.norm() <= OUTSIDE) && near >= 2 && 2 * near >= poles.len();
    is_discrete.then_some(ProblemKind::NoSampleTime { near, poles: poles.len() })
}

fn problems_of_condition(condition: i64, parts: &[(usize, &Part)]) -> Vec<Problem> {
    let first = parts[0].0;
    let mut kinds = contradictions(condition, parts);
    if parts.iter().all(|(_, part)| part.row.airspeed_kt.is_none()) {
        kinds.push(ProblemKind::NoAirspeed);
    }
    let count = |role: RowRole| parts.iter().filter(|(_, part)| part.row.role == Some(role)).count();
    if count(RowRole::Nominal) != 1 {
        kinds.push(ProblemKind::Nominal { condition, found: count(RowRole::Nominal) });
    }
    if count(RowRole::Identified) == 0 {
        kinds.push(ProblemKind::NoIdentified { condition });
    }
    let mut problems: Vec<Problem> = kinds.into_iter().map(|kind| Problem::of(first, kind)).collect();
    problems.extend(name_problems(condition, parts));
    problems
}

/// A field of a flight condition: its name, and what a row says of it.
type Field<'f> = (&'static str, &'f dyn Fn(&Row) -> Option<String>);

fn contradictions(condition: i64, parts: &[(usize, &Part)]) -> Vec<ProblemKind> {
    let number = |value: Option<f64>| value.map(crate::units::number);
    let fields: [Field<'_>; 5] = [
        ("airspeed [kt]", &|row| number(row.airspeed_kt)),
        ("altitude [ft]", &|row| number(row.altitude_ft)),
        ("mass [kg]", &|row| number(row.mass_kg)),
        ("altitude", &|row| row.altitude.clone()),
        ("weight", &|row| row.weight.clone()),
    ];
    let contradiction = |(field, of): Field<'_>| {
        let mut values = parts.iter().filter_map(|(_, part)| of(&part.row));
        let first = values.next()?;
        let second = values.find(|value| *value != first)?;
        Some(ProblemKind::Contradiction { condition, field, first, second })
    };
    fields.into_iter().filter_map(contradiction).collect()
}

/// Names that stand twice in a bundle; measured responses of one name are parts of one model.
fn name_problems(condition: i64, parts: &[(usize, &Part)]) -> Vec<Problem> {
    let mut seen: BTreeMap<(bool, &str), &Part> = BTreeMap::new();
    let mut problems = Vec::new();
    for (index, part) in parts {
        let is_identified = part.row.role == Some(RowRole::Identified);
        let Some(earlier) = seen.insert((is_identified, &part.row.name), part) else { continue };
        match (earlier.found.response(), part.found.response()) {
            (Some(a), Some(b)) if a.omega == b.omega => {}
            (Some(a), Some(b)) => {
                let grid = |of: &ResponseDraft| {
                    let end = |omega: Option<&f64>| omega.copied().unwrap_or(f64::NAN);
                    (of.omega.len(), [end(of.omega.first()), end(of.omega.last())])
                };
                let (first, second) = (earlier.found.key(), part.found.key());
                let kind = ProblemKind::Grids { first, first_grid: grid(a), second, second_grid: grid(b) };
                problems.push(Problem::of(*index, kind));
            }
            _ => {
                let bundle = if is_identified { "identified" } else { "physics" };
                let name = part.row.name.clone();
                problems.push(Problem::of(*index, ProblemKind::Name { condition, bundle, name }));
            }
        }
    }
    problems
}
