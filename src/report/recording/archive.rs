//! A zip of stored members whose sizes are known before their bytes: each has its place, so they can grow side by side.
//!
//! A member is a local header, its name, and its bytes; behind all of them the directory says where each begins. Only the
//! checksums come with the bytes: they are put into the local headers at the end. Sizes and places are written as ZIP64 has them
//! (PKWARE's APPNOTE 6.3.10, §4.3 and §4.5.3), of small members too: one form for all.

use crc32fast::Hasher;
use std::io::{self, Seek, SeekFrom, Write};

/// What a field says of which ZIP64's holds the number.
const ELSEWHERE: [u8; 4] = [0xff; 4];
/// The version that knows ZIP64; an entry of the directory says with it that it was made on Unix.
const VERSION: [u8; 2] = [45, 0];
const MADE_BY: [u8; 2] = [45, 3];
/// Of a file that all may read and its owner may write.
const PERMISSIONS: u32 = 0o100_644 << 16;
/// A name in UTF-8, stored bytes, and 1980-01-01, 00:00: equal recordings are equal bytes.
const FLAGS_METHOD_TIME: [u8; 8] = [0, 8, 0, 0, 0, 0, 33, 0];

/// A member of stored bytes.
#[derive(Clone, Debug)]
struct Member {
    name: String,
    /// All its bytes.
    size: u64,
    /// Where its local header is.
    start: u64,
    /// How many bytes it has.
    n_written: u64,
    hasher: Hasher,
}

/// Members that are being filled.
#[derive(Clone, Debug, Default)]
pub(super) struct Archive {
    members: Vec<Member>,
    /// Where the next member or the directory begins.
    end: u64,
}

impl Archive {
    /// Gives a member with so many bytes its place behind the others; returns its number.
    pub fn add(&mut self, name: &str, size: u64) -> usize {
        let member = Member {
            name: name.to_owned(),
            size,
            start: self.end,
            n_written: 0,
            hasher: Hasher::new(),
        };
        self.end = member.data() + size;
        self.members.push(member);
        self.members.len() - 1
    }

    /// Writes the next bytes of a member.
    pub fn append(
        &mut self,
        file: &mut (impl Write + Seek),
        member: usize,
        bytes: &[u8],
    ) -> io::Result<()> {
        let member = &mut self.members[member];
        let at = member.data() + member.n_written;
        member.n_written += bytes.len() as u64;
        member.hasher.update(bytes);
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    }

    /// Writes headers and directory; the error is a member that has not got all its bytes.
    pub fn finish(&self, file: &mut (impl Write + Seek)) -> io::Result<()> {
        for member in &self.members {
            let (name, size, n) = (&member.name, member.size, member.n_written);
            if n != size {
                let said = format!("member {name} has {n} of its {size} bytes");
                return Err(io::Error::other(said));
            }
            file.seek(SeekFrom::Start(member.start))?;
            file.write_all(&member.local_header())?;
        }
        file.seek(SeekFrom::Start(self.end))?;
        file.write_all(&self.directory())
    }

    fn directory(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.members.iter().flat_map(Member::entry).collect();
        let (n, size) = (self.members.len() as u64, bytes.len() as u64);
        let record = self.end + size;
        bytes.extend(b"PK\x06\x06");
        bytes.extend(44_u64.to_le_bytes());
        bytes.extend([MADE_BY, VERSION].concat());
        bytes.extend([0; 8]);
        bytes.extend(
            [n, n, size, self.end]
                .into_iter()
                .flat_map(u64::to_le_bytes),
        );
        bytes.extend(b"PK\x06\x07\0\0\0\0");
        bytes.extend(record.to_le_bytes());
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        // Numbers, size and place are in the record; no comment.
        bytes.extend([ELSEWHERE; 3].concat());
        bytes.extend([0; 2]);
        bytes
    }
}

impl Member {
    /// Where its bytes begin.
    fn data(&self) -> u64 {
        self.start + self.local_header().len() as u64
    }

