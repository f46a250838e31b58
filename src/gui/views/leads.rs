//! Effect that delays or leads have in each channel, and the gain that leads add above the band. A
//! lead filter acts as if a servo were replaced by a faster one (M15: docs/lead.md). A channel's
//! signed delay `tau_s` is a delay if it is positive and a lead if it is negative; the *price* of
//! the leads is the gain that they add above the band.

use egui::{Panel, Ui, vec2};

use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::{number, s_to_ms, signed, telling};
use gdcm_plot::figure::{Figure, FigureKind, FigureRequest, all_channels};
use gdcm_study::PhaseCorrection;
use gdcm_words::Table;
use gdcm_words::lead_price::limit_text;

use super::frequency_curves::condition_source;
use crate::gui::commands::command::Command;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{TableLook, table_block_ui};

/// Initial table width, as a share of the view width.
const TABLE_PART: f32 = 0.5;

/// Draws the gain and phase added by leads in the response in focus, up to ten times the band's
/// upper end, and the channel table.
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
            let pair = Channel::of_pair(state.display.selection.pair);
            let channels = all_channels(state.dataset());
            let look = TableLook {
                selected: &|row| match channels.get(row) {
                    Some(channel) => pair.contains(channel),
                    None => false,
                },
                ..TableLook::PLAIN
            };
            ui.label(palette.small_warning(&table.title));
            table_block_ui(ui, &table, &look, palette, commands);
        });
    }
    let figure = figure(state);
    let message = match state.study.settings.phase {
        PhaseCorrection::Lead if matches!(state.outcome(), Some(Err(_))) => {
            "This condition has no result, so no leads"
        }
        PhaseCorrection::Lead => state.results.absence(),
        _ => {
            "No leads: the phase is corrected by delays, or not at all. To use leads, choose \
            Settings, phase, \"delay or lead\""
        }
    };
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Leads)
        .unwrap_or_default();
    let scene = FigureScene::new("leads", &figure, vec2(180.0, 110.0), message, &figure);
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Leads, view);
}

/// Builds the figure for the response in focus; empty if there are no leads.
fn figure(state: &State) -> Figure {
    let mut source = None;
    if let Some(shown) = state.shown()
        && shown.correction.leads.is_some()
    {
        source = condition_source(state);
    }
    let pairs = vec![state.display.selection.pair];
    FigureRequest::new(FigureKind::Leads, pairs, Vec::new())
        .figure(None, source.as_ref())
        .unwrap_or_default()
}

/// Builds the channel table: delay or lead, phase at the upper band edge, replaced servo, and the
/// gain added above the band. The title gives the highest frequency at which the corrected model is
/// valid, or says that no channel has a lead filter. `None` unless the phase is corrected by leads.
pub fn leads_table(state: &State) -> Option<Table> {
    let leads = state.shown()?.correction.leads.as_ref()?;
    let price = LeadPrice::new(leads);
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let band_top = leads.design.band_top_rad_s();
    let title = match &price {
        Some(price) => limit_text(price),
        None => "No channel has a lead filter".to_owned(),
    };
    let above = match &price {
        Some(price) => price.above_rad_s(),
        None => band_top,
    };
    let columns = [
        "channel".to_owned(),
        "lead [ms]".to_owned(),
        format!("phase at {} rad/s [deg]", number(band_top)),
        "replaced servo [rad/s]".to_owned(),
        format!("gain at {} rad/s [dB]", number(above)),
    ];
    let mut table = Table::new(title, columns);
    for channel in all_channels(state.dataset()) {
        let tau_s = leads.taus_s[channel];
        let filter = leads.filters()[channel];
        // Without a filter, the phase is that of a pure delay; a negative tau_s means a lead, which
        // needs a filter.
        let phase = match filter {
            Some(filter) => filter.phase(band_top),
            None => -band_top * tau_s.max(0.0),
        };
        let servo = match filter {
            Some(filter) => format!(
                "{} → {}",
                telling(filter.zero_rad_s(), 0),
                telling(filter.lag_rad_s(), 0)
            ),
            None => NO_VALUE.to_owned(),
        };
        let gain_db = match &price {
            Some(price) => price.gains_db[channel],
            None => 0.0,
        };
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
