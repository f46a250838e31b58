//! Open questions and contradictions that keep the files from forming a dataset.

use std::collections::{BTreeMap, BTreeSet};

use super::assembly::Part;
use super::channel_match::ChannelMatch;
use super::declarations::FileScope;
use super::found_model::{Row, RowRole};
use super::response_name::ResponseNameError;
use super::rules::{ChannelRule, Rules};
use crate::dataset::channel::ChannelSide;
use crate::dataset::unchecked_dataset::ResponseDraft;

/// A missing or contradictory fact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemKind {
    /// Every model is left out.
    #[error("no model is included; add files that hold models")]
    NoModels,
    /// The dataset has no inputs, or no outputs.
    #[error("the dataset has no {0}; say which there are")]
    NoChannels(&'static str),
    /// A channel of the dataset has no unit.
    #[error("{0}: choose a unit")]
    NoUnit(String),
    /// Files that do not give the unit of a channel.
    #[error("{0}: choose the unit that it has in files that do not say one")]
    UnitOfFile(String),
    /// A unit that cannot be converted.
    #[error(
        "{channel} has the unit \"{from}\" in the file and \"{to}\" in the dataset: there is no factor from one to the other; enter one"
    )]
    Conversion {
        channel: String,
        from: String,
        to: String,
    },
    /// A channel that the model does not have.
    #[error("the model has no {side} {channel}; it has {found}")]
    NoChannel {
        side: ChannelSide,
        channel: String,
        /// Channels of the file, in words.
        found: String,
    },
    /// A channel whose name in the file leaves the sign open.
    #[error(
        "{channel} is called {found} in the file, which can be positive the other way: say its sign, 1 or -1 (\"signs\" in the rules)"
    )]
    Sign {
        channel: String,
        /// Its name in the file.
        found: String,
    },
    /// A model that looks discrete-time but has no sample time.
    #[error(
        "all its poles lie inside the unit circle and {near} of {poles} near 1, as those of a discrete-time model do, and it has no \
         sample time: enter it in s, or 0 of a continuous-time model (--sample-time)"
    )]
    NoSampleTime {
        near: usize,
        /// Number of all poles.
        poles: usize,
    },
    /// A part of the name that looks like a trim offset and is not understood.
    #[error("\"{0}\" in its name is not understood: say how its trim differs")]
    TrimPart(String),
    /// Two channels of the model match the same dataset channel.
    #[error("two {side}s of the model can be {channel}: {found}; say which")]
    AmbiguousChannel {
        side: ChannelSide,
        channel: String,
        found: String,
    },
    /// Channels without names whose number differs from the dataset's.
    #[error(
        "the model has {found} {side}s without names, the dataset has {expected}; say their names"
    )]
    Unnamed {
        side: ChannelSide,
        /// Number in the dataset.
        expected: usize,
        /// Number in the model.
        found: usize,
    },
    /// A measured response none of whose channels is in the dataset.
    #[error(
        "no {side} of the measured response is one of the dataset ({known}): {}. Say it in its headings, \"mag Q/LON [dB]\" (--headings, or \
         \"headings\" in the rules), or in the rules: under \"models\", \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]; or leave it out",
        if found.is_empty() { "neither the file nor its name says one".to_owned() } else { format!("it has {found}") }
    )]
    ResponseUnmatched {
        side: ChannelSide,
        /// The channels named by the file; empty where it names none.
        found: String,
        known: String,
    },
    /// A measured response whose channels appear only in the name of its file or variable,
    /// ambiguously.
    #[error(
        "the name \"{name}\" does not say one output and one input: {error}. Say them in the headings, \"mag Q/LON [dB]\" (--headings, or \
         \"headings\" in the rules), or in the rules: under \"models\", \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]"
    )]
    ResponseName {
        /// The name of the file or of the variable.
        name: String,
        error: ResponseNameError,
    },
    /// Two files give the same response of one measured model.
    #[error(
        "{output}/{input} of the measured model \"{name}\" is in {first} too; leave one of them out, or give one another name: it is a \
         model of its own then"
    )]
    ResponseTwice {
        output: String,
        input: String,
        name: String,
        first: String,
    },
    /// The number of declared channel names differs from the number of the model's channels.
    #[error(
        "{said} names are said for the {found} {side}s of the model; say one for each, in the file's order"
    )]
    Names {
        side: ChannelSide,
        /// Number of names.
        said: usize,
        /// Number of channels.
        found: usize,
    },
    /// The condition is unknown.
    #[error("choose its condition")]
    NoCondition,
    /// The role is unknown.
    #[error("choose its role: nominal, perturbed or identified")]
    NoRole,
    /// The airspeed is unknown.
    #[error("enter the airspeed of its condition")]
    NoAirspeed,
    /// Rows of one condition contradict one another.
    #[error("condition {condition}: {field} is {first} and {second}; one condition has one")]
    Contradiction {
        condition: i64,
        /// The contradictory field.
        field: &'static str,
        /// Value in one row.
        first: String,
        /// Value in another row.
        second: String,
    },
    /// A file contradicts its name and its folders.
    #[error(
        "its {field} is {} in the file and {} in the names of the file and its folders: correct one, or say which holds (\"{field}\" \
         under \"models\" in the rules)", crate::units::number(*of_file), crate::units::number(*of_name)
    )]
    NameContradiction {
        /// The quantity, by its name in the rules.
        field: String,
        of_file: f64,
        of_name: f64,
    },
    /// A condition without a nominal model, or with several.
    #[error("condition {condition} has {found} nominal models; it needs exactly one")]
    Nominal {
        condition: i64,
        /// Number of nominal models.
        found: usize,
    },
    /// Two models of a bundle share a name.
    #[error("the name \"{name}\" stands twice among the {bundle} models of condition {condition}")]
    Name {
        condition: i64,
        /// "physics" or "identified".
        bundle: &'static str,
        name: String,
    },
    /// A physics model given as measured data.
    #[error("a {} model needs matrices; this is measured data", .0.word())]
    MeasuredPhysics(RowRole),
    /// Measured parts of one model have different frequency grids.
    #[error(
        "measured responses of one model must be at the same frequencies; {first} has {} and {second} has {}. Estimate them at the same ones, \
         or give one of them another name: it is a model of its own then",
        grid_words(*first_grid), grid_words(*second_grid)
    )]
    Grids {
        first: String,
        /// Number of frequencies, the lowest and the highest \[rad/s\].
        first_grid: (usize, [f64; 2]),
        second: String,
        second_grid: (usize, [f64; 2]),
    },
    /// A fault found by the checks of the dataset.
    #[error("{0}")]
    Dataset(String),
}

