//! Gains and delays of inputs and outputs, scheduled with airspeed.

use super::airspeed::CutAirspeed;
use super::curve::Curve;
use super::export_fault::ExportFault;
use super::number::number;

/// A gain and a delay of an input or an output.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduledChannel {
    /// Name of the input or output.
    pub name: String,
    /// The gain \[-\].
    pub gain: Curve,
    /// The delay \[s\].
    pub delay_s: Curve,
    /// Time constant `a` of the lead filter's numerator \[s\]: equal to `b` where there is no lead. None of a correction without
    /// leads.
    pub zero_s: Option<Curve>,
}

/// What the lead filters of a correction have in common (M15.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExportedLead {
    /// Order, 1 or 2.
    pub order: usize,
    /// Time constant `b` of the denominators \[s\].
    pub lag_s: f64,
}

/// A correction of a model: y(t) = Mo ym(t - tau_o), with Mi u(t - tau_i) as the input of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduledCorrection {
    /// Its name.
    pub name: String,
    /// The dataset that it was found with.
    pub dataset: String,
    /// The program that wrote it, with its version.
    pub software: String,
    /// SHA-256 of the dataset, in hexadecimal.
    pub sha256: String,
    /// The inputs.
    pub inputs: Vec<ScheduledChannel>,
    /// The outputs.
    pub outputs: Vec<ScheduledChannel>,
    /// The lead filters, where there are any.
    pub lead: Option<ExportedLead>,
    /// Least and greatest airspeed \[kt\]; airspeeds outside are cut to them.
    pub airspeed_range_kt: (f64, f64),
    /// Airspeed at which the scaled airspeed is 0 \[kt\].
    pub airspeed_mean_kt: f64,
    /// Airspeed above the mean at which it is 1 \[kt\]; zero where there is one airspeed only: it is 0 there.
    pub airspeed_half_range_kt: f64,
    /// The second variable, where there is one.
    pub second: Option<SecondArgument>,
    /// What has to be known about it.
    pub notes: Vec<String>,
}

/// A second variable of a correction: the second argument of its functions.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondArgument {
    /// Its name with its unit, as an argument is called: `altitude_ft`.
    pub name: &'static str,
    /// The same in words: "altitude [ft]".
    pub words: &'static str,
    /// Least and greatest value; values outside are cut to them.
    pub range: (f64, f64),
}

impl SecondArgument {
    /// A value on the scale from -1 to 1, cut to the range; what is not a number stays so.
    pub fn scaled(&self, value: f64) -> f64 {
        let (least, most) = self.range;
        let within = match value {
            low if low < least => least,
            high if high > most => most,
            within => within,
        };
        (within - 0.5 * (least + most)) / (0.5 * (most - least))
    }

    /// The same of the variable `b`, which is cut already, in every language.
    pub(super) fn scaled_expression(&self) -> String {
        let (least, most) = self.range;
        format!("(b - ({})) / {}", number(0.5 * (least + most)), number(0.5 * (most - least)))
    }
}

/// A curve of a correction, with what it is.
pub(super) struct NamedCurve<'c> {
    pub(super) side: &'static str,
    pub(super) kind: &'static str,
    pub(super) name: &'c str,
    pub(super) curve: &'c Curve,
}

impl NamedCurve<'_> {
    /// Whether it is a time \[s\]: a delay, or the numerator of a lead filter; otherwise it is a gain.
    pub(super) fn is_time(&self) -> bool {
        self.kind != "gain"
    }

    /// What it is: "gain of input LON".
    pub(super) fn words(&self) -> String {
        format!("{} of {} {}", self.kind, self.side, self.name)
    }
}

