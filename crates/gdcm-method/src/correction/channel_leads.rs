//! Signed channel delays, with the lead filters that realise the negative ones (M15.5). A negative
//! delay, a *lead*, is needed where the physics model lags.

use std::sync::{Arc, OnceLock};

use gdcm_model::dataset::Pair;
use gdcm_model::response::LeadFilter;

use super::channels::Channels;
use super::lead_design::LeadDesign;

/// A signed delay for each channel: a pure delay if positive, a lead filter if negative (M15.5).
///
/// The filters, and their curves over the band, are computed at first use, and shared by all
/// clones.
#[derive(Clone, Debug)]
pub struct ChannelLeads {
    /// Design that converts a signed delay to a filter.
    pub design: Arc<LeadDesign>,
    /// Signed channel delays \[s\].
    pub taus_s: Channels<f64>,
    filters: Arc<OnceLock<Channels<Option<LeadFilter>>>>,
    curves: Arc<OnceLock<Channels<Option<LeadCurve>>>>,
}

impl PartialEq for ChannelLeads {
    /// Compares the signed delays and the design, which determine the cached filters.
    fn eq(&self, other: &Self) -> bool {
        (&self.taus_s, &self.design) == (&other.taus_s, &other.design)
    }
}

impl ChannelLeads {
    /// Creates the leads for signed delays \[s\], with filters according to `design`.
    pub fn new(design: Arc<LeadDesign>, taus_s: Channels<f64>) -> Self {
        Self {
            design,
            taus_s,
            filters: Arc::default(),
            curves: Arc::default(),
        }
    }

    /// Returns each channel's lead filter; `None` if the signed delay is not negative.
    pub fn filters(&self) -> &Channels<Option<LeadFilter>> {
        self.filters
            .get_or_init(|| self.taus_s.map(|_, &tau_s| self.design.filter(tau_s)))
    }

    /// Returns each channel's pure delay \[s\], the positive part of its signed delay.
    pub fn delays_s(&self) -> Channels<f64> {
        self.taus_s.map(|_, tau_s| tau_s.max(0.0))
    }

    /// Returns magnitude and phase of the filters on a response's input and output, at each
    /// frequency in the design's band; `None` if neither channel has a filter.
    pub fn curve(&self, pair: Pair) -> Option<LeadCurve> {
        let curves = self.curves.get_or_init(|| {
            self.filters().map(|_, filter| {
                let filter = (*filter)?;
                Some(LeadCurve::new(filter, self.design.omega()))
            })
        });
        match (&curves.inputs[pair.input], &curves.outputs[pair.output]) {
            (Some(input), Some(output)) => Some(input.in_series(output)),
            (Some(curve), None) | (None, Some(curve)) => Some(curve.clone()),
            (None, None) => None,
        }
    }
}

/// Magnitude \[dB\] and phase \[rad\] over the band, for one filter or two in series.
#[derive(Clone, Debug)]
pub struct LeadCurve {
    /// `20 log10 |L|` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// `arg L` at each frequency, continuous.
    pub phase: Vec<f64>,
}

impl LeadCurve {
    /// Evaluates a filter at the frequencies `omega` \[rad/s\].
    fn new(filter: LeadFilter, omega: &[f64]) -> Self {
        Self {
            magnitude_db: omega
                .iter()
                .map(|&omega| filter.magnitude_db(omega))
                .collect(),
            phase: omega.iter().map(|&omega| filter.phase(omega)).collect(),
        }
    }

    /// Returns the curve for both filters in series.
    fn in_series(&self, other: &Self) -> Self {
        Self {
            magnitude_db: sums(&self.magnitude_db, &other.magnitude_db),
            phase: sums(&self.phase, &other.phase),
        }
    }
}

/// Adds two curves, frequency by frequency.
fn sums(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}
