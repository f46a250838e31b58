//! Figures that show results, written as SVG, PDF and PNG.
//!
//! **Question answered:** how is a result drawn, on paper and on the screen?
//!
//! | module | contents |
//! |---|---|
//! | [`figure`] | the description of a figure for every view, and its shapes at their places |
//! | [`paper`] | a painted figure as SVG, PDF or PNG |
//!
//! Section numbers (M4, M13.2, ...) are those of the pages listed under
//! [Sections M1 to M18](gdcm_method#sections-m1-to-m18).
//!
//! A figure is made in four steps:
//!
//! 1. **Described** ([`figure::figure`], [`figure::marks`]): plots with panels, axes and marks in
//!    the units of the result. Every view has a function that describes its figure, such as
//!    [`figure::bode::bode_figure`]; nothing in the description depends on paper or screen.
//! 2. **Scaled** ([`figure::axis`]): ranges that are not set are fitted to the marks, ticks are
//!    chosen to suit the length of the axis, and values become fractions of a frame.
//! 3. **Thinned** ([`figure::thinning`]): points that would not be visible are omitted.
//! 4. **Painted**: on paper as a [`figure::drawing::Drawing`], which [`paper`] writes to a file; on
//!    the screen by the window, panel by panel ([`figure::Panel::shapes`]).
//!
//! ```
//! use gdcm_plot::figure::axis::Axis;
//! use gdcm_plot::figure::marks::{Along, Curve};
//! use gdcm_plot::figure::figure::Plot;
//! use gdcm_plot::figure::thinning::{Pixel, thinned};
//! use gdcm_plot::figure::{ColumnWidth, Figure, Panel, Role};
//! use gdcm_plot::paper::svg;
//!
//! // Described: a magnitude that falls by 20 dB per decade.
//! let omega: Vec<f64> = (0..=100).map(|k| 10f64.powf(f64::from(k) / 50.0)).collect();
//! let magnitude_db: Vec<f64> = omega.iter().map(|omega| -20.0 * omega.log10()).collect();
//! let curve = Curve::new("nominal", Role::Nominal.stroke(false), omega, magnitude_db);
//! let panel = Panel::new(
//!     Axis::logarithmic("Frequency [rad/s]"),
//!     Axis::linear("Magnitude [dB]").including(10.0),
//! );
//! let panel = panel.with(curve.clone().key("nominal"));
//!
//! // Axes: frequencies exactly, magnitudes with a margin.
//! assert_eq!(panel.shown(Along::X).max, 100.0);
//! assert!(panel.shown(Along::Y).max > 10.0);
//!
//! // Thinned: a straight line in the units of the screen needs its ends only.
//! let points: Vec<[f64; 2]> = curve.points().map(|[x, y]| [x.log10(), y]).collect();
//! let pixel = Pixel { width: 0.005, tolerance: 0.05 };
//! assert_eq!(thinned(&points, pixel).len(), 2);
//!
//! // Painted on paper.
//! let figure = Figure::new("LON → Q").plot(Plot::new("").panel(panel));
//! let drawing = figure.drawing(ColumnWidth::Single);
//! assert!(svg(&drawing).contains("Magnitude [dB]"));
//! ```
//!
//! Nothing here depends on egui or the file system.

pub mod figure;
pub mod paper;
