//! Random damage to a text, for tests that reading it never panics.

/// The text after one to four random edits; the same for the same seed.
pub(crate) fn corrupt(text: &str, seed: u64) -> String {
    // Splitmix64: any seed gives a good sequence.
    let mut state = seed;
    let mut random = |below: usize| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below as u64) as usize
    };
    let snippets = [
        "=", "[", "]]", "\"", "'''", "\n", "\r", "#", ".", "-", "1e999", "nan", "\0", "ü", "\u{feff}", "{",
        "99",
    ];
    let mut characters: Vec<char> = text.chars().collect();
    for _ in 0..=random(4) {
        let at = random(characters.len() + 1);
        let end = (at + 1 + random(30)).min(characters.len());
        match random(4) {
            0 => drop(characters.drain(at..end)),
            1 => characters.truncate(at.max(1)),
            2 => {
                let copy = characters[at..end].to_vec();
                let to = random(characters.len() + 1);
                characters.splice(to..to, copy);
            }
            _ => drop(characters.splice(at..at, snippets[random(snippets.len())].chars())),
        }
    }
    characters.into_iter().collect()
}
