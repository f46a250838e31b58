//! The identification of one flight condition from its records, and what is said of the recommended model (M14, sections 5 to 7).

use std::sync::Arc;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::model::{ModelBands, Origin, Provenance};
use gdcm_model::dataset::{Dynamics, Model, Pair};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress, Shares};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::simulation::{FlightRecord, Signal, Validation, ValidationSettings, validate};

use super::blocks::BlockModel;
use super::cautions::IdentificationCaution;
use super::diagnostics::{Diagnostics, RecordFit, RecordFits};
use super::feedback::{Feedback, FeedbackLevel};
use super::gaps::names;
use super::local_polynomial::{LocalPolynomialError, ResponseEstimate};
use super::order::fast_unstable_pole;
use super::preparation::{Preparation, PreparationError, RecordUse};
use super::prepared_data::{PreparedData, ScalingError};
use super::record_contrast::{RecordContrast, RecordContrasts};
use super::refinement::{Proposal, Refinement, propose, refine};
use super::subspace::StabilisationPoint;
use super::uncertainty::{ParameterCovariance, without_each_record};

/// Methods, as models carry them and as their names begin (M14).
const REFINED: &str = "CT-PBSID, refined";
const UNREFINED: &str = "CT-PBSID";
/// Points of the bands.
const BAND_POINTS: usize = 60;
/// Upper end of the band that is offered where the highest order is not enough, over the present one.
const NARROWER: f64 = 0.7;
/// Standard deviation \[dB\] above which a response is not identified.
const NOT_IDENTIFIED: f64 = 3.0;

/// What was identified from the records of a flight condition, in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model: CT-PBSID, refined, with the standard deviations of its response.
    pub refined: Model,
    /// CT-PBSID without refinement, of the same order.
    pub unrefined: Model,
    /// The bundle around the recommended model: the orders two less and two more, then without each record.
    pub bundle: Vec<Model>,
    /// The response estimated without a model.
    pub measured: ResponseEstimate,
    /// Poles of the recommended model.
    pub poles: Vec<PoleEstimate>,
    /// Poles of the unrefined models of all orders at the best Laguerre pole and past window.
    pub stabilisation: Vec<StabilisationPoint>,
    /// Best Laguerre pole \[rad/s\].
    pub laguerre_pole: f64,
    /// Best past window.
    pub past: usize,
    /// BIC of every order that was refined, ascending.
    pub criteria: Vec<(usize, f64)>,
    /// `J / (N - k)` over the records of the fit, per degree of freedom that the parameters leave; 1 is adequate.
    pub cost: f64,
    /// The same over the held-out records, where there are any.
    pub held_out_cost: Option<f64>,
    /// The same where the model may move within its own uncertainty: up to 1.3 good, above 2 not predicted (M14.17).
    pub held_out_normalised: Option<f64>,
    /// How much of the measured response was fed back (M14.14).
    pub feedback: Option<Feedback>,
    /// How far each record of the fit wants another model than the others; empty for one record (M14.16).
    pub contrasts: Vec<RecordContrast>,
    /// The same of every record that was used, in the order of the records.
    pub record_fits: Vec<RecordFit>,
    /// The same of every output, over the records of the fit.
    pub output_costs: Vec<f64>,
    /// The recommended model against the held-out records in time.
    pub validation: Option<Validation>,
    /// What was used of every record.
    pub record_uses: Vec<RecordUse>,
    /// Output and input of the responses with a standard deviation over 3 dB in the middle of the band.
    pub not_identified: Vec<(usize, usize)>,
    /// What the engineer should know.
    pub cautions: Vec<IdentificationCaution>,
}

