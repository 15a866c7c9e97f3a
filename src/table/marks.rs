//! List of the marks of charts. Each mark is a variant of [`Mark`](super::Mark) and a file in `report/chart/marks` that draws it.

/// Calls a macro with a list of all mark types of charts; each entry has a documentation, a variant with columns, and a file.
macro_rules! for_each_mark {
    ($declare:ident) => {
        $declare! {
            /// Points joined by lines along x. If the x column contains words, the points are not joined.
            #[default]
            Line line;
            /// Points that are not joined by lines.
            Points points;
            /// One coloured tile for each pair of x and y values.
            Tiles {
                /// Column that determines the colour of the tiles: outcomes with one colour each, or numbers on a sequential colour scale.
                fill: String,
            } tiles;
        }
    };
}

pub(crate) use for_each_mark;
