//! Legend above the Bode plot of an identified response.

use egui::{Color32, Rect, Role, Sense, Shape, Stroke, Ui, vec2};

use super::drawn_response::DrawnResponse;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, small};

/// Length of a line sample in the legend \[pt\].
const SAMPLE: f32 = 18.0;

pub(super) fn legend_ui(ui: &mut Ui, drawn: &DrawnResponse, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        for entry in legend_entries(drawn, palette) {
            entry.show(ui, palette);
        }
        if drawn.has_cut_intervals() {
            ui.label(palette.small("bars and bands are cut at ± 20 dB and ± 180°"));
        }
    });
}

fn legend_entries(drawn: &DrawnResponse, palette: &Palette) -> Vec<LegendEntry> {
    let mut entries = vec![
        LegendEntry {
            sample: Sample::Line,
            text: "CT-PBSID, refined, with its 95 % band",
            color: palette.identified,
        },
        LegendEntry {
            sample: Sample::DashedLine,
            text: "CT-PBSID",
            color: palette.accent,
        },
        LegendEntry {
            sample: Sample::Dot,
            text: "measured (local polynomial), ± 1.96 sd",
            color: palette.text,
        },
        LegendEntry {
            sample: Sample::Circle,
            text: "partial coherence below 0.6, or few spectral lines",
            color: palette.dim_text,
        },
    ];
    if !drawn.unexcited.is_empty() {
        entries.push(LegendEntry {
            sample: Sample::Bar,
            text: "not excited by the reference",
            color: palette.dim_text,
        });
    }
    entries
}

struct LegendEntry {
    sample: Sample,
    text: &'static str,
    color: Color32,
}

impl LegendEntry {
    /// Draws the sample and the label on the same line.
    fn show(&self, ui: &mut Ui, palette: &Palette) {
        let words = text_width(ui, self.text, small());
        let (rect, response) =
            ui.allocate_exact_size(vec2(SAMPLE + 4.0 + words, 14.0), Sense::hover());
        let sample = rect.with_max_x(rect.left() + SAMPLE);
        self.sample.paint(ui, sample, self.color);
        painted_text(ui, rect, SAMPLE + 4.0, self.text, small(), palette.dim_text);
        named(response, Role::Label, self.text);
    }
}

/// Line or point drawn before a legend label.
#[derive(Clone, Copy)]
enum Sample {
    Line,
    DashedLine,
    Dot,
    Circle,
    Bar,
}

impl Sample {
    fn paint(self, ui: &Ui, rect: Rect, color: Color32) {
        let painter = ui.painter();
        let ends = [rect.left_center(), rect.right_center()];
        match self {
            Self::Line => {
                painter.line_segment(ends, Stroke::new(2.0, color));
            }
            Self::DashedLine => {
                painter.extend(Shape::dashed_line(&ends, Stroke::new(1.2, color), 4.0, 3.0));
            }
            Self::Dot => {
                painter.circle_filled(rect.center(), 3.0, color);
            }
            Self::Circle => {
                painter.circle_stroke(rect.center(), 3.0, Stroke::new(1.0, color));
            }
            Self::Bar => {
                let bar = rect.shrink2(vec2(0.0, 4.0));
                painter.rect_filled(bar, 0.0, color.gamma_multiply(0.25));
            }
        }
    }
}
