//! `toolpath.svg`: the tool's path seen from above, by depth and kind, to look at before anything is cut.

use std::io::{self, Write};

use crate::milling::path::Planned;
use crate::milling::toolpath::{Block, Contour, Kind, Pose, Run};

/// Width of the paths, millimetres.
const LINE: f64 = 0.12;

/// How many times longer than it is the axis' way through the sheet is drawn.
const AXIS_SCALE: f64 = 5.0;

/// Axes are drawn so far apart, millimetres.
const AXIS_STEP: f64 = 6.0;

/// What the picture is of.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// The path with its tabs.
    pub planned: &'a Planned,
    /// Size of the stock, millimetres.
    pub stock: [f64; 2],
    /// Lines at its foot.
    pub notes: &'a [String],
}

/// Writes the picture, millimetres, y up as on the machine.
///
/// # Errors
/// What the writer refuses.
pub fn write<W: Write>(picture: &Picture, mut out: W) -> io::Result<()> {
    let Picture { planned, stock, notes } = *picture;
    let [x0, y0, x1, y1] = bounds(planned, stock);
    let (width, height) = (x1 - x0, y1 - y0);
    let letter = (0.012 * width.max(height)).max(1.5);
    let foot = letter * 1.5 * (notes.len() as f64 + 3.0);
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}mm\" height=\"{:.1}mm\" viewBox=\"{x0:.2} {:.2} \
         {width:.2} {:.2}\" font-family=\"sans-serif\">",
        height + foot,
        -y1,
        height + foot
    )?;
    writeln!(out, "<rect x=\"{x0:.2}\" y=\"{:.2}\" width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>", -y1)?;
    writeln!(
        out,
        "<g transform=\"scale(1,-1)\" fill=\"none\" stroke-linejoin=\"round\" stroke-width=\"{LINE}\">"
    )?;
    let runs = &planned.path.runs;
    links(runs, &mut out)?;
    let deepest = runs.iter().flat_map(|run| &run.blocks).map(|block| block.to.tip.z).fold(-1e-9, f64::min);
    for run in runs {
        levels(run, deepest, &mut out)?;
        axes(run, planned.path.thickness, &mut out)?;
    }
    for run in runs {
        ramps(run, &mut out)?;
    }
    for tab in &planned.tabs {
        let radius = planned.path.radius;
        writeln!(
            out,
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" stroke=\"#d00000\" stroke-width=\"{:.2}\"/>",
            tab.at.x,
            tab.at.y,
            tab.reach,
            0.6 * radius
        )?;
    }
    writeln!(out, "</g>")?;
    legend([x0, y0], letter, deepest, notes, &mut out)?;
    writeln!(out, "</svg>")
}

/// The picture's box: what is cut and what is near it of the stock.
fn bounds(planned: &Planned, stock: [f64; 2]) -> [f64; 4] {
    let tips = planned.path.runs.iter().flat_map(|run| &run.blocks).map(|block| block.to.tip);
    let start = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    let [x0, y0, x1, y1] =
        tips.fold(start, |[a, b, c, d], p| [a.min(p.x), b.min(p.y), c.max(p.x), d.max(p.y)]);
    if x0 > x1 {
        return [0.0, 0.0, stock[0], stock[1]];
    }
    [x0 - 5.0, y0 - 5.0, x1 + 5.0, y1 + 5.0]
}

/// Light for shallow, dark for deep.
fn colour(depth: f64) -> String {
    let part = depth.clamp(0.0, 1.0);
    let mix = |from: f64, to: f64| (from + part * (to - from)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(180.0, 0.0), mix(205.0, 40.0), mix(255.0, 140.0))
}

fn line<'a>(poses: impl IntoIterator<Item = &'a Pose>) -> String {
    let mut text = String::new();
    for (i, pose) in poses.into_iter().enumerate() {
        text += &format!("{}{:.2} {:.2}", if i == 0 { "M" } else { "L" }, pose.tip.x, pose.tip.y);
    }
    text
}

fn links(runs: &[Run], out: &mut impl Write) -> io::Result<()> {
    for pair in runs.windows(2) {
        if let Some(last) = pair[0].blocks.last() {
            let way = line([&last.to, &pair[1].start]);
            writeln!(out, "<path d=\"{way}\" stroke=\"#b0b0b0\" stroke-dasharray=\"1 1\"/>")?;
        }
    }
    Ok(())
}

