//! Generated hostile input: every key of every kind of file with invalid values, numbers outside the declared range of each key, and every file that a
//! command reads in broken forms.
//!
//! Keys come from the readers: an unknown key makes a reader list its known keys. `cargo test --test long_runs -- hostile` tries a part of the inputs. With
//! BUBBLETOUCH_LONG=1, all are tried, and studies that `plan` accepts are also run. An input is accepted, or refused within two seconds with exit code 2 and
//! one sentence, and nothing is written.

use crate::command::{Case, CommandLine};
use crate::kinds::Kind;
use bubbletouch::inputs::range::Range;
use bubbletouch::kinds::object_detail::ObjectDetailStudySpec;
use bubbletouch::kinds::reconstruction::ReconstructionStudySpec;
use bubbletouch::kinds::stability::StabilityStudySpec;
use bubbletouch::kinds::whole_body::WholeBodyStudySpec;
use bubbletouch::kinds::{self, Source};
use bubbletouch::scene::SceneSpec;
use bubbletouch::study::{StudySpec, write_integers, write_npy};
use ndarray::Array3;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use toml::{Table, Value};

/// TOML file, and the command that reads it.
struct File {
    name: &'static str,
    text: String,
    /// Function that parses a text and returns the reader's error.
    read: fn(&str) -> Result<(), toml::de::Error>,
    /// Command line, with `FILE` in the place of the file.
    command: &'static str,
}

/// Parses a text as a type, and drops the value.
fn reader<T: serde::de::DeserializeOwned>(text: &str) -> Result<(), toml::de::Error> {
    toml::from_str::<T>(text).map(drop)
}

fn files() -> Vec<File> {
    let study = |name, text: &str| File {
        name,
        text: text.to_owned(),
        read: reader::<StudySpec>,
        command: "plan FILE",
    };
    let kind = |name, read| File {
        read,
        ..study(name, &Kind::named(name).study)
    };
    let mut files = vec![
        study("recognition", include_str!("hostile/recognition.toml")),
        study("chosen", include_str!("hostile/chosen.toml")),
        study("shear", include_str!("hostile/shear.toml")),
        study("human", include_str!("hostile/human.toml")),
        study("recorded", include_str!("hostile/recorded.toml")),
    ];
    let read = reader::<ReconstructionStudySpec>;
    files.push(kind("reconstruction", read));
    let read = reader::<ObjectDetailStudySpec>;
    files.push(kind("object_detail", read));
    let read = reader::<WholeBodyStudySpec>;
    files.push(kind("whole_body", read));
    let read = reader::<StabilityStudySpec>;
    files.push(kind("stability", read));
    files.push(File {
        read: reader::<SceneSpec>,
        command: "simulate FILE --out out --quiet",
        ..study("scene", include_str!("hostile/scene.toml"))
    });
    files.push(File {
        read: reader::<Table>,
        command: "press --object one --objects FILE --surface-error-mm 2 --taxels 8x8 --out out.csv",
        ..study("parts", include_str!("hostile/parts.toml"))
    });
    files
}

/// Creates a folder with the files of the folder `hostile` and all files that they need.
fn case() -> Case {
    let case = Kind::named("recognition").case();
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/long_runs/hostile");
    for file in fs::read_dir(own).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), case.folder().join(file.file_name())).unwrap();
    }
    let touch = |n: usize, row: usize| ((n * 7 + row * 3) % 11) as f32 / 10.0;
    let frames = Array3::from_shape_fn((40, 8, 8), |(n, row, column)| touch(n, row + column));
    write_npy(&case.path("frames.npy"), &frames).unwrap();
    write_integers(&case.path("labels.npy"), (0..40).map(|n| n % 4)).unwrap();
    write_integers(&case.path("groups.npy"), (0..40).map(|n| n / 4)).unwrap();
    case.file("spheres.csv", "x,y,z,r\n0,0,0.01,0.01\n0.01,0,0.01,0.01\n");
    case.file("poses.csv", "x,y,z,qw,qx,qy,qz\n0,0,0.02,1,0,0,0\n");
    fs::copy(case.path("meshes/box.obj"), case.path("box.obj")).unwrap();
    case
}

