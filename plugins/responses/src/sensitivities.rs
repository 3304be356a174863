//! The response `sensitivities`: channels given by their spectral sensitivities.

use crate::picture::finish;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_core::params::{Deferred, Faults, Params, Positive, StageNode, Value};
use spectra_core::registry::Context;
use spectra_core::spectral::Channel;
use spectra_core::stage::Response;
use spectra_spectrum::{find_emission_in, find_sensitivity_in};
use std::collections::BTreeMap;

/// A detector is described by the spectral sensitivities of its channels.
///
/// Sensitivities are files beside the scene, bundled names, or spectra written out. A channel holds the integral of
/// irradiance times sensitivity, W m^-2 if the sensitivity has no unit. The picture shows three channels as red, green and
/// blue, and one channel as gray. For other numbers of channels, a `matrix` says how to make the picture.
///
/// # Example
/// ```yaml
/// kind: sensitivities
/// channels: {green: "rectangle:500,580", red: "rectangle:600,680", infrared: "rectangle:720,820"}
/// matrix: [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SensitivitiesParams {
    /// Map from the names of 1 to 64 channels to their sensitivities: each is a file beside the scene (`mine.csv`,
    /// `mine.csv#red`), a bundled name, or a spectrum written out (`gaussian:550,20`).
    pub channels: Deferred<BTreeMap<String, String>>,
    /// Matrix from the channels to linear red, green and blue (sRGB primaries) of the picture: three rows, each with one factor per
    /// channel. It applies to channels scaled to 1 in the light of `balance`.
    pub matrix: Option<Vec<Vec<f64>>>,
    /// Light in which every channel counts as 1, so that white is white; D65 if left out.
    pub balance: Option<String>,
    /// Irradiance by the light of `balance` that the picture shows as white, W m^-2 over the band (J m^-2 on a detector with an
    /// exposure time); automatic if left out.
    pub white: Option<Positive<f64>>,
}

/// Largest number of channels.
const MAX_CHANNELS: usize = 64;

/// A response with freely given channels and a matrix that makes the picture.
#[derive(Clone, Debug)]
pub struct Sensitivities {
    channels: Vec<Channel>,
    /// Rows of factors that turn the channels into linear red, green and blue.
    rgb_from_channels: [Vec<f64>; 3],
    white: Option<f64>,
}

impl Response for Sensitivities {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        let planes = exposure.planes(&self.channels)?;
        let sum = |row: &[f64], pixel: usize| -> f64 {
            row.iter().zip(&planes).map(|(factor, plane)| factor * f64::from(plane[pixel])).sum()
        };
        finish(exposure, self.white, wanted, |pixel| self.rgb_from_channels.each_ref().map(|row| sum(row, pixel)))
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Response>, Faults> {
    let p: SensitivitiesParams = params.parse()?;
    let mut faults = Faults::new();
    let channels = faults.take(channels(params, &p.channels, context));
    let light = p.balance.as_deref().unwrap_or("D65");
    let found = find_emission_in(light, context.resources);
    let light = faults.take(found.map_err(|e| e.faults(|text| params.fault("balance", text))));
    let (Some(channels), Some(light)) = (channels, light) else { return Err(faults) };
    let power = light.to_power(&context.grid);
    let total = power.seen_by(&vec![1.0; context.grid.count]);
    let rows = faults.take(rows(params, &p, &channels));
    let mut scale = Vec::new();
    for channel in &channels {
        let seen = power.seen_by(&channel.response);
        if !(seen > 0.0) {
            let key = format!("channels.{}", channel.name);
            faults.push(params.fault(&key, "it records none of the `balance` light").hint("choose another `balance`"));
        }
        // Scales the channel to the power of the light, so that it counts as 1 for each W m^-2.
        scale.push(total / seen);
    }
    let Some(rows) = faults.into_result(rows)? else { return Err(Faults::new()) };
    let rgb_from_channels = rows.map(|row| row.iter().zip(&scale).map(|(factor, s)| factor * s).collect());
    Ok(Box::new(Sensitivities { channels, rgb_from_channels, white: p.white.map(|w| w.get()) }))
}

/// Reads the channels, in the order of the scene.
fn channels(params: &Params, node: &StageNode, context: &Context<'_>) -> Result<Vec<Channel>, Faults> {
    let Value::Map(entries) = &node.node().value else {
        let fault = node.fault("a map of channels is expected here");
        return Err(fault.hint("write, for example, `{red: my-red.csv, green: \"gaussian:540,40\"}`").into());
    };
    if !(1..=MAX_CHANNELS).contains(&entries.len()) {
        let fault = node.fault(format!("`channels` has {} entries", entries.len()));
        return Err(fault.hint(format!("write 1 to {MAX_CHANNELS} channels")).into());
    }
    let mut faults = Faults::new();
    let mut channels = Vec::new();
    for (key, value) in entries {
        let name = &key.text;
        let fault = |text: String| value.fault(text).path(format!("{}.channels.{name}", params.path()));
        // The name becomes part of the channel's name in an EXR file, where a dot separates layers.
        let letter = |c: char| c.is_alphanumeric() || "-_".contains(c);
        if name.is_empty() || name.len() > 64 || !name.chars().all(letter) {
            faults
                .push(fault(format!("`{name}` is not a valid name of a channel")).hint("use letters, digits, - and _"));
            continue;
        }
        let Some(text) = value.as_str() else {
            faults.push(
                fault("a spectrum's name is expected here".into())
                    .hint("write, for example, my-red.csv or \"gaussian:540,40\""),
            );
            continue;
        };
        let found = find_sensitivity_in(text, context.resources).map_err(|e| e.faults(fault));
        let Some(sensitivity) = faults.take(found) else { continue };
        let response = sensitivity.on_grid(&context.grid);
        if response.iter().all(|v| *v == 0.0) {
            faults.push(fault(format!("`{text}` is zero in the whole band")));
        }
        channels.push(Channel { name: name.clone(), unit: "W.m^-2".into(), response });
    }
    faults.into_result(channels)
}

/// Returns the three rows of the matrix that makes the picture from the channels.
fn rows(params: &Params, p: &SensitivitiesParams, channels: &[Channel]) -> Result<[Vec<f64>; 3], Faults> {
    let count = channels.len();
    let unit = |of: usize| (0..count).map(|k| f64::from(u8::from(k == of))).collect::<Vec<f64>>();
    let Some(matrix) = &p.matrix else {
        return match count {
            1 => Ok([unit(0), unit(0), unit(0)]),
            3 => Ok([unit(0), unit(1), unit(2)]),
            _ => {
                let fault = params.fault("channels", format!("{count} channels need a `matrix` to make a picture"));
                Err(fault
                    .hint("give `matrix` three rows for red, green and blue, each with one factor per channel")
                    .into())
            }
        };
    };
    let [red, green, blue] = &matrix[..] else {
        let fault = params.fault("matrix", format!("`matrix` has {} rows", matrix.len()));
        return Err(fault.hint("write three rows, for red, green and blue").into());
    };
    for (i, row) in matrix.iter().enumerate() {
        if row.len() != count || row.iter().any(|v| !v.is_finite()) {
            let fault = params.fault(&format!("matrix[{i}]"), format!("{} factors for {count} channels", row.len()));
            return Err(fault.hint("write one finite factor per channel, in the order of `channels`").into());
        }
    }
    Ok([red.clone(), green.clone(), blue.clone()])
}

spectra_core::register!(response "sensitivities": SensitivitiesParams, build);
