//! Checks that a JPEG file is complete: decoders silently pad missing data with gray. All coded coefficients of every
//! scan are decoded, and their values are dropped (ITU-T T.81, annexes B, F and G).

use huffman::{Bits, DAMAGED, EARLY, Result, Table, next_marker};
use std::array;

mod huffman;

/// Most scans. More have no use, and each takes the time of the whole picture.
const MAX_SCANS: usize = 100;

/// Refuses a file whose data ends early or is damaged. Files without Huffman coding are left to the decoder.
pub(super) fn check(bytes: &[u8]) -> Result<()> {
    let mut file = File::default();
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8]).ok_or(DAMAGED)?;
    let mut scans = 0;
    loop {
        let (marker, after) = next_marker(rest)?;
        if marker == 0xd9 {
            let seen = file.components.iter().all(|c| c.seen);
            return if seen && !file.components.is_empty() { Ok(()) } else { Err(EARLY) };
        }
        if matches!(marker, 0x01 | 0xd0..=0xd8) {
            rest = after;
            continue;
        }
        let (size, _) = after.split_first_chunk().ok_or(EARLY)?;
        let (segment, after) = after.split_at_checked(usize::from(u16::from_be_bytes(*size))).ok_or(EARLY)?;
        let segment = segment.get(2..).ok_or(DAMAGED)?;
        rest = after;
        match marker {
            0xc0..=0xc2 => file.frame(segment, marker == 0xc2).ok_or(DAMAGED)?,
            0xc4 => file.tables(segment).ok_or(DAMAGED)?,
            0xc3 | 0xc5..=0xcf => return Ok(()),
            0xdd => file.interval = usize::from(u16::from_be_bytes(*segment.first_chunk().ok_or(DAMAGED)?)),
            0xda => {
                scans += 1;
                let scan = file.scan(segment).filter(|_| scans <= MAX_SCANS).ok_or(DAMAGED)?;
                rest = file.walk(&scan, rest)?;
            }
            _ => {}
        }
    }
}

/// The state of a file between scans.
#[derive(Default)]
struct File {
    size: [usize; 2],
    progressive: bool,
    components: Vec<Component>,
    /// Tables of the first coefficient and of the others, by number.
    tables: [[Option<Table>; 4]; 2],
    /// MCUs between restarts, 0 for none.
    interval: usize,
}

struct Component {
    id: u8,
    /// Blocks in an MCU, across and down.
    sampling: [usize; 2],
    /// Blocks in a row of memory.
    stride: usize,
    /// The nonzero coefficients of each block, for progressive files.
    nonzero: Vec<u64>,
    seen: bool,
}

/// A scan: its components with the numbers of their tables, and the range of its coefficients.
struct Scan {
    parts: Vec<(usize, [usize; 2])>,
    first: u32,
    last: u32,
    refines: bool,
}

impl File {
    fn frame(&mut self, segment: &[u8], progressive: bool) -> Option<()> {
        let ([_, y1, y0, x1, x0, count], list) = segment.split_first_chunk()?;
        let size = [[*x1, *x0], [*y1, *y0]].map(|b| usize::from(u16::from_be_bytes(b)));
        let list = list.get(..3 * usize::from(*count))?.as_chunks::<3>().0;
        let sampling = |[_, s, _]: &[u8; 3]| [usize::from(s >> 4), usize::from(s & 15)];
        let usable = list.iter().flat_map(sampling).all(|s| (1..=4).contains(&s));
        if !usable || list.is_empty() || size.contains(&0) || !self.components.is_empty() {
            return None;
        }
        let max: [usize; 2] = array::from_fn(|d| list.iter().map(|c| sampling(c)[d]).max().unwrap_or(1));
        let mcus: [usize; 2] = array::from_fn(|d| size[d].div_ceil(8 * max[d]));
        let component = |c: &[u8; 3]| {
            let [across, down] = sampling(c);
            let stride = mcus[0] * across;
            let blocks = if progressive { stride * mcus[1] * down } else { 0 };
            Component { id: c[0], sampling: [across, down], stride, nonzero: vec![0; blocks], seen: false }
        };
        self.components = list.iter().map(component).collect();
        (self.size, self.progressive) = (size, progressive);
        Some(())
    }

    fn tables(&mut self, mut segment: &[u8]) -> Option<()> {
        while let Some((kind, rest)) = segment.split_first() {
            let (counts, rest) = rest.split_first_chunk::<16>()?;
            let total = counts.iter().map(|n| usize::from(*n)).sum();
            let (symbols, rest) = rest.split_at_checked(total)?;
            let table = self.tables.get_mut(usize::from(kind >> 4))?.get_mut(usize::from(kind & 15))?;
            *table = Some(Table::new(counts, symbols)?);
            segment = rest;
        }
        Some(())
    }

    fn scan(&mut self, segment: &[u8]) -> Option<Scan> {
        let (count, rest) = segment.split_first()?;
        let (list, rest) = rest.split_at_checked(2 * usize::from(*count))?;
        let [first, last, approximation] = *rest.first_chunk()?;
        let part = |pair: &[u8; 2]| {
            let index = self.components.iter().position(|c| c.id == pair[0])?;
            Some((index, [usize::from(pair[1] >> 4), usize::from(pair[1] & 15)]))
        };
        let parts: Vec<_> = list.as_chunks::<2>().0.iter().map(part).collect::<Option<_>>()?;
        let (first, last) = if self.progressive { (first, last) } else { (0, 63) };
        let good = match first {
            0 => !self.progressive || last == 0,
            _ => first <= last && last < 64 && parts.len() == 1,
        };
        parts.iter().filter(|_| first == 0).for_each(|(index, _)| self.components[*index].seen = true);
        let refines = self.progressive && approximation >> 4 != 0;
        (good && !parts.is_empty()).then_some(Scan { parts, first: first.into(), last: last.into(), refines })
    }

