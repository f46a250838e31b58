//! Cautions about results that are nevertheless available, and the typed reasons in them: why a
//! response has no G and D ([`Undefined`]), why it is not finite ([`NotFinite`]), and gains out of
//! range ([`GainOutOfRange`]). G and D are the gain and the delay that would match a response (M6).
//! A *bundle* contains a condition's physics models, or its identified models; its *representative*
//! is the model closest to the others, or the engineer's choice (M5).

use std::fmt;

use gdcm_method::correction::delta::LARGEST_GAIN_DB;
use gdcm_method::fidelity::discontinuity::DiscontinuityError;
use gdcm_method::physics::ConditionOmission;
use gdcm_model::dataset::{BundleKind, Condition, Dynamics, Pair};
use gdcm_model::response::PolarResponse;
use gdcm_model::response::large_entry::LargeEntry;

use super::moved_models::{BendingParameter, MovedModels, UnmovedModel};

/// Usual range of G; a value outside it suggests different units, or a response without physical
/// meaning.
pub const USUAL_GAINS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// A caution attached to a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Caution {
    /// A response chosen as constrained is not constrained in this condition, because it has no G
    /// and D.
    HeldButUndefined { pair: Pair, why: Undefined },
    /// No outliers can be suggested.
    NoSuggestions(DiscontinuityError),
    /// A model is excluded from distances, suggestions and representatives (M5b), because it lacks
    /// responses. Each of them is zero wherever it has values, or not finite somewhere in the band,
    /// or zero somewhere in the band.
    SetAside {
        model: BundleModel,
        /// On-axis responses (any responses if none is on-axis) that the model lacks and another
        /// model of its bundle has.
        lacks: Vec<Pair>,
        /// Those in `lacks` that are zero wherever they have values.
        zero: Vec<Pair>,
        /// Why others in `lacks` are not finite; `None` if all others are zero somewhere in the
        /// band.
        why: Option<NotFinite>,
        /// Whether the model was pinned; the pin has no effect.
        pinned: bool,
    },
    /// A model that is not set aside has responses that are not finite somewhere in the band.
    NotFinite {
        model: BundleModel,
        responses: Vec<Pair>,
        why: NotFinite,
    },
    /// A measured model has responses that are zero at every measured frequency: not measured, or
    /// not found by name.
    MissingResponses {
        model: BundleModel,
        responses: Vec<Pair>,
    },
    /// A physics and an identified model differ in some responses by a factor outside the
    /// computable range: above 1e50 or below 1e-50 (M6).
    GainsOutOfRange {
        physics: String,
        identified: String,
        responses: Vec<GainOutOfRange>,
    },
    /// Some responses of a representative are numerically zero, and count as zero (M6a).
    NumericallyZero {
        model: BundleModel,
        responses: Vec<Pair>,
    },
    /// Some frequencies in the identified representative's responses have no weight: their
    /// coherence is too low, or they lie outside the valid band (M4a).
    NotCoherent {
        /// Minimum coherence at which a frequency counts.
        threshold: f64,
        /// Number of responses weighted by coherence.
        weighed: usize,
        /// Omitted frequency count for each response, in descending order.
        left_out: Vec<(Pair, usize)>,
        points: usize,
    },
    /// The identified representative has measured coherence, and weighting by coherence is switched
    /// off (M4a).
    CoherenceNotUsed,
    /// Model channels were assigned by position, because the files do not name them.
    ChannelsByPosition {
        bundle: BundleKind,
        models: Vec<String>,
    },
    /// The physics parameters move other conditions, but not this one (M18.5).
    ParametersNotApplied(ConditionOmission),
    /// Physics models keep their response, because the changes from the runs do not apply to them
    /// (M18.5).
    ModelsNotMoved(Vec<UnmovedModel>),
    /// The parameter effects are curved at the applied values (M18.7).
    ParametersBend(Vec<BendingParameter>),
    /// The objective fits a response whose G is outside [`USUAL_GAINS`].
    UnusualGain { pair: Pair, gain: f64 },
}

impl Caution {
    /// Returns the caution about a fitted response if its G is outside the usual range.
    pub(crate) fn unusual_gain(pair: Pair, gain: f64) -> Option<Self> {
        if USUAL_GAINS.contains(&gain) {
            None
        } else {
            Some(Caution::UnusualGain { pair, gain })
        }
    }

    /// Returns the cautions about a condition's moved physics models.
    pub(crate) fn of_moved_models(moved: &MovedModels) -> Vec<Self> {
        let mut cautions = Vec::new();
        match moved {
            MovedModels::NotMoved(omission) => {
                cautions.push(Caution::ParametersNotApplied(omission.clone()));
            }
            MovedModels::Moved { kept, bends } => {
                if !kept.is_empty() {
                    cautions.push(Caution::ModelsNotMoved(kept.clone()));
                }
                if !bends.is_empty() {
                    cautions.push(Caution::ParametersBend(bends.clone()));
                }
            }
        }
        cautions
    }

    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Caution::HeldButUndefined { .. } => "held-but-undefined",
            Caution::NoSuggestions(_) => "no-suggestions",
            Caution::SetAside { .. } => "set-aside",
            Caution::NotFinite { .. } => "response-not-finite",
            Caution::MissingResponses { .. } => "response-missing",
            Caution::GainsOutOfRange { .. } => "gain-out-of-range",
            Caution::NumericallyZero { .. } => "response-numerically-nothing",
            Caution::NotCoherent { .. } => "not-coherent",
            Caution::CoherenceNotUsed => "coherence-not-used",
            Caution::ChannelsByPosition { .. } => "channels-by-position",
            Caution::ParametersNotApplied(_) => "parameters-not-applied",
            Caution::ModelsNotMoved(_) => "models-not-moved",
            Caution::ParametersBend(_) => "parameters-bend",
            Caution::UnusualGain { .. } => "unusual-gain",
        }
    }

    /// Returns whether the caution states that this model is set aside.
    pub fn is_set_aside(&self, bundle: BundleKind, name: &str) -> bool {
        matches!(self, Caution::SetAside { model, .. } if model.bundle == bundle && model.name == name)
    }

    /// Returns the response that the caution suggests ignoring in the objective; `None` if it
    /// suggests none.
    pub fn offers_to_ignore(&self) -> Option<Pair> {
        match self {
            Caution::UnusualGain { pair, .. } => Some(*pair),
            _ => None,
        }
    }
}

