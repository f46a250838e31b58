//! Search for problems in models and conditions: missing and contradictory facts that keep them
//! from forming a dataset.
//!
//! A *part* is a model found in a file, its *row* the facts about it (condition, role, airspeed),
//! from its file, its name and the rules, which the engineer enters.

use std::collections::BTreeMap;

use super::indexed_part::IndexedPart;
use super::part::Part;
use super::problem::{GridSpan, Problem, ProblemKind};
use super::row::Row;
use super::rules::Rules;
use crate::names::RowRole;
use crate::number_format::number;

/// Returns a problem for each missing channel list, and for each dataset channel without a unit.
pub(super) fn channel_problems(rules: &Rules) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (side, channels) in [("inputs", &rules.inputs), ("outputs", &rules.outputs)] {
        if channels.is_empty() {
            problems.push(Problem::in_dataset(ProblemKind::NoChannels(side)));
        }
        for channel in channels {
            if channel.unit.trim().is_empty() {
                let kind = ProblemKind::NoUnit(channel.name.clone());
                problems.push(Problem::in_dataset(kind));
            }
        }
    }
    problems
}

/// Finds a model's problems: trim offsets, contradictions with its name, missing facts, channels.
pub(super) fn part_problems(part: &Part, rules: &Rules) -> Vec<ProblemKind> {
    let rule = rules.rows.get(&part.found.key());
    let mut problems = Vec::new();
    let has_trim_rule = rule.is_some_and(|rule| rule.perturbation.is_some());
    if part.row.role != Some(RowRole::Identified) && !has_trim_rule {
        for text in &part.row.unread {
            problems.push(ProblemKind::TrimPart(text.clone()));
        }
    }
    for contradiction in &part.row.contradictions {
        if rule.is_none_or(|rule| !rule.settles(&contradiction.field)) {
            problems.push(ProblemKind::NameContradiction {
                field: contradiction.field.clone(),
                of_file: contradiction.of_file,
                of_name: contradiction.of_name,
            });
        }
    }
    problems.extend(row_problems(part));
    problems.extend_from_slice(&part.inputs.problems);
    problems.extend_from_slice(&part.outputs.problems);
    problems
}

/// Finds missing facts in a row, and a role or a sample time that its model contradicts.
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
    if part.sample_time_s.is_none() {
        problems.extend(sample_time_problem(part));
    }
    problems
}

/// Returns a problem if a model has no sample time but its poles look discrete-time.
///
/// Discrete-time poles are `e^(lambda T)`, with the poles `lambda` and the sample time T: inside
/// the unit circle, or as little outside as an unstable helicopter mode, and near 1 for modes that
/// are slow compared with T. A model looks like that if all its poles have a magnitude up to 1.05,
/// and at least half of them (two or more) a real part above 0.5. As continuous-time poles, the
/// latter would be modes that diverge by a factor of e within two seconds.
fn sample_time_problem(part: &Part) -> Option<ProblemKind> {
    /// Real part above which a pole is regarded as near 1.
    const LEAST_REAL_PART: f64 = 0.5;
    /// Maximum pole magnitude; above 1 to admit unstable modes.
    const GREATEST_MAGNITUDE: f64 = 1.05;
    let a = part.found.draft.matrices[0].as_ref()?;
    if !a.is_square() || a.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    // Test the trace first, which is cheap: it is the sum of the poles, positive for poles near 1
    // and negative for a damped continuous-time model.
    if part.found.draft.timing.sample_time_s.is_some() || a.nrows() < 2 || a.trace() <= 0.0 {
        return None;
    }
    let poles = a.complex_eigenvalues();
    let near = poles
        .iter()
        .filter(|pole| pole.re > LEAST_REAL_PART)
        .count();
    let are_small = poles.iter().all(|pole| pole.norm() <= GREATEST_MAGNITUDE);
    if are_small && near >= 2 && 2 * near >= poles.len() {
        Some(ProblemKind::NoSampleTime {
            near,
            poles: poles.len(),
        })
    } else {
        None
    }
}

