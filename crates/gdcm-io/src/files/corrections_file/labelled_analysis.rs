//! Analysis values as JSON, labelled with the dataset's channel names. A response has an output and
//! an input; gains, delays and leads belong to single channels.

use serde_json::{Map, Value, json};

use gdcm_method::correction::{Channel, ChannelCorrection, Channels, LeadPrice};
use gdcm_method::schedule::Regression;
use gdcm_model::dataset::Pair;
use gdcm_study::Analysis;

/// An analysis with its dataset's channel names, which label its values.
pub(super) struct LabelledAnalysis<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) inputs: Vec<String>,
    pub(super) outputs: Vec<String>,
}

impl<'a> LabelledAnalysis<'a> {
    pub(super) fn new(analysis: &'a Analysis) -> Self {
        let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
        Self {
            analysis,
            inputs,
            outputs,
        }
    }

    /// Returns a response's channel names, output first.
    pub(super) fn pair(&self, pair: Pair) -> (String, String) {
        self.analysis.study.dataset.output_and_input_name(pair)
    }

    /// Returns each response's channel names, output first.
    pub(super) fn pairs(&self, pairs: impl IntoIterator<Item = Pair>) -> Vec<(String, String)> {
        pairs.into_iter().map(|pair| self.pair(pair)).collect()
    }

    /// Returns an object with a response's channel names, output first, followed by the members of
    /// `entries`.
    pub(super) fn response_entries(&self, pair: Pair, entries: Value) -> Value {
        let (output, input) = self.pair(pair);
        let mut members = Map::new();
        members.insert("output".to_owned(), output.into());
        members.insert("input".to_owned(), input.into());
        if let Value::Object(entries) = entries {
            members.extend(entries);
        }
        Value::Object(members)
    }

    /// Returns an object with the members `inputs` and `outputs`, each of which maps channel names
    /// to values.
    pub(super) fn by_channel<T: Into<Value>>(&self, value: impl Fn(Channel) -> T) -> Value {
        let mut inputs = Map::new();
        for (index, name) in self.inputs.iter().enumerate() {
            inputs.insert(name.clone(), value(Channel::Input(index)).into());
        }
        let mut outputs = Map::new();
        for (index, name) in self.outputs.iter().enumerate() {
            outputs.insert(name.clone(), value(Channel::Output(index)).into());
        }
        json!({"inputs": inputs, "outputs": outputs})
    }

    /// Returns each channel's regression parameters: polynomial coefficients or table values.
    pub(super) fn coefficients(&self, regressions: &Channels<Regression>) -> Value {
        self.by_channel(|channel| regressions[channel].parameters().to_vec())
    }

    pub(super) fn gains(&self, correction: &ChannelCorrection) -> Value {
        self.by_channel(|channel| correction.gain(channel))
    }

    /// Returns each channel's delay \[s\].
    pub(super) fn delays_s(&self, correction: &ChannelCorrection) -> Value {
        self.by_channel(|channel| correction.pure_delay_s(channel))
    }

    /// Returns each channel's signed delay and lead filter (M15); `None` if the correction has no
    /// leads.
    pub(super) fn leads(&self, correction: &ChannelCorrection) -> Option<Value> {
        let leads = correction.leads.as_ref()?;
        let price = LeadPrice::new(leads);
        Some(self.by_channel(|channel| {
            let filter = leads.filters()[channel];
            json!({
                "tau_s": leads.taus_s[channel],
                "lead_s": filter.map(|filter| filter.lead_s()),
                "zero_rad_s": filter.map(|filter| filter.zero_rad_s()),
                "lag_rad_s": filter.map(|filter| filter.lag_rad_s()),
                "gain_at_infinity_db": filter.map(|filter| filter.gain_at_infinity_db()),
                "gain_above_band_db": price.as_ref().map(|price| price.gains_db[channel]),
                "not_valid_above_rad_s": price.as_ref().map(|price| price.limit_rad_s),
            })
        }))
    }
}
