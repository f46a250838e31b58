//! Where in a file something stands, in the engineer's words.

use gdcm_core::dataset::{BundleKind, ConditionPlace, Location, ModelPlace};

use super::outline::Outline;
use gdcm_core::message_text::{sanitized, shortened};

/// One step on the way from the top of a JSON text to a value in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Into an object, to this key.
    Key(String),
    /// Into a list, to this entry, counted from 0.
    Entry(usize),
}

/// The location that these steps lead to.
pub(super) fn location_of(steps: &[Step], outline: &Outline) -> Location {
    let mut place = Location::default();
    let mut rest = steps;
    if let [Step::Key(key), Step::Entry(index), after @ ..] = rest
        && key == "conditions"
    {
        place.condition = Some(ConditionPlace { position: index + 1, id: outline.id(*index) });
        rest = after;
        if let [Step::Key(key), Step::Entry(model), after @ ..] = rest
            && let Some(bundle) = bundle_of(key)
        {
            let name = outline.name(*index, key, *model);
            place.model = Some(ModelPlace { bundle, position: model + 1, name });
            rest = after;
        }
    }
    place.entry = entry_words(rest);
    place
}

fn bundle_of(key: &str) -> Option<BundleKind> {
    match key {
        "physics_models" => Some(BundleKind::Physics),
        "identified_models" => Some(BundleKind::Identified),
        _ => None,
    }
}

/// Steps in words: `A[2][0]` is "matrix A, row 3, column 1", `re[0][1][4]` is "re, output 1, input 2, entry 5".
fn entry_words(steps: &[Step]) -> String {
    let mut words: Vec<String> = Vec::new();
    let mut indices: &[&str] = &[];
    for step in steps {
        match step {
            Step::Key(key) => {
                indices = match key.as_str() {
                    "A" | "B" | "C" | "D" => &["row", "column"],
                    "re" | "im" | "coherence" | "valid_band_rad_s" | "sd_db" | "sd_deg" => &["output", "input"],
                    _ => &[],
                };
                let matrix = if indices == ["row", "column"] { "matrix " } else { "" };
                words.push(format!("{matrix}{}", shortened(&sanitized(key))));
            }
            Step::Entry(index) => {
                let (name, after) = indices.split_first().map_or(("entry", indices), |(name, after)| (*name, after));
                words.push(format!("{name} {}", index + 1));
                indices = after;
            }
        }
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(path: &[&str]) -> Vec<Step> {
        path.iter().map(|step| step.parse().map_or(Step::Key((*step).to_owned()), Step::Entry)).collect()
    }

    #[test]
    fn a_place_is_named_by_id_name_matrix_row_and_column() {
        let outline = Outline::of(br#"{"conditions": [{"id": 10, "physics_models": [{"name": "nominal"}]}]}"#);
        let place = location_of(&steps(&["conditions", "0", "physics_models", "0", "A", "2", "4"]), &outline);
        let expected =
            "condition 10 (number 1 in the file), physics model \"nominal\" (number 1), matrix A, row 3, column 5";
        assert_eq!(place.to_string(), expected);
    }

    #[test]
    fn what_cannot_be_named_is_counted() {
        let path = steps(&["conditions", "2", "identified_models", "1", "frequency_response", "re", "0", "1", "4"]);
        let place = location_of(&path, &Outline::default());
        let expected = "condition number 3 in the file, identified model number 2, frequency_response, re, output 1, input 2, entry 5";
        assert_eq!(place.to_string(), expected);
    }
}
