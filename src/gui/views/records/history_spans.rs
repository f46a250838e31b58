//! Time spans marked in a record's charts: logging-system modes, and gaps.

use gdcm_sysid::records::ModeSpan;
use gdcm_sysid::spectra::gap::{Gap, Treatment};

use super::page::Page;
use crate::gui::plot::chart::ChartSpan;
use crate::gui::widgets::palette::Palette;

/// Returns the time spans of the logging system's modes, with alternating light and dark shading.
pub(super) fn mode_spans(modes: &[ModeSpan], palette: &Palette) -> Vec<ChartSpan> {
    let mut spans = Vec::new();
    for (index, mode) in modes.iter().enumerate() {
        let opacity = if index.is_multiple_of(2) { 0.06 } else { 0.14 };
        spans.push(ChartSpan {
            ends: mode.ends_s,
            color: palette.dim_text.gamma_multiply(opacity),
        });
    }
    spans
}

/// Returns the gaps in the displayed record that the identification bridged, estimated or cut out;
/// none without a current identification.
pub(super) fn gap_spans(page: Page<'_>) -> Vec<ChartSpan> {
    let Page {
        records, palette, ..
    } = page;
    let Some(found) = page.current_identification() else {
        return Vec::new();
    };
    let record = (0..found.record_uses.len())
        .find(|record| records.row_of_record(*record) == Some(records.chosen));
    let Some(record) = record else {
        return Vec::new();
    };
    found.record_uses[record]
        .gaps
        .iter()
        .map(|gap| gap_span(gap, palette))
        .collect()
}

fn gap_span(gap: &Gap, palette: &Palette) -> ChartSpan {
    ChartSpan {
        ends: [gap.start_s, gap.end_s],
        color: match gap.treatment {
            Treatment::Bridged | Treatment::Estimated => palette.accent.gamma_multiply(0.25),
            Treatment::CutOut => palette.warning.gamma_multiply(0.35),
        },
    }
}
