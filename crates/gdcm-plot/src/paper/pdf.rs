//! A drawing as PDF: a page as large as the drawing, with texts as text. No dates and no random
//! names, so that the same drawing produces the same file.

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

/// Distance from the ends of a quarter circle to its cubic curve's control points, relative to the
/// radius.
const QUARTER: f64 = 0.552_284_749_830_793_4;

/// Returns the bytes of a PDF file with these objects: catalog, page tree, page, content stream,
/// document information; then five objects (`FontObjects`) for each font that the page uses,
/// reduced to the letters that it uses.
///
/// 1. Paint the shapes into the content stream, and number the letters by their first use.
/// 2. Write catalog, page tree, content stream and fonts.
/// 3. Write the page, which refers to them, and the document information.
///
/// # Errors
/// Fails if a font cannot be read or reduced to the used letters, or if a stream cannot be
/// compressed.
pub fn pdf(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let [catalog, pages, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    // Step 1.
    let painted = Page::paint(drawing);
    // Step 2.
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let stream = packed(&painted.content.finish())?;
    pdf.stream(content, &stream).filter(Filter::FlateDecode);
    let fonts = painted.used.write(&mut pdf, Ref::new(6))?;
    // Step 3.
    let mut page_object = pdf.page(page);
    let [width, height] = drawing.size.map(|length| length as f32);
    page_object
        .parent(pages)
        .media_box(Rect::new(0.0, 0.0, width, height))
        .contents(content);
    let mut resources = page_object.resources();
    let mut font_list = resources.fonts();
    for (name, font) in fonts {
        font_list.pair(Name(name.as_bytes()), font);
    }
    font_list.finish();
    resources.finish();
    page_object.finish();
    pdf.document_info(info)
        .title(TextStr(&sanitized(&drawing.title)))
        .creator(TextStr("gdcm"));
    Ok(pdf.finish())
}

/// A page under construction; its coordinates run upwards from the lower left corner.
struct Page {
    content: Content,
    /// Page height \[pt\].
    height: f64,
    used: UsedLetters,
}

impl Page {
    fn paint(drawing: &Drawing) -> Self {
        let mut page = Self {
            content: Content::new(),
            height: drawing.size[1],
            used: UsedLetters::default(),
        };
        page.content
            .set_line_join(LineJoinStyle::RoundJoin)
            .set_line_cap(LineCapStyle::ButtCap);
        for shape in &drawing.shapes {
            page.shape(shape);
        }
        page
    }

    /// Converts a position in the drawing to page coordinates.
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
                self.set_style(*fill, *stroke);
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
                self.set_style(*fill, *stroke);
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
                for shape in shapes {
                    self.shape(shape);
                }
                self.content.restore_state();
            }
        }
    }

    /// Adds a circle to the current path, as four cubic curves.
    fn circle(&mut self, [x, y]: [f64; 2], radius: f64) {
        let [start_x, start_y] = self.at([x + radius, y]);
        self.content.move_to(start_x, start_y);
        let starts: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for [dx, dy] in starts {
            // A quarter turn maps (dx, dy) to (-dy, dx).
            let quarter = [
                [dx - QUARTER * dy, dy + QUARTER * dx],
                [QUARTER * dx - dy, QUARTER * dy + dx],
                [-dy, dx],
            ];
            let [[x1, y1], [x2, y2], [x3, y3]] =
                quarter.map(|[dx, dy]| self.at([x + radius * dx, y + radius * dy]));
            self.content.cubic_to(x1, y1, x2, y2, x3, y3);
        }
        self.content.close_path();
    }

    /// Sets fill colour and line style for the next path.
    fn set_style(&mut self, fill: Option<Color>, stroke: Option<Stroke>) {
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

    /// Ends the current path: fills it if `fill` is given, strokes it if `stroke` is given.
    fn draw(&mut self, fill: Option<Color>, stroke: Option<Stroke>) {
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
    }

    /// Writes a text in its colour, anchored and rotated, in runs of consecutive letters with the
    /// same font.
    fn text(&mut self, text: &Text) {
        let [red, green, blue] = parts(text.color);
        let before_anchor = text.anchor.before() * width(&text.words) * text.size_pt;
        let [x, y] = text.at;
        // The matrix rotates an upright text by a quarter turn; otherwise it is the identity.
        let (matrix, [x, y]) = if text.upright {
            ([0.0, 1.0, -1.0, 0.0], self.at([x, y + before_anchor]))
        } else {
            ([1.0, 0.0, 0.0, 1.0], self.at([x - before_anchor, y]))
        };
        let [a, b, c, d] = matrix;
        self.content
            .begin_text()
            .set_fill_rgb(red, green, blue)
            .set_text_matrix([a, b, c, d, x, y]);
        let letters = letters(&text.words);
        for run in letters.chunk_by(|letter, next| letter.font == next.font) {
            self.run(run, text.size_pt);
        }
        self.content.end_text();
    }

    /// Writes a run of letters that are all in the same font.
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

/// Returns red, green and blue as fractions from 0 to 1.
fn parts(color: Color) -> [f32; 3] {
    color.rgb().map(|part| f32::from(part) / 255.0)
}

/// Units per em in a PDF font.
const UNITS: f64 = 1000.0;
/// Letters are numbered by the file itself, not by a character collection.
const IDENTITY: SystemInfo<'static> = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};

/// The used letters, numbered in each font by their first use.
#[derive(Default)]
struct UsedLetters {
    /// In the order of [`FONTS`].
    fonts: [UsedFont; FONTS.len()],
}

/// The letters used in a font.
#[derive(Default)]
struct UsedFont {
    numbers: GlyphRemapper,
    /// Letter number n is at index n - 1.
    letters: Vec<Letter>,
}

impl UsedLetters {
    /// Returns a letter's number in its font, assigned at its first use.
    fn code(&mut self, letter: &Letter) -> u16 {
        let UsedFont { numbers, letters } = &mut self.fonts[letter.font];
        let is_new = numbers.get(letter.glyph).is_none();
        let code = numbers.remap(letter.glyph);
        if is_new {
            letters.push(*letter);
        }
        code
    }

    /// Writes the used fonts as PDF objects, numbered from `first` on; returns each font's name and
    /// object.
    fn write(&self, pdf: &mut Pdf, first: Ref) -> io::Result<Vec<(&'static str, Ref)>> {
        let mut next = first;
        let mut written = Vec::new();
        for (index, used) in self.fonts.iter().enumerate() {
            if !used.letters.is_empty() {
                written.push((FONTS[index].0, used.write(pdf, index, &mut next)?));
            }
        }
        Ok(written)
    }
}

/// PDF objects for a font: the composite font that texts select, and the objects to which it
/// refers.
struct FontObjects {
    /// The composite font.
    font: Ref,
    /// The composite font's only descendant, which holds the letter widths.
    descendant: Ref,
    /// Metrics of the descendant.
    descriptor: Ref,
    /// Map from letter numbers to characters.
    characters: Ref,
    /// Outlines of the used letters.
    file: Ref,
}

impl UsedFont {
    /// Writes the used letters of the font at this index in [`FONTS`]; returns the font object.
    fn write(&self, pdf: &mut Pdf, index: usize, next: &mut Ref) -> io::Result<Ref> {
        let (name, bytes) = FONTS[index];
        let objects = FontObjects {
            font: next.bump(),
            descendant: next.bump(),
            descriptor: next.bump(),
            characters: next.bump(),
            file: next.bump(),
        };
        let subset = subsetter::subset(bytes, 0, &self.numbers).map_err(io::Error::other)?;
        let face = FontRef::new(bytes).map_err(io::Error::other)?;
        // Readers expect six letters and a plus before the name of a font subset.
        let subset_name = format!("GDCMFG+{name}");
        let subset_name = Name(subset_name.as_bytes());
        pdf.type0_font(objects.font)
            .base_font(subset_name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(objects.descendant)
            .to_unicode(objects.characters);
        let mut cid_font = pdf.cid_font(objects.descendant);
        cid_font
            .subtype(CidFontType::Type2)
            .base_font(subset_name)
            .system_info(IDENTITY)
            .font_descriptor(objects.descriptor);
        cid_font
            .default_width(0.0)
            .cid_to_gid_map_predefined(Name(b"Identity"));
        let advances = self
            .letters
            .iter()
            .map(|letter| (UNITS * letter.advance) as f32);
        cid_font.widths().consecutive(1, advances).finish();
        cid_font.finish();
        describe(pdf, &objects, subset_name, &face);
        pdf.stream(objects.characters, &packed(&self.characters())?)
            .filter(Filter::FlateDecode);
        let length = i32::try_from(subset.len()).map_err(io::Error::other)?;
        pdf.stream(objects.file, &packed(&subset)?)
            .filter(Filter::FlateDecode)
            .pair(Name(b"Length1"), length);
        Ok(objects.font)
    }

    /// Returns the map from letter numbers to characters, for searching and copying.
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

/// Writes a font's descriptor, which contains its metrics.
fn describe(pdf: &mut Pdf, objects: &FontObjects, name: Name<'_>, face: &FontRef<'_>) {
    let metrics = face.metrics(Size::new(UNITS as f32), LocationRef::default());
    let bounds = metrics.bounds.unwrap_or_default();
    pdf.font_descriptor(objects.descriptor)
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
        // The format requires this value; readers ignore it for an embedded font.
        .stem_v(80.0)
        .font_file2(objects.file);
}

/// Compresses bytes in zlib format.
fn packed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}