impl ScheduledCorrection {
    /// An airspeed \[kt\] cut to the range; what is not a number stays so.
    pub fn cut(&self, airspeed_kt: f64) -> CutAirspeed {
        let (least, most) = self.airspeed_range_kt;
        let kt = match airspeed_kt {
            slow if slow < least => least,
            fast if fast > most => most,
            within => within,
        };
        let half_kt = self.airspeed_half_range_kt;
        let scaled = if half_kt == 0.0 { 0.0 } else { (kt - self.airspeed_mean_kt) / half_kt };
        CutAirspeed { kt, scaled, second_scaled: 0.0 }
    }

    /// The same with a value of the second variable.
    pub fn cut_both(&self, airspeed_kt: f64, second: f64) -> CutAirspeed {
        let second_scaled = self.second.as_ref().map_or(0.0, |argument| argument.scaled(second));
        CutAirspeed { second_scaled, ..self.cut(airspeed_kt) }
    }

    /// The one or the other, as far as there is a second value.
    pub(super) fn at(&self, airspeed_kt: f64, second: Option<f64>) -> CutAirspeed {
        second.map_or_else(|| self.cut(airspeed_kt), |second| self.cut_both(airspeed_kt, second))
    }

    /// The scaled airspeed of the airspeed `a`, in every language.
    pub(super) fn scaled_expression(&self) -> String {
        if self.airspeed_half_range_kt == 0.0 {
            return number(0.0);
        }
        format!("(a - ({})) / {}", number(self.airspeed_mean_kt), number(self.airspeed_half_range_kt))
    }

