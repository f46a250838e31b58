//! Small plots at the foot of the right column: fit over the order, and poles. A click opens the
//! page Order.
//!
//! χ²/dof is the cost of the fit for each degree of freedom, 1 if the model leaves only noise.

use egui::{CursorIcon, Rect, Role, Sense, Ui, pos2, vec2};

use gdcm_plot::figure::Range;
use gdcm_sysid::identification::Identification;

use super::identified_poles::add_poles;
use super::order_fits::add_order_fits;
use super::page::Page;
use super::value_range::rounded_range;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLayout};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::state::records::RecordsPage;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::small;

/// Caption height \[pt\].
const CAPTION: f32 = 16.0;
/// Plot height, tick labels included \[pt\].
const PLOT: f32 = 92.0;
/// Total height \[pt\].
pub(super) const SMALL_PLOTS_HEIGHT: f32 = CAPTION + PLOT;
/// Gap between the plots \[pt\].
const GAP: f32 = 12.0;
/// Margin around the determined poles, relative to the larger of the real range's width and the
/// largest imaginary part.
const EDGE: f64 = 0.15;

/// Draws both plots; without an identification, only their captions.
pub(super) fn small_plots_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let size = vec2(ui.available_width(), SMALL_PLOTS_HEIGHT);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let middle = area.center().x;
    let halves = [
        area.with_max_x(middle - 0.5 * GAP),
        area.with_min_x(middle + 0.5 * GAP),
    ];
    let has_held_out = page
        .records
        .identification()
        .is_some_and(|identification| identification.held_out_cost.is_some());
    let held_out_note = if has_held_out { "dashed: held out" } else { "" };
    let captions = [
        ["χ²/dof vs order", held_out_note],
        ["poles, rad/s", "grey: not determined"],
    ];
    let palette = page.palette;
    for (half, [name, note]) in halves.into_iter().zip(captions) {
        let caption = half.with_max_y(half.top() + CAPTION);
        let shown = painted_text(ui, caption, 0.0, name, small(), palette.text);
        let room = caption.right() - shown.right();
        if text_width(ui, note, small()) + 6.0 < room {
            painted_text(ui, caption, AT_RIGHT_END, note, small(), palette.dim_text);
        }
    }
    let Some(identification) = page.records.identification() else {
        return;
    };
    let plots = halves.map(|half| half.with_min_y(half.top() + CAPTION));
    let [orders, poles] = plots;
    let mut chart = small_chart("χ²/dof vs order");
    add_order_fits(&mut chart, identification, palette);
    let hint = if has_held_out {
        "Opens page Order; dashed: held-out records"
    } else {
        "Opens page Order"
    };
    plot_ui(ui, page, orders, &chart, hint, commands);
    let mut chart = small_chart("poles, rad/s");
    add_poles(&mut chart, &identification.poles, palette);
    if let Some([real, imaginary]) = pole_ranges(identification) {
        chart.whole_across = Some(real);
        chart.values = Some(imaginary);
    }
    let hint = "Opens page Order; grey: not determined by the records";
    plot_ui(ui, page, poles, &chart, hint, commands);
}

fn small_chart(title: &str) -> Chart<'_> {
    let mut chart = Chart::new(title, ChartAxis::Linear, "", "");
    chart.fits_values = true;
    chart.layout = ChartLayout {
        title_height: 0.0,
        value_axis_width: 26.0,
        right_margin: 2.0,
        has_ticks_across: true,
    };
    chart
}

/// Returns ranges of real and imaginary part that contain the determined poles and the origin's
/// real part, symmetric about the real axis; `None` without determined poles.
fn pole_ranges(identification: &Identification) -> Option<[Range; 2]> {
    let determined: Vec<_> = identification
        .poles
        .iter()
        .filter(|pole| pole.determined)
        .collect();
    let real = Range::spanning(determined.iter().map(|pole| pole.pole.re))?.including(0.0);
    let imaginary = determined
        .iter()
        .map(|pole| pole.pole.im.abs())
        .fold(0.0, f64::max);
    let edge = EDGE * real.width().max(imaginary);
    Some([
        rounded_range(Range::new(real.min - edge, real.max + edge)),
        rounded_range(Range::new(-imaginary - edge, imaginary + edge)),
    ])
}

/// Draws a plot, covered by an area that opens the page Order.
fn plot_ui(
    ui: &mut Ui,
    page: Page<'_>,
    place: Rect,
    chart: &Chart<'_>,
    hint: &str,
    commands: &mut Vec<Command>,
) {
    chart_ui(ui, place, chart, page.palette);
    let area = Rect::from_min_max(pos2(place.left(), place.top()), place.max);
    let id = ui.scope_id().with(("small plot", chart.title));
    let response = named(
        ui.interact(area, id, Sense::click()),
        Role::Button,
        format!("Open page Order: {}", chart.title),
    );
    response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(hint)
        .asks(RecordsCommand::ShowPage(RecordsPage::Order), commands);
}
