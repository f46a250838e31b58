//! Gains and delays of inputs and outputs, scheduled with airspeed.

use gdcm_core::dataset::{Channel, Dataset};
use gdcm_core::response::LeadFilter;
use gdcm_core::schedule::{LeadSchedule, Regression, Schedule, ScheduledQuantity, SecondVariable};

use super::curve::{AirspeedPoint, Curve, LookupTable, comment, number};
use super::{ExportFault, ExportSource};

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
    /// Least and greatest airspeed \[kt\]; airspeeds outside are clamped to them.
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
    /// Least and greatest value; values outside are clamped to them.
    pub range: (f64, f64),
}

impl SecondArgument {
    /// A value on the scale from -1 to 1, clamped to the range; what is not a number stays so.
    pub fn scaled(&self, value: f64) -> f64 {
        let (least, most) = self.range;
        let within = match value {
            low if low < least => least,
            high if high > most => most,
            within => within,
        };
        (within - 0.5 * (least + most)) / (0.5 * (most - least))
    }

    /// The same of the variable `b`, which is clamped already, in every language.
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
    /// An airspeed \[kt\] clamped to the range; what is not a number stays so.
    pub fn clamp(&self, airspeed_kt: f64) -> AirspeedPoint {
        let (least, most) = self.airspeed_range_kt;
        let kt = match airspeed_kt {
            slow if slow < least => least,
            fast if fast > most => most,
            within => within,
        };
        let half_kt = self.airspeed_half_range_kt;
        let scaled = if half_kt == 0.0 { 0.0 } else { (kt - self.airspeed_mean_kt) / half_kt };
        AirspeedPoint { kt, scaled, second_scaled: 0.0 }
    }

    /// The same with a value of the second variable.
    pub fn clamp_both(&self, airspeed_kt: f64, second: f64) -> AirspeedPoint {
        let second_scaled = self.second.as_ref().map_or(0.0, |argument| argument.scaled(second));
        AirspeedPoint { second_scaled, ..self.clamp(airspeed_kt) }
    }

