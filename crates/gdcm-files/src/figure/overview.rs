//! Every response of one condition, small.

use super::axis::Axis;
use super::bode::{BodeOptions, response_curves};
use super::condition_source::ConditionSource;
use super::figure::Figure;
use super::mark::{Note, Place};
use super::panel::{Panel, Plot};

/// The magnitude of every response of one condition, outputs down, inputs across, with J before and after the correction.
pub fn overview_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Figure {
    let dataset = source.dataset();
    let plots = dataset.on_axis().pairs().map(|pair| {
        let lines = source.lines(pair, options);
        let curves = response_curves(source, &lines, options.unit, |line| &line.shape.magnitude_db);
        let panel = Panel::new(options.frequency_axis(), Axis::linear("Magnitude [dB]").at_least(4.0));
        let panel = panel.with(options.band(source)).with_all(curves);
        let note = source.analysis.cost[pair].map(|cost| {
            let text = format!("J {:.0} → {:.0}", cost.uncorrected.total(), cost.corrected.total());
            Note { at: Place::LowerLeft, text }
        });
        let held = if source.analysis.held()[pair] { " *" } else { "" };
        Plot::new(format!("{}{held}", dataset.pair_name(pair))).panel(panel.with_all(note))
    });
    let figure =
        Figure::new(source.condition_words()).caption(format!("{} * held exactly.", source.caption())).plots(plots);
    figure.columns(dataset.inputs().len()).dense().shared_x().aspect(0.55)
}
