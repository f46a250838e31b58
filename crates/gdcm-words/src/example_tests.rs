//! The example of the tests in this crate: the reference dataset, analysed with leads.

use std::sync::{Arc, LazyLock};

use gdcm_study::decisions::setting_table;
use gdcm_study::{Analysis, Engine, PhaseCorrection, Study, Unobserved};

use crate::reference_tests::reference_dataset;

/// Analysis of the reference dataset with leads.
pub(crate) static EXAMPLE: LazyLock<Analysis> = LazyLock::new(|| {
    let mut study = Study::new(Arc::new(reference_dataset()));
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    Engine::default().analyze(&study, &Unobserved).unwrap()
});
