//! What lies in shared memory: repr(C) data only.
