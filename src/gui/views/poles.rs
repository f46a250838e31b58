//! Poles in the s-plane, and the modes of the physics bundle in a table.

use std::sync::Arc;

use egui::{Panel, Ui, Vec2, vec2};

use gdcm_method::requirements::{ModeName, NamedBy};
use gdcm_model::dataset::{BundleKind, Dynamics, Model, ModelId, Pair};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::response::Mode;
use gdcm_model::response::zeros::finite_zeros;
use gdcm_model::units::number;
use gdcm_plot::figure::figure::Along;
use gdcm_plot::figure::poles::{damping_grid, poles_figure};
use gdcm_plot::figure::{Figure, Mark, MarkId, Range, Role};
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::{ConditionAnalysis, Edit};
use gdcm_words::Table;

use super::frequency::{bode_options, condition_source};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::canvas::figure_legend_ui;
use crate::gui::plot::{FigureEvent, FigureScene, FigureView, FigureWords, figure_ui};
use crate::gui::state::modes_cache::{CachedModes, MadeOf};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::restore_panel_size;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Real and imaginary parts in the window of the slow modes \[rad/s\], which contains the
/// rigid-body modes of a helicopter.
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
/// Least size of a plot \[pt\].
const LEAST_PLOT: Vec2 = vec2(140.0, 130.0);
/// Initial share of the height taken by the table.
const TABLE_PART: f32 = 0.3;

/// Draws the switch of the zeros, from right to left.
pub fn poles_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut shown = state.display.poles.show_zeros;
    let name = format!(
        "zeros of {}",
        state.dataset().pair_name(state.display.selection.pair)
    );
    let hint = "Transmission zeros of the response in focus, of the nominal model and of both representatives";
    if ui.checkbox(&mut shown, name).on_hover_text(hint).changed() {
        commands.push(DisplayCommand::ShowZeros(shown).into());
    }
}

/// Draws the poles of every model of the displayed condition; a click rejects or restores a model.
pub fn poles_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut modes = std::mem::take(&mut state.display.poles.modes);
    modes.refresh(state);
    state.display.poles.modes = modes;
    let height = ui.available_height();
    if !state.display.poles.modes.table().0.rows.is_empty() {
        restore_panel_size(ui, "modes");
        let panel = Panel::bottom("modes")
            .resizable(true)
            .default_size(TABLE_PART * height)
            .min_size(60.0);
        panel.show(ui, |ui| modes_ui(ui, state, palette, commands));
    }
    let message = match state.modes() {
        Some(_) => "No model of this condition has poles: they are known by measured responses",
        None => state.results.absence(),
    };
    let mut view = state
        .display
        .figures
        .remove(&View::Poles)
        .unwrap_or_default();
    let figure = poles(state)
        .map(|figure| dressed(figure, &view))
        .unwrap_or_default();
    figure_legend_ui(ui, &figure, palette);
    let words = PoleWords {
        state,
        dots: figure
            .plots
            .first()
            .map_or(0, |plot| plot.panels[0].dots().count()),
    };
    let scene = FigureScene {
        highlighted: state.display.selection.hovered.clone().map(MarkId::Model),
        zooms: true,
        ..FigureScene::new("poles", &figure, LEAST_PLOT, message, &words)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        commands.push(match event {
            FigureEvent::Pointed(MarkId::Model(id)) => {
                Command::Selection(SelectionCommand::Hover(id))
            }
            FigureEvent::Told(words) => Command::Selection(SelectionCommand::Tell(words)),
            FigureEvent::Clicked(_, MarkId::Model(id), keys) if keys.alt => {
                Command::Selection(SelectionCommand::Isolate(id))
            }
            FigureEvent::Clicked(_, MarkId::Model(id), _) if state.study.is_rejected(&id) => {
                Edit::Restore(id).into()
            }
            FigureEvent::Clicked(_, MarkId::Model(id), _) => Edit::Reject(id).into(),
            FigureEvent::Clicked(..) | FigureEvent::Pointed(_) | FigureEvent::Asked(_) => continue,
        });
    }
    state.display.figures.insert(View::Poles, view);
}

/// Builds the figure of the poles of every model of the displayed condition, optionally with the
/// zeros of the response in focus; `None` until they are known.
pub fn poles(state: &State) -> Option<Figure> {
    let CachedModes { zeros, shifts, .. } = &state.display.poles.modes;
    let found = |id: &ModelId| {
        zeros
            .iter()
            .find(|(of, _)| of == id)
            .map(|(_, zeros)| zeros.clone())
            .unwrap_or_default()
    };
    let figure = poles_figure(
        &condition_source(state)?,
        state.modes()?,
        &bode_options(state),
        (&found, shifts),
    );
    Some(figure).filter(|figure| figure.plots[0].panels[0].dots().next().is_some())
}

