//! Readers and writers on small files.
