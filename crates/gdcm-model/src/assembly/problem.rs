//! What is still to be said before the files are a dataset.

use std::collections::{BTreeMap, BTreeSet};

use super::assembly::Part;
use super::channel_match::ChannelMatch;
use super::declarations::FileScope;
use super::found_model::{Row, RowRole};
use super::response_name::ResponseNameError;
use super::rules::{ChannelRule, Rules};
use crate::dataset::channel::ChannelSide;
use crate::dataset::unchecked_dataset::ResponseDraft;

/// What is missing or contradicts itself.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemKind {
    /// No model is taken.
    #[error("no model is included; add files that hold models")]
    NoModels,
    /// The dataset has no inputs, or no outputs.
    #[error("the dataset has no {0}; say which there are")]
    NoChannels(&'static str),
    /// A channel of the dataset has no unit.
    #[error("{0}: choose a unit")]
    NoUnit(String),
    /// Files that do not say the unit of a channel.
    #[error("{0}: choose the unit that it has in files that do not say one")]
    UnitOfFile(String),
    /// A unit that cannot be converted.
    #[error(
        "{channel} has the unit \"{from}\" in the file and \"{to}\" in the dataset: there is no factor from one to the other; enter one"
    )]
    Conversion {
        /// The channel of the dataset.
        channel: String,
        /// The file's unit.
        from: String,
        /// The dataset's unit.
        to: String,
    },
    /// A channel that the model does not have.
    #[error("the model has no {side} {channel}; it has {found}")]
    NoChannel {
        /// Input or output.
        side: ChannelSide,
        /// The channel of the dataset.
        channel: String,
        /// What the file has, in words.
        found: String,
    },
    /// A channel that the file calls by a name which leaves the sign open.
    #[error(
        "{channel} is called {found} in the file, which can be positive the other way: say its sign, 1 or -1 (\"signs\" in the rules)"
    )]
    Sign {
        /// The channel of the dataset.
        channel: String,
        /// Its name in the file.
        found: String,
    },
    /// A model that looks like one of discrete time, and has no sample time.
    #[error(
        "all its poles lie inside the unit circle and {near} of {poles} near 1, as those of a discrete-time model do, and it has no \
         sample time: enter it in s, or 0 of a continuous-time model (--sample-time)"
    )]
    NoSampleTime {
        /// Poles near 1.
        near: usize,
        /// All.
        poles: usize,
    },
    /// A part of the name that says how the trim differs and is not understood.
    #[error("\"{0}\" in its name is not understood: say how its trim differs")]
    TrimPart(String),
    /// Two channels of the model are called the same.
    #[error("two {side}s of the model can be {channel}: {found}; say which")]
    AmbiguousChannel {
        /// Input or output.
        side: ChannelSide,
        /// The channel of the dataset.
        channel: String,
        /// Their names.
        found: String,
    },
    /// Channels without names, and another number of them than the dataset has.
    #[error(
        "the model has {found} {side}s without names, the dataset has {expected}; say their names"
    )]
    Unnamed {
        /// Input or output.
        side: ChannelSide,
        /// How many the dataset has.
        expected: usize,
        /// How many the model has.
        found: usize,
    },
    /// A measured response none of whose channels is one of the dataset.
    #[error(
        "no {side} of the measured response is one of the dataset ({known}): {}. Say it in its headings, \"mag Q/LON [dB]\" (--headings, or \
         \"headings\" in the rules), or in the rules: under \"models\", \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]; or leave it out",
        if found.is_empty() { "neither the file nor its name says one".to_owned() } else { format!("it has {found}") }
    )]
    ResponseUnmatched {
        /// Input or output.
        side: ChannelSide,
        /// The channels that the file names; empty where it names none.
        found: String,
        /// The channels of the dataset.
        known: String,
    },
    /// A measured response whose channels only the name of its file or variable says, and that not clearly.
    #[error(
        "the name \"{name}\" does not say one output and one input: {error}. Say them in the headings, \"mag Q/LON [dB]\" (--headings, or \
         \"headings\" in the rules), or in the rules: under \"models\", \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]"
    )]
    ResponseName {
        /// The name of the file or of the variable.
        name: String,
        /// What is not clear.
        error: ResponseNameError,
    },
    /// Two files give the same response of one measured model.
    #[error(
        "{output}/{input} of the measured model \"{name}\" is in {first} too; leave one of them out, or give one another name: it is a \
         model of its own then"
    )]
    ResponseTwice {
        /// The output.
        output: String,
        /// The input.
        input: String,
        /// The name of the model.
        name: String,
        /// The other file.
        first: String,
    },
    /// More or fewer names are said of a model's channels than it has.
    #[error(
        "{said} names are said for the {found} {side}s of the model; say one for each, in the file's order"
    )]
    Names {
        /// Input or output.
        side: ChannelSide,
        /// How many names.
        said: usize,
        /// How many channels.
        found: usize,
    },
    /// The condition is not said.
    #[error("choose its condition")]
    NoCondition,
    /// The role is not said.
    #[error("choose its role: nominal, perturbed or identified")]
    NoRole,
    /// The airspeed is not said.
    #[error("enter the airspeed of its condition")]
    NoAirspeed,
    /// Rows of one condition contradict one another.
    #[error("condition {condition}: {field} is {first} and {second}; one condition has one")]
    Contradiction {
        /// The condition.
        condition: i64,
        /// What.
        field: &'static str,
        /// In one row.
        first: String,
        /// In another.
        second: String,
    },
    /// A file says otherwise than its name and its folders.
    #[error(
        "its {field} is {} in the file and {} in the names of the file and its folders: correct one, or say which holds (\"{field}\" \
         under \"models\" in the rules)", crate::units::number(*of_file), crate::units::number(*of_name)
    )]
    NameContradiction {
        /// The number, as the rules call it.
        field: String,
        /// In the file.
        of_file: f64,
        /// In the names.
        of_name: f64,
    },
    /// A condition without a nominal model, or with several.
    #[error("condition {condition} has {found} nominal models; it needs exactly one")]
    Nominal {
        /// The condition.
        condition: i64,
        /// How many it has.
        found: usize,
    },
    /// Two models of a bundle have one name.
    #[error("the name \"{name}\" stands twice among the {bundle} models of condition {condition}")]
    Name {
        /// The condition.
        condition: i64,
        /// "physics" or "identified".
        bundle: &'static str,
        /// The name.
        name: String,
    },
    /// A physics model is measured data.
    #[error("a {} model needs matrices; this is measured data", .0.word())]
    MeasuredPhysics(RowRole),
    /// Measured parts of one model are on different frequencies.
    #[error(
        "measured responses of one model must be at the same frequencies; {first} has {} and {second} has {}. Estimate them at the same ones, \
         or give one of them another name: it is a model of its own then",
        grid_words(*first_grid), grid_words(*second_grid)
    )]
    Grids {
        /// One file.
        first: String,
        /// How many frequencies it has, the lowest and the highest \[rad/s\].
        first_grid: (usize, [f64; 2]),
        /// The other file.
        second: String,
        /// Its frequencies.
        second_grid: (usize, [f64; 2]),
    },
    /// What the dataset itself refuses.
    #[error("{0}")]
    Dataset(String),
}

