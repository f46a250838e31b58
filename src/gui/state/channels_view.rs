//! State that the channel plots keep between frames.

use crate::gui::plot::FigureView;

#[derive(Clone, Debug, Default)]
pub struct ChannelsView {
    pub inputs: FigureView,
    pub outputs: FigureView,
}
