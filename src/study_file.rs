//! Macros that declare types of study files.

/// Implements `parse` for a type that is read from the text of a TOML file.
#[doc(hidden)]
#[macro_export]
macro_rules! toml_file {
    ($file:ident) => {
        impl $file {
            /// Parses the text of a TOML file. `place` is the name of the file in error messages.
            ///
            /// # Errors
            /// If a key is unknown, missing or of another type; the error names the file, the line and the key.
            pub fn parse(place: &str, text: &str) -> $crate::Result<Self> {
                $crate::toml_text::read(place, text)
            }
        }
    };
}
pub(crate) use crate::toml_file;

/// Declares the keys of a study file: those that all study files share, and those of a kind.
#[macro_export]
macro_rules! study_file {
    (pub struct $study:ident { $($of_kind:tt)* }) => {
        $crate::params! {
            /// Contents of a study file.
            pub struct $study {
                /// Question that the study answers, in one sentence.
                question: String => $crate::inputs::range::Range::Unchecked, Note, Never;
                /// Answer that the author expected before the first run. Default: empty.
                expected: String = String::new() => $crate::inputs::range::Range::Unchecked, Note, Never;
                /// Seed of all random numbers. Default: 2018.
                seed: u64 = $crate::studies::recognition::spec::study::DEFAULT_SEED => $crate::inputs::range::Range::Unchecked, Subject, Never;
                $($of_kind)*
            }
        }

        $crate::toml_file!($study);

        impl $study {
            /// Reads the keys of a study; the seed of the command line replaces that of the file.
            ///
            /// # Errors
            /// If a key is unknown, missing or of another type, or the seed is out of its range.
            pub(crate) fn of(source: &$crate::studies::Source) -> $crate::Result<Self> {
                let spec = Self::parse(&source.place, &source.text)?;
                let seed = source.seed(spec.seed)?;
                Ok(Self { seed, ..spec })
            }
        }
    };
}
