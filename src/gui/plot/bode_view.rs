//! Bode state kept between frames: visible ranges and screen positions.

use egui::{Pos2, Rect, Vec2};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};

use gdcm_plot::figure::Range;
use gdcm_plot::figure::responses::fitted_values;

use super::bode_axis::BodeAxis;
use super::bode_scene::BodeScene;
use super::drawn_curves::{BodeCurve, CurveId, PANES, Pane};
use super::drawn_pane::DrawnPane;
use super::limits_form::LimitsForm;
use super::steady_range::{AxisUpdate, changed_range, labelled_range};
use super::value_unit::ValueUnit;
use super::viewed_range::{ViewedRange, bounds_of};

/// Permitted widths for the visible frequency range \[decades\].
const DECADES: Range = Range {
    min: 1e-3,
    max: 12.0,
};
/// Permitted values for `log10 omega`, far from where floating-point numbers overflow.
const LOG_OMEGA: Range = Range {
    min: -30.0,
    max: 30.0,
};
/// Margin above and below the curves after fitting, relative to their height.
const FIT_MARGIN: f64 = 0.04;

/// Bode plot state kept between frames.
///
/// Value axes whose ranges the engineer has not chosen follow recomputed curves and other
/// conditions with hysteresis, so that they seldom move. For another response they are fitted once.
///
/// Two kinds of state control the visible ranges: a `ViewedRange` records whether the engineer
/// chose it, and `must_fit_frequencies`, `must_fit_values` request a fit in the next frame that has
/// data. A fit leaves a chosen range unchanged, so a request that concerns chosen ranges releases
/// them first.
#[derive(Clone, Debug)]
pub struct BodeView {
    log_omega: ViewedRange,
    /// Magnitudes \[dB\] and phases \[deg\].
    values: [ViewedRange; 2],
    pub hovered: Option<CurveId>,
    /// Frequency under the pointer \[rad/s\].
    pub pointed_omega: Option<f64>,
    pub(super) last_clicked: Option<CurveId>,
    /// Subject of the menu that is open or was last open.
    pub(super) menu_subject: Option<MenuSubject>,
    /// Whether a box is being drawn to select curves.
    pub(super) is_selecting: bool,
    /// Finished selection box.
    pub(super) selection: Option<SelectionBox>,
    /// Open form for axis limits.
    pub(super) limits_form: Option<LimitsForm>,
    must_fit_frequencies: bool,
    must_fit_values: bool,
    /// Range of the curves' `log10 omega` when the frequency axis last followed them.
    followed_log_omega: Option<Range>,
    /// Fitted values for all curves, including hidden ones, when the value axes last followed them.
    followed_values: [Option<Range>; 2],
    /// Panes as last drawn.
    pub(super) drawn: [DrawnPane; 2],
}

/// Curve or empty ground for which a menu is open, and the frequency at the click \[rad/s\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MenuSubject {
    pub(super) curve: Option<CurveId>,
    pub(super) omega: f64,
    /// Rejection reason, as typed so far.
    pub(super) reason: String,
}

/// Finished selection box in a pane.
#[derive(Clone, Copy, Debug)]
pub(super) struct SelectionBox {
    pub(super) pane: Pane,
    /// Place on the screen.
    pub(super) area: Rect,
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
            limits_form: None,
            must_fit_frequencies: true,
            must_fit_values: true,
            followed_log_omega: None,
            followed_values: [None; 2],
            drawn: Default::default(),
        }
    }
}

impl BodeView {
    /// Requests that all axes be fitted to the data in the next frame, even if the engineer chose
    /// their ranges.
    pub fn request_fit(&mut self) {
        self.log_omega.release();
        for values in &mut self.values {
            values.release();
        }
        self.must_fit_frequencies = true;
        self.must_fit_values = true;
    }

    /// Requests that the values be fitted to the next frame's curves, unless the engineer chose
    /// their ranges; the frequencies stay.
    pub fn request_refit(&mut self) {
        self.must_fit_values = true;
    }

    /// Requests that the values be fitted in the next frame, those in `pane` even if the engineer
    /// chose their range, because their unit changes.
    pub fn release_values(&mut self, pane: Pane) {
        self.values[pane as usize].release();
        self.must_fit_values = true;
    }

