//! Cautions about the response in focus: their short forms, and the frequency ranges that they call
//! doubtful.

use gdcm_sysid::identification::CautionNote;

use super::page::Page;

/// Returns short forms of the cautions about the displayed response.
///
/// A caution with a pair concerns that response. A caution with a channel, unless it is about
/// single records, concerns the responses to or of that channel. Of the others, only feedback and a
/// narrowed band are marked; they concern all responses.
pub(super) fn short_cautions(page: Page<'_>) -> Vec<&'static str> {
    let dataset = page.state.dataset();
    let pair = page.state.display.selection.pair;
    let output = &dataset.outputs()[pair.output].name;
    let input = &dataset.inputs()[pair.input].name;
    let mut cautions = Vec::new();
    for (_, note) in page.records.cautions() {
        let is_concerned = match (&note.pair, &note.channel) {
            (Some(names), _) => names[0] == *output && names[1] == *input,
            (None, Some(channel)) => {
                note.records.is_empty() && (channel == output || channel == input)
            }
            (None, None) => note.code.starts_with("feedback") || note.code == "band-narrowed",
        };
        if is_concerned {
            cautions.push(note.mark());
        }
    }
    cautions
}

/// Returns the frequency ranges \[rad/s\] to which a caution refers: the lower end of the band if
/// the records are short, or the parts of `band` outside the narrowed band; none for other
/// cautions.
pub(super) fn doubtful_ranges(note: &CautionNote, band: [f64; 2]) -> Vec<[f64; 2]> {
    match (note.code, note.band_rad_s) {
        ("short", Some(ends)) => vec![ends],
        ("band-narrowed", Some([low, high])) => vec![[band[0], low], [high, band[1]]],
        _ => Vec::new(),
    }
}
