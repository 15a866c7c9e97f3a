//! Conversion of library errors and panics to Python exceptions.
//!
//! | library | Python |
//! |---|---|
//! | [`Error::Input`] | `ValueError` with the library's message |
//! | [`Error::Io`] | `OSError`, or its subclass for the system's number, with the file's name |
//! | [`Error::WorkItems`] | `RuntimeError` with the library's message |
//! | a panic | `InternalError`; the message asks the user to report the bug |

use bubbletouch::Error;
use bubbletouch::serde::de::DeserializeOwned;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use std::any::Any;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook};
use std::path::Path;
use std::sync::Mutex;

create_exception!(
    bubbletouch,
    InternalError,
    PyRuntimeError,
    "A bug of bubbletouch itself, wherever it was called from: its text asks for a report."
);

/// Message and source location of the last panic; `None` if there was none.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Installs a panic hook that stores the message for the exception and prints nothing.
pub fn keep_panics() {
    set_hook(Box::new(|info: &PanicHookInfo| {
        let place = info.location().map_or(String::new(), |location| {
            format!(", {}:{}", location.file(), location.line())
        });
        let said = message(info.payload());
        if let Ok(mut last) = LAST_PANIC.lock() {
            *last = Some(format!("{said}{place}"));
        }
    }));
}

fn message(payload: &dyn Any) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message")
}

/// Calls a function and returns its result; a panic is converted to an [`InternalError`].
///
/// # Errors
/// Returns the errors of `call`, or an [`InternalError`] after a panic.
pub fn guarded<T>(call: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|payload| {
        let kept = LAST_PANIC.lock().ok().and_then(|mut last| last.take());
        let said = kept.unwrap_or_else(|| message(&*payload).to_owned());
        let version = env!("CARGO_PKG_VERSION");
        Err(InternalError::new_err(format!(
            "a bug of bubbletouch {version} ({said}); please report it, with the call that led here"
        )))
    })
}

/// Converts an error of the Rust library to a Python exception.
pub fn exception(error: Error) -> PyErr {
    let said = error.to_string();
    match error {
        Error::Input { .. } => PyValueError::new_err(said),
        Error::Io { path, source, .. } => os_error(&path, &source, said),
        _ => PyRuntimeError::new_err(said),
    }
}

/// Creates an `OSError` with the message `said`. From the system's error number, Python chooses the subclass, such as `FileNotFoundError`.
pub fn os_error(path: &Path, source: &std::io::Error, said: String) -> PyErr {
    match source.raw_os_error() {
        Some(number) => PyOSError::new_err((number, said, path.display().to_string())),
        None => PyOSError::new_err(said),
    }
}

/// Creates a `ValueError` with the message `<where>: <what was given>; <what is allowed>`.
pub fn bad_input(place: impl ToString, given: impl ToString, allowed: impl ToString) -> PyErr {
    exception(Error::input(place, given, allowed))
}

/// Checks an optional number.
///
/// # Errors
/// If there is a number that is not allowed; `allowed` describes the allowed numbers.
pub fn check_number(
    place: &str,
    given: Option<f64>,
    allowed: &str,
    is_allowed: impl Fn(f64) -> bool,
) -> PyResult<()> {
    match given.filter(|number| !is_allowed(*number)) {
        Some(wrong) => Err(bad_input(place, wrong, allowed)),
        None => Ok(()),
    }
}

/// Returns the value of a name. `known` contains all names with their values.
///
/// # Errors
/// If the name is unknown; the error lists all names.
pub fn one_of<T: Copy>(place: &str, name: &str, known: &[(&str, T)]) -> PyResult<T> {
    let found = known.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        let (last, others) = names.split_last().expect("there are names");
        let allowed = format!("{} or {last}", others.join(", "));
        bad_input(place, format!("`{name}`"), allowed)
    })
}

/// Returns the value of a name, such as a unit, by its name in study files.
///
/// # Errors
/// If the name is unknown; the error lists all names.
pub fn named<T: DeserializeOwned>(place: &str, name: &str) -> PyResult<T> {
    serde_json::from_value(name.into()).map_err(|error| {
        let error = error.to_string();
        let allowed = error.split_once("expected ");
        let allowed = allowed.map_or(&*error, |(_, names)| names);
        bad_input(place, format!("`{name}`"), allowed)
    })
}

/// Issues notes as Python warnings; `level` is the number of the frame of the call stack that the warning names.
///
/// # Errors
/// If Python raises a warning as an exception.
pub fn warn(py: Python, notes: impl IntoIterator<Item: ToString>, level: i32) -> PyResult<()> {
    notes.into_iter().try_for_each(|note| {
        let note = CString::new(note.to_string()).unwrap_or_default();
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &note, level)
    })
}

/// Checks that the file at `path` exists and can be opened, before the library reads it.
///
/// # Errors
/// If the file does not exist or cannot be opened (`OSError`).
pub fn check_readable(path: &Path) -> PyResult<()> {
    // Opening a pipe would block until another process writes to it; the library rejects pipes.
    let opened = std::fs::metadata(path).and_then(|about| match about.is_file() {
        true => std::fs::File::open(path).map(drop),
        false => Ok(()),
    });
    opened.map_err(|error| os_error(path, &error, format!("{}: cannot be read", path.display())))
}

/// Checks that the folder of an output file exists.
///
/// # Errors
/// If the folder does not exist (`OSError`).
pub fn check_folder(path: &Path) -> PyResult<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let found = folder.map_or(Ok(()), |folder| std::fs::metadata(folder).map(drop));
    found.map_err(|error| {
        os_error(
            path,
            &error,
            format!("{}: cannot be written", path.display()),
        )
    })
}

/// Panics; used in tests of the conversion to an exception.
#[pyfunction]
pub fn _panic() -> PyResult<()> {
    guarded(|| panic!("asked for"))
}
