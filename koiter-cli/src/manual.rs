//! `koiter completions` and `koiter man`: what the definition of the arguments yields.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_mangen::Man;
use koiter::io::write_atomically;

use crate::arguments::{Arguments, CompletionsArguments, ManArguments};
use crate::failure::Failure;
use crate::output::{say, write_out};

/// Prints the completions for a shell.
pub(crate) fn completions(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Arguments::command(),
        "koiter",
        &mut script,
    );
    write_out(&script);
    Ok(())
}

/// Prints the manual page, or writes it and those of all verbs to a folder.
pub(crate) fn man(arguments: &ManArguments) -> Result<(), Failure> {
    let mut root = Arguments::command();
    root.build();
    let Some(folder) = &arguments.output else {
        write_out(&page(root).map_err(Failure::run)?);
        return Ok(());
    };
    fs::create_dir_all(folder)
        .map_err(|error| Failure::run(format!("cannot make {}: {error}", folder.display())))?;
    let verbs: Vec<Command> = root.get_subcommands().cloned().collect();
    write_page(folder, root, "koiter")?;
    for verb in verbs {
        let name = format!("koiter-{}", verb.get_name());
        write_page(folder, verb, &name)?;
    }
    say!("made: {}", folder.join("koiter.1").display());
    Ok(())
}

fn write_page(folder: &Path, command: Command, name: &str) -> Result<(), Failure> {
    let path = folder.join(format!("{name}.1"));
    page(command)
        .and_then(|bytes| write_atomically(&path, &bytes))
        .map_err(|error| Failure::writing(&path, &error))
}

/// The page as roff. The text after the help is set as it stands: examples are lines, not paragraphs.
fn page(command: Command) -> io::Result<Vec<u8>> {
    let examples = command.get_after_help().map(ToString::to_string);
    let has_verbs = command.has_subcommands();
    let man = Man::new(command);
    let mut bytes = Vec::new();
    man.render_title(&mut bytes)?;
    man.render_name_section(&mut bytes)?;
    man.render_synopsis_section(&mut bytes)?;
    man.render_description_section(&mut bytes)?;
    man.render_options_section(&mut bytes)?;
    if has_verbs {
        man.render_subcommands_section(&mut bytes)?;
    }
    if let Some(text) = examples {
        bytes.write_all(b".SH EXAMPLES\n.nf\n")?;
        for line in text.lines().filter(|line| *line != "Examples:") {
            // A dot or quote at the start of a line, and every backslash, mean something to roff.
            writeln!(
                bytes,
                "\\&{}",
                line.replace('\\', "\\e").replace('-', "\\-")
            )?;
        }
        bytes.write_all(b".fi\n")?;
    }
    Ok(bytes)
}
