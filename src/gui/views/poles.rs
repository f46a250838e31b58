//! Poles in the s-plane, and a table of the physics bundle's modes.

use egui::{Panel, Ui, Vec2, vec2};

use gdcm_model::dataset::ModelId;
use gdcm_plot::figure::figure::Along;
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::poles::{PoleContents, damping_grid, poles_figure};
use gdcm_plot::figure::{Figure, Mark, Range, Role};
use gdcm_study::Edit;

use super::PageEntry;
use super::axis_updates::axis_update;
use super::frequency_curves::{bode_options, condition_source};
use super::mode_text::mode_description;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::steady_range::AxisUpdate;
use crate::gui::plot::{FigureEvent, FigureScene, FigureView, FigureWords, figure_ui};
use crate::gui::state::modes_cache::CachedModes;
use crate::gui::state::view::View;
use crate::gui::state::view_pages::{PolesPage, ViewPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Ranges for real and imaginary part in the plot of slow modes \[rad/s\], which contains a
/// helicopter's rigid-body modes.
const SLOW: [Range; 2] = [
    Range {
        min: -2.0,
        max: 0.6,
    },
    Range {
        min: -3.2,
        max: 3.2,
    },
];
/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(140.0, 130.0);
/// Initial table height, as a share of the view height.
const TABLE_PART: f32 = 0.3;
/// Minimum view height for plots and table \[pt\]; a lower view shows the table only on its own
/// page.
const LEAST_WITH_TABLE: f32 = 440.0;

/// Returns the pages: the s-plane, and the modes.
pub fn poles_pages(state: &State) -> Vec<PageEntry> {
    [PolesPage::Plane, PolesPage::Modes]
        .map(|page| PageEntry::new(ViewPage::Poles(page), page == state.display.pages.poles))
        .into()
}

/// Draws the switch for the zeros.
pub fn poles_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut shown = state.display.poles.show_zeros;
    let name = format!(
        "zeros of {}",
        state.dataset().pair_name(state.display.selection.pair)
    );
    let hint = "Transmission zeros of the nominal model and both representatives";
    if ui.checkbox(&mut shown, name).on_hover_text(hint).changed() {
        commands.push(DisplayCommand::ShowZeros(shown).into());
    }
}

/// Draws every model's poles in the displayed condition; a click rejects or restores a model, with
/// Alt it isolates the model.
///
/// 1. Modes, zeros and table from their cache.
/// 2. On the page with the modes, only the table, or why there is none.
/// 3. In a high view, the table below the plots.
/// 4. The figure with its screen marks, below its legend.
pub fn poles_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Step 1. Refreshing borrows the state: take the cache out meanwhile.
    let mut modes = std::mem::take(&mut state.display.poles.modes);
    modes.refresh(state);
    state.display.poles.modes = modes;
    let height = ui.available_height();
    let has_modes = !state.display.poles.modes.table.rows.is_empty();
    // Step 2.
    if state.display.pages.poles == PolesPage::Modes {
        if has_modes {
            modes_ui(ui, state, palette, commands);
        } else {
            ui.label(palette.dim(absence_of_modes(state)));
        }
        return;
    }
    // Step 3.
    if has_modes && height >= LEAST_WITH_TABLE {
        restore_panel_size(ui, "modes");
        let panel = Panel::bottom("modes")
            .resizable(true)
            .default_size(TABLE_PART * height)
            .min_size(60.0);
        panel.show(ui, |ui| modes_ui(ui, state, palette, commands));
    }
    // Step 4.
    let message = absence_of_modes(state);
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Poles)
        .unwrap_or_default();
    let update = axis_update(ui, state);
    let figure = match poles(state) {
        Some(figure) => with_screen_marks(figure, &mut view, update),
        None => Figure::default(),
    };
    figure_legend_ui(ui, &figure, palette);
    let dots = match figure.plots.first() {
        Some(plot) => plot.panels[0].dots().count(),
        None => 0,
    };
    let words = PoleWords { state, dots };
    let scene = FigureScene {
        highlighted: state.display.selection.hovered.clone().map(MarkId::Model),
        zooms: true,
        ..FigureScene::new("poles", &figure, LEAST_PLOT, message, &words)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        commands.extend(pole_command(state, event));
    }
    state.display.figures.insert(View::Poles, view);
}

/// Returns the message shown without poles and modes.
fn absence_of_modes(state: &State) -> &'static str {
    match state.modes() {
        Some(_) => "The models of this condition have no poles: they are measured responses",
        None => state.results.absence(),
    }
}

/// Returns the command for an event in the pole plots; `None` if the event has no effect.
fn pole_command(state: &State, event: FigureEvent) -> Option<Command> {
    match event {
        FigureEvent::Pointed(MarkId::Model(id)) => Some(SelectionCommand::Hover(id).into()),
        FigureEvent::StatusText(words) => Some(SelectionCommand::ShowStatus(words).into()),
        FigureEvent::Clicked(_, MarkId::Model(id), keys) => Some(if keys.alt {
            SelectionCommand::Isolate(id).into()
        } else if state.study.is_rejected(&id) {
            Edit::Restore(id).into()
        } else {
            Edit::Reject(id).into()
        }),
        FigureEvent::Clicked(..)
        | FigureEvent::Pointed(_)
        | FigureEvent::ExplanationRequested(_) => None,
    }
}

