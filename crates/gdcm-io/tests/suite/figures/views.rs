//! Figures of the views for the example.

use std::collections::BTreeSet;

use gdcm_method::uncertainty::{Scalar, VarianceDecomposition};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::drawing::{Area, Shape};
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::{Mark, Role};
use gdcm_study::results::analysis::NotAssessed;
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::uncertainty::differences_summary;

use super::*;

fn legend(figure: &Figure) -> Vec<String> {
    figure
        .legend()
        .into_iter()
        .map(|entry| entry.text)
        .collect()
}

#[test]
fn the_legend_of_a_bode_figure_names_the_visible_roles() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let figure = example.figure(FigureKind::Bode, vec![pair]);
    let expected = [
        "nominal (rejected)",
        "perturbed",
        "representative",
        "other identified",
        "identified",
        "corrected",
        "scheduled",
        "rejected",
        "comparison band",
        "95 % band",
    ];
    assert_eq!(legend(&figure), expected);
    let hidden = BTreeSet::from([Role::Perturbed, Role::Rejected]);
    let request = FigureRequest {
        bode: BodeOptions {
            hidden,
            ..BodeOptions::default()
        },
        ..FigureRequest::new(FigureKind::Bode, vec![pair], Vec::new())
    };
    let without = legend(&example.request(&request));
    assert!(
        !without
            .iter()
            .any(|text| text == "perturbed" || text == "rejected"),
        "{without:?}"
    );
    assert_eq!(without.len(), expected.len() - 2);
}

#[test]
fn a_figure_names_the_dataset_the_condition_and_the_rejected_models() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Bode, vec![example.pair("Q", "LON")]);
    assert!(
        figure.title.starts_with("LON → Q · Condition 10: 60 kt"),
        "{}",
        figure.title
    );
    for words in [
        example.analysis.study.dataset.name(),
        "0.5 to 12 rad/s, 200 frequencies",
        "Rejected: nominal, ROLL+5deg",
    ] {
        assert!(
            figure.caption.contains(words),
            "{words} is missing in: {}",
            figure.caption
        );
    }
}

#[test]
fn each_on_axis_response_has_a_plot_of_magnitude_and_phase() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Bode, example.on_axis());
    assert_eq!(figure.plots.len(), 5);
    assert!(figure.plots.iter().all(|plot| plot.panels.len() == 2));
    assert_eq!(figure.plots[1].title, "LON → Q");
}

#[test]
fn frequencies_in_hertz_are_those_of_the_curves_divided_by_two_pi() {
    let example = &*EXAMPLE;
    let request = FigureRequest {
        bode: BodeOptions {
            unit: FrequencyUnit::Hertz,
            ..BodeOptions::default()
        },
        ..FigureRequest::new(FigureKind::Bode, vec![example.pair("Q", "LON")], Vec::new())
    };
    let table = example.request(&request).tables().remove(0);
    assert_eq!(table.columns[0], "Frequency [Hz]");
    let first: f64 = table.rows[0][0].parse().unwrap();
    assert_eq!(
        first,
        example.curves.grid.omega()[0] / std::f64::consts::TAU
    );
}

#[test]
fn the_overview_has_every_response_outputs_down_and_inputs_across() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Overview, Vec::new());
    assert_eq!((figure.plots.len(), figure.columns), (24, 4));
    assert_eq!(figure.plots[0].title, "LON → P");
    assert_eq!(figure.plots[4].title, "LON → Q *");
}

#[test]
fn net_gains_have_a_dot_for_each_condition_and_the_schedule() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::NetGain, example.on_axis());
    for plot in &figure.plots {
        let dots = plot.panels[0].marks.iter().filter_map(|mark| match mark {
            Mark::Dots(dots) => Some(dots.dots.len()),
            _ => None,
        });
        assert_eq!(dots.sum::<usize>(), 11);
    }
    assert!(legend(&figure).contains(&"schedule".to_owned()));
}

#[test]
fn delays_of_channels_are_plotted_over_conditions_in_file_order_with_their_bounds() {
    let example = &*EXAMPLE;
    let request = FigureRequest {
        across: Across::Conditions,
        measure: Measure::Delay,
        ..FigureRequest::new(FigureKind::Channels, Vec::new(), example.channels())
    };
    let figure = example.request(&request);
    assert_eq!(figure.plots.len(), 10);
    let names = figure.plots[0].panels[0].x.names.as_ref().unwrap();
    assert_eq!(names[9], (9.0, "10".to_owned()));
    assert!(
        legend(&figure).contains(&"bounds".to_owned())
            && !legend(&figure).contains(&"schedule".to_owned())
    );
    assert_eq!(figure.plots[0].panels[0].y.label, "Delay [ms]");
}