    /// The one or the other, as far as there is a second value.
    pub(super) fn at(&self, airspeed_kt: f64, second: Option<f64>) -> AirspeedPoint {
        second.map_or_else(|| self.clamp(airspeed_kt), |second| self.clamp_both(airspeed_kt, second))
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

    /// What the file is, line by line.
    pub(super) fn heading(&self) -> Vec<String> {
        let (least, most) = self.airspeed_range_kt;
        let mut lines = vec![
            "Gains and delays that correct a model of a helicopter, scheduled with airspeed.".to_owned(),
            "The model gets the input Mi*u(t - tau_i); its output ym gives y(t) = Mo*ym(t - tau_o).".to_owned(),
            "Units: airspeed in knots, delays in seconds, gains without a unit.".to_owned(),
            format!("Airspeeds outside {least} to {most} kt are clamped to the ends of this range."),
            format!("Correction: {}", comment(&self.name)),
            format!("Dataset: {}", comment(&self.dataset)),
            format!("SHA-256 of the dataset: {}", comment(&self.sha256)),
            format!("Written by: {}", comment(&self.software)),
        ];
        if let Some(lead) = self.lead {
            let filter = match lead.order {
                1 => "L(s) = (1 + a*s)/(1 + b*s)",
                _ => "L(s) = (1 + sqrt(2)*a*s + a^2*s^2)/(1 + sqrt(2)*b*s + b^2*s^2)",
            };
            lines.push(format!(
                "Lead: each input, after its gain and delay, and each output, before them, passes {filter},"
            ));
            lines.push(format!(
                "with b = {} s for all, and a in seconds for each; where a = b there is no lead.",
                number(lead.lag_s)
            ));
            lines.push(format!(
                "In fixed-step code use Tustin's rule and a step of at most {} s.",
                number(0.5 * lead.lag_s)
            ));
        }
        lines.extend(self.notes.iter().map(|note| format!("Note: {}", comment(note))));
        lines
    }

    /// The same as comments, each behind a mark.
    pub(super) fn comment_lines(&self, mark: &str) -> String {
        self.heading().iter().map(|line| format!("{mark} {line}\n")).collect()
    }

    /// The second argument of a function, behind a comma and what its declaration begins with; nothing where there is none.
    pub(super) fn second_argument(&self, begin: &str) -> String {
        self.second.as_ref().map_or_else(String::new, |second| format!(", {begin}{}", second.name))
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

/// Intervals of airspeed in which a lead filter that depends on it is linear.
const LEAD_POINTS: u32 = 100;

impl ScheduledCorrection {
    /// The correction that a schedule makes at each airspeed, see [`Schedule::at`]. Delays that are not scheduled are zero, and a note
    /// says so; another repeats each caution of the schedule.
    pub fn of(schedule: &Schedule, dataset: &Dataset, source: &ExportSource) -> Self {
        let correction = Self::with_delays(schedule, dataset, source);
        match &schedule.leads {
            None => correction,
            Some(leads) => correction.with_leads(schedule, leads),
        }
    }

    /// The same with the lead filters and delays of scheduled signed delays.
    fn with_leads(mut self, schedule: &Schedule, leads: &LeadSchedule) -> Self {
        let [least, most] = [schedule.airspeeds.min_kt, schedule.airspeeds.max_kt];
        let design = &leads.design;
        let is_constant = |regression: &Regression| regression.figures().len() == 1 || least == most;
        let tau_s = |regression: &Regression, kt: f64| {
            regression.at(&schedule.airspeeds, kt).clamp(leads.bounds_s[0], leads.bounds_s[1])
        };
        // The numerator that a signed delay has is no polynomial of it.
        let zero_s = |tau_s: f64| design.filter(tau_s).map_or(design.lag_s(), LeadFilter::zero_s);
        let zero_curve = |regression: &Regression| {
            if is_constant(regression) {
                return Curve::Constant(zero_s(tau_s(regression, least)));
            }
            let kt = |place: u32| least + (most - least) * f64::from(place) / f64::from(LEAD_POINTS);
            let airspeed_kt: Vec<f64> = (0..=LEAD_POINTS).map(kt).collect();
            let values = airspeed_kt.iter().map(|&kt| zero_s(tau_s(regression, kt))).collect();
            Curve::Table { of_logarithm: false, table: LookupTable { airspeed_kt, values } }
        };
        let delay_curve = |regression: &Regression| Curve::Clamped {
            curve: Box::new(curve(regression, false)),
            least: 0.0,
            most: LookupTable { airspeed_kt: vec![least], values: vec![leads.bounds_s[1]] },
        };
        for (channels, regressions) in
            [(&mut self.inputs, &leads.taus_s.inputs), (&mut self.outputs, &leads.taus_s.outputs)]
        {
            for (channel, regression) in channels.iter_mut().zip(regressions) {
                channel.delay_s = delay_curve(regression);
                channel.zero_s = Some(zero_curve(regression));
            }
        }
        self.lead = Some(ExportedLead { order: design.settings().order.number(), lag_s: design.lag_s() });
        if !leads.taus_s.iter().all(|(_, regression)| is_constant(regression)) {
            let points = LEAD_POINTS + 1;
            self.notes.push(format!("the lead filters are tables over airspeed, linear between {points} points"));
        }
        self
    }

    fn with_delays(schedule: &Schedule, dataset: &Dataset, source: &ExportSource) -> Self {
        let (airspeeds, delays) = (&schedule.airspeeds, schedule.delays.as_ref());
        let delay = |regressions: Option<&[Regression]>, at: usize| match (delays, regressions) {
            (Some(delays), Some(regressions)) => Curve::Clamped {
                curve: Box::new(curve(&regressions[at], false)),
                least: 0.0,
                // The bounds are a table, whatever the delays are.
                most: LookupTable { airspeed_kt: airspeeds.clusters_kt(), values: delays.upper_s.figures().to_vec() },
            },
            _ => Curve::Constant(0.0),
        };
        let second = schedule.second.as_ref();
        let of_logarithm = schedule.settings.quantity == ScheduledQuantity::LnGain;
        let channels = |names: &[Channel],
                        gains: &[Regression],
                        slopes: Option<&[f64]>,
                        delays: Option<&[Regression]>| {
            let gain = |at: usize| match slopes.and_then(|slopes| slopes.get(at)) {
                Some(&slope) => Curve::WithSecond { curve: Box::new(curve(&gains[at], false)), of_logarithm, slope },
                None => curve(&gains[at], of_logarithm),
            };
            let channel = |at: usize| ScheduledChannel {
                name: names[at].name.clone(),
                gain: gain(at),
                delay_s: delay(delays, at),
                zero_s: None,
            };
            (0..gains.len()).map(channel).collect()
        };
        Self {
            name: source.name.clone(),
            dataset: dataset.name().to_owned(),
            software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
            sha256: source.sha256.clone(),
            inputs: channels(
                dataset.inputs(),
                &schedule.gains.inputs,
                second.map(|term| term.slopes.inputs.as_slice()),
                delays.map(|delays| delays.taus_s.inputs.as_slice()),
            ),
            outputs: channels(
                dataset.outputs(),
                &schedule.gains.outputs,
                second.map(|term| term.slopes.outputs.as_slice()),
                delays.map(|delays| delays.taus_s.outputs.as_slice()),
            ),
            lead: None,
            airspeed_range_kt: (airspeeds.min_kt, airspeeds.max_kt),
            airspeed_mean_kt: airspeeds.mean_kt,
            airspeed_half_range_kt: airspeeds.half_range_kt,
            second: second.map(|term| {
                let (name, words) = match term.variable {
                    SecondVariable::Altitude => ("altitude_ft", "altitude [ft]"),
                    SecondVariable::Mass => ("mass_kg", "mass [kg]"),
                };
                SecondArgument { name, words, range: (term.range[0], term.range[1]) }
            }),
            notes: notes(schedule, dataset),
        }
    }
}

fn notes(schedule: &Schedule, dataset: &Dataset) -> Vec<String> {
    let unscheduled = "delays are not scheduled in this study: they are zero here".to_owned();
    let (inputs, outputs) = dataset.names_of_channels();
    let cautions = schedule.cautions.iter().map(|caution| caution.words(&inputs, &outputs));
    (!schedule.has_delays()).then_some(unscheduled).into_iter().chain(cautions).collect()
}

fn curve(regression: &Regression, of_logarithm: bool) -> Curve {
    match regression {
        Regression::Polynomial { coefficients } => {
            Curve::Polynomial { of_logarithm, coefficients: coefficients.clone() }
        }
        Regression::Table { airspeeds_kt, values } => {
            let table = LookupTable { airspeed_kt: airspeeds_kt.clone(), values: values.clone() };
            Curve::Table { of_logarithm, table }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
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
        let clamped = |curve: Curve, least, most: &[f64]| Curve::Clamped {
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
                    clamped(polynomial(false, &[0.03, 0.04]), 0.0, &[0.05, 0.06]),
                ),
            ],
            outputs: vec![channel(
                NASTY[2],
                table(false, &[0.0, 40.0, 61.3], &[0.9, 1.1 / 3.0, 2.0]),
                clamped(table(false, &[30.0], &[0.1]), 0.0, &[0.2, 0.05]),
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
            let at = correction.clamp(airspeed);
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
    fn airspeeds_are_clamped_to_the_range() {
        let correction = example();
        assert_eq!(correction.clamp(-3.0), AirspeedPoint { kt: 0.0, scaled: -1.0, second_scaled: 0.0 });
        assert_eq!(correction.clamp(100.0), AirspeedPoint { kt: 80.0, scaled: 1.0, second_scaled: 0.0 });
        let single = ScheduledCorrection { airspeed_range_kt: (40.0, 40.0), airspeed_half_range_kt: 0.0, ..correction };
        assert_eq!(single.clamp(100.0), AirspeedPoint { kt: 40.0, scaled: 0.0, second_scaled: 0.0 });
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
