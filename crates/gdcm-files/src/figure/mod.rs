//! Figures: what plots show, apart from any screen, laid out on paper to be printed.
//!
//! A [`Figure`] has plots side by side, a title, a legend and a caption; a [`Plot`] has panels above one another; a [`Panel`] has
//! two axes and marks. [`Figure::drawing`] lays it out at the width of a journal's column, in sizes that can be read in print, and
//! in lines that differ without their colours; [`Figure::tables`] are its numbers. Every view of the window has a function here that
//! makes its figure, and the command `gdcm figure` calls the same.
//!
//! ```
//! use gdcm_files::figure::{Axis, ColumnWidth, Curve, Figure, Panel, Plot, Role};
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

mod airspeeds;
mod assessment;
mod axis;
mod bode;
mod condition_source;
mod drawing;
mod error;
mod evidence;
#[expect(clippy::module_inception, reason = "the room is named by what it makes")]
mod figure;
mod format;
mod gains;
mod label_places;
mod layout;
mod legend;
mod letters;
mod mark;
pub mod number;
mod numbers;
mod overview;
mod paint;
mod panel;
mod poles;
pub mod range;
mod reading;
mod request;
mod role;
mod simplify;
mod stroke;
mod ticks;

pub use airspeeds::airspeeds_figure;
pub use assessment::assessment_figure;
pub use axis::{Axis, Scale};
pub use bode::{BodeOptions, bode_figure};
pub use condition_source::{ConditionSource, CurveId};
pub use drawing::{Anchor, Area, Drawing, PT_PER_MM, Shape, Text};
pub use error::error_figure;
pub use evidence::evidence_figure;
pub use figure::{ColumnWidth, Figure, Shared};
pub use format::FigureFormat;
pub use gains::{
    Across, Classes, Measure, all_channels, channels_figure, is_scheduled, net_gain_figure, scheduled_samples,
};
pub use label_places::{LabelPlace, LabelledDot, Surroundings, place_labels};
pub use legend::{Entry, Sample};
pub use letters::{FONTS, Letter, letters, width};
pub use mark::{
    Along, Band, Bars, Bracket, Brackets, Curve, Dot, DotShape, Dots, Guide, Intervals, Mark, Note, Place, Rule, Spans,
};
pub use overview::overview_figure;
pub use panel::{Panel, Plot};
pub use poles::poles_figure;
pub use range::Range;
pub use reading::{FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
pub use request::{FigureKind, FigureRequest};
pub use role::{AMBER, BLUE, GREEN, GREY, RED, Role};
pub use stroke::{Color, Dash, Stroke};
pub use ticks::{degree_step, step_above};
