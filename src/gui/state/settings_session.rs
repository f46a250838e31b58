//! Settings session: the settings and results from when the panel was opened, with which the
//! present ones are compared.

use std::sync::Arc;

use gdcm_study::Analysis;
use gdcm_study::decisions::settings::Settings;

/// Settings and results from when the settings panel was opened.
#[derive(Clone, Debug)]
pub struct SettingsSession {
    pub settings: Settings,
    /// Analysis with these settings; `None` until it is available.
    pub analysis: Option<Arc<Analysis>>,
    /// Whether a setting is being dragged; long computations wait until it rests.
    pub is_dragged: bool,
}
