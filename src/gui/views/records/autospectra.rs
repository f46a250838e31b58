//! Input excitation: autospectra of every record.

use std::sync::Arc;

use egui::{Rect, ScrollArea, Sense, Ui, vec2};

use gdcm_model::dataset::Band;
use gdcm_model::executor::Sequential;
use gdcm_model::simulation::{FlightRecord, Segment};
use gdcm_sysid::spectra::spectrum::spectra;

use super::frame_cache::cached;
use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLine, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::palette::Palette;

/// Minimum chart height \[pt\].
const LEAST_HEIGHT: f32 = 140.0;
/// Number of adjacent spectral lines averaged into one point.
const SMOOTHED: usize = 5;

/// Autospectrum of each input: frequency \[rad/s\] and level \[dB of the squared unit per Hz\].
type Autospectra = Vec<Arc<[[f64; 2]]>>;

struct RecordSpectra {
    is_chosen: bool,
    inputs: Arc<Autospectra>,
}

impl RecordSpectra {
    /// Returns the line of an input: bright and thick for the displayed record.
    fn line(&self, input: usize, palette: &Palette) -> Option<ChartLine> {
        let points = Arc::clone(self.inputs.get(input)?);
        Some(if self.is_chosen {
            ChartLine {
                points,
                color: palette.identified,
                width: 1.8,
                dashed: false,
            }
        } else {
            ChartLine {
                points,
                color: palette.perturbed.gamma_multiply(0.6),
                width: 1.0,
                dashed: false,
            }
        })
    }
}

/// Shows a chart of each input with its spectrum in every record, the displayed record on top.
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

/// Charts of the inputs with an autospectrum of each record, in up to two columns.
struct InputCharts<'a> {
    page: Page<'a>,
    spectra: Vec<RecordSpectra>,
    /// Band, marked in every chart.
    band: Band,
}

impl InputCharts<'_> {
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

/// Returns the identification band of the condition, or else the band of the study.
fn shown_band(page: Page<'_>) -> Band {
    let study_band = page.state.study.settings.band;
    match page.records.band {
        Some([low, high]) => Band::new(low, high).unwrap_or(study_band),
        None => study_band,
    }
}

/// Computes the autospectra of every record with assigned columns.
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

/// Computes the power spectral density of each input about its mean,
/// `2 dt² / T |Σ u exp(-j ω t)|²`, averaged over [`SMOOTHED`] lines.
///
/// The spectrum `U = dt / sqrt(T) Σ u exp(-j ω t)` comes from [`spectra`]; u is the input, dt the
/// sample time and T the length of the record \[s\].
///
/// One-sided: the integral over frequency \[Hz\] is the variance (Bendat and Piersol, Random Data,
/// 5.2.2). The spectrum extends to twice the band end `highest` \[rad/s\].
fn autospectra(flight: &FlightRecord, highest: f64) -> Autospectra {
    let Some(sample_time_s) = middle_step(&flight.time_s) else {
        return Vec::new();
    };
    let mut inputs = flight.inputs.map(zero_if_missing);
    for mut column in inputs.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    let segment = Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s,
        inputs,
        outputs: flight.outputs.map(zero_if_missing),
    };
    let found = spectra(&[segment], 2.0 * highest, &Sequential);
    let Some(spectrum) = found.first() else {
        return Vec::new();
    };
    let mut autospectra = Vec::new();
    for input in 0..flight.inputs.ncols() {
        let mut lines = Vec::new();
        for (line, omega) in spectrum.omega.iter().enumerate() {
            lines.push([*omega, 2.0 * spectrum.inputs[(input, line)].norm_sqr()]);
        }
        autospectra.push(lines.chunks(SMOOTHED).map(smoothed_level).collect());
    }
    autospectra
}

/// Returns the median of the positive time steps \[s\], which is the sample time if sampling is
/// nearly uniform; `None` without positive steps.
fn middle_step(time_s: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = time_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    steps.get(steps.len() / 2).copied()
}

fn zero_if_missing(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// Averages spectral lines: geometric mean of the frequencies \[rad/s\], and mean power as a level
/// \[dB\].
fn smoothed_level(lines: &[[f64; 2]]) -> [f64; 2] {
    let count = lines.len() as f64;
    let mut log_omega = 0.0;
    let mut power = 0.0;
    for line in lines {
        log_omega += line[0].ln();
        power += line[1];
    }
    [
        (log_omega / count).exp(),
        10.0 * (power / count).max(f64::MIN_POSITIVE).log10(),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn the_integral_of_an_autospectrum_is_the_variance() {
        // 500 lines below half the sampling frequency: 100 complete groups.
        let samples = 1001;
        let input: Vec<f64> = (0..samples)
            .map(|n| (0.7 * (n * n) as f64).sin() + 3.0)
            .collect();
        let flight = FlightRecord {
            name: "record".to_owned(),
            time_s: (0..samples).map(|n| 0.02 * n as f64).collect(),
            inputs: DMatrix::from_column_slice(samples, 1, &input),
            outputs: DMatrix::from_column_slice(samples, 1, &input),
        };
        let autospectrum = autospectra(&flight, 1e6)[0].clone();
        let step_hz = SMOOTHED as f64 / (0.02 * samples as f64);
        let mean = input.iter().sum::<f64>() / samples as f64;
        let integral: f64 = autospectrum
            .iter()
            .map(|[_, db]| 10f64.powf(0.1 * db) * step_hz)
            .sum();
        let variance = input.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / samples as f64;
        // Parseval's theorem, up to rounding in a thousand terms.
        assert!(
            (integral / variance - 1.0).abs() < 1e-9,
            "{integral} {variance}"
        );
    }
}
