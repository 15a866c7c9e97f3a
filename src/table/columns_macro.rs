//! The one place in which a row says what its fields are.

/// Says what each field of a row is: `field: Role "words" in "unit": Scale between [low, high] named NAMES, optional;` of which the words and all after
/// them may be left out: words are then the field's name, and the scale is that of words. `NAMES` is a constant that says what people call
/// codes, as `[("rbf_svm", "RBF SVM")]`.
///
/// ```
/// use bubbletouch::columns;
/// #[derive(serde::Serialize)]
/// struct Row {
///     method: String,
///     step_s: f64,
///     error: f64,
///     error_low: f64,
///     error_high: f64,
/// }
/// columns! { Row {
///     method: Choice "method";
///     step_s: Choice "time step" in "s": Log;
///     error: Value(Less) "deflection error": Log between [error_low, error_high];
///     error_low: Note: Log;
///     error_high: Note: Log;
/// } }
/// ```
/// A field that is left out, or a name that is no field, does not compile.
#[macro_export]
macro_rules! columns {
    ($row:ident { $($field:ident: $role:ident $(($better:ident))? $($words:literal)? $(in $unit:literal)? $(: $scale:ident)?
        $(between [$low:ident, $high:ident])? $(named $names:path)? $(, $optional:ident)?;)* }) => {
        const _: fn(&$row) = |$row { $($field: _),* }| ();

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
                    $(let column = column.between(stringify!($low), stringify!($high));)?
                    $(let column = column.named($names);)?
                    $(let column = column.$optional();)?
                    column
                }),*]
            }
        }
    };
}

/// A row of a table: a struct, and what each of its fields is, as [`columns!`](crate::columns) says it behind the field's type.
///
/// ```
/// use bubbletouch::row;
/// row! {
/// /// What was found.
/// pub struct Row {
///     /// How it is simulated.
///     method: String => Choice;
///     /// Σ |δ − δ*| / Σ δ*.
///     error: f64 => Value(Less) "deflection error": Log;
/// } }
/// let row = Row { method: "press".to_owned(), error: 0.1 };
/// let found = bubbletouch::table::File::new("found.csv", "Found", "").of(&[row]);
/// assert_eq!(found.unwrap().csv, b"method,error\npress,0.1\n");
/// ```
#[macro_export]
macro_rules! row {
    ($(#[$of_row:meta])* pub struct $row:ident { $($(#[$of_field:meta])* $field:ident: $type:ty =>
        $role:ident $(($better:ident))? $($words:literal)? $(in $unit:literal)? $(: $scale:ident)?
        $(between [$low:ident, $high:ident])? $(named $names:path)? $(, $optional:ident)?;)* }) => {
        $(#[$of_row])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $row {
            $($(#[$of_field])* pub $field: $type,)*
        }

        $crate::columns! { $row {
            $($field: $role $(($better))? $($words)? $(in $unit)? $(: $scale)? $(between [$low, $high])? $(named $names)? $(, $optional)?;)*
        } }
    };
}
