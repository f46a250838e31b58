//! What a file is, by what it begins with.

use std::path::Path;

use crate::mat::is_hdf5;

/// The format of a file that may hold models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// MATLAB up to version 7.
    Mat,
    /// MATLAB 7.3, and HDF5.
    Hdf5,
    /// One array of NumPy.
    Npy,
    /// Several arrays of NumPy, or another zip archive.
    Npz,
    /// JSON, packed or not.
    Json,
    /// MATLAB's language.
    Literals,
    /// Numbers in columns, or a matrix.
    Text,
}

impl FileFormat {
    /// The format of bytes in a file of this name; the name decides only between texts.
    pub fn of(bytes: &[u8], path: &Path) -> Self {
        let extension =
            path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
        let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace()).copied();
        match bytes {
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Self::Npy,
            [b'P', b'K', 3 | 5, ..] => Self::Npz,
            [0x1f, 0x8b, ..] => Self::Json,
            _ if is_hdf5(bytes) => Self::Hdf5,
            _ if extension == "mat" => Self::Mat,
            _ if is_level_5(bytes) => Self::Mat,
            _ if extension == "json" || first == Some(b'{') => Self::Json,
            _ if extension == "m" => Self::Literals,
            _ => Self::Text,
        }
    }
}

/// The mark of the byte order at the end of the header of levels 5 to 7 ("MAT-File Format", The MathWorks).
fn is_level_5(bytes: &[u8]) -> bool {
    matches!(bytes.get(126..128), Some(b"IM" | b"MI")) && matches!(bytes.get(124..126), Some([0, 1] | [1, 0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_what_it_begins_with_whatever_it_is_called() {
        let of = |bytes: &[u8], name: &str| FileFormat::of(bytes, Path::new(name));
        assert_eq!(of(b"\x93NUMPY\x01\x00", "a.mat"), FileFormat::Npy);
        assert_eq!(of(b"PK\x03\x04", "a.txt"), FileFormat::Npz);
        assert_eq!(of(b"\x89HDF\r\n\x1a\n", "a.mat"), FileFormat::Hdf5);
        assert_eq!(of(b" {\"A\": 1}", "a.txt"), FileFormat::Json);
        assert_eq!(of(b"A = [1 2];", "a.m"), FileFormat::Literals);
        assert_eq!(of(b"1,2\n3,4\n", "a.csv"), FileFormat::Text);
        let header = [&[b'M'; 124][..], &[0, 1, b'I', b'M']].concat();
        assert_eq!(of(&header, "no extension"), FileFormat::Mat);
    }
}
