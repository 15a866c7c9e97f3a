//! What the shell sees of the command: completions, manual pages, colours.

mod command;

use command::Case;
use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

const SUBCOMMANDS: [&str; 8] = [
    "run", "merge", "slurm", "compare", "verify", "plan", "simulate", "press",
];

/// A program's exit status when it is given a file; says so aloud if there is no such program.
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
        let output = case.run(&["completions", shell]);
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
    let refused = case.run(&["completions", "csh"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn bash_completes_subcommands_and_options() {
    let script = Case::new().run(&["completions", "bash"]).stdout;
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
    let first = case.run(&["man"]).stdout;
    assert!(String::from_utf8_lossy(&first).starts_with(".ie"), "roff");
    let output = case.run(&["man", "--out", "man1"]);
    assert!(output.status.success());
    assert_eq!(fs::read(case.path("man1/bubbletouch.1")).unwrap(), first);
    for subcommand in SUBCOMMANDS {
        let page = fs::read(case.path(&format!("man1/bubbletouch-{subcommand}.1"))).unwrap();
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
        assert!(
            said.contains("SYNOPSIS") && said.contains("OPTIONS"),
            "{said}"
        );
    }
}

#[test]
fn a_pipe_gets_no_escape_codes_and_no_color_is_respected() {
    let case = Case::new();
    let press = [
        "press",
        "--object",
        "mug",
        "--taxels",
        "16x16",
        "--pitch-mm",
        "8",
    ];
    for (name, value) in [
        ("NO_COLOR", "1"),
        ("TERM", "dumb"),
        ("TERM", "xterm-256color"),
    ] {
        for arguments in [&press[..], &["--help"], &["objects"], &["run", "none.toml"]] {
            let output = case.command(arguments).env(name, value).output().unwrap();
            for text in [output.stdout, output.stderr] {
                assert!(!text.contains(&0x1b), "{name}={value} {arguments:?}");
            }
        }
    }
}

#[test]
fn a_terminal_gets_colours_unless_no_color_is_set() {
    // `script` gives a program a terminal.
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
