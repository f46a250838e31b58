//! The plots between the side panels, each with its header: what is drawn, and which commands its events stand for.

mod across;
mod assessment;
mod bode;
mod channels;
mod compare;
mod error;
mod evidence;
mod frequency;
mod net_gain;
mod overview;
mod poles;

pub use across::{across_header_ui, across_view_ui};
pub use assessment::{assessment_header_ui, assessment_view_ui};
pub use bode::bode_view_ui;
pub use channels::{channels_header_ui, channels_view_ui};
pub use compare::compare_view_ui;
pub use error::{error_header_ui, error_view_ui};
pub use evidence::evidence_view_ui;
pub use net_gain::{NET_GAIN_CONTROLS, net_gain_header_ui, net_gain_view_ui};
pub use overview::overview_view_ui;
pub use poles::{poles_header_ui, poles_view_ui};
