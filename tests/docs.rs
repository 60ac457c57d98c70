//! README and docs: every command in them runs, every link leads to a file, and the pages of `docs/commands` are what the
//! program says of itself. `UPDATE_DOCS=1 cargo test --release --test docs` writes the pages and printed output anew.

mod docs_pages;
mod program;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;

use docs_pages::{Block, blocks, command_pages, with_profiles};
use program::{Run, finish};

/// The repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// With `UPDATE_DOCS`: writes what is made from the program and its profiles, once and before any page is read.
fn update() {
    static ONCE: Once = Once::new();
    let write = || {
        let folder = root().join("docs/commands");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        command_pages().iter().for_each(|(name, text)| std::fs::write(folder.join(name), text).unwrap());
        std::fs::write(materials(), page_on_materials()).unwrap();
    };
    ONCE.call_once(|| {
        if updating() {
            write()
        }
    });
}

fn materials() -> PathBuf {
    root().join("docs/materials.md")
}

/// The page on materials as it should be.
fn page_on_materials() -> String {
    let files = std::fs::read_dir(root().join("profiles")).unwrap().map(|entry| entry.unwrap().path());
    let mut profiles: Vec<(String, String)> = files
        .filter(|path| path.is_file())
        .map(|path| (path.file_stem().unwrap().to_string_lossy().into_owned(), read(&path)))
        .collect();
    profiles.sort();
    with_profiles(&read(&materials()), &profiles)
}

