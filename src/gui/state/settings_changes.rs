//! Changes since the settings panel was opened.
//!
//! A settings session lasts while the settings panel is open. It keeps the settings and the
//! analysis from its beginning, with which the present ones are compared.

use std::sync::Arc;

use gdcm_study::decisions::setting::Setting;
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_study::decisions::setting_value::Value;
use gdcm_study::{Analysis, ConditionAnalysis, Edit};

use super::settings_session::SettingsSession;
use super::window_state::State;

impl State {
    /// Begins a session with the present settings, and with the present analysis if it belongs to
    /// them.
    pub fn begin_settings_session(&mut self) {
        let analysis = if self.results.is_behind() {
            None
        } else {
            self.results.analysis.clone()
        };
        self.settings_session = Some(SettingsSession {
            settings: self.study.settings.clone(),
            analysis,
            is_dragged: false,
        });
        self.history.begin_session();
    }

    /// Ends the session; its consecutive changes to settings become one undo step.
    pub fn end_settings_session(&mut self) {
        self.settings_session = None;
        self.history.end_session(&self.study);
    }

    /// Returns whether a setting is being dragged.
    pub fn is_setting_dragged(&self) -> bool {
        match &self.settings_session {
            Some(session) => session.is_dragged,
            None => false,
        }
    }

    /// Returns the settings in the table that have changed in the session, in table order.
    pub fn changed_settings(&self) -> Vec<&'static Setting> {
        let Some(session) = &self.settings_session else {
            return Vec::new();
        };
        SETTINGS
            .into_iter()
            .filter(|setting| {
                setting.value(&session.settings) != setting.value(&self.study.settings)
            })
            .collect()
    }

    /// Returns a setting's value when the panel was opened, if it has changed since.
    pub fn previous_setting(&self, setting: &Setting) -> Option<Value> {
        let session = self.settings_session.as_ref()?;
        let previous = setting.value(&session.settings);
        if previous == setting.value(&self.study.settings) {
            None
        } else {
            Some(previous)
        }
    }

    /// Returns the decisions that restore all settings changed in the session.
    pub fn reverting_edits(&self) -> Vec<Edit> {
        let mut edits = Vec::new();
        for setting in self.changed_settings() {
            if let Some(previous) = self.previous_setting(setting) {
                edits.push(setting.to(previous));
            }
        }
        edits
    }

    /// Returns the analysis with the settings at the time the settings panel was opened; `None` if
    /// the panel is closed, if no setting has changed since, if this analysis was never completed,
    /// or if the dataset has been replaced.
    pub fn previous_analysis(&self) -> Option<&Analysis> {
        let analysis = self.settings_session.as_ref()?.analysis.as_deref()?;
        let is_of_dataset = Arc::ptr_eq(&analysis.study.dataset, &self.study.dataset);
        if !is_of_dataset || self.changed_settings().is_empty() {
            return None;
        }
        Some(analysis)
    }

    /// Returns the displayed condition's result with the settings at the time the settings panel
    /// was opened; `None` in the same cases as [`Self::previous_analysis`], or without a result for
    /// the condition.
    pub fn previous_result(&self) -> Option<&ConditionAnalysis> {
        self.previous_analysis()?.condition(self.condition().id())
    }
}
