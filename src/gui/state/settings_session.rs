//! Session of the settings panel: the settings and results at its opening, with which the present
//! ones are compared.

use std::sync::Arc;

use gdcm_study::Analysis;
use gdcm_study::decisions::settings::Settings;

/// Settings and results at the opening of the settings panel.
#[derive(Clone, Debug)]
pub struct SettingsSession {
    pub settings: Settings,
    /// Analysis with these settings; `None` until it is available.
    pub analysis: Option<Arc<Analysis>>,
    /// Whether a setting is being dragged; long computations wait until it rests.
    pub is_dragged: bool,
}
