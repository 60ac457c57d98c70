//! Siemens 840D: words separated by spaces, `=` after names of more than one letter or axes.

use nalgebra::Vector3;

use super::controller::{Controller, Target};
use super::{Motion, ReadError, each_line, error, number};
use crate::machine::profile::{Dialect, Machine};

pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<Motion>, ReadError> {
    let mut controller = Controller::new(machine);
    each_line(text, |line, content| run(&mut controller, line, content))?;
    if !controller.ended {
        return Err(error(text.lines().count(), "", "the program does not end with M30".into()));
    }
    Ok(controller.motions)
}

fn run(controller: &mut Controller, line: usize, content: &str) -> Result<(), String> {
    let code = content.split(';').next().unwrap_or_default();
    let words: Vec<&str> = code.split_whitespace().collect();
    if words.iter().any(|word| !word.starts_with('N')) && controller.ended {
        return Err("a line after the program's end".into());
    }
    let dwell = words.contains(&"G4");
    let mut target = Target { machine: words.contains(&"SUPA"), ..Target::default() };
    let mut vector = [None; 3];
    let mut moves = false;
    for word in words {
        match word {
            "SUPA" => {}
            "TRAORI" => controller.hold_tip(true)?,
            "TRAFOOF" => controller.hold_tip(false)?,
            "ORIMKS" | "ORIAXES" if controller.machine.dialect == Dialect::SiemensAngles => {}
            "ORIWKS" | "ORIVECT" if controller.machine.dialect == Dialect::SiemensVectors => {}
            "D0" => controller.length = false,
            "D1" => controller.length = true,
            _ if dwell && word.starts_with('F') => drop(number(&word[1..])?),
            _ => moves |= axis_or_code(controller, word, &mut target, &mut vector)?,
        }
    }
    if vector.iter().any(Option::is_some) {
        let [a, b, c] = vector.map(|part| part.unwrap_or(0.0));
        target.vector = Some(Vector3::new(a, b, c));
    }
    if moves { controller.go(line, target) } else { Ok(()) }
}

/// One word; whether it moves an axis.
fn axis_or_code(
    controller: &mut Controller,
    word: &str,
    target: &mut Target,
    vector: &mut [Option<f64>; 3],
) -> Result<bool, String> {
    let unknown = || format!("\"{word}\" is not known here");
    if let Some((name, value)) = word.split_once('=') {
        let value = number(value)?;
        let letters = controller.letters().map(|letter| letter.map(String::from));
        let vectors = controller.machine.dialect == Dialect::SiemensVectors && controller.tcp;
        match (["A3", "B3", "C3"].iter().position(|part| *part == name), vectors) {
            (Some(part), true) => vector[part] = Some(value),
            (None, false) => {
                let axis = letters.iter().position(|letter| letter.as_deref() == Some(name));
                target.turns[axis.ok_or_else(unknown)?] = Some(value);
            }
            _ => return Err(unknown()),
        }
        return Ok(true);
    }
    let mut characters = word.chars();
    let letter = characters.next().ok_or_else(unknown)?;
    let value = number(characters.as_str())?;
    match (letter, word) {
        ('X' | 'Y' | 'Z', _) => {
            target.xyz[letter as usize - 'X' as usize] = Some(value);
            return Ok(true);
        }
        ('F', _) => controller.feed = Some(value),
        ('S', _) => controller.speed = value,
        ('N' | 'T', _) => {}
        (_, "G0") => controller.rapid = Some(true),
        (_, "G1") => controller.rapid = Some(false),
        (_, "G4" | "G17" | "G40" | "G90" | "G94") => {}
        ('G', _) if (54.0..=59.0).contains(&value) => {}
        (_, "G71" | "G710") => controller.unit = 1.0,
        (_, "G70" | "G700") => controller.unit = 25.4,
        ('M', _) if value.fract() == 0.0 && controller.auxiliary(value as u32) => {}
        _ => return Err(unknown()),
    }
    Ok(false)
}
