//! Other models of the bundles in place of the representatives, one at a time (M13.1).

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::correction::{Channel, ChannelCorrection, GainSource};
use crate::dataset::{BundleKind, PairTable};
use crate::response::FrequencyGrid;
use crate::uncertainty::{ConditionSpread, Figures, Scalar, ScalarTable};

use super::{Cancelled, Compared, Comparison, ConditionAnalysis, ConditionResponses, Execution, Settings, Study};

/// What came of the swaps of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionSwaps {
    /// How the figures change.
    pub spread: ConditionSpread,
    /// Figures of each swap, with the bundle and the place of the model that stands in; none where it could not be analysed.
    pub swaps: Vec<(BundleKind, usize, Option<Arc<Figures>>)>,
}

/// What swaps are made of.
#[derive(Clone, Copy)]
pub(super) struct Swapping<'a> {
    pub(super) study: &'a Study,
    pub(super) analysis: &'a ConditionAnalysis,
    pub(super) grid: &'a FrequencyGrid,
    pub(super) responses: &'a ConditionResponses,
}

/// What comes of a swap: the correction, and the G that it was asked for, and both D \[s\].
#[derive(Clone, Debug)]
pub(super) struct SwapOptimum {
    pub(super) correction: ChannelCorrection,
    pub(super) gain: PairTable<Option<f64>>,
    pub(super) delay_s: PairTable<Option<f64>>,
    pub(super) band_delay_s: PairTable<Option<f64>>,
}

impl SwapOptimum {
    /// That of an analysis with its representatives.
    pub(super) fn of(analysis: &ConditionAnalysis) -> Self {
        Self {
            correction: analysis.correction.clone(),
            gain: analysis.gain_problem.delta.clone(),
            delay_s: analysis.comparison.delta.delay_s.clone(),
            band_delay_s: analysis.comparison.delta.band_delay_s.clone(),
        }
    }

    /// The figures that have bars; signed delays where there are leads.
    pub(super) fn figures(&self) -> Figures {
        let Self { correction, gain, delay_s, band_delay_s } = self;
        ScalarTable::from_fn(gain.outputs(), gain.inputs(), |scalar| {
            let figure = match scalar {
                Scalar::Gain(pair) => gain[pair]?.ln(),
                Scalar::Delay(pair) => delay_s[pair]?,
                Scalar::BandDelay(pair) => band_delay_s[pair]?,
                Scalar::NetGain(pair) => correction.net_gain(pair).value().ln(),
                Scalar::ChannelGain(Channel::Input(input)) => correction.input_gains[input].ln(),
                Scalar::ChannelGain(Channel::Output(output)) => correction.output_gains[output].ln(),
                Scalar::ChannelDelay(channel) => match (&correction.leads, channel) {
                    (Some(leads), channel) => leads.tau_s(channel),
                    (None, Channel::Input(input)) => correction.input_delays_s[input],
                    (None, Channel::Output(output)) => correction.output_delays_s[output],
                },
            };
            figure.is_finite().then_some(figure)
        })
    }
}

/// What a swap depends on besides the two models: the settings of the analysis, and the representatives, beside which phases lie.
type SwapKey = (Settings, PairTable<bool>, [usize; 2]);

/// The swaps made last, by the physics and the identified model: a model that is rejected or restored leaves the others'.
#[derive(Clone, Debug, Default)]
pub(super) struct SwapMemo {
    key: Option<SwapKey>,
    kept: BTreeMap<[usize; 2], Option<Arc<Figures>>>,
}

impl Swapping<'_> {
    fn representatives(&self) -> [usize; 2] {
        [self.analysis.comparison.physics.model, self.analysis.comparison.identified.model]
    }

    /// The other kept models of a bundle, in file order; none that is set aside (M5b). A model that stands twice counts once, for
    /// it says nothing more; copies of the representative count where there are no others.
    fn others(&self, kind: BundleKind) -> Vec<usize> {
        let representative = self.analysis.representative(kind);
        let scores = representative.scores.iter().enumerate();
        let kept = scores.filter(|(model, score)| score.is_some() && *model != representative.model);
        let (responses, mut distinct) = (self.responses.bundle(kind), Vec::new());
        // Models of the same numbers share their response.
        let is_copy = |a: usize, b: usize| Arc::ptr_eq(&responses[a], &responses[b]);
        let mut copies = Vec::new();
        for (model, _) in kept {
            if is_copy(model, representative.model) {
                copies.push(model);
            } else if !distinct.iter().any(|&known| is_copy(known, model)) {
                distinct.push(model);
            }
        }
        copies.truncate(1);
        if distinct.is_empty() { copies } else { distinct }
    }

    /// The settings that a swap depends on.
    fn key(&self) -> SwapKey {
        let mut settings = self.study.settings.clone();
        settings.schedule = Default::default();
        settings.uncertainty = Default::default();
        settings.gain_source = GainSource::Representatives;
        (settings, self.study.dataset.measuring_pairs(), self.representatives())
    }

    fn compared(&self, kind: BundleKind, model: usize) -> Compared {
        let response = &self.responses.bundle(kind)[model];
        match kind {
            BundleKind::Physics => Compared::of(response),
            BundleKind::Identified => {
                let flight = &self.analysis.condition.bundle(kind)[model].dynamics;
                Compared::of_identified(response, flight, self.grid, self.study.settings.coherence_threshold)
            }
        }
    }
}