/// Formats a frequency grid: "40 from 0.3 to 12.3 rad/s".
fn grid_words((count, [lowest, highest]): (usize, [f64; 2])) -> String {
    format!("{count} from {lowest:.1} to {highest:.1} rad/s")
}

impl ProblemKind {
    /// Returns a stable code of the kind, for scripts and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoModels => "no-models",
            Self::NoChannels(_) => "no-channels",
            Self::NoUnit(_) => "no-unit",
            Self::UnitOfFile(_) => "unit-of-file",
            Self::Conversion { .. } => "conversion",
            Self::NoChannel { .. } => "no-channel",
            Self::Sign { .. } => "sign",
            Self::NoSampleTime { .. } => "no-sample-time",
            Self::TrimPart(_) => "trim-part",
            Self::AmbiguousChannel { .. } => "ambiguous-channel",
            Self::Unnamed { .. } => "unnamed-channels",
            Self::ResponseUnmatched { .. } => "response-unmatched",
            Self::ResponseName { .. } => "response-name",
            Self::ResponseTwice { .. } => "response-twice",
            Self::Names { .. } => "names",
            Self::NoCondition => "no-condition",
            Self::NoRole => "no-role",
            Self::NoAirspeed => "no-airspeed",
            Self::Contradiction { .. } => "contradiction",
            Self::NameContradiction { .. } => "name-contradiction",
            Self::Nominal { .. } => "nominal",
            Self::Name { .. } => "duplicate-name",
            Self::MeasuredPhysics(_) => "measured-physics",
            Self::Grids { .. } => "grids",
            Self::Dataset(_) => "dataset",
        }
    }

    /// Returns the channel in question and the option of `gdcm assemble` that answers it, without
    /// the scope.
    fn question(&self) -> Option<Question> {
        let (channel, option, value) = match self {
            Self::Sign { channel, .. } => (channel, "--sign", "-1"),
            Self::UnitOfFile(channel) => (channel, "--unit", "UNIT"),
            Self::Conversion { channel, .. } => (channel, "--factor", "X"),
            _ => return None,
        };
        Some(Question {
            channel: channel.clone(),
            option,
            value,
        })
    }
}

/// A question about a channel that a command-line option answers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Question {
    channel: String,
    option: &'static str,
    value: &'static str,
}

