//! Checks that every built-in response obeys the laws of responses.

use spectra_plugin_responses as _;
use spectra_testing::{ResponseLaws, response};

#[test]
fn built_in_responses() {
    for yaml in [
        "{kind: photopic}",
        "{kind: scotopic, white: 2}",
        "{kind: sensitivities, channels: {gray: \"gaussian:550,40\"}}",
        "{kind: sensitivities, channels: {a: \"rectangle:500,580\", b: \"rectangle:600,680\", c: \"rectangle:720,820\"}, white: 1}",
    ] {
        println!("{yaml}"); // shown where a law fails
        ResponseLaws::default().hold(&*response(yaml));
    }
}
