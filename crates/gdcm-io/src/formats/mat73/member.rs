//! Members of a group, called by name.

use hdf5_pure::Object;

/// Dataset or group in a group.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) object: Object,
}