/// A response whose gain (flight over physics) is outside the computable range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GainOutOfRange {
    pub pair: Pair,
    /// Power of ten nearest to the gain that is farthest from 1 in the band.
    pub power_of_ten: i32,
}

impl GainOutOfRange {
    /// Returns the responses in which the gain between two models is outside the computable range.
    pub(crate) fn of_models(physics: &PolarResponse, identified: &PolarResponse) -> Vec<Self> {
        physics
            .curves()
            .pairs()
            .filter_map(|pair| Self::of_pair(physics, identified, pair))
            .collect()
    }

    /// Returns a response's gain if it is outside the computable range; `None` also where a model
    /// lacks the response.
    pub(crate) fn of_pair(
        physics: &PolarResponse,
        identified: &PolarResponse,
        pair: Pair,
    ) -> Option<Self> {
        let physics = physics.curves()[pair].as_ref()?;
        let identified = identified.curves()[pair].as_ref()?;
        let gains_db = identified
            .magnitude_db
            .iter()
            .zip(&physics.magnitude_db)
            .map(|(flight, model)| flight - model);
        let farthest_db = gains_db.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        if farthest_db.abs() < LARGEST_GAIN_DB {
            return None;
        }
        Some(Self {
            pair,
            power_of_ten: (farthest_db / 20.0).round() as i32,
        })
    }
}

/// A model by its bundle and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BundleModel {
    pub bundle: BundleKind,
    pub name: String,
}

impl BundleModel {
    pub(crate) fn new(condition: &Condition, bundle: BundleKind, index: usize) -> Self {
        Self {
            bundle,
            name: condition.bundle(bundle)[index].name.clone(),
        }
    }
}

impl fmt::Display for BundleModel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} model \"{}\"", self.bundle, self.name)
    }
}

/// Why a response has no G and no D.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undefined {
    /// Zero in this bundle's representative, wherever it has values in the band.
    Zero(BundleKind),
    /// Zero somewhere in the band in this bundle's representative, and finite everywhere.
    ZeroSomewhere(BundleKind),
    /// Not finite somewhere in the band in this bundle's representative.
    NotFinite(BundleKind),
    /// The gain (flight over physics) is near this power of ten: above 1e50 or below 1e-50.
    GainOutOfRange(i32),
    /// Numerically zero in this bundle's representative (M6a).
    NumericallyZero(BundleKind),
    /// The identified representative's response is nowhere coherent enough, or all its frequencies
    /// lie outside its valid band (M4a).
    NotCoherent,
    /// The identified representative is measured, and none of its files contains this response.
    NotMeasured,
}

impl Undefined {
    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::Zero(_) => "response-zero",
            Self::ZeroSomewhere(_) => "response-zero-somewhere",
            Self::NotFinite(_) => "response-not-finite",
            Self::GainOutOfRange(_) => "gain-out-of-range",
            Self::NumericallyZero(_) => "response-numerically-nothing",
            Self::NotCoherent => "response-not-coherent",
            Self::NotMeasured => "response-not-measured",
        }
    }
}

/// Why a model has responses that are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotFinite {
    /// A matrix entry is too large to compute with.
    Entry(LargeEntry),
    /// The model is measured over only a part of the band.
    Measured {
        /// First measured frequency \[rad/s\].
        min: f64,
        /// Last measured frequency \[rad/s\].
        max: f64,
    },
    /// The model is discrete-time, and the band reaches its Nyquist frequency (M2a).
    Sampled {
        /// Sample time \[s\].
        sample_time_s: f64,
        /// Nyquist frequency `pi / T`, up to which the model has a response \[rad/s\].
        nyquist_rad_s: f64,
    },
    /// None of the above: a pole on the imaginary axis, or an overflow.
    Pole,
}

impl NotFinite {
    /// Returns why a model with these dynamics has a response that is not finite in a band that
    /// ends at `band_top` \[rad/s\]: `Measured` for a measured response; else `Entry` if a matrix
    /// has a large entry; else `Sampled` if the band reaches the Nyquist frequency; else `Pole`.
    pub(crate) fn new(dynamics: &Dynamics, band_top: f64) -> Self {
        let model = match dynamics {
            Dynamics::StateSpace(model) => model,
            Dynamics::Measured(response) => {
                let omega = response.omega();
                return NotFinite::Measured {
                    min: omega[0],
                    max: omega[omega.len() - 1],
                };
            }
        };
        if let Some(entry) = LargeEntry::find(model) {
            return NotFinite::Entry(entry);
        }
        let timing = model.timing();
        match (timing.sample_time_s, timing.nyquist_rad_s()) {
            (Some(sample_time_s), Some(nyquist_rad_s)) if band_top >= nyquist_rad_s => {
                NotFinite::Sampled {
                    sample_time_s,
                    nyquist_rad_s,
                }
            }
            _ => NotFinite::Pole,
        }
    }
}
