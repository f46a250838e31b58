//! Contents of an export: whether its gains, delays, leads and couplings are scheduled or corrected
//! for each condition alone, and which parts are omitted.
//!
//! The *parts* of a correction are gains, delays, leads and couplings. A part is *own* if it is
//! from each condition's own optimum, *scheduled* if it is from the schedule over airspeed;
//! couplings (M16) count as scheduled, because they are fitted to several conditions together.
//! Physics parameters *move* the physics models that are corrected (M18).

use serde_json::{Value, json};

use gdcm_method::schedule::{Schedule, ScheduleError};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_study::results::schedule_losses::DelayedChannel;
use gdcm_study::{Analysis, AssessedCorrection, PhaseCorrection};
use gdcm_words::coupling_error::coupling_error_text;
use gdcm_words::physics::applied_value_list;
use gdcm_words::schedule::delayed_channel_text;

/// Where a part of an exported correction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartSource {
    Scheduled,
    /// From each condition's own correction.
    Own,
    /// Both: from each condition's own correction, and from the schedule.
    OwnAndScheduled,
    /// The export does not contain the part.
    None,
}

impl PartSource {
    /// Returns the source as written in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Scheduled => "scheduled",
            Self::Own => "own",
            Self::OwnAndScheduled => "own and scheduled",
            Self::None => "none",
        }
    }

    fn scheduled_if(is_scheduled: bool) -> Self {
        if is_scheduled {
            Self::Scheduled
        } else {
            Self::None
        }
    }

    fn own_if(is_own: bool) -> Self {
        if is_own { Self::Own } else { Self::None }
    }

    /// Combines a part's source in the conditions' own corrections (`self`: `Own` or `None`) with
    /// its source in the schedule (`Scheduled` or `None`).
    fn and_scheduled(self, in_schedule: Self) -> Self {
        match (self, in_schedule) {
            (Self::Own, Self::Scheduled) => Self::OwnAndScheduled,
            (Self::None, in_schedule) => in_schedule,
            (in_own, _) => in_own,
        }
    }
}

/// A correction part that an export omits.
#[derive(Clone, Debug, PartialEq)]
pub enum LeftOutPart {
    /// A channel's delays in some conditions' own corrections that the schedule lacks.
    Delay(DelayedChannel),
    /// The scheduled lead filters.
    Leads,
    /// Physics parameters that the study requests but that are unavailable, with the reason.
    Physics(String),
    /// Couplings that the study requests but that are unavailable, with the reason.
    Couplings(String),
}

impl LeftOutPart {
    /// Returns the omitted part's stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Delay(_) => "delay-not-scheduled",
            Self::Leads => "leads-left-out",
            Self::Physics(_) => "physics-left-out",
            Self::Couplings(_) => "couplings-left-out",
        }
    }

    /// Describes the part: "delay of output NX: 5.3 ms in condition 4 (not scheduled)".
    pub fn words(&self, dataset: &Dataset) -> String {
        match self {
            Self::Delay(delayed) => {
                format!("{} (not scheduled)", delayed_channel_text(delayed, dataset))
            }
            Self::Leads => "the lead filters of the schedule".to_owned(),
            Self::Physics(why) => {
                format!("the physics parameters requested by the study ({why})")
            }
            Self::Couplings(why) => format!("the couplings requested by the study ({why})"),
        }
    }
}

/// Where the parts of an export come from, and which are omitted.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportContents {
    pub gains: PartSource,
    pub delays: PartSource,
    pub leads: PartSource,
    /// Mixing and feedback, which are fitted to several conditions together.
    pub couplings: PartSource,
    /// Physics parameter changes in words ("Ixx +4 %"); empty if the physics models are the
    /// dataset's. The other parts are computed for the moved models.
    pub physics: Vec<String>,
    pub left_out: Vec<LeftOutPart>,
}

impl ExportContents {
    /// Returns the contents of the result files: each condition's own correction, and the schedule
    /// if it exists.
    pub fn of_results(analysis: &Analysis) -> Self {
        let own = Self::of_own(analysis);
        let Ok(schedule) = &analysis.schedule else {
            return own;
        };
        let scheduled = Self::of_schedule(analysis, schedule);
        let mut left_out = scheduled.left_out;
        for part in own.left_out {
            if !left_out.contains(&part) {
                left_out.push(part);
            }
        }
        Self {
            gains: own.gains.and_scheduled(scheduled.gains),
            delays: own.delays.and_scheduled(scheduled.delays),
            leads: own.leads.and_scheduled(scheduled.leads),
            couplings: own.couplings,
            physics: own.physics,
            left_out,
        }
    }

    /// Returns the contents of an exported schedule; without a schedule, couplings and physics
    /// parameters can still be present.
    pub fn of_scheduled(analysis: &Analysis) -> Self {
        match &analysis.schedule {
            Ok(schedule) => Self::of_schedule(analysis, schedule),
            Err(_) => Self::of_physics_and_couplings(analysis),
        }
    }

