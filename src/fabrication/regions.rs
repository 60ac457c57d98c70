//! What the grooves leave of the sheet around every piece: so that the outlines of all pieces take time in proportion to
//! their number, and every piece can be looked at beside the others.

mod burned;

use kurbo::{Point, Rect};
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::error::FabricationError;
use super::layout::CutPath;
use super::ligament::MeasuredLigament;
use super::outline::{Contour, Shape, area, centroid, contains, contour_box, inner_point, ligament_region};
use super::states::sheet_vertices;
use crate::kirigami::design::Design;

use burned::Cuts;

/// A region that comes this near to the edge of the box in which it was looked for may go on beyond it, millimetres.
const AT_EDGE: f64 = 1e-4;

/// Neighbouring pieces that are looked at together, at most: alone each would see the cuts of all its neighbours too, and
/// a union takes more than twice the time for twice the cuts.
const TOGETHER: usize = 128;

/// The pieces by their middles.
struct Middles {
    of: Vec<[f64; 2]>,
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Middles {
    fn new(design: &Design, kerf: f64) -> Self {
        let middle = |piece| {
            let polygon: Contour = sheet_vertices(design, piece).iter().map(|p| [p.x, p.y]).collect();
            inner_point(&polygon, kerf)
        };
        let of: Vec<[f64; 2]> = design.pieces.par_iter().map(middle).collect();
        let tree = of.iter().enumerate().map(|(piece, &at)| GeomWithData::new(at, piece)).collect();
        Middles { of, tree: RTree::bulk_load(tree) }
    }

    /// The pieces whose middles lie in a region, in ascending order.
    fn in_region(&self, region: &Shape) -> Vec<usize> {
        let Rect { x0, y0, x1, y1 } = contour_box(&region[0]);
        let near = self.tree.locate_in_envelope(&AABB::from_corners([x0, y0], [x1, y1]));
        let mut inside: Vec<usize> =
            near.map(|item| item.data).filter(|&piece| holds(region, self.of[piece])).collect();
        inside.sort_unstable();
        inside
    }
}

/// Whether a point lies in a region and in none of its holes.
fn holds(region: &Shape, point: [f64; 2]) -> bool {
    contains(&region[0], point) && !region[1..].iter().any(|hole| contains(hole, point))
}

/// The true outline of every piece, counter-clockwise, without its halves of the ligaments, in the pieces' order.
///
/// `paths`: all cuts; `ligaments`: measured on them. Scraps smaller than a kerf square are ignored.
///
/// # Errors
/// Scraps that come free, pieces that vanish, hang together or are pierced.
pub fn piece_outlines(
    design: &Design,
    paths: &[CutPath],
    ligaments: &[MeasuredLigament],
    kerf: f64,
) -> Result<Vec<Contour>, FabricationError> {
    let sheet = Sheet::new(design, paths, ligaments, kerf);
    let mut pieces: Vec<usize> = (0..design.pieces.len()).collect();
    let groups = groups(&mut pieces, &sheet.middles.of);
    let found: Vec<_> = groups.into_par_iter().map(|group| sheet.outlines(group, 1.0)).collect();
    let mut outlines = vec![Contour::new(); design.pieces.len()];
    for outline in found {
        outline?.into_iter().for_each(|(piece, outline)| outlines[piece] = outline);
    }
    Ok(outlines)
}

/// Pieces in groups of neighbours: halved along the longer side of their box until few are left.
fn groups<'a>(pieces: &'a mut [usize], middles: &[[f64; 2]]) -> Vec<&'a [usize]> {
    if pieces.len() <= TOGETHER {
        pieces.sort_unstable();
        return vec![pieces];
    }
    let points: Contour = pieces.iter().map(|&piece| middles[piece]).collect();
    let place = contour_box(&points);
    let axis = usize::from(place.height() > place.width());
    let half = pieces.len() / 2;
    pieces
        .select_nth_unstable_by(half, |&a, &b| middles[a][axis].total_cmp(&middles[b][axis]).then(a.cmp(&b)));
    let (low, high) = pieces.split_at_mut(half);
    let mut all = groups(low, middles);
    all.extend(groups(high, middles));
    all
}

/// The cuts with the pieces that they are to leave.
struct Sheet<'a> {
    cuts: Cuts<'a>,
    middles: Middles,
    /// The box of every piece.
    places: Vec<Rect>,
    /// The hinges of every piece.
    hinges: Vec<Vec<usize>>,
    /// What is taken off at every hinge.
    ligaments: Vec<Contour>,
}

impl<'a> Sheet<'a> {
    fn new(design: &Design, paths: &'a [CutPath], ligaments: &[MeasuredLigament], kerf: f64) -> Self {
        let place = |piece| {
            let polygon: Contour = sheet_vertices(design, piece).iter().map(|p| [p.x, p.y]).collect();
            contour_box(&polygon)
        };
        let mut hinges = vec![Vec::new(); design.pieces.len()];
        for (id, hinge) in design.hinges.iter().enumerate() {
            hinge.pieces.iter().for_each(|&piece| hinges[piece].push(id));
        }
        let (cuts, middles) = rayon::join(|| Cuts::new(paths, kerf), || Middles::new(design, kerf));
        let places = design.pieces.iter().map(place).collect();
        Sheet { cuts, middles, places, hinges, ligaments: ligaments.iter().map(ligament_region).collect() }
    }

