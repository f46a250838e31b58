//! Card about the open study on the start page: name, picture of its results, the button that
//! returns to it, and buttons for the examples.

use egui::{Button, Frame, Margin, RichText, Sense, Stroke, Ui, vec2};

use gdcm_io::Example;
use gdcm_model::dataset::BundleKind;
use gdcm_model::number_format::counted;

use super::cost_picture::{PICTURE_HEAD, cost_picture_height, cost_picture_ui};
use super::phase_sketch::phase_sketch_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::window_state::State;
use crate::gui::views::frequency_curves::bode_curves;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, TITLE_SIZE, medium, small};

/// Line height in multi-line text \[pt\].
const LINE: f32 = 20.0;

/// Draws name and picture of the open study, the button that returns to it, and buttons for the
/// other examples; while an example is open, also one for the guided tour.
pub(super) fn open_study_card_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let frame = Frame::new()
        .fill(palette.panel)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(8.0)
        .inner_margin(Margin::same(24));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let words = StudyWords::new(state);
        ui.label(RichText::new(words.title).font(medium(TITLE_SIZE)));
        ui.label(palette.dim(words.content).line_height(Some(LINE)));
        ui.add_space(12.0);
        picture_ui(ui, state, palette);
        ui.add_space(8.0);
        ui.label(palette.small(
            "Left: remaining J of the held responses in each condition, magnitude and phase; pale \
            means matched. Right: phases of the identified and the corrected model.",
        ));
        ui.add_space(12.0);
        ui.horizontal_wrapped(|ui| {
            ui.add(Button::new(words.back).min_size(vec2(0.0, 28.0)))
                .asks(LayoutCommand::ShowStart(false), commands);
            examples_ui(ui, state.example, commands);
            if state.example.is_none() {
                return;
            }
            let text = RichText::new("Guided tour, five notes").color(palette.accent);
            if ui.add(Button::new(text).frame(false)).clicked() {
                commands.push(LayoutCommand::ShowStart(false).into());
                commands.push(LayoutCommand::StartTour.into());
            }
        });
    });
}

/// Draws a button for each example that is not open.
fn examples_ui(ui: &mut Ui, open: Option<Example>, commands: &mut Vec<Command>) {
    for example in Example::ALL {
        if open == Some(example) {
            continue;
        }
        let (name, meaning) = match example {
            Example::Simulated => (
                "Simulated example",
                "Eleven flight conditions of a helicopter with known deficits",
            ),
            Example::RealAircraft => (
                "Real aircraft",
                "A quadrotor: its published physics model, corrected from two flights",
            ),
        };
        ui.add(Button::new(name).min_size(vec2(0.0, 28.0)))
            .on_hover_text(meaning)
            .asks(FileCommand::OpenExample(example), commands);
    }
}

/// Texts about the open study.
struct StudyWords {
    title: String,
    content: String,
    /// Text on the button that returns to the study.
    back: &'static str,
}

impl StudyWords {
    fn new(state: &State) -> Self {
        let conditions = state.dataset().conditions();
        let models: usize = conditions
            .iter()
            .map(|condition| condition.bundle(BundleKind::Physics).len())
            .sum();
        let count = conditions.len();
        if state.example == Some(Example::RealAircraft) {
            return Self {
                title: "Real aircraft".to_owned(),
                content: "AscTec Pelican, a quadrotor: its published physics model, two flights \
                          of 2011, and the models identified from them."
                    .to_owned(),
                back: "Continue",
            };
        }
        if state.example == Some(Example::Simulated) {
            return Self {
                title: "No data at hand?".to_owned(),
                content: format!(
                    "The example is simulated: {count} conditions of a UH-60A-class helicopter, \
                     {models} physics models, flight records, and known deficits of the models."
                ),
                back: "Explore the example",
            };
        }
        Self {
            title: state.dataset().name().to_owned(),
            content: format!(
                "{}: {}, {}.",
                state.study_name,
                counted(count, "condition"),
                counted(models, "physics model")
            ),
            back: "Continue",
        }
    }
}

fn picture_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let size = vec2(ui.available_width(), cost_picture_height(state));
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let map = area.with_max_x(area.left() + 0.44 * area.width());
    cost_picture_ui(ui, map, state, palette);
    let pair = state.display.selection.pair;
    let curves = bode_curves(state, pair);
    let plot = area.with_min_x(area.left() + 0.52 * area.width());
    let title = format!(
        "{}, phase, condition {}",
        state.dataset().pair_name(pair),
        state.condition().id()
    );
    let head = plot.with_max_y(plot.top() + PICTURE_HEAD);
    painted_text(ui, head, 0.0, &title, small(), palette.dim_text);
    let band = state.study.settings.band;
    phase_sketch_ui(ui, plot.with_min_y(head.bottom()), &curves, band, palette);
}
