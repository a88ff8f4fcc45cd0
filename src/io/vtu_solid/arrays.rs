//! The data arrays of a VTK file: text, base64 or raw bytes, of either byte order, plain or packed by one of VTK's compressors.
//!
//! ```text
//! plain    length, data
//! packed   blocks, length of each, length of the last (0: as the others), packed length of each; data of the blocks
//! base64   plain: all as one run, or the length as one of its own; packed: all before the semicolon as one run
//! ```
//!
//! How many numbers an array must have is known before it is read, so that nothing is unpacked beyond that.
//! Source: VTK file formats, "XML file formats"; the sources of `vtkXMLDataParser`.

use std::borrow::Cow;
use std::cell::Cell;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::Node;

/// The numbers of one array.
#[derive(Debug)]
pub(super) enum Numbers {
    /// From a text.
    Text(Vec<f64>),
    /// As they are in memory, of one type and byte order.
    Raw { kind: Kind, is_big: bool, bytes: Vec<u8> },
}

/// A type of VTK's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    F64,
    F32,
    I64,
    U64,
    I32,
    U32,
    I16,
    U16,
    I8,
    U8,
}

impl Kind {
    fn new(name: &str) -> Option<Self> {
        Some(match name {
            "Float64" => Self::F64,
            "Float32" => Self::F32,
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            "Int32" => Self::I32,
            "UInt32" => Self::U32,
            "Int16" => Self::I16,
            "UInt16" => Self::U16,
            "Int8" => Self::I8,
            "UInt8" => Self::U8,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::F64 | Self::I64 | Self::U64 => 8,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::I16 | Self::U16 => 2,
            Self::I8 | Self::U8 => 1,
        }
    }
}

impl Numbers {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Text(numbers) => numbers.len(),
            Self::Raw { kind, bytes, .. } => bytes.len() / kind.size(),
        }
    }

    /// Number `i`.
    ///
    /// # Panics
    /// When there are not so many.
    pub(super) fn at(&self, i: usize) -> f64 {
        let (kind, is_big, bytes) = match self {
            Self::Text(numbers) => return numbers[i],
            Self::Raw { kind, is_big, bytes } => (*kind, *is_big, bytes),
        };
        let raw = &bytes[i * kind.size()..][..kind.size()];
        macro_rules! number {
            ($type:ty) => {{
                let raw = raw.try_into().expect("a slice of that size");
                let number =
                    if is_big { <$type>::from_be_bytes(raw) } else { <$type>::from_le_bytes(raw) };
                number as f64
            }};
        }
        match kind {
            Kind::F64 => number!(f64),
            Kind::F32 => number!(f32),
            Kind::I64 => number!(i64),
            Kind::U64 => number!(u64),
            Kind::I32 => number!(i32),
            Kind::U32 => number!(u32),
            Kind::I16 => number!(i16),
            Kind::U16 => number!(u16),
            Kind::I8 => number!(i8),
            Kind::U8 => number!(u8),
        }
    }
}

/// How the arrays of a file are written.
pub(super) struct Arrays<'a> {
    /// Bytes of a number in the head of an array.
    head: usize,
    is_big: bool,
    packing: Packing,
    appended: Option<Block<'a>>,
    /// How many bytes of numbers may still be read: no grid is packed much tighter than 1 to [`TIGHTEST`].
    left: Cell<usize>,
}

/// VTK's compressors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    None,
    Zlib,
    /// One block of LZ4, without a frame.
    Lz4,
    /// An `.xz` file.
    Lzma,
}

/// How many bytes a byte of the file may become. A regular lattice of 10^6 cubes of tetrahedra, points and all, becomes 1 to 40 with LZMA.
const TIGHTEST: usize = 256;
/// What is never too much, bytes.
const LITTLE: usize = 16 << 20;

