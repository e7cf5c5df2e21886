//! Mode 0: vertices of any layout. Each byte of a vertex is stored as its difference to the vertex before.

/// How the differences of four neighboring bytes are meant.
#[derive(Clone, Copy)]
enum Channel {
    /// Differences of bytes.
    Bytes,
    /// Differences of numbers of 16 bits.
    Words,
    /// Changed bits of a number of 32 bits, which the encoder turned left by this many.
    Bits(u32),
}

impl Channel {
    fn of(byte: u8) -> Option<Channel> {
        match (byte & 15, byte >> 4) {
            (0, 0) => Some(Channel::Bytes),
            (1, 0) => Some(Channel::Words),
            (2, turn) => Some(Channel::Bits(turn.into())),
            _ => None,
        }
    }

    /// The four bytes after those of the vertex before.
    fn apply(self, before: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Channel::Bytes => std::array::from_fn(|k| {
                let v = delta[k];
                before[k].wrapping_add(if v & 1 == 0 { v >> 1 } else { !(v >> 1) })
            }),
            Channel::Words => {
                let word = |k: usize| {
                    let [v, b] = [delta, before].map(|of| u16::from_le_bytes([of[k], of[k + 1]]));
                    b.wrapping_add(if v & 1 == 0 { v >> 1 } else { !(v >> 1) }).to_le_bytes()
                };
                let ([a, b], [c, d]) = (word(0), word(2));
                [a, b, c, d]
            }
            Channel::Bits(turn) => {
                (u32::from_le_bytes(before) ^ u32::from_le_bytes(delta).rotate_right(turn)).to_le_bytes()
            }
        }
    }
}

/// Vertices in a group, which share the number of bits of their differences.
const GROUP: usize = 16;
/// Most vertices in a block.
const BLOCK: usize = 256;

/// Decodes `count` vertices of `stride` bytes, a multiple of 4. None if the stream is damaged.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (header, rest) = stream.split_first()?;
    let (is_new, shortest_tail) = match header {
        0xa0 => (false, 32),
        0xa1 => (true, 24),
        _ => return None,
    };
    let own_tail = stride + if is_new { stride / 4 } else { 0 };
    let (mut data, tail) = rest.split_at_checked(rest.len().checked_sub(own_tail.max(shortest_tail))?)?;
    let (mut before, modes) = tail[tail.len() - own_tail..].split_at(stride);
    let channels: Vec<Channel> = match is_new {
        true => modes.iter().map(|mode| Channel::of(*mode)).collect::<Option<_>>()?,
        false => vec![Channel::Bytes; stride / 4],
    };
    let block = (8192 / stride / GROUP * GROUP).min(BLOCK);
    // The header of each block takes this much at least, so that memory is in proportion to the stream.
    let least = if is_new { stride / 4 * count.div_ceil(block) } else { stride * count.div_ceil(4 * GROUP) };
    if data.len() < least {
        return None;
    }
    let mut decoded = vec![0; stride * count];
    let mut deltas = vec![0; stride * BLOCK];
    for vertices in decoded.chunks_mut(stride * block) {
        read_block(&mut data, &mut deltas, vertices.len() / stride, stride, is_new)?;
        for (k, vertex) in vertices.chunks_exact_mut(stride).enumerate() {
            for (c, channel) in channels.iter().enumerate() {
                let four = 4 * c..4 * c + 4;
                let delta = std::array::from_fn(|b| deltas[(4 * c + b) * BLOCK + k]);
                let old: [u8; 4] = before[four.clone()].try_into().ok()?;
                vertex[four].copy_from_slice(&channel.apply(old, delta));
            }
            before = vertex;
        }
    }
    data.is_empty().then_some(decoded)
}

/// Reads the differences of a block of vertices, each byte of the vertex apart.
fn read_block(data: &mut &[u8], deltas: &mut [u8], vertices: usize, stride: usize, is_new: bool) -> Option<()> {
    let groups = vertices.div_ceil(GROUP);
    let control = if is_new { data.split_off(..stride / 4)? } else { &[] };
    for (byte, column) in deltas.chunks_exact_mut(BLOCK).enumerate() {
        let column = &mut column[..groups * GROUP];
        let mode = control.get(byte / 4).map(|four| four >> (2 * (byte % 4)) & 3);
        // Bits of the differences for each mode of a group.
        let bits = match mode {
            None => [0, 2, 4, 8],
            Some(0) => [0, 1, 2, 4],
            Some(1) => [1, 2, 4, 8],
            Some(2) => {
                column.fill(0);
                continue;
            }
            Some(_) => {
                // Literal: a byte for each vertex, and none for the rest of the last group.
                column[..vertices].copy_from_slice(data.split_off(..vertices)?);
                continue;
            }
        };
        let header = data.split_off(..groups.div_ceil(4))?;
        for (g, group) in column.as_chunks_mut::<GROUP>().0.iter_mut().enumerate() {
            let mode = header[g / 4] >> (2 * (g % 4)) & 3;
            *group = read_group(data, bits[usize::from(mode)])?;
        }
    }
    Some(())
}

