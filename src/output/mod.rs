//! Writers: each turns values into the bytes of one format, and decides nothing.
