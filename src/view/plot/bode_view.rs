//! What the Bode plot remembers between frames: the part in view, and where things are on the screen.

use egui::{Pos2, Rect};
use egui_plot::{PlotBounds, PlotPoint, PlotTransform};

use super::curve::{BodeCurve, CurveId, Pane};
use super::drawn_curves::DrawnCurves;
use super::legend::LegendState;
use super::range::Range;

/// Decades that can be in view.
const DECADES: Range = Range { min: 1e-3, max: 12.0 };
/// Values of `log10 omega` that can be in view: far inside what a float holds.
const LOG_OMEGA: Range = Range { min: -30.0, max: 30.0 };
/// Decibels that can be in view.
const DECIBELS: Range = Range { min: 1e-3, max: 5e3 };
/// Degrees that can be in view.
const DEGREES: Range = Range { min: 1e-2, max: 1e5 };
/// Space above and below the curves after fitting, as a part of their height.
const FIT_MARGIN: f64 = 0.04;
/// Height that fitting gives to values outside the band on either side, as a part of the height within it.
const OUTSIDE_PART: f64 = 0.4;

/// What the Bode plot remembers between frames. The ranges stay when the data change; fitting is asked for.
#[derive(Clone, Debug)]
pub struct BodeView {
    pub(super) log_omega: Range,
    pub(super) magnitude_db: Range,
    pub(super) phase_deg: Range,
    pub(super) legend: LegendState,
    pub(super) hovered: Option<CurveId>,
    pub(super) last_clicked: Option<CurveId>,
    must_fit: bool,
    magnitude_transform: Option<PlotTransform>,
    phase_transform: Option<PlotTransform>,
    magnitude_curves: DrawnCurves,
    phase_curves: DrawnCurves,
}

impl Default for BodeView {
    fn default() -> Self {
        Self {
            log_omega: Range { min: -1.0, max: 2.0 },
            magnitude_db: Range { min: -40.0, max: 20.0 },
            phase_deg: Range { min: -360.0, max: 90.0 },
            legend: LegendState { is_open: true, corner: None, rect: None },
            hovered: None,
            last_clicked: None,
            must_fit: true,
            magnitude_transform: None,
            phase_transform: None,
            magnitude_curves: DrawnCurves::default(),
            phase_curves: DrawnCurves::default(),
        }
    }
}

impl BodeView {
    /// Shows all of the data at the next frame.
    pub fn request_fit(&mut self) {
        self.must_fit = true;
    }

    /// Shows or hides the legend.
    pub fn set_legend_open(&mut self, open: bool) {
        self.legend.is_open = open;
    }

    /// The curve under the pointer.
    pub fn hovered(&self) -> Option<&CurveId> {
        self.hovered.as_ref()
    }

    /// The frequencies in view \[rad/s\].
    pub fn omega_range(&self) -> (f64, f64) {
        (10f64.powf(self.log_omega.min), 10f64.powf(self.log_omega.max))
    }

    /// The part of a pane's vertical axis that is in view.
    pub fn value_range(&self, pane: Pane) -> Range {
        match pane {
            Pane::Magnitude => self.magnitude_db,
            Pane::Phase => self.phase_deg,
        }
    }

    /// Where the magnitude plot was drawn last: x is `log10 omega`, y is in dB.
    pub fn magnitude_transform(&self) -> Option<&PlotTransform> {
        self.transform(Pane::Magnitude)
    }

    /// Where the phase plot was drawn last: x is `log10 omega`, y is in degrees.
    pub fn phase_transform(&self) -> Option<&PlotTransform> {
        self.transform(Pane::Phase)
    }

    /// Where a pane was drawn last.
    pub fn transform(&self, pane: Pane) -> Option<&PlotTransform> {
        match pane {
            Pane::Magnitude => self.magnitude_transform.as_ref(),
            Pane::Phase => self.phase_transform.as_ref(),
        }
    }

    /// Where `value` at `omega` \[rad/s\] is on the screen.
    pub fn screen_position(&self, pane: Pane, omega: f64, value: f64) -> Option<Pos2> {
        let transform = self.transform(pane)?;
        Some(transform.position_from_point(&PlotPoint::new(omega.log10(), value)))
    }

    /// What a pane drew last.
    pub(super) fn drawn_curves(&mut self, pane: Pane) -> &mut DrawnCurves {
        match pane {
            Pane::Magnitude => &mut self.magnitude_curves,
            Pane::Phase => &mut self.phase_curves,
        }
    }

    /// The part in view of a pane as egui_plot wants it.
    pub(super) fn bounds(&self, pane: Pane) -> PlotBounds {
        let values = self.value_range(pane);
        PlotBounds::from_min_max([self.log_omega.min, values.min], [self.log_omega.max, values.max])
    }