/// "40 from 0.3 to 12.3 rad/s".
fn grid_words((count, [lowest, highest]): (usize, [f64; 2])) -> String {
    format!("{count} from {lowest:.1} to {highest:.1} rad/s")
}

impl ProblemKind {
    /// A stable name of the kind, for scripts and tests.
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

    /// The channel that is asked about, and the option of `gdcm assemble` that answers, without the models that it is for.
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

/// A question about a channel that an option answers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Question {
    channel: String,
    option: &'static str,
    value: &'static str,
}

/// A problem, and the model that has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Index of the model; none of a problem of the whole.
    pub part: Option<usize>,
    /// What it is.
    pub kind: ProblemKind,
    /// The models that ask the same question of a channel, and no others; none where no option answers it.
    pub scope: Option<FileScope>,
}

impl Problem {
    /// A problem of the whole.
    pub fn of_all(kind: ProblemKind) -> Self {
        Self {
            part: None,
            kind,
            scope: None,
        }
    }

    /// A problem of one model.
    pub fn of(part: usize, kind: ProblemKind) -> Self {
        Self {
            part: Some(part),
            kind,
            scope: None,
        }
    }

    /// The option of `gdcm assemble` that answers the question for the models that ask it: "--sign NZ=-1:identified".
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

/// Says of each question about a channel which models ask it: all, those of a role, or this one file. Models without the channel do not
/// count.
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

/// Asks for the sample time of a model without one whose poles lie as those of discrete time do: all inside the unit circle, or as
/// little outside as an unstable mode of a helicopter is, and half of them or more (and at least two) near 1. In continuous time the
/// latter grow within a second.
fn missing_sample_time(part: &Part) -> Option<ProblemKind> {
    /// Real part of a pole near 1, and the magnitude of one that is outside by little.
    const NEAR: f64 = 0.5;
    const OUTSIDE: f64 = 1.05;
    let a = part.found.draft.matrices[0]
        .as_ref()
        .filter(|a| a.is_square() && a.iter().all(|entry| entry.is_finite()))?;
    // The sum of such poles is positive, that of a damped model in continuous time is not: it costs nothing to know.
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
        Some(ProblemKind::Contradiction {
            condition,
            field,
            first,
            second,
        })
    };
    fields.into_iter().filter_map(contradiction).collect()
}

/// Names that stand twice in a bundle; measured responses of one name are parts of one model.
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

/// The first response that a part of a measured model has and an earlier one too.
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
