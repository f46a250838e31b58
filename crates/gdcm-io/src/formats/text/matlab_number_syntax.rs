//! Finds where a number ends in MATLAB or Octave statements: `1.5`, `.5e-3`, `2D+4`.

/// Returns whether there is a digit at an offset.
pub(super) fn is_digit(bytes: &[u8], at: usize) -> bool {
    bytes.get(at).is_some_and(u8::is_ascii_digit)
}

/// Returns the offset after the digits that begin at `from`.
fn past_digits(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while is_digit(bytes, at) {
        at += 1;
    }
    at
}

/// Returns the offset after the digits at the beginning, which may include a decimal point.
pub(super) fn past_mantissa(bytes: &[u8]) -> usize {
    let end = past_digits(bytes, 0);
    // A point before an operator belongs to the operator: "1./x", "2.^n", "1...".
    let is_operator = bytes
        .get(end + 1)
        .is_some_and(|byte| b"*/\\^'.".contains(byte));
    if bytes.get(end) == Some(&b'.') && !is_operator {
        past_digits(bytes, end + 1)
    } else {
        end
    }
}

/// Returns the offset after the exponent that begins at `from`; `from` if there is no exponent.
pub(super) fn past_exponent(bytes: &[u8], from: usize) -> usize {
    if !matches!(bytes.get(from), Some(b'e' | b'E' | b'd' | b'D')) {
        return from;
    }
    let has_sign = matches!(bytes.get(from + 1), Some(b'+' | b'-'));
    let digits = from + 1 + usize::from(has_sign);
    if is_digit(bytes, digits) {
        past_digits(bytes, digits)
    } else {
        from
    }
}
