//! Bytes a little other than those of a good file: what broken disks, other programs and strangers send.

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`, which is not 0.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    fn pick<T: Copy>(&mut self, things: &[T]) -> T {
        things[self.below(things.len())]
    }
}

/// No mutation is longer, bytes: what is asked is what small files can do.
const LONGEST: usize = 1 << 20;

/// One of the `good` files after one to four changes.
pub(crate) fn mutated(good: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = good[random.below(good.len())].clone();
    for _ in 0..=random.below(4) {
        let other = &good[random.below(good.len())];
        change(&mut bytes, other, random);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    if bytes.is_empty() {
        bytes.extend(other);
        return;
    }
    let at = random.below(bytes.len());
    match random.below(14) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.pick(&[0, 1, 0x7f, 0x80, 0xff, b'\n', b'"', b'<', b' ', b'-']),
        2 => bytes.truncate(at),
        3 => {
            let end = (at + 1 + random.below(64)).min(bytes.len());
            bytes.drain(at..end);
        }
        4 => {
            bytes.truncate(at);
            bytes.extend(&other[random.below(other.len())..]);
        }
        5 => repeat(bytes, at, random),
        6..=8 => swap_number(bytes, at, random),
        9 => {
            let number = extreme_bytes(random);
            let end = (at + number.len()).min(bytes.len());
            bytes.splice(at..end, number);
        }
        10 => swap_lines(bytes, random),
        11 => {
            let word = random.pick(&WORDS);
            bytes.splice(at..at, word.iter().copied());
        }
        12 => {
            let from = random.below(other.len());
            let piece = &other[from..(from + 1 + random.below(256)).min(other.len())];
            bytes.splice(at..at, piece.iter().copied());
        }
        _ => {
            for _ in 0..8 {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
        }
    }
}

/// Words that other formats or terminals obey.
const WORDS: [&[u8]; 12] = [
    b"\x1b]0;title\x07",
    b"\xef\xbb\xbf",
    b"\xf6",
    b"\r",
    b"\0\0\0\0",
    b"\xe2\x80\xae",
    b"$End",
    b"endsolid",
    b"<!--",
    b"\"\"\"",
    b"]]]]]]",
    b"[[[[[[[[[[[[[[[[",
];

const NUMBERS: [&str; 20] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "2147483648",
    "18446744073709551615",
    "-9223372036854775808",
    "9999999999999999999999",
    "1e9",
    "0x10",
    "",
];

/// Puts an extreme number in the place of the next decimal one behind `at`.
fn swap_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_number = |byte: &u8| byte.is_ascii_digit();
    let Some(start) = bytes[at..].iter().position(is_number).map(|start| at + start) else {
        return;
    };
    let is_more = |byte: &u8| byte.is_ascii_digit() || b".eE+-".contains(byte);
    let length = bytes[start..].iter().take_while(|byte| is_more(byte)).count();
    bytes.splice(start..start + length, random.pick(&NUMBERS).bytes());
}

fn extreme_bytes(random: &mut Random) -> Vec<u8> {
    let integer =
        random.pick(&[0, 1, 2, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, u64::MAX, 1 << 63, 1 << 33]);
    let double =
        random.pick(&[f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE / 4.0, -0.0, 1e30]);
    match random.below(6) {
        0 => (integer as u32).to_le_bytes().to_vec(),
        1 => integer.to_le_bytes().to_vec(),
        2 => integer.to_be_bytes().to_vec(),
        3 => double.to_le_bytes().to_vec(),
        4 => (double as f32).to_le_bytes().to_vec(),
        _ => (integer as u32).to_be_bytes().to_vec(),
    }
}

/// Says a piece again and again, with or without what is between lines.
fn repeat(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let end = (at + 1 + random.below(512)).min(bytes.len());
    let piece = bytes[at..end].to_vec();
    let times = random.pick(&[1, 2, 10, 100, 2000]);
    let times = times.min(LONGEST.saturating_sub(bytes.len()) / piece.len());
    bytes.splice(at..at, piece.repeat(times));
}

fn swap_lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<Vec<u8>> =
        bytes.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    let (a, b) = (random.below(lines.len()), random.below(lines.len()));
    lines.swap(a, b);
    *bytes = lines.concat();
}
