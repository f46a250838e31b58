//! A setting's value, whatever its type, and the types whose values are choices.

use gdcm_method::correction::delta::GainSource;
use gdcm_method::correction::{GainBounds, GainObjective};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::form_comparison::SCHEDULE_KINDS;
use gdcm_method::schedule::{DelayScheduling, ScheduleKind, ScheduledQuantity, SecondVariable};
use gdcm_model::dataset::Band;
use gdcm_model::response::LeadOrder;

use super::physics_settings::PhysicsCorrection;
use super::settings::{CouplingCorrection, DelayFrom, PhaseCorrection};

/// A setting's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number in the file unit.
    Number(f64),
    /// No value, for settings that allow it.
    Nothing,
    Range([f64; 2]),
    Flag(bool),
    Choice(usize),
}

/// A type whose values are a setting's choices.
pub trait Choice: Copy + PartialEq + 'static {
    /// All values that a valid setting may have, in the same order as the words in `Kind::Choice`.
    const ALL: &'static [Self];

    /// Returns the value's index in [`Self::ALL`]; 0 for a value outside the list, such as a degree
    /// above the highest, which no valid setting has.
    fn index(self) -> usize {
        Self::ALL
            .iter()
            .position(|choice| *choice == self)
            .unwrap_or_default()
    }
}

impl Choice for PhaseCorrection {
    const ALL: &'static [Self] = &[Self::None, Self::Delay, Self::Lead];
}

impl Choice for CouplingCorrection {
    const ALL: &'static [Self] = &[Self::None, Self::Mixing, Self::MixingAndFeedback];
}

impl Choice for PhysicsCorrection {
    const ALL: &'static [Self] = &[Self::Off, Self::Named, Self::All, Self::ByHand];
}

impl Choice for DelayFrom {
    const ALL: &'static [Self] = &[Self::Median, Self::Band];
}

impl Choice for CostAverage {
    const ALL: &'static [Self] = &[Self::Median, Self::Mean];
}

impl Choice for GainObjective {
    const ALL: &'static [Self] = &[Self::Ratio, Self::Decibel];
}

impl Choice for GainSource {
    const ALL: &'static [Self] = &[Self::Representatives, Self::MeanOfPairs];
}

impl Choice for LeadOrder {
    const ALL: &'static [Self] = &[Self::Second, Self::First];
}

impl Choice for ScheduleKind {
    const ALL: &'static [Self] = &SCHEDULE_KINDS;
}

impl Choice for DelayScheduling {
    const ALL: &'static [Self] = &[Self::Automatic, Self::Always, Self::Never];
}

impl Choice for ScheduledQuantity {
    const ALL: &'static [Self] = &[Self::LnGain, Self::Gain];
}

impl Choice for Option<SecondVariable> {
    const ALL: &'static [Self] = &[
        None,
        Some(SecondVariable::Altitude),
        Some(SecondVariable::Mass),
    ];
}

impl<C: Choice> From<C> for Value {
    fn from(choice: C) -> Self {
        Self::Choice(choice.index())
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Number(count as f64)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<Option<f64>> for Value {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::Number)
    }
}

impl From<Band> for Value {
    fn from(band: Band) -> Self {
        Self::Range([band.min(), band.max()])
    }
}

impl From<Option<GainBounds>> for Value {
    fn from(bounds: Option<GainBounds>) -> Self {
        bounds.map_or(Self::Nothing, |bounds| {
            Self::Range([bounds.lower, bounds.upper])
        })
    }
}
