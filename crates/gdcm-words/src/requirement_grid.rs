//! The requirement grid in words: names, values, limits, verdicts, and the grid as a table (M17.5).
//! A row is a requirement, a column a condition, a cell the value of a corrected and of the physics
//! model compared with flight. MUAD is maximum unnoticeable added dynamics, J the mismatch cost.

use gdcm_method::requirements::level_boundary::AssessedLevel;
use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{Tolerance, ToleranceTable};
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::number_format::{NO_VALUE, decimals};
use gdcm_model::units::{number, s_to_ms, signed};
use gdcm_study::results::grid_cell::{CellVerdict, NotDetermined, RoleCell};
use gdcm_study::results::grid_requirement::{
    Requirement, RequirementGroup, RequirementLimit, RequirementUnit,
};
use gdcm_study::results::requirement_grid::{GridCount, RequirementGrid};

use crate::missing_results::{no_bandwidth_text, no_summary_text};
use crate::table::Table;
use crate::time_histories::tolerance_text;

/// Sign for a value that is not determined.
pub const NOT_DETERMINED_SIGN: &str = NO_VALUE;
/// Mark behind a value outside its limit, in tables without colours.
pub const OUTSIDE_MARK: &str = "!";

/// Dataset and tolerances that give the requirements their names.
#[derive(Clone, Copy)]
pub struct RequirementNames<'a> {
    pub dataset: &'a Dataset,
    pub tolerances: &'a ToleranceTable,
}

impl RequirementNames<'_> {
    /// Names a requirement: "Roll bandwidth", "Yaw rate", "Dutch roll, frequency".
    pub fn name(&self, requirement: Requirement) -> String {
        match requirement {
            Requirement::Bandwidth(pair) => format!("{} bandwidth", self.axis(pair)),
            Requirement::PhaseDelay(pair) => format!("{} phase delay", self.axis(pair)),
            Requirement::Level(pair) => format!("{} level", self.axis(pair)),
            Requirement::PeakError(row) => match self.tolerances.rows().get(row) {
                Some(tolerance) => capitalized(&tolerance.quantity),
                None => String::new(),
            },
            Requirement::ModeFrequency(name) => {
                format!("{}, frequency", capitalized(&name.to_string()))
            }
            Requirement::MeanJOnAxis => "J, on-axis".to_owned(),
            Requirement::MeanJAll => "J, all responses".to_owned(),
            Requirement::MuadShareOnAxis => "Band inside MUAD".to_owned(),
        }
    }

    /// Names a response's axis; also its input if several of [`Dataset::measuring_pairs`] have the
    /// same output.
    fn axis(&self, pair: Pair) -> String {
        let output = &self.dataset.outputs()[pair.output].name;
        let axis = match output.as_str() {
            "P" => "Roll",
            "Q" => "Pitch",
            "R" => "Yaw",
            other => other,
        };
        let pairs = self.dataset.measuring_pairs();
        let of_output = pairs.marked().filter(|other| other.output == pair.output);
        if of_output.count() > 1 {
            let input = &self.dataset.inputs()[pair.input].name;
            format!("{axis} ({input})")
        } else {
            axis.to_owned()
        }
    }
}

fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}

/// Names a requirement group.
pub fn group_name(group: RequirementGroup) -> &'static str {
    match group {
        RequirementGroup::Bandwidth => "Bandwidth",
        RequirementGroup::InTime => "Time histories",
        RequirementGroup::Modes => "Modes",
        RequirementGroup::Summary => "Summary",
    }
}

/// Describes a group's values and their reference: "difference from the identified model".
pub fn group_description(group: RequirementGroup) -> &'static str {
    match group {
        RequirementGroup::Bandwidth => "difference from the identified model",
        RequirementGroup::InTime => "peak error against the held-out record, in % of the tolerance",
        RequirementGroup::Modes => "difference from the identified mode",
        RequirementGroup::Summary => "agreement with the identified model",
    }
}

/// Returns the displayed unit for the values in a row; empty for a cost or a level.
pub fn unit_text(unit: RequirementUnit) -> &'static str {
    match unit {
        RequirementUnit::Percent => "%",
        RequirementUnit::Milliseconds => "ms",
        RequirementUnit::Cost | RequirementUnit::Level => "",
    }
}

/// Converts a stored value to the displayed unit.
pub fn shown_value(unit: RequirementUnit, value: f64) -> f64 {
    match unit {
        RequirementUnit::Percent => 100.0 * value,
        RequirementUnit::Milliseconds => s_to_ms(value),
        RequirementUnit::Cost | RequirementUnit::Level => value,
    }
}

