//! The way to a value within a variable.

use crate::variables::VariableFault;

/// How many values may lie in one another.
const DEEPEST: usize = 64;

/// The way from a variable to a value in it, one step at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldPath<'t> {
    before: Option<&'t FieldPath<'t>>,
    step: Step<'t>,
    depth: usize,
}

/// One step on the way.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step<'t> {
    /// The variable, or a way that was gone already.
    Start(&'t str),
    /// A field of a record.
    Field(&'t str),
    /// One of several records, counted from 0.
    Record(usize),
    /// A value in a cell array, counted from 0.
    Cell(usize),
}

impl<'t> FieldPath<'t> {
    /// At the variable itself.
    pub(super) fn start(name: &'t str) -> Self {
        Self { before: None, step: Step::Start(name), depth: 0 }
    }

    /// One step on.
    pub(super) fn step(&'t self, step: Step<'t>) -> Result<FieldPath<'t>, VariableFault> {
        if self.depth >= DEEPEST {
            return Err(VariableFault::TooDeep { variable: self.words() });
        }
        Ok(FieldPath { before: Some(self), step, depth: self.depth + 1 })
    }

    /// The way as MATLAB writes it: "sys.A", "models{3}.B".
    pub(super) fn words(&self) -> String {
        let before = self.before.map(FieldPath::words).unwrap_or_default();
        match self.step {
            Step::Start(name) => name.to_owned(),
            Step::Field(name) => format!("{before}.{name}"),
            Step::Record(at) => format!("{before}({})", at + 1),
            Step::Cell(at) => format!("{before}{{{}}}", at + 1),
        }
    }

    /// Says in a fault which value it concerns, unless it says so already.
    pub(super) fn name(&self, mut fault: VariableFault) -> VariableFault {
        match &mut fault {
            VariableFault::CutOff { variable, .. }
            | VariableFault::Damaged { variable, .. }
            | VariableFault::Unsupported { variable, .. }
            | VariableFault::TooLarge { variable, .. }
            | VariableFault::Line { variable, .. }
            | VariableFault::TooDeep { variable } => {
                if variable.is_empty() {
                    *variable = self.words();
                }
            }
            VariableFault::Format { .. } | VariableFault::Duplicate { .. } | VariableFault::Stopped => {}
        }
        fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_is_written_as_in_matlab() {
        let start = FieldPath::start("models");
        let cell = start.step(Step::Cell(2)).unwrap();
        let record = cell.step(Step::Record(0)).unwrap();
        assert_eq!(record.step(Step::Field("B")).unwrap().words(), "models{3}(1).B");
    }

    #[test]
    fn the_first_name_stays() {
        let fault = VariableFault::TooDeep { variable: String::new() };
        let named = FieldPath::start("a").name(fault);
        assert_eq!(FieldPath::start("b").name(named), VariableFault::TooDeep { variable: "a".to_owned() });
    }

    #[test]
    fn the_way_ends() {
        fn deeper(trail: &FieldPath<'_>) -> VariableFault {
            trail.step(Step::Cell(0)).map_or_else(|fault| fault, |next| deeper(&next))
        }
        assert!(matches!(deeper(&FieldPath::start("a")), VariableFault::TooDeep { .. }));
    }
}
