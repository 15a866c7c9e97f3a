//! Contents of array files: shape, element type and elements, and the names of columns.

use crate::error::{Error, Result};
use crate::inputs::arrays::csv_table::{self, TableContent};
use crate::inputs::arrays::npy_file;
use crate::note::note;
use ndarray::{Array2, ArrayD, IxDyn};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Kind of the elements of an array file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKind {
    /// Floating-point numbers; the value is the relative spacing of neighbouring numbers.
    Float(f64),
    /// Signed or unsigned integers.
    Integer,
    /// Truth values (booleans).
    Truth,
    /// Texts in Unicode or ASCII.
    Text,
}

/// Elements of an array in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements {
    /// Numbers; false is stored as 0, and true as 1.
    Numbers(Vec<f64>),
    /// Texts without the padding zeros of fixed-length texts.
    Texts(Vec<String>),
}

/// Array as it is stored in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// Name of the file and of the archive member, for error messages.
    pub place: String,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// Kind of the elements: floating-point numbers, integers, truth values or texts.
    pub kind: ElementKind,
    /// Elements of the array in row-major order.
    pub elements: Elements,
    /// Names of the columns of a table; `None` for other files and for a table without names.
    pub columns: Option<Vec<String>>,
    /// Place, given and allowed content of the error of the first text in a table; `None` for other files.
    pub refusal: Option<[String; 3]>,
}

/// File format from which an array is read.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Npy,
    Npz,
    Csv,
}

const ALLOWED: &str = "an array of numbers in a .npy, .npz or .csv file";

impl FileArray {
    /// Reads the array `name` from a file. In an archive, the name selects a member; in other files it is ignored.
    ///
    /// # Errors
    /// If the file does not exist, contains no such array, or its elements are neither numbers nor texts.
    pub fn read(path: &Path, name: &str) -> Result<Self> {
        Self::read_content(path, name, TableContent::Any)
    }

    /// Reads the array `name` from a file, as [`Self::read`] does. In a table, `content` decides which lines and columns are data; a note states what is
    /// left out.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`]. If the columns of frames are of several families, or columns are chosen in a file without names of columns.
    pub fn read_content(path: &Path, name: &str, content: TableContent) -> Result<Self> {
        let of_table = |(array, notes): (Self, Vec<String>)| {
            notes.iter().for_each(note);
            array
        };
        with_array(path, name, content, npy_file::read, of_table)
    }

    /// Returns the axis lengths of the array `name` in a file. If the file is a `.npy` file, only the header is read.
    ///
    /// # Errors
    /// If the file does not exist, or contains no such array.
    pub fn shape_of(path: &Path, name: &str, content: TableContent) -> Result<Vec<usize>> {
        let of_npy =
            |place: &str, reader: &mut dyn Read, _| Ok(npy_file::read_header(place, reader)?.shape);
        with_array(path, name, content, of_npy, |(array, _)| array.shape)
    }

    /// Checks the names of the columns as [`check_names`] does, against the columns `first` of a file of frames at `place`.
    ///
    /// # Errors
    /// If a name differs.
    pub fn check_columns_of(&self, first: Option<&[String]>, place: &str) -> Result<()> {
        check_names(&self.place, [self.columns.as_deref(), first], place)
    }

    /// Converts the elements of the array to numbers, with the shape of the array.
    ///
    /// # Errors
    /// If the elements are texts.
    pub fn into_numbers(self) -> Result<ArrayD<f64>> {
        match self.elements {
            Elements::Numbers(numbers) => {
                let numbers = ArrayD::from_shape_vec(IxDyn(&self.shape), numbers);
                Ok(numbers.expect("one element for each place"))
            }
            Elements::Texts(_) => {
                let texts = || [self.place, "texts".to_owned(), "numbers".to_owned()];
                let [place, given, allowed] = self.refusal.unwrap_or_else(texts);
                Err(Error::input(place, given, allowed))
            }
        }
    }
}

/// Checks that the columns of a table at `place` have the names of the columns of another table, `first`, in their order. Tables without names, and tables with
/// another number of columns, are not compared.
///
/// # Errors
/// If a name differs.
pub fn check_names(
    place: &str,
    [own, of_first]: [Option<&[String]>; 2],
    first: &str,
) -> Result<()> {
    let [own, of_first] = [own, of_first].map(Option::unwrap_or_default);
    let differs = || own.iter().zip(of_first).find(|(own, first)| own != first);
    match (own.len() == of_first.len()).then(differs).flatten() {
        None => Ok(()),
        Some((own, wanted)) => {
            let given = format!("column `{own}` in the place of `{wanted}`");
            let allowed = format!("the columns of {first}, in their order");
            Err(Error::input(place, given, allowed))
        }
    }
}

/// Opens an array and calls `of_npy` with its place for error messages, its bytes in `.npy` format and their number; or `of_table` with a table and its notes.
fn with_array<T>(
    path: &Path,
    name: &str,
    content: TableContent,
    of_npy: impl FnOnce(&str, &mut dyn Read, u64) -> Result<T>,
    of_table: impl FnOnce((FileArray, Vec<String>)) -> T,
) -> Result<T> {
    let file = open(path)?;
    let format = format_of(path)?;
    check_columns(path, format, content)?;
    match format {
        Format::Npy => {
            let place = path.display().to_string();
            let length = file.metadata().map_err(|e| Error::io(path, "read", e))?;
            of_npy(&place, &mut BufReader::new(file), length.len())
        }
        Format::Npz => with_member(path, name, of_npy),
        Format::Csv => csv_table::read(path, content).map(of_table),
    }
}

