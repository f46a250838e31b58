//! Compares every view, in both themes, with a picture that was inspected and accepted.
//!
//! `GDCM_PICTURES=write cargo test pictures` renews the pictures; inspect them before accepting
//! them.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::path::PathBuf;
use std::rc::Rc;

use dream_soft_render::{ClipRect, Color, Mesh, SoftwareRenderer, TextureId, Vertex};
use egui::epaint::{ColorImage, ImageData, ImageDelta, Primitive};
use egui::{TexturesDelta, ThemePreference};
use egui_kittest::TestRenderer;

use gdcm::gui::commands::assembling::AssemblingCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::view::View;
use gdcm::gui::widgets::palette::Palette;
use gdcm_study::Edit;

use super::assembling::type_into;
use super::views::{give, show};
use super::*;

/// Format of saved pictures: window size \[pt\], folder, and reduction factor. Pictures for
/// comparison are reduced as far as letters remain legible, so that the files are small.
#[derive(Clone, Copy)]
struct Format {
    size: [usize; 2],
    folder: &'static str,
    scale: usize,
}

/// Format of the compared pictures.
const COMPARED: Format = Format {
    size: [1280, 720],
    folder: "tests/data/pictures",
    scale: 2,
};
/// Format of the pictures in the documentation, at full window resolution.
const SHOWN: Format = Format {
    size: [1280, 720],
    folder: "assets/screenshots",
    scale: 1,
};

impl Format {
    /// Size of a picture \[px\].
    fn pixels(self) -> [usize; 2] {
        self.size.map(|side| side / self.scale)
    }

    fn path(self, name: &str) -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join(self.folder)
            .join(format!("{name}.png"))
    }
}

/// Minimum channel difference of a pixel that counts as different. A curve moved by rounding in the
/// last digit changes its pixels by less.
const OTHER: u8 = 40;
/// Maximum share of differing pixels: a digit or two may differ, but not a line of text or a curve.
const MOST_OTHERS: f64 = 0.002;

/// Textures of a window after all frames so far.
#[derive(Clone, Default)]
struct Textures(Rc<RefCell<HashMap<egui::TextureId, ColorImage>>>);

impl TestRenderer for Textures {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut textures = self.0.borrow_mut();
        for (id, changes) in std::mem::take(&mut delta.set) {
            for ImageDelta {
                image: ImageData::Color(image),
                pos,
                ..
            } in changes
            {
                match (pos, textures.get_mut(&id)) {
                    (Some([left, top]), Some(whole)) => {
                        for (row, line) in image.pixels.chunks(image.size[0]).enumerate() {
                            let start = (top + row) * whole.size[0] + left;
                            whole.pixels[start..start + line.len()].copy_from_slice(line);
                        }
                    }
                    _ => drop(textures.insert(id, (*image).clone())),
                }
            }
        }
        delta.free.clear();
    }
}

fn colour(of: egui::Color32) -> Color {
    let [r, g, b, a] = of.to_array();
    Color::from_rgba_premultiplied(r, g, b, a)
}