/// Builds the figure with all models' poles in the displayed condition, optionally with zeros for
/// the response in focus; `None` until the modes are available, or if no model has poles.
pub fn poles(state: &State) -> Option<Figure> {
    let CachedModes { zeros, shifts, .. } = &state.display.poles.modes;
    let zeros_of_model = |id: &ModelId| match zeros.iter().find(|(model, _)| model == id) {
        Some((_, zeros)) => zeros.clone(),
        None => Vec::new(),
    };
    let source = condition_source(state)?;
    let contents = PoleContents {
        modes: state.modes()?,
        zeros_of: &zeros_of_model,
        shifts,
    };
    let figure = poles_figure(&source, contents, &bode_options(state));
    figure.plots[0].panels[0].dots().next()?;
    Some(figure)
}

/// Returns the figure as shown in the window:
///
/// 1. the second plot, of the slow modes, has the constant range [`SLOW`];
/// 2. axes do not move with every update;
/// 3. the lines of equal damping ratio and frequency (guides) are those of the visible range
///    instead of the range on paper;
/// 4. perturbed models have smaller dots than the nominal model and the representatives.
fn with_screen_marks(mut figure: Figure, view: &mut FigureView, update: AxisUpdate) -> Figure {
    // Step 1.
    if let [_, slow] = &mut figure.plots[..] {
        slow.title = "s-plane, slow modes".to_owned();
        let [real, imaginary] = SLOW;
        slow.panels[0].x.range = Some(real);
        slow.panels[0].y.range = Some(imaginary);
    }
    // Step 2.
    view.keep_axis_ranges(&mut figure, update);
    // Steps 3 and 4.
    for (index, plot) in figure.plots.iter_mut().enumerate() {
        let panel = &mut plot.panels[0];
        let ranges = match view.ranges(index) {
            Some(ranges) => ranges,
            None => [Along::X, Along::Y].map(|along| panel.shown(along)),
        };
        panel.marks.retain(|mark| !matches!(mark, Mark::Guide(_)));
        panel
            .marks
            .splice(0..0, damping_grid(ranges).map(Mark::from));
        for mark in &mut panel.marks {
            if let Mark::Dots(dots) = mark {
                dots.size = dot_size(dots.key.as_deref());
            }
        }
    }
    figure
}

/// Returns the size of the dots with a legend entry, relative to the usual size. The entry ends in
/// the role's name; dots without an entry are small.
fn dot_size(key: Option<&str>) -> f64 {
    const LARGE: [Role; 3] = [
        Role::Nominal,
        Role::Representative,
        Role::IdentifiedRepresentative,
    ];
    const SMALL: f64 = 0.7;
    /// Rejected models have other legend entries.
    const IS_REJECTED: bool = false;
    if let Some(key) = key
        && LARGE
            .iter()
            .any(|role| key.ends_with(role.key(IS_REJECTED)))
    {
        1.0
    } else {
        SMALL
    }
}

/// Accessible names for the pole plots, and descriptions of their marks.
struct PoleWords<'a> {
    state: &'a State,
    dots: usize,
}

impl FigureWords for PoleWords<'_> {
    fn plot_name(&self, plot: usize) -> String {
        let name = ["s-plane", "s-plane, slow modes"][plot.min(1)];
        format!("{name}: {} poles and zeros", self.dots)
    }

    /// Describes the mark at `re + i im`: the model's mode with exactly this pole; else, since a
    /// model's other marks are its zeros, a transmission zero.
    fn status_text(&self, _: usize, id: &MarkId, [re, im]: [f64; 2]) -> Option<String> {
        let modes = self.state.modes()?;
        let MarkId::Model(id) = id else {
            return None;
        };
        let index = modes.condition.position(id.bundle, &id.name)?;
        let model = &modes.condition.bundle(id.bundle)[index];
        let model_modes = modes.bundle(id.bundle)[index]
            .as_deref()
            .unwrap_or_default();
        let pointed = model_modes
            .iter()
            .find(|mode| mode.pole.re == re && mode.pole.im == im);
        let mut words = vec![id.name.to_string()];
        match pointed {
            Some(mode) => words.extend(mode_description(mode, model)),
            None => {
                let pair = self.state.display.selection.pair;
                let name = self.state.dataset().pair_name(pair);
                words.push(format!("transmission zero of {name}"));
            }
        }
        words.push(if self.state.study.is_rejected(id) {
            "click to restore".to_owned()
        } else {
            "click to reject".to_owned()
        });
        Some(words.join(" · "))
    }
}

/// Draws the mode table; a click isolates the first model whose pole is an outlier for the mode.
fn modes_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let CachedModes {
        table, outliers, ..
    } = &state.display.poles.modes;
    let look = TableLook {
        color: &|row, _| match outliers.get(row) {
            Some(Some(_)) => Some(palette.warning),
            _ => None,
        },
        selected: &|row| match outliers.get(row) {
            Some(Some(id)) => Some(id) == state.display.selection.hovered.as_ref(),
            _ => false,
        },
    };
    let mut sorting = state.display.poles.modes_sorting;
    let click = table_ui(ui, table, &mut sorting, &look, palette, commands);
    if let Some(click) = click
        && let Some(Some(id)) = outliers.get(click.row)
    {
        commands.push(SelectionCommand::Isolate(id.clone()).into());
    }
    state.display.poles.modes_sorting = sorting;
}
