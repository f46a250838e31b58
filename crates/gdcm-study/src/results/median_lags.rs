//! Median lag at each input or output, which distinguishes a slow servo or sensor from a lag that
//! is common to all responses.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::statistics::median;

use super::analysis::ConditionAnalysis;

/// A channel's lag, as the median over its responses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MedianLag {
    pub channel: Channel,
    /// Lag of the physics representative behind the identified one \[s\]; negative for a lead.
    pub lag_s: f64,
}

impl ConditionAnalysis {
    /// Returns the median lags of the inputs or the outputs, without channels for which D is not
    /// defined in any response.
    pub fn median_lags(&self, side: ChannelSide) -> Vec<MedianLag> {
        let delays_s = &self.delay_problem.delta;
        let count = side.pick(delays_s.inputs(), delays_s.outputs());
        let mut lags = Vec::new();
        for index in 0..count {
            let channel = side.pick(Channel::Input(index), Channel::Output(index));
            let mut lags_s = Vec::new();
            for (pair, delay_s) in delays_s.iter() {
                if let Some(delay_s) = delay_s
                    && channel.belongs_to(pair)
                {
                    // The delay that removes a lag is negative.
                    lags_s.push(-delay_s);
                }
            }
            if !lags_s.is_empty() {
                lags.push(MedianLag {
                    channel,
                    lag_s: median(&mut lags_s),
                });
            }
        }
        lags
    }
}
