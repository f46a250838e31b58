//! Message layouts in binary and text DataFlash logs: fields, data types, units and multipliers.
//!
//! A log describes its own messages: [`MessageLayout::parse`] builds a message type's layout, and
//! [`Layouts::set_units`] then adds its unit and multiplier letters, whose meanings are in
//! [`Layouts::units`] and [`Layouts::multipliers`].

use std::collections::BTreeMap;

use crate::formats::stored_number::{NumberClass, StoredNumber};

/// Message field's data type, given by a format letter
/// (<https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html>).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FieldKind {
    /// Number that is stored divided by `factor`.
    Number { stored: StoredNumber, factor: f64 },
    /// Field that is not a number, with its length \[bytes\].
    Other(usize),
}

impl FieldKind {
    /// Returns the kind for a format letter; `None` for an unknown letter.
    fn from_letter(letter: char) -> Option<Self> {
        use NumberClass::{Float, Signed, Unsigned};
        let (class, size, factor) = match letter {
            'b' => (Signed, 1, 1.0),
            'B' | 'M' => (Unsigned, 1, 1.0),
            'h' => (Signed, 2, 1.0),
            'H' => (Unsigned, 2, 1.0),
            'i' => (Signed, 4, 1.0),
            'I' => (Unsigned, 4, 1.0),
            'q' => (Signed, 8, 1.0),
            'Q' => (Unsigned, 8, 1.0),
            'f' => (Float, 4, 1.0),
            'd' => (Float, 8, 1.0),
            'c' => (Signed, 2, 0.01),
            'C' => (Unsigned, 2, 0.01),
            'e' => (Signed, 4, 0.01),
            'E' => (Unsigned, 4, 0.01),
            'L' => (Signed, 4, 1e-7),
            'n' => return Some(Self::Other(4)),
            'N' => return Some(Self::Other(16)),
            'Z' | 'a' => return Some(Self::Other(64)),
            _ => return None,
        };
        Some(Self::Number {
            stored: StoredNumber::little_endian(class, size),
            factor,
        })
    }

    /// Returns the field length \[bytes\].
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number { stored, .. } => stored.size(),
            Self::Other(size) => size,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct MessageField {
    pub(super) name: String,
    pub(super) kind: FieldKind,
    /// Offset in the message content \[bytes\].
    pub(super) offset: usize,
}

impl MessageField {
    /// Returns the offset just after the field \[bytes\].
    pub(super) fn end(&self) -> usize {
        self.offset + self.kind.size()
    }
}

/// Layout shared by all messages of one type.
#[derive(Clone, Debug)]
pub(super) struct MessageLayout {
    pub(super) name: String,
    pub(super) fields: Vec<MessageField>,
    /// Unit letters by field.
    pub(super) units: Vec<char>,
    /// Multiplier letters by field.
    multipliers: Vec<char>,
}

impl MessageLayout {
    /// Builds a layout from format letters and comma-separated field names; returns `None` for an
    /// unknown letter, an empty message name, or more names than letters.
    pub(super) fn parse(name: &str, letters: &str, names: &str) -> Option<Self> {
        let mut offset = 0;
        let mut fields = Vec::new();
        for (letter, field) in letters.chars().zip(names.split(',')) {
            let kind = FieldKind::from_letter(letter)?;
            fields.push(MessageField {
                name: field.trim().to_owned(),
                kind,
                offset,
            });
            offset += kind.size();
        }
        if name.is_empty() || names.split(',').count() > letters.chars().count() {
            return None;
        }
        Some(Self {
            name: name.to_owned(),
            fields,
            units: Vec::new(),
            multipliers: Vec::new(),
        })
    }

    pub(super) fn field(&self, name: &str) -> Option<&MessageField> {
        self.fields.iter().find(|field| field.name == name)
    }

    pub(super) fn index_of(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }
}

/// Message layouts by type, with the meanings of the unit and multiplier letters.
#[derive(Default)]
pub(super) struct Layouts {
    pub(super) by_type: BTreeMap<u8, MessageLayout>,
    pub(super) units: BTreeMap<char, String>,
    pub(super) multipliers: BTreeMap<char, f64>,
}

impl Layouts {
    /// Sets a message type's unit and multiplier letters; ignores an unknown type.
    pub(super) fn set_units(&mut self, kind: u8, units: &str, multipliers: &str) {
        if let Some(layout) = self.by_type.get_mut(&kind) {
            layout.units = units.chars().collect();
            layout.multipliers = multipliers.chars().collect();
        }
    }

    /// Returns a field's unit as this program writes it; `None` if the field has no known unit.
    pub(super) fn unit(&self, layout: &MessageLayout, field: usize) -> Option<String> {
        let unit = self.units.get(layout.units.get(field)?)?;
        match unit.as_str() {
            "m/s/s" => Some("m/s^2".to_owned()),
            "degheading" => Some("deg".to_owned()),
            "" | "UNKNOWN" | "instance" | "-" => None,
            other => Some(other.to_owned()),
        }
    }

    /// Returns a field's multiplier; 1 if it is missing, not finite, or 0.
    pub(super) fn multiplier(&self, layout: &MessageLayout, field: usize) -> f64 {
        let letter = layout.multipliers.get(field);
        match letter.and_then(|letter| self.multipliers.get(letter)) {
            Some(multiplier) if *multiplier != 0.0 && multiplier.is_finite() => *multiplier,
            _ => 1.0,
        }
    }
}
