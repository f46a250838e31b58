//! Known answers of M17, by independent code.

use nalgebra::Complex;
use serde_json::Value;

/// The whole file.
pub(super) fn answers() -> Value {
    serde_json::from_str(include_str!("../../../../tests/data/reference/requirements.json")).unwrap()
}

/// A number of a case.
pub(super) fn number(case: &Value, name: &str) -> f64 {
    case[name].as_f64().unwrap()
}

/// The attitude response of each case, as its words say it.
pub(super) fn attitudes() -> [fn(Complex<f64>) -> Complex<f64>; 4] {
    fn second_order(gain: f64, omega: f64, damping: f64, delay_s: f64, s: Complex<f64>) -> Complex<f64> {
        gain * omega * omega * (-delay_s * s).exp() / (s * (s * s + 2.0 * damping * omega * s + omega * omega))
    }
    [
        |s| second_order(1.2, 2.5, 0.5, 0.09, s),
        |s| second_order(0.8, 3.0, 0.12, 0.05, s),
        |s| 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)) * 400.0 / (s * s + 28.0 * s + 400.0),
        |s| second_order(1.0, 4.0, 0.7, 0.02, s),
    ]
}