    fn local_header(&self) -> Vec<u8> {
        let mut bytes = b"PK\x03\x04".to_vec();
        self.describe(&mut bytes, &[self.size; 2], &[]);
        bytes
    }

    /// In the directory.
    fn entry(&self) -> Vec<u8> {
        let mut bytes = [b"PK\x01\x02", &MADE_BY[..]].concat();
        // No comment, the first disk, nothing known of the bytes.
        let more = [&[0; 6], &PERMISSIONS.to_le_bytes()[..], &ELSEWHERE].concat();
        self.describe(&mut bytes, &[self.size, self.size, self.start], &more);
        bytes
    }

    /// What both headers have, from the version to ZIP64's field, with what one has more before the name.
    fn describe(&self, bytes: &mut Vec<u8>, numbers: &[u64], more: &[u8]) {
        let numbers: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        bytes.extend(VERSION);
        bytes.extend(FLAGS_METHOD_TIME);
        bytes.extend(self.hasher.clone().finalize().to_le_bytes());
        bytes.extend([ELSEWHERE; 2].concat());
        let lengths = [self.name.len(), numbers.len() + 4].map(|n| n as u16);
        bytes.extend(lengths.into_iter().flat_map(u16::to_le_bytes));
        bytes.extend(more);
        bytes.extend(self.name.as_bytes());
        bytes.extend([1, 0, numbers.len() as u8, 0]);
        bytes.extend(numbers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use zip::ZipArchive;

    #[test]
    fn members_that_grow_side_by_side_are_read_as_they_were_written() {
        let mut archive = Archive::default();
        let members = ["meta.npy", "Füße/pose.npy", "empty.npy"].map(|name| {
            let size = if name == "empty.npy" { 0 } else { 30 };
            archive.add(name, size)
        });
        let mut file = io::Cursor::new(Vec::new());
        for part in 0..3_u8 {
            for &member in &members[..2] {
                let bytes = [part + 10 * member as u8; 10];
                archive.append(&mut file, member, &bytes).unwrap();
            }
        }
        archive.finish(&mut file).unwrap();
        let mut read = ZipArchive::new(file).unwrap();
        for member in 0..2 {
            let mut bytes = Vec::new();
            read.by_index(member)
                .unwrap()
                .read_to_end(&mut bytes)
                .unwrap();
            let expected = [0, 1, 2].map(|part| [part + 10 * member as u8; 10]);
            assert_eq!(bytes, expected.concat());
        }
        assert_eq!(read.by_name("Füße/pose.npy").unwrap().size(), 30);
        assert_eq!(read.by_name("empty.npy").unwrap().size(), 0);
    }

    #[test]
    fn a_member_without_all_its_bytes_is_an_error() {
        let mut archive = Archive::default();
        let member = archive.add("half.npy", 4);
        let mut file = io::Cursor::new(Vec::new());
        archive.append(&mut file, member, &[1, 2]).unwrap();
        let error = archive.finish(&mut file).unwrap_err().to_string();
        assert_eq!(error, "member half.npy has 2 of its 4 bytes");
    }

    #[test]
    fn what_is_beyond_four_gibibytes_is_found_again() {
        // A file with a hole: only the headers are on the disk.
        let mut archive = Archive::default();
        let sizes = [10, (5 << 30) + 7, 3];
        for (number, size) in sizes.into_iter().enumerate() {
            let member = archive.add(&format!("{number}.npy"), size);
            archive.members[member].n_written = size;
        }
        let mut file = tempfile::tempfile().unwrap();
        archive.finish(&mut file).unwrap();
        file.flush().unwrap();
        let mut read = ZipArchive::new(file).unwrap();
        for (number, size) in sizes.into_iter().enumerate() {
            let entry = read.by_index_raw(number).unwrap();
            let member = &archive.members[number];
            assert_eq!(
                (entry.name(), entry.size()),
                (&*format!("{number}.npy"), size)
            );
            assert_eq!(
                (entry.header_start(), entry.data_start()),
                (member.start, member.data())
            );
        }
    }
}
