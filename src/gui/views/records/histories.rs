//! Every channel of a record over time, and the excitation of the inputs over frequency.

use std::sync::Arc;

use egui::{
    ColorImage, Id, Label, Rect, RichText, ScrollArea, Sense, TextureHandle, TextureOptions, Ui,
    vec2,
};

use gdcm_model::dataset::Band;
use gdcm_model::executor::Sequential;
use gdcm_model::simulation::{FlightRecord, Segment};
use gdcm_model::units::telling;
use gdcm_sysid::identification::CautionNote;
use gdcm_sysid::records::spectrogram::Spectrogram;
use gdcm_sysid::records::{LaidOutRecord, ModeSpan};
use gdcm_sysid::spectra::gaps::Treatment;
use gdcm_sysid::spectra::spectrum::spectra;

use super::frame_cache::{Source, kept};
use super::numbers;
use super::page::Page;
use super::simulation::{simulated, time_models_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartImage, ChartLine, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::plot::stretch::chosen_stretch;
use crate::gui::state::records::ConditionRecords;
use crate::gui::widgets::choices::{check_ui, choice_ui};
use crate::gui::widgets::controls::entry_ui;
use crate::gui::widgets::palette::Palette;

/// Minimum height of a chart \[pt\]; further charts scroll.
const LEAST_HEIGHT: f32 = 84.0;

/// Shows a chart for each input and output, with the selected models' responses to the same inputs.
pub(super) fn histories_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    let Some(flight) = &row.flight else {
        ui.label(
            RichText::new("Choose first which columns are its channels: page Columns")
                .color(palette.warning),
        );
        return;
    };
    let dataset = state.dataset();
    let names = dataset
        .inputs()
        .iter()
        .chain(dataset.outputs())
        .map(|channel| format!("{} [{}]", channel.name, channel.unit));
    let names: Vec<String> = names.collect();
    let mut gaps = modes_ui(ui, &row.table.modes, palette);
    gaps.extend(spans(records, palette));
    ui.horizontal_wrapped(|ui| {
        time_models_ui(ui, state, palette, commands);
        spectrogram_choice_ui(ui, page, commands);
        part_ui(ui, page, commands);
        span_ui(ui, records, palette);
    });
    if let Some((part_s, has_ended)) = chosen_stretch(ui, charts()) {
        gaps.push(ChartSpan {
            ends: part_s,
            color: palette.accent.gamma_multiply(0.35),
        });
        if has_ended {
            commands.push(RecordsCommand::AddPart(records.chosen, part_s).into());
        }
    }
    let found = records.identification().filter(|_| !records.changed);
    let uses = found
        .into_iter()
        .flat_map(|found| found.record_uses.iter().enumerate());
    let uses = uses.filter(|(record, _)| records.row_of_record(*record) == Some(records.chosen));
    for fact in uses.flat_map(|(_, used)| used.facts()) {
        ui.label(palette.small(fact));
    }
    let models = simulated(state, palette);
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    spectrogram_ui(ui, page, flight);
    ScrollArea::vertical()
        .id_salt("histories")
        .auto_shrink(false)
        .show(ui, |ui| {
            let rows = names.len().div_ceil(2).max(1);
            let height = ((ui.available_height() - 6.0) / rows as f32).max(LEAST_HEIGHT);
            let width = 0.5 * ui.available_width();
            let area = ui
                .allocate_exact_size(vec2(2.0 * width, height * rows as f32), Sense::hover())
                .0;
            for (place, name) in names.iter().enumerate() {
                // Column by column, so that inputs come before outputs.
                let column = place / rows;
                let line = place % rows;
                let corner = area.min + vec2(column as f32 * width, line as f32 * height);
                let is_last = line + 1 == rows || place + 1 == names.len();
                let mut chart = Chart::new(
                    name,
                    ChartAxis::Linear,
                    if is_last { "time [s]" } else { "" },
                    "",
                );
                chart.group = Some(charts());
                chart.fits_values = true;
                chart.chooses = state.records.chooses_parts;
                chart.spans.clone_from(&gaps);
                let color = if place < dataset.inputs().len() {
                    palette.text
                } else {
                    palette.identified
                };
                let points = kept(
                    ui,
                    &format!("channel {place}"),
                    &[Arc::clone(flight) as _],
                    (),
                    || points_of(flight, place),
                );
                let line = |points: &Arc<[[f64; 2]]>| ChartLine {
                    points: Arc::clone(points),
                    color,
                    width: 1.0,
                    dashed: false,
                };
                chart.lines.extend(points.iter().map(line));
                if let Some(output) = place.checked_sub(dataset.inputs().len()) {
                    chart
                        .lines
                        .extend(models.iter().flat_map(|model| model.lines(ui, output)));
                    chart.notes.extend(
                        models
                            .iter()
                            .filter_map(|model| Some((model.fit_words(output)?, model.color))),
                    );
                }
                let channel = dataset
                    .inputs()
                    .iter()
                    .chain(dataset.outputs())
                    .nth(place)
                    .map(|of| of.name.as_str());
                let of_channel = |(rows, note): &(Vec<usize>, CautionNote)| {
                    (rows.is_empty() || rows.contains(&records.chosen))
                        && note.channel.as_deref() == channel
                };
                let marks = records
                    .cautions()
                    .filter(of_channel)
                    .map(|(_, note)| note.mark());
                chart
                    .notes
                    .extend(marks.map(|mark| (format!("⚠ {mark}"), palette.warning)));
                chart_ui(
                    ui,
                    Rect::from_min_size(corner, vec2(width, height)),
                    &chart,
                    palette,
                );
            }
        });
}

