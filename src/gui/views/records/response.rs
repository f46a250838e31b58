//! Results of the identification: the measured response with the models, the poles over the order,
//! and the recommended poles.

use std::sync::Arc;

use egui::{Color32, Rect, RichText, Role, Sense, Shape, Stroke, Ui, vec2};
use nalgebra::Complex;

use gdcm_model::dataset::{Pair, StateSpace};
use gdcm_model::response::evaluate;
use gdcm_model::response::frequency_response::{ResponseShape, log_spaced};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::neper_to_db;
use gdcm_sysid::diagnostics::bands::TWO_SIDED_95;
use gdcm_sysid::diagnostics::model_doubts::NARROW_WINDOW;
use gdcm_sysid::identification::{
    CautionNote, Identification, IdentificationCaution, TRUSTED_COHERENCE,
};
use gdcm_sysid::spectra::response_estimate::EstimatePoint;
use gdcm_sysid::subspace::stabilisation::StabilisationPoint;

use super::frame_cache::kept;
use super::page::Page;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartBand, ChartLine, ChartMarks, ChartSpan};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{named, painted_text, text_width};
use crate::gui::widgets::palette::{Palette, small};

/// Number of frequencies of a model's curve.
const POINTS: usize = 200;
/// Factor by which curves extend beyond the band.
const BEYOND: f64 = 1.5;

/// A response as frequencies \[rad/s\], magnitudes \[dB\] and unwrapped phases \[deg\].
type Curve = Vec<[f64; 3]>;

/// The curves of one pair.
#[derive(Clone, Debug, Default)]
struct DrawnResponse {
    /// The measured points, their standard deviations \[dB, deg\], and whether each is trusted.
    measured: Vec<([f64; 3], [f64; 2], bool)>,
    recommended: Curve,
    /// Standard deviations \[dB, deg\] of the recommended curve.
    bands: Vec<[f64; 2]>,
    unrefined: Curve,
    /// Intervals in which the recommended model deviates from the measured points \[rad/s\]
    /// (M14.17).
    left: Vec<[f64; 2]>,
    /// Intervals in which the reference did not excite the input \[rad/s\] (M14.15).
    unexcited: Vec<[f64; 2]>,
}

/// Maximum half-length of drawn bars and bands \[dB, deg\]: large uncertainties would hide the
/// rest.
const MOST_HALF: [f64; 2] = [20.0, 180.0];

/// Half height of the mark at deviations from the points \[dB, deg\].
const LEFT_DB: f64 = 2.0;
const LEFT_DEG: f64 = 15.0;

/// Shows magnitude above and phase below; during refinement, the initial model.
pub(super) fn response_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let pair = state.display.selection.pair;
    let running = state.records.running(state.condition().id());
    let first = running.and_then(|job| job.news().first_model);
    let drawn = match (records.identification(), first) {
        (_, Some(first)) => {
            let job = running.map_or([0.1, 10.0], |job| job.request.options.band);
            kept(ui, "first model", &[Arc::clone(&first) as _], pair, || {
                DrawnResponse {
                    unrefined: model_curve(&first, job, pair, None),
                    ..DrawnResponse::default()
                }
            })
        }
        (Some(found), None) => {
            let options = records.found.as_ref().map(|(job, _)| &job.request.options);
            let band = options.map_or([0.1, 10.0], |options| options.band);
            let by_reference = options.is_some_and(|options| options.references > 0);
            kept(ui, "response", &[Arc::clone(found) as _], pair, || {
                drawn(found, band, (pair, by_reference))
            })
        }
        (None, None) => {
            let text = "Nothing was identified yet: choose Identify above. The measured response, the models and their bands stand here then.";
            ui.label(RichText::new(text).color(palette.dim_text));
            return;
        }
    };
    legend_ui(ui, &drawn, palette);
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, egui::Sense::hover());
    let height = 0.5 * area.height();
    let name = state.dataset().pair_name(pair);
    for (row, (part, label)) in [(1, "Magnitude [dB]"), (2, "Phase [deg]")]
        .into_iter()
        .enumerate()
    {
        let title = format!("{name}: {}", if row == 0 { "magnitude" } else { "phase" });
        let across = if row == 1 {
            state.display.curves.unit.axis_label()
        } else {
            String::new()
        };
        let mut chart = chart_of((&title, &across, label), &drawn, part, state, palette);
        if row == 0 {
            chart
                .notes
                .extend(marks(page).map(|mark| (format!("⚠ {mark}"), palette.warning)));
        }
        chart.spans.extend(spans(page));
        let corner = area.min + vec2(0.0, row as f32 * height);
        chart_ui(
            ui,
            Rect::from_min_size(corner, vec2(area.width(), height)),
            &chart,
            palette,
        );
    }
}

