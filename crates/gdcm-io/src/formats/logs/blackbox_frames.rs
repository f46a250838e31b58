//! Encoding and prediction of the fields in blackbox frames.
//!
//! Each field has a numbered encoding and a numbered predictor
//! (<https://betaflight.com/docs/development/Blackbox-Internals>). The file holds the differences
//! from the predictions.

/// Maximum number of fields in a frame.
const MOST_FIELDS: usize = 256;

/// Descriptions of the fields in all frames with the same letter.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameFields {
    pub(super) names: Vec<String>,
    pub(super) signed: Vec<bool>,
    pub(super) predictors: Vec<u8>,
    pub(super) encodings: Vec<u8>,
}

/// Header values used by the predictors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeaderNumbers {
    pub(super) least_throttle: i64,
    pub(super) least_motor: i64,
    pub(super) battery: i64,
}

/// The two frames that precede a predicted frame.
#[derive(Default)]
pub(super) struct Predecessors {
    pub(super) last: Option<Vec<i64>>,
    /// The frame before the last; `None` if the last is an intra frame.
    pub(super) earlier: Option<Vec<i64>>,
}

/// Cursor over bytes that hold packed integers.
pub(super) struct PackedBytes<'b> {
    bytes: &'b [u8],
    pub(super) at: usize,
}

impl<'b> PackedBytes<'b> {
    pub(super) fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at).copied()?;
        self.at += 1;
        Some(byte)
    }

    /// Reads a variable-length integer: seven bits per byte, lowest first; the eighth bit is set if
    /// another byte follows. Returns `None` if the bytes end early or the integer exceeds five
    /// bytes.
    pub(super) fn unsigned(&mut self) -> Option<u32> {
        let mut value = 0_u32;
        for shift in (0..32).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// Reads a variable-length integer with the sign in the lowest bit.
    pub(super) fn signed(&mut self) -> Option<i32> {
        let value = self.unsigned()?;
        Some((value >> 1).cast_signed() ^ -((value & 1).cast_signed()))
    }

    /// Reads a signed 14-bit integer, which is stored with the opposite sign.
    fn negative_14(&mut self) -> Option<i32> {
        Some(-extended(self.unsigned()? & 0x3fff, 14))
    }

    /// Reads three signed integers of 2, 4 or 6 bits each, or of individual lengths from 1 to 4
    /// bytes.
    fn three(&mut self) -> Option<[i32; 3]> {
        let lead = self.byte()?;
        Some(match lead >> 6 {
            0 => [lead >> 4, lead >> 2, lead].map(|bits| extended(u32::from(bits & 3), 2)),
            1 => {
                let next = self.byte()?;
                [lead & 15, next >> 4, next & 15].map(|bits| extended(u32::from(bits), 4))
            }
            2 => [lead, self.byte()?, self.byte()?].map(|bits| extended(u32::from(bits & 63), 6)),
            _ => {
                let mut values = [0; 3];
                for (index, value) in values.iter_mut().enumerate() {
                    let bytes = 1 + u32::from((lead >> (2 * index)) & 3);
                    let mut bits = 0_u32;
                    for byte in 0..bytes {
                        bits |= u32::from(self.byte()?) << (8 * byte);
                    }
                    *value = extended(bits, 8 * bytes);
                }
                values
            }
        })
    }

    /// Reads four signed integers of 0, 4, 8 or 16 bits each, packed without gaps, the higher half
    /// of each byte first.
    fn four(&mut self) -> Option<[i32; 4]> {
        let tags = self.byte()?;
        let mut half = None;
        let mut values = [0; 4];
        for (index, value) in values.iter_mut().enumerate() {
            let halves = [0, 1, 2, 4][usize::from((tags >> (2 * index)) & 3)];
            let mut bits = 0_u32;
            for _ in 0..halves {
                let next = match half.take() {
                    Some(next) => next,
                    None => {
                        let byte = self.byte()?;
                        half = Some(byte & 15);
                        byte >> 4
                    }
                };
                bits = bits << 4 | u32::from(next);
            }
            *value = if halves == 0 {
                0
            } else {
                extended(bits, 4 * halves)
            };
        }
        Some(values)
    }
}