/// Returns an error if columns are chosen in a file that is no table.
fn check_columns(path: &Path, format: Format, content: TableContent) -> Result<()> {
    match content {
        TableContent::Frames {
            columns: Some(columns),
            key,
        } if format != Format::Csv => {
            let given = format!("{key}{columns:?} beside an array without names of columns");
            let allowed = "a table in a .csv, .tsv or .txt file, or all readings of the array";
            Err(Error::input(path.display(), given, allowed))
        }
        _ => Ok(()),
    }
}

/// Names of the columns of a table; `None` for arrays and for tables without a header.
pub type ColumnNames = Option<Vec<String>>;

/// Reads a matrix of numbers or booleans of any type, with the names of its columns.
///
/// # Errors
/// If the file does not exist, or contains no matrix of numbers.
pub fn read_matrix(path: &Path, name: &str) -> Result<(Array2<f64>, ColumnNames)> {
    const ALLOWED: &str = "n × m of float64, float32, float16, int8 to int64, uint8 to uint64 or bool, in a .npy, .npz or .csv file";
    let mut array = FileArray::read(path, name)?;
    let [rows, columns] = array.shape[..] else {
        let given = format!("an array of shape {:?}", array.shape);
        return Err(Error::input(array.place, given, ALLOWED));
    };
    let names = array.columns.take();
    let numbers = array.into_numbers()?;
    let matrix = numbers.into_shape_with_order((rows, columns));
    Ok((matrix.expect("one element for each place"), names))
}

/// Returns the names of the arrays of a `.npz` archive.
///
/// # Errors
/// If the file is not an archive.
pub fn member_names(path: &Path) -> Result<Vec<String>> {
    let archive = zip::ZipArchive::new(BufReader::new(open(path)?));
    let archive = archive.map_err(|_| Error::input(path.display(), "no archive", "a .npz file"))?;
    let names = archive
        .file_names()
        .map(|name| name.trim_end_matches(".npy").to_owned());
    Ok(names.collect())
}

/// Returns whether the array `name` is one of the arrays in a `.npz` archive; `false` for other files.
pub fn is_member(path: &Path, name: &str) -> bool {
    let is_archive = matches!(format_of(path), Ok(Format::Npz));
    is_archive && member_names(path).is_ok_and(|names| names.iter().any(|own| own == name))
}

fn open(path: &Path) -> Result<File> {
    let refuse = |why: String| {
        let given = format!("cannot be read ({why})");
        Error::input(path.display(), given, ALLOWED)
    };
    let file = crate::files::open(path).map_err(|error| refuse(error.to_string()))?;
    match file.metadata().is_ok_and(|about| about.is_dir()) {
        true => Err(refuse("it is a folder".to_owned())),
        false => Ok(file),
    }
}

/// Determines the format of an array file from its first bytes; for text files, from the extension.
fn format_of(path: &Path) -> Result<Format> {
    let mut start = [0; 6];
    let mut file = open(path)?;
    let mut n_read = 0;
    while let Ok(n @ 1..) = file.read(&mut start[n_read..]) {
        n_read += n;
    }
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    match (&start[..n_read], ending.as_deref()) {
        (b"\x93NUMPY", _) => Ok(Format::Npy),
        ([b'P', b'K', 3, 4, ..], _) => Ok(Format::Npz),
        (_, Some("csv" | "tsv" | "txt")) => Ok(Format::Csv),
        _ => Err(Error::input(
            path.display(),
            "a file that begins neither as a .npy nor as a .npz file",
            ALLOWED,
        )),
    }
}

/// Opens a member of an archive and calls `read` with its name for error messages, its bytes, and its number of bytes.
fn with_member<T>(
    path: &Path,
    name: &str,
    read: impl FnOnce(&str, &mut dyn Read, u64) -> Result<T>,
) -> Result<T> {
    let refuse = |given: String, allowed: String| Error::input(path.display(), given, allowed);
    let broken = |_| refuse("a damaged archive".to_owned(), ALLOWED.to_owned());
    let mut archive = zip::ZipArchive::new(BufReader::new(open(path)?)).map_err(broken)?;
    let members: Vec<String> = archive.file_names().map(str::to_owned).collect();
    let wanted = format!("{name}.npy");
    let member = match members.iter().find(|member| **member == wanted) {
        Some(member) => member,
        None if members.len() == 1 => &members[0],
        None => {
            let names = members.iter().map(|member| member.trim_end_matches(".npy"));
            let names: Vec<&str> = names.collect();
            let given = format!("arrays {}", names.join(", "));
            return Err(refuse(given, format!("an array `{name}`, or a single one")));
        }
    };
    let mut entry = archive.by_name(member).map_err(broken)?;
    let place = format!(
        "{}, array `{}`",
        path.display(),
        member.trim_end_matches(".npy")
    );
    let length = entry.size();
    read(&place, &mut entry, length)
}