/// Identifies one flight condition from its records (M14, section 7).
///
/// ```text
/// 1  segments of the records, scales, spectra, measured response, covariance of the noise                10 %
/// 2  CT-PBSID for each Laguerre pole and past window; models of all orders from the best two           40 %
/// 3  order by BIC of refined models; the chosen one refined further, records weighed by their noise  80 %
/// 4  covariance, bands, bundle, validation                                                            100 %
/// ```
///
/// The same to the last bit whoever carries out its pieces. `progress` is told a first model after step 2.
///
/// # Errors
/// Records that cannot be prepared, a band that they do not show, settings out of range, channels that depend on each other,
/// records too short for a model; or `progress` is cancelled.
pub fn identify(
    records: &[FlightRecord],
    options: &Options,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Identification, IdentificationError> {
    check(options)?;
    let progress = Shares::new(progress);
    progress.next(0.0, "records")?;
    let data = PreparedData::new(records, options, executor, &progress)?;
    let proposal = propose(&data, options, &progress)?;
    let refinement = refine(&data, &proposal, &progress)?;
    report(records, options, &data, proposal, &refinement, &progress)
}

fn check(options: &Options) -> Result<(), IdentificationError> {
    let [lowest, highest] = options.band;
    if !(lowest.is_finite() && highest.is_finite() && 0.0 < lowest && lowest < highest) {
        return Err(IdentificationError::Band { lowest, highest });
    }
    if options.inputs() == 0 && options.references > 0 {
        return Err(IdentificationError::OnlyReferences);
    }
    let within = |list: &Option<Vec<usize>>, most: usize| {
        list.as_ref().is_none_or(|list| {
            !list.is_empty() && list.iter().all(|value| (1..=most).contains(value))
        })
    };
    let poles = !options.poles.is_empty()
        && options
            .poles
            .iter()
            .all(|pole| pole.is_finite() && *pole > 0.0);
    let right =
        within(&options.orders, HIGHEST_ORDER) && within(&options.pasts, LONGEST_PAST) && poles;
    if right {
        Ok(())
    } else {
        Err(IdentificationError::Settings)
    }
}

/// Uncertainty, bundle and validation of the recommended model.
fn report(
    records: &[FlightRecord],
    options: &Options,
    data: &PreparedData,
    proposal: Proposal,
    refinement: &Refinement,
    progress: &Shares,
) -> Result<Identification, IdentificationError> {
    let no_model = || data.no_model();
    progress.next(0.8, "uncertainty")?;
    let Refinement {
        search,
        fit,
        likelihood,
        ..
    } = refinement;
    let executor = likelihood.executor;
    let systems = fit.systems(likelihood).ok_or_else(no_model)?;
    let covariance =
        ParameterCovariance::of(likelihood, fit, &systems, fit.cost).ok_or_else(no_model)?;
    // By way of a reference the cost says nothing: what is known is what the lines as logged tell of this model (M14.15).
    let of_lines = |direct| ParameterCovariance::of_lines(direct, fit).ok_or_else(no_model);
    let logged = data.direct.as_ref().map(of_lines).transpose()?;
    let known = logged.as_ref().unwrap_or(&covariance);
    // By way of a reference nothing is fed back, and every record is seen as the same reference shows it.
    let is_direct = options.references == 0;
    // Of inputs that were moved only together nothing tells what is fed back.
    let is_told = is_direct
        && !data
            .cautions
            .iter()
            .any(IdentificationCaution::is_of_collinear_inputs);
    let feedback = if is_told {
        Feedback::of(data, &fit.model, options.band, executor)
    } else {
        None
    };
    let neighbours = search.neighbours();
    let omegas = log_spaced(options.band[0], options.band[1], BAND_POINTS);
    let bands = known
        .bands(
            &fit.model,
            &neighbours,
            feedback.as_ref(),
            &omegas,
            executor,
        )
        .ok_or_else(no_model)?;
    let bands = if is_direct {
        bands
    } else {
        data.measured.widened(&bands).ok_or_else(no_model)?
    };
    let not_identified = not_identified(&bands);

    progress.next(0.88, "models without each record")?;
    let without = without_each_record(likelihood, fit, &systems);
    progress.next(0.93, "validation")?;
    let fits = RecordFits::of(data, &fit.model, &covariance).ok_or_else(no_model)?;
    let diagnostics = Diagnostics {
        records,
        options,
        data,
        fit,
    };
    let mut cautions = data.cautions.clone();
    cautions.extend(refinement.caution.clone());
    let level = feedback
        .as_ref()
        .map_or(FeedbackLevel::None, Feedback::level);
    cautions.extend(
        feedback
            .as_ref()
            .filter(|_| level > FeedbackLevel::None)
            .map(|of| {
                let share = of.share;
                let significance = of.significance;
                IdentificationCaution::Feedback {
                    level,
                    share,
                    significance,
                }
            }),
    );
    let mut contrasts = Vec::new();
    if is_direct {
        cautions.extend(diagnostics.adequacy(&fits));
        let first = refinement.before_weighing.as_ref().unwrap_or(fit);
        let of_records =
            RecordContrasts::of(&data.likelihood, &data.spectra, first).ok_or_else(no_model)?;
        let contradiction = of_records.caution(level > FeedbackLevel::None, &diagnostics);
        cautions.retain(|of| contradiction.as_ref().is_none_or(|why| !why.explains(of)));
        cautions.extend(contradiction);
        contrasts = of_records.contrasts;
    }
    cautions.extend(diagnostics.departures());
    if search.still_falls {
        let narrower = [options.band[0], NARROWER * options.band[1]];
        cautions.push(IdentificationCaution::OrderLimit {
            order: search.order,
            narrower,
        });
    }
    cautions.extend(diagnostics.unidentified_pairs(&not_identified));
    let unstable = fast_unstable_pole(&fit.model, options.highest());
    cautions.extend(unstable.map(|pole| IdentificationCaution::Unstable {
        pole,
        highest: options.highest(),
    }));

    let unrefined = &proposal
        .starts
        .get(&search.order)
        .ok_or_else(no_model)?
        .model;
    let model = |name: String, method: &str, model: &BlockModel, without: Option<usize>| {
        let dynamics = Dynamics::StateSpace(data.in_units(model)?);
        let origin = Origin::Identified {
            method: Some(method.to_owned()),
            order: Some(model.order()),
        };
        let source = Some(Provenance {
            records: options.fitted(records, without),
            ..Provenance::default()
        });
        Some(Model {
            source,
            ..Model::new(name, origin, dynamics)
        })
    };
    let of_order = |method: &str, of: &BlockModel| {
        model(format!("{method}, order {}", of.order()), method, of, None)
    };
    let mut refined = of_order(REFINED, &fit.model).ok_or_else(no_model)?;
    refined.bands = Some(Arc::new(bands));
    let mut bundle: Vec<Model> = neighbours
        .iter()
        .filter_map(|of| of_order(REFINED, of))
        .collect();
    bundle.extend(without.iter().filter_map(|(record, left)| {
        let name = format!("{REFINED}, without {}", diagnostics.record_name(*record));
        model(name, REFINED, left, Some(*record))
    }));
    let validation = match data.held_out_segments.as_slice() {
        [] => None,
        // An unstable pole that no line shows would end the windows after a few samples.
        _ if unstable.is_some() => None,
        segments => {
            let settings = ValidationSettings::filtered(options.highest());
            let model = data.in_units(&fit.model).ok_or_else(no_model)?;
            let validation = validate(&model, segments, &settings, executor);
            validation
                .map_err(|why| cautions.push(IdentificationCaution::NotValidated(why)))
                .ok()
        }
    };
    progress.next(1.0, "done")?;
    Ok(Identification {
        refined,
        unrefined: of_order(UNREFINED, unrefined).ok_or_else(no_model)?,
        bundle,
        measured: data.measured.in_units(&data.scales),
        poles: known.poles(&fit.model, options.band[0]),
        stabilisation: proposal.stabilisation,
        laguerre_pole: proposal.laguerre_pole,
        past: proposal.past,
        criteria: search
            .criteria
            .iter()
            .map(|(order, value)| (*order, *value))
            .collect(),
        cost: fits.cost,
        held_out_cost: fits.held_out.map(|(raw, _)| raw),
        held_out_normalised: fits.held_out.map(|(_, normalised)| normalised),
        feedback,
        contrasts,
        record_fits: fits.records,
        output_costs: fits.outputs,
        validation,
        record_uses: data.record_uses.clone(),
        not_identified,
        cautions,
    })
}

/// Output and input of the responses that are known too badly in the middle of the band.
fn not_identified(bands: &ModelBands) -> Vec<(usize, usize)> {
    let outputs = bands.sd_db().outputs();
    let inputs = bands.sd_db().inputs();
    let pairs =
        (0..inputs).flat_map(|input| (0..outputs).map(move |output| Pair { output, input }));
    let is_wide = |pair: &Pair| bands.sd_db()[*pair][bands.omega().len() / 2] > NOT_IDENTIFIED;
    pairs
        .filter(is_wide)
        .map(|pair| (pair.output, pair.input))
        .collect()
}

// What an identification is asked for.

/// The band, the channels, which records are held out, and what is tried. The defaults are those of M14, section 9: fixed on
/// five conditions of the example, and right on the other six, on fresh noise and on half the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Lower and upper end of the band \[rad/s\].
    pub band: [f64; 2],
    /// The channels, and how they are prepared.
    pub preparation: Preparation,
    /// How many of the inputs, the last ones, are no inputs of the model but recorded references that drove the loop from outside (M14.15).
    pub references: usize,
    /// Records that no model is fitted to, counted from 0: they judge the model.
    pub held_out: Vec<usize>,
    /// Orders that are tried; none: those that the records can carry (M14.13).
    pub orders: Option<Vec<usize>>,
    /// Laguerre poles over the upper end of the band.
    pub poles: Vec<f64>,
    /// Past windows: Laguerre projections that predict the next; none: those that the records can carry (M14.13).
    pub pasts: Option<Vec<usize>>,
}

