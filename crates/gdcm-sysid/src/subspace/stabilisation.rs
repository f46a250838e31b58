//! Finds poles that change little while the order rises, for the stabilisation diagram (M14.3): the
//! poles of the unrefined models at all orders.

use nalgebra::Complex;

/// A pole is stable if the model whose order is lower by two has a pole at most this far away,
/// relative to the modulus.
const STABLE: f64 = 0.05;

/// Poles of the model at an order.
pub(crate) struct PolesOfOrder {
    pub(crate) order: usize,
    /// Poles \[rad/s\].
    pub(crate) poles: Vec<Complex<f64>>,
}

/// A pole of an unrefined model, for the stabilisation diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilisationPoint {
    /// Model order.
    pub order: usize,
    /// Pole \[rad/s\]; from a complex pair, the one with positive imaginary part.
    pub pole: Complex<f64>,
    /// Whether the model whose order is lower by two has a pole within 5 %, relative to the
    /// modulus.
    pub stable: bool,
}

/// Finds the poles that change little while the order rises; `orders` are ascending.
pub(crate) fn stabilisation(orders: &[PolesOfOrder]) -> Vec<StabilisationPoint> {
    let mut points = Vec::new();
    for own in orders {
        let before = orders
            .iter()
            .find(|other| other.order + 2 == own.order)
            .map_or(&[][..], |other| other.poles.as_slice());
        for &pole in own.poles.iter().filter(|pole| pole.im >= 0.0) {
            points.push(StabilisationPoint {
                order: own.order,
                pole,
                stable: before
                    .iter()
                    .any(|other| (other - pole).norm() < STABLE * pole.norm()),
            });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_is_stable_when_the_order_before_has_it() {
        let orders = [
            PolesOfOrder {
                order: 2,
                poles: vec![Complex::new(-1.0, 2.0), Complex::new(-1.0, -2.0)],
            },
            PolesOfOrder {
                order: 4,
                poles: vec![
                    Complex::new(-1.0, 2.05),
                    Complex::new(-1.0, -2.05),
                    Complex::new(-3.0, 0.0),
                    Complex::new(-8.0, 0.0),
                ],
            },
        ];
        let diagram = stabilisation(&orders);
        let stable: Vec<_> = diagram
            .iter()
            .map(|point| (point.order, point.pole.re, point.stable))
            .collect();
        assert_eq!(
            stable,
            [
                (2, -1.0, false),
                (4, -1.0, true),
                (4, -3.0, false),
                (4, -8.0, false)
            ]
        );
    }
}