impl<'a> Arrays<'a> {
    /// The arrays of the file `root` of `length` bytes, with its `appended` data.
    pub(super) fn new(
        root: Node<'_, '_>,
        appended: Option<Block<'a>>,
        length: usize,
    ) -> Result<Self, String> {
        let is_big = match root.attribute("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => return Err(format!("the byte order {other} is not known")),
        };
        let head = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(format!("heads of the type {other} are not known")),
        };
        let packing = match root.attribute("compressor") {
            None | Some("") => Packing::None,
            Some("vtkZLibDataCompressor") => Packing::Zlib,
            Some("vtkLZ4DataCompressor") => Packing::Lz4,
            Some("vtkLZMADataCompressor") => Packing::Lzma,
            Some(other) => return Err(format!("data compressed by {other} are not read")),
        };
        let left = Cell::new(length.saturating_mul(TIGHTEST).saturating_add(LITTLE));
        Ok(Self { head, is_big, packing, appended, left })
    }

    /// The `count` numbers of a data `array`.
    pub(super) fn numbers(&self, array: Node<'_, '_>, count: usize) -> Result<Numbers, String> {
        let name = array.attribute("Name").unwrap_or("of the points");
        let unreadable = || format!("the array {name} cannot be read");
        let text = array.text().unwrap_or_default();
        let form = array.attribute("format").unwrap_or("ascii");
        if form.eq_ignore_ascii_case("ascii") {
            let words = text.split_ascii_whitespace();
            let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
            let numbers = numbers.map_err(|_| unreadable())?;
            return if numbers.len() == count {
                Ok(Numbers::Text(numbers))
            } else {
                Err(wrong_count(name, numbers.len(), count))
            };
        }
        let kind = array.attribute("type").and_then(Kind::new).ok_or_else(unreadable)?;
        let wanted = count.checked_mul(kind.size()).filter(|&wanted| wanted <= self.left.get());
        let wanted = wanted.ok_or_else(|| {
            format!("the array {name} of {count} numbers is not believed of a file of this size")
        })?;
        self.left.set(self.left.get() - wanted);
        let run: Cow<'_, str> = if text.trim().contains(|c: char| c.is_ascii_whitespace()) {
            text.split_ascii_whitespace().collect()
        } else {
            text.trim().into()
        };
        let block = if form.eq_ignore_ascii_case("binary") {
            Some(Block::Base64(run.as_bytes()))
        } else if form.eq_ignore_ascii_case("appended") {
            let offset = array.attribute("offset").and_then(|offset| offset.trim().parse().ok());
            offset.and_then(|offset| self.appended?.at(offset))
        } else {
            None
        };
        let block = block.ok_or_else(unreadable)?;
        match self.bytes(block, wanted) {
            Some(Ok(bytes)) => Ok(Numbers::Raw { kind, is_big: self.is_big, bytes }),
            Some(Err(length)) => Err(wrong_count(name, length / kind.size(), count)),
            None => Err(unreadable()),
        }
    }

    /// The `wanted` bytes of an array, or how many it has instead.
    fn bytes(&self, block: Block<'_>, wanted: usize) -> Option<Result<Vec<u8>, usize>> {
        let (first, behind) = block.taken(self.head)?;
        let first = self.number(&first)?;
        if self.packing == Packing::None {
            if first != wanted {
                return Some(Err(first));
            }
            return Some(Ok(if block.is_padded_at(self.head) {
                behind.taken(wanted)?.0
            } else {
                block.taken(self.head.checked_add(wanted)?)?.0.split_off(self.head)
            }));
        }
        let (head, data) = block.taken(self.head.checked_mul(first.checked_add(3)?)?)?;
        let numbers: Option<Vec<usize>> =
            head.chunks_exact(self.head).map(|number| self.number(number)).collect();
        let numbers = numbers?;
        let (&[_, each, last], sizes) = numbers.split_first_chunk()?;
        let last = if last == 0 { each } else { last };
        let announced = match first {
            0 => 0,
            blocks => (blocks - 1).checked_mul(each)?.checked_add(last)?,
        };
        if announced != wanted {
            return Some(Err(announced));
        }
        let total = sizes.iter().try_fold(0usize, |sum, &size| sum.checked_add(size))?;
        let (packed, _) = data.taken(total)?;
        let (mut bytes, mut rest) = (Vec::new(), &packed[..]);
        for (k, &size) in sizes.iter().enumerate() {
            let (these, others) = rest.split_at_checked(size)?;
            self.packing.unpack(these, if k + 1 == first { last } else { each }, &mut bytes)?;
            rest = others;
        }
        Some(Ok(bytes))
    }

    fn number(&self, bytes: &[u8]) -> Option<usize> {
        let number = bytes.iter().map(|&byte| u64::from(byte));
        let shifted = |sum: u64, byte: u64| (sum << 8) + byte;
        let number =
            if self.is_big { number.fold(0, shifted) } else { number.rev().fold(0, shifted) };
        number.try_into().ok()
    }
}

