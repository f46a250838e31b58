//! Tables of the window: as text to be copied and saved, and as drawn, sorted by a click on a
//! heading.

use std::sync::Arc;

use egui::{Align, Button, Color32, Grid, Label, Layout, RichText, Role, ScrollArea, Sense, Ui};

use gdcm_method::correction::Channel;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, Model, Pair};
use gdcm_model::number_format::full_precision;
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::all_channels;
use gdcm_study::ConditionAnalysis;
use gdcm_words::Table;

use super::controls::{entries_ui, named};
use super::palette::{Palette, SMALL_SIZE};
use crate::gui::commands::command::Command;
use crate::gui::state::window_state::{State, Sureness};

/// Table of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Every condition with its flight state and its open tasks.
    Conditions,
    /// Physics models of the displayed condition.
    PhysicsModels,
    /// Identified models of the displayed condition.
    IdentifiedModels,
    /// G, D and J of every response.
    Matrix,
    /// Gain and delay of every channel.
    Channels,
}

impl TableKind {
    /// Every table, in the order of the window.
    pub const ALL: [TableKind; 5] = [
        Self::Conditions,
        Self::PhysicsModels,
        Self::IdentifiedModels,
        Self::Matrix,
        Self::Channels,
    ];

    /// Returns the title of the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Conditions => "conditions",
            Self::PhysicsModels => "physics models",
            Self::IdentifiedModels => "identified models",
            Self::Matrix => "responses (G, D, J)",
            Self::Channels => "channel gains and delays",
        }
    }

    /// Returns the table of a bundle's models.
    pub fn of_bundle(bundle: BundleKind) -> Self {
        match bundle {
            BundleKind::Physics => Self::PhysicsModels,
            BundleKind::Identified => Self::IdentifiedModels,
        }
    }
}

/// Builds the current table. Numbers have full precision; unknown numbers are empty.
pub fn table_of(state: &State, kind: TableKind) -> Table {
    match kind {
        TableKind::Conditions => conditions(state),
        TableKind::PhysicsModels => models(state, BundleKind::Physics),
        TableKind::IdentifiedModels => models(state, BundleKind::Identified),
        TableKind::Matrix => matrix(state),
        TableKind::Channels => channels(state),
    }
}

fn yes(is_so: bool) -> String {
    if is_so { "yes" } else { "no" }.to_owned()
}

fn title(state: &State, what: &str) -> String {
    let condition = state.condition();
    format!(
        "{}, condition {} ({}): {what}",
        state.dataset().name(),
        condition.id(),
        condition.flight_state().name
    )
}

