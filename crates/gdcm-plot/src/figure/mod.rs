//! Figures: described independently of any screen, and laid out for print.
//!
//! A [`Figure`] has plots side by side, a title, a legend and a caption; a [`Plot`](figure::Plot)
//! has panels below one another; a [`Panel`] has two axes and [marks]. [`Figure::drawing`] lays it
//! out as wide as a journal column, in sizes that are readable in print, and in lines that are
//! distinguishable without colours; [`Figure::tables`] returns its numbers.
//!
//! | files | contents |
//! |---|---|
//! | [`figure`], [`marks`], [`legend`] | describe a figure |
//! | [`axis`], `range`, `ticks`, `display_units` | axes, their ticks and units |
//! | [`role`], `color`, `stroke` | line styles and colours by meaning |
//! | [`request`] | kinds of figures; the figure for a request |
//! | [`drawing`], `area` | shapes and texts on paper |
//! | [`bode`], [`airspeeds`], [`error`], [`gains`], [`gains_on_screen`], [`schedule_cost`], [`assessment`], [`poles`], [`physics`], [`physics_change`], [`leads`], [`requirements`], [`bandwidth_detail`] | a figure for each view |
//! | [`condition_source`], [`responses`] | curves for a condition, from models and corrections |
//! | [`caption_words`] | words for captions |
//! | `airspeed_curves`, `uncertainty_band`, `reference_line`, `error_references` | curves over all conditions, bands and lines about them |
//! | [`layout`], [`letters`], [`label_places`] | places for panels, letters and labels |
//! | [`paint`], `paint_axes`, `paint_marks`, `paint_dots`, `dot_style`, `paint_words` | shapes at their places |
//! | [`thinning`], [`tables`] | omission of invisible points; values of a figure |
//!
//! Every view in the window has a function here that describes its figure, and the command `gdcm
//! figure` calls the same function through [`FigureRequest::figure`].
//!
//! ```
//! use gdcm_plot::figure::axis::Axis;
//! use gdcm_plot::figure::figure::Plot;
//! use gdcm_plot::figure::marks::Curve;
//! use gdcm_plot::figure::{ColumnWidth, Figure, Panel, Role};
//!
//! let omega = [0.5, 1.0, 2.0];
//! let nominal = Curve::new("nominal", Role::Nominal.stroke(false), omega, [3.0, 1.0, -4.0]).key("nominal");
//! let panel = Panel::new(Axis::logarithmic("Frequency [rad/s]"), Axis::linear("Magnitude [dB]")).with(nominal);
//! let figure = Figure::new("LON → Q, condition 10").caption("Simulated data.").plot(Plot::new("LON → Q").panel(panel));
//! assert_eq!(figure.tables()[0].columns, ["Frequency [rad/s]", "nominal [dB]"]);
//! assert_eq!(figure.legend()[0].text, "nominal");
//! // 84 mm are 238 pt.
//! assert_eq!(figure.drawing(ColumnWidth::Single).size[0].round(), 238.0);
//! ```

mod airspeed_curves;
pub mod airspeeds;
mod area;
mod arrow;
pub mod assessment;
pub mod axis;
pub mod bandwidth_detail;
pub mod bode;
mod bode_curve;
mod bode_options;
pub mod caption_words;
mod coherence;
mod color;
mod condition_classes;
pub mod condition_source;
mod cost_change_table;
mod couplings;
mod damping_grid;
mod display_units;
mod dot_style;
pub mod drawing;
pub mod error;
mod error_cache;
mod error_references;
mod evidence;
#[expect(
    clippy::module_inception,
    reason = "the folder and the file of its main type have the same name"
)]
pub mod figure;
mod figure_format;
mod frequency_panels;
mod gain_panel;
mod gain_quantity;
pub mod gains;
pub mod gains_on_screen;
pub mod label_places;
pub mod layout;
pub mod leads;
pub mod legend;
pub mod letters;
pub mod marks;
mod muad;
pub mod paint;
mod paint_axes;
mod paint_dots;
mod paint_marks;
mod paint_words;
pub mod physics;
pub mod physics_change;
mod placed;
mod pole_shift;
pub mod poles;
mod range;
mod reference_line;
pub mod request;
pub mod requirements;
pub mod responses;
pub mod role;
pub mod schedule_cost;
mod stroke;
pub mod tables;
pub mod thinning;
mod ticks;
mod time_histories;
mod uncertainty_band;

pub use axis::Range;
pub use condition_source::ConditionSource;
pub use drawing::Color;
pub use figure::{Figure, Panel};
pub use figure_format::{ColumnWidth, FigureFormat};
pub use gains::all_channels;
pub use marks::Mark;
pub use request::{FigureKind, FigureRequest};
pub use role::Role;