    /// Decodes the data of a scan, and returns the bytes after it.
    fn walk<'a>(&mut self, scan: &Scan, data: &'a [u8]) -> Result<&'a [u8]> {
        let mut bits = Bits::new(data);
        let mcus = self.mcus(scan);
        let mut run = 0;
        for mcu in 0..mcus[0] * mcus[1] {
            if self.interval > 0 && mcu > 0 && mcu % self.interval == 0 {
                bits.restart(mcu / self.interval - 1)?;
                run = 0;
            }
            for (index, tables) in &scan.parts {
                // The blocks of a single component are coded one by one.
                let [across, down] = if scan.parts.len() > 1 { self.components[*index].sampling } else { [1, 1] };
                for block in 0..across * down {
                    let x = mcu % mcus[0] * across + block % across;
                    let y = mcu / mcus[0] * down + block / across;
                    self.block(&mut bits, scan, *index, *tables, [x, y], &mut run)?;
                }
            }
        }
        bits.end()
    }

    /// MCUs of a scan, across and down.
    fn mcus(&self, scan: &Scan) -> [usize; 2] {
        let max = |d: usize| self.components.iter().map(|c| c.sampling[d]).max().unwrap_or(1);
        array::from_fn(|d| match scan.parts[..] {
            [(index, _)] => (self.size[d] * self.components[index].sampling[d]).div_ceil(8 * max(d)),
            _ => self.size[d].div_ceil(8 * max(d)),
        })
    }

    fn block(
        &mut self,
        bits: &mut Bits,
        scan: &Scan,
        index: usize,
        [dc, ac]: [usize; 2],
        [x, y]: [usize; 2],
        run: &mut u32,
    ) -> Result<()> {
        let table = |class: usize, number: usize| self.tables[class].get(number)?.as_ref();
        if scan.first == 0 {
            let size = if scan.refines { 1 } else { u32::from(bits.decode(table(0, dc))?) };
            bits.skip(size)?;
        }
        let component = &mut self.components[index];
        match (self.progressive, scan.first) {
            (false, _) => sequential(bits, table(1, ac)),
            (true, 0) => Ok(()),
            _ => {
                let nonzero = component.nonzero.get_mut(y * component.stride + x).ok_or(DAMAGED)?;
                let step = if scan.refines { refine } else { first_pass };
                step(bits, table(1, ac), scan, nonzero, run)
            }
        }
    }
}

/// Decodes the other coefficients of a block (F.2.2.2).
fn sequential(bits: &mut Bits, table: Option<&Table>) -> Result<()> {
    let mut k = 1;
    while k < 64 {
        let symbol = u32::from(bits.decode(table)?);
        match (symbol >> 4, symbol & 15) {
            (15, 0) => k += 16,
            (_, 0) => break,
            (zeros, size) => {
                k += zeros;
                if k > 63 {
                    return Err(DAMAGED);
                }
                bits.skip(size)?;
                k += 1;
            }
        }
    }
    Ok(())
}

/// Decodes the first bits of the coefficients of a block; `run` counts blocks without any (G.1.2.2).
fn first_pass(bits: &mut Bits, table: Option<&Table>, scan: &Scan, nonzero: &mut u64, run: &mut u32) -> Result<()> {
    if *run > 0 {
        *run -= 1;
        return Ok(());
    }
    let mut k = scan.first;
    while k <= scan.last {
        let symbol = u32::from(bits.decode(table)?);
        match (symbol >> 4, symbol & 15) {
            (15, 0) => k += 16,
            (power, 0) => {
                *run = (1 << power) - 1 + bits.take(power)?;
                break;
            }
            (zeros, size) => {
                k += zeros;
                if k > 63 {
                    return Err(DAMAGED);
                }
                bits.skip(size)?;
                *nonzero |= 1 << k;
                k += 1;
            }
        }
    }
    Ok(())
}

/// Decodes one more bit of the nonzero coefficients, and those that become nonzero (G.1.2.3).
fn refine(bits: &mut Bits, table: Option<&Table>, scan: &Scan, nonzero: &mut u64, run: &mut u32) -> Result<()> {
    let mut k = scan.first;
    while *run == 0 && k <= scan.last {
        let symbol = u32::from(bits.decode(table)?);
        let (mut zeros, size) = (symbol >> 4, symbol & 15);
        match size {
            0 if zeros < 15 => {
                *run = (1 << zeros) + bits.take(zeros)?;
                break;
            }
            0 => {}
            _ => bits.skip(1)?,
        }
        while k <= scan.last {
            if *nonzero >> k & 1 == 1 {
                bits.skip(1)?;
            } else if zeros == 0 {
                break;
            } else {
                zeros -= 1;
            }
            k += 1;
        }
        if size > 0 {
            if k > scan.last {
                return Err(DAMAGED);
            }
            *nonzero |= 1 << k;
        }
        k += 1;
    }
    if *run > 0 {
        let left = if k <= scan.last { *nonzero >> k << k & (u64::MAX >> (63 - scan.last)) } else { 0 };
        bits.skip(left.count_ones())?;
        *run -= 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
