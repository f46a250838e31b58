//! Commands that stop and resume the computation.

#[derive(Clone, Debug, PartialEq)]
pub enum ComputingCommand {
    /// Stops reading a file; if none is being read, stops the computation.
    StopComputing,
    /// Resumes a stopped computation.
    Compute,
}
