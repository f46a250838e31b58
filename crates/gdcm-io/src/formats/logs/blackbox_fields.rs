//! Encoding and prediction of the fields in blackbox frames. Intra and predicted frames are main
//! frames, each a sample of all fields (`blackbox.rs`).
//!
//! A frame stores how each field differs from a prediction. Decoding has two steps, and the
//! flight's header gives each field a number for each step: the encoding says how the difference is
//! packed into bytes (`FrameFields::differences`), the predictor what it is added to
//! (`FrameFields::values`).
//!
//! Source: <https://betaflight.com/docs/development/Blackbox-Internals>.

use crate::formats::logs::blackbox_integers::PackedBytes;

/// Maximum number of fields in a frame.
const MOST_FIELDS: usize = 256;

/// Numbers of the supported encodings.
mod encoding {
    /// Variable-length integer with the sign in the lowest bit.
    pub(super) const SIGNED_VB: u8 = 0;
    /// Variable-length integer without a sign.
    pub(super) const UNSIGNED_VB: u8 = 1;
    /// Variable-length integer whose lower 14 bits hold the number with the opposite sign.
    pub(super) const NEG_14BIT: u8 = 3;
    /// Up to eight fields: a byte that marks the nonzero fields, then these; a single field has no
    /// such byte.
    pub(super) const TAG8_8SVB: u8 = 6;
    /// Three fields after a two-bit tag, which gives their common length, or says that the next six
    /// bits give a length for each.
    pub(super) const TAG2_3S32: u8 = 7;
    /// Four fields: a byte with two bits for each length, then the fields.
    pub(super) const TAG8_4S16: u8 = 8;
    /// No bytes; the difference is 0.
    pub(super) const NULL: u8 = 9;
}

/// Numbers of the predictors; all other numbers, such as 0, predict 0.
mod predictor {
    /// Value in the preceding frame.
    pub(super) const PREVIOUS: u8 = 1;
    /// Extrapolation along the line through the two preceding frames.
    pub(super) const STRAIGHT_LINE: u8 = 2;
    /// Mean of the two preceding frames.
    pub(super) const AVERAGE_2: u8 = 3;
    /// Header value `minthrottle`.
    pub(super) const MIN_THROTTLE: u8 = 4;
    /// Field `motor[0]` in the same frame.
    pub(super) const MOTOR_0: u8 = 5;
    /// Value in the preceding frame plus 1.
    pub(super) const INCREMENT: u8 = 6;
    pub(super) const FIXED_1500: u8 = 8;
    /// Header value `vbatref`.
    pub(super) const VBATREF: u8 = 9;
    /// First number in the header value `motorOutput`.
    pub(super) const MIN_MOTOR: u8 = 11;
}

/// Field descriptions for all frames with the same letter; each list has an entry for each field.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameFields {
    pub(super) names: Vec<String>,
    /// Whether the values are signed 32-bit integers, otherwise unsigned.
    pub(super) signed: Vec<bool>,
    /// Numbers in `predictor`.
    pub(super) predictors: Vec<u8>,
    /// Numbers in `encoding`.
    pub(super) encodings: Vec<u8>,
}

/// Header values used by the predictors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeaderNumbers {
    pub(super) least_throttle: i64,
    pub(super) least_motor: i64,
    pub(super) battery: i64,
}

/// The main frames that precede a frame; there are none at the beginning of a flight and after a
/// damaged frame.
#[derive(Default)]
pub(super) struct Predecessors {
    pub(super) last: Option<Vec<i64>>,
    /// The frame before the last; `None` if the last is an intra frame or missing.
    pub(super) earlier: Option<Vec<i64>>,
}

impl FrameFields {
    /// Returns whether the fields can be decoded: there are between 1 and `MOST_FIELDS` names, each
    /// with a sign, a predictor and a supported encoding.
    pub(super) fn is_whole(&self) -> bool {
        let count = self.names.len();
        (1..=MOST_FIELDS).contains(&count)
            && self.signed.len() == count
            && self.predictors.len() == count
            && self.encodings.len() == count
            && self.encodings.iter().all(|encoding| is_known(*encoding))
    }

