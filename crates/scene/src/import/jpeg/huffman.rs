//! Huffman codes of JPEG data, and its markers.

use super::{DAMAGED, EARLY};

/// Codes of up to so many bits are looked up at once.
const LOOKUP_BITS: u32 = 9;

/// The next marker and what follows it.
pub(super) fn next_marker(bytes: &[u8]) -> Result<(u8, &[u8]), &'static str> {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff);
    let at = bytes.windows(2).position(is_marker).ok_or(EARLY)?;
    Ok((bytes[at + 1], &bytes[at + 2..]))
}

/// Huffman codes.
pub(super) struct Table {
    /// Length and symbol by the next bits; length 0 for longer codes.
    short: Vec<(u8, u8)>,
    /// By length: the first code that is longer, from the left of 16 bits, and what a code's place is off by.
    limits: [(u32, i32); 17],
    symbols: Vec<u8>,
}

impl Table {
    /// So many codes of each length from 1, in order (annex C).
    pub fn new(counts: &[u8; 16], symbols: &[u8]) -> Option<Table> {
        let mut table =
            Table { short: vec![(0, 0); 1 << LOOKUP_BITS], limits: [(0, 0); 17], symbols: symbols.to_vec() };
        let (mut code, mut place) = (0_u32, 0_usize);
        for (length, count) in (1_u32..).zip(counts) {
            table.limits[length as usize].1 = place as i32 - code as i32;
            for _ in 0..*count {
                if length <= LOOKUP_BITS {
                    let spare = LOOKUP_BITS - length;
                    let entries = table.short.get_mut((code << spare) as usize..((code + 1) << spare) as usize)?;
                    entries.fill((length as u8, *symbols.get(place)?));
                }
                (code, place) = (code + 1, place + 1);
            }
            if code > 1 << length {
                return None;
            }
            table.limits[length as usize].0 = code << (16 - length);
            code <<= 1;
        }
        Some(table)
    }
}

/// The bits of a scan, up to the next marker.
pub(super) struct Bits<'a> {
    rest: &'a [u8],
    /// The next bits, from the left.
    buffer: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    pub fn new(rest: &'a [u8]) -> Bits<'a> {
        Bits { rest, buffer: 0, count: 0 }
    }

    /// As many bits as there are, at least 49.
    fn fill(&mut self) {
        while self.count <= 48 {
            let (byte, used) = match self.rest {
                [0xff, 0, ..] => (0xff, 2),
                [0xff, ..] | [] => return,
                [byte, ..] => (*byte, 1),
            };
            self.buffer |= u64::from(byte) << (56 - self.count);
            self.count += 8;
            self.rest = &self.rest[used..];
        }
    }

    pub fn skip(&mut self, count: u32) -> Result<(), &'static str> {
        let mut left = count;
        loop {
            self.fill();
            let step = left.min(self.count).min(32);
            self.buffer <<= step;
            self.count -= step;
            left -= step;
            match left {
                0 => return Ok(()),
                _ if step == 0 => return Err(EARLY),
                _ => {}
            }
        }
    }

    pub fn take(&mut self, count: u32) -> Result<u32, &'static str> {
        self.fill();
        let value = if count == 0 { 0 } else { self.buffer >> (64 - count) };
        self.skip(count)?;
        Ok(value as u32)
    }

    pub fn decode(&mut self, table: Option<&Table>) -> Result<u8, &'static str> {
        let table = table.ok_or(DAMAGED)?;
        self.fill();
        let (length, symbol) = table.short[(self.buffer >> (64 - LOOKUP_BITS)) as usize];
        if length > 0 {
            self.skip(length.into())?;
            return Ok(symbol);
        }
        let next = (self.buffer >> 48) as u32;
        let length = (1..=16).find(|length| next < table.limits[*length as usize].0);
        // No code: what is missing reads as zeros, which may be one; ones are none.
        let length = length.ok_or(if self.count < 16 { EARLY } else { DAMAGED })?;
        let place = (next >> (16 - length)) as i32 + table.limits[length as usize].1;
        self.skip(length)?;
        usize::try_from(place).ok().and_then(|place| table.symbols.get(place)).copied().ok_or(DAMAGED)
    }

    /// Goes to what follows a restart marker of this number, counted from 0.
    pub fn restart(&mut self, number: usize) -> Result<(), &'static str> {
        let rest = self.end()?;
        let (marker, after) = next_marker(rest)?;
        if usize::from(marker) != 0xd0 + number % 8 {
            return Err(if marker == 0xd9 { EARLY } else { DAMAGED });
        }
        *self = Bits::new(after);
        Ok(())
    }

    /// What follows the data: a marker, after the rest of a byte and what fills.
    pub fn end(&mut self) -> Result<&'a [u8], &'static str> {
        let whole = self.count / 8;
        let filler = (0..whole).all(|k| matches!((self.buffer << (self.count % 8) >> (56 - 8 * k)) as u8, 0 | 0xff));
        let at = self.rest.iter().position(|byte| !matches!(byte, 0 | 0xff)).ok_or(EARLY)?;
        if !filler || at == 0 || self.rest[at - 1] != 0xff {
            return Err(DAMAGED);
        }
        Ok(&self.rest[at - 1..])
    }
}
