//! The terminal: completions, manual pages, lists of profiles and machines, job files to begin with, colours.

mod program;

use std::path::{Path, PathBuf};
use std::process::Command;

use program::{command, finish, made, refused, run, sample_dome};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("terminal-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// All commands but "help".
fn commands() -> Vec<String> {
    kirimorph::cli::command().get_subcommands().map(|command| command.get_name().to_owned()).collect()
}

fn there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

#[test]
fn completions_know_every_command_and_are_shell_scripts() {
    let folder = folder("completions");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let made = run(&folder, ["completions", shell]);
        assert_eq!((made.status, made.stderr.as_str()), (0, ""), "{shell}");
        for name in commands() {
            assert!(made.stdout.contains(&name), "{name} is missing for {shell}");
        }
        assert!(made.stdout.contains("ignore-memory"), "{shell}");
        let file = folder.join(shell);
        std::fs::write(&file, &made.stdout).unwrap();
        if ["bash", "zsh", "fish"].contains(&shell) && there(shell) {
            let checked = finish(Command::new(shell).arg("-n").arg(&file));
            assert_eq!((checked.status, checked.stderr.as_str()), (0, ""), "{shell}");
        }
    }
    // What bash proposes after "kirimorph ver".
    let script = "source ./bash; COMP_WORDS=(kirimorph ver); COMP_CWORD=1; _kirimorph kirimorph ver kirimorph; \
                  echo ${COMPREPLY[*]}";
    let proposed = finish(Command::new("bash").args(["-c", script]).current_dir(&folder));
    assert_eq!(proposed.stdout, "verify\n", "{}", proposed.stderr);
    refused_usage(&folder, &["completions", "tcsh"], "bash");
}

fn refused_usage(folder: &Path, arguments: &[&str], says: &str) {
    let run = run(folder, arguments);
    assert_eq!(run.status, 1);
    assert!(run.stderr.contains(says), "{}", run.stderr);
}

#[test]
fn every_command_has_a_manual_page_that_groff_reads() {
    let folder = folder("man");
    std::fs::create_dir_all(folder.join("pages")).unwrap();
    std::fs::write(folder.join("pages/other.1"), "kept").unwrap();
    let made = run(&folder, ["man", "-o", "pages"]);
    assert_eq!((made.status, made.stderr.as_str()), (0, ""));
    let mut pages: Vec<String> = commands().iter().map(|name| format!("kirimorph-{name}.1")).collect();
    pages.push("kirimorph.1".to_owned());
    assert_eq!(std::fs::read_dir(folder.join("pages")).unwrap().count(), pages.len() + 1);
    for page in pages {
        let text = std::fs::read_to_string(folder.join("pages").join(&page)).unwrap();
        assert!(text.contains("Examples:"), "{page}");
        if there("groff") {
            let shown = finish(
                Command::new("groff")
                    .args(["-ww", "-man", "-Tutf8", &page])
                    .current_dir(folder.join("pages")),
            );
            assert_eq!((shown.status, shown.stderr.as_str()), (0, ""), "{page}");
            assert!(shown.stdout.contains("kirimorph"), "{page}");
        }
    }
    std::fs::write(folder.join("file"), "").unwrap();
    refused(&folder, &["man", "-o", "file"], 1, &["file"]);
}

/// The first words of all lines but the headings.
fn first_words(text: &str) -> Vec<&str> {
    text.lines().skip(1).map(|line| line.split_whitespace().next().unwrap()).collect()
}

/// Columns begin where their headings do.
fn aligned(text: &str, headings: &[&str]) {
    let first = text.lines().next().unwrap();
    for heading in headings {
        let at = first.find(heading).unwrap_or_else(|| panic!("{heading} in {first}"));
        for line in text.lines().filter(|line| at > 0 && line.len() > at) {
            assert!(line[..at].ends_with("  ") && !line[at..].starts_with(' '), "{heading}: {line}");
        }
    }
}