/// Height of the spectrogram \[pt\].
const SPECTROGRAM_HEIGHT: f32 = 150.0;

/// Id of the time axis shared by the charts of the displayed record.
fn charts() -> Id {
    Id::unique("flight record")
}

/// Makes records from parts dragged in the charts or typed.
fn part_ui(
    ui: &mut Ui,
    Page {
        state,
        records,
        palette,
    }: Page<'_>,
    commands: &mut Vec<Command>,
) {
    ui.label(palette.small("part [s]"));
    let text = entry_ui(ui, "Part of the record", "", "from to", 70.0);
    let span_s = records
        .rows
        .get(records.chosen)
        .and_then(LaidOutRecord::span_s);
    if let Some(text) = text.filter(|text| !text.trim().is_empty()) {
        commands.push(match part_of(&text, span_s) {
            Some(part_s) => RecordsCommand::AddPart(records.chosen, part_s).into(),
            None => Command::Form(FormCommand::Refuse(format!(
                "a part: expected two times in s, the earlier first, as in \"12 40\", or \"+5 +34\" from the start of the record, \
                 found \"{text}\""
            ))),
        });
    }
    let hint = "Dragging in a chart makes that stretch a record of its own, to be fitted or held out, in place of the whole";
    if let Some(chooses) = check_ui(ui, state.records.chooses_parts, "drag parts", hint) {
        commands.push(RecordsCommand::ChooseParts(chooses).into());
    }
}

/// Parses a typed part: two times on the record's clock, or with `+` before both, from its start.
fn part_of(text: &str, span_s: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let [from, to] = numbers(text).ok()?[..] else {
        return None;
    };
    let signs = text
        .split_whitespace()
        .filter(|time| time.starts_with('+'))
        .count();
    let start_s = match signs {
        0 => 0.0,
        2 => span_s?[0],
        _ => return None,
    };
    let part_s: [f64; 2] = [start_s + from, start_s + to];
    (part_s[0] < part_s[1]).then_some(part_s)
}

/// Shows the time span of the displayed record, on its own clock and from the start of the whole
/// record.
fn span_ui(ui: &mut Ui, records: &ConditionRecords, palette: &Palette) {
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    let Some(span_s) = row.span_s() else { return };
    let is_whole = |other: &&LaidOutRecord| {
        other.table.part_s.is_none() && other.table.source == row.table.source
    };
    let whole_s = records
        .rows
        .iter()
        .find(is_whole)
        .and_then(LaidOutRecord::span_s);
    let start_s = whole_s.unwrap_or(span_s)[0];
    let [from, to] = span_s.map(|time_s| telling(time_s, 2));
    let [first, last] = span_s.map(|time_s| telling(time_s - start_s, 2));
    let words = format!(
        "runs from {from} s to {to} s on its clock, +{first} s to +{last} s from its start"
    );
    ui.add(Label::new(palette.small(words)).truncate());
}