    /// Takes over what panning and zooming made of a pane, and remembers where it is.
    pub(super) fn take_over(&mut self, pane: Pane, transform: PlotTransform) {
        let (min, max) = (transform.bounds().min(), transform.bounds().max());
        self.set_log_omega(Range::new(min[0], max[0]));
        self.set_values(pane, Range::new(min[1], max[1]));
        match pane {
            Pane::Magnitude => self.magnitude_transform = Some(transform),
            Pane::Phase => self.phase_transform = Some(transform),
        }
    }

    /// Looks `factor` times closer at a pane, with the point under `pointer` staying where it is.
    pub(super) fn zoom(&mut self, pane: Pane, pointer: Pos2, frequency_factor: f64, value_factor: f64) {
        let Some(transform) = self.transform(pane) else { return };
        let fixed = transform.value_from_position(pointer);
        self.set_log_omega(self.log_omega.zoomed(frequency_factor, fixed.x));
        self.set_values(pane, self.value_range(pane).zoomed(value_factor, fixed.y));
    }

    /// Shows what lies in `area` of the screen.
    pub(super) fn zoom_to(&mut self, pane: Pane, area: Rect) {
        let Some(transform) = self.transform(pane) else { return };
        let (a, b) = (transform.value_from_position(area.min), transform.value_from_position(area.max));
        self.set_log_omega(Range::new(a.x, b.x));
        self.set_values(pane, Range::new(a.y, b.y));
    }

    fn set_log_omega(&mut self, range: Range) {
        if let Some(range) = range.limited(DECADES)
            && LOG_OMEGA.contains(range.min)
            && LOG_OMEGA.contains(range.max)
        {
            self.log_omega = range;
        }
    }

    fn set_values(&mut self, pane: Pane, range: Range) {
        let (current, widths) = match pane {
            Pane::Magnitude => (&mut self.magnitude_db, DECIBELS),
            Pane::Phase => (&mut self.phase_deg, DEGREES),
        };
        if let Some(range) = range.limited(widths) {
            *current = range;
        }
    }

    /// Shows all of `curves`, rejected ones included, if that was asked for. Without data the request stays.
    pub(super) fn fit_if_requested(&mut self, curves: &[BodeCurve], band: (f64, f64)) {
        if !self.must_fit {
            return;
        }
        let omega = curves.iter().flat_map(|curve| curve.omega.iter());
        let Some(log_omega) = Range::of(omega.map(|omega| omega.log10())) else {
            return;
        };
        self.must_fit = false;
        // The legend stays where it is while zooming, but makes room for new curves.
        self.legend.corner = None;
        self.set_log_omega(log_omega);
        for (pane, least) in [(Pane::Magnitude, 4.0), (Pane::Phase, 20.0)] {
            if let Some(values) = fitted_values(curves, pane, band) {
                self.set_values(pane, values.with_margin(FIT_MARGIN, least));
            }
        }
    }
}

/// The values to show: all within the band, and outside it as far as they leave room for those within.
fn fitted_values(curves: &[BodeCurve], pane: Pane, (min, max): (f64, f64)) -> Option<Range> {
    let points = || curves.iter().flat_map(|curve| curve.omega.iter().zip(curve.values(pane)));
    let all = Range::of(points().map(|(_, value)| *value))?;
    let within = points().filter(|(omega, _)| (min..=max).contains(*omega));
    let Some(within) = Range::of(within.map(|(_, value)| *value)) else {
        return Some(all);
    };
    let room = within.with_margin(OUTSIDE_PART, 0.0);
    Some(Range::new(all.min.max(room.min), all.max.min(room.max)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::curve::numbered;
    use crate::view::plot::role::Role;

    fn fitted(magnitude_db: &[f64]) -> Option<Range> {
        let curve = BodeCurve {
            id: numbered(0),
            label: String::new(),
            detail: String::new(),
            role: Role::Perturbed,
            rejected: true,
            highlighted: false,
            omega: vec![0.3, 0.5, 1.0, 10.0, 20.0].into(),
            magnitude_db: magnitude_db.into(),
            phase_deg: vec![0.0; 5].into(),
        };
        fitted_values(&[curve], Pane::Magnitude, (0.5, 12.0))
    }

    #[test]
    fn fitting_shows_all_that_is_within_the_band_and_what_is_near_it() {
        assert_eq!(fitted(&[2.0, 0.0, -5.0, -10.0, -12.0]), Some(Range::new(-12.0, 2.0)));
    }

    #[test]
    fn a_peak_outside_the_band_does_not_flatten_what_is_within() {
        assert_eq!(fitted(&[90.0, 0.0, -5.0, -10.0, -12.0]), Some(Range::new(-12.0, 10.0 * OUTSIDE_PART)));
    }

    #[test]
    fn without_values_in_the_band_all_are_shown() {
        assert_eq!(fitted(&[3.0, f64::NAN, f64::NAN, f64::NAN, -50.0]), Some(Range::new(-50.0, 3.0)));
        assert_eq!(fitted(&[f64::NAN; 5]), None);
    }
}
