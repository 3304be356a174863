//! Saves light to a file and loads it.

use crate::done::{Done, Units};
use crate::light::{EstimatorSums, Light};
use crate::renderer::Renderer;
use spectra_core::Loss;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};

/// First bytes of every light file; the last digit is the version of the format.
const MAGIC: &[u8; 16] = b"spectra light 7\n";

/// A stream of little-endian numbers followed by a checksum (64-bit FNV-1a by G. Fowler, L. C. Noll, K.-P. Vo, over words of eight bytes).
struct LightStream<T> {
    stream: T,
    check: u64,
}

impl<T> LightStream<T> {
    fn new(stream: T) -> Self {
        Self { stream, check: 0xcbf2_9ce4_8422_2325 }
    }

    fn mix(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut whole = [0; 8];
            whole[..word.len()].copy_from_slice(word);
            self.check = (self.check ^ u64::from_le_bytes(whole)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl<T: Write> LightStream<T> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.mix(bytes);
        self.stream.write_all(bytes)
    }

    fn number(&mut self, number: u64) -> io::Result<()> {
        self.put(&number.to_le_bytes())
    }
}

impl<T: Read> LightStream<T> {
    fn take<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.stream.read_exact(&mut bytes)?;
        self.mix(&bytes);
        Ok(bytes)
    }

    fn next(&mut self) -> io::Result<u64> {
        Ok(u64::from_le_bytes(self.take()?))
    }
}

impl Light {
    /// Writes the light, so that another process can continue the render.
    ///
    /// # Errors
    /// Returns the errors of the stream.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut form = LightStream::new(out);
        form.put(MAGIC)?;
        let losses: Vec<(u32, Loss, u64)> = self.losses.iter().collect();
        form.number(losses.len() as u64)?;
        for (surface, cause, rays) in losses {
            form.number(cause.state(surface))?;
            form.number(rays)?;
        }
        let metered = self.metered.as_deref().unwrap_or_default();
        form.number(u64::from(self.metered.is_some()) + metered.len() as u64)?;
        for value in metered.iter().flatten() {
            form.number(value.to_bits())?;
        }
        form.number(self.judged)?;
        form.number(u64::from(self.covers_frame))?;
        form.number(self.parts.len() as u64)?;
        for EstimatorSums { sums, share: _, done, rays, detected } in &self.parts {
            form.number(*rays)?;
            form.number(*detected)?;
            form.number(done.complete())?;
            let open = done.open().map(|(samples, units)| (samples.clone(), units.ranges().collect::<Vec<_>>()));
            let (samples, units) = open.unwrap_or_default();
            form.number(samples.start)?;
            form.number(samples.end)?;
            form.number(units.len() as u64)?;
            for range in units {
                form.number(range.start)?;
                form.number(range.end)?;
            }
            form.number(done.ended().len() as u64)?;
            for (tile, samples) in done.ended() {
                form.number(u64::from(*tile))?;
                form.number(*samples)?;
            }
            form.number(sums.cells() as u64)?;
            for cell in 0..sums.cells() {
                form.number(sums.get(cell) as u64)?;
            }
        }
        let check = form.check;
        form.number(check)
    }

    /// Reads light that [`Light::save`] wrote during a render of the same scene.
    ///
    /// # Errors
    /// Returns the errors of the stream, or [`io::ErrorKind::InvalidData`] if the data is not light, is damaged or belongs to another
    /// scene.
    pub fn load(renderer: &Renderer, from: &mut dyn Read) -> io::Result<Self> {
        /// Upper limit on the number of loss causes or pieces, which no render exceeds.
        const MANY: u64 = 1 << 24;
        /// Allowance for surfaces outside the lens: plates in front of the frame, and no surface at all.
        const FEW: u64 = 64;
        let bad = |text: &str| io::Error::new(io::ErrorKind::InvalidData, text.to_owned());
        let other = || bad("this light belongs to another scene");
        let mut form = LightStream::new(from);
        if form.take::<16>()? != *MAGIC {
            return Err(bad("this is not a light file, or it has another version"));
        }
        // Largest surface number that a loss may name, for the lens and what stands around it, along routes that go back and forth. A count
        // is allocated for each surface up to the last, so the number is checked first.
        let surfaces = 4 * renderer.scene().lens.elements.len() as u64 + FEW;
        let mut light = renderer.begin().map_err(|e| io::Error::new(io::ErrorKind::OutOfMemory, e.to_string()))?;
        let mut lost = 0_u64;
        for _ in 0..form.next()?.min(MANY) {
            let (state, rays) = (form.next()?, form.next()?);
            let (cause, surface) = Loss::of_state(state).filter(|_| state >> 8 <= surfaces).ok_or_else(other)?;
            lost = lost.checked_add(rays).ok_or_else(|| bad("this light is damaged"))?;
            light.losses.add(cause, surface, rays);
        }
        let of_meters = form.next()?;
        if of_meters > 1 + renderer.scene().meter_channels().len() as u64 {
            return Err(other());
        }
        if let Some(planes) = of_meters.checked_sub(1) {
            let pixels = renderer.scene().imager.size().pixels();
            let mut plane = || (0..pixels).map(|_| form.next().map(f64::from_bits)).collect::<io::Result<Vec<f64>>>();
            light.metered = Some((0..planes).map(|_| plane()).collect::<io::Result<_>>()?);
        }
        light.judged = form.next()?;
        light.covers_frame = form.next()? != 0;
        if form.next()? != light.parts.len() as u64 {
            return Err(other());
        }
        for part in &mut light.parts {
            part.rays = form.next()?;
            part.detected = form.next()?;
            let complete = form.next()?;
            let samples = form.next()?..form.next()?;
            let mut units = Units::default();
            for _ in 0..form.next()?.min(MANY) {
                let (begin, end) = (form.next()?, form.next()?);
                if begin >= end {
                    return Err(bad("this light is damaged"));
                }
                units.insert(begin..end);
            }
            let mut ended = BTreeMap::new();
            for _ in 0..form.next()?.min(MANY) {
                let (tile, samples) = (form.next()?, form.next()?);
                ended.insert(u32::try_from(tile).map_err(|_| other())?, samples);
            }
            part.done = Done::of(complete, (samples.start < samples.end).then_some((samples, units)), ended);
            let (saved, own, of_all) = (form.next()?, part.sums.cells() as u64, renderer.cells() as u64);
            if saved != own {
                return Err(match (saved / of_all, own / of_all) {
                    (0, _) => other(),
                    _ if saved % of_all != 0 => other(),
                    (saved, own) => bad(&format!(
                        "this light has separate sums for {} ghost paths, but this scene has {}; set `ghost-paths` to its earlier value",
                        saved - 1,
                        own - 1
                    )),
                });
            }
            for cell in 0..part.sums.cells() {
                part.sums.add(cell, form.next()? as i64);
            }
        }
        let check = form.check;
        if form.next()? == check { Ok(light) } else { Err(bad("this light is damaged")) }
    }
}
