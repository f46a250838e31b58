//! Detail of a requirement: a response's phase delay over bandwidth in all conditions, with the
//! tolerances about the identified model in the selected condition (M17.1).
//!
//! Bandwidth and phase delay are defined in `requirements.rs`, which plots all attitude responses.

use gdcm_method::requirements::LevelBoundaries;
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::units::s_to_ms;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;

use super::axis::Axis;
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Dot, Dots, Envelope, Mark, MarkId};
use super::requirements::{
    ARROW, BEYOND_MS, PairFindings, areas_beyond, bandwidth_place, boundaries, dot_style,
};

/// Strength \[%\] for dots in conditions that are not selected.
const OTHER_TINT: u8 = 60;
/// Strength \[%\] in a shaded tolerance.
const TOLERANCE_TINT: u8 = 9;
/// Size of dots in the selected condition, relative to the usual dot.
const SELECTED_SIZE: f64 = 1.2;
/// Size of dots in the other conditions, relative to the usual dot.
const OTHER_SIZE: f64 = 0.8;

/// A response in the plot for a single requirement.
#[derive(Clone, Copy)]
pub struct BandwidthDetail<'a> {
    pub requirements: &'a Requirements,
    pub levels: &'a LevelBoundaries,
    pub pair: Pair,
    /// Selected condition: its dots are larger and in full colour, and its tolerances are shaded.
    pub condition: ConditionId,
    /// Role of the corrected model: with its condition's own correction, or with the scheduled one.
    pub role: RequirementRole,
    /// Maximum relative difference between a bandwidth and the identified model's.
    pub bandwidth_tolerance: f64,
    /// Maximum difference between a phase delay and the identified model's \[s\].
    pub phase_delay_tolerance_s: f64,
}

/// Space above the largest phase delay, relative to it: the ring around a selected dot must not
/// touch the frame of a low plot.
const SPACE_ABOVE: f64 = 0.12;

/// Plots a response's phase delay over bandwidth in all conditions, for the physics, corrected and
/// identified model in each; the tolerances about one condition's identified model are shaded.
pub fn bandwidth_detail_figure(detail: &BandwidthDetail<'_>, dataset: &Dataset) -> Figure {
    let output = &dataset.outputs()[detail.pair.output].name;
    let x = Axis::linear("bandwidth [rad/s]");
    let mut y = Axis::linear("phase delay [ms]").including(0.0);
    for finding in &detail.requirements.bandwidth {
        if finding.pair == detail.pair
            && let Some([_, delay_ms]) = bandwidth_place(finding)
        {
            y = y.including((1.0 + SPACE_ABOVE) * delay_ms);
        }
    }
    let panel = Panel::new(x, y)
        .with_all(detail.tolerances())
        .with_all(areas_beyond(detail.levels, output))
        .with_all(boundaries(detail.levels, output))
        .with_all(detail.marks());
    let plot = Plot::new("").panel(panel);
    let title = format!("{}: attitude", dataset.pair_name(detail.pair));
    Figure::new(title).aspect(0.66).plots([plot])
}

impl BandwidthDetail<'_> {
    /// Shades the bandwidths within the tolerance, and more strongly the part in which the phase
    /// delay is within its tolerance too.
    fn tolerances(&self) -> Vec<Envelope> {
        let identified =
            self.requirements
                .bandwidth_of(self.condition, self.pair, RequirementRole::Identified);
        let Some([omega, delay_ms]) = identified.and_then(bandwidth_place) else {
            return Vec::new();
        };
        let tolerance_ms = s_to_ms(self.phase_delay_tolerance_s);
        let from = omega * (1.0 - self.bandwidth_tolerance);
        let to = omega * (1.0 + self.bandwidth_tolerance);
        vec![
            tolerance_area(
                "tolerance of the bandwidth",
                [from, to],
                [-BEYOND_MS, BEYOND_MS],
            ),
            tolerance_area(
                "tolerance of the phase delay",
                [from, to],
                [delay_ms - tolerance_ms, delay_ms + tolerance_ms],
            ),
        ]
    }

    /// Draws arrows, then dots in the other conditions, and dots in the selected condition on top.
    fn marks(&self) -> Vec<Mark> {
        let mut marks: Vec<Mark> = Vec::new();
        marks.extend(self.arrows().into_iter().map(Mark::from));
        let findings = PairFindings {
            requirements: self.requirements,
            pair: self.pair,
        };
        let roles = [
            RequirementRole::Identified,
            RequirementRole::Physics,
            self.role,
        ];
        for is_selected in [false, true] {
            for role in roles {
                let (shape, color) = dot_style(role);
                let mut dots = if is_selected {
                    Dots::new(role.name(), shape, color).key(role.name())
                } else {
                    Dots::new(role.name(), shape, color.tint(OTHER_TINT))
                };
                dots.size = if is_selected {
                    SELECTED_SIZE
                } else {
                    OTHER_SIZE
                };
                for finding in findings.with_role(role) {
                    if (finding.condition == self.condition) == is_selected
                        && let Some([x, y]) = bandwidth_place(finding)
                    {
                        dots.dots.push(Dot {
                            x,
                            y,
                            label: String::new(),
                            id: Some(MarkId::Condition(finding.condition)),
                        });
                    }
                }
                if !dots.dots.is_empty() {
                    marks.push(dots.into());
                }
            }
        }
        marks
    }

    /// Draws a line from the physics model to the corrected model in each condition.
    fn arrows(&self) -> Vec<Curve> {
        let mut lines = Vec::new();
        for physics in &self.requirements.bandwidth {
            if physics.pair != self.pair || physics.role != RequirementRole::Physics {
                continue;
            }
            let corrected = self
                .requirements
                .bandwidth_of(physics.condition, self.pair, self.role);
            if let Some(from) = bandwidth_place(physics)
                && let Some(to) = corrected.and_then(bandwidth_place)
            {
                let stroke = if physics.condition == self.condition {
                    Stroke::solid(Color::new(Hue::Text), 1.2)
                } else {
                    ARROW
                };
                lines.push(Curve::through("corrected", stroke, [from, to]));
            }
        }
        lines
    }
}

/// Shades a rectangle of bandwidths \[rad/s\] and phase delays \[ms\].
fn tolerance_area(name: &str, omega: [f64; 2], delay_ms: [f64; 2]) -> Envelope {
    let [low, high] = delay_ms;
    Envelope {
        name: name.to_owned(),
        color: Color::new(Hue::Text).tint(TOLERANCE_TINT),
        edge: None,
        points: omega.map(|omega| [omega, low, high]).to_vec(),
    }
}
