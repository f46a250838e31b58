//! Arrays as `NumPy` saves them: `.npy` files of one array, `.npz` archives of several.
//!
//! The format is that of NEP 1 and of `numpy.lib.format`, versions 1.0 to 3.0. `NumPy` knows arrays without and with one dimension,
//! this program does not: a number alone becomes 1 x 1, an array of n elements becomes the row 1 x n. Any other shape is kept; rows
//! stay rows, whichever way they run through the file. Pickled Python objects are programs and are refused.

mod archive;
mod archive_writer;
mod array_file;
mod element;
mod header;
mod literal;

pub use archive::read_npz;
pub use archive_writer::write_npz;
pub use array_file::read_npy;
