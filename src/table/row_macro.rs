//! Macro that defines a row type together with its columns.

/// Defines a type of table rows: a struct in which the type of each field is followed by a description of the table column.
///
/// The description has the form `=> Role "words" in "unit": Scale between [low, high] named NAMES, optional;`. All parts after the role may be
/// left out. The default words are the field's name, and the default scale is `Words`. `NAMES` is a constant with the display names of codes, as
/// `[("rbf_svm", "RBF SVM")]`.
///
/// ```
/// use bubbletouch::row;
/// row! {
/// /// What was found.
/// pub struct Row {
///     /// How it is simulated.
///     method: String => Choice;
///     /// Seconds from one state to the next.
///     step_s: f64 => Choice "time step" in "s": Log;
///     /// Σ |δ − δ*| / Σ δ*.
///     error: f64 => Value(Less) "deflection error": Log;
/// } }
/// let row = Row { method: "press".to_owned(), step_s: 0.5, error: 0.1 };
/// let found = bubbletouch::table::File::new("found.csv", "Found", "").table(&[row]);
/// assert_eq!(found.unwrap().csv, b"method,step_s,error\npress,0.5,0.1\n");
/// ```
/// A field without a description does not compile.
#[macro_export]
macro_rules! row {
    ($(#[$of_row:meta])* pub struct $row:ident { $($(#[$($of_field:tt)*])* $field:ident: $type:ty =>
        $role:ident $(($better:ident))? $($words:literal)? $(in $unit:literal)? $(: $scale:ident)?
        $(between [$low:ident, $high:ident])? $(named $names:path)? $(, $optional:ident)?;)* }) => {
        $(#[$of_row])*
        #[derive(Clone, Debug, PartialEq, $crate::serde::Serialize, $crate::serde::Deserialize)]
        #[serde(crate = "bubbletouch::serde")]
        pub struct $row {
            $($(#[$($of_field)*])* pub $field: $type,)*
        }

        impl $crate::table::Columns for $row {
            fn columns() -> Vec<$crate::table::Column> {
                vec![$({
                    let role = $crate::table::Role::$role $(($crate::table::Better::$better))?;
                    #[allow(unused_mut, unused_assignments)]
                    let mut words = stringify!($field).replace('_', " ");
                    $(words = $words.to_owned();)?
                    #[allow(unused_mut, unused_assignments)]
                    let mut unit = "";
                    $(unit = $unit;)?
                    #[allow(unused_mut, unused_assignments)]
                    let mut scale = $crate::table::Scale::Words;
                    $(scale = $crate::table::Scale::$scale;)?
                    let column = $crate::table::Column::new(stringify!($field), role, words, unit, scale);
                    let column = column.meaning($crate::doc_of!($(#[$($of_field)*])*));
                    $(let column = column.between(stringify!($low), stringify!($high));)?
                    $(let column = column.named($names);)?
                    $(let column = column.$optional();)?
                    column
                }),*]
            }
        }
    };
}

/// Returns the text of the given doc comments, with line breaks; other attributes are ignored.
#[doc(hidden)]
#[macro_export]
macro_rules! doc_of {
    (@ [$($line:literal)*]) => { concat!($($line, "\n"),*) };
    (@ [$($line:literal)*] #[doc = $next:literal] $($rest:tt)*) => { $crate::doc_of!(@ [$($line)* $next] $($rest)*) };
    (@ [$($line:literal)*] #[$($other:tt)*] $($rest:tt)*) => { $crate::doc_of!(@ [$($line)*] $($rest)*) };
    (@ $($wrong:tt)*) => { compile_error!("attributes") };
    ($($attributes:tt)*) => { $crate::doc_of!(@ [] $($attributes)*) };
}
