//! The export dialog: its choices and typed texts, and its dry run, which computes every file
//! without writing any. `export_plan.rs` says when a dry run is requested.
//!
//! A plan ([`ExportPlan`]) is the outcome of a dry run: every file with its contents or the reason
//! why it cannot be written, and notes on what the files omit or approximate. A remedy, offered
//! beside a note, removes or reduces what the note states.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gdcm_io::export::export_set::{ExistingNames, ExportPlan, ExportSet, proposed_prefix};
use gdcm_io::export::{ExportRequest, ExportSource, ExportedRole};
use gdcm_io::report::Report;
use gdcm_io::user_paths::at_home;
use gdcm_method::correction::Pade;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::six_digits;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::decisions::export_choices::ExportChoices;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::export_note::ExportRemedy;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{Analysis, AssessedCorrection};

use super::report_contents::{ReportContentsJob, ReportInputs};
use crate::message::Message;

/// Name for the report among the dialog's formats.
pub const REPORT: &str = "report";

/// Dry run before an export.
#[derive(Clone, Debug)]
pub struct ExportPlanJob {
    pub analysis: Arc<Analysis>,
    /// Error bars from the analysis, as far as they are computed.
    pub uncertainty: Option<Arc<Uncertainty>>,
    pub source: ExportSource,
    pub set: ExportSet,
    /// Number of failed attempts to write ([`ExportForm::revision`]). Another number makes the job
    /// differ from the previous one, so that the dry run is repeated.
    pub revision: u64,
}

impl PartialEq for ExportPlanJob {
    fn eq(&self, other: &Self) -> bool {
        let has_same_bars = match (&self.uncertainty, &other.uncertainty) {
            (Some(bars), Some(others)) => Arc::ptr_eq(bars, others),
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.analysis, &other.analysis)
            && has_same_bars
            && self.source == other.source
            && self.set == other.set
            && self.revision == other.revision
    }
}

impl Job for ExportPlanJob {
    type Tools = ();
    type Output = ExportPlan;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<ExportPlan, Cancelled> {
        let analysis = Analysis {
            uncertainty: self.uncertainty.clone(),
            ..Analysis::clone(&self.analysis)
        };
        self.set.dry_run(&analysis, &self.source, progress)
    }
}

/// Contents of the export dialog.
#[derive(Debug, Default)]
pub struct ExportForm {
    /// Choices, without the typed texts.
    pub choices: ExportChoices,
    /// Whether the choices are stored in the study.
    pub remembers: bool,
    /// Typed folder.
    pub folder: String,
    /// Typed prefix for the file names.
    pub prefix: String,
    /// Typed airspeeds for the tables \[kt\].
    pub breakpoints: String,
    /// Airspeeds \[kt\] in the scheduled conditions, which tables have by default.
    pub default_breakpoints_kt: Vec<f64>,
    /// Directory that replaces `~` in the folder.
    pub home: Option<PathBuf>,
    /// Origin of the corrections, stated in the files.
    pub source: Option<ExportSource>,
    /// Index of the file whose head is shown.
    pub selected: usize,
    /// Outcome of the newest dry run, with its job.
    pub plan: Option<(ExportPlanJob, ExportPlan)>,
    /// Inputs of the report, if it is among the files.
    pub report_inputs: Option<Arc<ReportInputs>>,
    /// The composed report, with its job.
    pub report: Option<(ReportContentsJob, Arc<Report>)>,
    /// Number of failed attempts to write; each requires a new dry run, because files in the folder
    /// may have changed.
    pub revision: u64,
    /// Whether the files are written as soon as the requested dry run has ended.
    pub is_awaited: bool,
    /// Why the last attempt failed.
    pub error: Option<Message>,
}

impl ExportForm {
    /// Creates the form with the choices made for the last export; the folder and the prefix are
    /// proposed where the study has none.
    pub fn new(
        choices: &ExportChoices,
        dataset: &Dataset,
        proposed_folder: &str,
        proposed_name: &str,
    ) -> Self {
        let mut choices = choices.clone();
        // Drop conditions that the dataset lacks; if none remain, or all, choose every condition.
        if let Some(conditions) = &mut choices.conditions {
            conditions.retain(|id| dataset.condition(*id).is_some());
            if conditions.len() == dataset.conditions().len() || conditions.is_empty() {
                choices.conditions = None;
            }
        }
        Self {
            remembers: true,
            folder: choices
                .folder
                .clone()
                .unwrap_or_else(|| proposed_folder.to_owned()),
            prefix: choices
                .prefix
                .clone()
                .unwrap_or_else(|| proposed_prefix(proposed_name)),
            breakpoints: match &choices.breakpoints_kt {
                Some(airspeeds_kt) => airspeeds_words(airspeeds_kt),
                None => String::new(),
            },
            choices,
            ..Self::default()
        }
    }

