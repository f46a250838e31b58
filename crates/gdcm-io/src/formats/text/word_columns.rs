//! Columns of words and of clock times among columns of numbers.

use std::collections::BTreeMap;

use crate::formats::text::columns::comment;
use crate::formats::text::separator::{Separator, cell_number, clock_s, is_number, lines};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Number of lines examined to recognise the columns.
const SAMPLE: usize = 200;
/// Largest number of distinct words in a column; a column with more is not a label.
const MOST_WORDS: usize = 500;
/// Number of words listed in a note.
const SHOWN: usize = 12;

/// A text with numbers instead of words in its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberedText {
    pub text: String,
    /// The number of each word, and the columns of clock times.
    pub notes: Vec<String>,
}

/// Kind of data in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Numbers,
    Clock,
    Words,
}

/// Replaces the words in columns by numbers, in the order of their first occurrence, and clock
/// times by seconds; returns nothing if the text has no word columns beside number columns. The
/// columns need a separator other than blanks.
pub fn numbered_words(
    text: &str,
    budget: &ReadingBudget,
) -> Result<Option<NumberedText>, VariableFault> {
    let Some((separator, columns)) = columns(text) else {
        return Ok(None);
    };
    let mut numbering = Numbering {
        columns,
        heading: None,
    };
    budget.take(text.len() as u64, 2, "")?;
    let mut numbered = String::with_capacity(text.len());
    for (_, line) in lines(text) {
        budget.work(1, "")?;
        let cells: Vec<String> = separator
            .cells(line)
            .map(|cell| cell.trim().to_owned())
            .collect();
        if cells.len() == numbering.columns.len() && comment(line).is_none() {
            numbered.push_str(&numbering.line(cells, separator));
        } else {
            numbered.push_str(line);
        }
        numbered.push('\n');
    }
    Ok(Some(NumberedText {
        text: numbered,
        notes: numbering.notes(),
    }))
}

/// A column during numbering.
struct Column {
    kind: Kind,
    words: BTreeMap<String, usize>,
    /// The first clock time, and the last with the elapsed days \[s\].
    clock: Option<(f64, f64)>,
}

struct Numbering {
    columns: Vec<Column>,
    heading: Option<Vec<String>>,
}

impl Numbering {
    /// Formats a row with numbers instead of words; leaves the heading unchanged.
    fn line(&mut self, cells: Vec<String>, separator: Separator) -> String {
        let mut numbers = cells
            .iter()
            .zip(&self.columns)
            .filter(|(_, column)| column.kind == Kind::Numbers);
        let is_row = numbers.all(|(cell, _)| is_number(cell));
        if !is_row {
            self.heading.get_or_insert_with(|| cells.clone());
        }
        let cell = |(cell, column): (String, &mut Column)| match column.kind {
            Kind::Clock if is_row => column.seconds(&cell),
            Kind::Words if is_row => column.number(cell),
            _ => cell,
        };
        separator.line(cells.into_iter().zip(&mut self.columns).map(cell))
    }

    fn notes(&self) -> Vec<String> {
        let name = |index: usize| {
            let heading = self
                .heading
                .as_ref()
                .and_then(|cells| cells.get(index))
                .filter(|name| !name.is_empty());
            heading.map_or_else(
                || format!("column {}", index + 1),
                |name| format!("column \"{name}\""),
            )
        };
        let note = |(index, column): (usize, &Column)| match column.kind {
            Kind::Numbers => None,
            Kind::Clock => Some(format!(
                "{} has times of the clock: taken as seconds from the first",
                name(index)
            )),
            Kind::Words if column.words.len() > MOST_WORDS => {
                Some(format!("{} has words: left out", name(index)))
            }
            Kind::Words => {
                let mut words: Vec<(&usize, &String)> = column
                    .words
                    .iter()
                    .map(|(word, number)| (number, word))
                    .collect();
                words.sort_unstable();
                let shown = words
                    .iter()
                    .take(SHOWN)
                    .map(|(number, word)| format!("{number} is {word}"));
                let more = if words.len() > SHOWN { ", …" } else { "" };
                Some(format!(
                    "{} has words, which are numbered: {}{more}",
                    name(index),
                    shown.collect::<Vec<_>>().join(", ")
                ))
            }
        };
        self.columns.iter().enumerate().filter_map(note).collect()
    }
}

impl Column {
    fn number(&mut self, word: String) -> String {
        if word.is_empty() || self.words.len() > MOST_WORDS {
            return String::new();
        }
        let next = self.words.len() + 1;
        self.words.entry(word).or_insert(next).to_string()
    }

