//! Remarks: sentences about a result, with their kind and suggested decisions.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::Pair;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::signs::SignRole;

/// Kind of a remark: whether a request was fulfilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemarkKind {
    /// The request was fulfilled.
    Good,
    /// The request was fulfilled, with a caution.
    Caution,
    /// The request could not be fulfilled.
    Trouble,
}

/// A remark on a result, with the decision that it suggests, if any.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Stable code, for programs and tests.
    pub code: &'static str,
    pub kind: RemarkKind,
    /// One or two sentences.
    pub text: String,
    /// The response that the user may exclude from the objective, if suggested.
    pub ignore: Option<Pair>,
    /// The phase correction that the user may choose instead, if suggested.
    pub phase: Option<PhaseCorrection>,
    /// The channel whose sign the user may reverse or, if the role is `None`, restore.
    pub turn: Option<(Channel, Option<SignRole>)>,
    /// Content for a common table, used if many conditions have this remark.
    pub repeated: Option<Repeated>,
}

/// Content of a remark that many conditions have; such remarks are collected in a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repeated {
    /// Constrained responses need lead: each response with its lead \[ms\].
    NeedsLead(Vec<(Pair, String)>),
    /// All constrained responses need about this lead \[ms\].
    CommonLead(String),
    /// Constrained responses that are farther from flight with the correction than without it.
    Farther(Vec<Pair>),
    /// Maximum gain increase \[dB\] within the band due to the lead filters, and the response in
    /// which it occurs.
    RaisedGain(String, Pair),
    /// Mean J over the constrained responses, without and with leads.
    LeadsOffered([String; 2]),
}

impl Remark {
    /// Creates a remark without a suggested decision.
    pub fn new(code: &'static str, kind: RemarkKind, text: String) -> Self {
        Self {
            code,
            kind,
            text,
            ignore: None,
            phase: None,
            turn: None,
            repeated: None,
        }
    }

    /// Creates the remark that a request was fulfilled.
    pub fn good(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Good, text.into())
    }

    /// Creates the remark that a request was fulfilled, with a caution.
    pub fn caution(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Caution, text.into())
    }

    /// Creates the remark that a request could not be fulfilled.
    pub fn trouble(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Trouble, text.into())
    }

    /// Returns the remark with content for the common table of many conditions.
    pub(crate) fn repeated(self, repeated: Repeated) -> Self {
        Self {
            repeated: Some(repeated),
            ..self
        }
    }
}