    /// The outlines of some pieces that lie beside each other. `wider`: how many times farther around them is looked than
    /// usual.
    fn outlines(&self, group: &[usize], wider: f64) -> Result<Vec<(usize, Contour)>, FabricationError> {
        let Self { cuts, middles, places, .. } = self;
        let about = |piece: &usize| {
            let margin = 2.0 * cuts.kerf + 0.04 * (places[*piece].width() + places[*piece].height());
            places[*piece].inflate(wider * margin, wider * margin)
        };
        let place = group.iter().map(about).reduce(|all, place| all.union(place)).unwrap_or_default();
        let mut hinges: Vec<usize> = group.iter().flat_map(|&piece| &self.hinges[piece]).copied().collect();
        hinges.sort_unstable();
        hinges.dedup();
        let ligaments = hinges.iter().map(|&hinge| self.ligaments[hinge].clone());
        let regions: Vec<Region> =
            cuts.left(place, ligaments).into_iter().map(|shape| Region::new(shape, place)).collect();
        let mut outlines = Vec::with_capacity(group.len());
        for &piece in group {
            let own = regions.iter().find(|region| region.holds(middles.of[piece]));
            let own = own.ok_or_else(|| self.gone(piece))?;
            self.check(piece, own)?;
            if !own.at_edge {
                outlines.push((piece, own.shape[0].clone()));
                continue;
            }
            let everything = cuts.bounds.inflate(cuts.kerf, cuts.kerf);
            if place.union(everything) == place {
                return Err(self.gone(piece));
            }
            outlines.extend(self.outlines(&[piece], 2.0 * wider)?);
        }
        if let Some(scrap) = regions.iter().find(|region| self.falls(region)) {
            let [x, y] = centroid(&scrap.shape[0]);
            return Err(FabricationError::FallsApart { area: area(&scrap.shape[0]), x, y });
        }
        Ok(outlines)
    }

    /// Checks the region of a piece.
    fn check(&self, piece: usize, own: &Region) -> Result<(), FabricationError> {
        let inside = self.middles.in_region(&own.shape);
        if let Some(other) = inside.iter().find(|&&other| other != piece) {
            return Err(
                self.error(piece, format!("still hangs together with piece {other} beside the ligaments"))
            );
        }
        let pierced = own.shape[1..].iter().any(|hole| area(hole).abs() > self.scrap());
        if pierced && !own.at_edge {
            return Err(self.error(piece, "is pierced by a cut".into()));
        }
        Ok(())
    }

    /// Whether a region comes free that is no piece.
    fn falls(&self, region: &Region) -> bool {
        let loose = !region.at_edge && area(&region.shape[0]) > self.scrap();
        loose
            && self.middles.in_region(&region.shape).is_empty()
            && self.cuts.in_sheet(inner_point(&region.shape[0], 0.0))
    }

    /// What is smaller, in square millimetres, is no concern.
    fn scrap(&self) -> f64 {
        self.cuts.kerf * self.cuts.kerf
    }

    fn gone(&self, piece: usize) -> FabricationError {
        self.error(piece, "is burned away or cut through at its centre".into())
    }

    fn error(&self, piece: usize, reason: String) -> FabricationError {
        let [x, y] = self.middles.of[piece];
        FabricationError::PieceRegion { piece, x, y, reason }
    }
}

/// What is left between cuts.
struct Region {
    shape: Shape,
    bounds: Rect,
    /// Whether it may go on beyond the box in which it was looked for.
    at_edge: bool,
}

impl Region {
    fn new(shape: Shape, place: Rect) -> Self {
        let inside = place.inflate(-AT_EDGE, -AT_EDGE);
        let bounds = contour_box(&shape[0]);
        let corners = [Point::new(bounds.x0, bounds.y0), Point::new(bounds.x1, bounds.y1)];
        let at_edge = !corners.into_iter().all(|corner| strictly(inside, corner));
        Self { shape, bounds, at_edge }
    }

    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        self.bounds.contains(Point::new(x, y)) && holds(&self.shape, [x, y])
    }
}

/// Whether a point lies inside of a box and not on its edge.
fn strictly(place: Rect, point: Point) -> bool {
    place.x0 < point.x && point.x < place.x1 && place.y0 < point.y && point.y < place.y1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::closed_sheet;
    use crate::fabrication::test_sheet::{TestSheet, profile};

    /// Every piece by itself, and from far around, has the outline that it has among its neighbours.
    #[test]
    fn a_piece_has_the_same_outline_in_any_group() {
        let profile = profile();
        let (kerf, count) = (profile.cut.kerf, 23 * 19);
        let design = TestSheet::rectangle([23, 19], [10.0, 7.0], profile.hinge_gap()).design(0.7);
        let lengths = vec![0.9; design.hinges.len()];
        let laid = closed_sheet::lay_out(&design, &profile, &lengths).unwrap();
        let middles = Middles::new(&design, kerf);
        let mut pieces: Vec<usize> = (0..count).collect();
        let groups = groups(&mut pieces, &middles.of);
        assert!(
            groups.len() > 3 && groups.iter().all(|group| (TOGETHER / 4..=TOGETHER).contains(&group.len()))
        );
        let sheet = Sheet::new(&design, &laid.paths, &laid.ligaments, kerf);
        for piece in 0..count {
            let size = area(&laid.outlines[piece]);
            // A quadrilateral less half a groove around.
            assert!((60.0..70.0).contains(&size), "{piece}: {size}");
            for wider in [1.0, 8.0] {
                let alone = &sheet.outlines(&[piece], wider).unwrap()[..];
                let [(number, outline)] = alone else { panic!("{piece}: {alone:?}") };
                assert!(*number == piece && (area(outline) - size).abs() < 1e-5, "{piece} {wider}");
            }
        }
    }
}
