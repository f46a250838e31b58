//! Sentences about a record's problems: problems of the same kind with several channels share a
//! sentence, "no column for P, Q; …" instead of one sentence for P and one for Q.

use gdcm_sysid::records::LayoutProblem;
use gdcm_sysid::records::record_table::shortened_list;

/// Describes a record's problems; several missing columns share one sentence, as do several unknown
/// units.
pub(super) fn problem_texts(problems: &[LayoutProblem]) -> Vec<String> {
    let mut missing = ChannelProblems::default();
    let mut without_unit = ChannelProblems::default();
    let mut others = Vec::new();
    // The columns are the same for every channel, because all channels belong to one record.
    let mut columns = String::new();
    for problem in problems {
        match problem {
            LayoutProblem::NoColumn { channel, found, .. } => {
                columns = shortened_list(found);
                missing.push(channel, problem);
            }
            LayoutProblem::UnitNotGiven { channel, .. } => without_unit.push(channel, problem),
            _ => others.push(problem.to_string()),
        }
    }
    let mut texts = Vec::new();
    texts.extend(missing.text(|channels| {
        format!("no column for {channels}; assign them on the Columns page (columns: {columns})")
    }));
    texts.extend(without_unit.text(|channels| {
        format!(
            "the file does not give the units of {channels}, and their values allow several \
            units; choose them on the Columns page"
        )
    }));
    texts.extend(others);
    texts
}

/// Problems of the same kind, which share one sentence.
#[derive(Default)]
struct ChannelProblems<'a> {
    channels: Vec<&'a str>,
    /// First problem's message.
    first: Option<String>,
}

impl<'a> ChannelProblems<'a> {
    fn push(&mut self, channel: &'a str, problem: &LayoutProblem) {
        self.channels.push(channel);
        if self.first.is_none() {
            self.first = Some(problem.to_string());
        }
    }

    /// Returns the message of a single problem, or `shared` applied to the names of several
    /// channels.
    fn text(self, shared: impl FnOnce(String) -> String) -> Option<String> {
        if self.channels.len() > 1 {
            Some(shared(self.channels.join(", ")))
        } else {
            self.first
        }
    }
}
