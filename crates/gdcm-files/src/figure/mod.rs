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

mod assessment;
mod axis;
mod bode;
mod condition_source;
mod curve;
mod drawing;
mod error;
mod evidence;
#[expect(clippy::module_inception, reason = "the room is named by what it makes")]
mod figure;
mod gains;
mod label_places;
mod layout;
mod mark;
mod paint;
mod poles;
mod request;
mod responses;
mod role;
mod tables;
mod ticks;

pub use assessment::*;
pub use axis::*;
pub use bode::*;
pub use condition_source::*;
pub use curve::*;
pub use drawing::*;
pub use error::*;
pub use evidence::*;
pub use figure::*;
pub use gains::*;
pub use label_places::*;
pub use layout::*;
pub use mark::*;
pub use paint::*;
pub use poles::*;
pub use request::*;
pub use responses::*;
pub use role::*;
pub use ticks::*;