/// A problem with its model.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Index of the model; `None` for a problem of the whole dataset.
    pub part: Option<usize>,
    pub kind: ProblemKind,
    /// Scope covering exactly the models that raise the same question about a channel; `None` where
    /// no option answers it.
    pub scope: Option<FileScope>,
}

impl Problem {
    /// Creates a problem of the whole dataset.
    pub fn of_all(kind: ProblemKind) -> Self {
        Self {
            part: None,
            kind,
            scope: None,
        }
    }

    /// Creates a problem of one model.
    pub fn of(part: usize, kind: ProblemKind) -> Self {
        Self {
            part: Some(part),
            kind,
            scope: None,
        }
    }

    /// Returns the option of `gdcm assemble` that answers the question for the models that raise
    /// it: "--sign NZ=-1:identified".
    pub fn option(&self) -> Option<String> {
        let Question {
            channel,
            option,
            value,
        } = self.kind.question()?;
        let said = format!("{channel}={value}:{}", self.scope.as_ref()?);
        let is_plain =
            |letter: char| letter.is_ascii_alphanumeric() || "=-+_./:#,%".contains(letter);
        if said.chars().all(is_plain) {
            Some(format!("{option} {said}"))
        } else {
            Some(format!("{option} '{said}'"))
        }
    }
}

/// Determines for each question about a channel which models raise it: all, those of a role, or a
/// single file. Models without the channel do not count.
pub(super) fn find_scopes(problems: &mut [Problem], parts: &[Part], rules: &Rules) {
    let mut asking: BTreeMap<Question, BTreeSet<usize>> = BTreeMap::new();
    for problem in problems.iter() {
        if let (Some(part), Some(question)) = (problem.part, problem.kind.question()) {
            asking.entry(question).or_default().insert(part);
        }
    }
    let scope_of = |index: usize| parts[index].row.role.map(FileScope::of_role);
    let mut asked_by: BTreeMap<&Question, Vec<FileScope>> = BTreeMap::new();
    for (question, asking) in &asking {
        let having: Vec<usize> = (0..parts.len())
            .filter(|index| {
                !parts[*index].row.left_out && has_channel(&parts[*index], &question.channel, rules)
            })
            .collect();
        let whole = asked_by.entry(question).or_default();
        for scope in [FileScope::Physics, FileScope::Identified] {
            let mut of_role = having
                .iter()
                .filter(|index| scope_of(**index) == Some(scope.clone()))
                .peekable();
            if of_role.peek().is_some() && of_role.all(|index| asking.contains(index)) {
                whole.push(scope);
            }
        }
        if whole.len() == 2 && having.iter().all(|index| asking.contains(index)) {
            *whole = vec![FileScope::All];
        }
    }
    for problem in problems {
        let (Some(part), Some(question)) = (problem.part, problem.kind.question()) else {
            continue;
        };
        let whole = asked_by
            .get(&question)
            .map(Vec::as_slice)
            .unwrap_or_default();
        let own = scope_of(part);
        let found = whole
            .iter()
            .find(|scope| **scope == FileScope::All || Some(*scope) == own.as_ref());
        problem.scope = Some(
            found
                .cloned()
                .unwrap_or_else(|| FileScope::Files(parts[part].found.key())),
        );
    }
}

fn has_channel(part: &Part, channel: &str, rules: &Rules) -> bool {
    let has = |rules: &[ChannelRule], matched: &ChannelMatch| {
        let mut uses = rules.iter().zip(&matched.uses);
        uses.any(|(rule, used)| rule.name == channel && used.is_some())
    };
    has(&rules.inputs, &part.inputs) || has(&rules.outputs, &part.outputs)
}

pub(super) fn row_problems(part: &Part) -> Vec<ProblemKind> {
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
    problems.extend(
        part.sample_time_s
            .is_none()
            .then(|| missing_sample_time(part))
            .flatten(),
    );
    problems
}

