//! Autopilot logs; in most formats, each topic has its own time axis.
//!
//! ```text
//! bytes -> messages -> topics: time stamps, and a column for each field  (ulog, dataflash)
//!       -> frames   -> a single topic                                    (blackbox)
//!       -> documented units and channels                                 (documented_channels)
//! ```

mod blackbox;
mod blackbox_fields;
mod blackbox_frames;
mod blackbox_header;
mod blackbox_integers;
mod dataflash;
mod dataflash_layouts;
mod dataflash_text;
mod dataflash_topics;
mod documented_channels;
mod mode_spans;
mod topic_samples;
mod ulog;
mod ulog_layouts;
mod ulog_modes;

pub(crate) use blackbox::BLACKBOX;
pub(crate) use dataflash::DATAFLASH;
pub(crate) use dataflash_text::DATAFLASH_TEXT;
pub(crate) use ulog::ULOG;

/// Returns the `N` bytes from `offset` on, for the readers of binary logs; `None` if fewer are left.
fn array<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..offset.checked_add(N)?)?.try_into().ok()
}
