//! What the Bode plot remembers between frames: the part in view, and where things are on the screen.

use egui::{Pos2, Rect, Vec2};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};

use gdcm_plot::figure::Range;
use gdcm_plot::figure::responses::fitted_values;

use super::axis_strip::{LimitsForm, PlotAxis};
use super::bode::{BodeScene, PANES};
use super::cached_raster::CachedRaster;
use super::curve_menu::MenuSubject;
use super::drawn_curves::{BodeCurve, CurveId, DrawnCurves, Pane};
use super::navigation::ViewedRange;
use super::quantity::ValueUnit;

/// Decades that can be in view.
const DECADES: Range = Range {
    min: 1e-3,
    max: 12.0,
};
/// Values of `log10 omega` that can be in view: far inside what a float holds.
const LOG_OMEGA: Range = Range {
    min: -30.0,
    max: 30.0,
};
/// Space above and below the curves after fitting, as a part of their height.
const FIT_MARGIN: f64 = 0.04;

/// What the Bode plot remembers between frames.
///
/// The view stands still: whatever is computed anew, only what the engineer does moves it. Values that nobody has zoomed into
/// are fitted once to another response or condition.
#[derive(Clone, Debug)]
pub struct BodeView {
    log_omega: ViewedRange,
    /// Magnitudes \[dB\] and phases \[deg\].
    values: [ViewedRange; 2],
    /// The curve under the pointer.
    pub hovered: Option<CurveId>,
    /// The frequency under the pointer \[rad/s\].
    pub pointed_omega: Option<f64>,
    pub(super) last_clicked: Option<CurveId>,
    /// What the menu that is open, or was last, was asked for.
    pub(super) menu_subject: Option<MenuSubject>,
    /// Whether a box is being drawn to select curves.
    pub(super) is_selecting: bool,
    /// The box that was drawn.
    pub(super) selection: Option<(Pane, Rect)>,
    /// Limits of an axis being typed.
    pub(super) limits: Option<LimitsForm>,
    must_fit_frequencies: bool,
    must_fit_values: bool,
    /// The frequencies of the curves that were last in view, as `log10 omega`.
    followed: Option<Range>,
    /// What each pane drew last.
    pub(super) drawn: [DrawnPane; 2],
}

/// What a pane drew last: where, its lines, and the image of those that stand still.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnPane {
    pub(super) transform: Option<PlotTransform>,
    pub(super) curves: DrawnCurves,
    pub(super) image: CachedRaster,
}

/// From the first to the last frequency of all curves, as `log10 omega`.
fn log_omega_of(curves: &[BodeCurve]) -> Option<Range> {
    Range::of(
        curves
            .iter()
            .flat_map(|curve| curve.omega.iter())
            .map(|omega| omega.log10()),
    )
}

impl Default for BodeView {
    fn default() -> Self {
        Self {
            log_omega: ViewedRange::new(
                Range {
                    min: -1.0,
                    max: 2.0,
                },
                DECADES,
                LOG_OMEGA,
            ),
            values: [
                ViewedRange::new(
                    Range {
                        min: -40.0,
                        max: 20.0,
                    },
                    ValueUnit::Decibel.widths(),
                    Range::ALL,
                ),
                ViewedRange::new(
                    Range {
                        min: -360.0,
                        max: 90.0,
                    },
                    ValueUnit::Degree.widths(),
                    Range::ALL,
                ),
            ],
            hovered: None,
            pointed_omega: None,
            last_clicked: None,
            menu_subject: None,
            is_selecting: false,
            selection: None,
            limits: None,
            must_fit_frequencies: true,
            must_fit_values: true,
            followed: None,
            drawn: Default::default(),
        }
    }
}

impl BodeView {
    /// Shows all of the data at the next frame, whatever the engineer has zoomed into.
    pub fn request_fit(&mut self) {
        self.log_omega.release();
        self.values.iter_mut().for_each(ViewedRange::release);
        self.must_fit_frequencies = true;
        self.must_fit_values = true;
    }

    /// Shows all values of other curves at the next frame, on the axes that the engineer has not zoomed; the frequencies stay.
    pub fn request_refit(&mut self) {
        self.must_fit_values = true;
    }

    /// Shows all values of a pane at the next frame: they are in another unit.
    pub fn release_values(&mut self, pane: Pane) {
        self.values[pane as usize].release();
        self.must_fit_values = true;
    }

    /// Shows all frequencies again where the curves came to have others, unless the engineer chose what is in view.
    pub(super) fn follow_curves(&mut self, curves: &[BodeCurve]) {
        let ends = log_omega_of(curves);
        if ends.is_some() && ends != self.followed {
            let is_first = self.followed.is_none();
            self.followed = ends;
            let follows = !is_first && !self.log_omega.is_chosen();
            self.must_fit_frequencies |= follows;
            self.must_fit_values |= follows;
        }
    }

    /// Shows the frequencies that another plot shows.
    pub fn share_frequencies(&mut self, other: &Self) {
        self.log_omega = other.log_omega;
        self.must_fit_frequencies = other.must_fit_frequencies;
    }

