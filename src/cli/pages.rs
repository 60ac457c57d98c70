//! `kirimorph completions` and `kirimorph man`: what shells and `man` know of the commands, from the same source as
//! the help texts.

use std::io::{self, Write};
use std::path::Path;

use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;

use super::{Failure, command, print};
use crate::output::whole_file::write_whole;

/// Prints the completions for a shell.
pub fn completions(shell: Shell) {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut command(), "kirimorph", &mut bytes);
    print(&String::from_utf8_lossy(&bytes));
}

/// Writes a page per command into a folder, which may hold others.
pub fn man(folder: &Path) -> Result<(), Failure> {
    let pages = pages().map_err(Failure::bad_input)?;
    for (name, text) in &pages {
        let path = folder.join(name);
        write_whole(&path, |out| out.write_all(text))
            .map_err(|error: io::Error| Failure::BadInput(format!("{}: {error}", path.display())))?;
    }
    let folder = folder.display();
    print(&format!("{} pages in {folder}: man {folder}/kirimorph-make.1\n", pages.len()));
    Ok(())
}

/// File names and texts, the main page first.
fn pages() -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut main = command().disable_help_subcommand(true);
    main.build();
    let commands: Vec<Command> = main.get_subcommands().cloned().collect();
    [main].into_iter().chain(commands).map(page).collect()
}

fn page(command: Command) -> io::Result<(String, Vec<u8>)> {
    let page = Man::new(command).manual("kirimorph").source(concat!("kirimorph ", env!("CARGO_PKG_VERSION")));
    let mut text = Vec::new();
    page.render(&mut text)?;
    Ok((page.get_filename(), text))
}
