//! The fonts of a PDF: cut down to the letters used, with the characters that they stand for, so that text can be found and copied.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};
use subsetter::GlyphRemapper;

use crate::figure::{FONTS, Letter};

/// Units of a PDF's letters in their size.
const UNITS: f64 = 1000.0;
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The letters of each font that have been used, numbered in the order in which they came.
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
    /// The number of a letter in its font.
    pub(super) fn code(&mut self, letter: &Letter) -> u16 {
        let Used { numbers, letters } = &mut self.fonts[letter.font];
        let is_new = numbers.get(letter.glyph).is_none();
        let code = numbers.remap(letter.glyph);
        if is_new {
            letters.push(*letter);
        }
        code
    }

    /// Writes the fonts that were used as objects from `first` on; gives the name and the object of each.
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
    fn write(&self, pdf: &mut Pdf, (name, bytes): (&str, &[u8]), next: &mut Ref) -> io::Result<Ref> {
        let [font, descendant, descriptor, characters, file] = std::array::from_fn(|_| next.bump());
        let subset = subsetter::subset(bytes, 0, &self.numbers).map_err(io::Error::other)?;
        let face = FontRef::new(bytes).map_err(io::Error::other)?;
        // Readers take six letters and a plus for the name of a part of a font.
        let part = format!("GDCMFG+{name}");
        let part = Name(part.as_bytes());
        pdf.type0_font(font)
            .base_font(part)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(descendant)
            .to_unicode(characters);
        let mut cid_font = pdf.cid_font(descendant);
        cid_font.subtype(CidFontType::Type2).base_font(part).system_info(IDENTITY).font_descriptor(descriptor);
        cid_font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let advances = self.letters.iter().map(|letter| (UNITS * letter.advance) as f32);
        cid_font.widths().consecutive(1, advances).finish();
        cid_font.finish();
        self.describe(pdf, (descriptor, file), part, &face);
        pdf.stream(characters, &packed(&self.characters())?).filter(Filter::FlateDecode);
        let length = i32::try_from(subset.len()).map_err(io::Error::other)?;
        pdf.stream(file, &packed(&subset)?).filter(Filter::FlateDecode).pair(Name(b"Length1"), length);
        Ok(font)
    }

    fn describe(&self, pdf: &mut Pdf, (descriptor, file): (Ref, Ref), name: Name<'_>, face: &FontRef<'_>) {
        let metrics = face.metrics(Size::new(UNITS as f32), LocationRef::default());
        let bounds = metrics.bounds.unwrap_or_default();
        pdf.font_descriptor(descriptor)
            .name(name)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max))
            .italic_angle(metrics.italic_angle)
            .ascent(metrics.ascent)
            .descent(metrics.descent)
            .cap_height(metrics.cap_height.unwrap_or(metrics.ascent))
            // No reader uses it of a font that is in the file.
            .stem_v(80.0)
            .font_file2(file);
    }

    /// The character that each letter stands for.
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

/// Bytes packed as PDF takes them.
pub(super) fn packed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}
