//! What was identified from the records of a flight condition.

use super::{
    Bands, IdentificationCaution, MeasuredResponse, PoleEstimate, RecordFit, RecordUse, StabilisationPoint,
    StateSpaceMatrices, Validation,
};

/// Where a model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The recommended one: CT-PBSID, refined.
    Refined,
    /// CT-PBSID as it is, of the same order.
    Plain,
    /// Refined, of the order two less or more.
    Neighbour,
    /// Refined without the record of this number, counted from 0.
    WithoutRecord(usize),
}

/// An identified model in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentifiedModel {
    /// Its name, for people.
    pub name: String,
    /// Where it comes from.
    pub origin: Origin,
    /// The model.
    pub matrices: StateSpaceMatrices,
}

/// What was identified from the records of a flight condition, in the units of the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model.
    pub refined: IdentifiedModel,
    /// CT-PBSID without refinement, of the same order.
    pub plain: IdentifiedModel,
    /// The bundle around the recommended model: the neighbouring orders, then without each record.
    pub bundle: Vec<IdentifiedModel>,
    /// Standard deviations of the recommended model's response.
    pub bands: Bands,
    /// The response measured without a model.
    pub measured: MeasuredResponse,
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
    /// `J` per degree of freedom over the records of the fit; 1 is adequate.
    pub cost: f64,
    /// The same over the held-out records, where there are any.
    pub held_out_cost: Option<f64>,
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