    /// Requests a fit if the curves' frequency range has changed, unless the engineer chose the
    /// visible range. The first range is only remembered: a new view requests its fit itself.
    pub(super) fn follow_frequencies(&mut self, curves: &[BodeCurve]) {
        let ends = log_omega_of(curves);
        if ends.is_some() && ends != self.followed_log_omega {
            let is_first = self.followed_log_omega.is_none();
            self.followed_log_omega = ends;
            let follows = !is_first && !self.log_omega.is_chosen();
            self.must_fit_frequencies |= follows;
            self.must_fit_values |= follows;
        }
    }

    /// Adapts the value axes to new curves that no longer fit, unless the engineer chose their
    /// ranges. The pointer, selections and chips leave the curves as they are, and therefore the
    /// axes.
    ///
    /// While results are pending, nothing changes. Otherwise, for each pane:
    ///
    /// 1. compute the values fitted to the curves in `whole`, which includes hidden curves; if
    ///    there are none, or they are those last followed, the axis stays;
    /// 2. remember them as followed; not while something is dragged, because the release may then
    ///    shrink the axis;
    /// 3. the first time, the axis stays: [`Self::fit_if_requested`] has fitted it;
    /// 4. afterwards, fit the curves in `visible` with hysteresis ([`changed_range`]): the axis
    ///    changes only if they leave it, or fill little of it.
    pub(super) fn follow_values(
        &mut self,
        whole: &BodeScene<'_>,
        visible: &BodeScene<'_>,
        update: AxisUpdate,
    ) {
        if update == AxisUpdate::Pending {
            return;
        }
        let band = fitted_band(whole);
        for pane in PANES {
            let index = pane as usize;
            // Step 1.
            let fitted = fitted_values(whole.curves, pane, band);
            if fitted.is_none() || fitted == self.followed_values[index] {
                continue;
            }
            // Step 2.
            let is_first = self.followed_values[index].is_none();
            if update == AxisUpdate::Complete {
                self.followed_values[index] = fitted;
            }
            // Step 3.
            if is_first {
                continue;
            }
            // Step 4.
            if let Some(values) = fitted_values(visible.curves, pane, band) {
                let fitted = values.with_margin(FIT_MARGIN, whole.quantity.least_height(pane));
                let shown = self.values[index].range();
                if let Some(changed) = changed_range(shown, fitted, update) {
                    let scale = whole.quantity.unit(pane).scale();
                    self.values[index].fit(labelled_range(changed, scale));
                }
            }
        }
    }

    /// Adopts another plot's frequency range, with a pending request to fit it.
    pub fn share_frequencies(&mut self, other: &Self) {
        self.log_omega = other.log_omega;
        self.must_fit_frequencies = other.must_fit_frequencies;
    }

    /// Returns the visible frequency range \[rad/s\].
    pub fn omega_range(&self) -> (f64, f64) {
        let Range { min, max } = self.log_omega.range();
        (10f64.powf(min), 10f64.powf(max))
    }

    /// Returns the visible frequency range \[rad/s\] if the engineer chose it.
    pub fn chosen_omega(&self) -> Option<Range> {
        if !self.log_omega.is_chosen() {
            return None;
        }
        let (min, max) = self.omega_range();
        Some(Range { min, max })
    }

    /// Returns a pane's visible values if the engineer chose them.
    pub fn chosen_values(&self, pane: Pane) -> Option<Range> {
        let viewed = &self.values[pane as usize];
        if viewed.is_chosen() {
            Some(viewed.range())
        } else {
            None
        }
    }

    /// Returns a pane's visible values.
    pub fn value_range(&self, pane: Pane) -> Range {
        self.values[pane as usize].range()
    }

    /// Returns a pane's transform as last drawn: x is `log10 omega`, y is in \[dB\], \[deg\] or,
    /// for phase errors, also \[ms\]. `None` before the first drawing.
    pub fn transform(&self, pane: Pane) -> Option<&PlotTransform> {
        self.drawn[pane as usize].transform.as_ref()
    }

    /// Returns a pane's frame as last drawn, without its axes.
    pub(super) fn frame(&self, pane: Pane) -> Option<Rect> {
        Some(*self.transform(pane)?.frame())
    }

