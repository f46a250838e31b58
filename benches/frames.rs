//! `cargo bench --bench frames`: processor time of a frame of the window, for each tab, compared
//! with plain lines.
//!
//! Target: 4 ms, including tessellation, for the Bode plot with the net gains below. The baseline
//! passes the curves of both panes to egui_plot point by point, and draws nothing else: no panels,
//! no legend, no dashes.

mod window;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;
use egui::{Context, Event, FullOutput, RawInput, Rect, Ui, pos2, vec2};
use egui_plot::{Line, Plot};

use gdcm::gui::plot::{BodeCurve, BodeScene, BodeView, CurveId, Role, bode_ui};
use gdcm::gui::widgets::palette::Palette;
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};

use window::Window;

const SIZE: egui::Vec2 = vec2(1600.0, 900.0);
/// Number of curves, and number of points on each; the target applies to the first.
const SIZES: [(usize, usize); 5] = [(25, 500), (25, 5000), (100, 500), (6, 500), (1000, 500)];
/// Number of measured frames; the table shows the medians of their times.
const FRAMES: usize = 301;

/// Activity of the engineer from frame to frame.
#[derive(Clone, Copy, PartialEq)]
enum Activity {
    Nothing,
    /// The pointer crosses the large plot.
    Pointing,
    /// The window changes its size, so that no layout of the previous frame can be reused.
    Resizing,
}

/// Processor time of a frame, and its size.
struct FrameCost {
    /// Time to create the shapes.
    shapes: Duration,
    tessellation: Duration,
    vertices: usize,
}

/// Screen on which frames are drawn and timed.
struct Screen<'a> {
    ctx: Context,
    draw: Box<dyn FnMut(&mut Ui) + 'a>,
    activity: Activity,
    frames: u32,
}

impl<'a> Screen<'a> {
    fn new(ctx: Context, activity: Activity, draw: impl FnMut(&mut Ui) + 'a) -> Self {
        let mut screen = Self {
            ctx,
            draw: Box::new(draw),
            activity,
            frames: 0,
        };
        // In the first frames, sizes still change and texts are laid out.
        for _ in 0..10 {
            screen.tessellated_frame();
        }
        screen
    }

    /// Processes the input, lays out everything, and paints it as shapes.
    fn shapes(&mut self) -> FullOutput {
        self.frames += 1;
        let step = (self.frames % 100) as f32;
        let size = if self.activity == Activity::Resizing {
            SIZE - vec2(0.0, step)
        } else {
            SIZE
        };
        // Moves along a slanted line through the magnitude plot.
        let pointer = Event::PointerMoved(pos2(400.0 + 7.0 * step, 100.0 + 2.0 * step));
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), size)),
            // Late enough that all animations have ended.
            time: Some(1e4 + f64::from(self.frames) / 60.0),
            events: if self.activity == Activity::Pointing {
                vec![pointer]
            } else {
                Vec::new()
            },
            ..RawInput::default()
        };
        self.ctx.run_ui(input, &mut self.draw)
    }

    /// Draws a whole frame.
    fn tessellated_frame(&mut self) -> FrameCost {
        let start = Instant::now();
        let mut output = self.shapes();
        let shapes = start.elapsed();
        let primitives = self
            .ctx
            .tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        let tessellation = start.elapsed() - shapes;
        output.drop_without_applying_deltas();
        let mut vertices = 0;
        for primitive in black_box(&primitives) {
            if let egui::epaint::Primitive::Mesh(mesh) = &primitive.primitive {
                vertices += mesh.vertices.len();
            }
        }
        FrameCost {
            shapes,
            tessellation,
            vertices,
        }
    }
}

/// Returns a second-order lag with a notch, whose curve has as many bends as a coupled response.
fn curve(number: usize, points: usize) -> BodeCurve {
    let omega: Vec<f64> = (0..points)
        .map(|k| 0.3 * (20.0f64 / 0.3).powf(k as f64 / (points - 1) as f64))
        .collect();
    let corner = 2.0 + 0.05 * number as f64;
    let magnitude = |w: &f64| {
        let lag = (w / corner).powi(2);
        let notch = (w / (2.0 * corner)).powi(2);
        -10.0 * ((1.0 - lag).powi(2) + 0.3 * lag).log10()
            + 5.0 * ((1.0 - notch).powi(2) + 0.1 * notch).log10()
    };
    let phase = |w: &f64| {
        -(0.5 * w / corner)
            .atan2(1.0 - (w / corner).powi(2))
            .to_degrees()
            - 4.0 * w
    };
    BodeCurve {
        id: CurveId::Model(ModelId::new(
            ConditionId(1),
            BundleKind::Physics,
            number.to_string(),
        )),
        label: format!("model {number}"),
        detail: String::new(),
        role: match number {
            0 => Role::Nominal,
            1 => Role::Representative,
            2 => Role::Corrected,
            3 => Role::Scheduled,
            4 => Role::IdentifiedRepresentative,
            5 | 6 => Role::Identified,
            _ => Role::Perturbed,
        },
        rejected: number == 23,
        highlighted: false,
        hidden: false,
        magnitude_db: omega.iter().map(magnitude).collect(),
        phase_deg: omega.iter().map(phase).collect(),
        omega: omega.into(),
    }
}

