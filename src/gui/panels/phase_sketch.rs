//! Sketch on the start page: phases of the identified and the corrected model over the band.

use egui::{Align2, Mesh, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2};

use gdcm_model::dataset::Band;
use gdcm_model::number_format::compact;

use crate::gui::plot::{BodeCurve, Pane, Role};
use crate::gui::widgets::palette::{Palette, small};

/// Number of steps over the band, equal on a logarithmic axis.
const STEPS: usize = 60;

/// Draws both phases \[deg\] over frequency \[rad/s\], with the gap between them; draws only the
/// frame if a curve is missing or does not span the band, or if all phases are equal.
pub(super) fn phase_sketch_ui(
    ui: &Ui,
    plot: Rect,
    curves: &[BodeCurve],
    band: Band,
    palette: &Palette,
) {
    let plot = plot
        .with_min_x(plot.left() + 28.0)
        .with_max_y(plot.bottom() - 14.0);
    ui.painter().rect(
        plot,
        0.0,
        palette.background,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    if let Some(sketch) = PhaseSketch::new(plot, curves, band) {
        sketch.paint_grid(ui, palette);
        sketch.paint_curves(ui, palette);
        sketch.paint_names(ui, palette);
    }
}

struct PhaseSketch {
    plot: Rect,
    /// Lower band end \[rad/s\].
    min: f64,
    /// Upper band end \[rad/s\].
    max: f64,
    /// Minimum phase \[deg\].
    least: f64,
    /// Maximum phase \[deg\].
    most: f64,
    /// Phases of the corrected model at each step \[deg\].
    corrected: Vec<f64>,
    /// Phases of the identified model at each step \[deg\].
    identified: Vec<f64>,
}

impl PhaseSketch {
    /// Creates the sketch; `None` if a curve is missing or does not span the band, or if all phases
    /// are equal.
    fn new(plot: Rect, curves: &[BodeCurve], band: Band) -> Option<Self> {
        let min = band.min();
        let max = band.max();
        let corrected = phases(curve_of_role(curves, Role::Corrected)?, min, max);
        let identified = phases(
            curve_of_role(curves, Role::IdentifiedRepresentative)?,
            min,
            max,
        );
        let mut least = f64::INFINITY;
        let mut most = f64::NEG_INFINITY;
        for phase in corrected.iter().chain(&identified) {
            least = least.min(*phase);
            most = most.max(*phase);
        }
        if corrected.len() <= STEPS || identified.len() <= STEPS || most <= least {
            return None;
        }
        Some(Self {
            plot,
            min,
            max,
            least,
            most,
            corrected,
            identified,
        })
    }

    /// Returns the vertical position of a phase \[deg\].
    fn y(&self, phase: f64) -> f32 {
        let part = ((phase - self.least) / (self.most - self.least)) as f32;
        let inner = self.plot.shrink2(vec2(0.0, 8.0));
        inner.bottom() - part * inner.height()
    }

    fn point(&self, step: usize, phase: f64) -> Pos2 {
        let x = self.plot.left() + self.plot.width() * step as f32 / STEPS as f32;
        pos2(x, self.y(phase))
    }

    fn path(&self, phases: &[f64]) -> Vec<Pos2> {
        phases
            .iter()
            .enumerate()
            .map(|(step, phase)| self.point(step, *phase))
            .collect()
    }

    fn paint_grid(&self, ui: &Ui, palette: &Palette) {
        let plot = self.plot;
        let stroke = Stroke::new(1.0, palette.grid);
        for omega in grid_frequencies(self.min, self.max) {
            let part = (omega / self.min).ln() / (self.max / self.min).ln();
            let x = plot.left() + plot.width() * part as f32;
            ui.painter().vline(x, plot.y_range(), stroke);
            ui.painter().text(
                pos2(x, plot.bottom() + 2.0),
                Align2::CENTER_TOP,
                compact(omega),
                small(),
                palette.dim_text,
            );
        }
        for phase in grid_phases(self.least, self.most) {
            let y = self.y(phase);
            ui.painter().hline(plot.x_range(), y, stroke);
            ui.painter().text(
                pos2(plot.left() - 4.0, y),
                Align2::RIGHT_CENTER,
                compact(phase),
                small(),
                palette.dim_text,
            );
        }
    }

    /// Paints both curves over the shaded gap between them.
    fn paint_curves(&self, ui: &Ui, palette: &Palette) {
        let corrected = self.path(&self.corrected);
        let identified = self.path(&self.identified);
        let shade = palette.identified.gamma_multiply(0.22);
        let mut mesh = Mesh::default();
        for step in 0..=STEPS {
            mesh.colored_vertex(corrected[step], shade);
            mesh.colored_vertex(identified[step], shade);
            if step > 0 {
                let corner = 2 * step as u32;
                mesh.add_triangle(corner - 2, corner - 1, corner);
                mesh.add_triangle(corner - 1, corner, corner + 1);
            }
        }
        let mut shapes = vec![Shape::mesh(mesh)];
        palette
            .role_style(Role::IdentifiedRepresentative, false)
            .add_shapes(identified, &mut shapes);
        palette
            .role_style(Role::Corrected, false)
            .add_shapes(corrected, &mut shapes);
        ui.painter().extend(shapes);
    }

    fn paint_names(&self, ui: &Ui, palette: &Palette) {
        let middle = STEPS / 2;
        ui.painter().text(
            self.point(middle, self.identified[middle]) + vec2(10.0, 0.0),
            Align2::LEFT_BOTTOM,
            "flight",
            small(),
            palette.label_color(palette.identified),
        );
        ui.painter().text(
            self.point(middle, self.corrected[middle]) + vec2(-8.0, 0.0),
            Align2::RIGHT_TOP,
            "corrected",
            small(),
            palette.label_color(palette.corrected),
        );
    }
}

fn curve_of_role(curves: &[BodeCurve], role: Role) -> Option<&BodeCurve> {
    curves.iter().find(|curve| curve.role == role)
}

/// Returns the phase at each step within the curve's range \[deg\].
fn phases(curve: &BodeCurve, min: f64, max: f64) -> Vec<f64> {
    (0..=STEPS)
        .filter_map(|step| {
            let omega = min * (max / min).powf(step as f64 / STEPS as f64);
            curve.value_at(Pane::Phase, omega)
        })
        .collect()
}

/// Returns the frequencies 1, 2 and 5 in each decade, within the band \[rad/s\].
fn grid_frequencies(min: f64, max: f64) -> Vec<f64> {
    let decades = (min.log10().floor() as i32)..=(max.log10().ceil() as i32);
    decades
        .flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(decade)))
        .filter(|omega| (min..=max).contains(omega))
        .collect()
}

/// Returns the multiples of 90° between two phases \[deg\].
fn grid_phases(least: f64, most: f64) -> Vec<f64> {
    let first = (least / 90.0).ceil() as i32;
    let last = (most / 90.0).floor() as i32;
    (first..=last).map(|line| 90.0 * f64::from(line)).collect()
}
