//! Numbers as text: base64 (RFC 4648) of whole numbers of two bytes, the low one first.

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Bytes as text.
pub fn base64(bytes: Vec<u8>) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

/// Values in whole units; those out of range stop at its end.
pub fn rounded(values: impl IntoIterator<Item = f64>, unit: f64) -> Vec<u8> {
    values.into_iter().flat_map(|value| ((value / unit).round() as i16).to_le_bytes()).collect()
}

/// Counts; those out of range stop at its end.
pub fn counts(values: impl IntoIterator<Item = usize>) -> Vec<u8> {
    values.into_iter().flat_map(|value| u16::try_from(value).unwrap_or(u16::MAX).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_rfc_4648() {
        let examples = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, wanted) in examples {
            assert_eq!(base64(plain.as_bytes().to_vec()), wanted);
        }
        assert_eq!(base64(vec![0xfb, 0xff, 0xfe]), "+//+");
    }

    #[test]
    fn numbers_are_rounded_and_stop_at_the_ends() {
        assert_eq!(rounded([0.26, -0.24, 1e9], 0.1), [3, 0, 0xfe, 0xff, 0xff, 0x7f]);
        assert_eq!(counts([258, 1 << 20]), [2, 1, 0xff, 0xff]);
    }
}
