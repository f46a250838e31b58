//! Tables behind one another in one text, each under a heading of its own.

use super::cell_number::cell_number;
use super::layout::{comment, is_rule};
use super::lines::lines;

/// Cuts a text before every heading that stands behind rows: number of the first line of each part, and the part. A log that is begun
/// anew with other columns is so cut where they change.
pub fn sections(text: &str) -> Vec<(usize, &str)> {
    let mut starts: Vec<(usize, usize)> = vec![(1, 0)];
    let mut has_rows = false;
    for (number, line) in lines(text) {
        if line.trim().is_empty() || comment(line).is_some() || is_rule(line) {
            continue;
        }
        let is_heading = is_heading(line);
        if is_heading && has_rows {
            // Lines are parts of the text.
            starts.push((number, line.as_ptr() as usize - text.as_ptr() as usize));
        }
        has_rows = !is_heading;
    }
    let ends = starts.iter().skip(1).map(|(_, at)| *at).chain([text.len()]);
    starts.iter().zip(ends).filter_map(|(&(line, start), end)| Some((line, text.get(start..end)?))).collect()
}

/// Whether no cell of a line is a number, and one holds letters.
fn is_heading(line: &str) -> bool {
    let strong = ['|', ';', '\t', ','];
    let is_between = |c: char| if line.contains(strong) { strong.contains(&c) } else { c.is_whitespace() };
    let mut cells = line.split(is_between).map(str::trim).filter(|cell| !cell.is_empty());
    let is_number = |cell: &str| cell_number(cell, false).is_some_and(|number| !number.is_nan());
    line.chars().any(char::is_alphabetic) && !cells.any(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_cut_where_a_heading_stands_behind_rows() {
        let text = "\nt | P |\n1 | 2 |\n2 | nan |\n\nt | P | Q |\n\nt | P | Q |\n1 | 2 | 3 |\n";
        let found = sections(text);
        assert_eq!(found, [(1, "\nt | P |\n1 | 2 |\n2 | nan |\n\n"), (6, "t | P | Q |\n\nt | P | Q |\n1 | 2 | 3 |\n")]);
        assert_eq!(sections("# by hand\na b\n1 2\n# middle\n3 4"), [(1, "# by hand\na b\n1 2\n# middle\n3 4")]);
        assert_eq!(sections(""), [(1, "")]);
    }
}