fn wrong_count(name: &str, found: usize, wanted: usize) -> String {
    format!("the array {name} has {found} numbers, but the grid wants {wanted}")
}

/// Memory for the dictionary of an `.xz` file, KiB: twice what VTK's tightest level takes.
const DICTIONARY: u32 = 128 << 10;

impl Packing {
    /// Appends the `size` bytes that `packed` holds to `bytes`; `None` when it holds others.
    fn unpack(self, packed: &[u8], size: usize, bytes: &mut Vec<u8>) -> Option<()> {
        let before = bytes.len();
        match self {
            Self::None => bytes.extend(packed),
            Self::Zlib => {
                read_at_most(flate2::read::ZlibDecoder::new(packed), size, bytes)?;
            }
            Self::Lz4 => {
                bytes.resize(before + size, 0);
                let length = lz4_flex::block::decompress_into(packed, &mut bytes[before..]).ok()?;
                bytes.truncate(before + length);
            }
            Self::Lzma => {
                let reader = lzma_rust2::XzReader::new_mem_limit(packed, false, DICTIONARY);
                read_at_most(reader, size, bytes)?;
            }
        }
        (bytes.len() - before == size).then_some(())
    }
}

/// Appends what `reader` gives, but for what is more than a byte beyond `size`.
fn read_at_most(reader: impl Read, size: usize, bytes: &mut Vec<u8>) -> Option<usize> {
    reader.take(size as u64 + 1).read_to_end(bytes).ok()
}

/// Binary data of a file, from the beginning of an array on.
#[derive(Clone, Copy)]
pub(super) enum Block<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl Block<'_> {
    fn at(self, offset: usize) -> Option<Self> {
        Some(match self {
            Self::Raw(data) => Self::Raw(data.get(offset..)?),
            Self::Base64(data) => Self::Base64(data.get(offset..)?),
        })
    }

    /// The first `count` bytes, which were encoded together, and what comes behind them.
    fn taken(self, count: usize) -> Option<(Vec<u8>, Self)> {
        match self {
            Self::Raw(data) => {
                let (these, rest) = data.split_at_checked(count)?;
                Some((these.to_vec(), Self::Raw(rest)))
            }
            Self::Base64(data) => {
                let (these, rest) = data.split_at_checked(count.div_ceil(3).checked_mul(4)?)?;
                let mut bytes = STANDARD.decode(these).ok()?;
                if bytes.len() < count {
                    return None;
                }
                bytes.truncate(count);
                Some((bytes, Self::Base64(rest)))
            }
        }
    }

    /// Whether the run of the first `count` bytes ends with them.
    fn is_padded_at(self, count: usize) -> bool {
        match self {
            Self::Raw(_) => true,
            Self::Base64(data) => data.get(4 * count.div_ceil(3) - 1) == Some(&b'='),
        }
    }
}