/// Selects the spectrogram's input, or none.
fn spectrogram_choice_ui(
    ui: &mut Ui,
    Page { state, palette, .. }: Page<'_>,
    commands: &mut Vec<Command>,
) {
    ui.label(palette.small("spectrogram of"));
    let hint = "Power over time and frequency: a sweep is a ridge that rises";
    let of_inputs = state.dataset().inputs().iter().enumerate();
    let of_inputs = of_inputs.map(|(index, channel)| (Some(index), channel.name.as_str(), hint));
    let choices: Vec<_> = std::iter::once((None, "none", "Only the channels over time"))
        .chain(of_inputs)
        .collect();
    let mut wanted = state.records.spectrogram;
    choice_ui(ui, "Input of the spectrogram", &mut wanted, &choices);
    if wanted != state.records.spectrogram {
        commands.push(RecordsCommand::ShowSpectrogram(wanted).into());
    }
}

/// Shows the spectrogram of the selected input above the charts, over the same time.
fn spectrogram_ui(ui: &mut Ui, page: Page<'_>, flight: &Arc<FlightRecord>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let inputs = state.dataset().inputs();
    let chosen = state.records.spectrogram;
    let Some((index, channel)) = chosen.and_then(|index| Some((index, inputs.get(index)?))) else {
        return;
    };
    let band = records
        .band
        .map_or(state.study.settings.band.max(), |band| band[1]);
    let highest = 2.0 * band;
    let is_dark = ui.visuals().dark_mode;
    let key = (index, highest.to_bits(), is_dark);
    let source: Source = Arc::clone(flight) as _;
    let found = kept(ui, "spectrogram", &[source], key, || {
        let samples: Vec<f64> = flight.inputs.column(index).iter().copied().collect();
        let found = Spectrogram::new(&flight.time_s, &samples, highest)?;
        let picture = picture_of(&found, palette);
        Some((
            ui.ctx()
                .load_texture("spectrogram", picture, TextureOptions::LINEAR),
            found,
        ))
    });
    let Some((texture, found)): &Option<(TextureHandle, Spectrogram)> = &found else {
        ui.label(
            palette.small("The record is too short, or sampled too slowly, for a spectrogram"),
        );
        return;
    };
    let title = format!("{}: power over time, dB below the greatest", channel.name);
    let unit = state.display.curves.unit;
    let label = unit.axis_label();
    let mut chart = Chart::new(&title, ChartAxis::Linear, "", &label);
    chart.group = Some(charts());
    chart.fits_values = true;
    chart.chooses = state.records.chooses_parts;
    let across = found.time_s;
    let omega = found.omega;
    chart.image = Some(ChartImage {
        texture: texture.id(),
        across,
        omega,
        unit,
    });
    let area = ui
        .allocate_exact_size(
            vec2(ui.available_width(), SPECTROGRAM_HEIGHT),
            Sense::hover(),
        )
        .0;
    chart_ui(ui, area, &chart, palette);
}

/// Returns an image with a pixel for each window and row, from the background to the colour of
/// identified models.
fn picture_of(found: &Spectrogram, palette: &Palette) -> ColorImage {
    let shade = |level: f64| {
        palette.background.lerp_to_gamma(
            palette.identified,
            (1.0 - level / Spectrogram::FLOOR) as f32,
        )
    };
    let rows = (0..Spectrogram::ROWS).rev();
    let pixels = rows
        .flat_map(|row| found.levels.iter().map(move |levels| shade(levels[row])))
        .collect();
    ColorImage::new([found.levels.len(), Spectrogram::ROWS], pixels)
}

/// Returns the samples of a channel as unbroken lines, with gaps for missing samples.
fn points_of(flight: &FlightRecord, place: usize) -> Vec<Arc<[[f64; 2]]>> {
    let inputs = flight.inputs.ncols();
    let value = |sample: usize| match place.checked_sub(inputs) {
        None => flight.inputs[(sample, place)],
        Some(output) => flight.outputs[(sample, output)],
    };
    let points: Vec<[f64; 2]> = flight
        .time_s
        .iter()
        .enumerate()
        .map(|(at, time)| [*time, value(at)])
        .collect();
    let runs = points.split(|point| point.iter().any(|value| !value.is_finite()));
    runs.filter(|run| !run.is_empty()).map(Arc::from).collect()
}

