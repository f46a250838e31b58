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
fn leads_are_drawn_to_ten_times_the_band_with_the_limit_and_the_price() {
    let mut study = Study::new(embedded_example().expect("it is in the program").dataset);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .expect("the example takes it");
    let mut engine = Engine::default();
    let id = ConditionId(10);
    let analysis = engine
        .analyze(&study, &Unobserved)
        .expect("nothing stops it");
    let grid = (study.settings.band, 20);
    let curves = engine
        .curves(&study.dataset, id, grid, &Unobserved)
        .expect("nothing stops it")
        .expect("curves");
    let shown = analysis.condition(id);
    let source = ConditionSource {
        study: &study,
        analysis: shown,
        schedule: None,
        curves: &curves,
        variant: None,
    };
    let pair = study
        .dataset
        .find_pair("P", "LAT")
        .expect("the example has it");
    let figure = leads_figure(&source, &[pair]);
    assert!(
        figure.plots[0].title.ends_with(" dB at 120 rad/s"),
        "{}",
        figure.plots[0].title
    );
    let panel = &figure.plots[0].panels[0];
    let is_limit = |mark: &Mark| matches!(mark, Mark::Rule(rule) if rule.at == 12.0);
    assert!(panel.marks.iter().any(is_limit));
    let of_both = panel.marks.iter().find_map(|mark| match mark {
        Mark::Curve(curve) if curve.name == study.dataset.pair_name(pair) => curve.points().last(),
        _ => None,
    });
    let [omega, gain_db] = of_both.expect("the curve of both channels");
    let leads = shown
        .and_then(|shown| shown.correction.leads.as_ref())
        .expect("leads");
    let price_db = LeadPrice::new(leads).expect("a price").of_pair_db(pair);
    // Rounding of a power and of a sum of decibels.
    assert!(
        (omega - 120.0).abs() < 1e-9 && (gain_db - price_db).abs() < 1e-9,
        "{omega} {gain_db} {price_db}"
    );
}
