//! Mode 1: a list of triangles, most of which share an edge with a recent one.

use super::{unzigzag, varint};

/// The last sixteen of a sequence. The specification leaves open what is there at the start.
struct Recent<T> {
    ring: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Recent { ring: [T::default(); 16], next: 0 }
    }

    fn push(&mut self, item: T) {
        self.ring[self.next % 16] = item;
        self.next = self.next.wrapping_add(1);
    }

    /// The item that was pushed `k` pushes before the last.
    fn get(&self, k: usize) -> T {
        self.ring[self.next.wrapping_sub(1 + k) % 16]
    }
}

/// The state of the decoder, in the terms of the specification.
struct Decoder<'a> {
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    /// The next index that no triangle had yet.
    next: u32,
    /// The last index that was given by its value.
    last: u32,
    data: &'a [u8],
}

/// Decodes `count` triangles. None if the stream is damaged.
pub(super) fn decode(stream: &[u8], count: usize) -> Option<Vec<[u32; 3]>> {
    const HEADER: u8 = 0xe1;
    let (&HEADER, rest) = stream.split_first()? else { return None };
    let (rest, table) = rest.split_last_chunk::<16>()?;
    let is_sound = table[14..] == [0; 2] && table.iter().all(|b| b >> 4 != 15 && b & 15 != 15);
    if count > rest.len() || !is_sound {
        return None;
    }
    let (codes, data) = rest.split_at(count);
    let (edges, vertices) = (Recent::new(), Recent::new());
    let mut decoder = Decoder { edges, vertices, next: 0, last: 0, data };
    let triangles = codes.iter().map(|code| decoder.triangle(*code, table)).collect::<Option<Vec<_>>>()?;
    decoder.data.is_empty().then_some(triangles)
}

impl Decoder<'_> {
    fn triangle(&mut self, code: u8, table: &[u8; 16]) -> Option<[u32; 3]> {
        let (high, low) = (usize::from(code >> 4), code & 15);
        match (high, low) {
            (15, 14 | 15) => self.explicit(low == 15),
            (15, _) => self.three(false, table[usize::from(low)], false),
            _ => self.beside(high, low),
        }
    }

    /// A triangle at a recent edge.
    fn beside(&mut self, edge: usize, low: u8) -> Option<[u32; 3]> {
        let [a, b] = self.edges.get(edge);
        let c = match low {
            0 => self.new_index(),
            13 | 14 => {
                self.last = if low == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            15 => self.given()?,
            _ => self.vertices.get(usize::from(low)),
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..=12).contains(&low) {
            self.vertices.push(c);
        }
        Some([a, b, c])
    }

    /// A triangle whose sources are a byte of the data.
    fn explicit(&mut self, first_is_given: bool) -> Option<[u32; 3]> {
        let sources = *self.data.split_off_first()?;
        if sources == 0 {
            self.next = 0;
        }
        self.three(first_is_given, sources, true)
    }

    /// Three indices. The nibbles of `sources` say where the second and the third come from; 15 is a given one, if
    /// there are such.
    fn three(&mut self, first_is_given: bool, sources: u8, may_give: bool) -> Option<[u32; 3]> {
        let a = if first_is_given { self.given()? } else { self.new_index() };
        let [z, w] = [usize::from(sources >> 4), usize::from(sources & 15)];
        let mut index = |source: usize| match source {
            0 => Some(self.new_index()),
            15 if may_give => self.given(),
            _ => Some(self.vertices.get(source - 1)),
        };
        let (b, c) = (index(z)?, index(w)?);
        [[b, a], [c, b], [a, c]].into_iter().for_each(|edge| self.edges.push(edge));
        self.vertices.push(a);
        for (source, vertex) in [(z, b), (w, c)] {
            if source == 0 || source == 15 {
                self.vertices.push(vertex);
            }
        }
        Some([a, b, c])
    }

    fn new_index(&mut self) -> u32 {
        let index = self.next;
        self.next = index.wrapping_add(1);
        index
    }

    fn given(&mut self) -> Option<u32> {
        self.last = self.last.wrapping_add(unzigzag(varint(&mut self.data)?));
        Some(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(codes: &[u8], data: &[u8], table: [u8; 16]) -> Vec<u8> {
        [&[0xe1], codes, data, &table].concat()
    }

    /// Each kind of code, followed by hand along the specification.
    ///
    /// Seen to catch: the edges of a triangle pushed in another order.
    #[test]
    fn every_kind_of_code() {
        let mut table = [0; 16];
        table[1] = 0x10; // b is the most recent vertex, c is new.
        // New 0, 1, 2; beside the edge (0, 2) a new 3; beside (0, 3) the vertex before the last, 2; a table triangle.
        let codes = [0xf0, 0x00, 0x01, 0xf1];
        let list = decode(&stream(&codes, &[], table), 4).expect("a good stream");
        assert_eq!(list, [[0, 1, 2], [0, 2, 3], [0, 3, 2], [4, 3, 5]]);
        // Given: 7, then from it 6 and 9; one less and one more than the last beside the edge (7, 9).
        let (codes, data) = ([0xff, 0x0d, 0x0e, 0x0f], [0xff, 14, 1, 6, 2]);
        let list = decode(&stream(&codes, &data, [0; 16]), 4).expect("a good stream");
        assert_eq!(list, [[7, 6, 9], [7, 9, 8], [7, 8, 9], [7, 9, 10]]);
        // The sequence of new indices starts again.
        let list = decode(&stream(&[0xf0, 0xfe], &[0], [0; 16]), 2).expect("a good stream");
        assert_eq!(list, [[0, 1, 2]; 2]);
    }

    /// Nine triangles as the encoder of meshoptimizer 1.x (from npm) writes them. It may turn their corners.
    #[test]
    fn a_stream_of_the_encoder() {
        let codes = [0xf0, 0x10, 0x10, 0x00, 0xff, 0x15, 0xff, 0xff, 0xff];
        let data = [0xff, 0x12, 0x01, 0x01, 0x83, 0x0d, 0xff, 0x28, 0x02, 0x02, 0xfb, 0x21, 0x32];
        let table = [0, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9, 0x86, 0x65, 0x89, 0x68, 0x98, 0x01, 0x69, 0, 0];
        let expected: [[u32; 3]; 9] =
            [[0, 1, 2], [2, 1, 3], [3, 1, 4], [4, 5, 3], [9, 8, 7], [7, 8, 3], [0, 1, 9], [20, 21, 22], [5, 30, 2]];
        let list = decode(&stream(&codes, &data, table), 9);
        let turned = list.into_iter().flatten().zip(expected).map(|(a, b)| {
            (0..3).find(|k| [a[*k], a[(k + 1) % 3], a[(k + 2) % 3]] == b).unwrap_or_else(|| panic!("{a:?} {b:?}"))
        });
        assert_eq!(turned.count(), 9);
    }

    /// Seen to catch: bytes left over.
    #[test]
    fn damaged_streams() {
        let mut bad = [0; 16];
        bad[3] = 0xf0;
        let cases = [
            stream(&[0xf0], &[1], [0; 16]),
            stream(&[0xff], &[], [0; 16]),
            stream(&[], &[], [0; 16]),
            stream(&[0xf0], &[], bad),
            stream(&[0xf0], &[], [1; 16]),
            vec![0xe1],
            Vec::new(),
            [&[0xd1, 0xf0][..], &[0; 16]].concat(),
        ];
        for bytes in cases {
            assert_eq!(decode(&bytes, 1), None, "{bytes:?}");
        }
    }
}