/// Returns the modes of the logging system as spans, every other one shaded, and shows their names
/// above the charts.
fn modes_ui(ui: &mut Ui, modes: &[ModeSpan], palette: &Palette) -> Vec<ChartSpan> {
    let named = modes
        .iter()
        .map(|of| format!("{} {:.1} to {:.1} s", of.name, of.ends_s[0], of.ends_s[1]));
    let words = named.collect::<Vec<_>>().join(" · ");
    if !words.is_empty() {
        ui.add(Label::new(palette.small(&words)).truncate())
            .on_hover_text(words);
    }
    let shade = |at: usize| {
        palette
            .dim_text
            .gamma_multiply(if at.is_multiple_of(2) { 0.06 } else { 0.14 })
    };
    modes
        .iter()
        .enumerate()
        .map(|(at, of)| ChartSpan {
            ends: of.ends_s,
            color: shade(at),
        })
        .collect()
}

/// Returns spans of the displayed record: parts that are separate records, bridged gaps, and cut
/// stretches.
fn spans(records: &ConditionRecords, palette: &Palette) -> Vec<ChartSpan> {
    let source = records
        .rows
        .get(records.chosen)
        .map(|row| &row.table.source);
    let of_it = records
        .rows
        .iter()
        .enumerate()
        .filter(|(at, row)| *at != records.chosen && Some(&row.table.source) == source);
    let parts = of_it.filter_map(|(_, row)| row.table.part_s);
    let parts: Vec<ChartSpan> = parts
        .map(|ends| ChartSpan {
            ends,
            color: palette.identified.gamma_multiply(0.15),
        })
        .collect();
    let Some(found) = records.identification().filter(|_| !records.changed) else {
        return parts;
    };
    let record = (0..found.record_uses.len())
        .find(|record| records.row_of_record(*record) == Some(records.chosen));
    let gaps = record.map_or(&[][..], |record| &found.record_uses[record].gaps);
    let span = |gap: &gdcm_sysid::spectra::gaps::Gap| {
        let color = match gap.treatment {
            Treatment::Bridged => palette.accent.gamma_multiply(0.25),
            Treatment::CutOut => palette.warning.gamma_multiply(0.35),
        };
        ChartSpan {
            ends: [gap.start_s, gap.end_s],
            color,
        }
    };
    parts.into_iter().chain(gaps.iter().map(span)).collect()
}

/// Minimum height of a spectrum chart \[pt\].
const LEAST_SPECTRUM: f32 = 140.0;
/// Number of spectral lines averaged into one point.
const SMOOTHED: usize = 5;

/// Autospectrum of each input: frequency \[rad/s\] and level \[dB of the squared unit per Hz\].
type Autospectra = Vec<Arc<[[f64; 2]]>>;

/// Shows a chart for each input with its spectrum in every record, the selected record on top.
pub(super) fn inputs_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let dataset = state.dataset();
    let unit = state.display.curves.unit;
    let band = records.band.map_or(state.study.settings.band, |band| {
        Band::new(band[0], band[1]).unwrap_or(state.study.settings.band)
    });
    let of_rows: Vec<(bool, Arc<Autospectra>)> = records
        .rows
        .iter()
        .enumerate()
        .filter_map(|(index, row)| {
            let flight = row.flight.as_ref()?;
            let name = format!("autospectrum {index}");
            let source = Arc::clone(flight);
            let spectra = kept(ui, &name, &[source], band.max().to_bits(), || {
                autospectra(flight, band.max())
            });
            Some((index == records.chosen, spectra))
        })
        .collect();
    ScrollArea::vertical()
        .id_salt("inputs")
        .auto_shrink(false)
        .show(ui, |ui| {
            let count = dataset.inputs().len();
            let columns = if count > 1 { 2 } else { 1 };
            let rows = count.div_ceil(columns);
            let height = ((ui.available_height() - 6.0) / rows.max(1) as f32).max(LEAST_SPECTRUM);
            let width = ui.available_width() / columns as f32;
            let area = ui
                .allocate_exact_size(
                    vec2(width * columns as f32, height * rows as f32),
                    Sense::hover(),
                )
                .0;
            for (input, channel) in dataset.inputs().iter().enumerate() {
                let corner = area.min
                    + vec2(
                        (input % columns) as f32 * width,
                        (input / columns) as f32 * height,
                    );
                let title = format!("{}: autospectrum of each record", channel.name);
                let label = format!("dB of ({})²/Hz", channel.unit);
                let across = unit.axis_label();
                let mut chart = Chart::new(&title, ChartAxis::Frequency(unit), &across, &label);
                let color = palette.accent.gamma_multiply(0.12);
                chart.spans.push(ChartSpan {
                    ends: [band.min(), band.max()],
                    color,
                });
                for is_chosen in [false, true] {
                    let lines = of_rows.iter().filter(|(chosen, _)| *chosen == is_chosen);
                    chart
                        .lines
                        .extend(lines.filter_map(|(_, spectra)| spectra.get(input)).map(
                            |points| ChartLine {
                                points: Arc::clone(points),
                                color: if is_chosen {
                                    palette.identified
                                } else {
                                    palette.perturbed.gamma_multiply(0.6)
                                },
                                width: if is_chosen { 1.8 } else { 1.0 },
                                dashed: false,
                            },
                        ));
                }
                chart_ui(
                    ui,
                    Rect::from_min_size(corner, vec2(width, height)),
                    &chart,
                    palette,
                );
            }
        });
}

