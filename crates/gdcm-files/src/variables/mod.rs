//! Variables by name, as files of other programs hold them; what they mean is decided elsewhere.
//!
//! Every reader of such files (MATLAB's, NumPy's, text) gives these values and knows nothing of models.

mod array;
mod fault;
mod meter;
mod value;

pub use array::{Array, ElementKind};
pub use fault::VariableFault;
pub use meter::MemoryBudget;
pub use value::{CellArray, Object, StructArray, TextArray, Value, Variable};
