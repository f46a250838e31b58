//! Names and units of columns from the preceding lines.

use gdcm_model::names::signed_name::parse_direction;

use crate::formats::text::columns::{Layout, comment, is_rule};
use crate::formats::text::separator::{Separator, cell_number};

/// The names and units of columns.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Heading {
    /// A name for each column.
    pub(super) names: Option<Vec<String>>,
    /// The unit of each column, if given.
    pub(super) units: Vec<Option<String>>,
    /// Decisions, in words.
    pub(super) notes: Vec<String>,
}

impl Heading {
    /// Finds names and units in the lines before the numbers: the nearest line with a cell for each
    /// column, preferably without a comment mark; a line of units may follow it.
    pub(super) fn find(above: &[(usize, String)], layout: Layout) -> Self {
        let candidates: Vec<_> = above
            .iter()
            .rev()
            .filter(|(_, line)| !is_rule(line))
            .take(100)
            .collect();
        let plain = candidates
            .iter()
            .filter(|(_, line)| comment(line).is_none());
        let marked = candidates
            .iter()
            .filter(|(_, line)| comment(line).is_some());
        let mut found: Vec<_> = plain
            .chain(marked)
            .filter_map(|(number, line)| {
                Some((*number, split(comment(line).unwrap_or(line), layout)?))
            })
            .collect();
        let mut heading = Heading {
            names: None,
            units: vec![None; layout.columns],
            notes: Vec::new(),
        };
        if found.len() >= 2 && only_units(&found[0].1) && found[0].0 > found[1].0 {
            let (number, units) = found.remove(0);
            heading.units = units.iter().map(|unit| unit_of(unit)).collect();
            heading.notes.push(format!("line {number} gives the units"));
        }
        if found.is_empty() {
            heading.note_misfit(above, layout);
        } else {
            let (number, cells) = found.remove(0);
            heading.take_names(&cells);
            heading
                .notes
                .push(format!("line {number} gives the names of the columns"));
        }
        heading
    }

    fn take_names(&mut self, cells: &[String]) {
        let mut names = Vec::with_capacity(cells.len());
        for (cell, known) in cells.iter().zip(&mut self.units) {
            let (name, unit) = name_and_unit(cell);
            *known = known.take().or(unit);
            names.push(name);
        }
        self.names = Some(names);
    }

    /// Notes a line that looks like names but has a different number of cells.
    fn note_misfit(&mut self, above: &[(usize, String)], layout: Layout) {
        let Some((number, line)) = above
            .iter()
            .rev()
            .find(|(_, line)| comment(line).is_none() && !is_rule(line))
        else {
            return;
        };
        let found = layout.separator.cells(line).count();
        if found > 1 {
            let columns = layout.columns;
            let note = format!(
                "line {number} has {found} words for {columns} columns: not taken as their names"
            );
            self.notes.push(note);
        }
    }
}