/// Returns short marks for cautions about the displayed response: its pair, input or output, or all
/// responses.
fn marks(Page { state, records, .. }: Page<'_>) -> impl Iterator<Item = &'static str> {
    let dataset = state.dataset();
    let pair = state.display.selection.pair;
    let names = [
        &dataset.outputs()[pair.output].name,
        &dataset.inputs()[pair.input].name,
    ];
    let concerns = move |note: &CautionNote| match (&note.pair, &note.channel, note.code) {
        (Some(of), ..) => [&of[0], &of[1]] == names,
        (None, Some(channel), _) => note.records.is_empty() && names.contains(&channel),
        (None, None, code) => code.starts_with("feedback") || code == "band-narrowed",
    };
    records
        .cautions()
        .map(|(_, note)| note)
        .filter(concerns)
        .map(|note| note.mark())
}

/// Returns the frequency intervals of cautions about all responses: the lower end for short
/// records, and frequencies that no input excites.
fn spans(
    Page {
        records, palette, ..
    }: Page<'_>,
) -> impl Iterator<Item = ChartSpan> {
    let color = palette.warning.gamma_multiply(0.1);
    let band = records
        .found
        .as_ref()
        .map_or([0.0; 2], |(job, _)| job.request.options.band);
    let of_all = move |(_, note): (Vec<usize>, CautionNote)| match (note.code, note.band_rad_s) {
        ("short", Some(ends)) => vec![ends],
        ("band-narrowed", Some([low, high])) => vec![[band[0], low], [high, band[1]]],
        _ => Vec::new(),
    };
    let ends = records
        .cautions()
        .flat_map(of_all)
        .filter(|[from, to]| from < to);
    ends.map(move |ends| ChartSpan { ends, color })
}

/// Returns half of the 95 % interval of a magnitude or a phase, limited to the drawn length.
fn half_drawn(sd: &[f64; 2], part: usize) -> f64 {
    (TWO_SIDED_95 * sd[part - 1]).min(MOST_HALF[part - 1])
}

fn legend_ui(ui: &mut Ui, drawn: &DrawnResponse, palette: &Palette) {
    let sds = drawn
        .measured
        .iter()
        .map(|(_, sd, _)| sd)
        .chain(&drawn.bands);
    let is_cut = |sd: &[f64; 2]| {
        [1, 2]
            .iter()
            .any(|&part| half_drawn(sd, part) < TWO_SIDED_95 * sd[part - 1])
    };
    let cut = sds
        .into_iter()
        .any(is_cut)
        .then_some("bars and bands end at ± 20 dB and ± 180°");
    let legend = [
        (
            Key::Line { dashed: false },
            "CT-PBSID, refined, with its 95 % band",
            palette.identified,
        ),
        (Key::Line { dashed: true }, "CT-PBSID", palette.accent),
        (
            Key::Dot { filled: true },
            "measured (local polynomial), ± 1.96 sd",
            palette.text,
        ),
        (
            Key::Dot { filled: false },
            "partial coherence below 0.6, or of few lines",
            palette.dim_text,
        ),
    ];
    let unexcited = (Key::Bar, "the reference does not excite", palette.dim_text);
    let unexcited = (!drawn.unexcited.is_empty()).then_some(unexcited);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        for (key, text, color) in legend.into_iter().chain(unexcited) {
            // In one piece: no line break between a sample and its label.
            let words = text_width(ui, text, small());
            let (rect, response) =
                ui.allocate_exact_size(vec2(SAMPLE + 4.0 + words, 14.0), Sense::hover());
            key.paint(ui, rect.with_max_x(rect.left() + SAMPLE), color);
            painted_text(ui, rect, SAMPLE + 4.0, text, small(), palette.dim_text);
            named(response, Role::Label, text);
        }
        cut.into_iter()
            .for_each(|words| drop(ui.label(palette.small(words))));
    });
}

