//! The laws that every imager must obey.

use crate::film::check_channels;
use crate::test_numbers::TestNumbers;
use glam::DVec3;
use spectra_core::batch::pixel_and_channel;
use spectra_core::stage::{Imager, Launch, Receive};
use spectra_core::{Isa, RayBatch};

/// The laws of imagers, with the facts about an imager that are needed to check them.
///
/// - Its size is finite and above zero. Each channel has a unique name, a unit, and a response over the band that is finite, not
///   negative and not zero everywhere.
/// - Points launched from a pixel lie in that pixel and have a unit normal toward the lens.
/// - Light that returns along the way it was launched is received by the same pixel; light that passes beside the frame is lost.
/// - The result does not depend on how rays are split into batches, nor on the instruction set.
#[derive(Clone, Copy, Debug)]
pub struct ImagerLaws {
    /// Whether light goes straight to the pixels; glass plates and microlenses displace it.
    pub straight: bool,
    /// Whether the frame is flat and not tilted, so that its points lie where the frame's size puts them.
    pub flat: bool,
    /// Number of rays that are tried.
    pub rays: usize,
}

impl Default for ImagerLaws {
    /// Returns the laws of a flat frame with nothing in front of it.
    fn default() -> Self {
        Self { straight: true, flat: true, rays: 4000 }
    }
}

impl ImagerLaws {
    /// Checks all laws on an imager.
    ///
    /// # Panics
    /// At the first case that breaks a law; the message describes it.
    pub fn hold(&self, imager: &dyn Imager) {
        let size = imager.size();
        assert!(size.width_px > 0 && size.height_px > 0, "a frame of {} x {} pixels", size.width_px, size.height_px);
        assert!(
            [size.width_mm, size.height_mm].iter().all(|mm| *mm > 0.0 && mm.is_finite()),
            "a frame of {} mm x {} mm",
            size.width_mm,
            size.height_mm
        );
        let own = imager.response();
        if let Some(channels) = own.map(|own| own.channels()) {
            assert!(!channels.is_empty(), "it records by itself, but has no channels");
            check_channels(&channels);
        }
        if let Some(time) = own.and_then(|own| own.exposure_time_s()) {
            assert!(time > 0.0 && time.is_finite(), "its exposure time is {time} s");
        }
        assert!(imager.launch().is_some() || imager.receive().is_some(), "it neither launches nor receives rays");
        if let Some(launch) = imager.launch() {
            self.launches(imager, launch);
        }
        if let (Some(launch), Some(receive)) = (imager.launch(), imager.receive()) {
            self.receives_what_it_launches(imager, launch, receive);
        }
    }

    fn launched(&self, imager: &dyn Imager, launch: &dyn Launch, batch: usize, isa: Isa) -> Vec<(u32, DVec3, DVec3)> {
        let pixels = imager.size().pixels() as u64;
        let spread = TestNumbers::new(21);
        let (u, v) = (spread.column(self.rays, 0), spread.column(self.rays, 1));
        let mut out = Vec::new();
        for first in (0..self.rays).step_by(batch) {
            let upto = (first + batch).min(self.rays);
            let mut rays = RayBatch::new(upto - first).on(isa);
            rays.restart(upto - first);
            let c = rays.columns_mut();
            for (i, tag) in c.tag.iter_mut().enumerate() {
                // The first and the last pixel, which are corners, are among them.
                let ray = (first + i) as u64;
                *tag = if ray == 1 { pixels - 1 } else { ray * 7919 * 104_729 % pixels } as u32;
            }
            c.wavelength_nm.fill(550.0);
            launch.place(&mut rays, &u[first..upto], &v[first..upto]);
            let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
            out.extend(
                (0..rays.len())
                    .filter(|i| rays.loss(*i).is_none())
                    .map(|i| (rays.tags()[i], DVec3::new(x[i], y[i], z[i]), DVec3::new(l[i], m[i], n[i]))),
            );
        }
        out
    }