/// Reads sixteen differences of so many bits. Those with all bits set follow as bytes.
fn read_group(data: &mut &[u8], bits: usize) -> Option<[u8; GROUP]> {
    let mut group = [0; GROUP];
    if bits == 0 {
        return Some(group);
    }
    let packed = data.split_off(..GROUP * bits / 8)?;
    let (per_byte, all) = (8 / bits, (0xff >> (8 - bits)) as u8);
    for (k, delta) in group.iter_mut().enumerate() {
        // The first is in the highest bits, but for single bits.
        let place = if bits == 1 { k % 8 } else { per_byte - 1 - k % per_byte };
        *delta = packed[k / per_byte] >> (bits * place) & all;
        if bits < 8 && *delta == all {
            *delta = *data.split_off_first()?;
        }
    }
    Some(group)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty vertices of eight bytes: a number in float32 that grows and changes its sign, and one that jumps. The
    /// streams are those that the encoder of meshoptimizer 1.x (from npm) makes of them in versions 0 and 1.
    const STREAMS: [&str; 2] = [
        "a00004ff000000ffffffff0700ffbfffd090886874444c543a32363aff0000003c2222260533cf3cf3fdfdfffdfffffffdffffcf\
         000000ffffff00000700281728171728171728172817172817ff0000001728172800000000000000000000000000000000000000\
         0000000000000000803d00000040",
        "a1796a0511451451450000000000400050b088b8944cdc7cca76de4ec523672f01374c40c00703ff030100010205753575357535\
         750f000305070500000000000000000000000000000000803d000000401262",
    ];

    fn bytes(hex: &str) -> Vec<u8> {
        let digit = |k: usize| u8::from_str_radix(&hex[k..k + 2], 16).expect("a byte");
        (0..hex.len()).step_by(2).map(digit).collect()
    }

    fn vertices() -> Vec<u8> {
        let vertex = |k: u32| {
            let sign = if k.is_multiple_of(3) { 1.0 } else { -1.0 };
            let number = sign * (k * k + 1) as f32 / 16.0;
            [number.to_le_bytes(), (0x4000_0000 + (((k * 5) & 7) << 18)).to_le_bytes()].concat()
        };
        (0..20).flat_map(vertex).collect()
    }

    /// Seen to catch: a turned channel turned the other way; differences of a byte in the other order.
    #[test]
    fn streams_of_both_versions() {
        for stream in STREAMS {
            assert_eq!(decode(&bytes(stream), 20, 8), Some(vertices()));
        }
    }

    /// The specification's example of a group.
    ///
    /// Seen to catch: differences of a byte in the other order.
    #[test]
    fn a_group_of_four_bits() {
        let mut data = &[0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5][..];
        let group = read_group(&mut data, 4).expect("ten bytes");
        let signed = group.map(|v| (if v & 1 == 0 { v >> 1 } else { !(v >> 1) }) as i8);
        assert_eq!(signed, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
        assert!(data.is_empty());
    }

    /// A stream that is cut, too long, of an unknown version or with an unknown channel is damaged, and so is one of
    /// too many vertices, before memory is taken for them.
    ///
    /// Seen to catch: bytes left over.
    #[test]
    fn damaged_streams() {
        for stream in STREAMS.map(bytes) {
            for length in 0..stream.len() {
                assert_eq!(decode(&stream[..length], 20, 8), None, "{length}");
            }
            assert_eq!(decode(&[&stream[..], &[0]].concat(), 20, 8), None);
            assert_eq!(decode(&stream, 1 << 40, 8), None);
            let [mut unknown, mut channel] = [stream.clone(), stream];
            unknown[0] = 0xa2;
            assert_eq!(decode(&unknown, 20, 8), None);
            if channel[0] == 0xa1 {
                *channel.last_mut().expect("a byte") = 3;
                assert_eq!(decode(&channel, 20, 8), None);
            }
        }
    }
}
