//! What the window shows: functions that draw the state and say what the engineer asks for.

pub mod answer_panel;
pub mod assembling;
pub mod bars;
pub mod centre;
pub mod command;
pub mod command_palette;
pub mod command_table;
pub mod conditions_panel;
pub mod controls;
pub mod cost_map;
pub mod curve_display;
pub mod display;
pub mod explanation;
pub mod figures;
pub mod focus;
pub mod forms;
pub mod help;
pub mod matrix_panel;
pub mod models_panel;
pub mod palette;
pub mod plot;
pub mod records;
pub mod result_panel;
pub mod settings_panel;
pub mod start_page;
pub mod state;
pub mod tables;
pub mod verdict;
pub mod views;

pub use bars::Bar;
pub use command::{Command, FormKind, RequirementTable};
pub use command_palette::{PaletteForm, command_palette_ui};
pub use command_table::{Entry, Menu, Reach, every_command};
pub use controls::{
    Asks, Entered, NumberField, ROW_HEIGHT, Room, button_ui, check_ui, elided_among, entries_ui,
    entry_ui, focus_field, is_entered, name_text_field, named, named_switch, number_entry_ui,
    painted_text, restore_panel_size, row_of_height_ui, row_text, row_text_within, row_ui,
    table_heading_ui, table_menu_ui, text_field_ui, typed_number,
};
use curve_display::curve_entries;
pub use curve_display::{CurveCommand, CurveDisplay};
pub use display::{Arrangement, Display, Preferences, ViewGroup};
pub use explanation::{
    QUESTION, Sheet, gain_conflict_marks, question_menu_ui, remarks_shown, sheet_ui, toggle_costs,
    turn_entry, value_label_ui,
};
use figures::figure_button_ui;
pub use figures::{figure_name, figure_of, tables_in_place, views_with_figure};
pub use focus::{Region, leave_region, region_place, region_ui, take_escape, was_focused};
pub use help::keys_page_ui;
pub use palette::{BODY_SIZE, CurveColors, Palette, PlotStyle, SMALL_SIZE};
use settings_panel::choice_ui;
use state::bar_words;
pub use state::{
    Background, FirstResult, Forms, Notice, NoticeKind, RecentFile, Results, State, Sureness,
};
pub use tables::{Sorting, TableKind, table_of};
pub use views::{Need, View, ViewKind, ViewTitle};
