//! Sheets milled in simulation, and programs with faults that it must find.

use nalgebra::{Unit, Vector3};

use super::path::{Planned, Work, path};
use super::sweep::finding::{Finding, Trouble};
use super::sweep::{Figures, Move, Neck, Wanted, inspect, of_path};
use super::toolpath::{Kind, Pose, Rate};
use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::test_sheet::{TestSheet, cut_open};
use crate::geometry::mesh::TriMesh;
use crate::kirigami::design::Design;
use crate::profile;
use crate::solid::strokes::Strokes;
use crate::solid::{Walls, thicken};

/// A sheet in nylon with all that milling it takes.
struct Milled {
    sheet: Fabrication,
    part: TriMesh,
    necks: Vec<Neck>,
    planned: Planned,
    tool: crate::profile::Tool,
}

const THICKNESS: f64 = 5.0;

/// A lattice whose axes lean by up to a tenth, more towards one corner, and the two hinges of a corner by `apart` to opposite
/// sides of the slit between them.
fn lattice(apart: f64) -> Design {
    let mut design = TestSheet::rectangle([4, 3], [14.0, 12.0], 1.5 + 2.5 * apart).design(0.3);
    for hinge in &mut design.hinges {
        let corner = design.corners[design.pieces[hinge.pieces[0]].corners[hinge.vertices[0]]];
        let away = (hinge.point - corner).try_normalize(1e-6).unwrap_or_default() * (0.5 * apart);
        let lean = Vector3::new(0.1 - 0.0025 * corner.x, 0.003 * corner.y - 0.05, 1.0);
        let up = (lean + away).normalize();
        hinge.axis = hinge.axis.z.signum() * up;
    }
    design
}

fn milled(design: &Design) -> Milled {
    let profile = profile::load("nylon-6-5mm", std::path::Path::new(".")).unwrap();
    let sheet = fabricate(design, &profile, &ligament_lengths(design, &profile).unwrap()).unwrap();
    let strokes = Strokes::new(&sheet.layout.paths, &sheet.hinges, 0.5);
    let part = thicken(&sheet, THICKNESS, Walls::Ruled).unwrap().part;
    let necks = sheet.hinges.iter().map(|row| Neck::new(row, false)).collect();
    let tool = profile.tool.unwrap();
    let work = Work { strokes: &strokes, hinges: &sheet.hinges, tool: &tool, thickness: THICKNESS };
    let planned = path(&work, &|a, b| (a.tip - b.tip).norm()).unwrap();
    Milled { sheet, part, necks, planned, tool }
}

impl Milled {
    fn moves(&self) -> Vec<Move> {
        of_path(&self.planned.path, self.tool.spindle)
    }

    fn inspected(&self, moves: &[Move], radius: f64) -> (Figures, Vec<Finding>) {
        let wanted = Wanted {
            part: &self.part,
            copies: 1,
            necks: &self.necks,
            stock: self.sheet.layout.sheet,
            thickness: THICKNESS,
            radius,
            tool: &self.tool,
            tabs: &self.planned.tabs,
        };
        inspect(moves, &wanted)
    }

    /// The troubles of a changed program, and the worst value of each.
    fn troubles(&self, moves: &[Move]) -> Vec<(Trouble, f64)> {
        let (_, mut findings) = self.inspected(moves, 0.5);
        findings.sort_by(|a, b| a.trouble.cmp(&b.trouble).then(b.value.total_cmp(&a.value)));
        findings.dedup_by_key(|finding| finding.trouble);
        findings.into_iter().map(|finding| (finding.trouble, finding.value)).collect()
    }
}

fn found(troubles: &[(Trouble, f64)], wanted: Trouble) -> f64 {
    troubles.iter().find(|(trouble, _)| *trouble == wanted).map_or(0.0, |(_, value)| *value)
}

/// Every pose of a program changed.
fn changed(moves: &[Move], change: impl Fn(&Pose) -> Pose) -> Vec<Move> {
    moves.iter().map(|a| Move { from: change(&a.from), to: change(&a.to), ..*a }).collect()
}

#[test]
fn lattices_are_milled_within_the_limits_closed_and_open() {
    let alike = lattice(0.0);
    for design in [alike.clone(), lattice(0.08), cut_open(alike)] {
        let milled = milled(&design);
        let (figures, findings) = milled.inspected(&milled.moves(), 0.5);
        assert!(
            findings.is_empty(),
            "{figures:?} {:?}",
            findings.iter().map(ToString::to_string).collect::<Vec<_>>()
        );
        assert!(figures.gouge < 0.007 && figures.leftover < 0.007, "{figures:?}");
        assert!(
            (figures.widths[0] - 0.5).abs() < 0.01 && (figures.widths[1] - 0.5).abs() < 0.01,
            "{figures:?}"
        );
        assert!(figures.centre < 0.005 && figures.bodies == 1, "{figures:?}");
        assert_eq!(milled.planned.tabs.len(), milled.tool.tabs);
        // Every groove at least twice at every depth.
        let cut: f64 = milled.sheet.layout.paths.iter().map(|path| path.length()).sum();
        assert!(figures.cut > 12.0 * cut, "{} {cut}", figures.cut);
    }
}