/// Reports a missing sample time for a model whose poles look discrete-time: all inside the unit
/// circle, or as little outside as an unstable helicopter mode would be, and at least half of them
/// (and at least two) near 1. In continuous time, poles near 1 would grow within a second.
fn missing_sample_time(part: &Part) -> Option<ProblemKind> {
    /// Real part from which a pole counts as near 1, and largest magnitude of a pole slightly
    /// outside.
    const NEAR: f64 = 0.5;
    const OUTSIDE: f64 = 1.05;
    let a = part.found.draft.matrices[0]
        .as_ref()
        .filter(|a| a.is_square() && a.iter().all(|entry| entry.is_finite()))?;
    // Cheap test first: the sum of such poles is positive, that of a damped continuous-time model
    // is not.
    if part.found.draft.timing.sample_time_s.is_some() || a.nrows() < 2 || a.trace() <= 0.0 {
        return None;
    }
    let poles = a.complex_eigenvalues();
    let near = poles.iter().filter(|pole| pole.re > NEAR).count();
    let is_discrete =
        poles.iter().all(|pole| pole.norm() <= OUTSIDE) && near >= 2 && 2 * near >= poles.len();
    is_discrete.then_some(ProblemKind::NoSampleTime {
        near,
        poles: poles.len(),
    })
}

pub(super) fn problems_of_condition(
    condition: i64,
    parts: &[(usize, &Part)],
    rules: &Rules,
) -> Vec<Problem> {
    let first = parts[0].0;
    let mut kinds = contradictions(condition, parts);
    if parts.iter().all(|(_, part)| part.row.airspeed_kt.is_none()) {
        kinds.push(ProblemKind::NoAirspeed);
    }
    let count = |role: RowRole| {
        parts
            .iter()
            .filter(|(_, part)| part.row.role == Some(role))
            .count()
    };
    if count(RowRole::Nominal) != 1 {
        kinds.push(ProblemKind::Nominal {
            condition,
            found: count(RowRole::Nominal),
        });
    }
    let mut problems: Vec<Problem> = kinds
        .into_iter()
        .map(|kind| Problem::of(first, kind))
        .collect();
    problems.extend(name_problems(condition, parts, rules));
    problems
}

/// A field of a flight condition: its name and its value in a row.
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
        Some(ProblemKind::Contradiction {
            condition,
            field,
            first,
            second,
        })
    };
    fields.into_iter().filter_map(contradiction).collect()
}

/// Returns duplicate names in a bundle; measured responses with the same name are parts of one
/// model.
fn name_problems(condition: i64, parts: &[(usize, &Part)], rules: &Rules) -> Vec<Problem> {
    let mut seen: BTreeMap<(bool, &str), Vec<&Part>> = BTreeMap::new();
    let mut problems = Vec::new();
    for (index, part) in parts {
        let is_identified = part.row.role == Some(RowRole::Identified);
        let earlier = seen.entry((is_identified, &part.row.name)).or_default();
        let last = earlier.last().copied();
        let kind = match last.map(|last| (last, last.found.response(), part.found.response())) {
            None => None,
            Some((_, Some(a), Some(b))) if a.omega == b.omega => {
                twice_measured(part, earlier, rules)
            }
            Some((last, Some(a), Some(b))) => {
                let grid = |of: &ResponseDraft| {
                    let end = |omega: Option<&f64>| omega.copied().unwrap_or(f64::NAN);
                    (
                        of.omega.len(),
                        [end(of.omega.first()), end(of.omega.last())],
                    )
                };
                let first = last.found.key();
                let second = part.found.key();
                Some(ProblemKind::Grids {
                    first,
                    first_grid: grid(a),
                    second,
                    second_grid: grid(b),
                })
            }
            Some(_) => {
                let bundle = if is_identified {
                    "identified"
                } else {
                    "physics"
                };
                Some(ProblemKind::Name {
                    condition,
                    bundle,
                    name: part.row.name.clone(),
                })
            }
        };
        problems.extend(kind.map(|kind| Problem::of(*index, kind)));
        earlier.push(part);
    }
    problems
}

/// Returns the first response that a part of a measured model and an earlier part both have.
fn twice_measured(part: &Part, earlier: &[&Part], rules: &Rules) -> Option<ProblemKind> {
    for (output, of_output) in rules.outputs.iter().enumerate() {
        for (input, of_input) in rules.inputs.iter().enumerate() {
            let measures = |part: &Part| {
                let used = |matched: &ChannelMatch, index: usize| {
                    matched.uses.get(index).is_some_and(Option::is_some)
                };
                used(&part.outputs, output) && used(&part.inputs, input)
            };
            if measures(part)
                && let Some(first) = earlier.iter().find(|part| measures(part))
            {
                return Some(ProblemKind::ResponseTwice {
                    output: of_output.name.clone(),
                    input: of_input.name.clone(),
                    name: part.row.name.clone(),
                    first: first.found.key(),
                });
            }
        }
    }
    None
}