/// Formats a cell's value, in the displayed unit and without decimals: a difference has a sign; a
/// missing value becomes an en dash.
///
/// Rounding must not move a value outside its limit to the other side (100.4 % of a tolerance is
/// "101"):
///
/// - a peak error and mean J on-axis outside their limits are rounded up
/// - a share of the band is rounded down: only the whole is "100"
/// - differences in bandwidth and phase delay outside their limits are rounded away from zero
/// - all others to the nearest number
pub fn value_text(requirement: Requirement, cell: &RoleCell) -> String {
    let Some(value) = cell.value else {
        return NOT_DETERMINED_SIGN.to_owned();
    };
    let shown = shown_value(requirement.unit(), value);
    let is_outside = cell.verdict == CellVerdict::Outside;
    match requirement {
        Requirement::PeakError(_) | Requirement::MeanJOnAxis if is_outside => {
            decimals(shown.ceil(), 0)
        }
        Requirement::MuadShareOnAxis => decimals(shown.floor(), 0),
        Requirement::PeakError(_)
        | Requirement::MeanJOnAxis
        | Requirement::MeanJAll
        | Requirement::Level(_) => decimals(shown, 0),
        Requirement::Bandwidth(_) | Requirement::PhaseDelay(_) if is_outside => {
            signed(shown.signum() * shown.abs().ceil(), 0)
        }
        Requirement::Bandwidth(_) | Requirement::PhaseDelay(_) | Requirement::ModeFrequency(_) => {
            signed(shown, 0)
        }
    }
}

/// Formats a cell's value with its unit: "−12 %", "201 % of the tolerance".
pub fn value_with_unit_text(requirement: Requirement, cell: &RoleCell) -> String {
    let value = value_text(requirement, cell);
    let unit = unit_text(requirement.unit());
    if cell.value.is_none() || unit.is_empty() {
        return match requirement {
            Requirement::Level(_) if cell.value.is_some() => format!("Level {value}"),
            _ => value,
        };
    }
    match requirement {
        Requirement::PeakError(_) => format!("{value} {unit} of the tolerance"),
        _ => format!("{value} {unit}"),
    }
}

/// Formats a level: "2", or an en dash if the boundaries do not determine it.
pub fn level_text(level: Option<AssessedLevel>) -> String {
    match level.and_then(AssessedLevel::number) {
        Some(number) => number.to_string(),
        None => NOT_DETERMINED_SIGN.to_owned(),
    }
}

/// Formats a row's limit, short enough for its column: "±10", "±3 °/s", "2.d.3.a", "none".
pub fn limit_text(requirement: Requirement, limit: &RequirementLimit) -> String {
    let unit = requirement.unit();
    match limit {
        RequirementLimit::Within(limit) => format!("\u{b1}{}", rounded(shown_value(unit, *limit))),
        RequirementLimit::AtMost(limit) => {
            format!("\u{2264} {}", rounded(shown_value(unit, *limit)))
        }
        RequirementLimit::AtLeast(limit) => {
            format!("\u{2265} {}", rounded(shown_value(unit, *limit)))
        }
        RequirementLimit::IdentifiedLevel => "as flown".to_owned(),
        // The relative part is left to `limit_description`.
        RequirementLimit::Tolerance(tolerance) => short_tolerance_text(tolerance),
        RequirementLimit::Mode(tolerance) => tolerance.entry.clone(),
        RequirementLimit::None => "none".to_owned(),
    }
}

/// Describes a row's limit in full: "±10 % or ±3 deg/s, whichever is wider (2.b.3.b, 2.d.1)".
pub fn limit_description(requirement: Requirement, limit: &RequirementLimit) -> String {
    match limit {
        RequirementLimit::Within(_)
        | RequirementLimit::AtMost(_)
        | RequirementLimit::AtLeast(_) => {
            let unit = unit_text(requirement.unit());
            let limit = limit_text(requirement, limit);
            if unit.is_empty() {
                limit
            } else {
                format!("{limit} {unit}")
            }
        }
        RequirementLimit::IdentifiedLevel => "the level of the identified model".to_owned(),
        RequirementLimit::Tolerance(tolerance) => {
            let mut words = tolerance_text(tolerance);
            if tolerance.relative.is_some() {
                words.push_str(", whichever is wider");
            }
            with_entry(words, &tolerance.entry)
        }
        RequirementLimit::Mode(tolerance) => mode_tolerance_text(tolerance),
        RequirementLimit::None => "no tolerance".to_owned(),
    }
}

fn with_entry(words: String, entry: &str) -> String {
    if entry.is_empty() {
        words
    } else {
        format!("{words} ({entry})")
    }
}

