//! Display options for poles, zeros and modes.

use super::modes_cache::CachedModes;
use crate::gui::widgets::tables::Sorting;

/// Display options of the pole view.
#[derive(Debug, Default)]
pub struct PolesDisplay {
    /// Whether zeros of the focused response are shown among the poles.
    pub show_zeros: bool,
    /// Modes and zeros, cached between frames.
    pub modes: CachedModes,
    pub modes_sorting: Sorting,
}
