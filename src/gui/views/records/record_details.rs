//! Three lines about the displayed record: manoeuvre and what it excites; length and quality; fit
//! of the other records. Above them its name and its problems.
//!
//! χ²/dof is the cost of the fit for each degree of freedom, 1 if the model leaves only noise
//! (M14.4: docs/identification.md).

use std::sync::Arc;

use egui::{Label, RichText, Ui};

use gdcm_model::dataset::condition::RecordKind;
use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::records::layout_problem::LayoutCaution;

use super::autospectra::{Autospectra, autospectra};
use super::excited_channel::displayed_excited_input;
use super::frame_cache::cached;
use super::page::Page;
use super::record_problems::problem_texts;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::choices::DropDown;
use crate::gui::widgets::palette::{BODY_SIZE, medium};

/// Distance below an autospectrum's maximum within which a frequency counts as excited \[dB\].
const EXCITED_DB: f64 = 20.0;

/// Shows the displayed record's name, its problems, and three lines about it.
pub(super) fn record_details_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.add_space(6.0);
    ui.separator();
    let name = RichText::new(&row.table.name).font(medium(BODY_SIZE));
    ui.add(Label::new(name).wrap());
    for problem in problem_texts(&row.problems) {
        ui.add(Label::new(palette.small_warning(problem)).wrap());
    }
    kind_ui(ui, page, row, commands);
    if let Some(flight) = &row.flight {
        let mut parts: Vec<String> = length_words(flight).into_iter().collect();
        parts.push(quality_words(page, row));
        ui.add(Label::new(palette.small(parts.join(", "))).wrap());
    }
    if let Some(cost) = cost_of_others(page, row) {
        let words = format!("χ²/dof of the other fitted records: {cost:.2}");
        ui.add(Label::new(palette.small(words)).wrap());
    }
}

/// Shows the manoeuvre, which can be changed, and what it excites: "[sweep] of LON, 0.30 to 13.0
/// rad/s".
fn kind_ui(ui: &mut Ui, page: Page<'_>, row: &LaidOutRecord, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let chosen = row.guess.kind;
        let kinds = RecordKind::ALL.map(|kind| (kind, kind == chosen, kind.word().to_owned()));
        let list = DropDown {
            name: "Manoeuvre of the record",
            width: 76.0,
            text: chosen.word(),
        };
        if let Some(kind) = list.ui(ui, kinds) {
            commands.push(RecordsCommand::SetKind(records.chosen, kind).into());
        }
        if let Some(flight) = &row.flight {
            ui.add(Label::new(palette.small(excitation_words(ui, page, flight))).wrap());
        }
    });
}

/// Formats "of LON, 0.30 to 13.0 rad/s"; empty if no input moves.
fn excitation_words(ui: &Ui, page: Page<'_>, flight: &Arc<FlightRecord>) -> String {
    let mut parts = Vec::new();
    if let Some(input) = displayed_excited_input(ui, page) {
        parts.push(format!("of {}", page.state.dataset().inputs()[input].name));
        let highest = page.state.study.settings.band.max();
        let spectra: Arc<Autospectra> = cached(
            ui,
            "autospectrum of the displayed record",
            &[Arc::clone(flight) as _],
            highest.to_bits(),
            || autospectra(flight, highest),
        );
        if let Some([from, to]) = spectra.get(input).and_then(|points| excited_band(points)) {
            parts.push(format!("{from:.2} to {to:.1} rad/s"));
        }
    }
    parts.join(", ")
}

/// Formats "60 s at 50 Hz"; `None` without increasing time stamps.
fn length_words(flight: &FlightRecord) -> Option<String> {
    let first_s = flight.time_s.first()?;
    let last_s = flight.time_s.last()?;
    let length_s = last_s - first_s;
    if length_s <= 0.0 {
        return None;
    }
    let rate_hz = (flight.time_s.len() - 1) as f64 / length_s;
    Some(format!("{length_s:.0} s at {rate_hz:.0} Hz"))
}

/// Returns the lowest and the highest frequency \[rad/s\] with a level within [`EXCITED_DB`] of the
/// maximum; `None` without points.
fn excited_band(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let most = points
        .iter()
        .map(|[_, level]| *level)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut excited = points
        .iter()
        .filter(|[_, level]| *level >= most - EXCITED_DB)
        .map(|[omega, _]| *omega);
    let first = excited.next()?;
    let last = excited.next_back().unwrap_or(first);
    Some([first, last])
}

/// Describes the data quality: gaps and clipping that the identification found, and cautions about
/// the columns.
fn quality_words(page: Page<'_>, row: &LaidOutRecord) -> String {
    let mut parts = Vec::new();
    if let Some(identification) = page.current_identification()
        && let Some(record_use) = identification
            .record_uses
            .iter()
            .find(|record_use| record_use.record == row.table.name)
    {
        parts.push(match record_use.gaps.len() {
            0 => "no gap".to_owned(),
            1 => "1 gap".to_owned(),
            count => format!("{count} gaps"),
        });
        if record_use.inputs_at_limit.is_empty() {
            parts.push("no clipping of inputs".to_owned());
        }
        for (signal, percent) in &record_use.inputs_at_limit {
            parts.push(format!(
                "{} at its limit for {percent:.0} % of the record",
                signal.name
            ));
        }
    }
    let mut assumed = Vec::new();
    for caution in &row.cautions {
        match caution {
            LayoutCaution::UnitAssumed { channel, unit, .. } => {
                assumed.push(format!("{channel} ({unit})"));
            }
            other => parts.push(other.to_string()),
        }
    }
    if !assumed.is_empty() {
        let channels = assumed.join(", ");
        parts.push(format!(
            "units of {channels} assumed: confirm them in Columns"
        ));
    }
    if parts.is_empty() {
        return "gaps and clipping not checked: no up-to-date identification uses this record"
            .to_owned();
    }
    parts.join(", ")
}

/// Returns χ²/dof over the other fitted records, for the model fitted to all records; `None` for a
/// held-out record, without a current identification, or without other fitted records.
fn cost_of_others(page: Page<'_>, row: &LaidOutRecord) -> Option<f64> {
    let identification = page.current_identification()?;
    let own = page.records.record_of_name(&row.table.name)?;
    let is_fitted = identification
        .record_fits
        .iter()
        .any(|fit| fit.record == own && !fit.held_out);
    if !is_fitted {
        return None;
    }
    let mut cost = 0.0;
    let mut freedom = 0.0;
    for fit in &identification.record_fits {
        if fit.record != own && !fit.held_out {
            cost += fit.cost * fit.freedom as f64;
            freedom += fit.freedom as f64;
        }
    }
    if freedom == 0.0 {
        return None;
    }
    Some(cost / freedom)
}

#[cfg(test)]
mod tests {
    use super::excited_band;

    #[test]
    fn the_excited_band_ends_where_the_level_has_fallen_by_20_db() {
        let points = [
            [0.1, -30.0],
            [0.3, -5.0],
            [1.0, 0.0],
            [10.0, -19.0],
            [20.0, -21.0],
        ];
        assert_eq!(excited_band(&points), Some([0.3, 10.0]));
        assert_eq!(excited_band(&[]), None);
    }
}