    /// All curves: for every input, then every output, the gain and the delay, and the numerator of the lead filter where there are
    /// any.
    pub(super) fn curves(&self) -> impl Iterator<Item = NamedCurve<'_>> {
        let inputs = self.inputs.iter().map(|channel| ("input", channel));
        inputs.chain(self.outputs.iter().map(|channel| ("output", channel))).flat_map(|(side, channel)| {
            let named = |kind, curve| NamedCurve { side, kind, name: &channel.name, curve };
            let zero = channel.zero_s.as_ref().map(|zero_s| named("lead numerator", zero_s));
            [named("gain", &channel.gain), named("delay", &channel.delay_s)].into_iter().chain(zero)
        })
    }

    /// Refuses numbers that no program can compute with.
    pub(super) fn check(&self) -> Result<(), ExportFault> {
        let (least, most) = self.airspeed_range_kt;
        let numbers = [least, most, self.airspeed_mean_kt, self.airspeed_half_range_kt];
        if !numbers.iter().all(|number| number.is_finite()) || least > most || self.airspeed_half_range_kt < 0.0 {
            return Err(ExportFault::Range);
        }
        if self.second.as_ref().is_some_and(|second| second.range.0.total_cmp(&second.range.1).is_ge()) {
            return Err(ExportFault::Range);
        }
        for NamedCurve { side, kind, name, curve } in self.curves() {
            if let Some(flaw) = curve.flaw() {
                return Err(ExportFault::Curve { channel: format!("{side} {name}"), curve: kind, flaw });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::lookup_table::LookupTable;
    use super::*;

    /// Names that would end a comment or a text if they were written as they are.
    pub(crate) const NASTY: [&str; 3] =
        ["LAT \"x\" 'y' */ \\ %d\n%}\r*/ end", "δ_a ??/ /* \u{2028} ''' \"\"\" ${x}", "\\u{7f}\u{0}\\"];

    /// A correction with every kind of curve and names that are hard to write.
    pub(crate) fn example() -> ScheduledCorrection {
        let polynomial = |of_logarithm, coefficients: &[f64]| Curve::Polynomial {
            of_logarithm,
            coefficients: coefficients.to_vec(),
        };
        let cut = |curve: Curve, least, most: &[f64]| Curve::Cut {
            curve: Box::new(curve),
            least,
            most: LookupTable { airspeed_kt: vec![10.0, 70.0], values: most.to_vec() },
        };
        let channel =
            |name: &str, gain, delay_s| ScheduledChannel { name: name.to_owned(), gain, delay_s, zero_s: None };
        let table = |of_logarithm, airspeed_kt: &[f64], values: &[f64]| {
            let table = LookupTable { airspeed_kt: airspeed_kt.to_vec(), values: values.to_vec() };
            Curve::Table { of_logarithm, table }
        };
        ScheduledCorrection {
            name: format!("first {}", NASTY[0]),
            dataset: NASTY[1].to_owned(),
            software: "gdcm 0.1.0".to_owned(),
            sha256: "ba78".to_owned(),
            inputs: vec![
                channel(NASTY[0], polynomial(true, &[0.1, -0.7 / 3.0, 0.05]), Curve::Constant(0.02)),
                channel(
                    NASTY[1],
                    table(true, &[0.0, 40.0, 61.3], &[-0.1, 1.1 / 3.0, 2.0]),
                    cut(polynomial(false, &[0.03, 0.04]), 0.0, &[0.05, 0.06]),
                ),
            ],
            outputs: vec![channel(
                NASTY[2],
                table(false, &[0.0, 40.0, 61.3], &[0.9, 1.1 / 3.0, 2.0]),
                cut(table(false, &[30.0], &[0.1]), 0.0, &[0.2, 0.05]),
            )],
            lead: None,
            airspeed_range_kt: (0.0, 80.0),
            airspeed_mean_kt: 40.0,
            airspeed_half_range_kt: 40.0,
            second: None,
            notes: vec![NASTY[0].to_owned()],
        }
    }

    /// Airspeeds within the range, on its points, and outside.
    pub(crate) fn airspeeds() -> Vec<f64> {
        (0..50).map(|index| f64::from(index) * 2.0 - 9.0).collect()
    }

    /// What a program must give, airspeed by airspeed: gains of inputs and outputs, delays of inputs and outputs.
    pub(crate) fn expected(correction: &ScheduledCorrection) -> Vec<f64> {
        let values = |airspeed: f64| {
            let at = correction.cut(airspeed);
            let channels = || correction.inputs.iter().chain(&correction.outputs);
            let gains = channels().map(move |channel| channel.gain.at(at));
            gains.chain(channels().map(move |channel| channel.delay_s.at(at))).collect::<Vec<_>>()
        };
        airspeeds().into_iter().flat_map(values).collect()
    }

    /// Compares what a program printed to 1e-12 of each value.
    pub(crate) fn assert_printed(correction: &ScheduledCorrection, printed: &str) {
        let found: Vec<f64> = printed.split_whitespace().map(|word| word.parse().unwrap()).collect();
        let expected = expected(correction);
        assert_eq!(found.len(), expected.len(), "{printed}");
        for (index, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() <= 1e-12 * b.abs(), "value {index}: {a} instead of {b}");
        }
    }

    #[test]
    fn airspeeds_are_cut_to_the_range() {
        let correction = example();
        assert_eq!(correction.cut(-3.0), CutAirspeed { kt: 0.0, scaled: -1.0, second_scaled: 0.0 });
        assert_eq!(correction.cut(100.0), CutAirspeed { kt: 80.0, scaled: 1.0, second_scaled: 0.0 });
        let single = ScheduledCorrection { airspeed_range_kt: (40.0, 40.0), airspeed_half_range_kt: 0.0, ..correction };
        assert_eq!(single.cut(100.0), CutAirspeed { kt: 40.0, scaled: 0.0, second_scaled: 0.0 });
    }

    #[test]
    fn what_cannot_be_computed_is_refused_with_its_channel() {
        let mut correction = example();
        assert_eq!(correction.check(), Ok(()));
        correction.outputs[0].name = "Q".to_owned();
        correction.outputs[0].gain = Curve::Constant(f64::NAN);
        let fault = correction.check().unwrap_err().to_string();
        assert_eq!(fault, "the gain of output Q has a number that is not finite; correct it before it is exported");
        correction.airspeed_half_range_kt = -1.0;
        assert_eq!(correction.check(), Err(ExportFault::Range));
    }
}