/// README first, since the others go on from what it makes, then the other pages by name.
fn pages() -> Vec<PathBuf> {
    update();
    let mut rest: Vec<PathBuf> = ["docs", "docs/commands"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .chain(["CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root().join(name)))
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    rest.sort();
    [root().join("README.md")].into_iter().chain(rest).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn updating() -> bool {
    std::env::var_os("UPDATE_DOCS").is_some()
}

/// A folder with the samples and profiles of the repository, and nothing that was made.
fn workplace(name: &str) -> PathBuf {
    fn copy(from: &Path, to: &Path) {
        std::fs::create_dir_all(to).unwrap();
        for entry in std::fs::read_dir(from).unwrap() {
            let from = entry.unwrap().path();
            let to = to.join(from.file_name().unwrap());
            if from.is_dir() {
                copy(&from, &to);
            } else {
                std::fs::copy(&from, &to).unwrap();
            }
        }
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    for part in ["samples", "profiles"] {
        copy(&root().join(part), &folder.join(part));
    }
    folder
}

/// What stands before every block: `cargo run` is the program too, and what was made once is not made again.
const PRELUDE: &str = r#"
set -euo pipefail
cargo() {
    [ "$1 $2 $3" = "run --release --" ] || { echo "cargo $* is not run by the test: mark it no-run" >&2; return 1; }
    shift 3
    kirimorph "$@"
}
kirimorph() {
    local call="${*/ --quiet/}"
    if [ "$1" = make ] && grep -qxF -- "$call" .made 2>/dev/null; then return; fi
    command kirimorph "$@"
    if [ "$1" = make ]; then echo "$call" >> .made; fi
}
"#;

/// Runs shell commands with the program in the path.
fn shell(folder: &Path, script: &str) -> Run {
    let program = Path::new(env!("CARGO_BIN_EXE_kirimorph")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("bash");
    finish(command.args(["-c", &format!("{PRELUDE}{script}")]).current_dir(folder).env("PATH", path))
}

#[test]
fn every_command_runs() {
    let folder = workplace("docs-commands");
    let (mut run, mut faults) = (0, String::new());
    for page in pages() {
        let mut text = read(&page);
        let name = page.strip_prefix(root()).unwrap().display().to_string();
        // From the end, so that output of another length does not move the blocks before.
        let mut printed = Vec::new();
        for (at, block) in blocks(&text) {
            let line = text[..at.start].matches('\n').count() + 1;
            let start = std::time::Instant::now();
            match block {
                Block::Shell(script) => {
                    let ended = shell(&folder, &script);
                    if ended.status != 0 {
                        writeln!(faults, "{name}:{line}: {script}\n{}{}", ended.stdout, ended.stderr)
                            .unwrap();
                    }
                }
                Block::Console(session) => {
                    let mut found = String::new();
                    for (command, _) in &session {
                        let ended = shell(&folder, command);
                        if ended.status != 0 {
                            writeln!(faults, "{name}:{line}: {command}\n{}", ended.stderr).unwrap();
                        }
                        found += &format!("$ {command}\n{}", ended.stdout);
                    }
                    let told: String =
                        session.iter().map(|(command, output)| format!("$ {command}\n{output}")).collect();
                    if told != found {
                        if !updating() {
                            writeln!(faults, "{name}:{line} is not what is printed now:\n{found}").unwrap();
                        }
                        printed.push((at, found));
                    }
                }
                Block::NotRun(reason) => {
                    assert!(!reason.is_empty(), "{name}:{line}: say why after no-run:");
                    continue;
                }
            }
            run += 1;
            println!("{:6.2} s  {name}:{line}", start.elapsed().as_secs_f64());
        }
        if updating() && !printed.is_empty() {
            for (at, found) in printed.into_iter().rev() {
                text.replace_range(at, &found);
            }
            std::fs::write(&page, text).unwrap();
        }
    }
    assert!(faults.is_empty(), "{faults}");
    assert!(run >= 25, "only {run} blocks were found");
}

#[test]
fn no_command_hides_in_an_indented_block() {
    for page in pages() {
        for line in read(&page).lines() {
            let Some(code) = line.strip_prefix("    ") else { continue };
            let word = code.split_whitespace().next().unwrap_or_default();
            let hidden = ["kirimorph", "cargo", "bash", "python3", "time"].contains(&word);
            assert!(!hidden, "{}: {line}: put it into a block of sh", page.display());
        }
    }
}

#[test]
fn the_pages_of_the_commands_are_the_programs_own_words() {
    update();
    let folder = root().join("docs/commands");
    let wanted = command_pages();
    assert!(wanted.len() > 12);
    for (name, text) in &wanted {
        let path = folder.join(name);
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            found == *text,
            "{} is out of date: UPDATE_DOCS=1 cargo test --release --test docs",
            path.display()
        );
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), wanted.len());
}

#[test]
fn the_page_on_materials_has_the_profiles_values() {
    update();
    let wanted = page_on_materials();
    assert!(wanted.contains("| `laser.kerf_mm` | 0.05 | calibrate by coupon;"));
    assert!(read(&materials()) == wanted, "docs/materials.md is out of date: UPDATE_DOCS=1");
}

/// The command, if the words begin with the program, have a command of its and options of that command.
fn known(words: &str) -> Result<bool, String> {
    let Some(rest) = words.strip_prefix("kirimorph ") else { return Ok(false) };
    let mut rest = rest.split_whitespace();
    let name = rest.next().unwrap_or_default();
    if name.starts_with('-') {
        return Ok(false);
    }
    let program = kirimorph::cli::command();
    let command = program.find_subcommand(name).ok_or_else(|| format!("there is no command {name}"))?;
    for option in rest.filter_map(|word| word.trim_matches(['[', ']']).strip_prefix("--")) {
        let found = command.get_arguments().any(|arg| arg.get_long() == Some(option)) || option == "help";
        if !found {
            return Err(format!("{name} has no option --{option}"));
        }
    }
    Ok(true)
}

#[test]
fn commands_and_samples_in_the_text_exist() {
    let (mut commands, mut samples) = (0, 0);
    for page in pages() {
        let text = read(&page);
        for span in text.split('`').skip(1).step_by(2).filter(|span| !span.contains('\n')) {
            match known(span) {
                Ok(is_command) => commands += usize::from(is_command),
                Err(fault) => panic!("{}: {span}: {fault}", page.display()),
            }
        }
        for part in text.split("samples/").skip(1) {
            let name: String =
                part.chars().take_while(|c| c.is_alphanumeric() || "-_./".contains(*c)).collect();
            let name = name.trim_end_matches('.');
            if name.ends_with(".toml") && name != "NAME.toml" {
                assert!(root().join("samples").join(name).exists(), "{}: samples/{name}", page.display());
                samples += 1;
            }
        }
    }
    assert!(commands > 30 && samples > 20, "{commands} {samples}");
}

#[test]
fn every_link_leads_to_a_file() {
    let mut links = 0;
    for page in pages() {
        let text = read(&page);
        for part in text.split("](").skip(1) {
            let link = part.split(')').next().unwrap();
            if link.starts_with("http") || link.starts_with('#') {
                continue;
            }
            let file = page.parent().unwrap().join(link.split('#').next().unwrap());
            assert!(file.exists(), "{}: {link} leads nowhere", page.display());
            links += 1;
        }
    }
    assert!(links > 40, "{links}");
}

#[test]
fn fragments_of_jobs_and_profiles_are_toml() {
    let mut found = 0;
    for page in pages() {
        for part in read(&page).split("```toml\n").skip(1) {
            let text = part.split("```").next().unwrap();
            if let Err(error) = toml::from_str::<toml::Table>(text) {
                panic!("{}: {error}", page.display());
            }
            found += 1;
        }
    }
    assert!(found >= 3, "{found}");
}

#[test]
fn pictures_stay_small() {
    let files = std::fs::read_dir(root().join("docs/pictures")).unwrap();
    let sizes: Vec<u64> = files.map(|file| file.unwrap().metadata().unwrap().len()).collect();
    assert!(sizes.len() > 10 && sizes.iter().all(|size| *size <= 300_000));
    assert!(sizes.iter().sum::<u64>() < 1_500_000);
}