#[test]
fn runs_are_closed_walks_that_go_down_away_from_ligaments_and_leave_the_border_to_the_end() {
    let milled = milled(&lattice(0.05));
    let runs = &milled.planned.path.runs;
    assert!(runs.len() > 5);
    use super::toolpath::Contour;
    let borders: Vec<usize> =
        runs.iter().enumerate().filter(|(_, run)| run.contour == Contour::Border).map(|(i, _)| i).collect();
    assert_eq!(borders, [runs.len() - 1]);
    for run in runs {
        assert!(run.start.tip.z > 2.0 && run.blocks.last().unwrap().to.tip.z > 2.0);
        let mut last = run.start;
        for block in &run.blocks {
            let down = last.tip.z - block.to.tip.z;
            if down > 1e-9 && block.kind != Kind::Approach && run.contour == Contour::Opening {
                let [a, b] = [last, block.to].map(|pose| pose.lifted((-2.5 - pose.tip.z) / pose.axis.z).tip);
                let near = |row: &&crate::fabrication::hinge_table::HingeRow| {
                    (a - row.point).norm().min((b - row.point).norm()) < 1.5
                };
                assert!(!milled.sheet.hinges.iter().any(|row| near(&row)), "down at {a}");
                let way = (block.to.tip - last.tip).norm();
                assert!(down <= way * (milled.tool.ramp + 0.12).sin(), "{down} {way}");
            }
            last = block.to;
        }
    }
    // Climb: around an opening with the material to the right is counter-clockwise.
    let first = &runs[0].blocks;
    let area: f64 = first
        .windows(2)
        .filter(|pair| pair[1].kind == Kind::Finish)
        .map(|pair| pair[0].to.tip.coords.xy().perp(&pair[1].to.tip.coords.xy()))
        .sum();
    assert!(area > -1.0, "{area}");
}

#[test]
fn seeded_faults_are_found() {
    let milled = milled(&lattice(0.05));
    let moves = milled.moves();
    assert_eq!(milled.troubles(&moves), []);
    // The tilt's sign.
    let mirrored = changed(&moves, |pose| Pose {
        axis: Unit::new_normalize(Vector3::new(-pose.axis.x, -pose.axis.y, pose.axis.z)),
        ..*pose
    });
    assert!(found(&milled.troubles(&mirrored), Trouble::Gouge) > 0.1);
    // A tool that is not what the program thinks.
    for (radius, trouble) in [(0.6, Trouble::Gouge), (0.4, Trouble::Leftover)] {
        let (_, findings) = milled.inspected(&moves, radius);
        let worst = findings.iter().filter(|f| f.trouble == trouble).map(|f| f.value).fold(0.0, f64::max);
        assert!((worst - 0.1).abs() < 0.01, "{worst}");
    }
    // Inches.
    let inches = changed(&moves, |pose| Pose { tip: pose.tip / 25.4, ..*pose });
    assert!(milled.troubles(&inches).iter().any(|(trouble, _)| *trouble == Trouble::Leftover));
    // The spindle stands.
    let still: Vec<Move> = moves.iter().map(|a| Move { spindle: 0.0, ..*a }).collect();
    assert!(milled.troubles(&still).iter().any(|(trouble, _)| *trouble == Trouble::Spindle));
    // Twice the feed in one move.
    let at = moves.iter().position(|a| a.to.tip.z < -3.0 && a.rate != Rate::Rapid).unwrap();
    let mut fast = moves.clone();
    fast[at].rate = Rate::Feed(600.0);
    assert_eq!(milled.troubles(&fast), [(Trouble::Feed, 600.0)]);
    // A rapid move at depth.
    fast[at].rate = Rate::Rapid;
    assert!(milled.troubles(&fast)[..].iter().any(|(trouble, _)| *trouble == Trouble::Rapid));
    // A way through a piece, between two cuts, that nobody lifted the tool for.
    let mut straight = moves.clone();
    straight.remove(at);
    assert!(found(&milled.troubles(&straight), Trouble::Jump) > 0.1);
    // A jump of the axis within a move.
    let mut swung = moves.clone();
    swung[at].to.axis = Unit::new_normalize(Vector3::new(0.6, 0.0, 1.0));
    assert!(found(&milled.troubles(&swung), Trouble::Jump) > 0.4);
}

