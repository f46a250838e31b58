//! Areas around the curves of a Bode plot.

use egui_plot::{FilledArea, PlotUi};

use super::curve::Pane;
use crate::view::palette::Palette;

/// How far a response may lie from its curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeBand {
    /// Frequencies \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// Lower and upper magnitude \[dB\].
    pub magnitude_db: Vec<[f64; 2]>,
    /// Lower and upper phase \[deg\].
    pub phase_deg: Vec<[f64; 2]>,
}

impl BodeBand {
    /// Draws the band in a pane, stretch by stretch: where a value is not finite, or a wrapped phase jumps, it has a gap.
    pub(super) fn draw(&self, plot: &mut PlotUi<'_>, pane: Pane, palette: &Palette) {
        let values = match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        };
        let points: Vec<[f64; 3]> =
            self.omega.iter().zip(values).map(|(omega, [lower, upper])| [omega.log10(), *lower, *upper]).collect();
        for run in points.split(|point| point.iter().any(|value| !value.is_finite())).filter(|run| run.len() > 1) {
            let column = |index: usize| run.iter().map(|point| point[index]).collect::<Vec<f64>>();
            let fill = palette.identified.gamma_multiply(0.22);
            plot.add(FilledArea::new("", &column(0), &column(1), &column(2)).fill_color(fill).allow_hover(false));
        }
    }
}
