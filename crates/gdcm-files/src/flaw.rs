//! Something wrong in a file.

use super::content_fault::ContentFault;
use gdcm_core::dataset::{DraftError, Place};

/// What is wrong in a file, and where. Boxed, so that results that are mostly right stay small.
#[derive(Debug)]
pub(super) struct Flaw {
    pub(super) place: Box<Place>,
    pub(super) fault: Box<ContentFault>,
}

impl From<DraftError> for Flaw {
    fn from(error: DraftError) -> Self {
        Self { place: error.place, fault: Box::new((*error.fault).into()) }
    }
}

impl Flaw {
    pub(super) fn new(place: Place, fault: impl Into<ContentFault>) -> Self {
        Self { place: Box::new(place), fault: Box::new(fault.into()) }
    }
}
