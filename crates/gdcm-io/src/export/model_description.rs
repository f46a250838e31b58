//! Description of an exported model and its accuracy in a single line.

use gdcm_model::dataset::StateSpace;
use gdcm_model::units::{number, telling};
use gdcm_study::{Analysis, AssessedCorrection, CouplingCorrection};

use super::exported_model::ExportedModel;
use crate::files::export_contents::PartSource;

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
            self.delay_words(),
            self.left_out_words(),
            self.couplings
        ) + &self.physics_words()
    }

    /// Describes the changes of the physics parameters in the model; empty without any.
    fn physics_words(&self) -> String {
        if self.contents.physics.is_empty() {
            return String::new();
        }
        format!("; physics model with {}", self.contents.physics.join(", "))
    }

    /// Describes the omitted delays of the condition's own correction, and their phase lag at the
    /// upper end of the band; empty without omitted delays.
    fn left_out_words(&self) -> String {
        if self.left_out_deg == 0.0 {
            return String::new();
        }
        let left_out = telling(self.left_out_deg, 3);
        let top = number(self.band_top_rad_s);
        format!(
            "; the delays of the condition's own correction are left out, which causes a phase \
            error of up to {left_out} deg at {top} rad/s"
        )
    }

    /// Describes the parts in the model and their accuracy; omitted delays are not mentioned.
    ///
    /// A part is exact unless it is approximated: in discrete time (`pade_order` 0), lead filters
    /// by Tustin's rule; in continuous time, delays by Padé approximants.
    fn delay_words(&self) -> String {
        let has_delays = self.contents.delays != PartSource::None;
        let has_leads = self.lead_states > 0;
        if self.pade_order == 0 && has_leads {
            return format!(
                "gains and delays exact, lead filters by Tustin's rule, phase error up to {} deg at {} rad/s",
                bound_words(self.approximation_error_deg),
                number(self.band_top_rad_s)
            );
        }
        if has_leads && self.delay_states == 0 {
            return "gains and lead filters exact".to_owned();
        }
        if self.pade_order == 0 || self.delay_states == 0 {
            let words = match (has_delays, self.delay_states) {
                (true, _) => "gains and delays exact",
                (false, 0) => "gains exact, without delays",
                // In discrete time, the model's own delays are whole samples, and therefore exact.
                (false, _) => "gains and the model's own delays exact",
            };
            return words.to_owned();
        }
        let exact = if has_leads {
            "gains and lead filters"
        } else {
            "gains"
        };
        let approximated = if has_delays {
            "delays"
        } else {
            "the model's own delays"
        };
        format!(
            "{exact} exact, {approximated} by Pade approximants of order {}, phase error up to {} deg at {} rad/s",
            self.pade_order,
            bound_words(self.approximation_error_deg),
            number(self.band_top_rad_s)
        )
    }
}

/// Formats an upper bound on a phase error \[deg\]; a nonzero bound below 0.001 is given as 0.001.
fn bound_words(error_deg: f64) -> String {
    /// Minimum reported bound.
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
        AssessedCorrection::ScheduleOfOthers => "of the other conditions",
        AssessedCorrection::Own => "own",
    }
}

/// Describes the couplings in a model; empty if there are none.
pub(super) fn couplings_words(analysis: &Analysis, dynamics: &StateSpace) -> &'static str {
    let has_delays =
        !StateSpace::timing(dynamics).is_plain() && dynamics.timing().sample_time_s.is_none();
    match (
        analysis.fitted_couplings(),
        analysis.study.settings.couplings,
    ) {
        (None, _) => "",
        (Some(_), CouplingCorrection::MixingAndFeedback) if has_delays => {
            "; with mixing and feedback; the model's own delays are inside the loop, as Pade \
            approximants"
        }
        (Some(_), CouplingCorrection::MixingAndFeedback) => "; with mixing and feedback, exact",
        (Some(_), _) => "; with mixing, exact",
    }
}
