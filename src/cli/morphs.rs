//! The path between the states that `make` and `fabricate` follow alike, and what is said of it.

use super::Failure;
use crate::fabrication::product::Product;
use crate::geometry::mesh::TriMesh;
use crate::kirigami::design::{Design, State};
use crate::morph::{MOST_HINGES, Morph, STEPS, Step, Thick, morph};
use crate::output::exchange::piece_mesh;
use crate::pipeline::mill::walls;
use crate::profile::Profile;
use crate::solid::loft::loft;
use crate::solid::pieces;

/// A sheet on its way, and what moves.
pub struct Moving {
    /// The way.
    pub morph: Morph,
    /// The solid of every piece in the sheet state (closed, where neither is flat), millimetres.
    pub bodies: Vec<TriMesh>,
}

/// Hinge points that part by less than this part of an edge are not worth a word: a mechanism but for rounding.
const FREE: f64 = 1e-4;
/// The largest part of an edge by which the way may end beside the closed state.
const ARRIVED: f64 = 0.05;

/// The way of a product; `None` where nothing turns, or where there is too much for a look.
///
/// # Errors
/// Pieces that cannot be made thick.
pub fn moving(product: &Product, profile: &Profile) -> Result<Option<Moving>, Failure> {
    let design = product.design();
    if design.hinges.is_empty() || design.hinges.len() > MOST_HINGES {
        return Ok(None);
    }
    let Product::Sheet(sheet) = product else {
        return Ok(Some(Moving {
            morph: morph(design, None),
            bodies: polygons(design, profile.sheet.thickness)?,
        }));
    };
    let (thickness, walls) = (profile.sheet.thickness, walls(profile));
    let refused = |error: crate::solid::error::SolidError| Failure::NotMakeable(error.to_string());
    let pieces = pieces(sheet, thickness, walls).map_err(refused)?;
    let shell = |piece: &crate::solid::clash::Placed| Ok(loft(&piece.plate, thickness)?.mesh);
    let bodies = pieces.iter().map(shell).collect::<Result<_, _>>().map_err(refused)?;
    let thick = Thick::new(&sheet.hinges, &pieces, thickness, walls);
    Ok(Some(Moving { morph: morph(design, Some(&thick)), bodies }))
}

/// The hinge polygons in the sheet state (closed, where neither is flat) as solids.
///
/// # Errors
/// A piece that cannot be made one.
pub fn polygons(design: &Design, thickness: f64) -> Result<Vec<TriMesh>, Failure> {
    let state = design.sheet_state.unwrap_or(State::Closed);
    let body = |(index, piece)| {
        piece_mesh(piece, state, thickness)
            .map_err(|error| Failure::NotMakeable(format!("piece {index} cannot be made a solid: {error}")))
    };
    design.pieces.iter().enumerate().map(body).collect()
}

/// Lines for the summary.
pub fn summary(moving: Option<&Moving>, hinges: usize) -> String {
    let Some(Moving { morph, .. }) = moving else {
        return match hinges {
            0 => String::new(),
            _ => format!(
                "  the way between the states was left out, for there are more than {MOST_HINGES} hinges: kirimorph export --format \
                 glb follows any design\n"
            ),
        };
    };
    let worst = morph.worst();
    let mut text = if worst.strain < FREE {
        String::from("  moves from state to state without strain\n")
    } else {
        format!(
            "  cannot move without strain: hinge points part by up to {:.3} mm ({:.2} % of an edge) {}, axes by {:.1} deg\n",
            worst.parting.0,
            100.0 * worst.strain,
            opened(worst),
            morph.steps.iter().map(|step| step.lean).fold(0.0, f64::max).to_degrees()
        )
    };
    if let Some((step, clash)) = morph.collision() {
        text += &format!("  on the way, {}, {clash}\n", opened(step));
    }
    if morph.jump > ARRIVED {
        text += &format!(
            "  the way found ends {:.2} edges beside the closed state, and the first of its {STEPS} steps jumps there\n",
            morph.jump
        );
    }
    text
}

/// Where on the way a step is, in words.
fn opened(step: &Step) -> String {
    format!("at {:.0} % of the turn", 100.0 * step.share)
}

/// Figures for the result event.
pub fn event(moving: &Moving) -> serde_json::Value {
    let morph = &moving.morph;
    let worst = morph.worst();
    serde_json::json!({
        "steps": STEPS,
        "strain": worst.strain,
        "parting_mm": worst.parting.0,
        "parting_hinge": worst.parting.1,
        "share": worst.share,
        "jump_edges": morph.jump,
        "collision": morph.collision().map(|(step, clash)| serde_json::json!({
            "pieces": clash.pieces, "depth_mm": clash.depth, "limit_mm": clash.limit, "share": step.share,
        })),
        "collisions_sought": morph.thick,
    })
}
