//! Group members, accessed by name.

use hdf5_pure::Object;

/// Dataset or group within a group.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) object: Object,
}
