//! Something wrong in a file.

use super::content_fault::ContentFault;
use gdcm_core::dataset::{DraftError, Location};

/// What is wrong in a file, and where. Boxed, so that results that are mostly right stay small.
#[derive(Debug)]
pub(super) struct ContentError {
    pub(super) place: Box<Location>,
    pub(super) fault: Box<ContentFault>,
}

impl From<DraftError> for ContentError {
    fn from(error: DraftError) -> Self {
        Self { place: error.place, fault: Box::new((*error.fault).into()) }
    }
}

impl ContentError {
    pub(super) fn new(place: Location, fault: impl Into<ContentFault>) -> Self {
        Self { place: Box::new(place), fault: Box::new(fault.into()) }
    }
}
