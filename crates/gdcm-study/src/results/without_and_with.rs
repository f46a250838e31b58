//! A result without and with a correction to the physics models.

/// A result without and with the physics parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct WithoutAndWith<T> {
    pub without: T,
    pub with: T,
}
