//! Members of HDF5 groups.

use hdf5_pure::Object;

/// Dataset or group within a group.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) object: Object,
}