/// Returns values that are invalid for most keys.
fn values() -> Vec<Value> {
    let text = "values = [nan, inf, -1.0, 1e308, 1e-308, 0, -1, 1000000000000000000, 'wrong', '', [], true, {}]";
    let table: Table = text.parse().unwrap();
    table["values"].as_array().unwrap().clone()
}

/// Returns copies of the text, each with another value of one key. The keys are the keys of the text and all other keys that the reader accepts.
fn mutations(file: &File) -> Vec<(String, String)> {
    let table: Table = file.text.parse().unwrap();
    let mut found = Vec::new();
    visit(file, &Value::Table(table), &mut Vec::new(), &mut found);
    found
}

fn visit(file: &File, value: &Value, path: &mut Vec<String>, found: &mut Vec<(String, String)>) {
    let whole: Table = file.text.parse().unwrap();
    let mut steps: Vec<String> = Vec::new();
    match value {
        Value::Table(table) => {
            steps.extend(table.keys().cloned());
            path.push("no_such_key".to_owned());
            let probe = replaced(&whole, path, &Value::Integer(1)).unwrap();
            path.pop();
            if let Err(error) = (file.read)(&probe) {
                steps.extend(listed(error.message()));
            }
            steps.dedup();
        }
        Value::Array(values) if values.iter().any(|one| one.is_table() || one.is_array()) => {
            steps.extend((0..values.len()).map(|number| number.to_string()));
        }
        _ => return,
    }
    for step in steps {
        let inner = match (value, step.parse::<usize>()) {
            (Value::Array(values), Ok(number)) => values.get(number),
            (value, _) => value.get(&step),
        };
        path.push(step);
        for hostile in values() {
            let text = replaced(&whole, path, &hostile).unwrap();
            found.push((format!("{} = {hostile}", path.join(".")), text));
        }
        if let Some(inner) = inner {
            visit(file, inner, path, found);
        }
        path.pop();
    }
}