    /// Returns the choices with the typed texts, to be stored in the study; breakpoints that cannot
    /// be read are omitted.
    pub fn all_choices(&self) -> ExportChoices {
        ExportChoices {
            breakpoints_kt: self.breakpoints_kt().unwrap_or_default(),
            folder: Some(self.folder.trim().to_owned()),
            prefix: Some(self.prefix.trim().to_owned()),
            ..self.choices.clone()
        }
    }

    /// Returns the chosen conditions.
    pub fn chosen(&self, dataset: &Dataset) -> BTreeSet<ConditionId> {
        match &self.choices.conditions {
            Some(conditions) => conditions.clone(),
            None => dataset.ids().collect(),
        }
    }

    pub fn switch_condition(&mut self, id: ConditionId, dataset: &Dataset) {
        let mut chosen = self.chosen(dataset);
        if !chosen.remove(&id) {
            chosen.insert(id);
        }
        self.choose(chosen, dataset);
    }

    /// Chooses these conditions; every condition is stored as `None`.
    pub fn choose(&mut self, chosen: BTreeSet<ConditionId>, dataset: &Dataset) {
        self.choices.conditions = if chosen.len() == dataset.conditions().len() {
            None
        } else {
            Some(chosen)
        };
    }

    pub fn switch_format(&mut self, name: &str) {
        if !self.choices.formats.remove(name) {
            self.choices.formats.insert(name.to_owned());
        }
    }

    /// Returns the typed airspeeds \[kt\]; `None` if none are typed, or those of the scheduled
    /// conditions.
    ///
    /// # Errors
    /// A message if they are not increasing numbers.
    pub fn breakpoints_kt(&self) -> Result<Option<Vec<f64>>, Message> {
        let mut airspeeds_kt: Vec<f64> = Vec::new();
        for word in self.breakpoints.split([' ', ',', ';']) {
            if word.is_empty() {
                continue;
            }
            match word.parse::<f64>() {
                Ok(airspeed_kt) if airspeed_kt.is_finite() => airspeeds_kt.push(airspeed_kt),
                _ => {
                    let text = format!("breakpoints: expected airspeeds in kt, found \"{word}\"");
                    return Err(Message::new("breakpoints", text));
                }
            }
        }
        if airspeeds_kt.is_empty() || airspeeds_kt == self.default_breakpoints_kt {
            return Ok(None);
        }
        if airspeeds_kt.windows(2).any(|pair| pair[0] >= pair[1]) {
            let text = "breakpoints: the airspeeds must increase, as in 40 60 80";
            return Err(Message::new("breakpoints", text));
        }
        Ok(Some(airspeeds_kt))
    }

    /// Adds an airspeed \[kt\] to the typed ones, or to the default ones if none are typed or the
    /// typed text cannot be read.
    pub fn add_breakpoint(&mut self, airspeed_kt: f64) {
        let mut airspeeds_kt = match self.breakpoints_kt() {
            Ok(Some(airspeeds_kt)) => airspeeds_kt,
            _ => self.default_breakpoints_kt.clone(),
        };
        airspeeds_kt.push(airspeed_kt);
        airspeeds_kt.sort_by(f64::total_cmp);
        airspeeds_kt.dedup();
        self.breakpoints = airspeeds_words(&airspeeds_kt);
    }

    /// Applies a remedy that changes the export; returns false for a remedy that changes the study
    /// instead, which the caller applies.
    pub fn apply_remedy(&mut self, remedy: ExportRemedy) -> bool {
        match remedy {
            ExportRemedy::AddBreakpoint { airspeed_kt } => self.add_breakpoint(airspeed_kt),
            ExportRemedy::UsePadeOrder { order } => self.choices.pade_order = order,
            ExportRemedy::IncludeAllConditions => self.choices.conditions = None,
            ExportRemedy::ScheduleDelays | ExportRemedy::SignedDelaysOverAirspeed => return false,
        }
        true
    }

    /// Returns the folder as a path, with `~` replaced by the home directory.
    pub fn folder_path(&self) -> PathBuf {
        at_home(Path::new(self.folder.trim()), self.home.as_deref())
    }

    /// Drops the bytes of the dry run and of the report.
    pub fn drop_contents(&mut self) {
        self.plan = None;
        self.report_inputs = None;
        self.report = None;
    }