    /// The frequencies in view \[rad/s\].
    pub fn omega_range(&self) -> (f64, f64) {
        let Range { min, max } = self.log_omega.range();
        (10f64.powf(min), 10f64.powf(max))
    }

    /// The frequencies in view \[rad/s\], where the engineer chose them.
    pub fn chosen_omega(&self) -> Option<Range> {
        let (min, max) = self.omega_range();
        self.log_omega.is_chosen().then_some(Range { min, max })
    }

    /// The part of a pane's vertical axis in view, where the engineer chose it.
    pub fn chosen_values(&self, pane: Pane) -> Option<Range> {
        let viewed = &self.values[pane as usize];
        viewed.is_chosen().then(|| viewed.range())
    }

    /// The part of a pane's vertical axis that is in view.
    pub fn value_range(&self, pane: Pane) -> Range {
        self.values[pane as usize].range()
    }

    /// Where a pane was drawn last: x is `log10 omega`, y is in dB or in degrees.
    pub fn transform(&self, pane: Pane) -> Option<&PlotTransform> {
        self.drawn[pane as usize].transform.as_ref()
    }

    /// Where `value` at `omega` \[rad/s\] is on the screen.
    pub fn screen_position(&self, pane: Pane, omega: f64, value: f64) -> Option<Pos2> {
        let transform = self.transform(pane)?;
        Some(transform.position_from_point(&PlotPoint::new(omega.log10(), value)))
    }

    /// The part in view of a pane as egui_plot wants it.
    pub(super) fn bounds(&self, pane: Pane) -> PlotBounds {
        let frequencies = self.log_omega.range();
        let values = self.value_range(pane);
        PlotBounds::from_min_max([frequencies.min, values.min], [frequencies.max, values.max])
    }

    /// Moves what a pane shows by so much on the screen.
    pub(super) fn pan(&mut self, pane: Pane, by: Vec2) {
        let Some(transform) = self.transform(pane) else {
            return;
        };
        let [x_per_point, y_per_point] = transform.dvalue_dpos();
        self.log_omega
            .choose(self.log_omega.range().moved(-x_per_point * f64::from(by.x)));
        let values = self.value_range(pane).moved(-y_per_point * f64::from(by.y));
        self.values[pane as usize].choose(values);
    }

    /// Looks `factor` times closer at a pane, with the point under `pointer` staying where it is.
    pub(super) fn zoom(
        &mut self,
        pane: Pane,
        pointer: Pos2,
        frequency_factor: f64,
        value_factor: f64,
    ) {
        let Some(transform) = self.transform(pane) else {
            return;
        };
        let fixed = transform.value_from_position(pointer);
        self.log_omega.zoom(frequency_factor, fixed.x);
        self.values[pane as usize].zoom(value_factor, fixed.y);
    }

    /// What is in view of an axis, and what can be.
    pub(super) fn axis_mut(&mut self, axis: PlotAxis) -> &mut ViewedRange {
        match axis {
            PlotAxis::Frequency => &mut self.log_omega,
            PlotAxis::Values(pane) => &mut self.values[pane as usize],
        }
    }

    /// Shows all of the curves on one axis at the next frame.
    pub(super) fn fit_axis(&mut self, axis: PlotAxis) {
        self.axis_mut(axis).release();
        match axis {
            PlotAxis::Frequency => self.must_fit_frequencies = true,
            PlotAxis::Values(_) => self.must_fit_values = true,
        }
    }

    /// Shows what lies in `area` of the screen.
    pub(super) fn zoom_to(&mut self, pane: Pane, area: Rect) {
        let Some(transform) = self.transform(pane) else {
            return;
        };
        let a = transform.value_from_position(area.min);
        let b = transform.value_from_position(area.max);
        self.log_omega.choose(Range::new(a.x, b.x));
        self.values[pane as usize].choose(Range::new(a.y, b.y));
    }

    /// Shows all curves of `scene`, rejected ones included, where that was asked for. Without data the request stays.
    pub(super) fn fit_if_requested(&mut self, scene: &BodeScene<'_>) {
        let ends = scene
            .omega_range
            .map(|(min, max)| Range::new(min.log10(), max.log10()));
        ends.into_iter().for_each(|ends| self.log_omega.reach(ends));
        if !(self.must_fit_frequencies || self.must_fit_values) {
            return;
        }
        let Some(log_omega) = ends.or_else(|| log_omega_of(scene.curves)) else {
            return;
        };
        self.log_omega.reach(log_omega);
        if std::mem::take(&mut self.must_fit_frequencies) {
            self.log_omega.fit(log_omega);
        }
        if std::mem::take(&mut self.must_fit_values) {
            let within = (
                scene.band.0,
                scene.invalid.map_or(scene.band.1, |invalid| invalid.up_to),
            );
            for pane in PANES {
                if let Some(values) = fitted_values(scene.curves, pane, within) {
                    self.values[pane as usize]
                        .fit(values.with_margin(FIT_MARGIN, scene.quantity.least_height(pane)));
                }
            }
        }
    }
}
