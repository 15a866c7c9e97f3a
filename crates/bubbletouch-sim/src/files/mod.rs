//! Output files that are either complete or absent, and protection of input files from being overwritten.
//!
//! | file | contents |
//! |---|---|
//! | `inputs` | input files of the command, which no output may replace |
//! | `whole_file` | files that are written under a temporary name and then renamed ([`WholeFile`]) |
//! | `csv_file` | tables that are written row by row ([`CsvFile`]) |
//! | `owned` | files of an output folder that the program wrote ([`OwnedFiles`]) |
//! | `file_path` | paths relative to the file that contains them ([`FilePath`]) |
//! | `spellings` | names of files in robots and meshes, which other programs write in several ways |

mod csv_file;
mod file_path;
mod inputs;
mod owned;
mod spellings;
mod whole_file;

pub use csv_file::CsvFile;
pub use file_path::{
    FilePath, SetName, file_path, optional_file_path, with_absolute_paths, with_folder,
};
pub use inputs::{
    check_content, check_output, input_within, open, protect_inputs, read, read_to_string,
};
pub use owned::{DataFolder, MANIFEST_FILE, OwnedFiles, RUN, check_single_output, has_table};
pub(crate) use spellings::spellings;
pub use whole_file::{WholeFile, write_bytes, write_whole};
