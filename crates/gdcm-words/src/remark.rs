//! Remarks: sentences about a result with their weight and the decisions that they offer.

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
    /// The response to consider ignoring in the objective.
    pub ignore: Option<Pair>,
    /// The phase correction to consider instead.
    pub phase: Option<PhaseCorrection>,
    /// The channel whose sign can be reversed, or restored (`None` as the role), at once.
    pub turn: Option<(Channel, Option<SignRole>)>,
    /// Content for one common table, where many conditions have the remark.
    pub repeated: Option<Repeated>,
}

/// A remark that most conditions share, with its numbers, so that many of them form a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repeated {
    /// Constrained responses need lead, with each response's lead \[ms\].
    NeedsLead(Vec<(Pair, String)>),
    /// All constrained responses need about the same lead \[ms\].
    CommonLead(String),
    /// Constrained responses are farther from flight than without a correction.
    Farther(Vec<Pair>),
    /// Greatest gain increase within the band by the lead filters \[dB\], and its response.
    RaisedGain(String, Pair),
    /// Mean J over the constrained responses without leads, and with them.
    LeadsOffered([String; 2]),
}

impl Remark {
    /// Creates a remark without an offer.
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

    /// Creates a remark that a request was fulfilled.
    pub fn good(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Good, text.into())
    }

    /// Creates a caution.
    pub fn caution(code: &'static str, text: impl Into<String>) -> Self {
        Self::new(code, RemarkKind::Caution, text.into())
    }

    /// Creates a remark that a request could not be fulfilled.
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
