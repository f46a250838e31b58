//! Frames of a blackbox flight: a letter, then fields or an event
//! (<https://betaflight.com/docs/development/Blackbox-Internals>).
//!
//! ```text
//! I, P      intra and predicted frame: the main fields
//! S         slow frame: flight mode and other states
//! G, H      GPS position, GPS home: not used
//! E         event: a type, on which the length depends
//! ```
//!
//! Intra and predicted frames are main frames: an intra frame is decoded by itself, a predicted
//! frame from the main frames before it.

use crate::formats::logs::blackbox_fields::Predecessors;
use crate::formats::logs::blackbox_header::Header;
use crate::formats::logs::blackbox_integers::PackedBytes;

/// Letters with which a frame can begin.
pub(super) const FRAME_LETTERS: &[u8] = b"IPSGHE";

pub(super) enum Frame {
    /// Values in an intra or predicted frame.
    Main(Vec<i64>),
    Slow(Vec<i64>),
    /// Frame whose contents are not used.
    Other,
    /// Event that ends the log.
    End,
}

/// Parses a frame with the letter `kind` from the bytes after this letter; `before` holds the main
/// frames that precede it. Returns `None` for an unknown letter or event type, a damaged frame, a
/// predicted frame without a predecessor, or a frame whose fields the header does not describe in a
/// supported form.
pub(super) fn parse_frame(
    header: &Header,
    kind: u8,
    bytes: &mut PackedBytes<'_>,
    before: &Predecessors,
) -> Option<Frame> {
    if kind == b'E' {
        return parse_event(bytes);
    }
    let fields = header.frame_fields(kind)?;
    if kind == b'P' && before.last.is_none() {
        return None;
    }
    let differences = fields.differences(bytes)?;
    let independent = Predecessors::default();
    Some(match kind {
        b'G' | b'H' => Frame::Other,
        b'S' => Frame::Slow(fields.values(differences, &independent, header.numbers)),
        b'P' => Frame::Main(fields.values(differences, before, header.numbers)),
        _ => Frame::Main(fields.values(differences, &independent, header.numbers)),
    })
}

/// Numbers of the event types.
mod event_type {
    pub(super) const SYNC_BEEP: u8 = 0;
    pub(super) const INFLIGHT_ADJUSTMENT: u8 = 13;
    pub(super) const LOGGING_RESUME: u8 = 14;
    pub(super) const DISARM: u8 = 15;
    pub(super) const FLIGHT_MODE: u8 = 30;
    pub(super) const IMU_FAILURE: u8 = 40;
    pub(super) const LOG_END: u8 = 255;
}

/// Parses an event frame, whose length depends on the event type. Event contents are not used.
fn parse_event(bytes: &mut PackedBytes<'_>) -> Option<Frame> {
    match bytes.byte()? {
        // One integer.
        event_type::SYNC_BEEP | event_type::DISARM | event_type::IMU_FAILURE => {
            bytes.unsigned()?;
        }
        // Two integers.
        event_type::LOGGING_RESUME | event_type::FLIGHT_MODE => {
            bytes.unsigned()?;
            bytes.unsigned()?;
        }
        // A byte for the adjusted function, then a four-byte float if this byte's highest bit is
        // set, otherwise a packed integer.
        event_type::INFLIGHT_ADJUSTMENT => {
            if bytes.byte()? & 0x80 == 0 {
                bytes.signed()?;
            } else {
                for _ in 0..4 {
                    bytes.byte()?;
                }
            }
        }
        event_type::LOG_END => {
            for letter in b"End of log" {
                if bytes.byte() != Some(*letter) {
                    return None;
                }
            }
            return Some(Frame::End);
        }
        _ => return None,
    }
    Some(Frame::Other)
}
