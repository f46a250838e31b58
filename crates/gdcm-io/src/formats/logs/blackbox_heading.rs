//! Header of a blackbox flight: lines `H key:value`.

use std::collections::BTreeMap;

use crate::formats::logs::blackbox_fields::{FrameFields, HeaderNumbers};

/// Contents of the header lines before the frames.
#[derive(Default)]
pub(super) struct Heading {
    /// Header values by key.
    lines: BTreeMap<String, String>,
    /// Field descriptions by frame letter.
    frames: BTreeMap<u8, FrameFields>,
    pub(super) numbers: HeaderNumbers,
    /// Header length \[bytes\].
    pub(super) length: usize,
}

impl Heading {
    /// Reads the header of a flight, with which `bytes` begin.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let mut heading = Self::default();
        heading.read_lines(bytes);
        for kind in *b"IPSGH" {
            let fields = heading.fields(char::from(kind));
            heading.frames.insert(kind, fields);
        }
        // The header gives names and signs only for intra frames; predicted frames have the same
        // fields.
        let intra = heading.frames[&b'I'].clone();
        if let Some(predicted) = heading.frames.get_mut(&b'P') {
            predicted.names = intra.names;
            predicted.signed = intra.signed;
        }
        heading.numbers = HeaderNumbers {
            least_throttle: heading.number("minthrottle"),
            least_motor: heading.number("motorOutput"),
            battery: heading.number("vbatref"),
        };
        heading
    }

    /// Reads the lines `H key:value` up to the first frame.
    fn read_lines(&mut self, bytes: &[u8]) {
        while bytes[self.length..].starts_with(b"H ") {
            let rest = &bytes[self.length..];
            let Some(end) = rest.iter().position(|byte| *byte == b'\n') else {
                break;
            };
            let line = String::from_utf8_lossy(&rest[2..end]);
            if let Some((key, value)) = line.split_once(':') {
                self.lines.insert(key.to_owned(), value.trim().to_owned());
            }
            self.length += end + 1;
        }
    }

    /// Returns the header value of a key; empty if the key is missing.
    pub(super) fn value(&self, key: &str) -> &str {
        self.lines.get(key).map_or("", String::as_str)
    }

    /// Returns the first number in the header value of a key; 0 if there is none.
    fn number(&self, key: &str) -> i64 {
        let first = self.value(key).split(',').next().unwrap_or_default();
        first.parse().unwrap_or(0)
    }

    /// Returns the descriptions of the fields in frames with the letter `kind`.
    fn fields(&self, kind: char) -> FrameFields {
        FrameFields {
            names: self.field_cells(kind, "name").map(str::to_owned).collect(),
            signed: self
                .field_numbers(kind, "signed")
                .iter()
                .map(|signed| *signed == 1)
                .collect(),
            predictors: self.field_numbers(kind, "predictor"),
            encodings: self.field_numbers(kind, "encoding"),
        }
    }

    /// Returns the cells of a header line such as "Field I name".
    fn field_cells(&self, kind: char, property: &str) -> impl Iterator<Item = &str> {
        self.value(&format!("Field {kind} {property}"))
            .split(',')
            .filter(|cell| !cell.is_empty())
    }

    /// Returns the numbers in a header line such as "Field I signed"; a cell that is not a number
    /// becomes 255.
    fn field_numbers(&self, kind: char, property: &str) -> Vec<u8> {
        self.field_cells(kind, property)
            .map(|cell| cell.parse().unwrap_or(u8::MAX))
            .collect()
    }

    /// Returns the names of the fields in the main frames, intra and predicted.
    pub(super) fn main_fields(&self) -> &[String] {
        &self.frames[&b'I'].names
    }

    /// Returns the fields of the frames with the letter `kind`; `None` if a field cannot be
    /// decoded.
    pub(super) fn frame(&self, kind: u8) -> Option<&FrameFields> {
        let fields = self.frames.get(&kind)?;
        if fields.is_whole() {
            Some(fields)
        } else {
            None
        }
    }
}
