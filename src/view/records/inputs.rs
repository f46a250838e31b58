//! Which input was moved in which record, and up to which frequency.

use std::sync::Arc;

use egui::{Rect, ScrollArea, Sense, Ui, vec2};

use crate::view::palette::Palette;
use crate::view::plot::{Chart, ChartAxis, ChartLine, ChartSpan, chart_ui};
use crate::view::state::State;
use gdcm_core::dataset::Band;
use gdcm_core::executor::Sequential;
use gdcm_core::identification::{FlightRecord, Piece, spectra};

use super::bench::ConditionRecords;
use super::kept::kept;

const LEAST_HEIGHT: f32 = 140.0;
/// Lines of a spectrum that are averaged into one point.
const SMOOTHED: usize = 5;

/// Amplitude of each input over frequency: \[rad/s\] and \[dB\].
type Amplitudes = Vec<Arc<[[f64; 2]]>>;

/// A chart for each input: its spectrum in every record, the chosen one on top.
pub(super) fn inputs_ui(ui: &mut Ui, state: &State, records: &ConditionRecords, palette: &Palette) {
    let dataset = state.dataset();
    let unit = state.display.unit;
    let band = records
        .band
        .map_or(state.study.settings.band, |band| Band::new(band[0], band[1]).unwrap_or(state.study.settings.band));
    let of_rows: Vec<(bool, Arc<Amplitudes>)> = records
        .rows
        .iter()
        .enumerate()
        .filter_map(|(index, row)| {
            let flight = row.flight.as_ref()?;
            let (name, source) = (format!("amplitude {index}"), Arc::clone(flight));
            let spectra = kept(ui, &name, &[source], band.max().to_bits(), || amplitude(flight, band.max()));
            Some((index == records.chosen, spectra))
        })
        .collect();
    ScrollArea::vertical().id_salt("inputs").auto_shrink(false).show(ui, |ui| {
        let count = dataset.inputs().len();
        let columns = if count > 1 { 2 } else { 1 };
        let rows = count.div_ceil(columns);
        let height = ((ui.available_height() - 6.0) / rows.max(1) as f32).max(LEAST_HEIGHT);
        let width = ui.available_width() / columns as f32;
        let area = ui.allocate_exact_size(vec2(width * columns as f32, height * rows as f32), Sense::hover()).0;
        for (input, channel) in dataset.inputs().iter().enumerate() {
            let corner = area.min + vec2((input % columns) as f32 * width, (input / columns) as f32 * height);
            let title = format!("{}: amplitude of each record", channel.name);
            let label = format!("dB of {}·s", channel.unit);
            let across = unit.axis_label();
            let mut chart = Chart::new(&title, ChartAxis::Frequency(unit), &across, &label);
            let color = palette.accent.gamma_multiply(0.12);
            chart.spans.push(ChartSpan { ends: [band.min(), band.max()], color });
            for is_chosen in [false, true] {
                let lines = of_rows.iter().filter(|(chosen, _)| *chosen == is_chosen);
                chart.lines.extend(lines.filter_map(|(_, spectra)| spectra.get(input)).map(|points| ChartLine {
                    points: Arc::clone(points),
                    color: if is_chosen { palette.identified } else { palette.perturbed.gamma_multiply(0.6) },
                    width: if is_chosen { 1.8 } else { 1.0 },
                    dashed: false,
                }));
            }
            chart_ui(ui, Rect::from_min_size(corner, vec2(width, height)), &chart, palette);
        }
    });
}

/// Amplitude of each input over frequency \[dB\].
fn amplitude(flight: &FlightRecord, highest: f64) -> Amplitudes {
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let steps: Vec<f64> = flight.time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let Some(step) = steps.get(steps.len() / 2).copied() else { return Vec::new() };
    let mut inputs = flight.inputs.map(finite);
    for mut column in inputs.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    let piece = Piece { record: 0, start_s: 0.0, sample_time_s: step, inputs, outputs: flight.outputs.map(finite) };
    let Some(spectrum) = spectra(&[piece], 2.0 * highest, &Sequential).into_iter().next() else { return Vec::new() };
    (0..flight.inputs.ncols())
        .map(|input| {
            let lines: Vec<[f64; 2]> = spectrum
                .omega
                .iter()
                .enumerate()
                .map(|(k, omega)| [*omega, spectrum.inputs[(input, k)].norm_sqr()])
                .collect();
            let smooth = |part: &[[f64; 2]]| {
                let count = part.len() as f64;
                let (omega, power) = part.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at[0].ln(), sum.1 + at[1]));
                [(omega / count).exp(), 10.0 * (power / count).max(f64::MIN_POSITIVE).log10()]
            };
            lines.chunks(SMOOTHED).map(smooth).collect()
        })
        .collect()
}
