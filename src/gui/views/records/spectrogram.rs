//! Spectrogram of an input, above the channel charts.

use std::sync::Arc;

use egui::{ColorImage, Sense, TextureHandle, TextureOptions, Ui, vec2};

use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::records::spectrogram::Spectrogram;

use super::frame_cache::{Source, cached};
use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartImage};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::Palette;

/// Chart height \[pt\].
const SPECTROGRAM_HEIGHT: f32 = 150.0;

/// A spectrogram with its picture on the graphics card.
struct PaintedSpectrogram {
    texture: TextureHandle,
    spectrogram: Spectrogram,
}

/// Draws the selector of the input whose spectrogram is shown; no input is an option.
pub(super) fn spectrogram_choice_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let state = page.state;
    ui.label(page.palette.small("spectrogram of"));
    let hint = "Power over time and frequency: a sweep is a rising ridge";
    let mut choices = vec![(None, "none", "Channels over time only")];
    for (index, channel) in state.dataset().inputs().iter().enumerate() {
        choices.push((Some(index), channel.name.as_str(), hint));
    }
    let mut wanted = state.records.spectrogram;
    choice_ui(ui, "Input of the spectrogram", &mut wanted, &choices);
    if wanted != state.records.spectrogram {
        commands.push(RecordsCommand::ShowSpectrogram(wanted).into());
    }
}

/// Shows the spectrogram of the selected input up to twice the upper band limit, on the time axis
/// of the charts.
pub(super) fn spectrogram_ui(ui: &mut Ui, page: Page<'_>, flight: &Arc<FlightRecord>) {
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
        ui.label(palette.small("The record is too short or sampled too slowly for a spectrogram"));
        return;
    };
    let title = format!(
        "{}: power over time [dB relative to the maximum]",
        channel.name
    );
    let unit = state.display.curves.unit;
    let label = unit.axis_label();
    let mut chart = Chart::new(&title, ChartAxis::Linear, "", &label);
    chart.group = Some(Page::time_axis());
    chart.fits_values = true;
    chart.chooses = state.records.chooses_parts;
    chart.image = Some(ChartImage {
        texture: painted.texture.id(),
        across: painted.spectrogram.time_s,
        omega: painted.spectrogram.omega,
        unit,
    });
    let size = vec2(ui.available_width(), SPECTROGRAM_HEIGHT);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    chart_ui(ui, area, &chart, palette);
}

/// Computes the spectrogram of an input up to `highest` \[rad/s\] and uploads its picture; `None`
/// if the record is too short or its sample rate too low.
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
            let share = (1.0 - window[row] / Spectrogram::FLOOR) as f32;
            pixels.push(palette.background.lerp_to_gamma(palette.identified, share));
        }
    }
    ColorImage::new([levels.len(), Spectrogram::ROWS], pixels)
}
