//! Identification settings: band, references, model orders, past windows, Laguerre poles. The last
//! two are settings of CT-PBSID: the past window p and the pole a of its Laguerre projections
//! (M14.3: docs/identification.md).

use egui::{Grid, Ui};

use gdcm_model::units::{number, six_digits};
use gdcm_sysid::identification::SearchSpace;
use gdcm_sysid::identification_error::{HIGHEST_ORDER, LONGEST_PAST};

use super::fold_summary::FoldSummary;
use super::page::Page;
use super::references::{REFERENCES, references_ui};
use super::typed_lists::{list_text, numbers, typed_band, whole_numbers};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::{entry_field_id, entry_ui};
use crate::message::Message;

const FIELD_WIDTH: f32 = 150.0;
/// Name by which cautions refer to the model orders.
pub(super) const ORDERS: &str = "orders";

/// List setting; the identification tries every entry.
#[derive(Clone, Copy)]
enum SearchList {
    Orders,
    PastWindows,
    LaguerrePoles,
}

impl SearchList {
    const ALL: [Self; 3] = [Self::Orders, Self::PastWindows, Self::LaguerrePoles];

    fn name(self) -> &'static str {
        match self {
            Self::Orders => ORDERS,
            Self::PastWindows => "past windows",
            Self::LaguerrePoles => "Laguerre poles",
        }
    }

    /// Describes the values that are searched if the field is empty (M14.9 and M14.13:
    /// docs/identification.md). [`HIGHEST_ORDER`] and [`LONGEST_PAST`] limit only typed values.
    fn default_values(self) -> &'static str {
        match self {
            Self::Orders => "automatic, within 1 to 24",
            Self::PastWindows => "automatic, at most 24",
            Self::LaguerrePoles => "0.375, 0.54, 0.75 of the upper band limit",
        }
    }

    fn text(self, search: &SearchSpace) -> String {
        match self {
            Self::Orders => list_text(&search.orders),
            Self::PastWindows => list_text(&search.pasts),
            Self::LaguerrePoles => list_text(&search.poles),
        }
    }

    fn set(self, search: &mut SearchSpace, list: Vec<f64>) -> Result<(), Message> {
        match self {
            Self::Orders => search.orders = whole_numbers(&list, HIGHEST_ORDER)?,
            Self::PastWindows => search.pasts = whole_numbers(&list, LONGEST_PAST)?,
            Self::LaguerrePoles => {
                if let Some(pole) = list.iter().find(|pole| **pole <= 0.0) {
                    let text =
                        format!("expected positive values in rad/s, found {}", number(*pole));
                    return Err(Message::new("pole-not-positive", text));
                }
                search.poles = list;
            }
        }
        Ok(())
    }
}

/// Names the kinds of settings that differ from the defaults: "own band, own search"; "automatic"
/// without any.
pub(super) fn settings_summary(page: Page<'_>) -> FoldSummary {
    let records = page.records;
    let mut parts = Vec::new();
    if records.band.is_some() {
        parts.push("own band".to_owned());
    }
    if !records.references.is_empty() {
        parts.push("references".to_owned());
    }
    if records.search != SearchSpace::default() {
        parts.push("own search".to_owned());
    }
    let text = if parts.is_empty() {
        "automatic".to_owned()
    } else {
        parts.join(", ")
    };
    FoldSummary {
        text,
        is_doubtful: false,
    }
}

/// Draws the settings; with an empty field, the identification chooses the values. If a caution's
/// button has requested a field, scrolls to the end of the settings and focuses the field, once.
pub(super) fn search_settings_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let palette = page.palette;
    let focused = page.state.records.advanced_field;
    ui.add_space(2.0);
    Grid::new("advanced identification")
        .num_columns(2)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            band_ui(ui, page, commands);
            let is_focused = focused == Some(REFERENCES);
            references_ui(ui, page, FIELD_WIDTH, is_focused, commands);
            for list in SearchList::ALL {
                search_list_ui(ui, &page.records.search, list, palette, commands);
            }
        });
    if let Some(name) = focused {
        ui.scroll_to_cursor(None);
        if name != REFERENCES {
            let field = entry_field_id(&field_name(name));
            ui.memory_mut(|memory| memory.request_focus(field));
        }
        commands.push(RecordsCommand::AdvancedFocused.into());
    }
}

fn band_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let study_band = page.state.study.settings.band;
    let hint = format!(
        "{} {} (the study's)",
        six_digits(study_band.min()),
        six_digits(study_band.max())
    );
    let value = match page.records.band {
        Some([low, high]) => format!("{} {}", number(low), number(high)),
        None => String::new(),
    };
    if let Some(text) = field_ui(ui, "band [rad/s]", &value, &hint, page.palette) {
        commands.push(match numbers(&text).and_then(|list| typed_band(&list)) {
            Ok(band) => RecordsCommand::SetBand(band).into(),
            Err(why) => {
                let text = format!("band: {}", why.text);
                Command::Form(FormCommand::Refuse(Message::new(why.code, text)))
            }
        });
    }
}

fn search_list_ui(
    ui: &mut Ui,
    search: &SearchSpace,
    list: SearchList,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let name = list.name();
    let value = list.text(search);
    if let Some(text) = field_ui(ui, name, &value, list.default_values(), palette) {
        let mut wanted = search.clone();
        let result = numbers(&text).and_then(|values| list.set(&mut wanted, values));
        commands.push(match result {
            Ok(()) => RecordsCommand::SetSearch(wanted).into(),
            Err(why) => {
                let text = format!("{name}: {}", why.text);
                Command::Form(FormCommand::Refuse(Message::new(why.code, text)))
            }
        });
    }
}

fn field_ui(ui: &mut Ui, name: &str, value: &str, hint: &str, palette: &Palette) -> Option<String> {
    ui.label(palette.small(name));
    let text = entry_ui(ui, &field_name(name), value, hint, FIELD_WIDTH);
    ui.end_row();
    text
}

fn field_name(name: &str) -> String {
    format!("Identification: {name}")
}
