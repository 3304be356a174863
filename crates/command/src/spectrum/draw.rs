//! `spectra spectrum draw`: draws wavelengths of a light with a sampling strategy.

use super::arguments::{NumbersName, SpectrumDraw};
use super::{files, refuse_name, tell_reading};
use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_bench::{Strategy, parse_list};
use spectra_core::Isa;
use spectra_core::batch::CONTINUUM;
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::params::Params;
use spectra_core::registry::{Context, build};
use spectra_core::spectral::{Channel, Grid, SystemResponse};
use spectra_core::stage::WavelengthSampler;
use spectra_files::write_atomically;
use spectra_scene::yaml;
use spectra_spectrum::{find_emission_in, find_sensitivity_in};
use std::fmt::Write as _;
use std::io::Write as _;

/// Draws wavelengths of a light in the same way as a render, and writes each with its weight.
pub(crate) fn draw(arguments: &SpectrumDraw) -> Outcome {
    let grid = super::fit::grid(&arguments.band, 1.0)?;
    let resources = files();
    let name = &arguments.name;
    let light = find_emission_in(name, &resources).map_err(|error| refuse_name(name, error))?;
    tell_reading(name);
    let channel = channel(arguments, &grid)?;
    let system = SystemResponse { grid, source: light.to_power(&grid), channels: vec![channel].into() };
    let density = sampler(arguments, &grid)?
        .prepare(&system)
        .map_err(|why| Failure::Input(format!("`{}` cannot sample `{name}`: {why}", arguments.strategy)))?;
    let many = arguments.number as usize;
    let seed = arguments.seed;
    let numbers = match arguments.numbers {
        NumbersName::Random => Numbers::random(seed),
        NumbersName::Sobol => Numbers::sobol(seed),
        NumbersName::Lattice => Numbers::lattice(seed),
        NumbersName::Stratified => Numbers::stratified(seed, arguments.number),
    };
    let isa = Isa::detect();
    let (mut u, mut nm, mut line, mut weight) = (vec![0.0; many], vec![0.0; many], vec![0; many], vec![1.0; many]);
    numbers.fill_rotated(isa, 0, 0, density.group(), Dimension::Wavelength as u32, &mut u);
    density.draw(&u, &mut nm, &mut line, &mut weight, isa);
    let (source, response) = (&system.source, &system.channels[0].response);
    let light_at = |i: usize| match line[i] {
        CONTINUUM => grid.interpolate(&source.continuum, nm[i]),
        line => source.lines.get(line as usize).map_or(0.0, |line| line.power),
    };
    let rows = (0..many).map(|i| {
        let probability = if line[i] == CONTINUUM {
            density.density_per_nm(nm[i])
        } else {
            density.line_probability(line[i] as usize)
        };
        let number = (line[i] != CONTINUUM).then_some(line[i]);
        (nm[i], number, weight[i], light_at(i), grid.interpolate(response, nm[i]), probability)
    });
    if arguments.report.json {
        let rows: Vec<_> = rows
            .map(|(nm, line, weight, light, response, density)| {
                json!({ "wavelength_nm": nm, "line": line, "weight": weight, "light": light, "response": response, "density": density })
            })
            .collect();
        console::pretty_json(&json!({
            "light": name, "strategy": arguments.strategy, "seed": seed, "integral": source.seen_by(response), "draws": rows,
        }))?;
        return Ok(DONE);
    }
    let mut text = "wavelength_nm,line,weight,light,response,density\n".to_owned();
    for (nm, line, weight, light, response, density) in rows {
        let line = line.map(|line| line.to_string()).unwrap_or_default();
        let _ = writeln!(text, "{nm},{line},{weight},{light},{response},{density}");
    }
    match &arguments.output {
        Some(path) => {
            write_atomically(path, |out| Ok(out.write_all(text.as_bytes())?))?;
            console::note(&format!("wrote {}", path.display()));
        }
        None => console::out(&text)?,
    }
    Ok(DONE)
}

/// Returns the channel that records the light: the sensitivity of `--on`, or 1 at all wavelengths.
fn channel(arguments: &SpectrumDraw, grid: &Grid) -> Result<Channel, Failure> {
    let response = match &arguments.on {
        None => vec![1.0; grid.count],
        Some(on) => {
            let seen = find_sensitivity_in(on, &files()).map_err(|error| refuse_name(on, error))?;
            seen.on_grid(grid)
        }
    };
    Ok(Channel { name: arguments.on.clone().unwrap_or_else(|| "all".to_owned()), unit: String::new(), response })
}

/// Builds the sampler of `--strategy` in the same way as in a scene.
fn sampler(arguments: &SpectrumDraw, grid: &Grid) -> Result<Box<dyn WavelengthSampler>, Failure> {
    let all = parse_list(&arguments.strategy)?;
    let [Strategy { kind, keys }] = &all[..] else {
        return Err(Failure::Input(format!("--strategy: `{}` is not one strategy", arguments.strategy)));
    };
    let mut map = format!("{{kind: {kind}");
    match keys {
        Some(keys) => map.push_str(&format!(", {keys}")),
        // By default this strategy samples in proportion to the light itself.
        None if kind == "inverse-transform" => {
            map.push_str(&format!(", spectrum: \"{}\"", arguments.name.replace(['"', '\\'], "")));
        }
        None => {}
    }
    map.push('}');
    let node = yaml::parse_bytes("--strategy", map.as_bytes()).map_err(Failure::Faults)?;
    let params = Params::stage(node, "wavelengths").map_err(Failure::Faults)?;
    let resources = files();
    build::<dyn WavelengthSampler>(&params, &Context::new(&resources, *grid)).map_err(Failure::Faults)
}