    /// Reads a frame's differences from its bytes; returns `None` if the bytes are damaged.
    pub(super) fn differences(&self, bytes: &mut PackedBytes<'_>) -> Option<Vec<i64>> {
        let count = self.names.len();
        let mut values: Vec<i64> = Vec::with_capacity(count);
        while values.len() < count {
            let field = values.len();
            match self.encodings[field] {
                encoding::SIGNED_VB => values.push(i64::from(bytes.signed()?)),
                encoding::UNSIGNED_VB => values.push(i64::from(bytes.unsigned()?)),
                encoding::NEG_14BIT => values.push(i64::from(bytes.neg_14bit()?)),
                encoding::TAG8_8SVB => self.read_tag8_8svb(bytes, &mut values)?,
                encoding::TAG2_3S32 => values.extend(bytes.tag2_3s32()?.map(i64::from)),
                encoding::TAG8_4S16 => values.extend(bytes.tag8_4s16()?.map(i64::from)),
                // Only `encoding::NULL` remains, because `is_whole` rejects unknown encodings.
                _ => values.push(0),
            }
        }
        // A group of three or four may reach beyond the last field.
        values.truncate(count);
        Some(values)
    }

    /// Reads up to eight consecutive fields with the encoding `TAG8_8SVB`. They share a leading
    /// byte in which each bit marks a nonzero field; a single field has no such byte.
    fn read_tag8_8svb(&self, bytes: &mut PackedBytes<'_>, values: &mut Vec<i64>) -> Option<()> {
        let mut count = 0;
        for number in self.encodings[values.len()..].iter().take(8) {
            if *number != encoding::TAG8_8SVB {
                break;
            }
            count += 1;
        }
        let tags = if count == 1 { 1 } else { bytes.byte()? };
        for index in 0..count {
            let is_nonzero = tags >> index & 1 == 1;
            values.push(if is_nonzero {
                i64::from(bytes.signed()?)
            } else {
                0
            });
        }
        Some(())
    }

    /// Computes a frame's field values by adding its predictions to its differences.
    ///
    /// A missing predecessor counts as 0, and a missing earlier frame as equal to the last.
    pub(super) fn values(
        &self,
        differences: Vec<i64>,
        before: &Predecessors,
        header: HeaderNumbers,
    ) -> Vec<i64> {
        // The differences are replaced by the values in field order.
        let mut values = differences;
        let motor = self.names.iter().position(|name| name == "motor[0]");
        for field in 0..values.len() {
            let last = field_of(&before.last, field).unwrap_or(0);
            let earlier = field_of(&before.earlier, field).unwrap_or(last);
            let predicted = match self.predictors[field] {
                predictor::PREVIOUS => last,
                predictor::STRAIGHT_LINE => 2 * last - earlier,
                predictor::AVERAGE_2 => (last + earlier) / 2,
                predictor::MIN_THROTTLE => header.least_throttle,
                predictor::MOTOR_0 => motor
                    .and_then(|motor| values.get(motor))
                    .copied()
                    .unwrap_or(0),
                predictor::INCREMENT => last + 1,
                predictor::FIXED_1500 => 1500,
                predictor::VBATREF => header.battery,
                predictor::MIN_MOTOR => header.least_motor,
                _ => 0,
            };
            // Keep the lower 32 bits, as the logger's arithmetic does.
            let low = values[field].wrapping_add(predicted) as u32;
            values[field] = if self.signed[field] {
                i64::from(low.cast_signed())
            } else {
                i64::from(low)
            };
        }
        values
    }
}

/// Returns whether this program can decode the encoding with this number.
fn is_known(number: u8) -> bool {
    matches!(
        number,
        encoding::SIGNED_VB
            | encoding::UNSIGNED_VB
            | encoding::NEG_14BIT
            | encoding::TAG8_8SVB
            | encoding::TAG2_3S32
            | encoding::TAG8_4S16
            | encoding::NULL
    )
}

/// Returns a field's value; `None` if the frame or the field is missing.
fn field_of(frame: &Option<Vec<i64>>, field: usize) -> Option<i64> {
    frame.as_ref()?.get(field).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn predictions_use_the_frames_before() {
        let fields = FrameFields {
            names: ["time", "a", "b", "motor[0]", "motor[1]"]
                .map(str::to_owned)
                .to_vec(),
            signed: vec![false, true, true, false, false],
            predictors: vec![2, 1, 3, 11, 5],
            encodings: vec![0; 5],
        };
        assert!(fields.is_whole());
        let header = HeaderNumbers {
            least_motor: 158,
            ..HeaderNumbers::default()
        };
        let before = Predecessors {
            last: Some(vec![200, -5, 8, 0, 0]),
            earlier: Some(vec![100, 0, 4, 0, 0]),
        };
        let values = fields.values(vec![1, 1, 1, 2, 3], &before, header);
        assert_eq!(values, [301, -4, 7, 160, 163]);
    }
}