/// Sign-extends a number with `count` bits.
fn extended(bits: u32, count: u32) -> i32 {
    let unused = 32 - count;
    (bits << unused).cast_signed() >> unused
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

    /// Reads the stored differences of a frame; returns `None` if they are damaged.
    pub(super) fn differences(&self, bytes: &mut PackedBytes<'_>) -> Option<Vec<i64>> {
        let count = self.names.len();
        let mut values: Vec<i64> = Vec::with_capacity(count);
        while values.len() < count {
            let from = values.len();
            match self.encodings[from] {
                0 => values.push(i64::from(bytes.signed()?)),
                1 => values.push(i64::from(bytes.unsigned()?)),
                3 => values.push(i64::from(bytes.negative_14()?)),
                6 => self.read_tagged(bytes, &mut values)?,
                7 => values.extend(bytes.three()?.map(i64::from)),
                8 => values.extend(bytes.four()?.map(i64::from)),
                _ => values.push(0),
            }
        }
        values.truncate(count);
        Some(values)
    }

    /// Reads up to eight consecutive fields with encoding 6. They share a leading byte in which
    /// each bit marks a nonzero field; a single field has no such byte.
    fn read_tagged(&self, bytes: &mut PackedBytes<'_>, values: &mut Vec<i64>) -> Option<()> {
        let mut count = 0;
        for encoding in self.encodings[values.len()..].iter().take(8) {
            if *encoding != 6 {
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

    /// Computes the field values of a frame; `values` are its stored differences.
    pub(super) fn values(
        &self,
        mut values: Vec<i64>,
        before: &Predecessors,
        header: HeaderNumbers,
    ) -> Vec<i64> {
        let motor = self.names.iter().position(|name| name == "motor[0]");
        for field in 0..values.len() {
            let last = field_of(&before.last, field).unwrap_or(0);
            let earlier = field_of(&before.earlier, field).unwrap_or(last);
            let predicted = match self.predictors[field] {
                1 => last,
                2 => 2 * last - earlier,
                3 => (last + earlier) / 2,
                4 => header.least_throttle,
                5 => motor
                    .and_then(|motor| values.get(motor))
                    .copied()
                    .unwrap_or(0),
                6 => last + 1,
                8 => 1500,
                9 => header.battery,
                11 => header.least_motor,
                _ => 0,
            };
            // 32-bit arithmetic, as in the logger.
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

/// Returns whether this program can decode an encoding.
fn is_known(encoding: u8) -> bool {
    matches!(encoding, 0 | 1 | 3 | 6 | 7 | 8 | 9)
}

/// Returns the value of a field; `None` if the frame or the field is missing.
fn field_of(frame: &Option<Vec<i64>>, field: usize) -> Option<i64> {
    frame.as_ref()?.get(field).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_numbers_agree_with_the_format_description() {
        assert_eq!(PackedBytes::new(&[0xff, 0x01], 0).unsigned(), Some(255));
        assert_eq!(
            PackedBytes::new(&[0x80; 6], 0).unsigned(),
            None,
            "it does not end"
        );
        assert_eq!(
            [0, 1, 2, 3].map(|byte| PackedBytes::new(&[byte], 0).signed()),
            [0, -1, 1, -2].map(Some)
        );
        assert_eq!(
            PackedBytes::new(&[0xff, 0x3f], 0).negative_14(),
            Some(-0x1fff)
        );
        assert_eq!(
            PackedBytes::new(&[0b0001_1011], 0).three(),
            Some([1, -2, -1])
        );
        assert_eq!(
            PackedBytes::new(&[0b0100_0111, 0x9f], 0).three(),
            Some([7, -7, -1])
        );
        assert_eq!(
            PackedBytes::new(&[0b1100_0001, 0x34, 0x12, 0xff, 0x05], 0).three(),
            Some([0x1234, -1, 5])
        );
        // Lengths 4, 8, 0 and 16 bits: the values 1, -2, 0 and 0x1234.
        assert_eq!(
            PackedBytes::new(&[0b1100_1001, 0x1f, 0xe1, 0x23, 0x40], 0).four(),
            Some([1, -2, 0, 0x1234])
        );
        assert_eq!(PackedBytes::new(&[0b1100_1001, 0x1f], 0).four(), None);
    }

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
