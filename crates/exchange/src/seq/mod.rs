//! CODE V's sequential command files, `.seq`.
//!
//! A file is commands of three letters and values, one a line or separated by `;`; `!` starts a comment, `&` at the end goes on in
//! the next line. `SO`, `S` and `SI` begin the object, a surface, the image; what follows belongs to it. The meaning
//! of commands is that of the CODE V reference manual (chapters Lens Data, Tilts and Decenters, Apertures).

mod command;
mod glass;
mod lens;
mod statement;
#[cfg(test)]
mod tests;

pub use command::read;