    fn launches(&self, imager: &dyn Imager, launch: &dyn Launch) {
        let size = imager.size();
        let want = self.launched(imager, launch, 256, Isa::Baseline);
        assert!(!want.is_empty(), "it launches no ray from any pixel");
        for (pixel, p, normal) in &want {
            assert!(p.is_finite(), "pixel {pixel} launches from {p} mm");
            assert!((normal.length() - 1.0).abs() < 1e-12, "pixel {pixel}: the normal {normal} is not a unit vector");
            assert!(normal.z < 0.0, "pixel {pixel}: the normal {normal} points away from the lens");
            if self.flat && self.straight {
                // On the edge of a pixel, rounding decides to which pixel a point belongs.
                let inward = DVec3::new(p.x, p.y, 0.0) * (1.0 - 1e-12);
                let found = size.pixel_at(inward.x, inward.y);
                let near = |a: u32| {
                    let (column, row) = (a % size.width_px, a / size.width_px);
                    let center = size.point_of(row * size.width_px + column, 0.5, 0.5);
                    let half = (
                        0.5 * size.width_mm / f64::from(size.width_px),
                        0.5 * size.height_mm / f64::from(size.height_px),
                    );
                    (p.x - center.0).abs() <= half.0 * (1.0 + 1e-9) && (p.y - center.1).abs() <= half.1 * (1.0 + 1e-9)
                };
                assert!(near(*pixel), "pixel {pixel} launches from ({}, {}) mm, where pixel {found:?} is", p.x, p.y);
            }
        }
        for (batch, isa) in
            [1, 100, 1024].map(|b| (b, Isa::Baseline)).into_iter().chain(Isa::available().into_iter().map(|i| (256, i)))
        {
            let got = self.launched(imager, launch, batch, isa);
            assert!(got == want, "points differ in batches of {batch} on {}", isa.name());
        }
    }

    fn receives_what_it_launches(&self, imager: &dyn Imager, launch: &dyn Launch, receive: &dyn Receive) {
        let spread = TestNumbers::new(22);
        let launched = self.launched(imager, launch, 256, Isa::detect());
        for isa in Isa::available() {
            let mut rays = RayBatch::new(launched.len()).on(isa);
            rays.restart(launched.len());
            let c = rays.columns_mut();
            for (i, (_, p, normal)) in launched.iter().enumerate() {
                let (a, b) = (spread.between(i, 0, -0.6, 0.6), spread.between(i, 1, -0.6, 0.6));
                let toward_lens = (*normal + a * DVec3::X + b * DVec3::Y).normalize();
                let far = spread.between(i, 2, 5.0, 200.0);
                let from = *p + far * toward_lens;
                (c.x[i], c.y[i], c.z[i]) = from.into();
                (c.l[i], c.m[i], c.n[i]) = (-toward_lens).into();
                c.wavelength_nm[i] = 550.0;
                c.tag[i] = u32::MAX;
            }
            receive.receive(&mut rays);
            let mut elsewhere = 0;
            let channels = imager.response().map_or(u32::MAX, |own| own.channels().len() as u32);
            for (i, (pixel, p, _)) in launched.iter().enumerate() {
                let Some((got, only)) = rays.loss(i).is_none().then(|| pixel_and_channel(rays.tags()[i])) else {
                    elsewhere += 1;
                    assert!(
                        !self.straight || is_at_edge(imager, *pixel, *p),
                        "light to {p} mm, in pixel {pixel}, is lost on {}",
                        isa.name()
                    );
                    continue;
                };
                assert!(
                    (got as usize) < imager.size().pixels(),
                    "light to {p} mm is received by pixel {got}, which does not exist"
                );
                assert!(
                    only.is_none_or(|only| only < channels),
                    "light to {p} mm goes to channel {only:?} of {channels}"
                );
                elsewhere += usize::from(got != *pixel);
                let same = got == *pixel || is_at_edge(imager, *pixel, *p);
                assert!(
                    !self.straight || same,
                    "light to {p} mm was launched from pixel {pixel} and is received by {got}"
                );
            }
            assert!(!self.straight || elsewhere * 100 <= launched.len(), "{elsewhere} rays end in another pixel");
        }
        // Light that passes far beside the frame.
        let size = imager.size();
        let aside =
            [(3.0, 0.0), (-3.0, 0.0), (0.0, 3.0), (0.0, -3.0)].map(|(a, b)| (a * size.width_mm, b * size.height_mm));
        let mut rays = RayBatch::new(aside.len());
        rays.restart(aside.len());
        let c = rays.columns_mut();
        for (i, (x, y)) in aside.into_iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = (x, y, -10.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
            c.wavelength_nm[i] = 550.0;
        }
        receive.receive(&mut rays);
        for (i, place) in aside.into_iter().enumerate() {
            let loss = rays.loss(i);
            assert!(!self.flat || loss.is_some(), "light that passes at {place:?} mm, beside the frame, is received");
        }
    }
}

/// Returns whether a place is so near the edge of its pixel that rounding may decide, or outside the area that the pixel has in a flat
/// frame.
fn is_at_edge(imager: &dyn Imager, pixel: u32, p: DVec3) -> bool {
    let size = imager.size();
    let center = size.point_of(pixel, 0.5, 0.5);
    let half = (0.5 * size.width_mm / f64::from(size.width_px), 0.5 * size.height_mm / f64::from(size.height_px));
    let inside = ((p.x - center.0).abs() / half.0).max((p.y - center.1).abs() / half.1);
    !(inside < 1.0 - 1e-6)
}
