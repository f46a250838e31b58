//! Requirements: phase delay over bandwidth for every attitude response (M17.1), with the
//! engineer's level boundaries.
//!
//! The *bandwidth* is the frequency up to which an attitude response leaves a phase margin of 45°
//! and, if the stick commands a rate, a gain margin of 6 dB. The *phase delay* says how fast its
//! phase falls beyond −180°. Flight has not judged the model where they are read above the band.

use gdcm_method::requirements::LevelBoundaries;
use gdcm_method::requirements::level_boundary::LevelBoundary;
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::units::s_to_ms;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;

pub use super::time_histories::{quantity_figure, record_history_figure, test_answers_figure};

use super::arrow::{arrow, spans};
use super::axis::Axis;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Dot, DotShape, Dots, Envelope, Intervals, Mark, MarkId};

/// Arrow from a condition's physics model to its corrected model.
pub(super) const ARROW: Stroke = Stroke::solid(Color::DIM.tint(70), 0.7);
/// Interval of a bandwidth or a phase delay.
const INTERVAL: Stroke = Stroke::solid(Color::DIM, 0.7);
/// Boundary between levels.
const LEVEL: Stroke = Stroke::dashed(Color::new(Hue::Warning), 1.0, Dash::Short);
/// Upper end of shaded areas \[ms\], above every drawn phase delay.
pub(super) const BEYOND_MS: f64 = 1e4;
/// Strength \[%\] in the widest shaded area; each narrower area is stronger by as much.
const BEYOND_TINT: usize = 12;
/// Maximum strength \[%\] in a shaded area.
const MOST_BEYOND_TINT: usize = 48;
/// Strength \[%\] for a dot whose bandwidth or phase delay depends on the model above the band.
const DEPENDENT_TINT: u8 = 45;

/// Name of the bandwidth in a finding's intervals.
const BANDWIDTH: &str = "omega_bw_rad_s";
/// Name of the phase delay in a finding's intervals.
const PHASE_DELAY: &str = "phase_delay_s";

/// Returns a response's position in the plot: bandwidth \[rad/s\] and phase delay \[ms\]; `None`
/// unless both are defined.
pub fn bandwidth_place(finding: &BandwidthFinding) -> Option<[f64; 2]> {
    let omega_bw_rad_s = finding.omega_bw_rad_s?;
    let phase_delay_s = finding.phase_delay_s?;
    Some([omega_bw_rad_s, s_to_ms(phase_delay_s)])
}

/// Returns the responses with a bandwidth and a phase delay in any condition, without duplicates.
pub fn bandwidth_pairs(requirements: &Requirements) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    for finding in &requirements.bandwidth {
        if bandwidth_place(finding).is_some() && !pairs.contains(&finding.pair) {
            pairs.push(finding.pair);
        }
    }
    pairs
}

/// Plots phase delay over bandwidth for each attitude response: a dot for each condition and model,
/// an arrow from the physics model to the corrected model, available intervals, and the engineer's
/// levels. Dots are pale if the bandwidth or the phase delay depends on the model above the band.
pub fn requirements_figure(
    requirements: &Requirements,
    dataset: &Dataset,
    levels: &LevelBoundaries,
) -> Figure {
    let mut plots = Vec::new();
    for pair in bandwidth_pairs(requirements) {
        let output = &dataset.outputs()[pair.output].name;
        let findings = PairFindings { requirements, pair };
        let x = Axis::linear("bandwidth [rad/s]");
        let y = Axis::linear("phase delay [ms]").including(0.0);
        let panel = Panel::new(x, y)
            .with_all(areas_beyond(levels, output))
            .with_all(boundaries(levels, output))
            .with_all(findings.marks());
        let title = format!("{}: attitude", dataset.pair_name(pair));
        plots.push(Plot::new(title).panel(panel));
    }
    let level = 100.0 * requirements.interval_level;
    let caption = format!(
        "Bars: {level:.0} % intervals. Pale dots: the value depends on the model above the band. \
        Arrows: from the physics model to the corrected model of a condition. These values are not \
        a qualification."
    );
    Figure::new("Bandwidth and phase delay")
        .caption(caption)
        .columns(2)
        .aspect(0.66)
        .plots(plots)
}

