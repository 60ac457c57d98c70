//! The `kirimorph` command.

fn main() {}
