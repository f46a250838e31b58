//! A caution's code, subject and text, for files and for marks in the window.

use gdcm_model::simulation::Signal;

/// A caution as stored in files, with a machine-readable subject.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CautionNote {
    /// Stable code, for programs.
    pub code: &'static str,
    /// Affected records, by name; empty if all are affected.
    pub records: Vec<String>,
    /// The affected channel, by name.
    pub channel: Option<String>,
    /// The affected response: names of output and input.
    pub pair: Option<[String; 2]>,
    /// Affected frequencies \[rad/s\]; for the codes `band-narrowed` and `order-limit`, the
    /// narrower band instead.
    pub band_rad_s: Option<[f64; 2]>,
    pub text: String,
}

impl CautionNote {
    /// Creates a note about all records, without text.
    pub(crate) fn new(code: &'static str) -> Self {
        Self {
            code,
            ..Self::default()
        }
    }

    pub(crate) fn with_record(self, name: &str) -> Self {
        Self {
            records: vec![name.to_owned()],
            ..self
        }
    }

    pub(crate) fn with_channel<'s>(self, signal: impl Into<Option<&'s Signal>>) -> Self {
        Self {
            channel: signal.into().map(|signal| signal.name.clone()),
            ..self
        }
    }

    pub(crate) fn with_pair(self, channels: [&Signal; 2]) -> Self {
        Self {
            pair: Some(channels.map(|signal| signal.name.clone())),
            ..self
        }
    }

    pub(crate) fn with_band(self, ends: [f64; 2]) -> Self {
        Self {
            band_rad_s: Some(ends),
            ..self
        }
    }

    /// Returns a label for a mark in the window, at most four words long.
    #[must_use]
    pub fn mark(&self) -> &'static str {
        match self.code {
            "clipped" => "at its limit",
            "spike" => "spikes",
            "rate-limited" => "at a rate limit",
            "stuck" => "stood still",
            "coarse" => "coarse steps",
            "held" => "moves in steps",
            "copy" => "a copy",
            "sign" => "opposite sign",
            "time-skew" => "time skew",
            "vibration" => "vibrates",
            "unit" => "unit in doubt",
            "inadequate" => "poorly fitted",
            "not-swept" => "not swept",
            "collinear-inputs" => "moved together",
            "points" => "off the measured points",
            "not-identified" => "not identified",
            "feedback" | "feedback-some" => "gusts fed back",
            "record" => "unlike other records",
            "gap" => "gaps",
            "duplicate" => "a duplicate",
            "resampled" => "resampled",
            "held-out" => "not predicted",
            "unstable" => "unstable above band",
            "order-limit" => "order too low",
            "band-narrowed" => "no coherent response",
            "short" => "short records",
            _ => "see the caution",
        }
    }
}
