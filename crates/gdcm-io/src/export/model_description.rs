//! Description of an exported model and its accuracy in a single line.
//!
//! It names the parts that are exact and those that are approximated (delays by Padé
//! approximants, leads by Tustin's rule), with the maximum phase error at the band's upper end,
//! then omitted delays, couplings (M16), the price of leads (M15.6), and changes of the physics
//! parameters (M18). The model's *own* delays are those of the physics model; *omitted* delays are
//! in the condition's own correction, but not in the schedule that corrects the model.

use gdcm_model::dataset::StateSpace;
use gdcm_model::units::{number, telling};
use gdcm_study::{Analysis, AssessedCorrection, CouplingCorrection};

use super::exported_model::{ExportedModel, ModelAccuracy, ModelCouplings};

impl ExportedModel {
    /// Describes the model and its accuracy in a single line.
    pub(super) fn words(&self) -> String {
        let price = match &self.price {
            Some(described) => format!("; {}", described.words),
            None => String::new(),
        };
        format!(
            "condition {}, model {}, {} correction: {}{}{}{price}",
            self.condition,
            self.name,
            self.correction,
            self.accuracy_words(),
            self.omitted_delay_words(),
            self.couplings.words()
        ) + &self.physics_words()
    }

    /// Describes the changes of the physics parameters in the model; empty if there are none.
    fn physics_words(&self) -> String {
        if self.contents.physics.is_empty() {
            return String::new();
        }
        format!("; physics model with {}", self.contents.physics.join(", "))
    }

    /// States that delays are omitted, with their phase lag at the band's upper end; empty without
    /// omitted delays.
    fn omitted_delay_words(&self) -> String {
        if self.omitted_delay_deg == 0.0 {
            return String::new();
        }
        let lag_deg = telling(self.omitted_delay_deg, 3);
        let top_rad_s = number(self.band_top_rad_s);
        format!(
            "; the delays of the condition's own correction are left out, which causes a phase \
            error of up to {lag_deg} deg at {top_rad_s} rad/s"
        )
    }

    /// Describes the parts in the model and their accuracy; omitted delays are not mentioned.
    fn accuracy_words(&self) -> String {
        match self.accuracy() {
            ModelAccuracy::SampledLeads => format!(
                "gains and delays exact, lead filters by Tustin's rule, {}",
                self.phase_error_words()
            ),
            ModelAccuracy::ExactLeads => "gains and lead filters exact".to_owned(),
            ModelAccuracy::ExactDelays => "gains and delays exact".to_owned(),
            ModelAccuracy::WithoutDelays => "gains exact, without delays".to_owned(),
            ModelAccuracy::ExactOwnDelays => "gains and the model's own delays exact".to_owned(),
            ModelAccuracy::PadeDelays => self.pade_words("delays"),
            ModelAccuracy::PadeOwnDelays => self.pade_words("the model's own delays"),
        }
    }

    /// Describes Padé approximants for `approximated`.
    fn pade_words(&self, approximated: &str) -> String {
        let exact = if self.lead_states > 0 {
            "gains and lead filters"
        } else {
            "gains"
        };
        format!(
            "{exact} exact, {approximated} by Pade approximants of order {}, {}",
            self.pade_order,
            self.phase_error_words()
        )
    }

    fn phase_error_words(&self) -> String {
        format!(
            "phase error up to {} deg at {} rad/s",
            bound_words(self.approximation_error_deg),
            number(self.band_top_rad_s)
        )
    }
}

/// Formats an upper bound on a phase error \[deg\]; a nonzero bound below 0.001 is given as 0.001.
fn bound_words(error_deg: f64) -> String {
    /// Minimum reported bound \[deg\].
    const LEAST_DEG: f64 = 1e-3;
    let bound_deg = if error_deg > 0.0 {
        error_deg.max(LEAST_DEG)
    } else {
        0.0
    };
    format!("{bound_deg:.3}")
}

/// Names the correction in the description of an exported model.
pub(super) fn correction_words(correction: AssessedCorrection) -> &'static str {
    match correction {
        AssessedCorrection::Scheduled => "scheduled",
        AssessedCorrection::ScheduledWithoutLeads => "scheduled, without leads,",
        AssessedCorrection::ScheduleOfOthers => "the other conditions'",
        AssessedCorrection::Own => "own",
    }
}

impl ModelCouplings {
    /// Returns how couplings enter the physics model `dynamics`. Only in continuous time are its
    /// own delays approximated inside the feedback loop.
    pub(super) fn new(analysis: &Analysis, dynamics: &StateSpace) -> Self {
        let timing = dynamics.timing();
        // Timing that is plain has neither a sample time nor delays.
        let has_pade_delays = !timing.is_plain() && timing.sample_time_s.is_none();
        match (
            analysis.fitted_couplings(),
            analysis.study.settings.couplings,
        ) {
            (None, _) => Self::None,
            (Some(_), CouplingCorrection::MixingAndFeedback) if has_pade_delays => {
                Self::FeedbackAroundDelays
            }
            (Some(_), CouplingCorrection::MixingAndFeedback) => Self::MixingAndFeedback,
            (Some(_), _) => Self::Mixing,
        }
    }

    /// Describes the couplings; empty if there are none.
    fn words(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Mixing => "; mixing included exactly",
            Self::MixingAndFeedback => "; mixing and feedback included exactly",
            Self::FeedbackAroundDelays => {
                "; with mixing and feedback; the model's own delays are inside the loop, as Pade \
                approximants"
            }
        }
    }
}
