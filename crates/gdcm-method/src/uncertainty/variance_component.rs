//! Variances with degrees of freedom: from substitutions, summed, and pooled over conditions (M13.1
//! to M13.3). A *substitution* replaces a condition's representative by another accepted model; the
//! *change* is that of a result.

/// Variance of a gain's natural logarithm, or of a delay \[s^2\], with its degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceComponent {
    pub variance: f64,
    /// Degrees of freedom, at least 1; infinite for an exactly known variance.
    pub degrees_of_freedom: f64,
}

/// Changes up to this size, in natural logarithms or s, are rounding errors in the solver and count
/// as zero.
const ROUNDING: f64 = 1e-9;

impl VarianceComponent {
    /// Computes the mean square change from the representative's value (M13.1); `None` without
    /// changes.
    ///
    /// The mean square is not a variance about the mean, and is never divided by the model count: a
    /// further model does not determine the flown trim better, and identified models share records.
    /// For independent identified models it is about twice their error variance. The surplus keeps
    /// the bars at their confidence level if up to half the error variance is common to all models
    /// (measured in `docs/uncertainty.md`).
    pub fn from_changes(changes: &[f64]) -> Option<Self> {
        if changes.is_empty() {
            return None;
        }
        let degrees = changes.len() as f64;
        let square: f64 = changes
            .iter()
            .filter(|change| change.abs() > ROUNDING)
            .map(|change| change * change)
            .sum();
        Some(Self {
            variance: square / degrees,
            degrees_of_freedom: degrees,
        })
    }

    /// Multiplies the variance by `factor`; the degrees of freedom stay.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            variance: factor * self.variance,
            ..self
        }
    }
}

/// Computes the degrees of freedom of a sum of variances, `u^4 / sum(s^4 / nu)`, where `s^2` are
/// the variances, `nu` their degrees of freedom and `u^2 = sum s^2`; `None` if all variances are
/// zero.
///
/// F. E. Satterthwaite, "An approximate distribution of estimates of variance components",
/// *Biometrics Bulletin* 2, 1946.
pub fn satterthwaite(parts: impl IntoIterator<Item = VarianceComponent>) -> Option<f64> {
    let parts: Vec<VarianceComponent> = parts
        .into_iter()
        .filter(|part| part.variance > 0.0)
        .collect();
    if parts.is_empty() {
        return None;
    }
    // Scaled by the largest variance, because small variances underflow when squared.
    let greatest = parts.iter().map(|part| part.variance).fold(0.0, f64::max);
    let mut sum = 0.0;
    let mut sum_of_squares_over_nu = 0.0;
    for part in &parts {
        let scaled = part.variance / greatest;
        sum += scaled;
        sum_of_squares_over_nu += scaled * scaled / part.degrees_of_freedom;
    }
    Some(sum * sum / sum_of_squares_over_nu)
}

/// Pools each condition's identification variance with that of the other conditions (M13.2).
///
/// ```text
/// s_id^2 = (n s_own^2 + d_0 s_pooled^2) / (n + d_0),
/// s_pooled^2 = sum n s_own^2 / sum n over all conditions,   d_0 = min(prior_degrees, sum of the others' n)
/// ```
///
/// `own` holds `s_own^2`, each condition's mean square, with its degrees of freedom n. A condition
/// with a single identified model has `None`, n = 0, and takes the pooled variance. An entry is
/// `None` if no condition has two identified models; for a condition with a single one, also if
/// `prior_degrees` is 0.
pub fn pooled(
    own: &[Option<VarianceComponent>],
    prior_degrees: f64,
) -> Vec<Option<VarianceComponent>> {
    let known = own.iter().flatten();
    // sum n and sum n s_own^2.
    let total_degrees: f64 = known.clone().map(|part| part.degrees_of_freedom).sum();
    let total_square: f64 = known
        .map(|part| part.degrees_of_freedom * part.variance)
        .sum();
    let mut identification = Vec::with_capacity(own.len());
    for component in own {
        let (n, own_variance) = match component {
            Some(component) => (component.degrees_of_freedom, component.variance),
            None => (0.0, 0.0),
        };
        // `d_0`.
        let borrowed = prior_degrees.min(total_degrees - n);
        let degrees = n + borrowed;
        // A condition with a single model has no estimate if nothing is borrowed from the others.
        identification.push(if total_degrees > 0.0 && degrees > 0.0 {
            Some(VarianceComponent {
                variance: (n * own_variance + borrowed * total_square / total_degrees) / degrees,
                degrees_of_freedom: degrees,
            })
        } else {
            None
        });
    }
    identification
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Variances by condition; `None` with zero degrees of freedom.
    fn own(variances: &[f64], degrees: &[f64]) -> Vec<Option<VarianceComponent>> {
        variances
            .iter()
            .zip(degrees)
            .map(|(&variance, &degrees_of_freedom)| {
                if degrees_of_freedom > 0.0 {
                    Some(VarianceComponent {
                        variance,
                        degrees_of_freedom,
                    })
                } else {
                    None
                }
            })
            .collect()
    }

    /// Reference case E, from independent numpy code.
    #[test]
    fn few_identified_models_borrow_from_the_other_conditions() {
        let five = pooled(
            &own(
                &[0.0009, 0.0001, 0.0, 0.0004, 0.0025],
                &[2.0, 2.0, 0.0, 1.0, 3.0],
            ),
            4.0,
        );
        let expected = [
            (0.001125, 6.0),
            (0.000858333333333, 6.0),
            (0.0012375, 4.0),
            (0.00107, 5.0),
            (0.00177857142857, 7.0),
        ];
        for (part, (variance, degrees)) in five.iter().zip(expected) {
            let part = part.unwrap();
            // The reference values have twelve digits.
            assert!(
                (part.variance - variance).abs() < 1e-14 && part.degrees_of_freedom == degrees,
                "{part:?}"
            );
        }
        let two = pooled(&own(&[0.0009, 0.0], &[2.0, 0.0]), 4.0);
        assert_eq!(
            two,
            vec![
                Some(VarianceComponent {
                    variance: 0.0009,
                    degrees_of_freedom: 2.0
                });
                2
            ]
        );
    }

    #[test]
    fn without_two_identified_models_anywhere_there_is_no_identification_part() {
        assert_eq!(pooled(&[None, None], 4.0), [None, None]);
    }

    #[test]
    fn without_a_prior_each_condition_is_estimated_alone() {
        let alone = pooled(&own(&[0.0009, 0.0001, 0.0], &[2.0, 2.0, 0.0]), 0.0);
        assert_eq!(
            alone[1],
            Some(VarianceComponent {
                variance: 0.0001,
                degrees_of_freedom: 2.0
            })
        );
        assert_eq!(alone[2], None, "a single model has no spread");
    }

    #[test]
    fn zero_variances_have_no_degrees_of_freedom() {
        assert_eq!(
            satterthwaite(
                [VarianceComponent {
                    variance: 0.0,
                    degrees_of_freedom: 4.0
                }; 2]
            ),
            None
        );
        let only = satterthwaite([
            VarianceComponent {
                variance: 0.0,
                degrees_of_freedom: 4.0,
            },
            VarianceComponent {
                variance: 1e-200,
                degrees_of_freedom: 5.0,
            },
        ]);
        assert!((only.unwrap() - 5.0).abs() < 1e-12);
    }
}
