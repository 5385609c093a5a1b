//! Teaching and analysis: from demonstrations to a job file.
