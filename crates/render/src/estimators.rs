//! Chooses the estimators of a scene.

use crate::backward::Backward;
use crate::estimator::Estimator;
use crate::forward::Forward;
use crate::ghosts::{Ghosts, LightLedger, MATTERS};
use crate::options::{GhostRays, Traced};
use crate::pipeline::{Pipeline, SourcePart};
use crate::veil::Veil;
use crate::{RenderError, Workers};
use spectra_scene::{Direction, LightKind, Lights};
use std::sync::Arc;

/// The estimators of a scene, one for each kind of light and direction.
#[derive(Default)]
pub(crate) struct Estimators {
    pub all: Vec<Box<dyn Estimator>>,
    /// Ledger of the light of the bright lights, if ghosts are traced.
    pub ledger: Option<LightLedger>,
    /// Whether the bright lights of the source are rendered separately from the rest.
    pub has_lights: bool,
}

impl Estimators {
    /// Makes the estimators for the light that is asked for.
    pub(crate) fn new(pipeline: &Arc<Pipeline>, traced: &Traced, workers: &dyn Workers) -> Result<Self, RenderError> {
        match traced {
            Traced::All => Self::of_all_light(pipeline, workers),
            Traced::Directions(directions) => {
                let mut own = Self::default();
                own.add_straight(pipeline, directions, workers)?;
                Ok(own)
            }
            Traced::Ghosts(rays) => {
                let mut own = Self::default();
                let share =
                    if pipeline.scene.source.split().is_some() { SourcePart::Lights } else { SourcePart::Whole };
                own.add_ghosts(&pipeline.of_share(share), None, *rays, workers)?;
                Ok(own)
            }
        }
    }

    fn of_all_light(pipeline: &Arc<Pipeline>, workers: &dyn Workers) -> Result<Self, RenderError> {
        let (scene, mut own) = (&pipeline.scene, Self::default());
        let (lights, order) = (scene.render.lights, scene.render.reflections.order);
        let pays = scene.source.split().map(|split| split.pays);
        let apart = lights != Lights::Same && pays.is_some_and(|pays| pays || lights == Lights::Forward);
        if apart {
            own.add_lights_and_rest(pipeline, order, workers)?;
        } else {
            own.add_straight(pipeline, &[scene.render.direction], workers)?;
            if order.unwrap_or(0) > 0 {
                // Ghosts of the bright lights, or of the whole source if no part of it is brighter than the rest.
                match scene.source.split() {
                    Some(_) => {
                        own.add_ghosts(&pipeline.of_share(SourcePart::Lights), None, GhostRays::default(), workers)?;
                    }
                    None => own.add_ghosts(pipeline, None, GhostRays::default(), workers)?,
                }
            }
        }
        own.add_glare(pipeline)?;
        Ok(own)
    }

    /// Adds the straight light in each direction, and the light that layers on the lens scatter.
    fn add_straight(
        &mut self,
        pipeline: &Arc<Pipeline>,
        directions: &[Direction],
        workers: &dyn Workers,
    ) -> Result<(), RenderError> {
        let scattered = pipeline.scattered()?.map(Arc::new);
        for pipeline in std::iter::once(pipeline).chain(&scattered) {
            for direction in directions {
                let pipeline = Arc::clone(pipeline);
                self.all.push(match direction {
                    Direction::Forward => Box::new(Forward::new(pipeline, workers)?),
                    Direction::Backward => Box::new(Backward::new(pipeline, workers)?),
                });
            }
        }
        Ok(())
    }

    /// Adds the bright lights forward, their ghosts, and the rest backward.
    fn add_lights_and_rest(
        &mut self,
        pipeline: &Arc<Pipeline>,
        order: Option<u32>,
        workers: &dyn Workers,
    ) -> Result<(), RenderError> {
        let share = |share| Arc::new(pipeline.of_share(share));
        let (of_lights, of_rest) = (share(SourcePart::Lights), share(SourcePart::Rest));
        let rest = Backward::new(of_rest.clone(), workers)?;
        let mean = rest.mean();
        self.all.push(Box::new(rest));
        self.all.push(Box::new(Forward::new(of_lights.clone(), workers)?));
        let threshold = if order.is_none() { Some(MATTERS * mean) } else { None };
        if order != Some(0) {
            self.add_ghosts(&of_lights, threshold, GhostRays::default(), workers)?;
        }
        if let (Some(rest), Some(lights)) = (of_rest.scattered()?, of_lights.scattered()?) {
            self.all.push(Box::new(Backward::new(Arc::new(rest), workers)?));
            self.all.push(Box::new(Forward::new(Arc::new(lights), workers)?));
        }
        self.has_lights = true;
        Ok(())
    }

    /// Adds the ghosts of a share of the light, if any are bright enough, and their ledger.
    fn add_ghosts(
        &mut self,
        pipeline: &Pipeline,
        threshold: Option<f64>,
        rays: GhostRays,
        workers: &dyn Workers,
    ) -> Result<(), RenderError> {
        if let Some(ghosts) = Ghosts::new(pipeline, threshold, rays, workers)? {
            self.ledger = Some(ghosts.ledger().clone());
            self.all.push(Box::new(ghosts));
        }
        Ok(())
    }

    /// Adds the veiling glare that the scene asks for: walks start at the source for the bright lights, and at the imager for the rest.
    fn add_glare(&mut self, pipeline: &Arc<Pipeline>) -> Result<(), RenderError> {
        let scene = &pipeline.scene;
        let Some(matter) = scene.render.glare else { return Ok(()) };
        // Ghosts may also be traced without being requested, because the lights are bright enough.
        let has_ghosts = self.all.iter().any(|estimator| estimator.light() == LightKind::Ghosts);
        let ghosts_order = if has_ghosts { scene.render.reflections.order.unwrap_or(2) } else { 0 };
        let emits = |split: &spectra_core::stage::Split<'_>| split.lights.emit().is_some();
        if scene.source.split().as_ref().is_some_and(emits) {
            let share = |share| Arc::new(pipeline.of_share(share));
            self.all.push(Box::new(Veil::new(share(SourcePart::Lights), true, ghosts_order, matter)?));
            self.all.push(Box::new(Veil::new(share(SourcePart::Rest), false, 0, matter)?));
        } else {
            let from_source = scene.render.direction == Direction::Forward;
            self.all.push(Box::new(Veil::new(Arc::clone(pipeline), from_source, ghosts_order, matter)?));
        }
        Ok(())
    }
}
