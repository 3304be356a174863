//! Tests of the public interface of this crate. They form one program, so that their dependencies are linked once.

mod imagers;
mod laws;
mod scheimpflug;
mod sensor;