/// Length of a sample in the legend \[pt\].
const SAMPLE: f32 = 18.0;

/// Sample in front of a legend label.
#[derive(Clone, Copy)]
enum Key {
    Line { dashed: bool },
    Dot { filled: bool },
    Bar,
}

impl Key {
    fn paint(self, ui: &Ui, rect: Rect, color: Color32) {
        let painter = ui.painter();
        let stroke = Stroke::new(2.0, color);
        let ends = [rect.left_center(), rect.right_center()];
        match self {
            Self::Line { dashed: false } => drop(painter.line_segment(ends, stroke)),
            Self::Line { dashed: true } => {
                painter.extend(Shape::dashed_line(&ends, Stroke::new(1.2, color), 4.0, 3.0))
            }
            Self::Dot { filled: true } => drop(painter.circle_filled(rect.center(), 3.0, color)),
            Self::Dot { filled: false } => {
                painter.circle_stroke(rect.center(), 3.0, Stroke::new(1.0, color));
            }
            Self::Bar => drop(painter.rect_filled(
                rect.shrink2(vec2(0.0, 4.0)),
                0.0,
                color.gamma_multiply(0.25),
            )),
        }
    }
}

fn chart_of<'a>(
    (title, across, label): (&'a str, &'a str, &'a str),
    drawn: &DrawnResponse,
    part: usize,
    state: &State,
    palette: &Palette,
) -> Chart<'a> {
    let mut chart = Chart::new(
        title,
        ChartAxis::Frequency(state.display.curves.unit),
        across,
        label,
    );
    chart.group = Some(egui::Id::unique("identified response"));
    let band = drawn.recommended.iter().zip(&drawn.bands).map(|(at, sd)| {
        let half = half_drawn(sd, part);
        [at[0], at[part] - half, at[part] + half]
    });
    chart.bands.push(ChartBand {
        points: band.collect(),
        color: palette.identified.gamma_multiply(0.28),
    });
    let line = |curve: &Curve, color: Color32, dashed: bool| ChartLine {
        points: curve
            .iter()
            .map(|at| [at[0], at[part]])
            .collect::<Vec<_>>()
            .into(),
        color,
        width: if dashed { 1.2 } else { 2.0 },
        dashed,
    };
    chart.lines = vec![
        line(&drawn.unrefined, palette.accent, true),
        line(&drawn.recommended, palette.identified, false),
    ];
    // A bar about the curve where the model deviates from the points or the reference does not
    // excite the input.
    let marked = drawn.left.iter().map(|span| (span, palette.warning));
    for (span, color) in marked.chain(drawn.unexcited.iter().map(|span| (span, palette.dim_text))) {
        let near = drawn
            .recommended
            .iter()
            .filter(|at| (span[0]..=span[1]).contains(&at[0]));
        let half = if part == 1 { LEFT_DB } else { LEFT_DEG };
        let points = near
            .map(|at| [at[0], at[part] - half, at[part] + half])
            .collect();
        chart.bands.push(ChartBand {
            points,
            color: color.gamma_multiply(0.25),
        });
    }
    for trusted in [false, true] {
        let points = drawn.measured.iter().filter(|(.., of)| *of == trusted);
        let points = points
            .map(|(at, sd, _)| [at[0], at[part], TWO_SIDED_95 * sd[part - 1]])
            .collect();
        let color = if trusted {
            palette.text
        } else {
            palette.dim_text
        };
        chart.marks.push(ChartMarks {
            points,
            sideways: Vec::new(),
            color,
            filled: trusted,
            crosses: false,
        });
    }
    chart
}