/// Describes the tolerances for a mode: "period ±10 % or ±0.5 s, and time to half ±10 % or damping
/// ratio ±0.02 (2.d.3.a)".
fn mode_tolerance_text(tolerance: &ModeTolerance) -> String {
    let mut period = format!("period \u{b1}{} %", rounded(100.0 * tolerance.period));
    if let Some(period_s) = tolerance.period_s {
        period.push_str(&format!(" or \u{b1}{} s", rounded(period_s)));
    }
    let words = format!(
        "{period}, and time to half \u{b1}{} % or damping ratio \u{b1}{}",
        rounded(100.0 * tolerance.amplitude_time),
        rounded(tolerance.damping_ratio)
    );
    with_entry(words, &tolerance.entry)
}

/// Formats a tolerance's absolute part: "±3 °/s", "±0.1 g".
fn short_tolerance_text(tolerance: &Tolerance) -> String {
    let value = rounded(tolerance.absolute);
    match tolerance.unit.as_str() {
        "deg" => format!("\u{b1}{value}\u{b0}"),
        "deg/s" => format!("\u{b1}{value} \u{b0}/s"),
        unit => format!("\u{b1}{value} {unit}"),
    }
}

/// Formats a limit without the floating-point noise from its unit conversion.
fn rounded(value: f64) -> String {
    number((1e6 * value).round() / 1e6)
}

/// Describes the verdict on a cell: "met", "outside ±10 %", "not ≤ 100", "no tolerance", or "not
/// determined" with the reason.
pub fn verdict_text(requirement: Requirement, limit: &RequirementLimit, cell: &RoleCell) -> String {
    match &cell.verdict {
        CellVerdict::Met => "met".to_owned(),
        CellVerdict::Outside => match limit {
            RequirementLimit::Within(_) => {
                format!("outside {}", limit_description(requirement, limit))
            }
            RequirementLimit::AtMost(_) | RequirementLimit::AtLeast(_) => {
                format!("not {}", limit_description(requirement, limit))
            }
            RequirementLimit::IdentifiedLevel => {
                format!("not {}", limit_description(requirement, limit))
            }
            RequirementLimit::Tolerance(_) | RequirementLimit::Mode(_) | RequirementLimit::None => {
                "outside".to_owned()
            }
        },
        CellVerdict::NoTolerance => "no tolerance".to_owned(),
        CellVerdict::NotDetermined(why) => {
            format!("not determined: {}", not_determined_text(why))
        }
    }
}

/// Returns why a cell has no verdict.
pub fn not_determined_text(why: &NotDetermined) -> String {
    match why {
        NotDetermined::NoModel(role) => format!("there is no {} model", role.name()),
        NotDetermined::Bandwidth { role, why } => {
            format!("{} model: {}", role.name(), no_bandwidth_text(why))
        }
        NotDetermined::AboveBoundaries(role) => {
            format!(
                "{} model: phase delay above the last point of a level boundary; extend the \
                boundary",
                role.name()
            )
        }
        NotDetermined::NoHeldOutRecord => {
            "no flight record of this condition is held out".to_owned()
        }
        NotDetermined::NotCompared => {
            "the quantity cannot be compared with the held-out record".to_owned()
        }
        NotDetermined::NoMode => "the identified model does not show this mode".to_owned(),
        NotDetermined::NoModes => "a measured response has no modes".to_owned(),
        NotDetermined::ModeNotPaired => {
            "unpaired: the model has no mode close to the identified one".to_owned()
        }
        NotDetermined::ModeUncertain => {
            "the flight data do not determine this mode: it is below the band, or its uncertainty \
            exceeds the tolerance"
                .to_owned()
        }
        NotDetermined::Summary(why) => no_summary_text(*why).to_owned(),
    }
}

/// Formats how many of the cells with a verdict are met: "156 of 173 met".
pub fn met_text(count: GridCount) -> String {
    format!("{} of {} met", count.met, count.judged)
}

/// Counts the cells that the physics model meets alone, and those not determined, if any, to follow
/// [`met_text`]: "73 without correction; 14 not determined".
pub fn count_details_text(count: GridCount) -> String {
    let physics = format!("{} without correction", count.physics_met);
    match count.not_determined {
        0 => physics,
        others => format!("{physics}; {others} not determined"),
    }
}

/// Number of columns before the first condition in [`grid_table`].
pub const GRID_HEADS: usize = 3;

