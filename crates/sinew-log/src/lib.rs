//! Recordings as frames.
