//! Mode 2: a list of indices, each as a difference to one of two earlier ones.

use super::{unzigzag, varint};

/// Decodes `count` indices. None if the stream is damaged.
pub(super) fn decode(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    const HEADER: u8 = 0xd1;
    const TAIL: usize = 4;
    let (&HEADER, rest) = stream.split_first()? else { return None };
    let mut data = &rest[..rest.len().checked_sub(TAIL)?];
    // Each index takes a byte at least.
    if count > data.len() {
        return None;
    }
    let mut last = [0u32; 2];
    let mut list = Vec::with_capacity(count);
    for _ in 0..count {
        let v = varint(&mut data)?;
        let baseline = &mut last[(v & 1) as usize];
        *baseline = baseline.wrapping_add(unzigzag(v >> 1));
        list.push(*baseline);
    }
    data.is_empty().then_some(list)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of the specification's examples: 0x7f, 0x201 and 0x1fd005 as differences to the two baselines.
    ///
    /// Seen to catch: one baseline for both.
    #[test]
    fn differences_to_two_baselines() {
        let stream = |data: &[u8]| [&[0xd1][..], data, &[0; 4]].concat();
        // 0x7f: odd, the second baseline, ~(0x3f >> 1) = -32; 0x04: the first, 1; 0x201: the second, 0x80.
        let list = decode(&stream(&[0x04, 0x08, 0x81, 0x04, 0x02]), 4).expect("a good stream");
        assert_eq!(list, [1, 3, 128, 2]);
        assert_eq!(decode(&stream(&[0x7f]), 1).expect("a good stream"), [0u32.wrapping_sub(32)]);
        for (data, count) in [(&[0x04][..], 2), (&[0x04, 0x04], 1), (&[0xff; 6], 1), (&[], 1)] {
            assert_eq!(decode(&stream(data), count), None, "{data:?}");
        }
        assert_eq!(decode(&[0xe1, 4, 0, 0, 0, 0], 1), None);
        assert_eq!(decode(&[0xd1, 0], 0), None);
    }
}
