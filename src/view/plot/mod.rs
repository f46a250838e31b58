//! The plots: each takes a scene and what it remembers of the last frame, and gives back what the engineer did.

mod assessment;
mod axes;
mod band_handle;
mod bar;
mod bar_panel;
mod bode;
mod bode_pane;
mod bode_view;
mod box_zoom;
mod channels;
mod curve;
mod dot;
mod dot_label;
mod gain_group;
mod gain_panel;
mod grid_strength;
mod legend;
mod linear_axis;
mod log_axis;
mod message;
mod net_gain;
mod number;
mod overview;
mod picking;
mod range;
mod readout;
mod role;
mod sparkline;
#[cfg(test)]
mod tests;
mod thinning;
mod tiles;

pub use assessment::{AssessmentEvent, AssessmentScene, AssessmentView, assessment_ui};
pub use bar::{AssessmentBar, AssessmentPanel, BarValue};
pub use bode::{BodeEvent, BodeScene, bode_ui};
pub use bode_view::BodeView;
pub use channels::{ChannelsScene, ChannelsView, channels_ui};
pub use curve::{BodeCurve, CurveId, Pane};
pub use dot::{Dot, DotShape};
pub use gain_group::{GainEvent, GainView};
pub use gain_panel::GainPanel;
pub use log_axis::FrequencyUnit;
pub use net_gain::{NetGainScene, net_gain_ui};
pub use overview::{OverviewCell, OverviewEvent, OverviewScene, OverviewView, overview_ui};
pub use range::Range;
pub use role::{LineLook, Role};
