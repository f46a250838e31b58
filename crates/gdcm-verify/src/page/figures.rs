//! Figures that tests record for the page `docs/verification.md`, one JSON line each: deviations
//! from independent values, or the coverage of confidence intervals.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Deserialize, Serialize};

/// Deviations up to this size are rounding, which differs from processor to processor.
const ROUNDING: f64 = 1e-9;
/// Maximum ratio between two larger deviations that count as the same figure, since they depend on
/// where an iteration stops.
const SAME_RATIO: f64 = 2.0;
/// Maximum difference between two coverages (shares from 0 to 1) that count as the same figure.
const SAME_SHARE: f64 = 0.005;

/// Deviations from independent figures, as a test records them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviations {
    pub code: String,
    /// Crate that contains `test`.
    #[serde(rename = "crate")]
    pub package: String,
    pub test: String,
    pub instances: usize,
    pub values: usize,
    pub worst: f64,
    pub tolerance: f64,
}

/// How many of a test's confidence intervals contain the true value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    pub code: String,
    #[serde(rename = "crate")]
    pub package: String,
    pub test: String,
    pub intervals: usize,
    /// Count of intervals that contain the true value.
    pub covered: usize,
    /// Nominal share, 0 to 1.
    pub nominal: f64,
    /// Seeds that generated the data.
    pub seeds: String,
}

/// All figures on the page, by code.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub deviations: BTreeMap<String, Deviations>,
    pub coverage: BTreeMap<String, Coverage>,
}

/// Reason why a figure is unreadable, missing or different from the page.
#[derive(Debug, thiserror::Error)]
pub enum FigureFault {
    #[error("{path}: {reason}")]
    Unreadable { path: String, reason: String },
    #[error("{code}: recorded by no test")]
    Missing { code: String },
    #[error("{code}: recorded by a test, not on the page")]
    New { code: String },
    #[error("{code}: expected {known} as on the page, found {fresh}")]
    Differs {
        code: String,
        known: String,
        fresh: String,
    },
}

impl Figures {
    /// Reads the lines that tests wrote into `folder`.
    ///
    /// # Errors
    /// [`FigureFault::Unreadable`] if the folder or a line cannot be read.
    pub fn read(folder: &Path) -> Result<Self, FigureFault> {
        let mut figures = Self::default();
        let entries = std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
        for entry in entries {
            let path = match entry {
                Ok(entry) => entry.path(),
                Err(error) => return Err(unreadable(folder, &error)),
            };
            let text = std::fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))?;
            for line in text.lines() {
                figures
                    .add(line)
                    .map_err(|error| unreadable(&path, &error))?;
            }
        }
        Ok(figures)
    }

    /// Adds a figure from a JSON line; it replaces an earlier one with the same code.
    fn add(&mut self, line: &str) -> Result<(), serde_json::Error> {
        let value: serde_json::Value = serde_json::from_str(line)?;
        if value.get("nominal").is_some() {
            let coverage: Coverage = serde_json::from_value(value)?;
            self.coverage.insert(coverage.code.clone(), coverage);
        } else {
            let deviations: Deviations = serde_json::from_value(value)?;
            self.deviations.insert(deviations.code.clone(), deviations);
        }
        Ok(())
    }

    /// Compares these figures, those on the page, with fresh ones, code by code; returns those that
    /// are missing, different or new.
    pub fn differences(&self, fresh: &Self) -> Vec<FigureFault> {
        let mut faults = Vec::new();
        for (code, known) in &self.deviations {
            match fresh.deviations.get(code) {
                None => faults.push(FigureFault::Missing { code: code.clone() }),
                Some(fresh) if known.agrees(fresh) => {}
                Some(fresh) => faults.push(FigureFault::Differs {
                    code: code.clone(),
                    known: format!("{known:?}"),
                    fresh: format!("{fresh:?}"),
                }),
            }
        }
        for (code, known) in &self.coverage {
            match fresh.coverage.get(code) {
                None => faults.push(FigureFault::Missing { code: code.clone() }),
                Some(fresh) if known.agrees(fresh) => {}
                Some(fresh) => faults.push(FigureFault::Differs {
                    code: code.clone(),
                    known: format!("{known:?}"),
                    fresh: format!("{fresh:?}"),
                }),
            }
        }
        let known = self.deviations.keys().chain(self.coverage.keys());
        let known: BTreeSet<&String> = known.collect();
        for code in fresh.deviations.keys().chain(fresh.coverage.keys()) {
            if !known.contains(code) {
                faults.push(FigureFault::New { code: code.clone() });
            }
        }
        faults
    }

    /// Replaces the figures that differ from fresh ones, and adds new ones; figures without a fresh
    /// one remain.
    pub fn update(&mut self, fresh: &Self) {
        for (code, fresh) in &fresh.deviations {
            match self.deviations.get(code) {
                Some(known) if known.agrees(fresh) => {}
                _ => {
                    self.deviations.insert(code.clone(), fresh.clone());
                }
            }
        }
        for (code, fresh) in &fresh.coverage {
            match self.coverage.get(code) {
                Some(known) if known.agrees(fresh) => {}
                _ => {
                    self.coverage.insert(code.clone(), fresh.clone());
                }
            }
        }
    }
}

