//! Huffman codes of JPEG data, and its markers.

pub(super) type Result<T> = std::result::Result<T, &'static str>;

pub(super) const EARLY: &str = "its JPEG data ends early";
pub(super) const DAMAGED: &str = "its JPEG data is damaged";

/// Codes of up to this many bits are found by one lookup.
const LOOKUP_BITS: u32 = 9;

/// The next marker, and the bytes after it.
pub(super) fn next_marker(bytes: &[u8]) -> Result<(u8, &[u8])> {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff);
    let at = bytes.windows(2).position(is_marker).ok_or(EARLY)?;
    Ok((bytes[at + 1], &bytes[at + 2..]))
}

/// A table of Huffman codes.
pub(super) struct Table {
    /// Length and symbol of a code by the next bits; length 0 for a longer code.
    short: Vec<(u8, u8)>,
    /// By length: the first longer code, left-aligned to 16 bits, and the index of a symbol minus its code.
    limits: [(u32, i32); 17],
    symbols: Vec<u8>,
}

impl Table {
    /// Table of `counts` codes of each length from 1, in the order of their symbols (annex C).
    pub fn new(counts: &[u8; 16], symbols: &[u8]) -> Option<Table> {
        let mut table =
            Table { short: vec![(0, 0); 1 << LOOKUP_BITS], limits: [(0, 0); 17], symbols: symbols.to_vec() };
        let (mut code, mut index) = (0_u32, 0_usize);
        for (length, count) in (1_u32..).zip(counts) {
            table.limits[length as usize].1 = index as i32 - code as i32;
            for _ in 0..*count {
                if length <= LOOKUP_BITS {
                    let spare = LOOKUP_BITS - length;
                    let entries = table.short.get_mut((code << spare) as usize..((code + 1) << spare) as usize)?;
                    entries.fill((length as u8, *symbols.get(index)?));
                }
                (code, index) = (code + 1, index + 1);
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

/// The bits of a scan up to the next marker.
pub(super) struct Bits<'a> {
    rest: &'a [u8],
    /// The next bits, left-aligned.
    buffer: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    pub fn new(rest: &'a [u8]) -> Bits<'a> {
        Bits { rest, buffer: 0, count: 0 }
    }

    /// Fills the buffer with at least 49 bits, or with all that are left.
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

    pub fn skip(&mut self, count: u32) -> Result<()> {
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

    pub fn take(&mut self, count: u32) -> Result<u32> {
        self.fill();
        let value = if count == 0 { 0 } else { self.buffer >> (64 - count) };
        self.skip(count)?;
        Ok(value as u32)
    }

    pub fn decode(&mut self, table: Option<&Table>) -> Result<u8> {
        let table = table.ok_or(DAMAGED)?;
        self.fill();
        let (length, symbol) = table.short[(self.buffer >> (64 - LOOKUP_BITS)) as usize];
        if length > 0 {
            self.skip(length.into())?;
            return Ok(symbol);
        }
        let next = (self.buffer >> 48) as u32;
        let length = (1..=16).find(|length| next < table.limits[*length as usize].0);
        // Missing bits read as zeros, which may be a code; all ones are no code.
        let length = length.ok_or(if self.count < 16 { EARLY } else { DAMAGED })?;
        let index = (next >> (16 - length)) as i32 + table.limits[length as usize].1;
        self.skip(length)?;
        usize::try_from(index).ok().and_then(|index| table.symbols.get(index)).copied().ok_or(DAMAGED)
    }

    /// Continues after the restart marker of this number, counted from 0.
    pub fn restart(&mut self, number: usize) -> Result<()> {
        let rest = self.end()?;
        let (marker, after) = next_marker(rest)?;
        if usize::from(marker) != 0xd0 + number % 8 {
            return Err(if marker == 0xd9 { EARLY } else { DAMAGED });
        }
        *self = Bits::new(after);
        Ok(())
    }

    /// The bytes after the data, from a marker on. Only the rest of a byte and fill bytes may come before it.
    pub fn end(&mut self) -> Result<&'a [u8]> {
        let whole = self.count / 8;
        let filler = (0..whole).all(|k| matches!((self.buffer << (self.count % 8) >> (56 - 8 * k)) as u8, 0 | 0xff));
        let at = self.rest.iter().position(|byte| !matches!(byte, 0 | 0xff)).ok_or(EARLY)?;
        if !filler || at == 0 || self.rest[at - 1] != 0xff {
            return Err(DAMAGED);
        }
        Ok(&self.rest[at - 1..])
    }
}