/// Row of a table: headings with their cells.
type Row = Vec<(&'static str, String)>;

/// Builds a table from rows with the same headings.
fn table_of_rows(title: String, rows: Vec<Row>) -> Table {
    let headings = rows
        .first()
        .map(|row| row.iter().map(|(heading, _)| *heading).collect::<Vec<_>>());
    let mut table = Table::new(title, headings.unwrap_or_default());
    for row in rows {
        table.row(row.into_iter().map(|(_, cell)| cell));
    }
    table
}

fn conditions(state: &State) -> Table {
    let row = |condition: &Arc<Condition>| {
        let id = condition.id();
        let flight = condition.flight_state();
        let result = state.analysis().and_then(|analysis| analysis.condition(id));
        let count = |of: &dyn Fn(&ConditionAnalysis) -> usize| {
            result.map_or(String::new(), |result| of(result).to_string())
        };
        vec![
            ("condition", id.to_string()),
            ("name", flight.name.clone()),
            ("airspeed [kt]", full_precision(Some(flight.airspeed_kt))),
            ("altitude", flight.altitude.clone().unwrap_or_default()),
            ("altitude [ft]", full_precision(flight.altitude_ft)),
            ("weight", flight.weight.clone().unwrap_or_default()),
            ("mass [kg]", full_precision(flight.mass_kg)),
            ("scheduled", yes(state.study.choice(id).scheduled)),
            (
                "suggested outliers not rejected",
                count(&|result| state.open_suggestions(result).len()),
            ),
            (
                "held gains not matched",
                count(&|result| result.gains.unmatched.len()),
            ),
            (
                "held delays not matched",
                count(&|result| result.delays.unmatched.len()),
            ),
        ]
    };
    let rows = state.dataset().conditions().iter().map(row).collect();
    table_of_rows(format!("{}: conditions", state.dataset().name()), rows)
}

fn models(state: &State, bundle: BundleKind) -> Table {
    let condition = state.condition();
    let shown = state.shown();
    let choice = state.study.choice(condition.id()).bundle(bundle);
    let row = |model: &Model| {
        let ratio = shown.filter(|_| bundle == BundleKind::Physics);
        let ratio = ratio.and_then(|shown| shown.discontinuity_ratio(&model.name));
        let is_representative =
            shown.is_some_and(|shown| shown.representative_name(bundle) == model.name);
        vec![
            ("model", model.name.clone()),
            ("kept", yes(!choice.rejected.contains(&model.name))),
            (
                "chosen as representative",
                yes(choice.pinned.as_ref() == Some(&model.name)),
            ),
            ("representative", yes(is_representative)),
            (
                "states",
                model
                    .order()
                    .map_or(String::new(), |order| order.to_string()),
            ),
            (
                "mean distance [√J]",
                full_precision(shown.and_then(|shown| shown.score(bundle, &model.name))),
            ),
            ("discontinuity ratio", full_precision(ratio)),
            (
                "suggested",
                ratio.map_or(String::new(), |ratio| yes(ratio > SUGGESTION_RATIO)),
            ),
        ]
    };
    let rows = condition.bundle(bundle).iter().map(row).collect();
    table_of_rows(title(state, TableKind::of_bundle(bundle).name()), rows)
}

/// Returns the title with the condition and the confidence level.
fn title_with_bars(state: &State, kind: TableKind) -> String {
    let level = state
        .sureness()
        .level()
        .map(|level| format!(", ± of {:.0} %", 100.0 * level));
    title(
        state,
        &format!("{}{}", kind.name(), level.unwrap_or_default()),
    )
}

/// Returns the half-widths of a value's error bar and of its inner bar, "for this physics model":
/// \[%\], for delays \[ms\].
fn halves(sure: &Sureness<'_>, scalar: Scalar) -> [Option<f64>; 2] {
    let Some((bar, level)) = sure.bar(scalar) else {
        return [None; 2];
    };
    let shown = |half: f64| {
        if scalar.is_delay() {
            s_to_ms(half)
        } else {
            100.0 * half
        }
    };
    [bar.half_width(level), bar.inner_half_width(level)].map(|half| half.map(shown))
}

/// Builds the table of G, D, net gain, each with error bars, net delay, and J, J_mag and J_phase
/// before and after.
fn matrix(state: &State) -> Table {
    let sure = state.sureness();
    let shown = state.shown();
    let settings = &state.study.settings;
    let row = |pair: Pair| {
        let (output, input) = state.dataset().channel_names(pair);
        let cost = shown.and_then(|shown| shown.cost[pair]);
        let before = cost.map(|cost| cost.uncorrected);
        let after = cost.map(|cost| cost.corrected);
        let [gain, gain_inner] = halves(&sure, Scalar::Gain(pair));
        let [delay, delay_inner] =
            shown.map_or([None; 2], |shown| halves(&sure, shown.wanted_delay(pair)));
        let [net, net_inner] = halves(&sure, Scalar::NetGain(pair));
        let net_delay = shown.map(|shown| s_to_ms(shown.correction.net_delay_s(pair)));
        let words = [
            ("output", output.to_owned()),
            ("input", input.to_owned()),
            ("on-axis", yes(state.dataset().on_axis()[pair])),
            ("held", yes(settings.constrained[pair])),
            ("fitted", yes(!settings.ignored[pair])),
        ];
        let values = [
            ("G [-]", shown.and_then(|shown| shown.wanted_gain(pair))),
            ("G ± [%]", gain),
            ("G ± of identification [%]", gain_inner),
            (
                "D [ms]",
                shown
                    .and_then(|shown| shown.wanted_delay_s(pair))
                    .map(s_to_ms),
            ),
            ("D ± [ms]", delay),
            ("D ± of identification [ms]", delay_inner),
            (
                "net gain [-]",
                shown.map(|shown| shown.correction.net_gain(pair)),
            ),
            ("net gain ± [%]", net),
            ("net gain ± of identification [%]", net_inner),
            ("net delay [ms]", net_delay),
            ("J before", before.map(|cost| cost.total())),
            ("J after", after.map(|cost| cost.total())),
            ("J_mag before", before.map(|cost| cost.magnitude)),
            ("J_mag after", after.map(|cost| cost.magnitude)),
            ("J_phase before", before.map(|cost| cost.phase)),
            ("J_phase after", after.map(|cost| cost.phase)),
        ];
        words
            .into_iter()
            .chain(values.map(|(heading, value)| (heading, full_precision(value))))
            .collect()
    };
    table_of_rows(
        title_with_bars(state, TableKind::Matrix),
        state.dataset().on_axis().pairs().map(row).collect(),
    )
}

fn channels(state: &State) -> Table {
    let sure = state.sureness();
    let correction = state.shown().map(|shown| &shown.correction);
    let (inputs, outputs) = state.dataset().names_of_channels();
    let row = |channel: Channel| {
        let side = if matches!(channel, Channel::Input(_)) {
            "input"
        } else {
            "output"
        };
        let [half, inner] = halves(&sure, Scalar::ChannelGain(channel));
        let [delay_half, delay_inner] = halves(&sure, Scalar::ChannelDelay(channel));
        let values = [
            ("k [-]", correction.map(|of| of.gain(channel))),
            ("k ± [%]", half),
            ("k ± of identification [%]", inner),
            ("τ [ms]", correction.map(|of| s_to_ms(of.delay_s(channel)))),
            ("τ ± [ms]", delay_half),
            ("τ ± of identification [ms]", delay_inner),
        ];
        let words = [
            ("side", side.to_owned()),
            ("channel", channel.name(&inputs, &outputs)),
        ];
        words
            .into_iter()
            .chain(values.map(|(heading, value)| (heading, full_precision(value))))
            .collect()
    };
    let rows = all_channels(state.dataset()).into_iter().map(row).collect();
    table_of_rows(title_with_bars(state, TableKind::Channels), rows)
}

/// Sort column and whether the order is descending; `None` for the original order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sorting(Option<(usize, bool)>);

impl Sorting {
    /// Returns the order after a click on a column's heading: ascending, descending, original.
    pub fn clicked(self, column: usize) -> Self {
        Self(match self.0 {
            Some((sorted, false)) if sorted == column => Some((column, true)),
            Some((sorted, true)) if sorted == column => None,
            _ => Some((column, false)),
        })
    }

    /// Returns the sorted row indices: numbers by value, text alphabetically, empty cells last.
    /// Equal rows keep their order.
    pub fn order(self, table: &Table) -> Vec<usize> {
        self.order_of(table.rows.len(), |row, column| {
            table.rows[row].get(column).cloned().unwrap_or_default()
        })
    }

    /// As `order`, for the given number of rows and a function of row and column that returns a
    /// cell.
    pub fn order_of(self, rows: usize, cell: impl Fn(usize, usize) -> String) -> Vec<usize> {
        let mut order: Vec<usize> = (0..rows).collect();
        let Some((column, falling)) = self.0 else {
            return order;
        };
        let cells: Vec<String> = order.iter().map(|&row| cell(row, column)).collect();
        order.sort_by(|a, b| {
            let a = &cells[*a];
            let b = &cells[*b];
            let compared = match (number_in(a), number_in(b)) {
                (Some(a), Some(b)) => a.total_cmp(&b),
                _ => a.cmp(b),
            };
            let compared = if falling {
                compared.reverse()
            } else {
                compared
            };
            a.is_empty().cmp(&b.is_empty()).then(compared)
        });
        order
    }

    /// Returns the sort mark of a column's heading.
    pub fn mark(self, column: usize) -> &'static str {
        match self.0 {
            Some((sorted, false)) if sorted == column => " ▲",
            Some((sorted, true)) if sorted == column => " ▼",
            _ => "",
        }
    }
}