/// Shades the areas beyond an output's level boundaries (lower bandwidth, higher phase delay), wide
/// areas first and narrow areas darker; an area is wider if its boundary starts at a higher
/// bandwidth. A boundary whose bandwidths do not ascend is not shaded.
pub(super) fn areas_beyond(levels: &LevelBoundaries, output: &str) -> Vec<Envelope> {
    let mut rising: Vec<&LevelBoundary> = levels
        .for_output(output)
        .filter(|boundary| boundary.points.is_sorted_by(|a, b| a[0] <= b[0]))
        .collect();
    rising.sort_by(|a, b| b.points[0][0].total_cmp(&a.points[0][0]));
    let mut areas = Vec::new();
    for (index, boundary) in rising.into_iter().enumerate() {
        let tint = (BEYOND_TINT * (1 + index)).min(MOST_BEYOND_TINT);
        areas.push(area_beyond(boundary, tint as u8));
    }
    areas
}

/// Shades the area above a boundary, and everything to the left of its first point.
fn area_beyond(boundary: &LevelBoundary, tint: u8) -> Envelope {
    let mut edge = vec![[0.0, 0.0], [boundary.points[0][0], 0.0]];
    edge.extend(&boundary.points);
    Envelope {
        name: format!("beyond {}", boundary.name),
        color: Color::new(Hue::Warning).tint(tint),
        edge: None,
        points: edge
            .into_iter()
            .map(|[omega, delay_s]| [omega, s_to_ms(delay_s), BEYOND_MS])
            .collect(),
    }
}

/// Draws the level boundaries for an output as lines.
pub(super) fn boundaries(levels: &LevelBoundaries, output: &str) -> Vec<Curve> {
    let mut lines = Vec::new();
    for boundary in levels.for_output(output) {
        let points = boundary
            .points
            .iter()
            .map(|[omega, delay_s]| [*omega, s_to_ms(*delay_s)]);
        lines.push(Curve::through(&boundary.name, LEVEL, points).key(&boundary.name));
    }
    lines
}

/// A response's bandwidths and phase delays in all conditions.
pub(super) struct PairFindings<'a> {
    pub(super) requirements: &'a Requirements,
    pub(super) pair: Pair,
}

