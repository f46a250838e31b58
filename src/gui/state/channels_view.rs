//! State of the channel plots between frames.

use crate::gui::plot::FigureView;

/// State of the channel plots between frames.
#[derive(Clone, Debug, Default)]
pub struct ChannelsView {
    pub inputs: FigureView,
    pub outputs: FigureView,
}
