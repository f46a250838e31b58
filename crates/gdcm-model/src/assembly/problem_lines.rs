//! Describes an assembly's problems, one line for each distinct problem.

use super::assembly::Assembly;
use super::problem::Problem;

/// A problem in words, with the model to which it belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProblemLine {
    /// Index of the first model with the problem; `None` for a problem with the whole dataset.
    pub part: Option<usize>,
    /// The problem's stable code.
    pub code: &'static str,
    pub text: String,
}

impl Assembly {
    /// Describes a problem: the model, the missing or contradictory fact, and the command-line
    /// option that settles it, if there is one.
    pub fn words(&self, problem: &Problem) -> String {
        let mut words = String::new();
        if let Some(part) = problem.part {
            words.push_str(&format!("{}: ", self.parts()[part].found.key()));
        }
        words.push_str(&problem.kind.to_string());
        if let Some(option) = problem.option() {
            words.push_str(&format!(" ({option})"));
        }
        words
    }

    /// Lists the problems. A problem shared by several models appears once, with its first model
    /// and how many others share it.
    pub fn problem_lines(&self) -> Vec<ProblemLine> {
        let mut distinct: Vec<SharedProblem<'_>> = Vec::new();
        for problem in self.problems() {
            let known = distinct.iter_mut().find(|known| {
                known.first.kind == problem.kind && known.first.scope == problem.scope
            });
            match known {
                Some(known) => known.others += 1,
                None => distinct.push(SharedProblem {
                    first: problem,
                    others: 0,
                }),
            }
        }
        let mut lines = Vec::with_capacity(distinct.len());
        for SharedProblem { first, others } in distinct {
            let mut text = self.words(first);
            match others {
                0 => {}
                1 => text.push_str(" (and 1 other model)"),
                others => text.push_str(&format!(" (and {others} other models)")),
            }
            lines.push(ProblemLine {
                part: first.part,
                code: first.kind.code(),
                text,
            });
        }
        lines
    }
}

/// A problem and how many other models share it.
struct SharedProblem<'p> {
    first: &'p Problem,
    others: usize,
}
