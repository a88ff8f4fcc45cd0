//! A number that tells a damaged text from a whole one, and one text from another.

/// FNV-1a, 64 bit (Fowler, Noll and Vo), of `bytes`.
///
/// Every single byte that is changed changes it; it is no guard against malice.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// The checksum of `bytes` as files hold it: 16 digits.
#[must_use]
pub fn written(bytes: &[u8]) -> String {
    format!("{:016x}", checksum(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_fnv_1a() {
        // Test vectors of the authors' reference code.
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
        assert_eq!(written(b"a"), "af63dc4c8601ec8c");
    }
}
