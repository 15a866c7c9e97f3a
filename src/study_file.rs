//! Macros that implement reading for types of study files.

/// Implements `parse` for a type that is read from the text of a TOML file.
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
pub(crate) use toml_file;

/// Defines the type of a study file, with the keys that all study files share and the keys of a kind.
macro_rules! study_file {
    (pub struct $study:ident { $($(#[$of_field:meta])* pub $field:ident: $type:ty,)* }) => {
        /// Contents of a study file.
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $study {
            /// Question that the study answers, in one sentence.
            pub question: String,
            /// Answer that the author expected before the first run. Default: empty.
            #[serde(default)]
            pub expected: String,
            /// Seed of all random numbers. Default: 2018.
            #[serde(default = "crate::studies::recognition::spec::study::default_seed")]
            pub seed: u64,
            $($(#[$of_field])* pub $field: $type,)*
        }

        $crate::study_file::toml_file!($study);
    };
}
pub(crate) use study_file;
