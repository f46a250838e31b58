//! Figures of leads.

use gdcm_io::embedded_example;
use gdcm_method::correction::LeadPrice;
use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::Unobserved;
use gdcm_plot::figure::leads::leads_figure;
use gdcm_plot::figure::{ConditionSource, Mark};
use gdcm_study::decisions::setting_table;
use gdcm_study::{Engine, PhaseCorrection, Study};

#[test]
fn leads_are_drawn_to_ten_times_the_end_of_the_band_with_their_limit_and_price() {
    let mut study = Study::new(
        embedded_example()
            .expect("the embedded example should load")
            .dataset,
    );
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .expect("the setting should be accepted");
    let mut engine = Engine::default();
    let id = ConditionId(10);
    let analysis = engine
        .analyze(&study, &Unobserved)
        .expect("the computation should not be cancelled");
    let grid = (study.settings.band, 20);
    let curves = engine
        .curves(&study.dataset, id, grid, &Unobserved)
        .expect("the computation should not be cancelled")
        .expect("the condition should have curves");
    let condition = analysis.condition(id);
    let source = ConditionSource {
        study: &study,
        analysis: condition,
        schedule: None,
        curves: &curves,
        variant: None,
    };
    let pair = study
        .dataset
        .find_pair("P", "LAT")
        .expect("the example should have LAT → P");
    let figure = leads_figure(&source, &[pair]);
    // The band ends at 12 rad/s; the leads are drawn to ten times that frequency.
    assert!(
        figure.plots[0].title.ends_with(" dB at 120 rad/s"),
        "{}",
        figure.plots[0].title
    );
    let panel = &figure.plots[0].panels[0];
    let is_limit = |mark: &Mark| matches!(mark, Mark::Rule(rule) if rule.at == 12.0);
    assert!(panel.marks.iter().any(is_limit));
    let total = panel.marks.iter().find_map(|mark| match mark {
        Mark::Curve(curve) if curve.name == study.dataset.pair_name(pair) => curve.points().last(),
        _ => None,
    });
    let [omega, gain_db] = total.expect("the curve of both channels should be drawn");
    let leads = condition
        .and_then(|condition| condition.correction.leads.as_ref())
        .expect("the correction should have leads");
    let price_db = LeadPrice::new(leads)
        .expect("the leads should have a price")
        .of_pair_db(pair);
    // Rounding of a power and of a sum of decibels.
    assert!(
        (omega - 120.0).abs() < 1e-9 && (gain_db - price_db).abs() < 1e-9,
        "the curve ends at {omega} rad/s, {gain_db} dB; expected 120 rad/s, {price_db} dB"
    );
}