/// Returns a screen with the Bode plot alone, as in the window.
fn bode(curves: &[BodeCurve]) -> Screen<'_> {
    let mut view = BodeView::default();
    let palette = Palette::dark();
    Screen::new(Context::default(), Activity::Nothing, move |ui| {
        let scene = BodeScene::new("LON → Q", curves, (0.5, 12.0));
        bode_ui(ui, &scene, &mut view, &palette);
    })
}

/// Returns a screen with the same curves as plain lines in two plots.
fn plain(curves: &[BodeCurve]) -> Screen<'_> {
    Screen::new(Context::default(), Activity::Nothing, move |ui| {
        let height = 0.5 * ui.available_height() - 4.0;
        for name in ["magnitude", "phase"] {
            Plot::new(name).height(height).show(ui, |plot| {
                for curve in curves {
                    let values = if name == "magnitude" {
                        &curve.magnitude_db
                    } else {
                        &curve.phase_deg
                    };
                    let points: Vec<[f64; 2]> = curve
                        .omega
                        .iter()
                        .zip(values.iter())
                        .map(|(omega, value)| [omega.log10(), *value])
                        .collect();
                    plot.line(Line::new(&curve.label, points));
                }
            });
        }
    })
}

/// Times of a frame \[ms\].
struct Figures {
    /// Median time to create the shapes.
    shapes: f64,
    /// Median time to tessellate the shapes.
    tessellation: f64,
    /// Median of the total time.
    both: f64,
    /// Minimum of the total time, without disturbance by other processes.
    shortest: f64,
    /// Number of vertices in the last frame.
    vertices: usize,
}

impl Figures {
    fn measure(screen: &mut Screen<'_>) -> Self {
        let frames: Vec<FrameCost> = (0..FRAMES).map(|_| screen.tessellated_frame()).collect();
        let both = sorted_ms(&frames, |frame| frame.shapes + frame.tessellation);
        Self {
            shapes: sorted_ms(&frames, |frame| frame.shapes)[FRAMES / 2],
            tessellation: sorted_ms(&frames, |frame| frame.tessellation)[FRAMES / 2],
            both: both[FRAMES / 2],
            shortest: both[0],
            vertices: frames[FRAMES - 1].vertices,
        }
    }
}

/// Returns a time of each frame in ascending order \[ms\].
fn sorted_ms(frames: &[FrameCost], time: fn(&FrameCost) -> Duration) -> Vec<f64> {
    let mut times: Vec<f64> = frames
        .iter()
        .map(|frame| time(frame).as_secs_f64() * 1e3)
        .collect();
    times.sort_by(f64::total_cmp);
    times
}

/// Row of the printed table.
struct Row {
    name: String,
    figures: Figures,
    /// Median total time of plain lines \[ms\].
    plain: f64,
}

fn frames(criterion: &mut Criterion) {
    // The window is created first, so that the heap has the same size for plain lines and for the
    // window.
    let mut window = Window::settled();
    println!("The window shows {}.", window.curves_drawn());
    let mut rows: Vec<Row> = Vec::new();
    let mut group = criterion.benchmark_group("a frame");
    let mut measure = |name: String, screen: &mut Screen<'_>| {
        group.bench_function(&name, |bencher| bencher.iter(|| screen.tessellated_frame()));
        (name, Figures::measure(screen))
    };
    for (count, points) in SIZES {
        let curves: Vec<BodeCurve> = (0..count).map(|number| curve(number, points)).collect();
        let (name, figures) = measure(
            format!("plain lines, {count} of {points} points"),
            &mut plain(&curves),
        );
        let plain = figures.both;
        rows.push(Row {
            name,
            figures,
            plain,
        });
        let (name, figures) = measure(
            format!("Bode plot, {count} curves of {points} points"),
            &mut bode(&curves),
        );
        rows.push(Row {
            name,
            figures,
            plain,
        });
    }
    let plain = rows[0].plain;
    for (tab, activity, suffix) in [
        ("Bode", Activity::Nothing, ""),
        ("Bode", Activity::Pointing, ", pointer moving"),
        ("Bode", Activity::Resizing, ", resized"),
        ("Error", Activity::Nothing, ""),
        ("Error", Activity::Pointing, ", pointer moving"),
        ("Overview", Activity::Nothing, ""),
        ("Overview", Activity::Resizing, ", resized"),
        ("Channels", Activity::Nothing, ""),
        ("Channels", Activity::Resizing, ", resized"),
        ("Assessment", Activity::Nothing, ""),
    ] {
        window.show(tab);
        let (ctx, draw) = window.drawn();
        let (name, figures) = measure(
            format!("window, {tab}{suffix}"),
            &mut Screen::new(ctx, activity, draw),
        );
        rows.push(Row {
            name,
            figures,
            plain,
        });
    }
    group.finish();
    print_table(&rows);
}

fn print_table(rows: &[Row]) {
    println!(
        "{:40} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "ms a frame, median", "ui", "tessel.", "both", "shortest", "vertices", "of plain"
    );
    for Row {
        name,
        figures,
        plain,
    } in rows
    {
        let Figures {
            shapes,
            tessellation,
            both,
            shortest,
            vertices,
        } = figures;
        let ratio = both / plain;
        println!(
            "{name:40} {shapes:8.2} {tessellation:8.2} {both:8.2} {shortest:8.2} {vertices:8} {ratio:8.2}"
        );
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    frames(&mut criterion);
    criterion.final_summary();
}