#[test]
fn missing_passes_are_found_and_so_is_a_border_that_is_cut_first() {
    let milled = milled(&lattice(0.05));
    let of = |path: &super::toolpath::Toolpath| milled.troubles(&of_path(path, milled.tool.spindle));
    // One opening is not cut at all, another not to the bottom.
    let mut fewer = milled.planned.path.clone();
    fewer.runs.remove(2);
    assert!(found(&of(&fewer), Trouble::Leftover) > 0.5);
    let mut shallow = milled.planned.path.clone();
    let last = shallow.runs[1].blocks.len() - 1;
    let deepest = shallow.runs[1].blocks.iter().map(|block| block.to.tip.z).fold(0.0, f64::min);
    let keep = |i: usize, z: f64| i == last || z > deepest + 0.2;
    let mut i = 0;
    shallow.runs[1].blocks.retain(|block| {
        i += 1;
        keep(i - 1, block.to.tip.z)
    });
    assert!(found(&of(&shallow), Trouble::Leftover) > 0.1);
    // One pass on the way down is left out: the next one takes two at once.
    let mut hasty = milled.planned.path.clone();
    let level = |block: &super::toolpath::Block| (-2.3..-1.8).contains(&block.to.tip.z);
    hasty.runs[1].blocks.retain(|block| !level(block));
    let depth = found(&of(&hasty), Trouble::Depth);
    assert!(depth > 1.5 * milled.tool.step_down, "{depth}");
    let mut early = milled.planned.path.clone();
    let border = early.runs.pop().unwrap();
    early.runs.insert(0, border);
    assert_eq!(of(&early).iter().map(|(trouble, _)| *trouble).collect::<Vec<_>>(), [Trouble::Body]);
    // Tabs that are not declared are leftover.
    let bare = Milled { planned: Planned { tabs: Vec::new(), ..milled.planned.clone() }, ..milled };
    assert!(found(&bare.troubles(&bare.moves()), Trouble::Leftover) > 0.4);
}

#[test]
fn only_the_way_back_along_a_groove_goes_faster() {
    use super::toolpath::Contour;
    let milled = milled(&lattice(0.0));
    let tool = milled.tool;
    assert!(tool.retrace > 2.0 * tool.feed);
    let blocks = || milled.planned.path.runs.iter().flat_map(|run| &run.blocks);
    let length = |wanted: &dyn Fn(Kind) -> bool| {
        let runs = milled.planned.path.runs.iter().filter(|run| run.contour == Contour::Opening);
        runs.flat_map(|run| {
            let ends = run.blocks.iter().map(|block| block.to.tip);
            let starts = std::iter::once(run.start.tip).chain(ends.clone());
            let kinds = run.blocks.iter().map(|block| block.kind).collect::<Vec<_>>();
            starts.zip(ends).zip(kinds).filter(|(_, kind)| wanted(*kind)).map(|((a, b), _)| (b - a).norm())
        })
        .sum::<f64>()
    };
    for block in blocks() {
        assert_eq!(block.rate == Rate::Feed(tool.retrace), block.kind == Kind::Retrace);
    }
    // All of an opening is passed twice, but for the ramp's length.
    let rough = length(&|kind| kind == Kind::Rough);
    let back = length(&|kind| kind == Kind::Retrace);
    assert!(back > 0.6 * rough, "{back} of {rough}");
    let (_, findings) = milled.inspected(&milled.moves(), 0.5);
    assert!(findings.is_empty(), "{findings:?}");

    // The same speed anywhere else is a fault.
    let hurried = |kind: Kind| {
        let mut path = milled.planned.path.clone();
        let blocks = path.runs.iter_mut().flat_map(|run| &mut run.blocks);
        blocks.filter(|block| block.kind == kind).for_each(|block| block.rate = Rate::Feed(tool.retrace));
        milled.troubles(&of_path(&path, tool.spindle))
    };
    for kind in [Kind::Rough, Kind::Ramp] {
        assert_eq!(found(&hurried(kind), Trouble::Feed), tool.retrace, "{kind:?}");
    }
    // Neither may it go faster than that.
    let faster = changed_rates(&milled.moves(), |rate| if rate > tool.feed { 1.5 * rate } else { rate });
    assert_eq!(found(&milled.troubles(&faster), Trouble::Feed), 1.5 * tool.retrace);
}

fn changed_rates(moves: &[Move], change: impl Fn(f64) -> f64) -> Vec<Move> {
    let rate = |rate: Rate| match rate {
        Rate::Feed(feed) => Rate::Feed(change(feed)),
        Rate::Rapid => Rate::Rapid,
    };
    moves.iter().map(|a| Move { rate: rate(a.rate), ..*a }).collect()
}