#[test]
fn profiles_and_machines_are_listed_and_can_be_copied() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (what, shelf, one) in
        [("profiles", "profiles", "nylon-6-5mm"), ("machines", "profiles/machines", "haas-umc-bc")]
    {
        let folder = folder(what);
        let listed = run(&folder, [what]);
        assert_eq!((listed.status, listed.stderr.as_str()), (0, ""));
        let mut files: Vec<String> = std::fs::read_dir(repository.join(shelf))
            .unwrap()
            .filter_map(|entry| {
                entry.unwrap().file_name().to_str().unwrap().strip_suffix(".toml").map(str::to_owned)
            })
            .collect();
        files.sort();
        assert_eq!(first_words(&listed.stdout), files);
        assert!(listed.stdout.lines().skip(1).all(|line| line.ends_with("built in")));
        aligned(
            &listed.stdout,
            if what == "profiles" { &["material", "process", "from"] } else { &["control", "from"] },
        );

        let text = std::fs::read_to_string(repository.join(shelf).join(format!("{one}.toml"))).unwrap();
        let printed = run(&folder, [what, one]);
        assert_eq!(printed.stdout, text);
        refused(&folder, &[what, "no-such"], 1, &["no-such", one]);

        // The user's own go first, and one that cannot be used does not hide the others.
        let own = folder.join(shelf);
        std::fs::create_dir_all(&own).unwrap();
        std::fs::write(own.join("mine.toml"), &text).unwrap();
        std::fs::write(own.join("broken.toml"), "version = 1\n").unwrap();
        let listed = run(&folder, [what]);
        assert_eq!(listed.status, 1);
        assert!(listed.stderr.contains("broken.toml"), "{}", listed.stderr);
        assert!(first_words(&listed.stdout).contains(&"mine"));
        assert!(listed.stdout.contains(&format!("{shelf}/mine.toml")));
        assert_eq!(first_words(&listed.stdout).len(), files.len() + 1);
    }
}

#[test]
fn a_new_job_is_made() {
    let folder = folder("new");
    std::fs::create_dir_all(folder.join("meshes")).unwrap();
    std::fs::write(folder.join("meshes/a \"dome\".obj"), sample_dome()).unwrap();
    let mesh = "meshes/a \"dome\".obj";
    let new = run(&folder, ["new", mesh, "-o", "job.toml"]);
    assert_eq!((new.status, new.stderr.as_str()), (0, ""));
    assert!(new.stdout.contains("1600 faces, 300.0 x 300.0 x 90.0 mm"), "{}", new.stdout);
    let text = std::fs::read_to_string(folder.join("job.toml")).unwrap();
    let job: toml::Table = toml::from_str(&text).unwrap();
    assert_eq!(job["target"]["open"].as_str(), Some(mesh));
    made(&folder, "job.toml", "out");
    refused(&folder, &["new", mesh, "-o", "job.toml"], 1, &["job.toml", "not replaced", "-o"]);
    refused(&folder, &["new", mesh, "-o", "other.toml", "--profile", "tin"], 1, &["tin", "steel-304-0.5mm"]);
    refused(&folder, &["new", mesh, "-o", "other.toml", "--size-mm", "-3"], 1, &["-3"]);
    refused(&folder, &["new", "absent.obj"], 1, &["absent.obj"]);
    refused(&folder, &["new", mesh, "-o", "no/folder/job.toml"], 1, &["no/folder/job.toml"]);

    // In the mesh's own units, by its own name, from another folder, and with what else there is switched on.
    let outside = folder.join("outside");
    std::fs::create_dir(&outside).unwrap();
    let new = run(&outside, ["new", "../meshes/a \"dome\".obj", "--units", "in"]);
    assert_eq!((new.status, new.stderr.as_str()), (0, ""));
    assert!(new.stdout.contains("7620.0 x"), "{}", new.stdout);
    let text = std::fs::read_to_string(outside.join("a \"dome\".toml")).unwrap();
    let job: toml::Table = toml::from_str(&text).unwrap();
    assert!(Path::new(job["target"]["open"].as_str().unwrap()).is_absolute());
    assert_eq!(job["target"]["units"].as_str(), Some("in"));
    let new = run(&folder, ["new", mesh, "-o", "small.toml", "--size-mm", "20"]);
    assert!(new.stdout.contains("small for steel"), "{}", new.stdout);
    let all = std::fs::read_to_string(folder.join("job.toml")).unwrap();
    let all: String =
        all.lines().skip(1).map(|line| format!("{}\n", line.trim_start_matches("# "))).collect();
    std::fs::write(folder.join("all.toml"), all.replace("kerf_mm = 0.05", "kerf_mm = 0.06")).unwrap();
    let read = run(&folder, ["design", "all.toml", "--feasibility-only"]);
    assert!(!read.stderr.contains("unknown key") && !read.stderr.contains("TOML"), "{}", read.stderr);
}

#[test]
fn colours_are_for_those_who_want_them() {
    let folder = folder("colours");
    let coloured = |variables: &[(&str, &str)], arguments: &[&str]| {
        let mut command = command(&folder);
        command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").env_remove("CLICOLOR").args(arguments);
        let run = finish(command.envs(variables.iter().copied()));
        let text = run.stdout + &run.stderr;
        (text.contains('\u{1b}'), text.replace("\u{1b}[", ""))
    };
    for arguments in [&["profiles"][..], &["machines"], &["profiles", "tin"], &["--help"]] {
        let plain = coloured(&[], arguments);
        assert!(!plain.0, "{arguments:?}");
        assert!(coloured(&[("CLICOLOR_FORCE", "1")], arguments).0, "{arguments:?}");
        assert_eq!(coloured(&[("NO_COLOR", "1")], arguments), plain, "{arguments:?}");
    }
}
