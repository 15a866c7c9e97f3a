//! Types that are read from study files.

/// What a file says, as a type that is read from its text.
macro_rules! toml_file {
    ($file:ident) => {
        impl $file {
            /// Reads a file.
            ///
            /// # Errors
            /// A key that is unknown, missing or of another type; it names the file, the line and the key.
            pub fn parse(place: &str, text: &str) -> $crate::Result<Self> {
                $crate::toml_text::read(place, text)
            }
        }
    };
}
pub(crate) use toml_file;

/// The file of a study: the keys that all of them begin with, and its own.
macro_rules! study_file {
    (pub struct $study:ident { $($(#[$of_field:meta])* pub $field:ident: $type:ty,)* }) => {
        /// The file.
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $study {
            /// What the study asks, in a sentence.
            pub question: String,
            /// What the author expected before it ran.
            #[serde(default)]
            pub expected: String,
            /// Root of all randomness.
            #[serde(default = "crate::studies::recognition::spec::study::default_seed")]
            pub seed: u64,
            $($(#[$of_field])* pub $field: $type,)*
        }

        $crate::study_file::toml_file!($study);
    };
}
pub(crate) use study_file;
