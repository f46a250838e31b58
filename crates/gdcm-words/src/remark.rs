//! Remarks: sentences about a result, with their kind and suggested decisions.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::Pair;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::signs::SignRole;

/// A remark's kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemarkKind {
    /// The request was fulfilled.
    Good,
    /// The request was fulfilled, with a caution.
    Caution,
    /// The request could not be fulfilled.
    Trouble,
}

/// A remark on a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The remark's stable code, for programs and tests.
    pub code: &'static str,
    pub kind: RemarkKind,
    /// One or two sentences.
    pub text: String,
    /// The response that the user may exclude from the objective, if suggested.
    pub ignore: Option<Pair>,
    /// The phase correction that the user may choose instead, if suggested.
    pub phase: Option<PhaseCorrection>,
    /// The channel whose sign the user may reverse, or restore if the role is `None`.
    pub turn: Option<(Channel, Option<SignRole>)>,
    /// Content for a common table, if many conditions have the remark.
    pub repeated: Option<Repeated>,
}

/// Content of a remark that many conditions have; such remarks are collected in a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repeated {
    /// Constrained responses need lead, with each response's lead \[ms\].
    NeedsLead(Vec<(Pair, String)>),
    /// All constrained responses need about the same lead \[ms\].
    CommonLead(String),
    /// Constrained responses are farther from flight than without a correction.
    Farther(Vec<Pair>),
    /// Maximum gain increase within the band by the lead filters \[dB\], and its response.
    RaisedGain(String, Pair),
    /// Mean J over the constrained responses without leads, and with them.
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

    /// Creates a caution.
    pub fn caution(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Caution, text.into())
    }

    /// Creates the remark that a request could not be fulfilled.
    pub fn trouble(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Trouble, text.into())
    }

    /// Marks the remark as one that many conditions share.
    pub(crate) fn repeated(self, repeated: Repeated) -> Self {
        Self {
            repeated: Some(repeated),
            ..self
        }
    }
}
