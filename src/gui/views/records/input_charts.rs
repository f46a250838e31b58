//! Page about the inputs' excitation: a chart for each input, with its autospectrum in every
//! record.
//!
//! An autospectrum is a power spectral density over frequency: it shows which frequencies an input
//! excites.

use std::sync::Arc;

use egui::{Rect, ScrollArea, Sense, Ui, vec2};

use gdcm_model::dataset::Band;

use super::autospectra::{Autospectra, autospectra};
use super::frame_cache::cached;
use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLine, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::palette::Palette;

/// Minimum chart height \[pt\].
const LEAST_HEIGHT: f32 = 140.0;

struct RecordSpectra {
    /// Whether the record is displayed.
    is_chosen: bool,
    inputs: Arc<Autospectra>,
}

impl RecordSpectra {
    /// Returns an input's line, thicker and in another colour for the displayed record.
    fn line(&self, input: usize, palette: &Palette) -> Option<ChartLine> {
        let points = Arc::clone(self.inputs.get(input)?);
        Some(if self.is_chosen {
            ChartLine {
                points,
                color: palette.identified,
                width: 1.8,
                dash: None,
            }
        } else {
            ChartLine {
                points,
                color: palette.perturbed.gamma_multiply(0.6),
                width: 1.0,
                dash: None,
            }
        })
    }
}

/// Shows a chart for each input with its spectrum in every record, the displayed record on top.
pub(super) fn inputs_ui(ui: &mut Ui, page: Page<'_>) {
    let band = shown_band(page);
    let charts = InputCharts {
        page,
        spectra: record_spectra(ui, page, band),
        band,
    };
    ScrollArea::vertical()
        .id_salt("inputs")
        .auto_shrink(false)
        .show(ui, |ui| charts.show(ui));
}

/// Charts for the inputs with an autospectrum from each record, in up to two columns.
struct InputCharts<'a> {
    page: Page<'a>,
    spectra: Vec<RecordSpectra>,
    /// Band, marked in every chart.
    band: Band,
}

impl InputCharts<'_> {
    /// Draws the charts row by row, as high as the page allows.
    fn show(&self, ui: &mut Ui) {
        let count = self.page.state.dataset().inputs().len();
        let columns = if count > 1 { 2 } else { 1 };
        let rows = count.div_ceil(columns);
        let height = ((ui.available_height() - 6.0) / rows.max(1) as f32).max(LEAST_HEIGHT);
        let width = ui.available_width() / columns as f32;
        let size = vec2(width * columns as f32, height * rows as f32);
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        for input in 0..count {
            let column = (input % columns) as f32;
            let row = (input / columns) as f32;
            let corner = area.min + vec2(column * width, row * height);
            self.input_ui(ui, Rect::from_min_size(corner, vec2(width, height)), input);
        }
    }

    fn input_ui(&self, ui: &mut Ui, place: Rect, input: usize) {
        let Page { state, palette, .. } = self.page;
        let channel = &state.dataset().inputs()[input];
        let unit = state.display.curves.unit;
        let title = format!("{}: autospectrum of each record", channel.name);
        let label = format!("dB of ({})²/Hz", channel.unit);
        let across = unit.axis_label();
        let mut chart = Chart::new(&title, ChartAxis::Frequency(unit), &across, &label);
        chart.spans.push(ChartSpan {
            ends: [self.band.min(), self.band.max()],
            color: palette.accent.gamma_multiply(0.12),
        });
        for is_chosen in [false, true] {
            for record in &self.spectra {
                if record.is_chosen == is_chosen {
                    chart.lines.extend(record.line(input, palette));
                }
            }
        }
        chart_ui(ui, place, &chart, palette);
    }
}

/// Returns the condition's identification band, or else the study's band.
fn shown_band(page: Page<'_>) -> Band {
    let study_band = page.state.study.settings.band;
    match page.records.band {
        Some([low, high]) => Band::new(low, high).unwrap_or(study_band),
        None => study_band,
    }
}

/// Computes autospectra for every record with assigned columns.
fn record_spectra(ui: &Ui, page: Page<'_>, band: Band) -> Vec<RecordSpectra> {
    let records = page.records;
    let mut spectra = Vec::new();
    for (index, row) in records.rows.iter().enumerate() {
        let Some(flight) = &row.flight else { continue };
        let inputs = cached(
            ui,
            &format!("autospectrum {index}"),
            &[Arc::clone(flight) as _],
            band.max().to_bits(),
            || autospectra(flight, band.max()),
        );
        spectra.push(RecordSpectra {
            is_chosen: index == records.chosen,
            inputs,
        });
    }
    spectra
}
