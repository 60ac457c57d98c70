//! Blocks of commands in Markdown, and the pages that are made from the program's own help.

use std::ops::Range;

use clap::{Arg, Command};

/// Commands of a page.
pub enum Block {
    /// A script, which is to end well.
    Shell(String),
    /// Commands and what they print.
    Console(Vec<(String, String)>),
    /// Not run, and why.
    NotRun(String),
}

/// The fenced blocks of commands, with the bytes between their fences. A fence that says `sh no-run: REASON` is not run.
pub fn blocks(text: &str) -> Vec<(Range<usize>, Block)> {
    let mut found = Vec::new();
    let (mut at, mut open): (usize, Option<(usize, String)>) = (0, None);
    for line in text.split_inclusive('\n') {
        let end = at + line.len();
        if let Some(kind) = line.trim_end().strip_prefix("```") {
            open = match open {
                None => Some((end, kind.to_owned())),
                Some((start, kind)) => {
                    found.extend(block(&kind, &text[start..at]).map(|block| (start..at, block)));
                    None
                }
            };
        }
        at = end;
    }
    assert!(open.is_none(), "a fence is not closed");
    found
}

fn block(kind: &str, content: &str) -> Option<Block> {
    let (language, rest) = kind.split_once(' ').unwrap_or((kind, ""));
    match (language, rest.strip_prefix("no-run:")) {
        ("sh" | "console", Some(reason)) => Some(Block::NotRun(reason.trim().to_owned())),
        ("sh", None) => Some(Block::Shell(content.to_owned())),
        ("console", None) => {
            let parts = format!("\n{content}");
            let commands = parts.split("\n$ ").skip(1).map(|part| {
                let (command, output) = part.split_once('\n').unwrap_or((part, ""));
                let end = if output.is_empty() || output.ends_with('\n') { "" } else { "\n" };
                (command.to_owned(), format!("{output}{end}"))
            });
            Some(Block::Console(commands.collect()))
        }
        _ => None,
    }
}

/// File names and texts of `docs/commands`.
pub fn command_pages() -> Vec<(String, String)> {
    let mut main = kirimorph::cli::command().disable_help_subcommand(true);
    main.build();
    let mut index = format!("# Commands\n\n{}.\n\n| command | what it does |\n|---|---|\n", about(&main));
    let mut pages = Vec::new();
    for command in main.get_subcommands() {
        let name = command.get_name();
        index += &format!("| [`kirimorph {name}`]({name}.md) | {} |\n", cell(&about(command)));
        pages.push((format!("{name}.md"), page(command)));
    }
    index += &format!("\n{}\n{NOTE}", after(&main));
    pages.push(("README.md".to_owned(), index));
    pages
}

const NOTE: &str = "\nThis page is made from the program's help. After a change of it: `UPDATE_DOCS=1 cargo test --release \
                    --test docs`\n";

fn page(command: &Command) -> String {
    let usage = command.clone().render_usage().to_string();
    let usage = usage.strip_prefix("Usage: ").unwrap_or(&usage);
    let mut text =
        format!("# kirimorph {}\n\n{}.\n\n```text\n{usage}\n```\n", command.get_name(), about(command));
    text += "\n| argument | what it is |\n|---|---|\n";
    let arguments = command.get_arguments().filter(|arg| arg.get_id() != "help");
    let (named, placed): (Vec<&Arg>, Vec<&Arg>) = arguments.partition(|arg| arg.get_long().is_some());
    for arg in placed.into_iter().chain(named) {
        text += &format!("| {} | {} |\n", name(arg), cell(&help(arg)));
    }
    format!("{text}\n{}{NOTE}", after(command))
}

fn about(command: &Command) -> String {
    command.get_about().map(ToString::to_string).unwrap_or_default().trim_end_matches('.').to_owned()
}

/// `-o`, `--output <OUTPUT>`, in code marks.
fn name(arg: &Arg) -> String {
    let values: Vec<String> = match arg.get_num_args().is_some_and(|count| count.takes_values()) {
        true => arg.get_value_names().into_iter().flatten().map(|name| format!("<{name}>")).collect(),
        false => Vec::new(),
    };
    let values = values.join(" ");
    let Some(long) = arg.get_long() else { return format!("`{values}`") };
    let short = arg.get_short().map(|short| format!("`-{short}`, ")).unwrap_or_default();
    format!("{short}`{}`", format!("--{long} {values}").trim_end())
}

fn help(arg: &Arg) -> String {
    let mut text = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let defaults: Vec<_> =
        arg.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
    let takes = arg.get_num_args().is_some_and(|count| count.takes_values());
    if takes && !defaults.is_empty() {
        text += &format!(" [default: {}]", defaults.join(" "));
    }
    let values: Vec<String> = match takes {
        true => arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect(),
        false => Vec::new(),
    };
    if !values.is_empty() {
        text += &format!(" [possible values: {}]", values.join(", "));
    }
    text
}

/// What stands below the options: the examples as a block of commands.
fn after(command: &Command) -> String {
    let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let Some((before, examples)) = text.split_once("Examples:\n") else { return text + "\n" };
    let lines: String = examples.lines().map(|line| format!("{}\n", line.trim())).collect();
    format!("{before}```sh\n{lines}```\n")
}

/// A text as a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;")
}

/// The page on materials with the values of the profiles, each with what its file says beside it.
pub fn with_profiles(page: &str, profiles: &[(String, String)]) -> String {
    let (before, rest) = page.split_once(BEGIN).expect("the mark where the values begin");
    let (_, after) = rest.split_once(END).expect("the mark where they end");
    let tables: String = profiles.iter().map(|(name, text)| values(name, text)).collect();
    format!("{before}{BEGIN}{tables}\n{END}{after}")
}

const BEGIN: &str = "<!-- profiles: made by tests/docs.rs from profiles/*.toml, UPDATE_DOCS=1 -->\n";
const END: &str = "<!-- end -->";

fn values(name: &str, text: &str) -> String {
    let mut table = format!(
        "\n### {name}\n\n[profiles/{name}.toml](../profiles/{name}.toml)\n\n| value | | source |\n|---|---|---|\n"
    );
    let mut section = "";
    for line in text.lines() {
        if line.starts_with('[') {
            section = line.trim_matches(['[', ']']);
        } else if let Some((key, rest)) = line.split_once('=').filter(|_| !line.starts_with('#')) {
            let (value, source) = rest.split_once('#').unwrap_or((rest, ""));
            let dot = if section.is_empty() { "" } else { "." };
            table += &format!("| `{section}{dot}{}` | {} | {} |\n", key.trim(), value.trim(), source.trim());
        }
    }
    table
}
