//! The machine file: its keys, the range of each number with the reason, and the rules between them.

use nalgebra::{Rotation3, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::{Coolant, Dialect, Machine, Output, Rotary, Setup, Spindle, Table};
use crate::geometry::Point3;
use crate::toml_source::{Limits, TomlError, TomlSource};

const PLACE: Limits = Limits::new(-20_000.0, 20_000.0, "mm", "machine coordinates of a mill, in millimetres");
const LINEAR_SPEED: Limits =
    Limits::new(10.0, 200_000.0, "mm/min", "hobby mills reach 1000 mm/min, linear motors 120000");
const ANGLE: Limits = Limits::new(-1.0e5, 1.0e5, "degrees", "an axis without end says -36000 to 36000");
const ROTARY_SPEED: Limits =
    Limits::new(10.0, 200_000.0, "deg/min", "a stepper table does 1800 deg/min, a torque motor 70000");
const SWING: Limits =
    Limits::new(0.1, 180.0, "degrees", "a block of a cut that turns further is no cut, but a rewind");
const UPRIGHT: Limits = Limits::new(
    0.0,
    0.5,
    "degrees",
    "0.05 degrees are 4 um over 5 mm; beyond half a degree hinges leave their axes",
);
const HEIGHT: Limits = Limits::new(1.0, 500.0, "mm", "above the stock, below the spindle");
const TOOL_LENGTH: Limits = Limits::new(0.0, 500.0, "mm", "from the spindle's face to the tip");
const TILT: Limits =
    Limits::new(-45.0, 45.0, "degrees", "a wedge lifts the job off the pole by some degrees");
const SPEED: Limits = Limits::new(1.0, 200_000.0, "turns/min", "of the spindle");
const START: Limits = Limits::new(0.0, 60.0, "s", "a spindle is up to speed within seconds");

#[derive(Deserialize)]
struct VersionOnly {
    version: Spanned<i64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMachine {
    #[serde(rename = "version")]
    _version: i64,
    kind: Spanned<String>,
    dialect: Spanned<String>,
    tcp: Spanned<bool>,
    linear: RawLinear,
    rotary: Option<RawRotary>,
    setup: RawSetup,
    fixture: Option<RawFixture>,
    spindle: RawSpindle,
    output: RawOutput,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLinear {
    x_mm: [Spanned<f64>; 2],
    y_mm: [Spanned<f64>; 2],
    z_mm: [Spanned<f64>; 2],
    rapid_mm_per_min: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRotary {
    sign: Spanned<i64>,
    a_deg: Option<[Spanned<f64>; 2]>,
    b_deg: Option<[Spanned<f64>; 2]>,
    c_deg: Option<[Spanned<f64>; 2]>,
    tilt_centre_mm: [Spanned<f64>; 3],
    turn_centre_mm: [Spanned<f64>; 3],
    rapid_deg_per_min: Spanned<f64>,
    cutting_deg_per_min: Spanned<f64>,
    max_swing_deg: Spanned<f64>,
    upright_below_deg: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSetup {
    work_offset: Spanned<u32>,
    zero_mm: [Spanned<f64>; 3],
    safe_height_mm: Spanned<f64>,
    clearance_mm: Spanned<f64>,
    home_z_mm: Spanned<f64>,
    tool_number: Spanned<u32>,
    tool_length_mm: Spanned<f64>,
    coolant: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFixture {
    axis: Spanned<String>,
    tilt_deg: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSpindle {
    min_rpm: Spanned<f64>,
    max_rpm: Spanned<f64>,
    start_s: Spanned<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawOutput {
    decimals: Spanned<u32>,
    angle_decimals: Spanned<u32>,
    max_bytes: Option<Spanned<u32>>,
    program_number: Option<Spanned<u32>>,
    kinematics_output: Option<Spanned<u32>>,
    tcp_on: Option<Spanned<u32>>,
    tcp_off: Option<Spanned<u32>>,
}

/// Reads and checks the text of a machine file. `name` becomes the machine's name, `file` stands in messages.
///
/// # Errors
/// Syntax, unknown, missing or mistyped keys, numbers that are not finite or out of range or contradict each
/// other, rotary axes that do not belong to the kind, another version than 1.
pub fn parse(text: &str, name: &str, file: &str) -> Result<Machine, TomlError> {
    let source = TomlSource { file, text };
    let VersionOnly { version } = source.parse()?;
    if *version.get_ref() != 1 {
        let help = "write `version = 1`, or use the release of kirimorph that the file was made for";
        let what = "not a version that this program reads: allowed is 1";
        return Err(source.value_error(version.span(), what, help));
    }
    let raw: RawMachine = source.parse()?;
    let rotary = rotary(&source, &raw)?;
    let dialect = dialect(&source, &raw.dialect)?;
    check_tcp(&source, &raw, dialect, rotary.is_some())?;
    let machine = Machine {
        name: name.to_owned(),
        dialect,
        tcp: *raw.tcp.get_ref(),
        travel: [
            range(&source, &raw.linear.x_mm, &PLACE)?,
            range(&source, &raw.linear.y_mm, &PLACE)?,
            range(&source, &raw.linear.z_mm, &PLACE)?,
        ],
        rapid: source.number(&raw.linear.rapid_mm_per_min, &LINEAR_SPEED)?,
        setup: setup(&source, &raw, rotary.is_some())?,
        rotary,
        spindle: Spindle {
            range: [
                source.number(&raw.spindle.min_rpm, &SPEED)?,
                source.number(&raw.spindle.max_rpm, &SPEED)?,
            ],
            start_seconds: source.number(&raw.spindle.start_s, &START)?,
        },
        output: output(&source, &raw.output)?,
    };
    check_home(&source, &raw, &machine)?;
    Ok(machine)
}

fn dialect(source: &TomlSource, word: &Spanned<String>) -> Result<Dialect, TomlError> {
    let words = [
        ("linuxcnc", Dialect::LinuxCnc),
        ("fanuc-g43.4", Dialect::FanucAngles),
        ("fanuc-g43.5", Dialect::FanucVectors),
        ("heidenhain-tcpm", Dialect::HeidenhainTcpm),
        ("heidenhain-m128", Dialect::HeidenhainM128),
        ("siemens", Dialect::SiemensAngles),
        ("siemens-vectors", Dialect::SiemensVectors),
        ("haas", Dialect::Haas),
    ];
    source.word(word, &words, "whose words the program uses")
}

/// Tool centre point control needs rotary axes, and only LinuxCNC's programs do without it.
fn check_tcp(source: &TomlSource, raw: &RawMachine, dialect: Dialect, rotary: bool) -> Result<(), TomlError> {
    let (what, help) = match (*raw.tcp.get_ref(), rotary) {
        (true, false) => ("not for three axes", "nothing turns: write `tcp = false`"),
        (false, true) if dialect != Dialect::LinuxCnc => {
            ("not for this dialect", "only LinuxCNC's programs are written in joint coordinates")
        }
        _ => return Ok(()),
    };
    Err(source.value_error(raw.tcp.span(), what, help))
}

fn rotary(source: &TomlSource, machine: &RawMachine) -> Result<Option<Rotary>, TomlError> {
    let words = [
        ("xyz", None),
        ("xyzac-trt", Some(Table::TiltAC)),
        ("xyzbc-trt", Some(Table::TiltBC)),
        ("xyzab-tdr", Some(Table::TiltBA)),
    ];
    let table = source.word(&machine.kind, &words, "which axes the machine has")?;
    let (table, raw) = match (table, &machine.rotary) {
        (None, None) => return Ok(None),
        (Some(table), Some(raw)) => (table, raw),
        (None, Some(_)) => {
            let what = "not a kind with a table [rotary]";
            return Err(source.value_error(machine.kind.span(), what, "three axes turn nothing"));
        }
        (Some(_), None) => {
            let what = "not a kind without a table [rotary]";
            return Err(source.value_error(machine.kind.span(), what, "give centres, limits and speeds"));
        }
    };
    let letters = table.letters();
    let ranges = [('A', &raw.a_deg), ('B', &raw.b_deg), ('C', &raw.c_deg)];
    if let Some((letter, Some(foreign))) =
        ranges.iter().find(|(letter, range)| range.is_some() && !letters.contains(letter))
    {
        let what = format!("not for a machine without an axis {letter}");
        return Err(source.value_error(foreign[0].span(), &what, "each axis of the kind has its own limits"));
    }
    let limits = letters.map(|letter| axis_range(source, machine, &ranges, letter));
    let [tilt, turn] = limits;
    let sign = match raw.sign.get_ref() {
        1 => 1.0,
        -1 => -1.0,
        _ => {
            let help =
                "1 for the tool's angle seen from the part (ISO), -1 for the table's own (LinuxCNC trt)";
            return Err(source.value_error(raw.sign.span(), "not a sign: allowed is 1 or -1", help));
        }
    };
    Ok(Some(Rotary {
        table,
        sign,
        tilt_centre: point(source, &raw.tilt_centre_mm)?,
        turn_centre: point(source, &raw.turn_centre_mm)?,
        limits: [tilt?, turn?],
        rapid: source.number(&raw.rapid_deg_per_min, &ROTARY_SPEED)?.to_radians(),
        cutting: source.number(&raw.cutting_deg_per_min, &ROTARY_SPEED)?.to_radians(),
        max_swing: source.number(&raw.max_swing_deg, &SWING)?.to_radians(),
        upright: source.number(&raw.upright_below_deg, &UPRIGHT)?.to_radians(),
    }))
}

type RawRange = Option<[Spanned<f64>; 2]>;

/// Limits of one rotary axis in radians; zero lies between them, where programs begin and end.
fn axis_range(
    source: &TomlSource,
    machine: &RawMachine,
    ranges: &[(char, &RawRange); 3],
    letter: char,
) -> Result<[f64; 2], TomlError> {
    let given = ranges.iter().find(|(named, _)| *named == letter).and_then(|(_, range)| range.as_ref());
    let Some(given) = given else {
        let what = format!("without the limits {}_deg in [rotary]", letter.to_ascii_lowercase());
        return Err(source.value_error(machine.kind.span(), &what, "give least and largest angle"));
    };
    let [least, largest] = range(source, given, &ANGLE)?;
    if least > 0.0 || largest < 0.0 {
        let help = "programs begin and end with both angles zero";
        return Err(source.value_error(given[0].span(), "the end of a range without zero", help));
    }
    Ok([least.to_radians(), largest.to_radians()])
}

fn range(source: &TomlSource, raw: &[Spanned<f64>; 2], limits: &Limits) -> Result<[f64; 2], TomlError> {
    let [least, largest] = [source.number(&raw[0], limits)?, source.number(&raw[1], limits)?];
    if least >= largest {
        let what = format!("not below the other end, {largest}");
        return Err(source.value_error(raw[0].span(), &what, "give the least value, then the largest"));
    }
    Ok([least, largest])
}

fn point(source: &TomlSource, raw: &[Spanned<f64>; 3]) -> Result<Point3, TomlError> {
    Ok(Point3::new(
        source.number(&raw[0], &PLACE)?,
        source.number(&raw[1], &PLACE)?,
        source.number(&raw[2], &PLACE)?,
    ))
}

fn setup(source: &TomlSource, machine: &RawMachine, rotary: bool) -> Result<Setup, TomlError> {
    let raw = &machine.setup;
    let heidenhain = machine.dialect.get_ref().starts_with("heidenhain");
    let offsets = if heidenhain { 0..=999 } else { 54..=59 };
    if !offsets.contains(raw.work_offset.get_ref()) {
        let what = format!("out of range: allowed is {} to {}", offsets.start(), offsets.end());
        let help = "the number after G of a work offset; for Heidenhain the preset's number";
        return Err(source.value_error(raw.work_offset.span(), &what, help));
    }
    if !(1..=999).contains(raw.tool_number.get_ref()) {
        let help = "the tool's place in the magazine";
        return Err(source.value_error(raw.tool_number.span(), "out of range: allowed is 1 to 999", help));
    }
    let words = [("off", Coolant::Off), ("mist", Coolant::Mist), ("flood", Coolant::Flood)];
    let coolant = source.word(&raw.coolant, &words, "M9, M7 or M8")?;
    let setup = Setup {
        work_offset: *raw.work_offset.get_ref(),
        zero: point(source, &raw.zero_mm)?,
        fixture: fixture(source, machine, rotary)?,
        safe_height: source.number(&raw.safe_height_mm, &HEIGHT)?,
        clearance: source.number(&raw.clearance_mm, &HEIGHT)?,
        home_z: source.number(&raw.home_z_mm, &PLACE)?,
        tool_number: *raw.tool_number.get_ref(),
        tool_length: source.number(&raw.tool_length_mm, &TOOL_LENGTH)?,
        coolant,
    };
    if setup.clearance > setup.safe_height {
        let what = format!("too large: allowed is at most setup.safe_height_mm = {}", setup.safe_height);
        return Err(source.value_error(raw.clearance_mm.span(), &what, "the tool comes down to it"));
    }
    Ok(setup)
}

/// The height of tool changes is a height that Z reaches.
fn check_home(source: &TomlSource, raw: &RawMachine, machine: &Machine) -> Result<(), TomlError> {
    let [least, largest] = machine.travel[2];
    if (least..=largest).contains(&machine.setup.home_z) {
        return Ok(());
    }
    let what = format!("beyond the travel of Z: allowed is linear.z_mm = {least} to {largest}");
    Err(source.value_error(raw.setup.home_z_mm.span(), &what, "where the spindle stands before and after"))
}

fn fixture(source: &TomlSource, machine: &RawMachine, rotary: bool) -> Result<Rotation3<f64>, TomlError> {
    let Some(raw) = &machine.fixture else { return Ok(Rotation3::identity()) };
    let tilt = source.number(&raw.tilt_deg, &TILT)?;
    let axis = match raw.axis.get_ref().as_str() {
        "x" => Vector3::x_axis(),
        "y" => Vector3::y_axis(),
        _ => {
            let what = "not an axis of a wedge: allowed is \"x\", \"y\"";
            return Err(source.value_error(raw.axis.span(), what, "the edge that stays on the table"));
        }
    };
    if !rotary && tilt != 0.0 {
        let what = "not for three axes: allowed is 0";
        return Err(source.value_error(raw.tilt_deg.span(), what, "nothing turns the stock upright again"));
    }
    Ok(Rotation3::from_axis_angle(&axis, tilt.to_radians()))
}

fn output(source: &TomlSource, raw: &RawOutput) -> Result<Output, TomlError> {
    let number = |value: &Spanned<u32>, least: u32, largest: u32, help: &str| {
        let given = *value.get_ref();
        if (least..=largest).contains(&given) {
            return Ok(given);
        }
        let what = format!("out of range: allowed is {least} to {largest}");
        Err(source.value_error(value.span(), &what, help))
    };
    let optional = |value: &Option<Spanned<u32>>, default: u32, least: u32, largest: u32, help: &str| {
        value.as_ref().map_or(Ok(default), |value| number(value, least, largest, help))
    };
    let digits = "3 digits of a millimetre are 1 um; no controller reads more than 9";
    let bytes = "a program of less than 20000 bytes holds no cut";
    let analog = "LinuxCNC has 64 analog outputs; the kinematics' types are 0 to 2";
    Ok(Output {
        decimals: number(&raw.decimals, 3, 9, digits)? as usize,
        angle_decimals: number(&raw.angle_decimals, 3, 9, digits)? as usize,
        max_bytes: match &raw.max_bytes {
            Some(value) => Some(number(value, 20_000, u32::MAX, bytes)? as usize),
            None => None,
        },
        program_number: optional(
            &raw.program_number,
            1,
            1,
            9000,
            "9001 and up are the maker's own programs",
        )?,
        switch: [
            optional(&raw.kinematics_output, 3, 0, 63, analog)?,
            optional(&raw.tcp_on, 1, 0, 2, analog)?,
            optional(&raw.tcp_off, 0, 0, 2, analog)?,
        ],
    })
}
