//! CODE V sequential command files, `.seq`.
//!
//! A file consists of commands of three letters with values, one per line or separated by `;`. `!` starts a comment, and `&` at the end
//! continues on the next line. `SO`, `S` and `SI` begin the object, a surface and the image; the commands that follow belong to it.
//! Commands have the meaning given in the CODE V reference manual (chapters Lens Data, Tilts and Decenters, Apertures).

mod command;
mod glass;
mod lens;
mod statement;
#[cfg(test)]
mod tests;

pub use command::read;
