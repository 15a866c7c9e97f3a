//! `bubbletouch schema`: JSON Schemas of study and scene files.

use crate::command::terminal::say;
use bubbletouch::Result;
use bubbletouch::schema::{scene_schema, study_schema};
use clap::ValueEnum;

/// Print the JSON Schema of study or scene files
///
/// Editors with TOML support complete and check keys with the schema. The first line of the file names it: #:schema study.schema.json
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch schema study > study.schema.json")]
pub struct Args {
    /// Print the schema of this kind of file
    file: SchemaOf,
}

/// Kind of file for which a schema is written.
#[derive(Clone, Copy, ValueEnum)]
enum SchemaOf {
    /// Study files of all kinds
    Study,
    /// Scene files
    Scene,
}

/// Prints a schema.
pub fn schema(args: &Args) -> Result<()> {
    let schema = match args.file {
        SchemaOf::Study => study_schema(),
        SchemaOf::Scene => scene_schema(),
    };
    say(format_args!("{schema:#}"))
}
