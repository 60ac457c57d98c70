//! The job file: what the user asks for.
