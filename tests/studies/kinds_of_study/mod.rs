//! Kinds of studies other than recognition.

mod asked;
mod object_detail;
mod reconstruction;
mod stability;
mod whole_body;