    /// Returns the contents of a file with the corrected models for these conditions.
    ///
    /// 1. Own corrections need no schedule, and omit no delays or leads.
    /// 2. Otherwise the parts are those of the schedule; for a single condition, of a schedule
    ///    fitted to the others if requested.
    /// 3. Omitted delays are only those of these conditions, and only if the schedule has none.
    /// 4. Leads are omitted if requested.
    /// 5. Physics parameters are listed only if they move a model in one of these conditions.
    ///
    /// # Errors
    /// [`ScheduleError`] if the schedule is requested but does not exist.
    pub fn of_models(
        analysis: &Analysis,
        correction: AssessedCorrection,
        conditions: &[ConditionId],
    ) -> Result<Self, ScheduleError> {
        // Steps 1 and 2.
        let mut contents = match (correction, conditions) {
            (AssessedCorrection::Own, _) => {
                return Ok(Self::of_own(analysis).for_conditions(analysis, conditions));
            }
            (AssessedCorrection::ScheduleOfOthers, [condition]) => {
                let schedule = analysis.schedule_without(*condition)?;
                Self::of_schedule(analysis, &schedule)
            }
            _ => {
                let schedule = analysis.schedule.as_ref().map_err(|error| *error)?;
                Self::of_schedule(analysis, schedule)
            }
        };
        // Step 3.
        contents
            .left_out
            .retain(|part| !matches!(part, LeftOutPart::Delay(_)));
        if contents.delays == PartSource::None {
            contents.left_out.extend(
                analysis
                    .delayed_channels(conditions)
                    .into_iter()
                    .map(LeftOutPart::Delay),
            );
        }
        // Step 4.
        if correction == AssessedCorrection::ScheduledWithoutLeads
            && contents.leads != PartSource::None
        {
            contents.leads = PartSource::None;
            contents.left_out.push(LeftOutPart::Leads);
        }
        // Step 5.
        Ok(contents.for_conditions(analysis, conditions))
    }

    /// Returns the contents without the physics parameters if they move no model in these
    /// conditions.
    fn for_conditions(mut self, analysis: &Analysis, conditions: &[ConditionId]) -> Self {
        let is_moved = match analysis.applied_physics() {
            Some(applied) => conditions.iter().any(|id| applied.moved(*id).is_some()),
            None => false,
        };
        if !is_moved {
            self.physics.clear();
        }
        self
    }

    /// Returns the contents of the physics parameter table, which has no correction parts.
    pub fn of_physics(analysis: &Analysis) -> Self {
        let mut contents = Self::of_physics_and_couplings(analysis);
        contents.couplings = PartSource::None;
        contents
            .left_out
            .retain(|part| matches!(part, LeftOutPart::Physics(_)));
        contents
    }

    /// Returns what all exports share: the physics parameters and the couplings that the study
    /// requests, or why they are unavailable. No gains, delays and leads.
    fn of_physics_and_couplings(analysis: &Analysis) -> Self {
        let mut left_out = Vec::new();
        let couplings = match analysis.requested_couplings() {
            Ok(fitted) => PartSource::scheduled_if(fitted.is_some()),
            Err(error) => {
                let why = coupling_error_text(error, &analysis.study.dataset);
                left_out.push(LeftOutPart::Couplings(why));
                PartSource::None
            }
        };
        let physics = match analysis.requested_physics() {
            Ok(Some(applied)) => applied_value_list(applied),
            Ok(None) => Vec::new(),
            Err(failure) => {
                left_out.push(LeftOutPart::Physics(failure.to_string()));
                Vec::new()
            }
        };
        Self {
            gains: PartSource::None,
            delays: PartSource::None,
            leads: PartSource::None,
            couplings,
            physics,
            left_out,
        }
    }

    /// Returns the contents of the conditions' own corrections.
    fn of_own(analysis: &Analysis) -> Self {
        let phase = analysis.study.settings.phase;
        Self {
            gains: PartSource::Own,
            delays: PartSource::own_if(phase != PhaseCorrection::None),
            leads: PartSource::own_if(phase == PhaseCorrection::Lead),
            ..Self::of_physics_and_couplings(analysis)
        }
    }

    /// Returns the contents of a schedule; the delays in the conditions' own corrections count as
    /// omitted if the schedule has none.
    fn of_schedule(analysis: &Analysis, schedule: &Schedule) -> Self {
        let mut contents = Self {
            gains: PartSource::Scheduled,
            delays: PartSource::scheduled_if(schedule.has_delays()),
            leads: PartSource::scheduled_if(schedule.leads.is_some()),
            ..Self::of_physics_and_couplings(analysis)
        };
        contents.left_out.extend(
            analysis
                .unscheduled_delays()
                .into_iter()
                .map(LeftOutPart::Delay),
        );
        contents
    }

    /// Returns the name and source of each part, in the order used in reports.
    pub fn parts(&self) -> [(&'static str, PartSource); 4] {
        [
            ("gains", self.gains),
            ("delays", self.delays),
            ("leads", self.leads),
            ("couplings", self.couplings),
        ]
    }

    /// Describes the parts: "gains scheduled, delays none, leads none, couplings none".
    pub fn words(&self) -> String {
        self.parts()
            .map(|(name, source)| format!("{name} {}", source.word()))
            .join(", ")
    }

    /// Describes each omitted part in words.
    pub fn left_out_words(&self, dataset: &Dataset) -> Vec<String> {
        self.left_out
            .iter()
            .map(|part| part.words(dataset))
            .collect()
    }

    /// Returns lines for a report: "contains: …"; if physics parameters are moved, "valid only for
    /// physics models with …"; then "left out: …" for each omitted part.
    pub fn lines(&self, dataset: &Dataset) -> Vec<String> {
        let mut lines = vec![format!("contains: {}", self.words())];
        if !self.physics.is_empty() {
            lines.push(format!(
                "valid only for physics models with {}",
                self.physics.join(", ")
            ));
        }
        for words in self.left_out_words(dataset) {
            lines.push(format!("left out: {words}"));
        }
        lines
    }

    /// Returns the JSON object that files hold under the key `contains`.
    pub fn json(&self, dataset: &Dataset) -> Value {
        let mut contents = json!({
            "gains": self.gains.word(),
            "delays": self.delays.word(),
            "leads": self.leads.word(),
            "couplings": self.couplings.word(),
            "left_out": self.left_out_words(dataset),
        });
        if !self.physics.is_empty() {
            contents["physics"] = json!(self.physics);
        }
        contents
    }
}
