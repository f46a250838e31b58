//! The stabilisation diagram: which poles stay where they are while the order rises (M14, section 3).

use nalgebra::Complex;

/// Greatest relative distance of a stable pole from one of the order before.
const STABLE: f64 = 0.05;

/// A pole of the unpolished model of an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilisationPoint {
    /// Order of the model.
    pub order: usize,
    /// Pole \[rad/s\], imaginary part not negative: of a pair the upper one.
    pub pole: Complex<f64>,
    /// Whether a model of the order two less has a pole within 5 % of its modulus.
    pub stable: bool,
}

/// The diagram from the poles of each order, ascending.
pub(super) fn stabilisation(poles: &[(usize, Vec<Complex<f64>>)]) -> Vec<StabilisationPoint> {
    let of_order = |(order, own): &(usize, Vec<Complex<f64>>)| {
        let before = poles.iter().find(|(other, _)| other + 2 == *order).map(|(_, poles)| poles);
        let point = |pole: Complex<f64>| {
            let near = |other: &Complex<f64>| (other - pole).norm() < STABLE * pole.norm();
            StabilisationPoint { order: *order, pole, stable: before.is_some_and(|before| before.iter().any(near)) }
        };
        own.iter().filter(|pole| pole.im >= 0.0).map(|pole| point(*pole)).collect::<Vec<_>>()
    };
    poles.iter().flat_map(of_order).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_is_stable_when_the_order_before_has_it() {
        let pole = |re: f64, im: f64| Complex::new(re, im);
        let orders = [
            (2, vec![pole(-1.0, 2.0), pole(-1.0, -2.0)]),
            (4, vec![pole(-1.0, 2.05), pole(-1.0, -2.05), pole(-3.0, 0.0), pole(-8.0, 0.0)]),
        ];
        let diagram = stabilisation(&orders);
        let stable: Vec<_> = diagram.iter().map(|point| (point.order, point.pole.re, point.stable)).collect();
        assert_eq!(stable, [(2, -1.0, false), (4, -1.0, true), (4, -3.0, false), (4, -8.0, false)]);
    }
}
