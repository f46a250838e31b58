//! From the columns of record files to flight records.
