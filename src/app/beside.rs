//! What the views that can be seen need beside the live answer.

use std::sync::Arc;

use crate::view::arrangement::{Need, View};
use crate::view::state::State;
use gdcm_core::study::UncertaintyJob;

use super::window::GdcmApp;
use super::worker::BackgroundJobs;

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
    let analysis = state.results.analysis.as_ref().filter(|_| state.analysis().is_some());
    let mut wanted = BackgroundJobs {
        uncertainty: analysis
            .filter(|_| !state.results.is_behind())
            .map(|analysis| UncertaintyJob { analysis: Arc::clone(analysis) }),
        identifications: state.records.by_urgency(state.condition().id()),
        ..BackgroundJobs::default()
    };
    let shown = View::ALL.into_iter().filter(|view| state.display.arrangement.is_shown(*view));
    for need in shown.flat_map(|view| (view.kind().needs)(state)) {
        match need {
            Need::Modes(job) => wanted.modes = Some(job),
            Need::Assessment(job) => wanted.assessment = Some(job),
            Need::Across(job) => wanted.across = Some(job),
            Need::Variant(job) => wanted.variants.push(job),
            Need::Simulation(job) => wanted.simulations.push(job),
        }
    }
    wanted
}
