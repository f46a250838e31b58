//! Columns of complex numbers as text, `(1.5-2j)`, as columns of their real and imaginary parts.

use super::separator::{Separator, cell_number, lines};
use crate::text::columns::comment;
use crate::variables::{ReadingBudget, VariableFault};

/// The text with two columns in place of each that holds complex numbers, their headings with "re" and "im" before them; nothing where
/// there is none. Lines keep their numbers.
pub fn split_complex(text: &str, budget: &ReadingBudget) -> Result<Option<String>, VariableFault> {
    let Some((separator, is_complex)) = complex_columns(text) else { return Ok(None) };
    budget.take(text.len() as u64, 3, "")?;
    let between = match separator {
        Separator::Tab => "\t",
        Separator::Semicolon => ";",
        Separator::Pipe => "|",
        Separator::Comma => ",",
        Separator::Blanks => " ",
    };
    let mut split = String::with_capacity(2 * text.len());
    for (_, line) in lines(text) {
        budget.work(1, "")?;
        let cells: Vec<String> = separator.cells(comment(line).unwrap_or(line)).map(|cell| cell.into_owned()).collect();
        if cells.len() == is_complex.len() {
            let cells = cells.iter().zip(&is_complex).map(|(cell, is_complex)| match is_complex {
                true => two_cells(cell, separator, between),
                false => quoted(cell, between),
            });
            split.push_str(&cells.collect::<Vec<_>>().join(between));
        } else {
            split.push_str(line);
        }
        split.push('\n');
    }
    // Behind the last end of a line an empty one was read.
    split.pop();
    Ok(Some(split))
}

/// What stands between the cells of the first line that holds complex numbers beside real ones, and which cells they are.
fn complex_columns(text: &str) -> Option<(Separator, Vec<bool>)> {
    /// Lines that are looked at.
    const SAMPLE: usize = 200;
    let of_line = |line: &str| {
        Separator::ALL.into_iter().find_map(|separator| {
            let parsed = |cell: &str| match parts(cell) {
                Some(_) => Some(true),
                None => cell_number(cell, false).map(|_| false),
            };
            let cells = separator.cells(line).map(|cell| parsed(&cell)).collect::<Option<Vec<bool>>>()?;
            (cells.len() > 1 && cells.contains(&true)).then_some((separator, cells))
        })
    };
    lines(text).filter(|(_, line)| comment(line).is_none()).take(SAMPLE).find_map(|(_, line)| of_line(line))
}

fn two_cells(cell: &str, separator: Separator, between: &str) -> String {
    if let Some((re, im)) = parts(cell) {
        return format!("{re}{between}{im}");
    }
    let cell = cell.trim();
    match cell_number(cell, false) {
        Some(number) if number.is_nan() => format!("{cell}{between}{cell}"),
        Some(_) => format!("{cell}{between}0"),
        None => {
            let joint = if separator == Separator::Blanks { "_" } else { " " };
            format!(
                "{}{between}{}",
                quoted(&format!("re{joint}{cell}"), between),
                quoted(&format!("im{joint}{cell}"), between)
            )
        }
    }
}

fn quoted(cell: &str, between: &str) -> String {
    if cell.contains(between) { format!("\"{cell}\"") } else { cell.to_owned() }
}

/// Real and imaginary part of "(1.5-2j)", "1.5 + 2i", "2e-3j", "(1+-2j)".
fn parts(cell: &str) -> Option<(String, String)> {
    let cell: String = cell.chars().filter(|letter| !letter.is_whitespace()).collect();
    let inner = cell.strip_prefix('(').and_then(|cell| cell.strip_suffix(')')).unwrap_or(&cell);
    let inner = inner.strip_suffix(['i', 'j'])?.trim_end_matches('*').replace("+-", "-");
    let is_sign = |(at, letter): &(usize, char)| {
        *at > 0 && matches!(letter, '+' | '-') && !inner[..*at].ends_with(['e', 'E', 'd', 'D'])
    };
    let (re, im) = match inner.char_indices().rfind(is_sign) {
        Some((at, _)) => inner.split_at(at),
        None => ("0", inner.as_str()),
    };
    let im = im.trim_start_matches('+');
    let is_number = |text: &str| !text.is_empty() && cell_number(text, false).is_some_and(|number| !number.is_nan());
    (is_number(re) && is_number(im)).then(|| (re.to_owned(), im.to_owned()))
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
        assert_eq!(split(text).unwrap(), "omega,re H,im H\n1,1.5,-2\n2,3e-2,4e+1\n3,0,-2\n4,7,0\n");
        let blanks = "# w H\n 1.0e+00 (1.0e+00+-2.0e+00j)\n";
        assert_eq!(split(blanks).unwrap(), "w re_H im_H\n1.0e+00 1.0e+00 -2.0e+00\n");
    }

    #[test]
    fn other_tables_and_words_are_left_alone() {
        for text in ["w,re,im\n1,2,3\n", "t;mode\n1;j\n", "", "a,i\nb,j\n"] {
            assert_eq!(split(text), None, "{text}");
        }
    }
}