impl SwapMemo {
    /// All swaps; those that are not kept are made, each a step, with the correction that `optimum` finds for a comparison.
    pub(super) fn complete(
        &mut self,
        swapping: &Swapping<'_>,
        execution: &Execution<'_>,
        optimum: impl Fn(&Comparison, &Execution<'_>) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
    ) -> Result<ConditionSwaps, Cancelled> {
        let key = swapping.key();
        if self.key.as_ref() != Some(&key) {
            *self = Self { key: Some(key), kept: BTreeMap::new() };
        }
        let [physics, identified] = swapping.representatives();
        let [trim, own] = BundleKind::BOTH.map(|kind| swapping.others(kind));
        let pairs = trim.iter().map(|&a| [a, identified]).chain(own.iter().map(|&b| [physics, b]));
        // The mean over all pairs is no figure of the representatives: what changes are measured from is made too.
        let base = (swapping.study.settings.gain_source == GainSource::MeanOfPairs).then_some([physics, identified]);
        let of = &swapping.analysis.comparison.delta.gain;
        let pairs = pairs.chain(base);
        let missing: Vec<[usize; 2]> = pairs.filter(|pair| !self.kept.contains_key(pair)).collect();
        execution.step((trim.len() + own.len()).saturating_sub(missing.len()));
        let made = make(swapping, &missing, execution, optimum)?;
        self.kept.extend(missing.into_iter().zip(made));
        let kept = |pair: [usize; 2]| self.kept.get(&pair).cloned().flatten();
        let by_trim: Vec<Option<Arc<Figures>>> = trim.iter().map(|&a| kept([a, identified])).collect();
        let by_own: Vec<Option<Arc<Figures>>> = own.iter().map(|&b| kept([physics, b])).collect();
        let base = match swapping.study.settings.gain_source {
            GainSource::Representatives => SwapOptimum::of(swapping.analysis).figures(),
            GainSource::MeanOfPairs => match kept([physics, identified]) {
                Some(base) => Figures::clone(&base),
                None => ScalarTable::from_fn(of.outputs(), of.inputs(), |_| None),
            },
        };
        let [of_trim, of_own] = [&by_trim, &by_own].map(|swaps| swaps.iter().map(Option::as_deref).collect::<Vec<_>>());
        let spread = ConditionSpread::of(&base, &of_trim, &of_own);
        let named = |kind, models: Vec<usize>, swaps: Vec<_>| {
            models.into_iter().zip(swaps).map(move |(model, figures)| (kind, model, figures))
        };
        let swaps = named(BundleKind::Physics, trim, by_trim).chain(named(BundleKind::Identified, own, by_own));
        Ok(ConditionSwaps { spread, swaps: swaps.collect() })
    }
}

/// The figures of each of these pairs of models.
fn make(
    swapping: &Swapping<'_>,
    pairs: &[[usize; 2]],
    execution: &Execution<'_>,
    optimum: impl Fn(&Comparison, &Execution<'_>) -> Result<Option<SwapOptimum>, Cancelled> + Sync,
) -> Result<Vec<Option<Arc<Figures>>>, Cancelled> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let base = &swapping.analysis.comparison;
    let [physics, identified] = swapping.representatives();
    let simulated = swapping.compared(BundleKind::Physics, physics);
    let reference = swapping.compared(BundleKind::Identified, identified);
    let omega = swapping.grid.omega();
    let median_phases =
        base.representative.mismatch.map(|_, mismatch| mismatch.as_ref().map(|mismatch| mismatch.median_phase(omega)));
    let swap = |place: usize| {
        let pair @ [a, b] = pairs[place];
        let other;
        let (simulated, reference) = if b == identified {
            other = swapping.compared(BundleKind::Physics, a);
            (&other, &reference)
        } else {
            other = swapping.compared(BundleKind::Identified, b);
            (&simulated, &other)
        };
        let comparison = base.swapped(pair, simulated, reference, omega, &median_phases);
        // As of a pinned pair that has nothing to compare.
        if comparison.delta.gain.iter().all(|(_, gain)| gain.is_none()) {
            return Ok(None);
        }
        Ok(optimum(&comparison, execution)?.map(|optimum| Arc::new(optimum.figures())))
    };
    execution.each(pairs.len(), 1, swap)?.into_iter().collect()
}
