//! The command in a shell: completions, manual pages, colours, and closed pipes.

use crate::command::{Case, says};
use std::fs;
use std::io::Write;
use std::process::{Command, Output, Stdio};

const SUBCOMMANDS: [&str; 8] = [
    "run", "merge", "slurm", "compare", "verify", "plan", "simulate", "press",
];

/// Returns whether a program accepts a file; prints a message and returns `None` if the program is not installed.
fn accepted(program: &str, arguments: &[&str], input: &[u8]) -> Option<(bool, String)> {
    let child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let Ok(mut child) = child else {
        writeln!(std::io::stderr(), "SKIPPED: no {program} here")
            .expect("standard error takes a line");
        return None;
    };
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    Some((output.status.success(), said.into_owned()))
}

#[test]
fn completions_know_every_subcommand_and_are_accepted_by_their_shell() {
    let case = Case::new();
    for (shell, check) in [
        ("bash", "-n"),
        ("zsh", "-n"),
        ("fish", "--no-execute"),
        ("powershell", ""),
    ] {
        let output = case.run(&format!("completions {shell}"));
        assert!(output.status.success());
        let script = String::from_utf8(output.stdout).unwrap();
        for subcommand in SUBCOMMANDS {
            assert!(script.contains(subcommand), "{shell}: {subcommand}");
        }
        if !check.is_empty()
            && let Some((is_accepted, said)) = accepted(shell, &[check], script.as_bytes())
        {
            assert!(is_accepted, "{shell}: {said}");
        }
    }
    case.refuses("completions csh");
}

#[test]
fn bash_completes_subcommands_and_options() {
    let script = Case::new().run("completions bash").stdout;
    let ask = |words: &str, current: &str| {
        let asked = format!(
            "\nCOMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _bubbletouch bubbletouch '{current}' x; \
             printf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
        );
        [script.as_slice(), asked.as_bytes()].concat()
    };
    let Some((_, said)) = accepted("bash", &["--norc"], &ask("bubbletouch comp", "comp")) else {
        return;
    };
    assert_eq!(said.lines().collect::<Vec<_>>(), ["compare", "completions"]);
    let (_, said) = accepted("bash", &["--norc"], &ask("bubbletouch run --sh", "--sh")).unwrap();
    assert_eq!(said.trim(), "--shard");
}

#[test]
fn the_manual_has_a_page_for_each_subcommand_that_renders_without_a_warning() {
    let case = Case::new();
    let first = case.run("man").stdout;
    assert!(String::from_utf8_lossy(&first).starts_with(".ie"), "roff");
    let output = case.run("man --out man1");
    assert!(output.status.success());
    assert_eq!(case.bytes("man1/bubbletouch.1"), first);
    for subcommand in SUBCOMMANDS {
        let page = case.bytes(&format!("man1/bubbletouch-{subcommand}.1"));
        let Some((is_accepted, said)) = accepted(
            "groff",
            &["-k", "-man", "-Tutf8", "-ww", "-P-c", "-P-b", "-P-u"],
            &page,
        ) else {
            return;
        };
        assert!(
            is_accepted && !said.contains("warning"),
            "{subcommand}: {said}"
        );
        let title = format!("bubbletouch-{subcommand}(1)");
        assert!(said.contains(&title), "{said}");
        says(&said, &["SYNOPSIS", "OPTIONS"]);
    }
}

#[test]
fn a_pipe_gets_no_escape_codes_and_no_color_is_respected() {
    let case = Case::new();
    let press = "press --object mug --taxels 16x16 --pitch-mm 8";
    for (name, value) in [
        ("NO_COLOR", "1"),
        ("TERM", "dumb"),
        ("TERM", "xterm-256color"),
    ] {
        for arguments in [press, "--help", "objects", "run none.toml"] {
            let output = case.command(arguments).env(name, value).output().unwrap();
            for text in [output.stdout, output.stderr] {
                assert!(!text.contains(&0x1b), "{name}={value} {arguments:?}");
            }
        }
    }
}