    /// Returns seconds since the first time of the column; midnight adds a day.
    fn seconds(&mut self, cell: &str) -> String {
        const DAY_S: f64 = 86_400.0;
        let Some(mut now) = clock_s(cell) else {
            return String::new();
        };
        let (first, last) = self.clock.unwrap_or((now, now));
        if now < DAY_S && now < last - DAY_S / 2.0 {
            now += DAY_S * ((last - now) / DAY_S).round();
        }
        self.clock = Some((first, now));
        // Integer nanoseconds, finer than any clock: they need no decimal mark, which may be either
        // in this text.
        format!("{:.0}e-9", (now - first) * 1e9)
    }
}

/// Finds the separator for which most lines have one width, and the kind of each column.
fn columns(text: &str) -> Option<(Separator, Vec<Column>)> {
    let sample: Vec<&str> = lines(text)
        .map(|(_, line)| line)
        .filter(|line| !line.trim().is_empty() && comment(line).is_none())
        .take(SAMPLE)
        .collect();
    let width = |separator: Separator| {
        let mut widths: BTreeMap<usize, usize> = BTreeMap::new();
        sample
            .iter()
            .for_each(|line| *widths.entry(separator.cells(line).count()).or_default() += 1);
        let (width, count) = widths
            .into_iter()
            .max_by_key(|(width, count)| (*count, *width))?;
        (width > 2 && 2 * count > sample.len()).then_some((count, width, separator))
    };
    let separators = Separator::ALL
        .into_iter()
        .filter(|separator| *separator != Separator::Blanks);
    let (_, width, separator) = separators
        .filter_map(width)
        .max_by_key(|(count, width, _)| (*count, *width))?;
    let rows: Vec<Vec<String>> = sample
        .iter()
        .map(|line| {
            separator
                .cells(line)
                .map(|cell| cell.trim().to_owned())
                .collect::<Vec<_>>()
        })
        .filter(|cells: &Vec<String>| cells.len() == width)
        .collect();
    let kind = |index: usize| {
        let filled = || {
            rows.iter()
                .map(|row| row[index].as_str())
                .filter(|cell| !cell.is_empty())
        };
        let most = |is_it: &dyn Fn(&str) -> bool| {
            2 * filled().filter(|cell| is_it(cell)).count() > filled().count()
        };
        if filled().next().is_none() || most(&is_number) {
            Kind::Numbers
        } else if most(&|cell| clock_s(cell).is_some()) {
            Kind::Clock
        } else {
            Kind::Words
        }
    };
    let kinds: Vec<Kind> = (0..width).map(kind).collect();
    let numbers = kinds.iter().filter(|kind| **kind == Kind::Numbers).count();
    let column = |kind: Kind| Column {
        kind,
        words: BTreeMap::new(),
        clock: None,
    };
    (numbers >= 2 && numbers < width).then(|| (separator, kinds.into_iter().map(column).collect()))
}

// Complex columns, `(1.5-2j)`, as columns of real and imaginary parts.

/// Replaces each complex column by two columns, with "re" and "im" before their headings; returns
/// nothing if there is none. Line numbers are kept.
pub fn split_complex(text: &str, budget: &ReadingBudget) -> Result<Option<String>, VariableFault> {
    let Some((separator, is_complex)) = complex_columns(text) else {
        return Ok(None);
    };
    budget.take(text.len() as u64, 3, "")?;
    let mut split = String::with_capacity(2 * text.len());
    for (_, line) in lines(text) {
        budget.work(1, "")?;
        let cells: Vec<String> = separator
            .cells(comment(line).unwrap_or(line))
            .map(|cell| cell.into_owned())
            .collect();
        if cells.len() == is_complex.len() {
            let parts =
                cells
                    .iter()
                    .zip(&is_complex)
                    .flat_map(|(cell, is_complex)| match is_complex {
                        true => two_cells(cell, separator).to_vec(),
                        false => vec![cell.clone()],
                    });
            split.push_str(&separator.line(parts));
        } else {
            split.push_str(line);
        }
        split.push('\n');
    }
    // An empty line follows the last line end.
    split.pop();
    Ok(Some(split))
}

/// Finds the separator and the complex cells of the first line of numbers, at least one of them
/// complex.
fn complex_columns(text: &str) -> Option<(Separator, Vec<bool>)> {
    /// Number of lines examined.
    const SAMPLE: usize = 200;
    let of_line = |line: &str| {
        Separator::ALL.into_iter().find_map(|separator| {
            let parsed = |cell: &str| match parts(cell) {
                Some(_) => Some(true),
                None => cell_number(cell, false).map(|_| false),
            };
            let cells = separator
                .cells(line)
                .map(|cell| parsed(&cell))
                .collect::<Option<Vec<bool>>>()?;
            (cells.len() > 1 && cells.contains(&true)).then_some((separator, cells))
        })
    };
    lines(text)
        .filter(|(_, line)| comment(line).is_none())
        .take(SAMPLE)
        .find_map(|(_, line)| of_line(line))
}