/// Blocks that belong together, each with the pose before the first.
fn stretches(run: &Run, same: impl Fn(&Block, &Block) -> bool) -> Vec<(Pose, &[Block])> {
    let mut before = run.start;
    let mut all = Vec::new();
    for blocks in run.blocks.chunk_by(same) {
        all.push((before, blocks));
        before = blocks[blocks.len() - 1].to;
    }
    all
}

/// The tip's way at every depth; what is passed again at the same depth is drawn once.
fn levels(run: &Run, deepest: f64, out: &mut impl Write) -> io::Result<()> {
    let mut drawn: Vec<i64> = Vec::new();
    let same = |a: &Block, b: &Block| a.kind == b.kind && (a.to.tip.z - b.to.tip.z).abs() < 1e-6;
    for (before, level) in stretches(run, same) {
        let z = level[0].to.tip.z;
        if !matches!(level[0].kind, Kind::Rough | Kind::Finish) {
            continue;
        }
        let key = (z * 1e4).round() as i64;
        if level[0].kind == Kind::Finish && run.contour == Contour::Opening {
            if drawn.contains(&key) {
                continue;
            }
            drawn.push(key);
        }
        let way = line(std::iter::once(&before).chain(level.iter().map(|block| &block.to)));
        let dash = if level[0].kind == Kind::Finish { "" } else { " stroke-dasharray=\"2 0.3\"" };
        writeln!(out, "<path d=\"{way}\" stroke=\"{}\"{dash}/>", colour(z / deepest))?;
    }
    Ok(())
}

fn ramps(run: &Run, out: &mut impl Write) -> io::Result<()> {
    for (before, ramp) in stretches(run, |a, b| a.kind == b.kind) {
        if ramp[0].kind == Kind::Ramp {
            let way = line(std::iter::once(&before).chain(ramp.iter().map(|block| &block.to)));
            writeln!(out, "<path d=\"{way}\" stroke=\"#ff7a00\"/>")?;
        }
    }
    let start = run.start.tip;
    writeln!(
        out,
        "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"0.4\" fill=\"#ff7a00\" stroke=\"none\"/>",
        start.x, start.y
    )
}

/// The tool's axis through the sheet, drawn longer than it is.
fn axes(run: &Run, thickness: f64, out: &mut impl Write) -> io::Result<()> {
    let finish: Vec<&Block> = run.blocks.iter().filter(|block| block.kind == Kind::Finish).collect();
    let mut way = String::new();
    let mut since = f64::INFINITY;
    for (i, block) in finish.iter().enumerate() {
        let Pose { tip, axis } = block.to;
        since += if i > 0 { (tip - finish[i - 1].to.tip).norm() } else { 0.0 };
        if since < AXIS_STEP {
            continue;
        }
        since = 0.0;
        let reach = AXIS_SCALE * thickness / axis.z;
        way += &format!("M{:.2} {:.2}l{:.2} {:.2}", tip.x, tip.y, reach * axis.x, reach * axis.y);
    }
    writeln!(out, "<path d=\"{way}\" stroke=\"#2a9d2a\" stroke-width=\"{:.2}\"/>", 0.7 * LINE)
}

fn legend(
    [x0, y0]: [f64; 2],
    letter: f64,
    deepest: f64,
    notes: &[String],
    out: &mut impl Write,
) -> io::Result<()> {
    let mut y = -y0 + 1.5 * letter;
    let x = x0 + letter;
    writeln!(out, "<g font-size=\"{letter:.2}\" fill=\"#202020\">")?;
    let steps = 6;
    for i in 0..steps {
        let part = f64::from(i) / f64::from(steps - 1);
        let left = x + f64::from(i) * 9.0 * letter;
        writeln!(
            out,
            "<rect x=\"{left:.2}\" y=\"{:.2}\" width=\"{letter:.2}\" height=\"{letter:.2}\" fill=\"{}\"/><text x=\"{:.2}\" \
             y=\"{y:.2}\">{:.2} mm deep</text>",
            y - 0.8 * letter,
            colour(part),
            left + 1.4 * letter,
            0.0_f64.max(-part * deepest)
        )?;
    }
    y += 1.5 * letter;
    let says = "blue: tip at depth (dashed: rough); orange: way down, dot: entry; green: tool axis through the sheet, five \
                times as long; red: tabs; grey: between cuts";
    for text in [says].into_iter().chain(notes.iter().map(String::as_str)) {
        writeln!(out, "<text x=\"{x:.2}\" y=\"{y:.2}\">{}</text>", escaped(text))?;
        y += 1.5 * letter;
    }
    writeln!(out, "</g>")
}

fn escaped(text: &str) -> String {
    let text = super::plain_line(text);
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
