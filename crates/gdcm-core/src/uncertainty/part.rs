//! One part of an uncertainty: a variance, and how well it is known.

/// A variance with its degrees of freedom. Of a gain the variance is that of its natural logarithm, of a delay \[s^2\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The mean square.
    pub variance: f64,
    /// Degrees of freedom, at least 1; infinite where it is taken as known.
    pub degrees: f64,
}

/// Changes of an optimum that are no larger, in natural logarithms or \[s\], are rounding: identical models have no spread.
const ROUNDING: f64 = 1e-9;

impl Part {
    /// The mean square of some changes about the representative's figure (M13.1); none of none.
    ///
    /// Not a variance about the mean, and never divided by the number of models: a further model does not make the trim flown
    /// better known.
    pub fn of_changes(changes: &[f64]) -> Option<Self> {
        let degrees = changes.len() as f64;
        let beyond_rounding = changes.iter().filter(|change| change.abs() > ROUNDING);
        let square: f64 = beyond_rounding.map(|change| change * change).sum();
        (!changes.is_empty()).then(|| Self { variance: square / degrees, degrees })
    }

    /// The same part, so many times as large in variance.
    pub fn scaled(self, factor: f64) -> Self {
        Self { variance: factor * self.variance, ..self }
    }
}

/// Degrees of freedom of a sum of parts, `u^4 / sum(s^4 / nu)`; none where all of them are zero.
///
/// F. E. Satterthwaite, "An approximate distribution of estimates of variance components", Biometrics Bulletin 2 (1946).
pub fn satterthwaite(parts: impl IntoIterator<Item = Part>) -> Option<f64> {
    let parts: Vec<Part> = parts.into_iter().filter(|part| part.variance > 0.0).collect();
    // Beside the greatest: the squares of small variances underflow.
    let greatest = parts.iter().map(|part| part.variance).fold(0.0, f64::max);
    let (mut sum, mut spread) = (0.0, 0.0);
    for part in &parts {
        let share = part.variance / greatest;
        sum += share;
        spread += share * share / part.degrees;
    }
    (!parts.is_empty()).then(|| sum * sum / spread)
}

/// The identification part of every condition, pooled (M13.2): `(n s_own^2 + d_0 s_pooled^2) / (n + d_0)` with
/// `d_0 = min(prior, sum of the others' n)`. None where no condition has two identified models.
///
/// `own` is the mean square of each condition, none where it has one model only, which then borrows all of it.
pub fn pooled(own: &[Option<Part>], prior_degrees: f64) -> Vec<Option<Part>> {
    let count: f64 = own.iter().flatten().map(|part| part.degrees).sum();
    let square: f64 = own.iter().flatten().map(|part| part.degrees * part.variance).sum();
    let of_condition = |own: &Option<Part>| {
        let (n, variance) = own.map_or((0.0, 0.0), |own| (own.degrees, own.variance));
        let borrowed = prior_degrees.min(count - n);
        let degrees = n + borrowed;
        // A prior of zero degrees leaves a condition with one model nothing to go by.
        (count > 0.0 && degrees > 0.0)
            .then(|| Part { variance: (n * variance + borrowed * square / count) / degrees, degrees })
    };
    own.iter().map(of_condition).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(variances: &[f64], counts: &[f64]) -> Vec<Option<Part>> {
        let part = |(&variance, &degrees): (&f64, &f64)| (degrees > 0.0).then_some(Part { variance, degrees });
        variances.iter().zip(counts).map(part).collect()
    }

    /// Case E of the reference (independent numpy code).
    #[test]
    fn few_identified_models_borrow_from_the_other_conditions() {
        let five = pooled(&own(&[0.0009, 0.0001, 0.0, 0.0004, 0.0025], &[2.0, 2.0, 0.0, 1.0, 3.0]), 4.0);
        let expected =
            [(0.001125, 6.0), (0.000858333333333, 6.0), (0.0012375, 4.0), (0.00107, 5.0), (0.00177857142857, 7.0)];
        for (part, (variance, degrees)) in five.iter().zip(expected) {
            let part = part.unwrap();
            // The reference has twelve digits.
            assert!((part.variance - variance).abs() < 1e-14 && part.degrees == degrees, "{part:?}");
        }
        let two = pooled(&own(&[0.0009, 0.0], &[2.0, 0.0]), 4.0);
        assert_eq!(two, vec![Some(Part { variance: 0.0009, degrees: 2.0 }); 2]);
    }

    #[test]
    fn without_two_identified_models_anywhere_there_is_no_identification_part() {
        assert_eq!(pooled(&[None, None], 4.0), [None, None]);
    }

    #[test]
    fn a_prior_of_nothing_trusts_the_condition_alone() {
        let alone = pooled(&own(&[0.0009, 0.0001, 0.0], &[2.0, 2.0, 0.0]), 0.0);
        assert_eq!(alone[1], Some(Part { variance: 0.0001, degrees: 2.0 }));
        assert_eq!(alone[2], None, "one model says nothing by itself");
    }

    #[test]
    fn parts_of_nothing_have_no_degrees() {
        assert_eq!(satterthwaite([Part { variance: 0.0, degrees: 4.0 }; 2]), None);
        let only = satterthwaite([Part { variance: 0.0, degrees: 4.0 }, Part { variance: 1e-200, degrees: 5.0 }]);
        assert!((only.unwrap() - 5.0).abs() < 1e-12);
    }
}
