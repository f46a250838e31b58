//! Spectrogram of an input (power over time and frequency) on the charts' time axis. It is computed
//! and uploaded to the graphics card once, and cached while record, input, frequencies and theme
//! stay.

use std::sync::Arc;

use egui::{Align2, ColorImage, Rect, TextureHandle, TextureOptions, Ui, vec2};

use gdcm_model::simulation::FlightRecord;
use gdcm_plot::figure::Range;
use gdcm_sysid::records::spectrogram::Spectrogram;

use super::frame_cache::{Source, cached};
use super::page::Page;
use super::record_span::RecordSpan;
use super::time_charts::{READOUT_WIDTH, VALUE_AXIS, time_axis};
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartImage, ChartLayout};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};

/// Spectrogram with its picture on the graphics card.
struct PaintedSpectrogram {
    texture: TextureHandle,
    spectrogram: Spectrogram,
}

/// Draws the selector for the input whose spectrogram is shown, or "off".
pub(super) fn spectrogram_choice_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let state = page.state;
    let wanted = state.records.spectrogram;
    let mut shown = "off";
    let mut choices = vec![(None, wanted.is_none(), "off".to_owned())];
    for (index, channel) in state.dataset().inputs().iter().enumerate() {
        let is_shown = wanted == Some(index);
        if is_shown {
            shown = &channel.name;
        }
        choices.push((Some(index), is_shown, channel.name.clone()));
    }
    let list = DropDown {
        name: "Input of the spectrogram",
        width: 118.0,
        text: &format!("spectrogram {shown}"),
    };
    if let Some(chosen) = list.ui(ui, choices) {
        commands.push(RecordsCommand::ShowSpectrogram(chosen).into());
    }
}

/// Shows the selected input's spectrogram up to twice the upper band limit, on the charts' time
/// axis, or why there is none.
pub(super) fn spectrogram_ui(
    ui: &mut Ui,
    page: Page<'_>,
    record: &RecordSpan,
    place: Rect,
    has_ticks_across: bool,
) {
    let flight = &record.flight;
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(index) = state.records.spectrogram else {
        return;
    };
    let Some(channel) = state.dataset().inputs().get(index) else {
        return;
    };
    let band_end = match records.band {
        Some([_, high]) => high,
        None => state.study.settings.band.max(),
    };
    let highest = 2.0 * band_end;
    let key = (index, highest.to_bits(), ui.visuals().dark_mode);
    let source: Source = Arc::clone(flight) as _;
    let painted = cached(ui, "spectrogram", &[source], key, || {
        paint(ui, flight, index, highest, palette)
    });
    let Some(painted) = &*painted else {
        let text = "The record is too short or sampled too slowly for a spectrogram";
        let center = place.center();
        ui.painter().text(
            center,
            Align2::CENTER_CENTER,
            text,
            small(),
            palette.dim_text,
        );
        return;
    };
    let title = format!("{}: power over time", channel.name);
    let unit = state.display.curves.unit;
    let mut chart = Chart::new(&title, ChartAxis::Linear, "", "");
    chart.group = Some(time_axis(record));
    chart.fits_values = true;
    let [from, to] = record.span_s;
    chart.whole_across = Some(Range::new(from, to));
    chart.layout = ChartLayout {
        title_height: 0.0,
        value_axis_width: VALUE_AXIS,
        right_margin: READOUT_WIDTH,
        has_ticks_across,
    };
    chart.image = Some(ChartImage {
        texture: painted.texture.id(),
        across: painted.spectrogram.time_s,
        omega: painted.spectrogram.omega,
        unit,
    });
    let frame = *chart_ui(ui, place, &chart, palette).transform.frame();
    let margin = place.with_min_x(frame.right() + 10.0);
    let lines = [
        (channel.name.clone(), medium(BODY_SIZE), palette.text),
        (unit.axis_label(), small(), palette.dim_text),
        (
            "stronger colour: more power".to_owned(),
            small(),
            palette.dim_text,
        ),
    ];
    for (row, (text, font, color)) in lines.into_iter().enumerate() {
        let at = margin.min + vec2(0.0, 15.0 * row as f32);
        ui.painter().text(at, Align2::LEFT_TOP, text, font, color);
    }
}

/// Computes an input's spectrogram up to `highest` \[rad/s\] and uploads its picture; `None` if the
/// record is too short or its sample rate too low.
fn paint(
    ui: &Ui,
    flight: &FlightRecord,
    input: usize,
    highest: f64,
    palette: &Palette,
) -> Option<PaintedSpectrogram> {
    let samples: Vec<f64> = flight.inputs.column(input).iter().copied().collect();
    let spectrogram = Spectrogram::new(&flight.time_s, &samples, highest)?;
    let texture = ui.ctx().load_texture(
        "spectrogram",
        picture(&spectrogram, palette),
        TextureOptions::LINEAR,
    );
    Some(PaintedSpectrogram {
        texture,
        spectrogram,
    })
}

/// Returns an image with a pixel for each window (across) and frequency (up), shaded from the
/// background colour at the lowest level to the identified models' colour at 0 dB.
fn picture(spectrogram: &Spectrogram, palette: &Palette) -> ColorImage {
    let levels = &spectrogram.levels;
    let mut pixels = Vec::with_capacity(levels.len() * Spectrogram::ROWS);
    for row in (0..Spectrogram::ROWS).rev() {
        for window in levels {
            // Levels are in dB relative to the highest power, from `FLOOR` to 0.
            let share = (1.0 - window[row] / Spectrogram::FLOOR) as f32;
            pixels.push(palette.background.lerp_to_gamma(palette.identified, share));
        }
    }
    ColorImage::new([levels.len(), Spectrogram::ROWS], pixels)
}
