//! Legend, key figures and the hinges to look at first.

use kurbo::{Point, Rect, Vec2};
use svg::node::element::{Group, Path};

use super::Scene;
use super::page::{
    self, BOLD, BORDER, INK, Sense, colour, dots, fixed, grouped, number, push_polyline, rectangle, segment,
    shortened, text, turn_arrow, wrapped,
};
use super::sheet::cut_style;
use super::space::sense_name;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::layout::CutKind;
use crate::fabrication::mechanics::StrainClass;

/// How a hinge is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HingeClass {
    /// Ok, and springs back.
    Elastic,
    /// Ok, and stays bent.
    Plastic,
    /// Verdict "warn".
    Warn,
    /// Verdict "fail".
    Fail,
}

impl HingeClass {
    /// All, those to be seen drawn last.
    pub const ALL: [Self; 4] = [Self::Elastic, Self::Plastic, Self::Warn, Self::Fail];

    /// The class of a hinge.
    pub fn of(row: &HingeRow) -> Self {
        match (row.verdict, row.strain_class) {
            (Verdict::Fail, _) => Self::Fail,
            (Verdict::Warn, _) => Self::Warn,
            (Verdict::Ok, StrainClass::Elastic) => Self::Elastic,
            (Verdict::Ok, _) => Self::Plastic,
        }
    }

    /// Filling.
    pub fn colour(self) -> &'static str {
        match self {
            Self::Elastic => "#009e73",
            Self::Plastic => "#222222",
            Self::Warn => "#f0e442",
            Self::Fail => "#d55e00",
        }
    }

    /// Size of the marker on the page; `None` for plain dots.
    pub fn marker_size(self) -> Option<f64> {
        match self {
            Self::Elastic | Self::Plastic => None,
            Self::Warn => Some(1.0),
            Self::Fail => Some(1.3),
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Self::Elastic => "ok, springs back (elastic)",
            Self::Plastic => "ok, stays bent (plastic)",
            Self::Warn => "WARN: makeable, less exact",
            Self::Fail => "FAIL: do not cut",
        }
    }
}

/// A warning's triangle or a failure's diamond.
pub fn marker(class: HingeClass, at: Point, size: f64) -> Path {
    let corners: &[[f64; 2]] = match class {
        HingeClass::Fail => &[[0.0, -1.2], [1.2, 0.0], [0.0, 1.2], [-1.2, 0.0]],
        _ => &[[0.0, -1.1], [1.05, 0.8], [-1.05, 0.8]],
    };
    let mut data = String::new();
    push_polyline(&mut data, corners.iter().map(|&[x, y]| at + size * Vec2::new(x, y)), true, 2);
    page::area(data, class.colour()).set("stroke", BORDER).set("stroke-width", "0.2")
}

const ROW: f64 = 4.9;
const SIZE: f64 = 3.3;

/// What tones, lines and dots mean.
pub fn legend(scene: &Scene, area: Rect) -> Group {
    let third = area.width() / 3.0;
    let column = |i: f64| Rect { x0: area.x0 + 2.0 + i * third, x1: area.x0 + (i + 1.0) * third, ..area };
    let frame = rectangle(area, "none").set("stroke", "#bbbbbb").set("stroke-width", "0.25");
    Group::new()
        .add(frame)
        .add(piece_legend(
            if scene.opening.closes { "closes" } else { "opens" },
            &scene.opening.senses,
            column(0.0),
        ))
        .add(cut_legend(scene, column(1.0)))
        .add(hinge_legend(&scene.fabrication.hinges, column(2.0)))
}

fn heading(area: Rect, content: &str) -> Group {
    Group::new().add(text(Point::new(area.x0, area.y0 + 4.6), SIZE, content).set("font-weight", "bold"))
}

fn row(area: Rect, i: usize) -> Point {
    Point::new(area.x0, area.y0 + 4.6 + ROW * (i + 1) as f64)
}

/// The tones of these pieces of a sheet that "opens" or "closes".
pub fn piece_legend(does: &str, senses: &[Sense], area: Rect) -> Group {
    let mut group = heading(area, &format!("Pieces, as the sheet {does}, turn"));
    let kinds = [Sense::CounterClockwise, Sense::Clockwise, Sense::Still];
    let shown: Vec<Sense> = kinds.into_iter().filter(|kind| senses.contains(kind)).collect();
    let spread = if shown.len() > 2 { 0.35 } else { 1.5 };
    for (i, &sense) in shown.iter().enumerate() {
        let at = row(area, i) + Vec2::new(0.0, spread * i as f64);
        let swatch = Rect::new(at.x, at.y - 3.6 - 0.5 * spread, at.x + 9.0, at.y + 1.2);
        group = group
            .add(
                rectangle(swatch, &colour(sense.tone())).set("stroke", "#555555").set("stroke-width", "0.15"),
            )
            .add(turn_arrow(swatch.center(), 1.5, sense, 0.35))
            .add(text(Point::new(at.x + 11.0, at.y - 0.6), SIZE, sense_name(sense)));
    }
    let at = row(area, shown.len()) + Vec2::new(0.0, 0.9 * spread * shown.len() as f64);
    group.add(rectangle(Rect::new(at.x, at.y - 2.8, at.x + 9.0, at.y + 0.4), "#8a8a8a")).add(text(
        Point::new(at.x + 11.0, at.y),
        SIZE,
        "underside (in space)",
    ))
}

