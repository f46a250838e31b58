//! What the views that can be seen need beside the live answer.

use std::sync::Arc;

use gdcm_core::study::{AssessmentJob, ModesJob, UncertaintyJob};

use super::window::GdcmApp;
use super::worker::BackgroundJobs;
use crate::view::arrangement::View;
use crate::view::records::simulation_jobs;
use crate::view::state::State;
use crate::view::views::across_job;
use crate::view::views::assessment_choice;
use crate::view::views::variant_jobs;

impl GdcmApp {
    /// Asks for what the views shown need; what none shows is not computed.
    pub(super) fn want_beside(&mut self) {
        let beside = BackgroundJobs { report: self.reporting.clone(), ..wanted(&self.state) };
        let variants = &beside.variants;
        self.state.results.variants.retain(|(known, _)| variants.contains(known));
        let simulations = &beside.simulations;
        self.state.results.simulations.retain(|(known, _)| simulations.contains(known));
        self.worker.want_beside(beside);
    }
}

fn wanted(state: &State) -> BackgroundJobs {
    let is_shown = |view| state.display.arrangement.is_shown(view);
    let analysis = state.results.analysis.as_ref().filter(|_| state.analysis().is_some());
    let condition = state.dataset().condition(state.condition().id());
    BackgroundJobs {
        modes: condition.filter(|_| is_shown(View::Poles)).map(|of| ModesJob { condition: Arc::clone(of) }),
        assessment: analysis
            .filter(|_| is_shown(View::Assessment))
            .map(|analysis| AssessmentJob { analysis: Arc::clone(analysis), choice: assessment_choice(state) }),
        across: is_shown(View::Across).then(|| across_job(state)),
        uncertainty: analysis
            .filter(|_| !state.results.is_behind())
            .map(|analysis| UncertaintyJob { analysis: Arc::clone(analysis) }),
        report: None,
        identifications: state.records.by_urgency(state.condition().id()),
        simulations: if is_shown(View::Records) { simulation_jobs(state) } else { Vec::new() },
        variants: if is_shown(View::Compare) { variant_jobs(state) } else { Vec::new() },
    }
}