/// Parses the number at the beginning of a cell, with either minus sign.
fn number_in(cell: &str) -> Option<f64> {
    cell.split_whitespace()
        .next()?
        .replacen('\u{2212}', "-", 1)
        .parse()
        .ok()
}

/// Click in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableClick {
    /// Index of the row in the original order.
    pub row: usize,
    pub column: usize,
}

/// Appearance of a table's cells.
pub struct TableLook<'a> {
    /// Text colour of a cell, by row and column; the default if `None`.
    pub color: &'a dyn Fn(usize, usize) -> Option<Color32>,
    /// Whether a row is in focus.
    pub selected: &'a dyn Fn(usize) -> bool,
}

impl TableLook<'_> {
    /// Default colours, no row in focus.
    pub const PLAIN: TableLook<'static> = TableLook {
        color: &|_, _| None,
        selected: &|_| false,
    };
}

/// Draws a table that scrolls if it is too large. Its headings sort it; a right-click copies or
/// saves it.
pub fn table_ui(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> Option<TableClick> {
    let area = ScrollArea::both()
        .id_salt(("table", &table.title))
        .auto_shrink(false);
    area.show(ui, |ui| {
        table_grid_ui(ui, table, sorting, look, palette, commands)
    })
    .inner
}

/// As `table_ui`, in full size without scrolling.
pub fn table_grid_ui(
    ui: &mut Ui,
    table: &Table,
    sorting: &mut Sorting,
    look: &TableLook<'_>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) -> Option<TableClick> {
    let mut clicked = None;
    let order = sorting.order(table);
    // Row 0 is the heading.
    let is_selected: Vec<bool> = std::iter::once(false)
        .chain(order.iter().map(|row| (look.selected)(*row)))
        .collect();
    let selected = palette.selected;
    let row_color = move |row: usize, style: &egui::Style| match is_selected.get(row) {
        Some(true) => Some(selected),
        _ => (row % 2 == 1).then_some(style.visuals.faint_bg_color),
    };
    Grid::new(("cells", &table.title))
        .spacing([12.0, 3.0])
        .with_row_color(row_color)
        .show(ui, |ui| {
            for (column, heading) in table.columns.iter().enumerate() {
                let text = palette.small(format!("{heading}{}", sorting.mark(column)));
                let button = ui.add(Button::new(text).frame(false));
                let button = named(
                    button,
                    Role::Button,
                    format!("Sort {} by {heading}", table.title),
                );
                button.context_menu(|ui| copy_ui(ui, table, commands));
                if button
                    .on_hover_text("Sort; right-click: copy or save the table")
                    .clicked()
                {
                    *sorting = sorting.clicked(column);
                }
            }
            ui.end_row();
            for row in order {
                for (column, cell) in table.rows[row].iter().enumerate() {
                    let color = (look.color)(row, column).unwrap_or(palette.text);
                    let text = RichText::new(cell).size(SMALL_SIZE).color(color);
                    let layout = if number_in(cell).is_some() || cell == "-" {
                        Align::Max
                    } else {
                        Align::Min
                    };
                    let label = Label::new(text)
                        .sense(Sense::click())
                        .selectable(false)
                        .extend();
                    let response = ui
                        .with_layout(Layout::top_down(layout), |ui| ui.add(label))
                        .inner;
                    response.context_menu(|ui| copy_ui(ui, table, commands));
                    if response.clicked() {
                        clicked = Some(TableClick { row, column });
                    }
                }
                ui.end_row();
            }
        });
    clicked
}

fn copy_ui(ui: &mut Ui, table: &Table, commands: &mut Vec<Command>) {
    let entries = [
        ("Copy the table as text", Command::CopyText(table.text())),
        (
            "Save the table as CSV…",
            Command::AskSaveShownTable(Arc::new(table.clone())),
        ),
    ];
    entries_ui(ui, entries, commands);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("t", ["name", "value"]);
        for (name, value) in [("b", "10"), ("a", "\u{2212}2.5"), ("c", ""), ("d", "9")] {
            table.row([name, value]);
        }
        table
    }

    #[test]
    fn numbers_are_sorted_by_value_and_words_by_letters() {
        let by = |column| Sorting::default().clicked(column);
        assert_eq!(by(1).order(&table()), [1, 3, 0, 2], "empty cells last");
        assert_eq!(
            by(1).clicked(1).order(&table()),
            [0, 3, 1, 2],
            "downwards too"
        );
        assert_eq!(by(0).order(&table()), [1, 0, 2, 3]);
    }

    #[test]
    fn the_third_click_on_a_heading_leaves_the_table_as_it_was_made() {
        let sorting = Sorting::default().clicked(1).clicked(1).clicked(1);
        assert_eq!(sorting.order(&table()), [0, 1, 2, 3]);
        assert_eq!(
            Sorting::default().clicked(0).clicked(1),
            Sorting::default().clicked(1)
        );
    }
}
