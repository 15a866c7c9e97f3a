//! Reader of recordings, which reads one row or one block of rows at a time.

use super::header::{Element, Member, RecordingHeader};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::inputs::arrays::npy_file::read_header;
use crate::signal::Quantity;
use crate::spelling::counted;
use glam::{DQuat, DVec3};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use zip::ZipArchive;
use zip::read::ZipFile;

/// Description of a valid recording, for error messages.
const A_RECORDING: &str = "a whole recording as bubbletouch writes it";

/// Recording that is open for reading. Header and times are in memory (8 bytes per frame, 48 per taxel); all other data stay on disk.
pub struct RecordingFile {
    path: PathBuf,
    archive: ZipArchive<BufReader<File>>,
    header: RecordingHeader,
    time: Vec<f64>,
}

impl RecordingFile {
    /// Opens a recording and checks that all its arrays exist and have the correct shapes.
    ///
    /// # Errors
    /// If the file cannot be read, or a member is missing, damaged or inconsistent with `meta`. Other members are ignored.
    pub fn open(path: &Path) -> Result<Self> {
        let file = crate::files::open(path).map_err(|e| Error::unreadable(path, A_RECORDING, e))?;
        let archive = ZipArchive::new(BufReader::new(file))
            .map_err(|e| Error::input(path.display(), format!("no .npz: {e}"), A_RECORDING))?;
        let mut open = Self {
            path: path.to_owned(),
            archive,
            header: RecordingHeader::default(),
            time: Vec::new(),
        };
        let meta = open.meta().map_err(|e| open.damaged("meta", e))?;
        open.header = RecordingHeader::of_meta(&meta).map_err(|e| open.damaged("meta", e))?;
        for patch in 0..open.header.patches.len() {
            let name = open.header.patches[patch].name.clone();
            open.header.patches[patch].centers = open.vectors(&format!("{name}/centers"))?;
            open.header.patches[patch].axes = open.vectors(&format!("{name}/axes"))?;
        }
        open.header.check().map_err(|e| open.damaged("meta", e))?;
        open.time = open.whole(&Member::new("time", Element::Double, &[]))?;
        let increases = open.time.is_sorted_by(|a, b| a < b);
        if !(increases && open.time.iter().all(|time| time.is_finite())) {
            return Err(open.damaged("time", "times that do not increase"));
        }
        for member in open.header.members() {
            let n_rows = open_rows(&mut open.archive, &member).map(|rows| rows.1);
            let n_rows = n_rows.map_err(|e| open.damaged(&member.name, e))?;
            if n_rows != open.time.len() {
                let given = format!(
                    "{} for {}",
                    counted(n_rows, "row"),
                    counted(open.time.len(), "frame")
                );
                return Err(open.damaged(&member.name, given));
            }
        }
        Ok(open)
    }

    /// Returns the header of the recording.
    pub fn header(&self) -> &RecordingHeader {
        &self.header
    }

    /// Returns the times of all frames, seconds.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Returns a quantity of a patch in one frame, one number per taxel: metres, or newtons (the length of force vectors). Only this row of the file is read,
    /// and no checksum is checked.
    ///
    /// # Errors
    /// If there is no such frame, or the file cannot be read.
    pub fn frame(&mut self, patch: usize, quantity: Quantity, frame: usize) -> Result<Vec<f64>> {
        if frame >= self.time.len() {
            let allowed = match self.time.len() {
                0 => "no frame: the recording is empty".to_owned(),
                n => format!("0 to {}", n - 1),
            };
            return Err(Error::input(
                self.path.display(),
                format!("frame {frame}"),
                allowed,
            ));
        }
        let member = self.header.member(patch, quantity);
        let row = read_row(&mut self.archive, &member, frame);
        row.map_err(|e| self.damaged(&member.name, e))
    }

