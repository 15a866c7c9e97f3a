//! Files that are complete or absent; none replaces a file that the command reads.
//!
//! | file | contents |
//! |---|---|
//! | `inputs` | files that the command reads, which no output may replace |
//! | `whole_file` | files written under another name, then renamed ([`WholeFile`]) |
//! | `csv_file` | tables that grow row by row ([`CsvFile`]) |
//! | `owned` | files of an output folder that the program wrote ([`OwnedFiles`]) |
//! | `file_path` | paths that are relative to the file which names them ([`FilePath`]) |

mod csv_file;
mod file_path;
mod inputs;
mod owned;
mod whole_file;

pub use csv_file::{CsvFile, table_error};
pub use file_path::{
    FilePath, SetName, file_path, optional_file_path, with_absolute_paths, with_folder,
};
pub use inputs::{check_output, input_within, open, protect_inputs, read, read_to_string};
pub use owned::{DataFolder, MANIFEST_FILE, OwnedFiles, RUN, check_single_output};
pub use whole_file::{WholeFile, write_bytes, write_whole};