    /// Returns the composed report of an analysis; `None` until it is composed.
    pub fn report_of(&self, analysis: &Arc<Analysis>) -> Option<&Arc<Report>> {
        let (job, report) = self.report.as_ref()?;
        let inputs = self.report_inputs.as_ref()?;
        if Arc::ptr_eq(&job.inputs, inputs) && Arc::ptr_eq(&inputs.shown, analysis) {
            Some(report)
        } else {
            None
        }
    }

    /// Adds the notes of the report to those of the dry run, once both are known.
    pub fn join_report_notes(&mut self) {
        let Some((job, _)) = &self.plan else {
            return;
        };
        let Some(report) = self.report_of(&job.analysis).map(Arc::clone) else {
            return;
        };
        if let Some((_, plan)) = &mut self.plan
            && plan.report.is_some()
        {
            plan.add_report_notes(&report.notes);
        }
    }

    /// Returns whether the report is among the files.
    pub fn has_report(&self) -> bool {
        self.choices.formats.contains(REPORT)
    }

    /// Returns the files that the choices request, as an export set: formats, folder, names and
    /// contents.
    ///
    /// # Errors
    /// The first that is missing or wrong: a format or the report; the folder; the prefix, which
    /// may not contain a folder; a condition, if a format needs one; the Padé order; the
    /// breakpoints.
    pub fn export_set(&self) -> Result<ExportSet, Message> {
        let names = self.choices.formats.iter().map(String::as_str);
        let (formats, has_checksums) = ExportSet::formats_named(names);
        if formats.is_empty() && !self.has_report() {
            return Err(Message::new("no-format", "choose a format"));
        }
        if self.folder.trim().is_empty() {
            return Err(Message::new("no-folder", "choose a folder"));
        }
        if self.prefix.contains(['/', '\\']) {
            let text = format!(
                "file prefix: expected a name without / or \\, found \"{}\"; the folder belongs in \
                the field Folder",
                self.prefix
            );
            return Err(Message::new("prefix-with-folder", text));
        }
        // The formats with this option write files for each condition.
        let needs_conditions = formats
            .iter()
            .any(|format| format.options.contains(&"--condition"));
        let has_none = self
            .choices
            .conditions
            .as_ref()
            .is_some_and(BTreeSet::is_empty);
        if needs_conditions && has_none {
            return Err(Message::new("no-condition", "choose a condition"));
        }
        let Some(pade) = Pade::new(self.choices.pade_order) else {
            let text = "the Padé order must be from 1 to 8";
            return Err(Message::new("pade-order", text));
        };
        Ok(ExportSet {
            formats,
            has_checksums,
            has_report: self.has_report(),
            folder: self.folder_path(),
            prefix: self.prefix.trim().to_owned(),
            existing: if self.choices.replaces {
                ExistingNames::Ignore
            } else {
                ExistingNames::Number
            },
            request: ExportRequest {
                breakpoints_kt: self.breakpoints_kt()?,
                conditions: self.choices.conditions.clone(),
                role: ExportedRole::from_name(&self.choices.model),
                correction: if self.choices.per_condition {
                    AssessedCorrection::Own
                } else {
                    AssessedCorrection::Scheduled
                },
                pade,
                ..ExportRequest::default()
            },
        })
    }
}

/// Formats airspeeds \[kt\] for the text field, for example "45 60 90".
pub fn airspeeds_words(airspeeds_kt: &[f64]) -> String {
    let words: Vec<String> = airspeeds_kt.iter().map(|kt| six_digits(*kt)).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(breakpoints: &str) -> ExportForm {
        ExportForm {
            breakpoints: breakpoints.to_owned(),
            default_breakpoints_kt: vec![45.0, 60.0, 90.0],
            ..ExportForm::default()
        }
    }

    #[test]
    fn typed_airspeeds_are_those_of_the_conditions_or_others() {
        assert_eq!(form("").breakpoints_kt(), Ok(None));
        assert_eq!(form("45 60 90").breakpoints_kt(), Ok(None));
        assert_eq!(form("45, 60").breakpoints_kt(), Ok(Some(vec![45.0, 60.0])));
        for wrong in ["60 45", "45 x", "45 NaN"] {
            let code = form(wrong).breakpoints_kt().map_err(|message| message.code);
            assert_eq!(code, Err("breakpoints"), "{wrong}");
        }
    }

    #[test]
    fn an_offered_airspeed_joins_those_of_the_conditions() {
        let mut form = form("");
        assert!(form.apply_remedy(ExportRemedy::AddBreakpoint { airspeed_kt: 75.0 }));
        assert_eq!(form.breakpoints, "45 60 75 90");
        assert!(!form.apply_remedy(ExportRemedy::ScheduleDelays));
    }
}
