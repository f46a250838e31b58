//! Gains and delays against airspeed or over conditions (Figures 3, 4, 6 and 7).
//!
//! A condition's *optimum* is its own correction, to which the schedule over airspeed is fitted;
//! the *net gain* of a response is the product of its channels' gains.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::uncertainty::Uncertainty;

pub use super::condition_classes::{Classes, class_names};
pub use super::gain_quantity::{Across, GainAxes, GainQuantity, Measure};

use super::caption_words::{settings_words, used_schedule_words};
use super::figure::{Figure, Plot};
use super::gain_panel::GainPanel;

/// Ratio of plot height to width without error bars.
const ASPECT: f64 = 0.95;
/// Ratio of plot height to width with error bars, which need more height.
const ASPECT_WITH_BARS: f64 = 1.3;

/// Plots each pair's net gain at every condition's optimum, and the schedule (Figures 6 and 7);
/// with error bars and bands if `uncertainty` contains them.
pub fn net_gain_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    pairs: &[Pair],
) -> Figure {
    let across = Across::Airspeed;
    let mut plots = Vec::new();
    for &pair in pairs {
        let contents = GainPanel {
            quantity: GainQuantity::NetGain(pair),
            analysis,
            uncertainty,
            across,
        };
        let title = analysis.study.dataset.pair_name(pair);
        plots.push(Plot::new(title).panel(contents.panel("Net gain [-]")));
    }
    Figure::new("Net gains against airspeed")
        .caption(caption(analysis, across, Measure::Gain))
        .plots(plots)
        .columns(5)
        .shared_x()
        .shared_y()
        .aspect(aspect(uncertainty))
}

/// Plots each channel's gain or delay at every condition's optimum and, against airspeed, the
/// schedule (Figures 3 and 4); with error bars and bands if `uncertainty` contains them.
pub fn channels_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    channels: &[Channel],
    axes: GainAxes,
) -> Figure {
    let GainAxes { measure, across } = axes;
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    let mut plots = Vec::new();
    for &channel in channels {
        let contents = GainPanel {
            quantity: GainQuantity::of_channel(channel, measure),
            analysis,
            uncertainty,
            across,
        };
        let title = channel.name(&inputs, &outputs);
        plots.push(Plot::new(title).panel(contents.panel(measure.axis_label())));
    }
    let title = match measure {
        Measure::Gain => "Channel gains",
        Measure::Delay => "Channel delays",
    };
    Figure::new(title)
        .caption(caption(analysis, across, measure))
        .plots(plots)
        .columns(6)
        .shared_x()
        .shared_y()
        .aspect(aspect(uncertainty))
}

fn aspect(uncertainty: Option<&Uncertainty>) -> f64 {
    match uncertainty {
        Some(_) => ASPECT_WITH_BARS,
        None => ASPECT,
    }
}

fn caption(analysis: &Analysis, across: Across, measure: Measure) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if measure.schedule_of(analysis, across).is_some() {
        let schedule = used_schedule_words(analysis);
        caption.push_str(&format!(" Schedule: {schedule}."));
    }
    if across == Across::Airspeed {
        caption.push_str(" Numbers identify the conditions.");
    }
    caption.push_str(" Dashed: no correction.");
    caption
}

/// Returns all channels, inputs first.
pub fn all_channels(dataset: &Dataset) -> Vec<Channel> {
    let inputs = (0..dataset.inputs().len()).map(Channel::Input);
    let outputs = (0..dataset.outputs().len()).map(Channel::Output);
    inputs.chain(outputs).collect()
}
