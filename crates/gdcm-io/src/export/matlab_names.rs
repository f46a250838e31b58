//! Names that MATLAB accepts for fields and functions.

use crate::export_fault::ExportFault;

/// Maximum name length in MATLAB (`namelengthmax`).
const LONGEST_NAME: usize = 63;
/// Reserved words in MATLAB (`iskeyword`) and GNU Octave, and function names in the exported file.
const KEYWORDS: &str = "break case catch classdef continue do else elseif end end_try_catch end_unwind_protect endfor \
    endfunction endif endparfor endswitch endwhile for function global if otherwise parfor persistent return spmd switch try \
    until unwind_protect unwind_protect_cleanup while gdcm_polynomial gdcm_table";

/// Returns a name that MATLAB accepts for a field: characters other than ASCII letters and digits
/// become _, an x precedes a first character that is no letter, and the name is cut to
/// [`LONGEST_NAME`].
pub(super) fn valid_name(name: &str) -> String {
    let mut valid = String::new();
    if !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
        valid.push('x');
    }
    for letter in name.chars() {
        if valid.len() == LONGEST_NAME {
            break;
        }
        let is_valid = letter.is_ascii_alphanumeric();
        valid.push(if is_valid { letter } else { '_' });
    }
    valid
}

/// Rejects a file name that is not a valid MATLAB function name.
pub(super) fn check_function_name(name: &str) -> Result<(), ExportFault> {
    let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.len() <= LONGEST_NAME
        && name
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    let is_keyword = KEYWORDS.split(' ').any(|word| word == name);
    if !is_name || is_keyword {
        return Err(ExportFault::FunctionName {
            found: name.to_owned(),
        });
    }
    Ok(())
}