/// Returns the figure as shown in the window: with arcs of equal frequency in the visible range,
/// and enlarged marks of the most important models.
fn dressed(mut figure: Figure, view: &FigureView) -> Figure {
    if let [_, slow] = &mut figure.plots[..] {
        slow.title = "s-plane, slow modes".to_owned();
        (slow.panels[0].x.range, slow.panels[0].y.range) = (Some(SLOW[0]), Some(SLOW[1]));
    }
    for (index, plot) in figure.plots.iter_mut().enumerate() {
        let panel = &mut plot.panels[0];
        let ranges = view
            .ranges(index)
            .unwrap_or_else(|| [Along::X, Along::Y].map(|along| panel.shown(along)));
        panel.marks.retain(|mark| !matches!(mark, Mark::Guide(_)));
        panel
            .marks
            .splice(0..0, damping_grid(ranges).map(Mark::from));
        for mark in &mut panel.marks {
            if let Mark::Dots(dots) = mark {
                let of = [
                    Role::Nominal,
                    Role::Representative,
                    Role::IdentifiedRepresentative,
                ];
                let matters = of.into_iter().any(|role| {
                    dots.key
                        .as_deref()
                        .is_some_and(|key| key.ends_with(role.key(false)))
                });
                dots.size = if matters { 1.0 } else { 0.7 };
            }
        }
    }
    figure
}

/// Descriptions of the pole plots.
struct PoleWords<'a> {
    state: &'a State,
    dots: usize,
}

impl FigureWords for PoleWords<'_> {
    fn plot(&self, plot: usize) -> String {
        let name = ["s-plane", "s-plane, slow modes"][plot.min(1)];
        format!("{name}: {} poles and zeros", self.dots)
    }

    fn pointed(&self, _: usize, id: &MarkId, [re, im]: [f64; 2]) -> Option<String> {
        let (MarkId::Model(id), modes) = (id, self.state.modes()?) else {
            return None;
        };
        let index = modes.condition.position(id.bundle, &id.name)?;
        let model = &modes.condition.bundle(id.bundle)[index];
        let found = modes.bundle(id.bundle)[index]
            .as_deref()
            .unwrap_or_default();
        let words: Vec<String> = match found
            .iter()
            .find(|mode| [mode.pole.re, mode.pole.im] == [re, im])
        {
            Some(mode) => [
                Some(mode_words(mode)),
                name_words(mode, model),
                participation_words(mode, model, 3),
            ]
            .into_iter()
            .flatten()
            .chain(sampled_words(model))
            .collect(),
            None => vec![format!(
                "transmission zero of {}",
                self.state
                    .dataset()
                    .pair_name(self.state.display.selection.pair)
            )],
        };
        let click = if self.state.study.is_rejected(id) {
            "click to restore"
        } else {
            "click to reject"
        };
        Some(format!("{} · {} · {click}", id.name, words.join(" · ")))
    }
}

/// Draws the table of modes; a click on a row highlights the model that jumps.
fn modes_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (table, jumping) = state.display.poles.modes.table();
    let look = TableLook {
        color: &|row, _| {
            jumping
                .get(row)
                .and_then(Option::as_ref)
                .map(|_| palette.warning)
        },
        selected: &|row| {
            jumping
                .get(row)
                .is_some_and(|id| id.is_some() && *id == state.display.selection.hovered)
        },
    };
    let mut sorting = state.display.poles.modes_sorting;
    let clicked = table_ui(ui, table, &mut sorting, &look, palette, commands);
    let model = clicked.and_then(|click| jumping.get(click.row)?.clone());
    commands.extend(model.map(|value| Command::Selection(SelectionCommand::Isolate(value))));
    state.display.poles.modes_sorting = sorting;
}

impl MadeOf {
    fn of(state: &State, modes: &Arc<ConditionModes>) -> Self {
        let coupled = state.shown().and_then(|shown| shown.coupled.as_ref());
        let couplings = coupled.map(|coupled| Arc::clone(&coupled.fitted));
        let zeros_of = state.display.poles.show_zeros.then(|| {
            (
                state.display.selection.pair,
                models_with_zeros(state, modes),
            )
        });
        Self {
            modes: Arc::clone(modes),
            reference: reference(state, modes),
            couplings,
            zeros_of,
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        let address = |of: &Self| of.couplings.as_ref().map(Arc::as_ptr);
        Arc::ptr_eq(&self.modes, &other.modes)
            && address(self) == address(other)
            && (self.reference, &self.zeros_of) == (other.reference, &other.zeros_of)
    }
}

impl CachedModes {
    /// Returns the table of modes, and for each row the first model that jumps.
    pub fn table(&self) -> (&Table, &[Option<ModelId>]) {
        (&self.table, &self.jumping)
    }

