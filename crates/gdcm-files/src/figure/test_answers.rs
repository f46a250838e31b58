//! What models answer to a test input over time (M17.2).

use gdcm_core::dataset::Dataset;
use gdcm_core::requirements::TestInputShape;
use gdcm_core::study::{RequirementRole, TestAnswers};
use gdcm_core::units::number;

use super::axis::Axis;
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::Curve;
use super::role::Role;

const INPUT: Stroke = Stroke::solid(Color::of(Hue::Text), 1.2);

/// The role of a requirement among curves.
pub fn curve_role(role: RequirementRole) -> Role {
    match role {
        RequirementRole::Physics => Role::Representative,
        RequirementRole::Corrected => Role::Corrected,
        RequirementRole::Scheduled => Role::Scheduled,
        RequirementRole::Identified => Role::IdentifiedRepresentative,
    }
}

/// The input, then a plot for each output with a curve for each model, over time. Why a model has no curve stands below.
pub fn test_answers_figure(answers: &TestAnswers, dataset: &Dataset) -> Figure {
    let time_s = answers.time_s();
    let input = &dataset.inputs()[answers.input];
    let plot = |label: String, curves: Vec<Curve>| {
        let panel = Panel::new(Axis::linear("time [s]"), Axis::linear(&label).including(0.0));
        Plot::new(label).panel(panel.with_all(curves))
    };
    let moved = Curve::new(&input.name, INPUT, time_s.clone(), answers.signal.clone());
    let moved = plot(format!("{} [{}]", input.name, input.unit), vec![moved]);
    let of_output = |(index, output): (usize, &gdcm_core::dataset::Channel)| {
        // The identified one is wide, and lies below the others.
        let models = answers.models.iter().rev().filter_map(|(role, answer)| Some((*role, answer.as_ref().ok()?)));
        let curves = models.map(|(role, answer)| {
            let values: Vec<f64> = answer.column(index).iter().copied().collect();
            let drawn = curve_role(role);
            Curve::new(role.name(), drawn.line(false), time_s.clone(), values).key(role.name())
        });
        plot(format!("{} [{}]", output.name, output.unit), curves.collect())
    };
    let outputs = dataset.outputs().iter().enumerate().map(of_output);
    let shape = match answers.test.shape {
        TestInputShape::Step => "step",
        TestInputShape::Doublet => "doublet",
    };
    let (size, duration) = (number(answers.test.size), number(answers.test.duration_s));
    let title =
        format!("Condition {}: {shape} of {} by {size} {} for {duration} s", answers.condition, input.name, input.unit);
    let absent = answers.models.iter().filter_map(|(role, answer)| {
        let why = answer.as_ref().err()?;
        Some(format!(" No {} model: {why}.", role.name()))
    });
    let caption = format!("Linear models from rest; there is no flight here.{}", absent.collect::<String>());
    Figure::new(title).caption(caption).columns(2).aspect(0.4).plots(std::iter::once(moved).chain(outputs))
}