/// Computes the power of each input by frequency, `2 dt² / T
/// sum u e^(-j omega t)
/// ²` about its mean, averaged over a few lines: one-sided, so that its integral over frequency
/// \[Hz\] is the variance (Bendat and Piersol, Random Data, 5.2.2).
fn autospectra(flight: &FlightRecord, highest: f64) -> Autospectra {
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let steps: Vec<f64> = flight
        .time_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    let Some(step) = steps.get(steps.len() / 2).copied() else {
        return Vec::new();
    };
    let mut inputs = flight.inputs.map(finite);
    for mut column in inputs.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    let segment = Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s: step,
        inputs,
        outputs: flight.outputs.map(finite),
    };
    let Some(spectrum) = spectra(&[segment], 2.0 * highest, &Sequential)
        .into_iter()
        .next()
    else {
        return Vec::new();
    };
    (0..flight.inputs.ncols())
        .map(|input| {
            let lines: Vec<[f64; 2]> = spectrum
                .omega
                .iter()
                .enumerate()
                .map(|(k, omega)| [*omega, 2.0 * spectrum.inputs[(input, k)].norm_sqr()])
                .collect();
            let smooth = |part: &[[f64; 2]]| {
                let count = part.len() as f64;
                let (omega, power) = part
                    .iter()
                    .fold((0.0, 0.0), |sum, at| (sum.0 + at[0].ln(), sum.1 + at[1]));
                [
                    (omega / count).exp(),
                    10.0 * (power / count).max(f64::MIN_POSITIVE).log10(),
                ]
            };
            lines.chunks(SMOOTHED).map(smooth).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_an_autospectrum_is_the_variance() {
        // 500 lines below half the sampling frequency, averaged in groups of five without
        // remainder.
        let samples = 1001;
        let input: Vec<f64> = (0..samples)
            .map(|n| (0.7 * (n * n) as f64).sin() + 3.0)
            .collect();
        let column = |values: &[f64]| nalgebra::DMatrix::from_column_slice(values.len(), 1, values);
        let time_s: Vec<f64> = (0..samples).map(|n| 0.02 * n as f64).collect();
        let inputs = column(&input);
        let outputs = column(&input);
        let flight = FlightRecord {
            name: "record".to_owned(),
            time_s,
            inputs,
            outputs,
        };
        let autospectrum = autospectra(&flight, 1e6)[0].clone();
        let step_hz = SMOOTHED as f64 / (0.02 * samples as f64);
        let mean = input.iter().sum::<f64>() / samples as f64;
        let integral: f64 = autospectrum
            .iter()
            .map(|[_, db]| 10f64.powf(0.1 * db) * step_hz)
            .sum();
        let variance = input.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / samples as f64;
        // Parseval's theorem, up to the rounding of a thousand terms.
        assert!(
            (integral / variance - 1.0).abs() < 1e-9,
            "{integral} {variance}"
        );
    }
}