#[test]
fn an_assessment_names_the_condition_left_out_and_the_reason() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Assessment, example.on_axis());
    let why = not_assessed_text(
        &NotAssessed::NominalRejected,
        &example.analysis.study.dataset,
    );
    assert!(
        figure.caption.contains(&why) && figure.caption.contains(" 10 "),
        "{}",
        figure.caption
    );
    let notes = figure.plots[0].panels[0]
        .marks
        .iter()
        .filter(|mark| matches!(mark, Mark::Note(_)));
    assert_eq!(notes.count(), 1);
    assert_eq!(legend(&figure), ["ΔJ", "ΔJ magnitude", "ΔJ phase"]);
}

#[test]
fn the_reference_has_zero_error_and_the_corrected_median_of_a_held_response_is_near_zero() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let table = example
        .figure(FigureKind::Error, vec![pair])
        .tables()
        .remove(0);
    let column = |name: &str| -> Vec<f64> {
        let at = table
            .columns
            .iter()
            .position(|column| column.starts_with(name))
            .unwrap();
        table
            .rows
            .iter()
            .map(|row| row[at].parse().unwrap())
            .collect()
    };
    let source = example.source();
    let reference = source
        .analysis
        .unwrap()
        .representative_name(gdcm_model::dataset::BundleKind::Identified);
    assert!(column(reference).iter().all(|error| *error == 0.0));
    let physics = source
        .analysis
        .unwrap()
        .representative_name(gdcm_model::dataset::BundleKind::Physics);
    let mut errors = column(&format!("{physics}, corrected"));
    // Not exactly zero: the curves have other frequencies than the 200 from which the median was
    // computed.
    assert!(gdcm_model::statistics::median(&mut errors).abs() < 0.02);
}

#[test]
fn evidence_stacks_the_shares_of_each_variance_to_100_percent() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Evidence, example.on_axis());
    let uncertainty = example.analysis.uncertainty.as_ref().unwrap();
    assert_eq!(
        (figure.plots.len(), figure.plots[1].title.as_str()),
        (5, "LON → Q")
    );
    assert!(
        figure
            .caption
            .starts_with(&differences_summary(uncertainty)),
        "{}",
        figure.caption
    );
    let names = [
        "trim",
        "identification",
        "unexplained",
        "unexplained, 90 % interval",
        "scatter",
    ];
    assert_eq!(legend(&figure)[..5], names);
    for (plot, scatter) in figure.plots.iter().zip(&uncertainty.scatter) {
        let bars: Vec<&Bars> = plot.panels[0]
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Bars(bars) => Some(bars),
                _ => None,
            })
            .collect();
        for (place, split) in [&scatter.same_airspeed, &scatter.about_schedule]
            .into_iter()
            .enumerate()
        {
            let shares = split
                .as_ref()
                .and_then(VarianceDecomposition::shares)
                .unwrap();
            let mut foot = 0.0;
            for (bars, share) in bars.iter().zip(shares) {
                assert_eq!(
                    (bars.feet[place], bars.bars[place]),
                    (foot, [place as f64, 100.0 * share])
                );
                foot += 100.0 * share;
            }
            // Rounding of a sum of three quotients with the same denominator.
            assert!((foot - 100.0).abs() < 1e-9, "the shares sum to {foot} %");
        }
    }
}

#[test]
fn the_table_of_evidence_has_the_scatter_about_the_schedule() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Evidence, example.on_axis());
    let split = example.analysis.uncertainty.as_ref().unwrap().scatter[0]
        .about_schedule
        .unwrap();
    let [_, high] = split.unexplained_interval(0.9).unwrap();
    let rows = figure.tables().swap_remove(1).rows;
    let row = |series: &str| {
        rows.iter()
            .find(|row| row[0] == series && row[2] == "schedule")
            .unwrap()
    };
    assert_eq!(
        row("scatter")[3],
        format!("{:?}", 100.0 * split.scatter.sqrt())
    );
    assert_eq!(
        row("unexplained, 90 % interval, upper")[3],
        format!("{:?}", 100.0 * high)
    );
}

