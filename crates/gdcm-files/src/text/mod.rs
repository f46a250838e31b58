//! Texts that hold numbers: tables in columns, frequency responses, matrices and MATLAB literals.

mod column_guess;
mod columns;
mod frequency_columns;
mod heading;
mod literals;
mod matrix_text;
mod response_columns;
mod separator;
mod word_columns;

pub use columns::{TextTable, read_table};
pub use frequency_columns::{FrequencyColumns, RecognisedResponse, ResponsePoints, says_quantity};
pub use literals::read_literals;
pub use matrix_text::{read_matrices, read_matrix};
pub use separator::{decode, sections};
pub use word_columns::{NumberedText, numbered_words};
