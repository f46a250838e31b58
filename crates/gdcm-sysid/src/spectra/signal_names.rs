//! Lists signal names for messages.

use gdcm_model::simulation::Signal;

/// Joins signal names: `P, Q and R`.
pub(crate) fn names(signals: &[Signal]) -> String {
    let names: Vec<&str> = signals.iter().map(|signal| signal.name.as_str()).collect();
    listed(&names)
}

/// Joins words: `P, Q and R`.
pub(crate) fn listed<S: AsRef<str> + std::borrow::Borrow<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [single] => single.as_ref().to_owned(),
        [most @ .., last] => format!("{} and {}", most.join(", "), last.as_ref()),
    }
}
