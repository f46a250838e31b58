//! Patterns for file paths, with the wildcards `*` and `?`; not the patterns that read values from
//! names (`names/name_pattern.rs`).

/// Returns whether a pattern matches a file or one of its parent folders. `*` matches any
/// characters within a name, `?` a single character. A pattern without a slash may match any name
/// in the path; a pattern with a slash must match the path from its beginning.
pub(super) fn matches_path(pattern: &str, file: &str) -> bool {
    let pattern = pattern.trim_end_matches('/');
    let mut names = file.split('/');
    if !pattern.contains('/') {
        return names.any(|name| matches_name(pattern, name));
    }
    pattern
        .split('/')
        .all(|part| names.next().is_some_and(|name| matches_name(part, name)))
}

/// Position of a star in the pattern, and of the first letter in the name that it does not cover
/// yet.
struct Star {
    in_pattern: usize,
    in_name: usize,
}

/// Returns whether a pattern matches a whole name.
///
/// Only the last star is extended on a mismatch, so that the time grows with the product of both
/// lengths, not exponentially.
fn matches_name(pattern: &str, name: &str) -> bool {
    let pattern: Vec<char> = pattern.chars().collect();
    let name: Vec<char> = name.chars().collect();
    let mut at_pattern = 0;
    let mut at_name = 0;
    let mut last_star: Option<Star> = None;
    while at_name < name.len() {
        match pattern.get(at_pattern) {
            Some('*') => {
                last_star = Some(Star {
                    in_pattern: at_pattern,
                    in_name: at_name,
                });
                at_pattern += 1;
            }
            Some(letter) if *letter == '?' || *letter == name[at_name] => {
                at_pattern += 1;
                at_name += 1;
            }
            _ => {
                let Some(star) = &mut last_star else {
                    return false;
                };
                star.in_name += 1;
                at_pattern = star.in_pattern + 1;
                at_name = star.in_name;
            }
        }
    }
    pattern[at_pattern..].iter().all(|letter| *letter == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_matches_names_of_folders_and_files() {
        for (pattern, matches) in [
            ("flight_*", true),
            ("flight_*/", true),
            ("c03", true),
            ("c03/*", true),
            ("c0?/flight_1", true),
            ("*.mat", true),
            ("c03/flight_1/m*.mat", true),
            ("*", true),
            ("flight", false),
            ("flight_1/c03", false),
            ("c03/m.mat", false),
            ("c03/flight_1/model.mat/more", false),
            ("*a*b*c", false),
        ] {
            assert_eq!(
                matches_path(pattern, "c03/flight_1/model.mat"),
                matches,
                "{pattern}"
            );
        }
        let long = "*a".repeat(500);
        assert!(!matches_path(&long, &"a".repeat(499)));
    }
}