    /// Returns the pose (world from body) of a patch or an object in one frame, given its name.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn pose(&mut self, name: &str, frame: usize) -> Result<Pose> {
        let member = Member::new(format!("{name}/pose"), Element::Double, &[7]);
        let row = read_row(&mut self.archive, &member, frame);
        let row = row.map_err(|e| self.damaged(&member.name, e))?;
        let rotation = DQuat::from_xyzw(row[4], row[5], row[6], row[3]);
        Ok(Pose::new(rotation, DVec3::from_slice(&row)))
    }

    /// Calls `visit(frame, values)` for a quantity of a patch in every frame, in order. The memory holds only one frame.
    ///
    /// The zip checksum is compared at the end.
    ///
    /// # Errors
    /// If the file cannot be read, or the checksum differs.
    pub fn each_frame(
        &mut self,
        patch: usize,
        quantity: Quantity,
        visit: impl FnMut(usize, &[f64]),
    ) -> Result<()> {
        let member = self.header.member(patch, quantity);
        self.visit(&member, visit)
    }

    fn visit(&mut self, member: &Member, visit: impl FnMut(usize, &[f64])) -> Result<()> {
        let visited = visit_rows(&mut self.archive, member, visit);
        visited.map_err(|e| self.damaged(&member.name, e))
    }

    /// Reads the JSON text of the archive member `meta`.
    fn meta(&mut self) -> io::Result<String> {
        let mut entry = self.archive.by_name("meta.npy")?;
        read_header("meta", &mut entry).map_err(io::Error::other)?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes)?;
        let code_points = bytes.as_chunks().0.iter().map(|&c| u32::from_le_bytes(c));
        Ok(code_points.filter_map(char::from_u32).collect())
    }

    fn vectors(&mut self, name: &str) -> Result<Vec<DVec3>> {
        let numbers = self.whole(&Member::new(name, Element::Double, &[3]))?;
        let vectors = numbers.as_chunks().0.iter();
        Ok(vectors.map(|&v: &[f64; 3]| DVec3::from(v)).collect())
    }

    fn whole(&mut self, member: &Member) -> Result<Vec<f64>> {
        let mut values = Vec::new();
        self.visit(member, |_, row| values.extend_from_slice(row))?;
        Ok(values)
    }

    fn damaged(&self, member: &str, given: impl ToString) -> Error {
        let place = format!("{}, member {member}", self.path.display());
        Error::input(place, given, A_RECORDING)
    }
}

/// Opens an archive member and reads its header; returns the member and its number of rows. This number is computed from the size in the zip directory and
/// must agree with the header. No memory is therefore allocated for a wrong header. An error describes a missing or invalid member.
fn open_rows<'a>(
    archive: &'a mut ZipArchive<BufReader<File>>,
    member: &Member,
) -> io::Result<(ZipFile<'a, BufReader<File>>, usize)> {
    let mut entry = archive.by_name(&format!("{}.npy", member.name))?;
    let header = read_header(&member.name, &mut entry).map_err(io::Error::other)?;
    let n_bytes = entry.size().saturating_sub(header.n_bytes);
    let row_bytes = member.row_bytes() as u64;
    let n_rows = (n_bytes / row_bytes) as usize;
    let checked = header.check(&member.name, &member.descr(), &member.shape(n_rows));
    checked.map_err(io::Error::other)?;
    match n_bytes % row_bytes {
        0 => Ok((entry, n_rows)),
        _ => Err(io::Error::other(format!(
            "{n_bytes} bytes for rows of {row_bytes}"
        ))),
    }
}

/// Calls `visit` for each row of an array in the archive. The zip checksum is compared at the end.
fn visit_rows(
    archive: &mut ZipArchive<BufReader<File>>,
    member: &Member,
    mut visit: impl FnMut(usize, &[f64]),
) -> io::Result<()> {
    let (mut entry, n_rows) = open_rows(archive, member)?;
    let mut bytes = vec![0; member.row_bytes()];
    for row in 0..n_rows {
        entry.read_exact(&mut bytes)?;
        visit(row, &decode(&bytes, member));
    }
    // The checksum is compared only at the end of the member.
    entry.read_to_end(&mut bytes).map(drop)
}

fn read_row(
    archive: &mut ZipArchive<BufReader<File>>,
    member: &Member,
    row: usize,
) -> io::Result<Vec<f64>> {
    let mut entry = archive.by_name_seek(&format!("{}.npy", member.name))?;
    let header = read_header(&member.name, &mut entry).map_err(io::Error::other)?;
    let mut bytes = vec![0; member.row_bytes()];
    let before = header.n_bytes + (row * bytes.len()) as u64;
    entry.seek(SeekFrom::Start(before))?;
    entry.read_exact(&mut bytes)?;
    Ok(decode(&bytes, member))
}

/// Decodes the numbers in one row of an array; force vectors are converted to their lengths, one per taxel.
fn decode(bytes: &[u8], member: &Member) -> Vec<f64> {
    let numbers: Vec<f64> = match member.element {
        Element::Single => {
            let singles = bytes.as_chunks().0.iter();
            singles.map(|&b| f32::from_le_bytes(b).into()).collect()
        }
        Element::Double => {
            let doubles = bytes.as_chunks().0.iter();
            doubles.map(|&b| f64::from_le_bytes(b)).collect()
        }
    };
    if member.row.len() < 2 {
        return numbers;
    }
    let vectors = numbers.as_chunks().0.iter();
    vectors.map(|&v| DVec3::from_array(v).length()).collect()
}