/// Renders the window as red, green and blue values, averaged over squares of the format's scale.
fn picture(window: &Window, textures: &Textures, format: Format) -> Vec<u8> {
    fn corner(at: Pos2) -> [u32; 2] {
        [at.x.round().max(0.0) as u32, at.y.round().max(0.0) as u32]
    }

    let [width, height] = format.size;
    let scale = format.scale;
    let mut renderer = SoftwareRenderer::default();
    let known: HashMap<egui::TextureId, TextureId> = textures
        .0
        .borrow()
        .iter()
        .map(|(id, image)| {
            let pixels: Vec<u8> = image
                .pixels
                .iter()
                .flat_map(|pixel| pixel.to_array())
                .collect();
            (
                *id,
                renderer
                    .create_texture(image.size[0], image.size[1], &pixels)
                    .expect("a texture of letters"),
            )
        })
        .collect();
    let shapes = window.ctx.tessellate(window.output().shapes.clone(), 1.0);
    let mut frame = renderer
        .begin_frame(width, height)
        .expect("the size is allowed");
    let ground = Palette::from_visuals(&window.ctx.global_style().visuals).background;
    frame.clear(colour(ground));
    for of in shapes {
        let Primitive::Mesh(mesh) = of.primitive else {
            continue;
        };
        let [min_x, min_y] = corner(of.clip_rect.min);
        let [max_x, max_y] = corner(of.clip_rect.max);
        let vertices: Vec<Vertex> = mesh
            .vertices
            .iter()
            .map(|at| Vertex::new(at.pos.into(), at.uv.into(), colour(at.color)))
            .collect();
        let texture = known.get(&mesh.texture_id).copied();
        let mesh = Mesh {
            vertices: &vertices,
            indices: &mesh.indices,
            texture,
        };
        let clip = ClipRect {
            min_x,
            min_y,
            max_x,
            max_y,
        };
        if let Err(error) = frame.mesh(mesh, clip) {
            let shown = View::ALL
                .into_iter()
                .filter(|view| state(window).display.layout.arrangement.is_shown(*view));
            panic!("a mesh of {:?}: {error:?}", shown.collect::<Vec<View>>());
        }
    }
    let pixels = &frame.surface().pixels;
    let average = |x: usize, y: usize, channel: usize| {
        let square = (0..scale * scale).map(|at| (x * scale + at % scale, y * scale + at / scale));
        let sum: usize = square
            .map(|(x, y)| usize::from(pixels[4 * (y * width + x) + channel]))
            .sum();
        (sum / (scale * scale)) as u8
    };
    let [columns, rows] = format.pixels();
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    places
        .flat_map(|(x, y)| [0, 1, 2].map(|channel| average(x, y, channel)))
        .collect()
}

fn write(name: &str, pixels: &[u8], format: Format) {
    let path = format.path(name);
    let [width, height] = format.pixels();
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(pixels)
        .unwrap();
}

fn read(name: &str, format: Format) -> Vec<u8> {
    let path = format.path(name);
    let file = File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

/// Returns a message if a picture differs from the accepted one. If pictures are being renewed,
/// saves the picture instead.
fn miss(name: &str, window: &Window, textures: &Textures, format: Format) -> Option<String> {
    let found = picture(window, textures, format);
    if std::env::var("GDCM_PICTURES").is_ok_and(|what| what == "write") {
        write(name, &found, format);
    }
    let part = others(&found, &read(name, format));
    (part > MOST_OTHERS).then(|| format!("{name}: {:.2} % of the pixels are others", 100.0 * part))
}

/// Returns the share of differing pixels.
fn others(one: &[u8], other: &[u8]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.chunks(3).zip(other.chunks(3));
    let differing = pairs
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > OTHER))
        .count();
    differing as f64 / (one.len() / 3) as f64
}

/// Returns whether the records of both conditions of the example that have some are read; those of
/// the displayed condition come first.
fn has_all_records(window: &Window) -> bool {
    let records = &state(window).records;
    let are_read = |id: ConditionId| {
        let of = records.conditions.get(&id);
        of.is_some_and(|of| of.rows.len() == 9)
    };
    records.reading.is_none() && are_read(ConditionId(3)) && are_read(ConditionId(10))
}

fn pictured_window(textures: &Textures, format: Format) -> Window {
    let size = vec2(format.size[0] as f32, format.size[1] as f32);
    let mut window = Harness::builder()
        .with_size(size)
        .renderer(textures.clone())
        .build_eframe(warm_example);
    settle(&mut window);
    window
}