/// Finds a condition's problems; `parts` has at least one model. Problems with the condition as a
/// whole are attributed to its first model.
pub(super) fn condition_problems(
    condition: i64,
    parts: &[IndexedPart<'_>],
    rules: &Rules,
) -> Vec<Problem> {
    let mut kinds = contradictions(condition, parts);
    if parts.iter().all(|part| part.part.row.airspeed_kt.is_none()) {
        kinds.push(ProblemKind::NoAirspeed);
    }
    let nominal_count = parts
        .iter()
        .filter(|part| part.part.row.role == Some(RowRole::Nominal))
        .count();
    if nominal_count != 1 {
        kinds.push(ProblemKind::Nominal {
            condition,
            found: nominal_count,
        });
    }
    let first = parts[0].index;
    let mut problems: Vec<Problem> = kinds
        .into_iter()
        .map(|kind| Problem::in_part(first, kind))
        .collect();
    problems.extend(name_problems(condition, parts, rules));
    problems
}

/// A field of a flight condition.
struct ConditionField {
    name: &'static str,
    /// Formats the field in a row; `None` if the row has no value.
    text: fn(&Row) -> Option<String>,
}

const CONDITION_FIELDS: [ConditionField; 5] = [
    ConditionField {
        name: "airspeed [kt]",
        text: |row| row.airspeed_kt.map(number),
    },
    ConditionField {
        name: "altitude [ft]",
        text: |row| row.altitude_ft.map(number),
    },
    ConditionField {
        name: "mass [kg]",
        text: |row| row.mass_kg.map(number),
    },
    ConditionField {
        name: "altitude",
        text: |row| row.altitude.clone(),
    },
    ConditionField {
        name: "weight",
        text: |row| row.weight.clone(),
    },
];

/// Finds fields with different values within a condition.
fn contradictions(condition: i64, parts: &[IndexedPart<'_>]) -> Vec<ProblemKind> {
    let mut contradictions = Vec::new();
    for field in CONDITION_FIELDS {
        let mut values = parts.iter().filter_map(|part| (field.text)(&part.part.row));
        if let Some(first) = values.next()
            && let Some(second) = values.find(|value| *value != first)
        {
            contradictions.push(ProblemKind::Contradiction {
                condition,
                field: field.name,
                first,
                second,
            });
        }
    }
    contradictions
}

/// Finds models with the same name in a bundle. Measured responses may share a name: they then form
/// a single model, unless they give the same response twice, or have different frequencies.
fn name_problems(condition: i64, parts: &[IndexedPart<'_>], rules: &Rules) -> Vec<Problem> {
    let mut physics: BTreeMap<&str, Vec<&Part>> = BTreeMap::new();
    let mut identified: BTreeMap<&str, Vec<&Part>> = BTreeMap::new();
    let mut problems = Vec::new();
    for IndexedPart { index, part } in parts {
        let is_identified = part.row.role == Some(RowRole::Identified);
        let bundle = if is_identified {
            &mut identified
        } else {
            &mut physics
        };
        // The models with the same name that come before this one.
        let earlier = bundle.entry(&part.row.name).or_default();
        if let Some(last) = earlier.last() {
            let kind = match (last.found.response(), part.found.response()) {
                (Some(a), Some(b)) if a.omega == b.omega => {
                    duplicate_response(part, earlier, rules)
                }
                (Some(a), Some(b)) => Some(ProblemKind::Grids {
                    first: last.found.key(),
                    first_grid: GridSpan::new(a),
                    second: part.found.key(),
                    second_grid: GridSpan::new(b),
                }),
                _ => Some(ProblemKind::DuplicateName {
                    condition,
                    bundle: if is_identified {
                        "identified"
                    } else {
                        "physics"
                    },
                    name: part.row.name.clone(),
                }),
            };
            problems.extend(kind.map(|kind| Problem::in_part(*index, kind)));
        }
        earlier.push(part);
    }
    problems
}

/// Returns a problem for the first response that a measured model's part shares with an earlier
/// part; `None` if they share no response.
fn duplicate_response(part: &Part, earlier: &[&Part], rules: &Rules) -> Option<ProblemKind> {
    for (output, output_rule) in rules.outputs.iter().enumerate() {
        for (input, input_rule) in rules.inputs.iter().enumerate() {
            if !measures(part, output, input) {
                continue;
            }
            let first = earlier.iter().find(|part| measures(part, output, input));
            if let Some(first) = first {
                return Some(ProblemKind::ResponseTwice {
                    output: output_rule.name.clone(),
                    input: input_rule.name.clone(),
                    name: part.row.name.clone(),
                    first: first.found.key(),
                });
            }
        }
    }
    None
}

/// Returns whether a part contains a response, given by its dataset channel indices.
fn measures(part: &Part, output: usize, input: usize) -> bool {
    let has_output = part.outputs.uses.get(output).is_some_and(Option::is_some);
    let has_input = part.inputs.uses.get(input).is_some_and(Option::is_some);
    has_output && has_input
}
