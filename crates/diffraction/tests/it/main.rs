//! Tests of the public interface of this crate, in one program so that dependencies are linked only once.

mod closed_form;
mod pixels;