fn cut_legend(scene: &Scene, area: Rect) -> Group {
    let paths = &scene.fabrication.layout.paths;
    let kinds = [
        (CutKind::Slit, "slits (layer SLIT)"),
        (CutKind::Relief, "relief bars (layer RELIEF)"),
        (CutKind::Window, "windows (layer WINDOW)"),
        (CutKind::Border, "border, cut last (layer BORDER)"),
    ];
    let mut group = heading(area, "Cuts, their width already applied:");
    let present =
        kinds.into_iter().map(|(kind, name)| (kind, name, paths.iter().filter(|p| p.kind == kind).count()));
    for (i, (kind, name, count)) in present.filter(|(.., count)| *count > 0).enumerate() {
        let at = row(area, i);
        let (colour, width) = cut_style(kind);
        group = group
            .add(segment(at - Vec2::new(0.0, 1.1), at + Vec2::new(9.0, -1.1), colour, 2.5 * width))
            .add(text(Point::new(at.x + 11.0, at.y), SIZE, &format!("{} {name}", grouped(count))));
    }
    group
}

/// How many hinges there are of each class.
pub fn hinge_legend(rows: &[HingeRow], area: Rect) -> Group {
    let mut group = heading(area, &format!("Hinges: {} in all", grouped(rows.len())));
    for (i, class) in HingeClass::ALL.into_iter().enumerate() {
        let at = row(area, i);
        let centre = Point::new(at.x + 3.0, at.y - 1.1);
        let sign = match class.marker_size() {
            None => dots([centre], 0.8, class.colour()),
            Some(size) => marker(class, centre, size),
        };
        let count = rows.iter().filter(|row| HingeClass::of(row) == class).count();
        let line = format!("{} {}", grouped(count), class.meaning());
        group = group.add(sign).add(text(Point::new(at.x + 7.0, at.y), SIZE, &line));
    }
    group
}

/// The caller's key figures.
pub fn figures(lines: &[(String, String)], area: Rect) -> Group {
    let mut group = page::panel(area, "4  Key figures");
    let room = area.height() - 9.0;
    // Rows shrink down to small print; what still has no room is counted.
    let pitch = (room / lines.len().max(1) as f64).clamp(3.4, 4.8);
    let size = 0.68 * pitch;
    let most = (room / pitch) as usize;
    let shown = if lines.len() > most { most.saturating_sub(1) } else { lines.len() };
    let width = area.width() - 4.0;
    let base = |i: usize| area.y0 + 10.2 + pitch * i as f64;
    for (i, (label, value)) in lines.iter().take(shown).enumerate() {
        let value = shortened(value, BOLD * size, 0.62 * width);
        let label = shortened(label, size, width - page::text_width(&value, BOLD * size) - size);
        group = group.add(text(Point::new(area.x0 + 2.0, base(i)), size, &label)).add(
            text(Point::new(area.x1 - 2.0, base(i)), size, &value)
                .set("text-anchor", "end")
                .set("font-weight", "bold"),
        );
    }
    if shown < lines.len() {
        let rest = format!("and {} more in design.json", lines.len() - shown);
        group = group.add(text(Point::new(area.x0 + 2.0, base(shown)), size, &rest));
    }
    group
}

/// Counts by verdict and the worst hinges with what is wrong.
pub fn hinges(rows: &[HingeRow], worst: &[&HingeRow], area: Rect) -> Group {
    let all_ok = rows.iter().all(|row| row.verdict == Verdict::Ok);
    let heading = if all_ok { "5  Most strained hinges" } else { "5  Worst hinges" };
    let mut y = area.y0 + 10.6;
    let mut group = page::panel(area, heading).add(text(
        Point::new(area.x0 + 2.0, y),
        2.9,
        "id at (x, y) in mm: turning angle, strain at that angle",
    ));
    let room = (area.y1 - y - 2.0) / worst.len().max(1) as f64;
    y += 1.4;
    for row in worst {
        let head = format!(
            "#{} at ({}, {}): {}\u{b0}, {} %",
            row.id,
            number(row.point.x, 1),
            number(row.point.y, 1),
            fixed(row.angle.to_degrees(), 1),
            fixed(100.0 * row.strain, 1)
        );
        let width = area.width() - 4.0;
        group = group.add(
            text(Point::new(area.x0 + 2.0, y + 3.2), 3.0, &shortened(&head, BOLD * 3.0, width))
                .set("font-weight", "bold"),
        );
        let verdict = match row.verdict {
            Verdict::Ok => format!("ok, {}", row.strain_class),
            Verdict::Warn => format!("warn: {}", row.reason),
            Verdict::Fail => format!("fail: {}", row.reason),
        };
        let most = (((room - 3.6) / 3.2) as usize).max(1);
        let mut lines = wrapped(&verdict, 2.8, width);
        if lines.len() > most {
            lines.truncate(most);
            lines[most - 1].push_str(" \u{2026}");
        }
        for (i, line) in lines.iter().enumerate() {
            let at = Point::new(area.x0 + 2.0, y + 6.4 + 3.2 * i as f64);
            group = group.add(text(at, 2.8, line).set("fill", INK));
        }
        y += room;
    }
    group
}