#[test]
fn a_terminal_gets_colours_unless_no_color_is_set() {
    // `script` runs a program in a terminal.
    let bubbletouch = env!("CARGO_BIN_EXE_bubbletouch");
    let press = format!("{bubbletouch} press --object mug --taxels 16x16 --pitch-mm 8");
    let help = format!("{bubbletouch} --help");
    for (command, has_colours) in [
        (&press, true),
        (&help, true),
        (&press, false),
        (&help, false),
    ] {
        let mut script = Command::new("script");
        script
            .args(["-qec", command, "/dev/null"])
            .stdin(Stdio::null());
        script
            .env("TERM", "xterm-256color")
            .env_remove("NO_COLOR")
            .env_remove("CI");
        if !has_colours {
            script.env("NO_COLOR", "1");
        }
        let Ok(output) = script.output() else {
            writeln!(std::io::stderr(), "SKIPPED: no `script` here")
                .expect("standard error takes a line");
            return;
        };
        assert!(output.status.success());
        let coloured = output.stdout.windows(2).any(|pair| pair == b"\x1b[");
        assert_eq!(
            coloured,
            has_colours,
            "{command}: {}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
}

/// Command lines of all subcommands that write to standard output; those whose results others read come first.
const SPEAKERS: [&str; 23] = [
    "run study.toml --out results/study --threads 2",
    "run study.toml --out results/json --json --threads 2",
    "features study.toml --out features",
    "simulate scene.toml --out scene",
    "--help",
    "--version",
    "help run",
    "objects --help",
    "objects",
    "objects pack golf --surface-error-mm 1 --out o.csv",
    "objects mesh corner.obj",
    "press --object golf",
    "press --object golf --poses poses.csv",
    "completions bash",
    "man",
    "man --out pages",
    "plan study.toml",
    "recording scene/recording.npz",
    "recording scene/recording.npz --frame 0",
    "verify results/study --work-items 1",
    "report results/study",
    "compare results/study results/study --html o.html",
    "classify features --classifier linear_svm",
];

fn speaking() -> Case {
    let case = Case::new();
    case.file(
        "study.toml",
        include_str!("../fixtures/texts/shell_speaking.toml"),
    );
    case.file(
        "scene.toml",
        include_str!("../fixtures/texts/shell_speaking_2.toml"),
    );
    case.file("poses.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n");
    let corner = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n";
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    case.file("corner.obj", corner.to_owned() + faces);
    case
}

/// Returns the writing end of a pipe that has no reader.
fn closed_pipe() -> std::io::PipeWriter {
    std::io::pipe().unwrap().1
}

fn ended(output: &Output, code: i32, arguments: &str) -> String {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {error}");
    assert!(!error.contains("panicked"), "{arguments}: {error}");
    let n_errors = error.lines().filter(|line| line.starts_with("error:"));
    assert_eq!(
        n_errors.count(),
        usize::from(code != 0),
        "{arguments}: {error}"
    );
    error.into_owned()
}

#[test]
fn every_subcommand_does_its_work_and_ends_quietly_where_nobody_reads_what_it_says() {
    let case = speaking();
    for arguments in SPEAKERS {
        let words: Vec<&str> = arguments.split(' ').collect();
        let output = case
            .command(&words)
            .stdout(closed_pipe())
            .stderr(Stdio::piped())
            .spawn()
            .and_then(std::process::Child::wait_with_output);
        ended(&output.unwrap(), 0, arguments);
    }
    for made in [
        "results/study/report.html",
        "results/json/report.html",
        "o.csv",
        "o.html",
    ] {
        assert!(case.path(made).exists(), "{made}");
    }
    let advise = ["advise", "results/study", "--accuracy", "0.01"];
    let output = case.command(&advise).stdout(closed_pipe()).output();
    ended(&output.unwrap(), 0, "advise");
}

#[test]
fn notes_and_errors_that_nobody_reads_change_no_exit_code() {
    let case = speaking();
    for (arguments, code) in [
        ("run study.toml --threads 2", 0),
        ("press --object golf", 0),
        ("press --object unicorn", 2),
        ("press --no-such-option", 2),
    ] {
        let words: Vec<&str> = arguments.split(' ').collect();
        let status = case
            .command(&words)
            .stdout(Stdio::null())
            .stderr(closed_pipe())
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{arguments}");
    }
    assert!(case.path("results/study/report.html").exists());
}

#[test]
#[cfg(target_os = "linux")]
fn a_standard_output_that_is_full_is_an_error_after_the_work_is_done() {
    let case = speaking();
    for arguments in SPEAKERS {
        let words: Vec<&str> = arguments.split(' ').collect();
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = case
            .command(&words)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .and_then(std::process::Child::wait_with_output);
        // This command prints only progress, so a closed standard output has no effect.
        let code = i32::from(!arguments.starts_with("features"));
        let said = ended(&output.unwrap(), code, arguments);
        let sentence = "error: standard output: write failed: No space left on device";
        assert!(code == 0 || said.contains(sentence), "{arguments}: {said}");
    }
    for made in [
        "results/study/report.html",
        "results/json/report.html",
        "o.csv",
        "o.html",
    ] {
        assert!(case.path(made).exists(), "{made}");
    }
}
