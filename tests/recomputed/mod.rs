//! Designs held against what independent programs make of them.

use std::path::Path;

use serde_json::json;

use super::peers;
use super::program::{asked, number};

/// What a design says about itself, recomputed by an independent program; and the schema.
pub fn check_recomputed(file: &Path) {
    let Some(found) = asked(peers::oracle("design_check.py"), &[&file]) else { return };
    for (key, limit) in [
        ("length_difference", 1e-9),
        ("planarity_difference", 1e-12),
        ("mean_edge_difference", 1e-10),
        ("apart_mm", 0.0),
        ("point_mm", 0.0),
        // Near half a turn the axis is known to the square root of rounding.
        ("rotation_difference", 1e-6),
    ] {
        assert!(number(&found, key) <= limit, "{}: {key}: {found}", file.display());
    }
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/design.schema.json");
    let faults = asked(peers::oracle("schema_check.py"), &[&schema, &file]).unwrap();
    assert_eq!(faults, json!([[]]), "{}", file.display());
}