/// Splits a heading into a cell for each column; its separator may differ from that of the numbers.
fn split(line: &str, layout: Layout) -> Option<Vec<String>> {
    let columns = layout.columns;
    let fitting = |mut cells: Vec<String>| {
        if cells.len() == columns + 1 && cells.last().is_some_and(|cell| cell.trim().is_empty()) {
            cells.pop();
        }
        let words = cells
            .iter()
            .any(|cell| cell.chars().any(char::is_alphabetic));
        (cells.len() == columns && words && !numbers_mostly(&cells, layout)).then_some(cells)
    };
    // One cell too many is enough to reject the separator.
    let by = |separator: Separator| -> Vec<String> {
        separator
            .cells(line)
            .take(columns + 2)
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    if layout.separator != Separator::Blanks
        && let Some(cells) = fitting(by(layout.separator))
    {
        return Some(cells);
    }
    let others = [
        Separator::Tab,
        Separator::Semicolon,
        Separator::Pipe,
        Separator::Comma,
    ]
    .map(by);
    let blanks = [
        by_wide_blanks(line, columns),
        with_brackets_joined(line, columns),
        by(Separator::Blanks),
    ];
    let ways: Vec<_> = if columns == 1 {
        vec![vec![line.trim().to_owned()]]
    } else {
        [&others[..], &blanks[..]].concat()
    };
    ways.into_iter().find_map(fitting)
}

/// Whether a line is probably a number line with an error.
pub(super) fn numbers_mostly(cells: &[String], layout: Layout) -> bool {
    let is_number = |cell: &&String| {
        cell_number(cell, layout.decimal_comma).is_some_and(|number| !number.is_nan())
    };
    cells.first().is_some_and(|cell| is_number(&cell))
        && 2 * cells.iter().filter(is_number).count() > cells.len()
}

/// Splits at two or more blanks, so that names can contain single blanks.
fn by_wide_blanks(line: &str, columns: usize) -> Vec<String> {
    let cells = line
        .trim()
        .split("  ")
        .filter(|cell| !cell.trim().is_empty());
    cells
        .take(columns + 2)
        .map(|cell| cell.trim().to_owned())
        .collect()
}

/// Splits at blanks; text in brackets belongs to the cell before.
fn with_brackets_joined(line: &str, columns: usize) -> Vec<String> {
    let mut cells: Vec<String> = Vec::new();
    let mut open = false;
    for word in line.split_whitespace() {
        let count = cells.len();
        match cells.last_mut() {
            Some(last) if open || word.starts_with(['[', '(', '{']) => {
                last.push(' ');
                last.push_str(word);
            }
            _ if count > columns => break,
            _ => cells.push(word.to_owned()),
        }
        let opened = |bracket| word.matches(bracket).count();
        open = if open {
            opened([']', ')', '}']) == 0
        } else {
            opened(['[', '(', '{']) > opened([']', ')', '}'])
        };
    }
    cells
}

/// Whether a heading names one column more than `layout` has: the empty cells after a trailing
/// separator are then a column.
pub(super) fn names_one_more(above: &[(usize, String)], layout: Layout) -> bool {
    above.iter().any(|(_, line)| {
        let cells = layout
            .separator
            .cells(comment(line).unwrap_or(line))
            .take(layout.columns + 2);
        let named = cells
            .filter(|cell| cell.chars().any(char::is_alphabetic))
            .count();
        named == layout.columns + 1
    })
}

fn unit_of(cell: &str) -> Option<String> {
    let unit = cell
        .trim()
        .trim_matches(['[', ']', '(', ')', '{', '}'])
        .trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}

fn only_units(cells: &[String]) -> bool {
    let said: Vec<_> = cells.iter().filter_map(|cell| unit_of(cell)).collect();
    2 * said.len() >= cells.len() && said.iter().all(|unit| is_unit(unit))
}

// Units in column headings.

/// Words of units, in lower case.
const WORDS: [&str; 68] = [
    "rad", "radian", "radians", "mrad", "deg", "degree", "degrees", "°", "s", "sec", "secs",
    "second", "seconds", "ms", "us", "µs", "min", "h", "hr", "hz", "khz", "cps", "rps", "rpm",
    "db", "m", "mm", "cm", "km", "ft", "in", "inch", "inches", "nm", "kt", "kts", "knot", "knots",
    "kias", "ktas", "kcas", "keas", "ktgs", "mph", "fpm", "g", "n", "kn", "lb", "lbf", "lbs",
    "slug", "kg", "pa", "hpa", "kpa", "psi", "bar", "v", "a", "w", "%", "pct", "percent", "ratio",
    "norm", "abs", "unitless",
];

/// Whether a text consists only of unit words, numbers and signs: "deg/s", "rad/s^2", "%", "1/s".
pub(super) fn is_unit(text: &str) -> bool {
    let text = text.trim().to_lowercase();
    if matches!(text.as_str(), "-" | "1" | "--" | "none") {
        return true;
    }
    let mut words = 0;
    for word in text
        .split(['/', '*', '^', '·', ' ', '.', '-', '(', ')', '²', '³'])
        .filter(|word| !word.is_empty())
    {
        if word.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        if !WORDS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit())) {
            return false;
        }
        words += 1;
    }
    words > 0
}

/// Splits a heading into name and unit: "omega \[rad/s\]", "P (deg/s)", "_Vind,_kias".
///
/// Square brackets hold a unit unless they contain an integer; round brackets and text after a
/// comma only if they consist of known words, as "re(LAT->P)" names a response.
pub(super) fn name_and_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim().trim_matches(['"', '\'']).trim();
    let clean = |text: &str| {
        text.trim_matches(|c: char| c.is_whitespace() || c == '_')
            .to_owned()
    };
    for (open, close, always) in [('[', ']', true), ('(', ')', false), ('{', '}', false)] {
        let inner = heading
            .strip_suffix(close)
            .and_then(|rest| rest.rsplit_once(open));
        // `xyz[0]` is an index.
        let is_index =
            |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()) && !text.is_empty();
        if let Some((name, unit)) = inner
            && ((always && !is_index(unit)) || is_unit(unit))
            // "az [+down]" gives a sign convention.
            && parse_direction(unit).is_none()
        {
            return (
                clean(name),
                Some(unit.trim().to_owned()).filter(|unit| !unit.is_empty()),
            );
        }
    }
    if let Some((name, unit)) = heading.rsplit_once(',')
        && is_unit(&clean(unit))
    {
        return (clean(name), Some(clean(unit)));
    }
    (clean(heading), None)
}

