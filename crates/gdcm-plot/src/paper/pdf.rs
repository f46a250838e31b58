//! A drawing as PDF: one page as large as the drawing, text as text. No dates, no random names.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};
use subsetter::GlyphRemapper;

use gdcm_model::message_text::sanitized;

use crate::figure::Color;
use crate::figure::drawing::{Area, Drawing, Shape, Stroke, Text};
use crate::figure::letters::{FONTS, Letter, letters, width};

/// Distance of the control points of a cubic curve for a quarter circle, as a fraction of the
/// radius.
const QUARTER: f64 = 0.552_284_749_830_793_4;

/// Returns the bytes of the file.
pub fn pdf(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let [catalog, pages, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut drawn = Page {
        content: Content::new(),
        height: drawing.size[1],
        used: UsedLetters::default(),
    };
    drawn
        .content
        .set_line_join(LineJoinStyle::RoundJoin)
        .set_line_cap(LineCapStyle::ButtCap);
    drawing.shapes.iter().for_each(|shape| drawn.shape(shape));
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let stream = packed(&drawn.content.finish())?;
    pdf.stream(content, &stream).filter(Filter::FlateDecode);
    let fonts = drawn.used.write(&mut pdf, Ref::new(6))?;
    let mut entry = pdf.page(page);
    let [width, height] = drawing.size.map(|length| length as f32);
    entry
        .parent(pages)
        .media_box(Rect::new(0.0, 0.0, width, height))
        .contents(content);
    let mut resources = entry.resources();
    let mut list = resources.fonts();
    for (name, font) in fonts {
        list.pair(Name(name.as_bytes()), font);
    }
    list.finish();
    resources.finish();
    entry.finish();
    pdf.document_info(info)
        .title(TextStr(&sanitized(&drawing.title)))
        .creator(TextStr("gdcm"));
    Ok(pdf.finish())
}

/// Content of the page, in coordinates from its lower left corner up.
struct Page {
    content: Content,
    height: f64,
    used: UsedLetters,
}

impl Page {
    fn at(&self, [x, y]: [f64; 2]) -> [f32; 2] {
        [x as f32, (self.height - y) as f32]
    }

    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Path {
                points,
                closed,
                fill,
                stroke,
            } => {
                self.take_paint(*fill, *stroke);
                for (index, point) in points.iter().enumerate() {
                    let [x, y] = self.at(*point);
                    if index == 0 {
                        self.content.move_to(x, y)
                    } else {
                        self.content.line_to(x, y)
                    };
                }
                if *closed {
                    self.content.close_path();
                }
                self.draw(*fill, *stroke);
            }
            Shape::Circle {
                center,
                radius,
                fill,
                stroke,
            } => {
                self.take_paint(*fill, *stroke);
                self.circle(*center, *radius);
                self.draw(*fill, *stroke);
            }
            Shape::Text(text) => self.text(text),
            Shape::Clipped { area, shapes } => {
                let Area {
                    left,
                    width,
                    height,
                    ..
                } = *area;
                let [x, y] = self.at([left, area.bottom()]);
                self.content
                    .save_state()
                    .rect(x, y, width as f32, height as f32)
                    .clip_nonzero()
                    .end_path();
                shapes.iter().for_each(|shape| self.shape(shape));
                self.content.restore_state();
            }
        }
    }

    fn circle(&mut self, [x, y]: [f64; 2], radius: f64) {
        let at = |dx: f64, dy: f64| self.at([x + radius * dx, y + radius * dy]);
        let quarters =
            [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|[dx, dy]: [f64; 2]| {
                // A quarter turn on from (dx, dy) is (-dy, dx).
                [
                    at(dx - QUARTER * dy, dy + QUARTER * dx),
                    at(QUARTER * dx - dy, QUARTER * dy + dx),
                    at(-dy, dx),
                ]
            });
        let [start_x, start_y] = at(1.0, 0.0);
        self.content.move_to(start_x, start_y);
        for [[x1, y1], [x2, y2], [x3, y3]] in quarters {
            self.content.cubic_to(x1, y1, x2, y2, x3, y3);
        }
        self.content.close_path();
    }

    fn take_paint(&mut self, fill: Option<Color>, stroke: Option<Stroke>) {
        if let Some(color) = fill {
            let [red, green, blue] = parts(color);
            self.content.set_fill_rgb(red, green, blue);
        }
        if let Some(Stroke {
            color,
            width_pt,
            dash,
        }) = stroke
        {
            let [red, green, blue] = parts(color);
            let lengths = dash.pattern_pt().iter().map(|length| *length as f32);
            self.content
                .set_stroke_rgb(red, green, blue)
                .set_line_width(width_pt as f32)
                .set_dash_pattern(lengths, 0.0);
        }
    }

    fn draw(&mut self, fill: Option<Color>, stroke: Option<Stroke>) {
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
    }

    fn text(&mut self, text: &Text) {
        let [red, green, blue] = parts(text.color);
        let before = text.anchor.before() * width(&text.words) * text.size_pt;
        let [x, y] = text.at;
        let (matrix, [x, y]) = if text.upright {
            ([0.0, 1.0, -1.0, 0.0], self.at([x, y + before]))
        } else {
            ([1.0, 0.0, 0.0, 1.0], self.at([x - before, y]))
        };
        let [a, b, c, d] = matrix;
        self.content
            .begin_text()
            .set_fill_rgb(red, green, blue)
            .set_text_matrix([a, b, c, d, x, y]);
        let letters = letters(&text.words);
        for run in letters.chunk_by(|one, next| one.font == next.font) {
            self.run(run, text.size_pt);
        }
        self.content.end_text();
    }

    /// Writes letters of one font.
    fn run(&mut self, run: &[Letter], size_pt: f64) {
        let Some(first) = run.first() else { return };
        let codes: Vec<u8> = run
            .iter()
            .flat_map(|letter| self.used.code(letter).to_be_bytes())
            .collect();
        self.content
            .set_font(Name(FONTS[first.font].0.as_bytes()), size_pt as f32)
            .show(Str(&codes));
    }
}

