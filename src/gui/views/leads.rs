//! Effect of delay or lead in each channel of the condition, and the cost of leads above the band.

use egui::{Panel, Ui, vec2};

use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_model::units::{number, s_to_ms, signed, telling};
use gdcm_plot::figure::{Figure, FigureKind, FigureRequest, all_channels};
use gdcm_study::PhaseCorrection;
use gdcm_words::Table;

use super::frequency::condition_source;
use crate::gui::commands::command::Command;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::restore_panel_size;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{Sorting, TableLook, table_ui};

/// Share of the width taken by the table.
const TABLE_PART: f32 = 0.5;

/// Draws gain and phase of the leads up to ten times the band, and the table of the channels.
pub fn leads_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if let Some(table) = leads_table(state) {
        let width = ui.available_width();
        restore_panel_size(ui, "leads");
        let panel = Panel::right("leads")
            .resizable(true)
            .default_size(TABLE_PART * width)
            .min_size(160.0);
        panel.show(ui, |ui| {
            let pair = Channel::of(state.display.selection.pair);
            let channels = all_channels(state.dataset());
            let selected = |row: usize| {
                channels
                    .get(row)
                    .is_some_and(|channel| pair.contains(channel))
            };
            let look = TableLook {
                selected: &selected,
                ..TableLook::PLAIN
            };
            ui.label(palette.small_warning(&table.title));
            ui.spacing_mut().interact_size.y = 16.0;
            table_ui(
                ui,
                &table,
                &mut Sorting::default(),
                &look,
                palette,
                commands,
            );
        });
    }
    let figure = figure(state);
    let message = match state.study.settings.phase {
        PhaseCorrection::Lead => state.results.absence(),
        _ => {
            "No leads: the phase is corrected by delays, or not at all. Settings, phase, \"delay or lead\""
        }
    };
    let mut view = state
        .display
        .figures
        .remove(&View::Leads)
        .unwrap_or_default();
    let scene = FigureScene::new("leads", &figure, vec2(180.0, 110.0), message, &figure);
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Leads, view);
}

/// Builds the figure of the response in focus; without plots if there are no leads.
fn figure(state: &State) -> Figure {
    let has_leads = state
        .shown()
        .is_some_and(|shown| shown.correction.leads.is_some());
    let source = condition_source(state).filter(|_| has_leads);
    let pairs = vec![state.display.selection.pair];
    FigureRequest::new(FigureKind::Leads, pairs, Vec::new())
        .figure(None, source.as_ref())
        .unwrap_or_default()
}

/// Builds the table of the channels: delay or lead, the lag removed by its lead at the end of the
/// band, the replaced servo, and the price; the title gives the end of the corrected model's
/// validity. `None` without leads.
pub fn leads_table(state: &State) -> Option<Table> {
    let leads = state.shown()?.correction.leads.as_ref()?;
    let price = LeadPrice::of(leads);
    let (inputs, outputs) = state.dataset().names_of_channels();
    let top = leads.design.band_top_rad_s();
    let title = price.as_ref().map_or_else(
        || "No channel has a lead filter".to_owned(),
        LeadPrice::limit_words,
    );
    let above = price.as_ref().map_or(top, LeadPrice::above_rad_s);
    let columns = [
        "channel".to_owned(),
        "lead [ms]".to_owned(),
        format!("phase at {} [deg]", number(top)),
        "as if servo [rad/s]".to_owned(),
        format!("gain at {} [dB]", number(above)),
    ];
    let mut table = Table::new(title, columns);
    for channel in all_channels(state.dataset()) {
        let tau_s = leads.taus_s[channel];
        let filter = leads.filters()[channel];
        let phase = filter.map_or(-top * tau_s.max(0.0), |filter| filter.phase(top));
        let servo = filter.map_or_else(
            || "–".to_owned(),
            |filter| {
                format!(
                    "{} → {}",
                    telling(filter.zero_rad_s(), 0),
                    telling(filter.lag_rad_s(), 0)
                )
            },
        );
        let gain_db = price.as_ref().map_or(0.0, |price| price.gains_db[channel]);
        table.row([
            channel.name(&inputs, &outputs),
            signed(-s_to_ms(tau_s), 0),
            signed(phase.to_degrees(), 0),
            servo,
            signed(gain_db, 1),
        ]);
    }
    Some(table)
}