impl Options {
    /// The defaults for a band \[rad/s\] and channels.
    #[must_use]
    pub fn new(band: [f64; 2], preparation: Preparation) -> Self {
        Self {
            band,
            preparation,
            references: 0,
            held_out: Vec::new(),
            orders: None,
            poles: vec![0.375, 0.54, 0.75],
            pasts: None,
        }
    }

    /// Inputs of the model.
    pub(super) fn inputs(&self) -> usize {
        self.preparation
            .inputs
            .len()
            .saturating_sub(self.references)
    }

    /// Names of the records that models are fitted to, but for the one of the number `without`.
    pub(super) fn fitted(&self, records: &[FlightRecord], without: Option<usize>) -> Vec<String> {
        let fitted = |index: &usize| !self.held_out.contains(index) && Some(*index) != without;
        (0..records.len())
            .filter(fitted)
            .map(|index| records[index].name.clone())
            .collect()
    }

    /// A channel by its place, with its name.
    pub(super) fn signal(&self, role: ChannelSide, index: usize) -> Signal {
        let channels = role.of(&self.preparation.inputs, &self.preparation.outputs);
        Signal {
            role,
            index,
            name: channels
                .get(index)
                .map_or_else(String::new, |channel| channel.name.clone()),
        }
    }

    /// Lowest line used \[rad/s\]: half the lower end of the band.
    pub(super) fn lowest(&self) -> f64 {
        0.5 * self.band[0]
    }