#[test]
fn evidence_needs_error_bars_and_an_on_axis_response() {
    let example = &*EXAMPLE;
    let request = FigureRequest::new(FigureKind::Evidence, example.on_axis(), Vec::new());
    let bare = Analysis {
        uncertainty: None,
        ..example.analysis.clone()
    };
    assert_eq!(request.figure(Some(&bare), None), None);
    let off_axis = FigureRequest {
        pairs: vec![example.pair("P", "LON")],
        ..request
    };
    assert_eq!(
        off_axis.figure(Some(&example.analysis), None),
        None,
        "the variance of an off-axis response is not decomposed"
    );
}

/// Returns the text and the area on paper of the condition numbers at dots and of the factors at
/// brackets.
fn labels_on_paper(figure: &Figure, width: ColumnWidth) -> Vec<(String, Area)> {
    let label = |shape: &Shape| match shape {
        Shape::Text(text) if text.color != Color::INK && text.words.len() <= 6 => {
            let length = gdcm_plot::figure::layout::width(&text.words) * text.size_pt;
            // Digits have no descenders.
            let height = 0.74 * text.size_pt;
            Some((
                text.words.clone(),
                Area::new(text.at[0], text.at[1] - height, length, height),
            ))
        }
        _ => None,
    };
    figure
        .drawing(width)
        .shapes
        .iter()
        .filter_map(label)
        .collect()
}

#[test]
fn condition_numbers_and_factors_of_net_gains_do_not_overlap_on_paper() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::NetGain, example.on_axis());
    let uncertainty = example.analysis.uncertainty.as_ref().unwrap();
    let greatest = example
        .on_axis()
        .into_iter()
        .flat_map(|pair| uncertainty.greatest_differences(pair));
    let factors = greatest
        .filter(|difference| difference.is_significant(uncertainty.level))
        .count();
    for width in ColumnWidth::BOTH {
        let labels = labels_on_paper(&figure, width);
        assert_eq!(
            labels
                .iter()
                .filter(|(words, _)| words.ends_with('×'))
                .count(),
            factors,
            "{width:?}"
        );
        assert_eq!(
            labels.len(),
            5 * 11 + factors,
            "every condition of every response should have its number: {width:?}"
        );
        for (index, (words, area)) in labels.iter().enumerate() {
            for (other, beside) in &labels[..index] {
                assert!(
                    area.overlap(beside) < 0.05 * area.size(),
                    "{width:?}: {words} at {area:?} overlaps {other}"
                );
            }
        }
    }
}

#[test]
fn net_gains_on_paper_have_error_bars_and_brackets() {
    let example = &*EXAMPLE;
    let pair = example.pair("NZ", "COL");
    let figure = example.figure(FigureKind::NetGain, vec![pair]);
    let [beyond, within] = [
        "significant difference (n×: n times the expected one)",
        "difference, not significant",
    ];
    let names = [
        "90 % error bar",
        "identification part of the error bar",
        beyond,
        within,
    ];
    assert!(
        names
            .iter()
            .all(|name| legend(&figure).iter().any(|text| text == name)),
        "{:?}",
        legend(&figure)
    );
    let uncertainty = example.analysis.uncertainty.as_ref().unwrap();
    let [low, _] = uncertainty
        .bar(CONDITION, Scalar::NetGain(pair))
        .unwrap()
        .interval(0.9)
        .unwrap();
    let rows = figure.tables().remove(0).rows;
    let lower: Vec<&String> = rows
        .iter()
        .filter(|row| row[0] == "90 % error bar, lower")
        .map(|row| &row[3])
        .collect();
    assert!(
        lower.len() == 11 && lower.contains(&&format!("{:?}", low.exp())),
        "{low} in {lower:?}"
    );
    let bracket: Vec<&Vec<String>> = rows.iter().filter(|row| row[0] == beyond).collect();
    assert!(
        bracket.len() >= 2 && bracket.iter().all(|row| row[1].ends_with('×')),
        "{bracket:?}"
    );
}

