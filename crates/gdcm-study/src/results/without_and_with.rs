//! Pairs of results without and with the physics parameters.

/// A result without and with the physics parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct WithoutAndWith<T> {
    pub without: T,
    pub with: T,
}
