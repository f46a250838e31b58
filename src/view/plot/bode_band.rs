//! Areas around the curves of a Bode plot.

use egui_plot::{FilledArea, PlotBounds, PlotUi};

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
    /// Draws what is in `view` of the band in a pane, stretch by stretch: where a value is not finite, or a wrapped phase jumps, it has
    /// a gap.
    pub(super) fn draw(&self, plot: &mut PlotUi<'_>, pane: Pane, view: &PlotBounds, palette: &Palette) {
        let values = match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        };
        let points: Vec<[f64; 3]> =
            self.omega.iter().zip(values).map(|(omega, [lower, upper])| [omega.log10(), *lower, *upper]).collect();
        for run in points.chunk_by(|from, to| is_in_view(from, to, view)).filter(|run| run.len() > 1) {
            let column = |index: usize| run.iter().map(|point| point[index]).collect::<Vec<f64>>();
            let fill = palette.identified.gamma_multiply(0.22);
            plot.add(FilledArea::new("", &column(0), &column(1), &column(2)).fill_color(fill).allow_hover(false));
        }
    }
}

/// Whether something of the band between two points, each a place with its lower and its upper value, is in view.
fn is_in_view(from: &[f64; 3], to: &[f64; 3], view: &PlotBounds) -> bool {
    let ([min_x, min_y], [max_x, max_y]) = (view.min(), view.max());
    let is_finite = from.iter().chain(to).all(|value| value.is_finite());
    is_finite && to[0] >= min_x && from[0] <= max_x && from[2].max(to[2]) >= min_y && from[1].min(to[1]) <= max_y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_counts_where_it_reaches_into_the_view() {
        let view = PlotBounds::from_min_max([0.0, 0.0], [1.0, 10.0]);
        let is_seen = |from, to| is_in_view(&from, &to, &view);
        assert!(is_seen([0.2, 1.0, 2.0], [0.3, 1.0, 2.0]));
        assert!(is_seen([-1.0, -5.0, -3.0], [2.0, 12.0, 15.0]), "it may pass through");
        assert!(!is_seen([-2.0, 1.0, 2.0], [-1.0, 1.0, 2.0]) && !is_seen([2.0, 1.0, 2.0], [3.0, 1.0, 2.0]));
        assert!(!is_seen([0.2, 11.0, 12.0], [0.3, 11.0, 12.0]) && !is_seen([0.2, -2.0, -1.0], [0.3, -2.0, -1.0]));
        assert!(!is_seen([0.2, f64::NAN, 2.0], [0.3, 1.0, 2.0]), "there is a gap");
    }
}
