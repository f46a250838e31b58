//! Analysing a study in a command.

use std::sync::Arc;

use gdcm_study::{Analysis, Edit, Engine, Study};
use gdcm_words::caution::failure_text;

use super::condition_messages::{ConditionMessage, SharedMessage, shared_messages};
use super::failure::Failure;
use super::progress::ProgressReceiver;
use super::study_arguments::StudyArguments;
use super::study_options::apply;
use super::terminal::caution_for;
use crate::executor::Pool;

/// Whether an analysis computes error bars.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ErrorBars {
    Computed,
    Omitted,
}

/// An analysis with the engine that computed it.
pub(super) struct StudyAnalysis {
    pub(super) analysis: Analysis,
    pub(super) engine: Engine,
}

/// Analyses a study as [`analyze_with_progress`] does, with a progress bar on the terminal.
///
/// # Errors
/// No condition has a result, or the analysis was stopped.
pub(super) fn analyze_study(
    study: Study,
    arguments: &StudyArguments,
    bars: ErrorBars,
) -> Result<StudyAnalysis, Failure> {
    analyze_with_progress(study, arguments, bars, ProgressReceiver::Terminal)
}

/// Analyses a study.
///
/// 1. Analyse; if requested, reject the suggested outliers and analyse once more. Outliers suggested
///    by the second analysis are not rejected.
/// 2. With error bars: compute the uncertainty, and the benefit of couplings and physics parameters.
/// 3. Report conditions without a result on standard error.
///
/// # Errors
/// No condition has a result, or the analysis was stopped.
pub(super) fn analyze_with_progress(
    mut study: Study,
    arguments: &StudyArguments,
    bars: ErrorBars,
    receiver: ProgressReceiver<'_>,
) -> Result<StudyAnalysis, Failure> {
    // Step 1.
    let mut engine = Engine::with_executor(Box::new(Pool));
    let bar = receiver.begin("analysing");
    let progress = &*bar;
    let mut analysis = engine.analyze(&study, progress)?;
    if arguments.reject_suggested && reject_suggested(&mut study, &analysis)? {
        analysis = engine.analyze(&study, progress)?;
    }
    // Step 2.
    if bars == ErrorBars::Computed {
        analysis.uncertainty = Some(Arc::new(engine.uncertainty(&analysis, progress)?));
        // No reason is lost below: an assessment fails only where the analysis has no couplings or
        // physics parameters either, and `analysis.couplings` and `analysis.physics` contain why.
        let assessed = engine.assess_couplings(&study, study.settings.couplings, progress)?;
        analysis.coupling_assessment = assessed.and_then(Result::ok);
        let assessed = engine.assess_physics(&study, study.settings.physics, progress)?;
        analysis.physics_assessment = assessed.and_then(Result::ok);
    }
    drop(bar);
    // Step 3.
    report_failed_conditions(&analysis)?;
    Ok(StudyAnalysis { analysis, engine })
}

/// Reports conditions without a result on standard error.
///
/// # Errors
/// No condition has a result.
fn report_failed_conditions(analysis: &Analysis) -> Result<(), Failure> {
    let mut failures = Vec::new();
    for (id, outcome) in &analysis.conditions {
        if let Err(failure) = outcome {
            failures.push((*id, failure));
        }
    }
    let messages = failures.iter().map(|(id, failure)| {
        let text = failure_text(failure, &analysis.study.dataset);
        ConditionMessage::new(*id, failure.code(), text)
    });
    let shared = shared_messages(messages);
    if let Some(first) = shared.first()
        && failures.len() == analysis.conditions.len()
    {
        return Err(Failure::NoResult {
            reason: first.words(),
        });
    }
    for SharedMessage {
        conditions,
        message,
    } in &shared
    {
        caution_for(message.code, conditions, &message.text);
    }
    Ok(())
}

/// Rejects the suggested outliers; returns whether any was not yet rejected.
fn reject_suggested(study: &mut Study, analysis: &Analysis) -> Result<bool, Failure> {
    let before = study.clone();
    for (&condition, outcome) in &analysis.conditions {
        let models = match outcome {
            Ok(result) => result.suggested(),
            Err(_) => Default::default(),
        };
        let edit = Edit::reject_physics(condition, &models);
        apply(study, "--reject-suggested", &edit)?;
    }
    Ok(*study != before)
}
