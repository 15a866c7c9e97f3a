//! Recordings: skin readings over time, written frame by frame to an `.npz` file that NumPy opens.
//!
//! [`RecordingWriter`] receives the frames of a scene and writes a zip file of `.npy` members. The members are stored without compression, as ZIP64 if
//! necessary. `np.load(path)` opens the file without pickle. Only a block of rows is in memory: earlier blocks are stored in an unnamed temporary file
//! until the recording is complete. [`RecordingFile`] reads a recording row by row.
//!
//! | member | shape | holds |
//! |---|---|---|
//! | `meta` | () | JSON text: `json.loads(archive["meta"].item())` |
//! | `time` | n_frames | f64, seconds, increasing |
//! | `PATCH/centers` | n_taxels × 3 | f64, metres, patch frame: where the taxels rest |
//! | `PATCH/axes` | n_taxels × 3 | f64, unit vectors, patch frame: away from the substrate |
//! | `PATCH/deflection` | n_frames × n_taxels | f32, metres |
//! | `PATCH/force` | n_frames × n_taxels (normal) or n_frames × n_taxels × 3 (vectors, patch frame) | f32, newtons |
//! | `PATCH/signal` | n_frames × n_taxels, of a patch with a signal | f32, metres or newtons (`meta` says which) |
//! | `PATCH/pose` | n_frames × 7 | f64, world from patch: x, y, z in metres, unit quaternion w, x, y, z |
//! | `OBJECT/pose` | n_frames × 7 | f64, world from object, the same |
//!
//! `meta` is a JSON object with `format` ("bubbletouch recording"), `version` (1), `patches`, `objects` (names) and `about` (any metadata of the writer). Each
//! patch has `name`, `n_taxels` and `force` ("normal" or "vector"). If the taxels form a grid, the patch also has `grid` with `nx`, `ny` and `pitch_m`, where
//! taxel = row · nx + column.
//!
//! [`skin_picture`] draws still pictures of recordings, [`animation`] draws moving ones with the scene beside the skin.

pub mod animation;
pub(super) mod cells;
mod header;
mod reader;
mod scene_view;
pub mod skin_picture;
mod summary;
mod writer;

pub use header::{ForceKind, RecordedPatch, RecordingHeader};
pub use reader::RecordingFile;
pub use summary::recording_table;
pub use writer::RecordingWriter;