    /// Returns where `value` at `omega` \[rad/s\] lies on the screen.
    pub fn screen_position(&self, pane: Pane, omega: f64, value: f64) -> Option<Pos2> {
        let transform = self.transform(pane)?;
        Some(transform.position_from_point(&PlotPoint::new(omega.log10(), value)))
    }

    /// Returns a pane's visible range as egui_plot bounds.
    pub(super) fn bounds(&self, pane: Pane) -> PlotBounds {
        bounds_of([self.log_omega.range(), self.value_range(pane)])
    }

    /// Pans a pane by a screen distance.
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

    /// Magnifies a pane by a factor along each axis, with the point under `pointer` fixed.
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

    /// Returns the visible range of an axis with its limits.
    pub(super) fn axis_mut(&mut self, axis: BodeAxis) -> &mut ViewedRange {
        match axis {
            BodeAxis::Frequency => &mut self.log_omega,
            BodeAxis::Values(pane) => &mut self.values[pane as usize],
        }
    }

    /// Requests that an axis be fitted in the next frame, even if the engineer chose its range. For
    /// a value axis, the other pane's values are fitted too, unless they were chosen.
    pub(super) fn request_axis_fit(&mut self, axis: BodeAxis) {
        self.axis_mut(axis).release();
        match axis {
            BodeAxis::Frequency => self.must_fit_frequencies = true,
            BodeAxis::Values(_) => self.must_fit_values = true,
        }
    }

    /// Zooms into an area on the screen.
    pub(super) fn zoom_to(&mut self, pane: Pane, area: Rect) {
        let Some(transform) = self.transform(pane) else {
            return;
        };
        let upper_left = transform.value_from_position(area.min);
        let lower_right = transform.value_from_position(area.max);
        self.log_omega
            .choose(Range::new(upper_left.x, lower_right.x));
        self.values[pane as usize].choose(Range::new(upper_left.y, lower_right.y));
    }

    /// Fits the requested axes to the curves in `scene`, including rejected ones.
    ///
    /// The frequency range is the scene's `omega_range`, or else that of its curves; zooming out
    /// is limited to a decade beyond it. Without either, the request stays pending. Axes whose
    /// ranges the engineer chose do not move, but the request counts as fulfilled.
    pub(super) fn fit_if_requested(&mut self, scene: &BodeScene<'_>) {
        let given = scene
            .omega_range
            .map(|(min, max)| Range::new(min.log10(), max.log10()));
        if let Some(given) = given {
            self.log_omega.limit_to_decade_around(given);
        }
        if !(self.must_fit_frequencies || self.must_fit_values) {
            return;
        }
        let Some(log_omega) = given.or_else(|| log_omega_of(scene.curves)) else {
            return;
        };
        self.log_omega.limit_to_decade_around(log_omega);
        if std::mem::take(&mut self.must_fit_frequencies) {
            self.log_omega.fit(log_omega);
        }
        if std::mem::take(&mut self.must_fit_values) {
            self.fit_values(scene);
        }
    }

    /// Fits the value axes of both panes to the curves, unless the engineer chose their ranges.
    fn fit_values(&mut self, scene: &BodeScene<'_>) {
        let band = fitted_band(scene);
        for pane in PANES {
            if let Some(values) = fitted_values(scene.curves, pane, band) {
                let least = scene.quantity.least_height(pane);
                let scale = scene.quantity.unit(pane).scale();
                let fitted = labelled_range(values.with_margin(FIT_MARGIN, least), scale);
                self.values[pane as usize].fit(fitted);
            }
        }
    }
}

/// Returns the frequencies whose values set the value axes: the band or, if the correction has
/// leads, from the band's lower end to the end of the drawn curves ([`BodeScene::invalid`]).
fn fitted_band(scene: &BodeScene<'_>) -> Range {
    let max = match scene.invalid {
        Some(invalid) => invalid.up_to,
        None => scene.band.1,
    };
    Range {
        min: scene.band.0,
        max,
    }
}

/// Returns the range of `log10 omega` over all curves; `None` without frequencies.
fn log_omega_of(curves: &[BodeCurve]) -> Option<Range> {
    Range::spanning(
        curves
            .iter()
            .flat_map(|curve| curve.omega.iter())
            .map(|omega| omega.log10()),
    )
}