/// Returns the real and imaginary part of a number, or two headings for one.
fn two_cells(cell: &str, separator: Separator) -> [String; 2] {
    if let Some(parts) = parts(cell) {
        return parts;
    }
    let cell = cell.trim();
    match cell_number(cell, false) {
        Some(number) if number.is_nan() => [cell, cell].map(str::to_owned),
        Some(_) => [cell, "0"].map(str::to_owned),
        None => {
            let joint = if separator == Separator::Blanks {
                "_"
            } else {
                " "
            };
            ["re", "im"].map(|part| format!("{part}{joint}{cell}"))
        }
    }
}

/// Returns the real and imaginary part of "(1.5-2j)", "1.5 + 2i", "2e-3j", "(1+-2j)".
fn parts(cell: &str) -> Option<[String; 2]> {
    let cell: String = cell
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    let inner = cell
        .strip_prefix('(')
        .and_then(|cell| cell.strip_suffix(')'))
        .unwrap_or(&cell);
    let inner = inner
        .strip_suffix(['i', 'j'])?
        .trim_end_matches('*')
        .replace("+-", "-");
    let is_sign = |(at, letter): &(usize, char)| {
        *at > 0 && matches!(letter, '+' | '-') && !inner[..*at].ends_with(['e', 'E', 'd', 'D'])
    };
    let (re, im) = match inner.char_indices().rfind(is_sign) {
        Some((at, _)) => inner.split_at(at),
        None => ("0", inner.as_str()),
    };
    let im = im.trim_start_matches('+');
    let is_number = |text: &str| {
        !text.is_empty() && cell_number(text, false).is_some_and(|number| !number.is_nan())
    };
    (is_number(re) && is_number(im)).then(|| [re, im].map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::super::columns::read_table;
    use super::*;

    fn numbered(text: &str) -> Option<NumberedText> {
        numbered_words(text, &ReadingBudget::new(1 << 20)).unwrap()
    }

    #[test]
    fn words_become_numbers_in_the_order_in_which_they_come() {
        let text = "t,mode,P,Q\n0,SAS,1,2\n0.1,SAS,3,4\n0.2,\"ATT, on\",5,6\n0.3,SAS,7,8\n";
        let found = numbered(text).unwrap();
        assert_eq!(
            found.text,
            "t,mode,P,Q\n0,1,1,2\n0.1,1,3,4\n0.2,2,5,6\n0.3,1,7,8\n\n"
        );
        assert_eq!(
            found.notes,
            ["column \"mode\" has words, which are numbered: 1 is SAS, 2 is ATT, on"]
        );
        let table = read_table(&found.text, &ReadingBudget::new(1 << 20)).unwrap();
        assert_eq!(table.columns[1], [1.0, 1.0, 2.0, 1.0]);
    }

    #[test]
    fn times_of_the_clock_become_seconds_over_midnight_too() {
        let text = "time;P;Q\n23:59:59,90;1,5;2\n23:59:59,95;1,5;2\n00:00:00,00;1,5;2\n00:00:00,05;1,5;2\n";
        let found = numbered(text).unwrap();
        let table = read_table(&found.text, &ReadingBudget::new(1 << 20)).unwrap();
        // The times are written in nanoseconds.
        assert!(
            table.columns[0]
                .iter()
                .zip([0.0, 0.05, 0.1, 0.15])
                .all(|(a, b)| (a - b).abs() < 1e-9),
            "{table:?}"
        );
        assert_eq!(table.columns[1], [1.5; 4]);
    }

    #[test]
    fn a_table_of_numbers_and_a_text_are_left_alone() {
        assert_eq!(numbered("t,P,Q\n0,1,2\n1,2,3\n"), None);
        assert_eq!(
            numbered("Dear sir,\nthis is, as you say, a text,\nof words\n"),
            None
        );
        assert_eq!(numbered(""), None);
    }
}

#[cfg(test)]
mod complex_tests {
    use super::*;

    fn split(text: &str) -> Option<String> {
        split_complex(text, &ReadingBudget::new(1 << 20)).unwrap()
    }

    #[test]
    fn complex_numbers_of_python_and_matlab_become_two_columns() {
        let text = "omega,H\n1,(1.5-2j)\n2,3e-2+4e+1i\n3,-2j\n4,7\n";
        assert_eq!(
            split(text).unwrap(),
            "omega,re H,im H\n1,1.5,-2\n2,3e-2,4e+1\n3,0,-2\n4,7,0\n"
        );
        let blanks = "# w H\n 1.0e+00 (1.0e+00+-2.0e+00j)\n";
        assert_eq!(
            split(blanks).unwrap(),
            "w re_H im_H\n1.0e+00 1.0e+00 -2.0e+00\n"
        );
    }

    #[test]
    fn other_tables_and_words_are_left_alone() {
        for text in ["w,re,im\n1,2,3\n", "t;mode\n1;j\n", "", "a,i\nb,j\n"] {
            assert_eq!(split(text), None, "{text}");
        }
    }
}