#[test]
fn the_quantiles_of_the_error_remain_when_the_curve_of_the_representative_is_hidden() {
    let example = &*EXAMPLE;
    let quantiles = |hidden: &[Role]| {
        let bode = BodeOptions {
            hidden: hidden.iter().copied().collect(),
            ..BodeOptions::default()
        };
        let pairs = vec![example.pair("Q", "LON")];
        let figure = example.request(&FigureRequest {
            bode,
            ..FigureRequest::new(FigureKind::Error, pairs, vec![])
        });
        let table = figure.tables().remove(0);
        let columns: Vec<usize> = (0..table.columns.len())
            .filter(|column| table.columns[*column].contains("quantile"))
            .collect();
        columns
            .iter()
            .map(|column| table.rows[0][*column].clone())
            .collect::<Vec<String>>()
    };
    let shown = quantiles(&[]);
    assert_eq!(shown.len(), 2);
    assert_eq!(quantiles(&[Role::Representative]), shown);
}

/// The values that the figure shows are those of the diagnosis, in the unit of the parameter.
#[test]
fn a_physics_parameter_is_drawn_in_every_condition_with_the_misfit_that_remains() {
    let findings = EXAMPLE.physics.applied.findings.as_ref().unwrap();
    let shown = findings.selected(None).unwrap();
    let parameter = &findings.parameters[shown];
    let diagnosis = &findings.diagnosis;
    let figure = EXAMPLE.figure(FigureKind::Physics, Vec::new());
    let [by_condition, misfit] = &figure.plots[..] else {
        panic!("{} plots", figure.plots.len())
    };
    let mut expected = Vec::new();
    for condition in &diagnosis.conditions {
        let here = condition.z_here[shown].unwrap();
        expected.push(here.z * parameter.plausible_sd);
    }
    let mut drawn: Vec<f64> = by_condition.panels[0].dots().map(|dot| dot.y).collect();
    expected.sort_by(f64::total_cmp);
    drawn.sort_by(f64::total_cmp);
    assert_eq!(drawn, expected);
    let steps = &diagnosis.scores.as_ref().unwrap().stepwise;
    let ratios: Vec<f64> = steps.iter().map(|step| 100.0 * step.score.ratio).collect();
    let remaining: Vec<f64> = misfit.panels[0].dots().map(|dot| dot.y).collect();
    assert_eq!(remaining, ratios);
    assert_eq!(
        remaining[0], 100.0,
        "the misfit without parameters should be 100 %"
    );
}

/// J of the drawn curves, recomputed from its definition (eq. (14) to (19)), equals the J in the
/// title.
#[test]
fn the_drawn_responses_reproduce_the_cost_of_the_changed_parameters() {
    let figure = EXAMPLE.figure(FigureKind::PhysicsChange, Vec::new());
    let effect = &EXAMPLE.physics.conditions[&CONDITION];
    let (poles, responses) = figure.plots.split_last().unwrap();
    assert!(poles.panels[0].dots().count() > 0);
    assert_eq!(responses.len(), 5);
    let mut improvements = Vec::new();
    for (plot, response) in responses.iter().zip(&effect.responses) {
        let cost = response.cost.with;
        improvements.push(response.cost.without - cost);
        let mut expected = 0.0;
        // Weights of eq. (14): 20 for dB^2, 20 * 0.0175 for deg^2.
        for (panel, weight) in plot.panels.iter().zip([20.0, 20.0 * 0.0175]) {
            let identified = curve_named(panel, "identified");
            let moved = curve_named(panel, "physics, parameters changed");
            let errors = identified.y.iter().zip(moved.y.iter());
            let mut squares: Vec<f64> = errors
                .map(|(reference, moved)| {
                    let error = moved - reference;
                    // Whole turns do not count; magnitudes differ by less than half of 360 dB.
                    let error = error - 360.0 * (error / 360.0).round();
                    error * error
                })
                .collect();
            expected += weight * gdcm_model::statistics::median(&mut squares);
        }
        // Relative tolerance: the errors are differences of values up to 1e3, rounded to 1e-13.
        assert!(
            (cost - expected).abs() < 1e-9 * expected.max(1.0),
            "J of the analysis {cost}, of the drawn curves {expected}"
        );
    }
    assert!(improvements[0] > 0.0);
    assert!(improvements.is_sorted_by(|a, b| a >= b));
}

fn curve_named<'a>(panel: &'a Panel, name: &str) -> &'a Curve {
    panel
        .marks
        .iter()
        .find_map(|mark| match mark {
            Mark::Curve(curve) if curve.name == name => Some(curve),
            _ => None,
        })
        .unwrap()
}