fn parts(color: Color) -> [f32; 3] {
    color.rgb().map(|part| f32::from(part) / 255.0)
}

/// Units per em of a PDF font.
const UNITS: f64 = 1000.0;
const IDENTITY: SystemInfo<'static> = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};

/// The used letters of each font, numbered in order of first use.
#[derive(Default)]
pub(super) struct UsedLetters {
    fonts: [Used; FONTS.len()],
}

#[derive(Default)]
struct Used {
    numbers: GlyphRemapper,
    /// The letters in the order of their numbers, from 1.
    letters: Vec<Letter>,
}

impl UsedLetters {
    /// Returns the number of a letter in its font.
    pub(super) fn code(&mut self, letter: &Letter) -> u16 {
        let Used { numbers, letters } = &mut self.fonts[letter.font];
        let is_new = numbers.get(letter.glyph).is_none();
        let code = numbers.remap(letter.glyph);
        if is_new {
            letters.push(*letter);
        }
        code
    }

    /// Writes the used fonts as objects from `first` on; returns the name and the object of each.
    pub(super) fn write(&self, pdf: &mut Pdf, first: Ref) -> io::Result<Vec<(&'static str, Ref)>> {
        let mut next = first;
        let mut written = Vec::new();
        for (used, (name, bytes)) in self.fonts.iter().zip(FONTS) {
            if !used.letters.is_empty() {
                written.push((name, used.write(pdf, (name, bytes), &mut next)?));
            }
        }
        Ok(written)
    }
}

impl Used {
    fn write(
        &self,
        pdf: &mut Pdf,
        (name, bytes): (&str, &[u8]),
        next: &mut Ref,
    ) -> io::Result<Ref> {
        let [font, descendant, descriptor, characters, file] = std::array::from_fn(|_| next.bump());
        let subset = subsetter::subset(bytes, 0, &self.numbers).map_err(io::Error::other)?;
        let face = FontRef::new(bytes).map_err(io::Error::other)?;
        // Readers expect six letters and a plus before the name of a font subset.
        let part = format!("GDCMFG+{name}");
        let part = Name(part.as_bytes());
        pdf.type0_font(font)
            .base_font(part)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(descendant)
            .to_unicode(characters);
        let mut cid_font = pdf.cid_font(descendant);
        cid_font
            .subtype(CidFontType::Type2)
            .base_font(part)
            .system_info(IDENTITY)
            .font_descriptor(descriptor);
        cid_font
            .default_width(0.0)
            .cid_to_gid_map_predefined(Name(b"Identity"));
        let advances = self
            .letters
            .iter()
            .map(|letter| (UNITS * letter.advance) as f32);
        cid_font.widths().consecutive(1, advances).finish();
        cid_font.finish();
        self.describe(pdf, (descriptor, file), part, &face);
        pdf.stream(characters, &packed(&self.characters())?)
            .filter(Filter::FlateDecode);
        let length = i32::try_from(subset.len()).map_err(io::Error::other)?;
        pdf.stream(file, &packed(&subset)?)
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), length);
        Ok(font)
    }

    fn describe(
        &self,
        pdf: &mut Pdf,
        (descriptor, file): (Ref, Ref),
        name: Name<'_>,
        face: &FontRef<'_>,
    ) {
        let metrics = face.metrics(Size::new(UNITS as f32), LocationRef::default());
        let bounds = metrics.bounds.unwrap_or_default();
        pdf.font_descriptor(descriptor)
            .name(name)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(
                bounds.x_min,
                bounds.y_min,
                bounds.x_max,
                bounds.y_max,
            ))
            .italic_angle(metrics.italic_angle)
            .ascent(metrics.ascent)
            .descent(metrics.descent)
            .cap_height(metrics.cap_height.unwrap_or(metrics.ascent))
            // No reader uses it for an embedded font.
            .stem_v(80.0)
            .font_file2(file);
    }

    /// Returns the character of each letter.
    fn characters(&self) -> Vec<u8> {
        let mut map = UnicodeCmap::<u16>::new(Name(b"Custom"), IDENTITY);
        for letter in &self.letters {
            if let Some(code) = self.numbers.get(letter.glyph) {
                map.pair(code, letter.character);
            }
        }
        map.finish().to_vec()
    }
}

/// Compresses bytes as PDF expects them.
pub(super) fn packed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}