/// Tabulates a grid: a row for each requirement, a column for each condition.
pub fn grid_table(grid: &RequirementGrid, names: RequirementNames<'_>) -> Table {
    let mut columns = ["requirement", "unit", "limit"].map(str::to_owned).to_vec();
    columns.extend(
        grid.conditions
            .iter()
            .map(|condition| condition.id.to_string()),
    );
    let count = grid.count();
    let title = format!(
        "{} models compared with identified models and held-out records; requirements: {}, {}; \
        {OUTSIDE_MARK} marks values outside their limits",
        capitalized(grid.role.name()),
        met_text(count),
        count_details_text(count)
    );
    let mut table = Table::new(title, columns);
    for row in &grid.rows {
        let requirement = row.requirement;
        let mut cells = vec![
            names.name(requirement),
            unit_text(requirement.unit()).to_owned(),
            limit_text(requirement, &row.limit),
        ];
        for cell in &row.cells {
            let mut text = value_text(requirement, &cell.corrected);
            if cell.corrected.verdict == CellVerdict::Outside {
                text.push(' ');
                text.push_str(OUTSIDE_MARK);
            }
            cells.push(text);
        }
        table.row(cells);
    }
    table
}

#[cfg(test)]
mod tests {
    use gdcm_study::Execution;
    use gdcm_study::decisions::requirement_settings::{OverviewLimits, RequirementSettings};
    use gdcm_study::results::grid_source::GridSource;
    use gdcm_study::results::required_modes::IdentifiedPoles;
    use gdcm_study::results::requirement_role::RequirementRole;
    use gdcm_study::results::requirements::requirements_of;

    use super::*;
    use crate::example_tests::EXAMPLE;

    fn grid(limits: OverviewLimits) -> RequirementGrid {
        let analysis = &*EXAMPLE;
        let requirements = requirements_of(
            analysis,
            &IdentifiedPoles::default(),
            &Execution::sequential(),
        )
        .unwrap();
        let settings = RequirementSettings {
            overview: limits,
            ..RequirementSettings::default()
        };
        RequirementGrid::new(&GridSource {
            requirements: &requirements,
            histories: None,
            dataset: &analysis.study.dataset,
            settings: &settings,
            role: RequirementRole::Corrected,
        })
    }

    #[test]
    fn a_value_in_the_table_is_marked_if_and_only_if_it_is_outside() {
        let dataset = &EXAMPLE.study.dataset;
        let names = RequirementNames {
            dataset,
            tolerances: &ToleranceTable::default(),
        };
        let strict = OverviewLimits {
            bandwidth: 1e-9,
            ..OverviewLimits::default()
        };
        for grid in [grid(OverviewLimits::default()), grid(strict)] {
            let table = grid_table(&grid, names);
            assert_eq!(table.columns.len(), GRID_HEADS + grid.conditions.len());
            assert_eq!(table.rows.len(), grid.rows.len());
            for (cells, row) in table.rows.iter().zip(&grid.rows) {
                for (text, cell) in cells[GRID_HEADS..].iter().zip(&row.cells) {
                    let is_outside = cell.corrected.verdict == CellVerdict::Outside;
                    assert_eq!(text.ends_with(OUTSIDE_MARK), is_outside, "{cells:?}");
                    assert_eq!(
                        text == NOT_DETERMINED_SIGN,
                        cell.corrected.value.is_none(),
                        "{cells:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_level_is_a_number_in_the_grid_and_has_its_word_in_the_details() {
        let level = Requirement::Level(Pair::new(0, 0));
        let outside = RoleCell {
            value: Some(2.0),
            verdict: CellVerdict::Outside,
        };
        assert_eq!(value_text(level, &outside), "2");
        assert_eq!(value_with_unit_text(level, &outside), "Level 2");
        assert_eq!(level_text(Some(AssessedLevel::Level(3))), "3");
        assert_eq!(
            level_text(Some(AssessedLevel::AboveBoundaries)),
            NOT_DETERMINED_SIGN
        );
    }

    #[test]
    fn a_value_beyond_its_limit_is_never_rounded_to_the_limit() {
        let cell = |value, verdict| RoleCell {
            value: Some(value),
            verdict,
        };
        let peak = Requirement::PeakError(0);
        assert_eq!(value_text(peak, &cell(1.004, CellVerdict::Outside)), "101");
        assert_eq!(value_text(peak, &cell(0.996, CellVerdict::Met)), "100");
        let muad = Requirement::MuadShareOnAxis;
        assert_eq!(value_text(muad, &cell(0.899, CellVerdict::Outside)), "89");
        let delay = Requirement::PhaseDelay(Pair::new(0, 0));
        assert_eq!(
            value_text(delay, &cell(-0.0202, CellVerdict::Outside)),
            "\u{2212}21"
        );
        assert_eq!(
            value_text(
                delay,
                &RoleCell {
                    value: None,
                    verdict: CellVerdict::NotDetermined(NotDetermined::NoMode)
                }
            ),
            NOT_DETERMINED_SIGN
        );
    }
}