fn drawn(
    found: &Identification,
    band: [f64; 2],
    (pair, by_reference): (Pair, bool),
) -> DrawnResponse {
    let points = &found.measured.points;
    let at = (pair.output, pair.input);
    let sds = points.iter().map(|point| {
        Some(point.sd(at))
            .filter(|sd| sd.is_finite())
            .unwrap_or(0.0)
    });
    let is_narrow = |point: &EstimatePoint| point.half_width <= NARROW_WINDOW * point.omega;
    let trusted = points
        .iter()
        .map(|point| point.partial_coherence[at] >= TRUSTED_COHERENCE && is_narrow(point));
    let measured = shape(
        points.iter().map(|point| (point.omega, point.response[at])),
        None,
    );
    let measured: Vec<_> = measured
        .into_iter()
        .zip(sds.zip(trusted))
        .map(|(at, (sd, trusted))| (at, [neper_to_db(sd), sd.to_degrees()], trusted))
        .collect();
    let reference = measured
        .iter()
        .find(|(.., trusted)| *trusted)
        .map(|(at, ..)| *at);
    let bands = found.refined.bands.as_ref();
    let left = found.cautions.iter().filter_map(|caution| match caution {
        IdentificationCaution::LeavesPoints {
            output,
            input,
            band,
            ..
        } if (output.index, input.index) == at => Some(*band),
        _ => None,
    });
    let sd = bands
        .into_iter()
        .flat_map(|bands| bands.sd_db()[pair].iter().zip(&bands.sd_deg()[pair]));
    let omega = bands.map_or(&[][..], |bands| bands.omega());
    DrawnResponse {
        recommended: found
            .refined
            .state_space()
            .map_or_else(Curve::new, |of| curve(of, omega, pair, reference)),
        bands: sd.map(|(db, deg)| [*db, *deg]).collect(),
        unrefined: found
            .unrefined
            .state_space()
            .map_or_else(Curve::new, |of| model_curve(of, band, pair, reference)),
        measured,
        left: left.collect(),
        unexcited: if by_reference {
            unexcited(points, at)
        } else {
            Vec::new()
        },
    }
}

/// Returns the intervals in which the coherence of an input with the reference is too low for a
/// response.
fn unexcited(points: &[EstimatePoint], at: (usize, usize)) -> Vec<[f64; 2]> {
    let is_low = |point: &EstimatePoint| point.partial_coherence[at] < TRUSTED_COHERENCE;
    let runs = points
        .chunk_by(|a, b| is_low(a) == is_low(b))
        .filter(|run| is_low(&run[0]));
    runs.map(|run| [run[0].omega, run[run.len() - 1].omega])
        .collect()
}

/// Returns the response of a model, with the phase on the branch nearest to `reference`.
fn curve(model: &StateSpace, omegas: &[f64], pair: Pair, reference: Option<[f64; 3]>) -> Curve {
    let response = evaluate(model, omegas);
    let values = omegas
        .iter()
        .copied()
        .zip(response.curve(pair).iter().copied());
    shape(values.filter(|(_, value)| value.is_finite()), reference)
}

fn model_curve(
    model: &StateSpace,
    band: [f64; 2],
    pair: Pair,
    reference: Option<[f64; 3]>,
) -> Curve {
    curve(
        model,
        &log_spaced(band[0] / BEYOND, band[1] * BEYOND, POINTS),
        pair,
        reference,
    )
}

