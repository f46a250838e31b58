//! Splits columns with complex numbers, such as `(1.5-2j)`, into real and imaginary parts.
//!
//! The result is again a text, which is read like any other table (`table_reader.rs`). The first
//! row with a complex number determines the separator and the complex columns.

use crate::formats::text::cell_number::{cell_number, has_number};
use crate::formats::text::lines::{comment, lines};
use crate::formats::text::separator::Separator;
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};

/// Whether the decimal mark may be a comma; it is always a point in tables with complex numbers.
const DECIMAL_COMMA: bool = false;
/// Number of lines examined for complex numbers.
const SAMPLE: usize = 200;
/// Upper bound for the split text's memory, as a multiple of the original text.
const GROWTH: u64 = 3;

/// Replaces each complex column by two columns, whose headings begin with "re" and "im"; copies
/// lines with more or fewer cells unchanged. Returns `None` if there is no complex column. Line
/// numbers do not change.
pub fn split_complex(text: &str, budget: &ReadingBudget) -> Result<Option<String>, VariableFault> {
    let Some(columns) = ComplexColumns::recognise(text) else {
        return Ok(None);
    };
    budget.take(text.len() as u64, GROWTH, NO_VARIABLE)?;
    let mut split = String::with_capacity(2 * text.len());
    for (_, line) in lines(text) {
        budget.work(1, NO_VARIABLE)?;
        // The heading may be in a comment, whose mark is then omitted.
        match columns.split_line(comment(line).unwrap_or(line)) {
            Some(line) => split.push_str(&line),
            None => split.push_str(line),
        }
        split.push('\n');
    }
    // Remove the line feed that was added after the last line.
    split.pop();
    Ok(Some(split))
}

/// A text's separator, and its complex columns.
struct ComplexColumns {
    separator: Separator,
    /// Whether each column has complex numbers.
    is_complex: Vec<bool>,
}

impl ComplexColumns {
    /// Recognises the columns from the first row with a complex number; `None` if there is no such
    /// row among the first `SAMPLE` lines.
    fn recognise(text: &str) -> Option<Self> {
        lines(text)
            .filter(|(_, line)| comment(line).is_none())
            .take(SAMPLE)
            .find_map(|(_, line)| Self::from_line(line))
    }

    /// Recognises the columns from a row with any separator.
    fn from_line(line: &str) -> Option<Self> {
        Separator::ALL
            .into_iter()
            .find_map(|separator| Self::from_separated_line(line, separator))
    }

    /// Recognises the columns from a row. Returns `None` unless the row has at least two cells, all
    /// numbers, and some of them complex.
    fn from_separated_line(line: &str, separator: Separator) -> Option<Self> {
        let mut is_complex = Vec::new();
        for cell in separator.cells(line) {
            if PartCells::parse(&cell).is_some() {
                is_complex.push(true);
            } else {
                cell_number(&cell, DECIMAL_COMMA)?;
                is_complex.push(false);
            }
        }
        if is_complex.len() > 1 && is_complex.contains(&true) {
            Some(Self {
                separator,
                is_complex,
            })
        } else {
            None
        }
    }

    /// Splits the cells in the complex columns of a line; `None` if the number of cells differs
    /// from the number of columns.
    fn split_line(&self, line: &str) -> Option<String> {
        let cells: Vec<_> = self.separator.cells(line).collect();
        if cells.len() != self.is_complex.len() {
            return None;
        }
        let mut split = Vec::with_capacity(2 * cells.len());
        for (cell, is_complex) in cells.into_iter().zip(&self.is_complex) {
            if *is_complex {
                let PartCells { re, im } = self.parts_or_headings(&cell);
                split.push(re);
                split.push(im);
            } else {
                split.push(cell.into_owned());
            }
        }
        Some(self.separator.line(split.into_iter()))
    }

    /// Splits a cell: a number into its real and imaginary part, a heading into two headings.
    fn parts_or_headings(&self, cell: &str) -> PartCells {
        if let Some(parts) = PartCells::parse(cell) {
            return parts;
        }
        let cell = cell.trim();
        match cell_number(cell, DECIMAL_COMMA) {
            // A missing number has neither part.
            Some(number) if number.is_nan() => PartCells::new(cell, cell),
            Some(_) => PartCells::new(cell, "0"),
            None => {
                // A blank would split the heading if blanks separate the cells.
                let joint = if self.separator == Separator::Blanks {
                    "_"
                } else {
                    " "
                };
                PartCells {
                    re: format!("re{joint}{cell}"),
                    im: format!("im{joint}{cell}"),
                }
            }
        }
    }
}

/// The two cells that replace a cell: a number's real and imaginary parts, or their headings.
struct PartCells {
    re: String,
    im: String,
}

impl PartCells {
    fn new(re: &str, im: &str) -> Self {
        Self {
            re: re.to_owned(),
            im: im.to_owned(),
        }
    }

    /// Parses a complex number such as "(1.5-2j)", "1.5 + 2i", "2e-3j" or "(1+-2j)"; `None` for any
    /// other text.
    fn parse(cell: &str) -> Option<Self> {
        let cell: String = cell
            .chars()
            .filter(|letter| !letter.is_whitespace())
            .collect();
        let inner = cell
            .strip_prefix('(')
            .and_then(|cell| cell.strip_suffix(')'))
            .unwrap_or(&cell);
        // "2*i" is 2 i; NumPy writes "+-" before a negative imaginary part.
        let inner = inner
            .strip_suffix(['i', 'j'])?
            .trim_end_matches('*')
            .replace("+-", "-");
        let (re, im) = match last_sign(&inner) {
            Some(at) => inner.split_at(at),
            None => ("0", inner.as_str()),
        };
        let im = im.trim_start_matches('+');
        if is_filled_number(re) && is_filled_number(im) {
            Some(Self::new(re, im))
        } else {
            None
        }
    }
}

/// Returns the offset of the sign between the real and the imaginary part: the last sign that is
/// neither at the beginning nor in an exponent.
fn last_sign(number: &str) -> Option<usize> {
    let (at, _) = number.char_indices().rfind(|(at, letter)| {
        *at > 0 && matches!(letter, '+' | '-') && !number[..*at].ends_with(['e', 'E', 'd', 'D'])
    })?;
    Some(at)
}

/// Returns whether a text is a number, neither empty nor missing.
fn is_filled_number(text: &str) -> bool {
    !text.is_empty() && has_number(text, DECIMAL_COMMA)
}

#[cfg(test)]
mod tests {
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
