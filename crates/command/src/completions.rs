//! `spectra completions` and `spectra man`.

use crate::arguments::{Arguments, Completions};
use crate::console;
use crate::outcome::{DONE, Outcome};
use clap::CommandFactory;

/// Writes the completion script for a shell to standard output.
pub(crate) fn completions(arguments: &Completions) -> Outcome {
    let mut bytes = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "spectra", &mut bytes);
    console::out(&String::from_utf8_lossy(&bytes))?;
    Ok(DONE)
}

/// Writes the man page to standard output: the program, then a section for each command.
pub(crate) fn man() -> Outcome {
    let mut command = Arguments::command();
    command.build();
    let mut bytes = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut bytes)?;
    for of in command.get_subcommands().filter(|of| of.get_name() != "help") {
        // The options of each command become a section of this one page.
        let man = clap_mangen::Man::new(of.clone());
        bytes.extend(format!(".SH \"SPECTRA {}\"\n", of.get_name().to_uppercase()).into_bytes());
        man.render_description_section(&mut bytes)?;
        man.render_options_section(&mut bytes)?;
    }
    console::out(&String::from_utf8_lossy(&bytes))?;
    Ok(DONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap_complete::Shell;

    #[test]
    fn every_shell_has_completions_of_every_command() {
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::PowerShell, Shell::Elvish] {
            let mut bytes = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "spectra", &mut bytes);
            let text = String::from_utf8(bytes).expect("UTF-8");
            for command in Arguments::command().get_subcommands() {
                assert!(text.contains(command.get_name()), "{shell}: {}", command.get_name());
            }
        }
    }
}