    /// Highest line used \[rad/s\]: 4/3 of the upper end of the band.
    pub(super) fn highest(&self) -> f64 {
        4.0 / 3.0 * self.band[1]
    }
}

/// What is tried in place of the defaults; an empty list leaves them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchSpace {
    /// Orders.
    pub orders: Vec<usize>,
    /// Past windows, in Laguerre projections.
    pub pasts: Vec<usize>,
    /// Laguerre poles \[rad/s\].
    pub poles: Vec<f64>,
}

impl SearchSpace {
    /// Sets what is tried.
    pub fn set(&self, options: &mut Options) {
        let said = |list: &[usize]| (!list.is_empty()).then(|| list.to_vec());
        options.orders = said(&self.orders).or(options.orders.take());
        options.pasts = said(&self.pasts).or(options.pasts.take());
        if !self.poles.is_empty() {
            options.poles = self
                .poles
                .iter()
                .map(|pole| pole / options.band[1])
                .collect();
        }
    }
}

// Why nothing could be identified.

/// The highest order that may be asked for.
pub const HIGHEST_ORDER: usize = 60;
/// The longest past window that may be asked for.
pub const LONGEST_PAST: usize = 60;

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationError {
    /// The records cannot be prepared.
    #[error(transparent)]
    Preparation(#[from] PreparationError),
    /// The channels cannot be scaled.
    #[error(transparent)]
    Scaling(#[from] ScalingError),
    /// The response cannot be measured.
    #[error(transparent)]
    Measurement(#[from] LocalPolynomialError),
    /// The records are too short for the lower end of the band, and would do for a higher one.
    #[error(
        "the longest record lasts {longest_s:.0} s: {lowest:.2} rad/s needs {needed_s:.1} s, better {better_s:.0} s. From \
         {enough:.2} rad/s on the records would do"
    )]
    TooShort {
        /// Length of the longest \[s\].
        longest_s: f64,
        /// Lower end of the band \[rad/s\].
        lowest: f64,
        /// Length that it takes \[s\]: 1.5 periods.
        needed_s: f64,
        /// Length that is better \[s\]: 5 periods, or 3 an input where several are moved in one record.
        better_s: f64,
        /// Lower end of the band for which the records are long enough \[rad/s\].
        enough: f64,
    },
    /// Fewer figures than even a model of the first order takes.
    #[error(
        "the lines of the records in the band are {figures} real figures, and {needed} are needed, 5 for each of the {unknowns} \
         unknowns of a model of order 1: log longer or more records, widen the band, or leave out channels"
    )]
    TooFewFigures {
        /// Real figures.
        figures: usize,
        /// How many it takes.
        needed: usize,
        /// Unknowns of a model of order 1.
        unknowns: usize,
    },
    /// The band is no band.
    #[error(
        "a band from {lowest} to {highest} rad/s: its lower end must be greater than 0, and its upper end above it"
    )]
    Band {
        /// Lower end \[rad/s\].
        lowest: f64,
        /// Upper end \[rad/s\].
        highest: f64,
    },
    /// The records are sampled too slowly for the band.
    #[error(
        "the band ends at {highest} rad/s, but a sample time of {sample_time_s:.4} s is too long for that: \
         end the band below {limit:.1} rad/s, or log faster"
    )]
    SampledTooSlowly {
        /// Upper end \[rad/s\].
        highest: f64,
        /// The longest sample time \[s\].
        sample_time_s: f64,
        /// Highest upper end that can be had \[rad/s\].
        limit: f64,
    },
    /// No orders, past windows or poles, or impossible ones.
    #[error(
        "orders and past windows must be given, from 1 to {HIGHEST_ORDER} and from 1 to {LONGEST_PAST}, \
         and Laguerre poles greater than 0"
    )]
    Settings,
    /// All inputs are references.
    #[error("every input is given as a reference: at least one input of the model has to be left")]
    OnlyReferences,
    /// A held-out record is not there.
    #[error("record {} is to be held out, but there are only {records}", record + 1)]
    HeldOutMissing {
        /// Which, counted from 0.
        record: usize,
        /// Records there are.
        records: usize,
    },
    /// All records are held out, or cannot be used.
    #[error("no record is left to fit a model to: hold out fewer")]
    NothingToFit,
    /// Inputs that are copies of each other.
    #[error("{} move as one in every record: leave out all but one, or fly them apart", names(.0))]
    InputsDepend(Vec<Signal>),
    /// Outputs whose noise cannot be told apart.
    #[error(
        "the outputs depend on each other so closely that their noise cannot be weighed: leave out the copies"
    )]
    OutputsDepend,
    /// No model could be made.
    #[error(
        "no model came of {lines} spectral lines in {seconds:.0} s of records: log longer or more records, \
         widen the band, or leave out channels"
    )]
    NoModel {
        /// Spectral lines of all records.
        lines: usize,
        /// Their length \[s\].
        seconds: f64,
    },
    /// It was stopped.
    #[error("the identification was stopped")]
    Stopped(#[from] Cancelled),
}
