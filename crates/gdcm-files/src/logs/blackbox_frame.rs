//! Frames of a blackbox: how the numbers in them are packed, and what they are told from.
//!
//! Each field has an encoding and a predictor, by number (<https://betaflight.com/docs/development/Blackbox-Internals>). What stands in
//! the file is the difference to the prediction.

/// Most fields of a frame.
pub(super) const MOST_FIELDS: usize = 256;

/// The fields of one kind of frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameFields {
    pub(super) names: Vec<String>,
    pub(super) signed: Vec<bool>,
    pub(super) predictors: Vec<u8>,
    pub(super) encodings: Vec<u8>,
}

/// Numbers of the heading that predictions take.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub(super) least_throttle: i64,
    pub(super) least_motor: i64,
    pub(super) battery: i64,
}

/// Bytes that are read one after another.
pub(super) struct Bits<'b> {
    bytes: &'b [u8],
    pub(super) at: usize,
}

impl<'b> Bits<'b> {
    pub(super) fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at).copied()?;
        self.at += 1;
        Some(byte)
    }

    /// Seven bits a byte, the lowest first; the eighth says that more come.
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

    /// The same, with the sign in the lowest bit.
    pub(super) fn signed(&mut self) -> Option<i32> {
        let value = self.unsigned()?;
        Some((value >> 1).cast_signed() ^ -((value & 1).cast_signed()))
    }

    /// The negative of 14 bits with a sign.
    fn negative_14(&mut self) -> Option<i32> {
        Some(-extended(self.unsigned()? & 0x3fff, 14))
    }

    /// Three numbers of 2, 4 or 6 bits, or of 1 to 4 bytes each.
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

    /// Four numbers of no, 4, 8 or 16 bits, half a byte after another, the highest first.
    fn four(&mut self) -> Option<[i32; 4]> {
        let tags = self.byte()?;
        let (mut half, mut values) = (None, [0; 4]);
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
            *value = if halves == 0 { 0 } else { extended(bits, 4 * halves) };
        }
        Some(values)
    }
}

/// A number of so many bits with a sign.
fn extended(bits: u32, count: u32) -> i32 {
    let unused = 32 - count;
    (bits << unused).cast_signed() >> unused
}

impl FrameFields {
    /// Whether there is an encoding and a predictor that are known for each name.
    pub(super) fn is_whole(&self) -> bool {
        let count = self.names.len();
        let known = |encoding: &u8| matches!(encoding, 0 | 1 | 3 | 6 | 7 | 8 | 9);
        (1..=MOST_FIELDS).contains(&count)
            && [self.signed.len(), self.predictors.len(), self.encodings.len()] == [count; 3]
            && self.encodings.iter().all(known)
    }

    /// The numbers of a frame, as they stand; none where they are damaged.
    pub(super) fn differences(&self, bits: &mut Bits<'_>) -> Option<Vec<i64>> {
        let mut values: Vec<i64> = Vec::with_capacity(self.names.len());
        while values.len() < self.names.len() {
            let from = values.len();
            let encoding = self.encodings[from];
            match encoding {
                0 => values.push(i64::from(bits.signed()?)),
                1 => values.push(i64::from(bits.unsigned()?)),
                3 => values.push(i64::from(bits.negative_14()?)),
                6 => {
                    // As many as follow one another, up to eight; a bit for each says whether it is more than 0.
                    let count = self.encodings[from..].iter().take(8).take_while(|other| **other == encoding).count();
                    let tags = if count == 1 { 1 } else { bits.byte()? };
                    for index in 0..count {
                        values.push(if tags >> index & 1 == 1 { i64::from(bits.signed()?) } else { 0 });
                    }
                }
                7 => values.extend(bits.three()?.map(i64::from)),
                8 => values.extend(bits.four()?.map(i64::from)),
                _ => values.push(0),
            }
        }
        values.truncate(self.names.len());
        Some(values)
    }

    /// The numbers of a frame by their predictions from the frame before and the one before that.
    pub(super) fn values(&self, mut values: Vec<i64>, before: [Option<&Vec<i64>>; 2], known: Known) -> Vec<i64> {
        let motor = self.names.iter().position(|name| name == "motor[0]");
        for at in 0..values.len() {
            let last = before[0].and_then(|frame| frame.get(at)).copied().unwrap_or(0);
            let earlier = before[1].and_then(|frame| frame.get(at)).copied().unwrap_or(last);
            let predicted = match self.predictors[at] {
                1 => last,
                2 => 2 * last - earlier,
                3 => (last + earlier) / 2,
                4 => known.least_throttle,
                5 => motor.and_then(|motor| values.get(motor)).copied().unwrap_or(0),
                6 => last + 1,
                8 => 1500,
                9 => known.battery,
                11 => known.least_motor,
                _ => 0,
            };
            // As the logger reckons, in 32 bits.
            let low = values[at].wrapping_add(predicted) as u32;
            values[at] = if self.signed[at] { i64::from(low.cast_signed()) } else { i64::from(low) };
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_numbers_are_those_of_the_format_s_description() {
        assert_eq!(Bits::new(&[0xff, 0x01], 0).unsigned(), Some(255));
        assert_eq!(Bits::new(&[0x80; 6], 0).unsigned(), None, "it does not end");
        assert_eq!([0, 1, 2, 3].map(|byte| Bits::new(&[byte], 0).signed()), [0, -1, 1, -2].map(Some));
        assert_eq!(Bits::new(&[0xff, 0x3f], 0).negative_14(), Some(-0x1fff));
        assert_eq!(Bits::new(&[0b0001_1011], 0).three(), Some([1, -2, -1]));
        assert_eq!(Bits::new(&[0b0100_0111, 0x9f], 0).three(), Some([7, -7, -1]));
        assert_eq!(Bits::new(&[0b1100_0001, 0x34, 0x12, 0xff, 0x05], 0).three(), Some([0x1234, -1, 5]));
        // 4 bits, 8 bits, none, 16 bits: 1, -2, 0, 0x1234.
        assert_eq!(Bits::new(&[0b1100_1001, 0x1f, 0xe1, 0x23, 0x40], 0).four(), Some([1, -2, 0, 0x1234]));
        assert_eq!(Bits::new(&[0b1100_1001, 0x1f], 0).four(), None);
    }

    #[test]
    fn predictions_take_the_frames_before() {
        let fields = FrameFields {
            names: ["time", "a", "b", "motor[0]", "motor[1]"].map(str::to_owned).to_vec(),
            signed: vec![false, true, true, false, false],
            predictors: vec![2, 1, 3, 11, 5],
            encodings: vec![0; 5],
        };
        assert!(fields.is_whole());
        let known = Known { least_motor: 158, ..Known::default() };
        let (last, earlier) = (vec![200, -5, 8, 0, 0], vec![100, 0, 4, 0, 0]);
        let values = fields.values(vec![1, 1, 1, 2, 3], [Some(&last), Some(&earlier)], known);
        assert_eq!(values, [301, -4, 7, 160, 163]);
    }
}
