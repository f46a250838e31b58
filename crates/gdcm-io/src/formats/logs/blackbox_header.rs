//! Blackbox flight header: lines `H key:value`, among them the fields in each kind of frame:
//!
//! ```text
//! H Field I name:time,motor[0]  names of the fields in frames with the letter I
//! H Field I signed:0,1          1 for a signed integer
//! H Field I predictor:0,0       number of each field's predictor (blackbox_fields.rs)
//! H Field I encoding:1,0        number of each field's encoding (blackbox_fields.rs)
//! ```

use std::collections::BTreeMap;

use crate::formats::logs::blackbox_fields::{FrameFields, HeaderNumbers};

/// Content of the header lines before the frames.
#[derive(Default)]
pub(super) struct Header {
    /// Header values by key.
    lines: BTreeMap<String, String>,
    /// Field descriptions by frame letter.
    fields_by_letter: BTreeMap<u8, FrameFields>,
    pub(super) numbers: HeaderNumbers,
    /// Header length \[bytes\].
    pub(super) length: usize,
}

impl Header {
    /// Reads a flight's header, with which `bytes` begin.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let mut header = Self::default();
        header.read_lines(bytes);
        // Intra, predicted, slow, GPS and GPS home frames.
        for kind in *b"IPSGH" {
            let fields = header.parse_fields(char::from(kind));
            header.fields_by_letter.insert(kind, fields);
        }
        // For the main frames, the header gives names and signs under I only; P has the same
        // fields.
        let intra = header.fields_by_letter[&b'I'].clone();
        if let Some(predicted) = header.fields_by_letter.get_mut(&b'P') {
            predicted.names = intra.names;
            predicted.signed = intra.signed;
        }
        header.numbers = HeaderNumbers {
            least_throttle: header.number("minthrottle"),
            least_motor: header.number("motorOutput"),
            battery: header.number("vbatref"),
        };
        header
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

    /// Returns the header value for a key; empty if the key is missing.
    pub(super) fn value(&self, key: &str) -> &str {
        self.lines.get(key).map_or("", String::as_str)
    }

    /// Returns the first number in the header value for a key; 0 if there is none.
    fn number(&self, key: &str) -> i64 {
        let first = self.value(key).split(',').next().unwrap_or_default();
        first.parse().unwrap_or(0)
    }

    /// Parses the field descriptions for frames with the letter `kind`; a list without a header
    /// line is empty.
    fn parse_fields(&self, kind: char) -> FrameFields {
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

    /// Returns the nonempty cells in a header line such as "Field I name".
    fn field_cells(&self, kind: char, property: &str) -> impl Iterator<Item = &str> {
        self.value(&format!("Field {kind} {property}"))
            .split(',')
            .filter(|cell| !cell.is_empty())
    }

    /// Returns the numbers in a header line such as "Field I signed"; a cell that is not a number
    /// becomes 255, which denotes no encoding.
    fn field_numbers(&self, kind: char, property: &str) -> Vec<u8> {
        self.field_cells(kind, property)
            .map(|cell| cell.parse().unwrap_or(u8::MAX))
            .collect()
    }

    /// Returns the field names in main frames, intra and predicted.
    pub(super) fn main_fields(&self) -> &[String] {
        &self.fields_by_letter[&b'I'].names
    }

    /// Returns the fields in frames with the letter `kind`; `None` if they are not described
    /// completely, or if one has an unsupported encoding.
    pub(super) fn frame_fields(&self, kind: u8) -> Option<&FrameFields> {
        let fields = self.fields_by_letter.get(&kind)?;
        if fields.is_whole() {
            Some(fields)
        } else {
            None
        }
    }
}
