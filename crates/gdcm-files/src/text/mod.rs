//! Texts that hold numbers: tables in columns, frequency responses, matrices and MATLAB literals.

mod cell_number;
mod clock;
mod column_guess;
mod column_meaning;
mod columns;
mod encoding;
mod frequency_columns;
mod frequency_values;
mod heading;
mod layout;
mod lines;
mod literals;
mod matrix_text;
mod printed_line;
mod response_columns;
mod response_label;
mod sections;
mod separator;
mod unit_word;
mod word_columns;

pub use column_meaning::says_quantity;
pub use columns::{TextTable, read_table};
pub use encoding::decode;
pub use frequency_columns::{FrequencyColumns, RecognisedResponse};
pub use frequency_values::ResponsePoints;
pub use literals::read_literals;
pub use matrix_text::{read_matrices, read_matrix};
pub use sections::sections;
pub use word_columns::{NumberedText, numbered_words};
