//! A pole or a zero of one model, as the s-plane shows it.

use crate::view::plot::RoleLook;
use egui::{Painter, Pos2, Stroke, vec2};

use crate::view::palette::Palette;
use gdcm_core::dataset::ModelId;

use super::role::Role;

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MarkShape {
    /// A pole of a physics model: ×.
    Cross,
    /// A pole of an identified model: +.
    Plus,
    /// A transmission zero: ○.
    Circle,
}

/// A pole or a zero of one model.
#[derive(Clone, Debug)]
pub struct PoleMark {
    /// Whose it is.
    pub id: ModelId,
    /// What hovering says first: the model's name.
    pub label: String,
    /// Further lines for hovering.
    pub details: Vec<String>,
    /// What it stands for.
    pub shape: MarkShape,
    /// The role of its model.
    pub role: Role,
    /// Whether its model is left out.
    pub rejected: bool,
    /// Whether another view points at its model.
    pub highlighted: bool,
    /// Real and imaginary part \[rad/s\].
    pub value: [f64; 2],
}

impl PoleMark {
    /// Place in the order of drawing: what matters most is drawn last, on top.
    pub(super) fn layer(&self) -> usize {
        self.role.layer(self.rejected)
    }

    /// Draws the mark at `center`.
    pub(super) fn paint(&self, painter: &Painter, center: Pos2, is_emphasized: bool, palette: &Palette) {
        let look = self.role.look(self.rejected, palette);
        let matters = matches!(self.role, Role::Nominal | Role::Representative | Role::IdentifiedRepresentative);
        let radius = match (matters, is_emphasized) {
            (_, true) => 6.0,
            (true, false) => 5.0,
            (false, false) => 3.2,
        };
        let width = if matters || is_emphasized { 2.0 } else { 1.2 };
        let stroke = Stroke::new(width, look.color.to_opaque());
        match self.shape {
            MarkShape::Cross => {
                for corner in [vec2(radius, radius), vec2(radius, -radius)] {
                    painter.line_segment([center - 0.75 * corner, center + 0.75 * corner], stroke);
                }
            }
            MarkShape::Plus => {
                for end in [vec2(radius, 0.0), vec2(0.0, radius)] {
                    painter.line_segment([center - end, center + end], stroke);
                }
            }
            MarkShape::Circle => {
                painter.circle_stroke(center, 0.8 * radius, stroke);
            }
        }
    }
}
