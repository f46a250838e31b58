//! Responses of the same model in every condition.

use gdcm_io::embedded_example;
use gdcm_model::dataset::{Band, BundleKind, ModelId};
use gdcm_model::progress::Unobserved;
use gdcm_study::jobs::across_job::AcrossJob;
use gdcm_study::jobs::job::Job;

#[test]
fn absent_models_are_left_out_and_the_others_keep_their_order() {
    let dataset = embedded_example().unwrap().dataset;
    let ids = [2, 0].map(|index| {
        let condition = &dataset.conditions()[index];
        let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
        ModelId::new(condition.id(), BundleKind::Physics, &nominal.name)
    });
    let missing = ModelId::new(ids[0].condition, BundleKind::Physics, "no such model");
    let band = Band::new(0.5, 12.0).unwrap();
    let models = vec![ids[0].clone(), missing, ids[1].clone()];
    let job = AcrossJob {
        moved_dataset: dataset.clone().into(),
        dataset: dataset.into(),
        models,
        couplings: None,
        grid: (band, 5),
    };
    let curves = job.run(&mut (), &Unobserved).unwrap();
    let found: Vec<&ModelId> = curves
        .responses
        .iter()
        .map(|response| &response.model)
        .collect();
    assert_eq!(found, [&ids[0], &ids[1]]);
    let pair = job.dataset.measuring_pairs().marked().next().unwrap();
    assert!(
        curves
            .responses
            .iter()
            .all(|found| found.response.curve(pair).len() == 5 && found.coupled.is_none()),
        "every response has the 5 requested points, and none a coupled response"
    );
}