    /// Recomputes the cache if it no longer matches the state.
    pub fn refresh(&mut self, state: &State) {
        let Some(modes) = state.modes() else {
            *self = Self::default();
            return;
        };
        let made_of = MadeOf::of(state, modes);
        if self
            .made_of
            .as_ref()
            .is_some_and(|known| known.is_same(&made_of))
        {
            return;
        }
        (self.table, self.jumping) = modes_table(state, modes, made_of.reference);
        self.shifts = state
            .shown()
            .map(ConditionAnalysis::pole_shifts)
            .unwrap_or_default();
        let zeros = |pair: Pair, id: &ModelId| {
            let model = modes.condition.model(id.bundle, &id.name);
            model
                .map(|model| finite_zeros(&model.dynamics, pair))
                .unwrap_or_default()
        };
        let zeros_of = made_of
            .zeros_of
            .iter()
            .flat_map(|(pair, ids)| ids.iter().map(|id| (*pair, id)));
        self.zeros = zeros_of
            .map(|(pair, id)| (id.clone(), zeros(pair, id)))
            .collect();
        self.made_of = Some(made_of);
    }
}

/// Returns the nominal model and both representatives: zeros of every model would hide the poles.
fn models_with_zeros(state: &State, modes: &ConditionModes) -> Vec<ModelId> {
    let condition = &modes.condition;
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
    let mut wanted = vec![state.model_id(BundleKind::Physics, &nominal.name)];
    for kind in BundleKind::BOTH {
        let name = state.shown().map(|shown| shown.representative_name(kind));
        let id = name.map(|name| state.model_id(kind, name));
        wanted.extend(id.filter(|id| !wanted.contains(id)));
    }
    wanted
}

/// Returns the index of the physics model to whose modes the others' are matched: the
/// representative, or the nominal model until it is known.
pub fn reference(state: &State, modes: &ConditionModes) -> usize {
    let name = state
        .shown()
        .map(|shown| shown.representative_name(BundleKind::Physics));
    let found = name.and_then(|name| modes.condition.position(BundleKind::Physics, name));
    found.unwrap_or_else(|| modes.condition.nominal())
}

/// "1.52 rad/s, ζ 0.31, T 2.1 s".
fn mode_words(mode: &Mode) -> String {
    let mut words = vec![format!("|λ| {:.3} rad/s", mode.frequency_rad_s)];
    words.extend(
        mode.damping_ratio
            .filter(|_| mode.oscillates())
            .map(|ratio| format!("ζ {ratio:.3}")),
    );
    words.extend(
        mode.time_constant_s
            .map(|constant| format!("T {constant:.2} s")),
    );
    words.join(", ")
}

/// Returns the name of a mode, if the states of its model are named (M17.3).
fn name_words(mode: &Mode, model: &Model) -> Option<String> {
    let (name, by) = ModeName::of(mode, &model.states);
    name.filter(|_| by == NamedBy::States)
        .map(|name| name.to_string())
}

/// Describes how a pole of a discrete-time model is to be read.
fn sampled_words(model: &Model) -> Option<String> {
    let Dynamics::StateSpace(system) = &model.dynamics else {
        return None;
    };
    let sample_time_s = system.timing().sample_time_s?;
    Some(format!(
        "s = ln z / T, T = {} s; poles at z = 0 have no s and are not drawn",
        number(sample_time_s)
    ))
}

/// Lists the states with the largest participation, at most `most`: "w 62 %, q 21 %".
fn participation_words(mode: &Mode, model: &Model, most: usize) -> Option<String> {
    let shares = match &mode.participation {
        Ok(shares) => shares,
        Err(why) => return Some(why.to_string()),
    };
    let name = |state: usize| match model.states.get(state) {
        Some(name) => name.clone(),
        None => format!("state {}", state + 1),
    };
    let words = shares
        .iter()
        .take(most)
        .map(|(state, share)| format!("{} {:.0} %", name(*state), 100.0 * share));
    Some(words.collect::<Vec<_>>().join(", ")).filter(|words| !words.is_empty())
}

/// Builds the table of the physics bundle's modes, followed from model to model: a row for each
/// mode of the reference model.
fn modes_table(
    state: &State,
    modes: &ConditionModes,
    reference: usize,
) -> (Table, Vec<Option<ModelId>>) {
    let kind = BundleKind::Physics;
    let models = modes.condition.bundle(kind);
    let title = format!("Modes of condition {}", modes.condition.id());
    let columns = [
        "mode",
        "|λ| [rad/s]",
        "ζ [-]",
        "T [s]",
        "Re λ",
        "Im λ",
        "spread [rad/s]",
        "states",
        "outlying at",
    ];
    let mut table = Table::new(title, columns);
    let mut jumping = Vec::new();
    let own = modes.bundle(kind)[reference].as_deref().unwrap_or_default();
    for track in modes.tracks(kind, reference) {
        let Some(mode) = own.get(track.reference) else {
            continue;
        };
        let jumps: Vec<&str> = track
            .jumps
            .iter()
            .map(|&model| models[model].name.as_str())
            .collect();
        let figure = |value: f64| with_minus_sign(&format!("{value:.3}"));
        table.row([
            name_words(mode, &models[reference]).unwrap_or_default(),
            figure(mode.frequency_rad_s),
            mode.damping_ratio
                .filter(|_| mode.oscillates())
                .map(figure)
                .unwrap_or_default(),
            mode.time_constant_s.map(figure).unwrap_or_default(),
            figure(mode.pole.re),
            figure(mode.pole.im),
            figure(track.spread_rad_s),
            participation_words(mode, &models[reference], 2).unwrap_or_default(),
            jumps.join(", "),
        ]);
        jumping.push(
            track
                .jumps
                .first()
                .map(|&model| state.model_id(kind, &models[model].name)),
        );
    }
    (table, jumping)
}
