//! Aircraft logs, which consist of topics with a time axis each.
//!
//! ```text
//! bytes -> messages -> topics: stamps, and a column for each field  (ulog, dataflash)
//!       -> frames   -> a single topic                               (blackbox)
//!       -> documented units and channels                            (meanings)
//! ```

mod blackbox;
mod blackbox_frames;
mod blackbox_heading;
mod dataflash;
mod dataflash_messages;
mod dataflash_text;
mod meanings;
mod mode_spans;
mod topics;
mod ulog;
mod ulog_layouts;

pub(crate) use blackbox::BLACKBOX;
pub(crate) use dataflash::DATAFLASH;
pub(crate) use dataflash_text::DATAFLASH_TEXT;
pub(crate) use ulog::ULOG;

/// Returns the `N` bytes from `offset` on; `None` if fewer are left.
fn array<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..offset.checked_add(N)?)?.try_into().ok()
}
