//! Description of an array layout, with the functions that create and project its taxels.

use crate::error::Result;
use crate::world::ImageShape;
use crate::world::{Grid, Layout};
use glam::{DVec2, DVec3};

/// Description of an array layout, with the functions that create its taxels and project them onto a plane.
pub struct LayoutAbout {
    /// Display name of the layout.
    pub words: &'static str,
    /// Function that creates the taxels on the area of a square grid; the second argument is the radius of curvature, metres.
    pub taxels: fn(&Grid, f64) -> Result<Layout>,
    /// Function that returns the numbers of rows and columns; `None` if taxels are not numbered row by row.
    pub sides: fn(&Grid) -> Option<ImageShape>,
    /// Limits of the curvature; `None` for a flat layout.
    pub curved: Option<Curved>,
    /// Distance between neighbouring taxels, in pitches; `None` if the distance is about one pitch.
    pub neighbour_pitches: Option<f64>,
    /// Largest distance between neighbouring rows or columns of taxels, in pitches.
    pub widest_pitches: f64,
    /// Whether the taxels lie in straight rows and columns, one pitch apart along the surface.
    pub is_image: bool,
    /// Function that returns a taxel's position on a plane, metres, from its centre and the radius of curvature.
    pub place_on_plane: fn(DVec3, f64) -> DVec2,
}

/// Limits of the curvature of a curved layout.
pub struct Curved {
    /// Function that returns the smallest radius of curvature, metres, for a square array with the given side, metres.
    pub least_radius: fn(f64) -> f64,
    /// Words that describe the part of the shape covered at the smallest radius, such as half a turn.
    pub half: &'static str,
}

impl LayoutAbout {
    /// Describes a flat layout without rows of taxels, with its display name and the function that creates its taxels.
    pub const fn new(words: &'static str, taxels: fn(&Grid, f64) -> Result<Layout>) -> Self {
        Self {
            words,
            taxels,
            sides: |_| None,
            curved: None,
            neighbour_pitches: None,
            widest_pitches: 1.0,
            is_image: false,
            place_on_plane: |center, _| center.truncate(),
        }
    }
}

/// Declares the array layouts from a list: the name of each layout, the file that describes it, and its documentation.
macro_rules! array_layouts {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Layout of the taxels of an array.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum ArrayLayout {
            $(#[doc = $doc] $name,)*
        }

        /// The default is the first layout of the list.
        impl Default for ArrayLayout {
            fn default() -> Self {
                Self::ALL[0]
            }
        }

        impl ArrayLayout {
            /// All array layouts, in the order of the list.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Returns the description of the layout.
            const fn about(self) -> &'static LayoutAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