fn unreadable(path: &Path, error: &dyn std::error::Error) -> FigureFault {
    FigureFault::Unreadable {
        path: path.display().to_string(),
        reason: error.to_string(),
    }
}

impl Deviations {
    /// Returns whether two runs of a test give the same figure: equal test, counts and tolerance,
    /// and worst deviations that are both rounding or within a factor of 2.
    fn agrees(&self, other: &Self) -> bool {
        let is_same_test = self.package == other.package && self.test == other.test;
        let is_same_count = self.instances == other.instances && self.values == other.values;
        let is_same_worst = if self.worst <= ROUNDING || other.worst <= ROUNDING {
            self.worst <= ROUNDING && other.worst <= ROUNDING
        } else {
            self.worst <= SAME_RATIO * other.worst && other.worst <= SAME_RATIO * self.worst
        };
        is_same_test && is_same_count && is_same_worst && self.tolerance == other.tolerance
    }
}

impl Coverage {
    /// Returns the share of intervals that contain the true value, 0 to 1.
    pub fn share(&self) -> f64 {
        self.covered as f64 / self.intervals as f64
    }

    /// Returns whether two runs of a test give the same figure: equal test, interval count, seeds
    /// and nominal share, and shares that differ by at most 0.005.
    fn agrees(&self, other: &Self) -> bool {
        self.package == other.package
            && self.test == other.test
            && self.intervals == other.intervals
            && self.seeds == other.seeds
            && self.nominal == other.nominal
            && (self.share() - other.share()).abs() <= SAME_SHARE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(worst: f64, covered: usize) -> Figures {
        let mut figures = Figures::default();
        let deviation = format!(
            "{{\"code\":\"a\",\"crate\":\"c\",\"test\":\"t\",\"instances\":3,\"values\":9,\
             \"worst\":{worst},\"tolerance\":1e-6}}"
        );
        let coverage = format!(
            "{{\"code\":\"b\",\"crate\":\"c\",\"test\":\"u\",\"intervals\":1000,\"covered\":{covered},\
             \"nominal\":0.9,\"seeds\":\"1\"}}"
        );
        for line in [deviation, coverage] {
            figures.add(&line).expect("a line of figures");
        }
        figures
    }

    #[test]
    fn rounding_is_the_same_figure_and_larger_changes_are_not() {
        let known = figures(3e-13, 905);
        for (fresh, differences) in [
            (figures(9e-12, 905), 0),
            (figures(3e-13, 908), 0),
            (figures(2e-8, 905), 1),
            (figures(3e-13, 880), 1),
            (Figures::default(), 2),
        ] {
            assert_eq!(known.differences(&fresh).len(), differences, "{fresh:?}");
        }
    }

    #[test]
    fn a_figure_that_the_page_lacks_is_a_difference() {
        let differences = Figures::default().differences(&figures(3e-13, 905));
        assert!(
            matches!(&differences[..], [FigureFault::New { code: a }, FigureFault::New { code: b }]
                if a == "a" && b == "b"),
            "{differences:?}"
        );
    }

    #[test]
    fn only_changed_figures_are_replaced() {
        let mut known = figures(3e-13, 905);
        known.update(&figures(9e-12, 880));
        assert_eq!(known.deviations["a"].worst, 3e-13);
        assert_eq!(known.coverage["b"].covered, 880);
    }
}