#[cfg(test)]
mod heading_tests {
    use super::*;

    fn find(lines: &[&str], separator: Separator, columns: usize) -> Heading {
        let above: Vec<_> = lines
            .iter()
            .enumerate()
            .map(|(index, line)| (index + 1, (*line).to_owned()))
            .collect();
        Heading::find(
            &above,
            Layout {
                separator,
                decimal_comma: false,
                columns,
                trailing: false,
            },
        )
    }

    fn units(heading: &Heading) -> Vec<&str> {
        heading
            .units
            .iter()
            .map(|unit| unit.as_deref().unwrap_or(""))
            .collect()
    }

    #[test]
    fn a_whole_number_in_brackets_is_an_index() {
        assert_eq!(name_and_unit("xyz[0]"), ("xyz[0]".to_owned(), None));
        assert_eq!(
            name_and_unit("xyz [1/s]"),
            ("xyz".to_owned(), Some("1/s".to_owned()))
        );
    }

    #[test]
    fn names_and_units_stand_in_one_line_or_in_two() {
        let one = find(&["omega [rad/s],mag (dB),x"], Separator::Comma, 3);
        assert_eq!(one.names.as_deref().unwrap(), ["omega", "mag", "x"]);
        assert_eq!(units(&one), ["rad/s", "dB", ""]);
        let two = find(&["w,mag,phase", "rad/s,dB,deg"], Separator::Comma, 3);
        assert_eq!(two.names.as_deref().unwrap(), ["w", "mag", "phase"]);
        assert_eq!(units(&two), ["rad/s", "dB", "deg"]);
    }

    #[test]
    fn blanks_may_stand_in_names_and_before_units() {
        let joined = find(&["% omega [rad/s] mag [dB]"], Separator::Blanks, 2);
        assert_eq!(joined.names.as_deref().unwrap(), ["omega", "mag"]);
        let wide = find(&["mag P/LAT   phase P/LAT"], Separator::Blanks, 2);
        assert_eq!(wide.names.as_deref().unwrap(), ["mag P/LAT", "phase P/LAT"]);
        let commas = find(&["# w, re, im"], Separator::Blanks, 3);
        assert_eq!(commas.names.as_deref().unwrap(), ["w", "re", "im"]);
    }

    #[test]
    fn a_title_is_no_heading_and_a_misfit_is_noted() {
        let heading = find(&["Flight 12", "a,b"], Separator::Comma, 3);
        assert_eq!(heading.names, None);
        assert_eq!(
            heading.notes,
            ["line 2 has 2 words for 3 columns: not taken as their names"]
        );
    }

    #[test]
    fn a_line_without_a_mark_goes_before_a_comment() {
        let heading = find(&["w,m,p", "# by, some, tool"], Separator::Comma, 3);
        assert_eq!(heading.names.as_deref().unwrap(), ["w", "m", "p"]);
    }
}

#[cfg(test)]
mod unit_word_tests {
    use super::*;

    #[test]
    fn units_are_told_from_names() {
        for unit in [
            "rad/s",
            "deg",
            "[1/s]".trim_matches(['[', ']']),
            "%",
            "°",
            "deg/s^2",
            "m/s²",
            "-",
        ] {
            assert!(is_unit(unit), "{unit}");
        }
        for name in ["LAT->P", "P/LAT", "omega", "", "12"] {
            assert!(!is_unit(name), "{name}");
        }
    }

    #[test]
    fn a_heading_is_cut_into_name_and_unit() {
        let cut = |heading| name_and_unit(heading);
        assert_eq!(
            cut("omega [rad/s]"),
            ("omega".to_owned(), Some("rad/s".to_owned()))
        );
        assert_eq!(
            cut("\"P (deg/s)\""),
            ("P".to_owned(), Some("deg/s".to_owned()))
        );
        assert_eq!(
            cut("_Vind,_kias"),
            ("Vind".to_owned(), Some("kias".to_owned()))
        );
        assert_eq!(cut("re(LAT->P)"), ("re(LAT->P)".to_owned(), None));
        assert_eq!(
            cut("mag(P/LAT) [dB]"),
            ("mag(P/LAT)".to_owned(), Some("dB".to_owned()))
        );
        assert_eq!(cut("az [+down]"), ("az [+down]".to_owned(), None));
        assert_eq!(cut("x []"), ("x".to_owned(), None));
    }
}
