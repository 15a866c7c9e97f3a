//! A recording read back from its file, a row or a block of rows at a time.

use super::header::{RecordedPatch, RecordingHeader, Stream};
use super::npy::{Element, NpyHeader};
use super::rows::{decode, read_rows};
use crate::error::{Error, Result};
use crate::signal::Quantity;
use glam::DVec3;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// What is asked for where there is none.
const A_RECORDING: &str = "a whole recording as bubbletouch writes it";

/// An open recording: header and times in memory (8 bytes a frame, 48 a taxel), the rest on disk.
pub struct RecordingFile {
    path: PathBuf,
    archive: ZipArchive<BufReader<File>>,
    header: RecordingHeader,
    time: Vec<f64>,
    streams: HashMap<String, Stream>,
}

impl RecordingFile {
    /// Opens a recording and checks that its members are all there and of the right shapes.
    ///
    /// The error says why the file cannot be read, or which member is missing, damaged or not as `meta` says. Members that do
    /// not belong to a recording are let be.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::unreadable(path, A_RECORDING, e))?;
        let archive = ZipArchive::new(BufReader::new(file))
            .map_err(|e| Error::input(path.display(), format!("no .npz: {e}"), A_RECORDING))?;
        let mut open = Self {
            path: path.to_owned(),
            archive,
            header: RecordingHeader::default(),
            time: Vec::new(),
            streams: HashMap::new(),
        };
        open.header = open.read_meta()?;
        for patch in 0..open.header.patches.len() {
            let name = open.header.patches[patch].name.clone();
            open.header.patches[patch].centers = open.vectors(&name, "centers")?;
            open.header.patches[patch].axes = open.vectors(&name, "axes")?;
        }
        open.header
            .check()
            .map_err(|e| open.damaged("meta", e, "as it was written"))?;
        open.time = open.whole("time", &[])?;
        let n_frames = open.time.len();
        for stream in open.header.streams() {
            open.check_member(&stream.name, stream.element, &stream.shape(n_frames))?;
            open.streams.insert(stream.name.clone(), stream);
        }
        Ok(open)
    }

    /// What the recording is of.
    pub fn header(&self) -> &RecordingHeader {
        &self.header
    }

    /// Seconds, one a frame.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// The number of a patch by its name; the error lists the names there are.
    pub fn patch(&self, name: &str) -> Result<usize> {
        let mut names = self.header.patches.iter().map(|patch| &patch.name);
        let found = names.position(|known| known == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.header.patches.iter().map(|p| &p.name[..]).collect();
            Error::input(
                self.path.display(),
                format!("no patch {name}"),
                format!("one of its patches: {}", names.join(", ")),
            )
        })
    }

    /// What a member with one row a frame has of one frame; what stands before it is not read, and no checksum compared.
    ///
    /// `member` is its name (`time`, `PATCH/deflection`, …). Errors: no such member or frame; a file that cannot be read.
    pub fn row(&mut self, member: &str, frame: usize) -> Result<Vec<f64>> {
        if frame >= self.time.len() {
            return Err(Error::input(
                self.path.display(),
                format!("frame {frame}"),
                match self.time.len() {
                    0 => "no frame: the recording is empty".to_owned(),
                    n => format!("0 to {}", n - 1),
                },
            ));
        }
        let stream = self.stream(member)?;
        let mut bytes = vec![0; stream.row_bytes()];
        self.read_row(member, frame, &mut bytes)
            .map_err(|e| self.damaged(member, e, "rows as they were written"))?;
        let mut values = Vec::new();
        decode(&bytes, stream.element, &mut values);
        Ok(values)
    }

    fn read_row(&mut self, member: &str, frame: usize, bytes: &mut [u8]) -> io::Result<()> {
        let mut entry = self.archive.by_name_seek(&format!("{member}.npy"))?;
        let (_, start) = NpyHeader::read(&mut entry)?;
        let before = start as u64 + frame as u64 * bytes.len() as u64;
        entry.seek(SeekFrom::Start(before))?;
        entry.read_exact(bytes)
    }

    /// What a patch reported in one frame, one number a taxel: metres, or newtons (of vectors, the length).
    pub fn frame(&mut self, patch: usize, quantity: Quantity, frame: usize) -> Result<Vec<f64>> {
        let member = self.member_of(patch, quantity);
        let row = self.row(&member, frame)?;
        Ok(self.per_taxel(patch, row))
    }

    /// Visits what a patch reported in every frame, in time's order: `visit(frame, values)`; a megabyte of memory.
    ///
    /// The zip's checksum is checked at the end: then it is an error if a bit has changed.
    pub fn each_frame(
        &mut self,
        patch: usize,
        quantity: Quantity,
        mut visit: impl FnMut(usize, &[f64]),
    ) -> Result<()> {
        let n_components = self.n_components(patch, quantity);
        let mut lengths = Vec::new();
        let member = self.member_of(patch, quantity);
        self.each_row(&member, |frame, row| {
            if n_components == 1 {
                return visit(frame, row);
            }
            lengths.clear();
            lengths.extend(row.as_chunks().0.iter().map(|&v: &[f64; 3]| length(v)));
            visit(frame, &lengths);
        })
    }

    /// Visits the rows of a member in time's order; otherwise as [`each_frame`](Self::each_frame).
    pub fn each_row(&mut self, member: &str, mut visit: impl FnMut(usize, &[f64])) -> Result<()> {
        let stream = self.stream(member)?;
        let n_frames = self.time.len();
        let read = read_rows(&mut self.archive, &stream, n_frames, &mut visit);
        read.map_err(|e| self.damaged(member, e, "rows as they were written"))
    }

    fn member_of(&self, patch: usize, quantity: Quantity) -> String {
        format!("{}/{}", self.header.patches[patch].name, quantity.name())
    }

    fn n_components(&self, patch: usize, quantity: Quantity) -> usize {
        let patch: &RecordedPatch = &self.header.patches[patch];
        match quantity {
            Quantity::Deflection => 1,
            Quantity::Force => patch.force.n_components(),
        }
    }

    fn stream(&self, member: &str) -> Result<Stream> {
        self.streams.get(member).cloned().ok_or_else(|| {
            Error::input(
                self.path.display(),
                format!("no member {member}"),
                "a member with one row a frame",
            )
        })
    }

    fn read_meta(&mut self) -> Result<RecordingHeader> {
        let bytes = self.bytes("meta").and_then(|(array, bytes)| {
            let is_text = matches!(array.element, Element::Text(_)) && array.shape.is_empty();
            match is_text {
                true => Ok(bytes),
                false => Err(io::Error::other("not a text")),
            }
        });
        let bytes = bytes.map_err(|e| self.damaged("meta", e, "a text"))?;
        let letters = bytes.as_chunks().0.iter();
        let text: String = letters
            .filter_map(|&code| char::from_u32(u32::from_le_bytes(code)))
            .collect();
        RecordingHeader::of_meta(&text)
            .map_err(|e| self.damaged("meta", e, "what a bubbletouch recording says of itself"))
    }

    fn vectors(&mut self, patch: &str, what: &str) -> Result<Vec<DVec3>> {
        let numbers = self.whole(&format!("{patch}/{what}"), &[3])?;
        let vectors = numbers.as_chunks().0.iter();
        Ok(vectors.map(|&v: &[f64; 3]| DVec3::from(v)).collect())
    }

    /// A member of numbers in f64 with rows of a shape, at once.
    fn whole(&mut self, member: &str, row: &[usize]) -> Result<Vec<f64>> {
        let read = self.bytes(member);
        let (array, bytes) = read.map_err(|e| self.damaged(member, e, "an array"))?;
        let n_rows = array.shape.first().copied().unwrap_or(0);
        array
            .check(Element::Double, &[&[n_rows], row].concat())
            .map_err(|(given, allowed)| self.damaged(member, given, allowed))?;
        let mut values = Vec::new();
        decode(&bytes, array.element, &mut values);
        Ok(values)
    }

    fn npy_header(&mut self, member: &str) -> io::Result<NpyHeader> {
        let mut entry = self.archive.by_name(&format!("{member}.npy"))?;
        let size = entry.size();
        let (header, start) = NpyHeader::read(&mut entry)?;
        let n_bytes = header.n_bytes().unwrap_or(usize::MAX) as u64;
        if n_bytes.checked_add(start as u64) != Some(size) {
            return Err(io::Error::other(format!(
                "{size} bytes for an array of shape {:?}",
                header.shape
            )));
        }
        Ok(header)
    }

    /// A member's bytes. What is reserved is what the file holds: a size that lies is found before.
    fn bytes(&mut self, member: &str) -> io::Result<(NpyHeader, Vec<u8>)> {
        let header = self.npy_header(member)?;
        let mut entry = self.archive.by_name(&format!("{member}.npy"))?;
        NpyHeader::read(&mut entry)?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes)?;
        Ok((header, bytes))
    }

    fn check_member(&mut self, member: &str, element: Element, shape: &[usize]) -> Result<()> {
        let header = self.npy_header(member);
        let header = header.map_err(|e| self.damaged(member, e, "an array"))?;
        header
            .check(element, shape)
            .map_err(|(given, allowed)| self.damaged(member, given, allowed))
    }

    fn per_taxel(&self, patch: usize, row: Vec<f64>) -> Vec<f64> {
        if row.len() == self.header.patches[patch].n_taxels() {
            return row;
        }
        row.as_chunks().0.iter().map(|&v| length(v)).collect()
    }

    fn damaged(&self, member: &str, given: impl ToString, allowed: impl ToString) -> Error {
        let place = format!("{}, member {member}", self.path.display());
        Error::input(place, given, allowed)
    }
}

fn length(vector: [f64; 3]) -> f64 {
    DVec3::from(vector).length()
}
