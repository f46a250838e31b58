//! Path to a value inside a variable, for errors and instructions.

use crate::reading_budget::VariableFault;

/// Maximum nesting depth of values.
const DEEPEST: usize = 64;

/// Path from a variable to a value inside it: a linked list that begins with the innermost step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValuePath<'p> {
    outer: Option<&'p ValuePath<'p>>,
    step: Step<'p>,
    depth: usize,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Step<'p> {
    /// Variable name, or a complete path as text.
    Start(&'p str),
    Field(&'p str),
    /// Index in a struct array, counted from 0.
    Record(usize),
    /// Index in a cell array, counted from 0.
    Cell(usize),
}

impl<'p> ValuePath<'p> {
    /// Creates the path to a variable.
    pub(super) fn start(name: &'p str) -> Self {
        Self {
            outer: None,
            step: Step::Start(name),
            depth: 0,
        }
    }

    /// Appends a step.
    ///
    /// # Errors
    /// [`VariableFault`] if the path exceeds the maximum depth.
    pub(super) fn step(&'p self, step: Step<'p>) -> Result<ValuePath<'p>, VariableFault> {
        if self.depth >= DEEPEST {
            return Err(VariableFault::too_deep(&self.text()));
        }
        Ok(ValuePath {
            outer: Some(self),
            step,
            depth: self.depth + 1,
        })
    }

    /// Formats the path in MATLAB notation: "sys.A", "models{3}.B".
    pub(super) fn text(&self) -> String {
        let outer = self.outer.map(ValuePath::text).unwrap_or_default();
        match self.step {
            Step::Start(name) => name.to_owned(),
            Step::Field(name) => format!("{outer}.{name}"),
            Step::Record(at) => format!("{outer}({})", at + 1),
            Step::Cell(at) => format!("{outer}{{{}}}", at + 1),
        }
    }

    /// Adds the path to an error that does not contain a variable name.
    pub(super) fn locate(&self, fault: VariableFault) -> VariableFault {
        fault.in_variable(|| self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_is_written_as_in_matlab() {
        let start = ValuePath::start("models");
        let cell = start.step(Step::Cell(2)).unwrap();
        let record = cell.step(Step::Record(0)).unwrap();
        assert_eq!(
            record.step(Step::Field("B")).unwrap().text(),
            "models{3}(1).B"
        );
    }

    #[test]
    fn the_first_name_stays() {
        let fault = VariableFault::TooDeep {
            variable: String::new(),
        };
        let named = ValuePath::start("a").locate(fault);
        assert_eq!(
            ValuePath::start("b").locate(named),
            VariableFault::TooDeep {
                variable: "a".to_owned()
            }
        );
    }

    #[test]
    fn the_depth_is_limited() {
        fn deeper(path: &ValuePath<'_>) -> VariableFault {
            match path.step(Step::Cell(0)) {
                Ok(next) => deeper(&next),
                Err(fault) => fault,
            }
        }
        assert!(matches!(
            deeper(&ValuePath::start("a")),
            VariableFault::TooDeep { .. }
        ));
    }
}
