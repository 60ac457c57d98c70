//! Random edits of files.

/// Splitmix64: any seed gives a good sequence.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Less than `limit`, which is above 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    /// From -1 to 1.
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// One of them.
    pub fn of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

/// What numbers are replaced by.
const NUMBERS: [&str; 34] = [
    "nan",
    "NaN",
    "inf",
    "-inf",
    "Infinity",
    "1e308",
    "-1e308",
    "1.8e308",
    "1e999",
    "5e-324",
    "2.2e-308",
    "-0",
    "0",
    "1",
    "-1",
    "2",
    "3",
    "1e-9",
    "1e-300",
    "1e15",
    "1e9",
    "999999999",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "0.30000000000000004",
    "1.",
    ".5",
    "0x10",
    "1_000",
];

/// What is put between other words.
const WORDS: [&str; 40] = [
    "\0",
    "\r\n",
    "\r",
    "\n",
    "\n\n",
    "\u{feff}",
    "\t",
    " ",
    "#",
    "(",
    ")",
    "%",
    ";",
    "\"",
    "'",
    "'''",
    "\"\"\"",
    "\\",
    "\\u0000",
    "../",
    "/",
    "/dev/null",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "{}",
    "[]",
    ",",
    ":",
    "=",
    ".",
    "-",
    "+",
    "null",
    "true",
    "\u{fc}",
    "<",
    "&amp;",
];

/// Most bytes of an input: larger ones would test the patience only.
const LARGEST: usize = 1 << 20;

/// A file after one to five edits; parts of `others` may be put in.
pub fn mutate(bytes: &[u8], others: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(5) {
        edit(&mut bytes, others, random);
        bytes.truncate(LARGEST);
    }
    bytes
}

fn edit(bytes: &mut Vec<u8>, others: &[Vec<u8>], random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    let end = (at + 1 + random.below(40)).min(bytes.len());
    match random.below(14) {
        0 => flip(bytes, random),
        1 => drop(bytes.drain(at..end)),
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(..at)),
        4 => {
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        5 => doubled(bytes, random),
        6 => spliced(bytes, others, random),
        7 => drop(bytes.splice(at..at, random.of(&WORDS).bytes())),
        8 => nested(bytes, at, random),
        9 => lines(bytes, random),
        10 => counts(bytes, random),
        _ => number(bytes, at, random),
    }
}

/// Some bits the other way.
fn flip(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..=random.below(8) {
        if let Some(last) = bytes.len().checked_sub(1) {
            let at = random.below(last + 1);
            bytes[at] ^= 1 << random.below(8);
        }
    }
}

/// A long part twice or often.
fn doubled(bytes: &mut Vec<u8>, random: &mut Random) {
    let from = random.below(bytes.len() + 1);
    let to = from + random.below(bytes.len() - from + 1);
    let times = if to - from < 200 { 1 + random.below(200) } else { 1 };
    let copies = bytes[from..to].repeat(times);
    bytes.splice(to..to, copies);
}

/// A part of another file in the place of one of this.
fn spliced(bytes: &mut Vec<u8>, others: &[Vec<u8>], random: &mut Random) {
    let other = random.of(others);
    let from = random.below(other.len() + 1);
    let part = &other[from..(from + random.below(400)).min(other.len())];
    let at = random.below(bytes.len() + 1);
    let end = (at + random.below(400)).min(bytes.len());
    bytes.splice(at..end, part.iter().copied());
}

/// Brackets in brackets.
fn nested(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let word = random.of(&["[", "{", "(", "{\"a\":", "[[", "a.", "<g>", "a={"]);
    let times = *random.of(&[10, 200, 5000, 50_000]);
    bytes.splice(at..at, word.repeat(times).into_bytes());
}

/// Two lines change places, one goes, or all end otherwise.
fn lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = bytes.split(|&byte| byte == b'\n').collect();
    let [a, b] = [random.below(lines.len()), random.below(lines.len())];
    let end: &[u8] = match random.below(4) {
        0 => b"\r\n",
        1 => b"\r",
        _ => b"\n",
    };
    if random.below(2) == 0 {
        lines.swap(a, b);
    } else {
        lines.remove(a);
    }
    *bytes = lines.join(end);
}

/// Four bytes that a binary file may take for a count or a number.
fn counts(bytes: &mut [u8], random: &mut Random) {
    let values = [u32::MAX, 0x7fff_ffff, 0x7f80_0000, 0xff80_0000, 0x7fc0_0000, 0x0000_0001, 0x7f7f_ffff, 0];
    let value = *random.of(&values);
    let value = if random.below(2) == 0 { value.to_le_bytes() } else { value.to_be_bytes() };
    // Headers more often than the rest.
    let range = if random.below(2) == 0 { bytes.len().min(120) } else { bytes.len() };
    if range >= 4 {
        let at = random.below(range - 3);
        bytes[at..at + 4].copy_from_slice(&value);
    }
}

/// The number at or after a place becomes another.
fn number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let of_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let Some(from) = bytes[at..].iter().position(is_digit).map(|digit| at + digit) else { return };
    let begin = from - bytes[..from].iter().rev().take_while(|byte| of_number(byte)).count();
    let end = from + bytes[from..].iter().take_while(|byte| of_number(byte)).count();
    let new = match random.below(4) {
        0 => format!("{:?}", random.signed() * 10f64.powi(random.below(40) as i32 - 20)),
        1 => random.below(300).to_string(),
        _ => (*random.of(&NUMBERS)).to_owned(),
    };
    bytes.splice(begin..end, new.into_bytes());
}
