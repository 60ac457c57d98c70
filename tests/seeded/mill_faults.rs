//! What can be wrong with a program.

use super::Dice;

/// What a fault does to the lines of a program.
pub type Spoil = fn(&mut Vec<String>, &mut Dice) -> Option<()>;

pub const FAULTS: [(&str, Spoil); 9] = [
    ("a pass missing", |lines, dice| {
        let at = dice.below(lines.len() - 60);
        let cuts: Vec<usize> = (at..lines.len()).filter(|&i| is_cut(&lines[i])).take(40).collect();
        cuts.iter().rev().for_each(|&i| _ = lines.remove(i));
        (cuts.len() == 40).then_some(())
    }),
    ("a coordinate off", |lines, dice| {
        let letter = ['X', 'Y'][dice.below(2)];
        changed(lines, letter, dice, &|value| value + 0.3)
    }),
    ("too deep", |lines, dice| changed(lines, 'Z', dice, &|value| value - 20.0)),
    ("tilt off", |lines, dice| changed(lines, 'B', dice, &|value| value + 8.0)),
    ("a turn too many", |lines, dice| changed(lines, 'C', dice, &|value| value + 360.0)),
    ("a cut as a rapid move", |lines, dice| {
        let at = any(lines, dice, &is_cut)?;
        lines[at] = lines[at].replacen("G1 ", "G0 ", 1);
        Some(())
    }),
    ("too fast", |lines, dice| {
        let at = any(lines, dice, &|line| is_cut(line) && line.contains(" F300.0"))?;
        lines[at] = lines[at].replace(" F300.0", " F400.0");
        Some(())
    }),
    ("the spindle stands", |lines, _| {
        lines.iter_mut().for_each(|line| *line = line.replace("M3", "M5"));
        Some(())
    }),
    ("tilted the other way", |lines, _| {
        let at: Vec<usize> = (0..lines.len()).filter(|&i| is_cut(&lines[i])).collect();
        at.iter().for_each(|&i| lines[i] = word(&lines[i], 'B', &|value| -value).unwrap_or(lines[i].clone()));
        Some(())
    }),
];

/// Deep in the stock: neither on the way there nor back.
fn is_cut(line: &str) -> bool {
    line.starts_with("G1 X") && line.contains(" B")
}

fn any(lines: &[String], dice: &mut Dice, wanted: &dyn Fn(&str) -> bool) -> Option<usize> {
    let all: Vec<usize> = (0..lines.len()).filter(|&i| wanted(&lines[i])).collect();
    (!all.is_empty()).then(|| all[dice.below(all.len())])
}

/// A line with a changed word; `None` where it has none of that letter.
fn word(line: &str, letter: char, change: &dyn Fn(f64) -> f64) -> Option<String> {
    let mut found = false;
    let words: Vec<String> = line
        .split(' ')
        .map(|word| match word.strip_prefix(letter).and_then(|number| number.parse::<f64>().ok()) {
            Some(value) => {
                found = true;
                format!("{letter}{:.5}", change(value))
            }
            None => word.to_owned(),
        })
        .collect();
    found.then(|| words.join(" "))
}

fn changed(lines: &mut [String], letter: char, dice: &mut Dice, change: &dyn Fn(f64) -> f64) -> Option<()> {
    let at = any(lines, dice, &|line| is_cut(line) && word(line, letter, &|v| v).is_some())?;
    lines[at] = word(&lines[at], letter, change)?;
    Some(())
}
