//! The stages together, on exact flat designs.
use super::fabricate::fabricate;
use super::test_sheet::{profile, sheets};

#[test]
fn dump() {
    for (n, (sheet, phi)) in sheets().into_iter().enumerate() {
        let design = sheet.design(phi);
        let lengths = vec![1.1; design.hinges.len()];
        match fabricate(&design, &profile(), &lengths) {
            Ok(made) => {
                let mut text = String::new();
                for path in &made.layout.paths {
                    text += &format!("P {:?} {}", path.kind, path.closed);
                    for v in &path.vertices {
                        text += &format!(" {},{},{}", v.point.x, v.point.y, v.bulge);
                    }
                    text += "\n";
                }
                for outline in &made.outlines {
                    text += "O";
                    for v in outline {
                        text += &format!(" {},{}", v[0], v[1]);
                    }
                    text += "\n";
                }
                for p in &made.design.pieces {
                    text += "H";
                    for v in &p.closed {
                        text += &format!(" {},{}", v.x, v.y);
                    }
                    text += "\n";
                }
                for p in &made.layout.notes {
                    text += &format!("N {} {} {} {}\n", p.position.x, p.position.y, p.height, p.text);
                }
                std::fs::write(format!("/tmp/wtd_{n}.txt"), text).unwrap();
                for row in &made.hinges {
                    println!("{row:?}");
                }
            }
            Err(error) => println!("{n}: {error}"),
        }
    }
}
