//! Prisms: solids of glass that a batch passes ray by ray.

use super::Tracer;
use super::program::LossAccount;
use super::route::Leg;
use super::run::book;
use super::work::{Work, columns};
use crate::transmission::weigh_polarized;
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::Polarization;
use spectra_core::loss::ALIVE;
use spectra_lens::coating::Amplitudes;
use spectra_lens::solid::FaceEvent;

impl Tracer {
    /// Takes a batch through a prism, ray by ray.
    pub(super) fn pass_prism(&self, rays: &mut RayBatch, work: &mut Work, leg: &Leg, step: usize) -> usize {
        let element = &self.elements[leg.at];
        let Some(solid) = &element.solid else { return 0 };
        let (number, shift_mm) = (leg.number(), leg.shift_mm());
        let len = rays.len();
        let n = columns(&work.media[leg.before], len).n;
        let inside = columns(&work.media[solid.medium], len).n;
        let absorption = self.absorptions.as_ref().and_then(|all| Some((all, all.table_of(solid.medium)?)));
        let weighs = work.before.is_some();
        let mut paths: Vec<(usize, f64)> = Vec::with_capacity(len);
        let (mut ended, mut clear, mut mirrors) = (0, vec![1.0; len], vec![1.0; len]);
        let coating = (&Amplitudes::of(&self.solid_coatings[leg.at]), element.reflectance);
        // Light keeps its polarization from face to face, whether the batch carries it or not.
        let mut own: [Vec<f64>; 6] =
            if rays.is_polarized() { Default::default() } else { std::array::from_fn(|_| vec![0.0; len]) };
        let mut c = rays.columns_mut();
        let polarization = if c.polarization.is_empty() {
            let [q, u, v, ax, ay, az] = own.each_mut().map(|column| &mut column[..]);
            &mut Polarization { q, u, v, axis: [ax, ay, az] }
        } else {
            &mut c.polarization
        };
        for i in 0..len {
            if c.state[i] != ALIVE {
                continue;
            }
            let from = DVec3::new(c.x[i], c.y[i], c.z[i] - shift_mm);
            let way = DVec3::new(c.l[i], c.m[i], c.n[i]);
            let nm = c.wavelength_nm[i];
            let passed = solid.pass(from, way, inside[i] / n[i], |face| {
                if weighs {
                    let does = face.polarizes([n[i], inside[i]], nm, coating);
                    let across = face.direction.cross(face.normal).to_array();
                    let left = weigh_polarized(polarization, i, face.direction.to_array(), across, does);
                    *(if face.bend == FaceEvent::Mirror { &mut mirrors[i] } else { &mut clear[i] }) *= left;
                }
            });
            match passed {
                Err(cause) => {
                    c.state[i] = cause.state(number);
                    ended += 1;
                }
                Ok(passed) => {
                    (c.x[i], c.y[i], c.z[i]) = passed.position.into();
                    (c.l[i], c.m[i], c.n[i]) = passed.direction.into();
                    if let Some((all, table)) = absorption.filter(|_| weighs) {
                        let per_mm = all.at(table, all.grid.place(nm));
                        mirrors[i] *= spectra_core::math::exp(-per_mm * passed.inside_mm);
                    }
                    // A batch that carries its optical path has a column of it.
                    paths.push((i, n[i] * passed.outside_mm + inside[i] * passed.inside_mm));
                }
            }
        }
        let weighing = rays.weight_columns();
        if !weighing.optical_path_mm.is_empty() {
            paths.iter().for_each(|(i, path)| weighing.optical_path_mm[*i] += path);
        }
        if leg.turns {
            // A prism as a whole reflects nothing back.
            weighing.weight.fill(0.0);
        }
        // What mirrors and glass absorb, then what faces reflect.
        for (own, account) in [(&mirrors, LossAccount::Absorbed), (&clear, LossAccount::Elsewhere)] {
            rays.weight_columns().weight.iter_mut().zip(own).for_each(|(weight, left)| *weight *= left);
            book(rays, work, step, account);
        }
        ended
    }
}
