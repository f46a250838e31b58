//! Progress reports and cancellation of a fit.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_model::executor::Sequential;
use gdcm_model::progress::{Cancelled, Progress};

use super::{disturbed, many_channels};
use crate::couplings::fit_couplings;
use crate::couplings::jackknife::left_out_fits;
use crate::couplings::problem::CouplingError;

/// A progress listener that cancels immediately.
struct Impatient;

impl Progress for Impatient {
    fn cancelled(&self) -> bool {
        true
    }

    fn advanced(&self, _done: usize, _total: usize) {}
}

#[test]
fn a_cancelled_fit_ends() {
    assert_eq!(
        fit_couplings(&disturbed(), &Sequential, &Impatient),
        Err(CouplingError::Cancelled(Cancelled))
    );
    assert!(left_out_fits(&disturbed(), &Sequential, &Impatient).is_err());
}

/// Keeps the reports of progress, in thousandths, and cancels after a number of polls.
struct Listener {
    polls_left: AtomicUsize,
    reports: Mutex<Vec<usize>>,
}

impl Listener {
    fn cancelling_after(polls: usize) -> Self {
        Self {
            polls_left: AtomicUsize::new(polls),
            reports: Mutex::default(),
        }
    }
}

impl Progress for Listener {
    fn cancelled(&self) -> bool {
        self.polls_left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                left.checked_sub(1)
            })
            .is_err()
    }

    fn advanced(&self, done: usize, total: usize) {
        assert_eq!(total, 1000);
        self.reports.lock().unwrap().push(done);
    }
}

#[test]
fn a_fit_reports_every_condition_in_every_pass_in_order() {
    let listener = Listener::cancelling_after(usize::MAX);
    fit_couplings(&disturbed(), &Sequential, &listener).unwrap();
    let reports = listener.reports.into_inner().unwrap();
    // Progress is counted in thousandths. Each of the five passes reports four conditions and the
    // solution, 40 thousandths each; then the end is reported, the 26th report.
    assert_eq!(
        (
            reports.len(),
            reports[0],
            reports[4],
            *reports.last().unwrap()
        ),
        (26, 40, 200, 1000),
        "{reports:?}"
    );
    assert!(reports.is_sorted());
}

#[test]
fn a_fit_can_be_cancelled_within_a_condition() {
    let problem = many_channels(2, 1, 200);
    let listener = Listener::cancelling_after(3);
    let stopped = fit_couplings(&problem, &Sequential, &listener);
    assert_eq!(stopped, Err(CouplingError::Cancelled(Cancelled)));
    assert!(
        listener.reports.into_inner().unwrap().is_empty(),
        "cancelled only after the first condition of the first pass"
    );
}

#[test]
fn the_fits_without_each_condition_are_reported_step_by_step() {
    let listener = Listener::cancelling_after(usize::MAX);
    left_out_fits(&disturbed(), &Sequential, &listener).unwrap();
    let reports = listener.reports.into_inner().unwrap();
    // Four fits, each of five passes with three conditions and the solution: 20 reports.
    assert!(
        reports.len() >= 4 * 20 && reports.is_sorted() && *reports.last().unwrap() >= 999,
        "{reports:?}"
    );
}
