//! A drawing as PNG, with the same pixels on every machine.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, PixelDimensions, Unit};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use vello_cpu::color::AlphaColor;
use vello_cpu::kurbo::{
    Affine, BezPath, Cap, Circle, Join, Point, Rect, Shape as _, Stroke as PathStroke,
};
use vello_cpu::{Level, Pixmap, RenderContext, RenderSettings, Resources};

use crate::figure::Color;
use crate::figure::drawing::{Area, Drawing, Shape, Stroke, Text};
use crate::figure::letters::{FONTS, letters, width};

/// Dots per inch, as journals require.
const DOTS_PER_INCH: f64 = 300.0;
/// Dots per point.
const SCALE: f64 = DOTS_PER_INCH / 72.0;
/// Inches per metre.
const INCHES_PER_METRE: f64 = 1.0 / 0.0254;
/// Maximum distance between a drawn circle and a true circle \[pt\].
const TOLERANCE: f64 = 0.01;

/// Writes the drawing as a PNG file at 300 dots per inch.
///
/// # Errors
/// Fails if the file cannot be written.
pub fn write_png(drawing: &Drawing, file: &mut dyn Write) -> io::Result<()> {
    let [width, height] = drawing
        .size
        .map(|length| (length * SCALE).ceil().clamp(1.0, f64::from(u16::MAX)) as u16);
    let pixels = pixels(drawing, width, height);
    let mut encoder = Encoder::new(file, u32::from(width), u32::from(height));
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    let per_metre = (DOTS_PER_INCH * INCHES_PER_METRE).round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header().map_err(unpacked)?;
    writer.write_image_data(&pixels).map_err(unpacked)?;
    writer.finish().map_err(unpacked)
}

/// Returns the underlying I/O error, so that causes such as a full disk are reported as such.
fn unpacked(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        error => io::Error::other(error),
    }
}

/// Returns red, green and blue at each dot, row by row.
fn pixels(drawing: &Drawing, width: u16, height: u16) -> Vec<u8> {
    // Without processor-specific instructions, the dots are the same on every machine.
    let settings = RenderSettings {
        level: Level::baseline(),
        num_threads: 0,
    };
    let mut context = RenderContext::new_with(width, height, settings);
    context.set_transform(Affine::scale(SCALE));
    let ground = Shape::rectangle(
        Area::new(0.0, 0.0, drawing.size[0] + 1.0, drawing.size[1] + 1.0),
        Some(Color::WHITE),
        None,
    );
    let fonts: Vec<FontRef<'_>> = FONTS
        .iter()
        .filter_map(|(_, bytes)| FontRef::new(bytes).ok())
        .collect();
    paint(&mut context, &ground, &fonts);
    for shape in &drawing.shapes {
        paint(&mut context, shape, &fonts);
    }
    context.flush();
    let mut pixmap = Pixmap::new(width, height);
    context.render(&mut pixmap, &mut Resources::new());
    // The background is opaque white, so that premultiplied and plain colours are equal.
    pixmap
        .data_as_u8_slice()
        .chunks_exact(4)
        .flat_map(|dot| [dot[0], dot[1], dot[2]])
        .collect()
}

fn paint(context: &mut RenderContext, shape: &Shape, fonts: &[FontRef<'_>]) {
    match shape {
        Shape::Path {
            points,
            closed,
            fill,
            stroke,
        } => draw(context, &path(points, *closed), *fill, *stroke),
        Shape::Circle {
            center: [x, y],
            radius,
            fill,
            stroke,
        } => {
            draw(
                context,
                &Circle::new((*x, *y), *radius).to_path(TOLERANCE),
                *fill,
                *stroke,
            );
        }
        Shape::Text(text) => write(context, text, fonts),
        Shape::Clipped { area, shapes } => {
            let area = Rect::new(area.left, area.top, area.right(), area.bottom());
            context.push_clip_path(&area.to_path(TOLERANCE));
            for shape in shapes {
                paint(context, shape, fonts);
            }
            context.pop_clip_path();
        }
    }
}

fn path(points: &[[f64; 2]], closed: bool) -> BezPath {
    let mut path = BezPath::new();
    for (index, &[x, y]) in points.iter().enumerate() {
        if index == 0 {
            path.move_to((x, y))
        } else {
            path.line_to((x, y))
        }
    }
    if closed && !points.is_empty() {
        path.close_path();
    }
    path
}

/// Fills a path and draws its line, as far as given.
fn draw(context: &mut RenderContext, path: &BezPath, fill: Option<Color>, stroke: Option<Stroke>) {
    if let Some(color) = fill {
        set_color(context, color);
        context.fill_path(path);
    }
    if let Some(Stroke {
        color,
        width_pt,
        dash,
    }) = stroke
    {
        set_color(context, color);
        let line = PathStroke::new(width_pt)
            .with_caps(Cap::Butt)
            .with_join(Join::Round);
        context.set_stroke(line.with_dashes(0.0, dash.pattern_pt().iter().copied()));
        context.stroke_path(path);
    }
}

fn set_color(context: &mut RenderContext, color: Color) {
    let [red, green, blue] = color.rgb();
    context.set_paint(AlphaColor::from_rgb8(red, green, blue));
}

/// Draws a text by filling its letters' outlines.
fn write(context: &mut RenderContext, text: &Text, fonts: &[FontRef<'_>]) {
    let turn = if text.upright {
        -std::f64::consts::FRAC_PI_2
    } else {
        0.0
    };
    let place = Affine::translate((text.at[0], text.at[1]))
        * Affine::rotate(turn)
        * Affine::scale(text.size_pt);
    let mut pen = Pen {
        path: BezPath::new(),
        x: -text.anchor.before() * width(&text.words),
    };
    for letter in letters(&text.words) {
        let outline = fonts
            .get(letter.font)
            .and_then(|font| font.outline_glyphs().get(GlyphId::from(letter.glyph)));
        if let Some(outline) = outline {
            // A damaged outline is skipped; the built-in fonts have none.
            let _ = outline.draw(
                DrawSettings::unhinted(Size::new(1.0), LocationRef::default()),
                &mut pen,
            );
        }
        pen.x += letter.advance;
    }
    set_color(context, text.color);
    context.fill_path(&(place * pen.path));
}

/// Collects the outlines of letters side by side; y runs downwards.
struct Pen {
    path: BezPath,
    /// Horizontal position at which the next letter starts.
    x: f64,
}

impl Pen {
    /// Converts a point of the present letter, whose y runs upwards.
    fn at(&self, x: f32, y: f32) -> Point {
        Point::new(self.x + f64::from(x), -f64::from(y))
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.path.quad_to(self.at(cx, cy), self.at(x, y));
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        self.path
            .curve_to(self.at(cx0, cy0), self.at(cx1, cy1), self.at(x, y));
    }

    fn close(&mut self) {
        self.path.close_path();
    }
}
