//! The kinds of study other than recognition.

mod asked;
mod breaking_points;
mod object_detail;
mod reconstruction;
mod stability;
mod whole_body;
