//! Elements of a file: what kind of data follows, how much, and the data.

/// What kind of data an element holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8 = 1,
    U8 = 2,
    U16 = 4,
    I32 = 5,
    U32 = 6,
    F64 = 9,
    I64 = 12,
    Matrix = 14,
    Packed = 15,
    Utf8 = 16,
}

/// Adds an element, filled up to eight bytes. Up to four bytes stand in the tag itself, as MATLAB insists on for some names.
pub(super) fn element(bytes: &mut Vec<u8>, kind: Kind, data: &[u8]) {
    // The writer refuses a variable whose length does not fit; the elements in it are shorter.
    let length = data.len() as u32;
    if (1..=4).contains(&length) && kind != Kind::Packed {
        bytes.extend((length << 16 | kind as u32).to_le_bytes());
        bytes.extend(data);
        bytes.resize(bytes.len() + 4 - data.len(), 0);
        return;
    }
    bytes.extend((kind as u32).to_le_bytes());
    bytes.extend(length.to_le_bytes());
    bytes.extend(data);
    if kind != Kind::Packed {
        bytes.resize(bytes.len().next_multiple_of(8), 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_data_stand_in_the_tag_and_long_ones_are_filled_up() {
        let mut bytes = Vec::new();
        element(&mut bytes, Kind::I8, b"abc");
        assert_eq!(bytes, [1, 0, 3, 0, b'a', b'b', b'c', 0]);
        element(&mut bytes, Kind::U8, &[7; 5]);
        assert_eq!(bytes[8..], [2, 0, 0, 0, 5, 0, 0, 0, 7, 7, 7, 7, 7, 0, 0, 0]);
    }
}