/// Returns magnitude and unwrapped phase, on the branch nearest to `reference`, a point of another
/// curve.
fn shape(values: impl Iterator<Item = (f64, Complex<f64>)>, reference: Option<[f64; 3]>) -> Curve {
    let (omega, values): (Vec<f64>, Vec<Complex<f64>>) = values.unzip();
    let ResponseShape {
        magnitude_db,
        phase_deg,
    } = ResponseShape::new(&values);
    let distance = |at: &usize, to: f64| (omega[*at] / to).ln().abs();
    let shift = reference.map_or(0.0, |[to, _, phase]| {
        let nearest = (0..omega.len()).min_by(|a, b| distance(a, to).total_cmp(&distance(b, to)));
        nearest.map_or(0.0, |nearest| {
            360.0 * ((phase - phase_deg[nearest]) / 360.0).round()
        })
    });
    (0..omega.len())
        .map(|at| [omega[at], magnitude_db[at], phase_deg[at] + shift])
        .collect()
}

/// Shows moduli of the poles over frequency, one row for each order; crosses mark poles that agree
/// with those of the order two below.
pub(super) fn stabilisation_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(found) = page.identification_ui(ui) else {
        return;
    };
    let text =
        "Crosses: within 5 % of a pole of the order two below. Circles: not. Dotted: the band.";
    ui.label(palette.small(text));
    let unit = state.display.curves.unit;
    let across = unit.axis_label();
    let title = "Stabilisation diagram: |λ| of the models of every order, at the best Laguerre pole and past window";
    let mut chart = Chart::new(title, ChartAxis::Frequency(unit), &across, "order");
    chart.verticals = records
        .found
        .iter()
        .flat_map(|(job, _)| job.request.options.band)
        .collect();
    chart.notes.extend(
        records
            .marks("order-limit")
            .map(|mark| (mark, palette.warning)),
    );
    for stable in [false, true] {
        let points = found
            .stabilisation
            .iter()
            .filter(|point| point.stable == stable && point.pole.norm() > 0.0);
        let place = |point: &StabilisationPoint| [point.pole.norm(), point.order as f64, 0.0];
        chart.marks.push(ChartMarks {
            points: points.map(place).collect(),
            sideways: Vec::new(),
            color: if stable {
                palette.perturbed
            } else {
                palette.dim_text
            },
            filled: false,
            crosses: stable,
        });
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, egui::Sense::hover());
    chart_ui(ui, area, &chart, palette);
}

/// Shows the s-plane with an error bar on every pole.
pub(super) fn identified_poles_ui(ui: &mut Ui, page: Page<'_>) {
    let palette = page.palette;
    let Some(found) = page.identification_ui(ui) else {
        return;
    };
    let text =
        "± 1.96 standard deviations. Grey: below the band, or not determined by these records.";
    ui.label(palette.small(text));
    let mut chart = Chart::new(
        "Poles of CT-PBSID, refined",
        ChartAxis::Linear,
        "Re λ [rad/s]",
        "Im λ [rad/s]",
    );
    chart.verticals = vec![0.0];
    chart.notes.extend(
        page.records
            .marks("unstable")
            .map(|mark| (mark, palette.warning)),
    );
    for determined in [false, true] {
        let poles = || {
            found
                .poles
                .iter()
                .filter(move |pole| pole.determined == determined)
        };
        // The bar of an undetermined pole would hide the others.
        let bar = |sd: f64| if determined { TWO_SIDED_95 * sd } else { 0.0 };
        let place = |of: &PoleEstimate| [of.pole.re, of.pole.im, bar(of.sd_im)];
        chart.marks.push(ChartMarks {
            points: poles().map(place).collect(),
            sideways: poles().map(|of| bar(of.sd_re)).collect(),
            color: if determined {
                palette.identified
            } else {
                palette.dim_text
            },
            filled: false,
            crosses: true,
        });
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, egui::Sense::hover());
    chart_ui(ui, area, &chart, palette);
}