impl<'a> PairFindings<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a BandwidthFinding> {
        let pair = self.pair;
        self.requirements
            .bandwidth
            .iter()
            .filter(move |finding| finding.pair == pair)
    }

    pub(super) fn with_role(
        &self,
        role: RequirementRole,
    ) -> impl Iterator<Item = &'a BandwidthFinding> {
        self.iter().filter(move |finding| finding.role == role)
    }

    /// Draws arrows and intervals, and the dots on top.
    fn marks(&self) -> Vec<Mark> {
        let mut marks: Vec<Mark> = Vec::new();
        marks.extend(self.arrows().into_iter().map(Mark::from));
        marks.extend(self.delay_intervals().map(Mark::from));
        marks.extend(self.bandwidth_intervals().into_iter().map(Mark::from));
        for role in RequirementRole::ALL {
            for depends_beyond_band in [false, true] {
                let dots = self.dots(role, depends_beyond_band);
                if !dots.dots.is_empty() {
                    marks.push(dots.into());
                }
            }
        }
        marks
    }

    /// Draws an arrow from the physics model to the corrected model in each condition.
    fn arrows(&self) -> Vec<Curve> {
        let points: Vec<[f64; 2]> = self.iter().filter_map(bandwidth_place).collect();
        let spans = spans(&points);
        let mut arrows = Vec::new();
        for physics in self.with_role(RequirementRole::Physics) {
            let corrected = self.requirements.bandwidth_of(
                physics.condition,
                self.pair,
                RequirementRole::Corrected,
            );
            if let Some(from) = bandwidth_place(physics)
                && let Some(to) = corrected.and_then(bandwidth_place)
            {
                arrows.push(Curve::through("corrected", ARROW, arrow(from, to, spans)));
            }
        }
        arrows
    }

    /// Draws the phase delays' intervals as vertical lines; `None` if there are none.
    fn delay_intervals(&self) -> Option<Intervals> {
        let mut ends = Vec::new();
        for finding in self.iter() {
            if let Some([low, high]) = finding.interval.get(PHASE_DELAY)
                && let Some([omega, _]) = bandwidth_place(finding)
            {
                ends.push([omega, s_to_ms(*low), s_to_ms(*high)]);
            }
        }
        if ends.is_empty() {
            return None;
        }
        Some(Intervals {
            name: "interval".to_owned(),
            stroke: INTERVAL,
            ends,
        })
    }

    /// Draws the bandwidths' intervals as horizontal lines.
    fn bandwidth_intervals(&self) -> Vec<Curve> {
        let mut lines = Vec::new();
        for finding in self.iter() {
            if let Some([low, high]) = finding.interval.get(BANDWIDTH)
                && let Some([_, delay_ms]) = bandwidth_place(finding)
            {
                let x = [*low, *high];
                let y = [delay_ms, delay_ms];
                lines.push(Curve::new("interval of the bandwidth", INTERVAL, x, y));
            }
        }
        lines
    }

    /// Draws the models in a role: with `depends_beyond_band`, those whose bandwidth or phase delay
    /// depends on the model above the band, otherwise the others.
    fn dots(&self, role: RequirementRole, depends_beyond_band: bool) -> Dots {
        let (shape, color) = dot_style(role);
        let mut dots = if depends_beyond_band {
            Dots::new(role.name(), shape, color.tint(DEPENDENT_TINT)).filled(false)
        } else {
            Dots::new(role.name(), shape, color).key(role.name())
        };
        for finding in self.with_role(role) {
            let depends = finding.rests_above(BANDWIDTH) || finding.rests_above(PHASE_DELAY);
            if depends == depends_beyond_band
                && let Some([x, y]) = bandwidth_place(finding)
            {
                // To avoid clutter, only the corrected model's dot shows the condition number.
                let label = if role == RequirementRole::Corrected {
                    finding.condition.to_string()
                } else {
                    String::new()
                };
                dots.dots.push(Dot {
                    x,
                    y,
                    label,
                    id: Some(MarkId::Condition(finding.condition)),
                });
            }
        }
        dots
    }
}

pub(super) fn dot_style(role: RequirementRole) -> (DotShape, Color) {
    match role {
        RequirementRole::Physics => (DotShape::Circle, Color::new(Hue::Perturbed)),
        RequirementRole::Corrected => (DotShape::Square, Color::new(Hue::Corrected)),
        RequirementRole::Scheduled => (DotShape::Triangle, Color::new(Hue::Corrected)),
        RequirementRole::Identified => (DotShape::Diamond, Color::new(Hue::Identified)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_beyond_the_levels_are_shaded_and_the_narrower_area_is_darker() {
        let text = r#"[{"name": "Level 2", "axis": "P", "points": [[1, 0], [1, 0.2], [1.5, 0.3]]},
                       {"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]},
                       {"name": "back", "axis": "P", "points": [[2, 0], [1.5, 0.2]]},
                       {"name": "other", "axis": "Q", "points": [[2, 0], [2.5, 0.2]]}]"#;
        let levels: LevelBoundaries = serde_json::from_str(text).unwrap();
        let areas = areas_beyond(&levels, "P");
        let names: Vec<&str> = areas.iter().map(|area| area.name.as_str()).collect();
        assert_eq!(
            names,
            ["beyond Level 1", "beyond Level 2"],
            "the wider area lies below; a line that turns back has no side"
        );
        assert!(areas[0].color.percent < areas[1].color.percent);
        let lower: Vec<[f64; 2]> = areas[1].points.iter().map(|end| [end[0], end[1]]).collect();
        assert_eq!(
            lower,
            [
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 0.0],
                [1.0, 200.0],
                [1.5, 300.0]
            ]
        );
    }
}
