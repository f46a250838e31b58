//! Poles as text. A complex pair is written with j before the number, so that "±" cannot be taken
//! for an error bar.

use nalgebra::Complex;

use gdcm_model::number_format::{telling, with_minus_sign};

/// Returns a real pole as "−0.300", and a complex pair as "−0.300 ± j1.200"; `decimals` of the real
/// and of the imaginary part.
pub fn pole_text(pole: Complex<f64>, decimals: [usize; 2]) -> String {
    let real = with_minus_sign(&telling(pole.re, decimals[0]));
    if pole.im == 0.0 {
        return real;
    }
    format!("{real} ± j{}", telling(pole.im.abs(), decimals[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_digit_follows_the_sign_of_a_pair() {
        let pair = pole_text(Complex::new(-2.541, 1.26), [3, 2]);
        assert_eq!(pair, "−2.541 ± j1.26");
        assert_eq!(pole_text(Complex::new(-2.541, -1.26), [3, 2]), pair);
        assert_eq!(pole_text(Complex::new(0.3, 0.0), [2, 2]), "0.30");
    }
}