#[test]
fn every_view_looks_as_it_did_in_both_themes() {
    let textures = Textures::default();
    let mut window = pictured_window(&textures, COMPARED);
    give(&mut window, LayoutCommand::OpenDock(false));
    give(
        &mut window,
        Edit::StoreVariant {
            name: "all models".to_owned(),
        },
    );
    click(&mut window, CONDITION_10);
    wait_for_bars(&mut window);
    let mut misses = Vec::new();
    for (theme, preference) in [
        ("dark", ThemePreference::Dark),
        ("light", ThemePreference::Light),
    ] {
        give(&mut window, LayoutCommand::SetTheme(preference));
        for view in View::ALL {
            show(&mut window, view);
            wait_until(&mut window, "what the view shows", |window| match view {
                View::Across => state(window).across().is_some(),
                View::Poles => state(window).modes().is_some(),
                View::Compare => !state(window).results.variants.is_empty(),
                View::Physics => state(window).physics().is_some(),
                View::Records => has_all_records(window),
                View::Requirements => {
                    has_all_records(window) && state(window).requirements().is_some()
                }
                _ => true,
            });
            // The status bar shows running work, which would change the picture.
            wait_until(&mut window, "rest", |window| {
                !state(window).results.background.is_busy()
            });
            // Wait for the end of the animations of tooltips, fades and scroll bars.
            window.run_steps(8);
            let name = format!("{}-{theme}", view.name().to_lowercase().replace(' ', "-"));
            misses.extend(miss(&name, &window, &textures, COMPARED));
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[test]
#[ignore = "the pictures of the views are enough by default; those of the pages take 15 s"]
fn the_pictures_of_the_pages_are_those_of_the_window() {
    let textures = Textures::default();
    let mut window = pictured_window(&textures, SHOWN);
    wait_for_bars(&mut window);
    click(&mut window, CONDITION_10);
    click(&mut window, "Response LON → Q");
    let mut misses = Vec::new();
    let mut look = |window: &mut Window, name: &str| {
        for (theme, preference) in [
            ("dark", ThemePreference::Dark),
            ("light", ThemePreference::Light),
        ] {
            give(window, LayoutCommand::SetTheme(preference));
            wait_for_background(window);
            window.run_steps(8);
            misses.extend(miss(&format!("{name}-{theme}"), window, &textures, SHOWN));
        }
    };
    window.key_press_modifiers(Modifiers::COMMAND, Key::R);
    settle(&mut window);
    wait_for_bars(&mut window);
    look(&mut window, "outliers");
    show(&mut window, View::Evidence);
    look(&mut window, "evidence");
    show(&mut window, View::Bode);
    click(&mut window, "Use leads");
    settle(&mut window);
    wait_for_bars(&mut window);
    look(&mut window, "leads");
    show(&mut window, View::Records);
    // The records of the other conditions are read after those of the displayed one.
    wait_until(&mut window, "the records", has_all_records);
    window.run_steps(2);
    click(&mut window, "More ways to identify");
    click(&mut window, "Identify condition 10 only");
    wait_until(&mut window, "the models", |window| {
        state(window).records.conditions[&ConditionId(10)]
            .identification()
            .is_some()
    });
    look(&mut window, "records");
    let folder = tempfile::tempdir().unwrap();
    crate::assembling::example_folder(folder.path());
    give(
        &mut window,
        AssemblingCommand::Add(vec![folder.path().to_owned()]),
    );
    wait_until(&mut window, "the models", |window| {
        state(window)
            .assembling
            .as_ref()
            .is_some_and(|bench| bench.reading.is_none() && !bench.sources.is_empty())
    });
    // Replace the paths, because the temporary folder changes with every run.
    for (field, text) in [
        ("Name of the dataset", "models"),
        ("Path of the dataset to make", "models.json.gz"),
        ("Path of the rules", "models.gdcm-rules.json"),
    ] {
        type_into(&mut window, field, text);
    }
    give(&mut window, AssemblingCommand::Select(5));
    look(&mut window, "models");
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[test]
fn a_missing_line_of_text_is_another_picture() {
    let textures = Textures::default();
    let mut window = pictured_window(&textures, COMPARED);
    let before = picture(&window, &textures, COMPARED);
    assert_eq!(
        others(&before, &picture(&window, &textures, COMPARED)),
        0.0,
        "a picture is the same twice"
    );
    click(&mut window, CONDITION_10);
    assert!(others(&before, &picture(&window, &textures, COMPARED)) > MOST_OTHERS);
}