/// Returns a file with a value at a path of keys and of indices of lists; absent tables are created. Returns `None` if the file has another value in the way.
pub fn replaced(table: &Table, path: &[String], value: &Value) -> Option<String> {
    let mut whole = Value::Table(table.clone());
    let mut place = &mut whole;
    for step in path {
        place = match place {
            Value::Table(table) => {
                let inner = table.entry(step);
                inner.or_insert_with(|| Table::new().into())
            }
            Value::Array(values) => values.get_mut(step.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    *place = value.clone();
    Some(toml::to_string(&whole).unwrap())
}

/// Returns the keys that an error about an unknown key lists, in backticks after `expected`.
fn listed(message: &str) -> Vec<String> {
    let expected = match message.split_once("unknown field") {
        Some((_, rest)) => rest.split_once("expected").map_or("", |(_, rest)| rest),
        None => "",
    };
    let words = expected.split('`').skip(1).step_by(2);
    words.map(str::to_owned).collect()
}

/// Result of a command.
struct Answer {
    code: Option<i32>,
    said: String,
    took: Duration,
}

fn is_long() -> bool {
    std::env::var_os("BUBBLETOUCH_LONG").is_some()
}

/// Runs a command for at most a minute.
fn answer(case: &Case, line: &(impl CommandLine + ?Sized)) -> Answer {
    let start = Instant::now();
    let mut command = case.command(line);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stderr = child.stderr.take().unwrap();
    let reads = std::thread::spawn(move || {
        let mut said = Vec::new();
        let _ = stderr.read_to_end(&mut said);
        String::from_utf8_lossy(&said).into_owned()
    });
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let took = start.elapsed();
    let said = reads.join().unwrap();
    Answer { code, said, took }
}

/// Returns what is wrong with a result; `None` if the input was accepted, or refused correctly.
fn wrong(answer: &Answer, is_unchanged: bool) -> Option<String> {
    let sentences = answer.said.lines().filter(|l| l.starts_with("error:"));
    let n_sentences = sentences.count();
    // Other tests run at the same time; alone, the limit is two seconds.
    let most = Duration::from_secs(if is_long() { 2 } else { 10 });
    let said = answer.said.trim();
    match answer.code {
        Some(0) => None,
        Some(2) if n_sentences != 1 => Some(format!("{n_sentences} sentences: {said}")),
        Some(2) if answer.took > most => Some(format!("refused after {:?}: {said}", answer.took)),
        Some(2) if !is_unchanged => Some(format!("refused, but something was written: {said}")),
        Some(2) => None,
        None => Some("no answer within a minute".to_owned()),
        Some(code) => Some(format!("exit code {code}: {said}")),
    }
}

/// Returns all files and folders in a folder and its subfolders.
fn all_names(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        names.push(path.display().to_string());
        if path.is_dir() && !path.is_symlink() {
            names.extend(all_names(&path));
        }
    }
    names.sort();
    names
}

/// Removes the output of an accepted input.
fn clear(case: &Case) {
    let _ = fs::remove_dir_all(case.path("out"));
    let _ = fs::remove_file(case.path("out.csv"));
}

fn tried(case: &Case, command: &str) -> Option<String> {
    let before = all_names(case.folder());
    let answer = answer(case, command);
    let found = wrong(&answer, all_names(case.folder()) == before);
    clear(case);
    found
}

/// Reads and plans a study in this process, as the command `plan` does.
fn planned(case: &Case, text: &str) -> bubbletouch::Result<()> {
    let study = kinds::load(&Source {
        folder: case.folder().to_owned(),
        results: case.path("results"),
        ..Source::of_text("study.toml", text)
    })?;
    study.plan().map(drop)
}

/// Returns what is wrong with the answer to a study; `None` if it was accepted, or refused correctly.
fn misread(case: &Case, text: &str) -> Option<String> {
    let start = Instant::now();
    match catch_unwind(AssertUnwindSafe(|| planned(case, text))) {
        Ok(Ok(())) => None,
        Ok(Err(error)) => {
            let code = Some(i32::from(error.exit_code()));
            let said = format!("error: {error}");
            let took = start.elapsed();
            wrong(&Answer { code, said, took }, true)
        }
        Err(_) => Some("panicked".to_owned()),
    }
}

/// Returns numbers outside a range: below it, above it, and one that is no number.
fn outside(range: Range) -> Vec<Value> {
    let Some([low, high]) = range.bounds() else {
        return Vec::new();
    };
    let number = |number: f64| match range {
        Range::Count(..) => Value::Integer(number as i64),
        _ => Value::Float(number),
    };
    let beyond = [low - low.abs().max(1.0), high + high.abs().max(1.0)].into_iter();
    let beyond = beyond.filter(|end| end.is_finite() && !range.contains(*end));
    beyond.map(number).chain([Value::Float(f64::NAN)]).collect()
}

/// Returns the path of a key in a file, through the first table of a list that has it; `None` if the file does not have the key.
fn place(value: &Value, names: &[&str]) -> Option<Vec<String>> {
    let Some((name, rest)) = names.split_first() else {
        return Some(Vec::new());
    };
    let (step, inner) = match value {
        Value::Table(table) => ((*name).to_owned(), place(table.get(*name)?, rest)?),
        Value::Array(entries) => {
            let mut found = entries.iter().enumerate();
            let (number, inner) = found.find_map(|(k, entry)| Some((k, place(entry, names)?)))?;
            (number.to_string(), inner)
        }
        _ => return None,
    };
    Some([vec![step], inner].concat())
}

/// The declaration of a key states its range; no other number is read. The error names the key or its line.
#[test]
fn every_number_outside_the_range_of_its_key_is_refused_with_the_key() {
    let case = case();
    let (mut tried, mut faults) = (BTreeSet::new(), Vec::new());
    let is_study = |file: &&File| file.command.starts_with("plan");
    for file in files().iter().filter(is_study) {
        let table: Table = file.text.parse().unwrap();
        let kind = kinds::about(&file.text).map_or("recognition", |about| about.table);
        for key in kinds::keys(kind).unwrap() {
            let names: Vec<&str> = key.path.split('.').collect();
            let Some(path) = place(&Value::Table(table.clone()), &names) else {
                continue;
            };
            for number in outside(key.range) {
                let text = replaced(&table, &path, &number).unwrap();
                let written = format!("{} = {number}", key.name());
                let given = text.lines().position(|line| line == written);
                let line = given.map_or("no line".to_owned(), |line| format!(":{}:", line + 1));
                let said = planned(&case, &text).err().map(|error| error.to_string());
                let names_it = |said: &String| said.contains(key.name()) || said.contains(&line);
                tried.insert((kind, key.path));
                if !said.as_ref().is_some_and(names_it) {
                    faults.push(format!("{}: {} = {number}: {said:?}", file.name, key.path));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(tried.len() > 90, "{} keys: {tried:?}", tried.len());
}

#[test]
fn every_key_is_accepted_or_refused_in_one_sentence() {
    let case = case();
    let (mut n, mut faults) = (0, Vec::new());
    for file in files() {
        let name = format!("{}_x.toml", file.name);
        let command = file.command.replace("FILE", &name);
        case.file(&name, &file.text);
        let usual = answer(&case, &command);
        assert_eq!(usual.code, Some(0), "{}: {}", file.name, usual.said);
        clear(&case);
        let all = mutations(&file);
        assert!(all.len() > 100, "{}: {} inputs", file.name, all.len());
        // A test run takes a sample of each file that covers all keys and values: the step is prime.
        let step = if is_long() { 1 } else { 97 };
        for (what, text) in all.iter().step_by(step) {
            n += 1;
            let is_study = command.starts_with("plan");
            let mut found = match is_study {
                true => misread(&case, text),
                false => {
                    case.file(&name, text);
                    tried(&case, &command)
                }
            };
            if is_long() && is_study && found.is_none() && planned(&case, text).is_ok() {
                case.file(&name, text);
                let run = format!("run {name} --out out --quiet");
                // An input that `plan` accepts also runs; a study may take longer than the test waits.
                let answer = answer(&case, &run);
                clear(&case);
                if !matches!(answer.code, Some(0) | None) {
                    found = Some(format!("plan accepts it, but run: {}", answer.said.trim()));
                }
            }
            if let Some(found) = found {
                faults.push(format!("{}: {what}: {found}", file.name));
            }
        }
        fs::remove_file(case.path(&name)).unwrap();
    }
    assert_none(n, &faults);
}

#[test]
fn every_file_that_is_broken_is_refused_in_one_sentence_or_read() {
    let case = case();
    case.succeeds("run small.toml --out results --quiet");
    case.succeeds("features small.toml --out rows");
    case.succeeds("simulate scene.toml --out moved --quiet");
    let commands: BTreeMap<String, Vec<String>> =
        toml::from_str(include_str!("hostile/commands.toml")).unwrap();
    let ways = "missing, empty, truncated, wrong kind, a folder, unreadable";
    let (mut n, mut faults) = (0, Vec::new());
    for (number, (name, commands)) in commands.iter().enumerate() {
        let path = case.path(name);
        let whole = fs::read(&path).unwrap();
        for (way, how) in ways.split(", ").enumerate() {
            if !is_long() && (number + way) % 4 != 0 {
                continue;
            }
            fs::remove_file(&path).unwrap();
            match how {
                "missing" => {}
                "empty" => fs::write(&path, []).unwrap(),
                "truncated" => fs::write(&path, &whole[..whole.len() / 2]).unwrap(),
                "wrong kind" => fs::write(&path, b"\x89PNG\r\n\x1a\n\x00\x00\xff\xfe").unwrap(),
                "a folder" => fs::create_dir(&path).unwrap(),
                _ => make_unreadable(&path, &whole),
            }
            for command in commands {
                n += 1;
                if let Some(found) = tried(&case, command) {
                    faults.push(format!("{name} {how}: {command}: {found}"));
                }
            }
            let _ = fs::remove_dir(&path);
            let _ = fs::remove_file(&path);
            fs::write(&path, &whole).unwrap();
        }
    }
    assert_none(n, &faults);
}

/// Asserts that none of `n` inputs has a fault.
fn assert_none(n: usize, faults: &[String]) {
    eprintln!("{n} inputs");
    let n_faults = faults.len();
    assert_eq!(n_faults, 0, "of {n} inputs:\n{}", faults.join("\n"));
}

/// Makes a file unreadable for all users except root.
fn make_unreadable(path: &Path, whole: &[u8]) {
    fs::write(path, whole).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o000)).unwrap();
    }
}
