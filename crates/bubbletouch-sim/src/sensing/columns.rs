//! Φ by columns: what each taxel adds to which measurements, so that measuring costs what is touched and not the skin.

use super::projection::Projection;

/// A [`Projection`] that measures frames of which only the touched taxels are known.
///
/// It holds 4 bytes a taxel and 16 an entry of Φ that is not zero: m · 32 of them for scrambled blocks, m√n for very sparse
/// rows, n for averages; of dense ensembles all m · n.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Ensemble, Projection};
///
/// let seed = Seed::new(2018).named("projection");
/// let projection = Projection::new(Ensemble::Sbhe, (300, 400), 1024, &seed)?;
/// let columns = projection.columns();
/// let mut measurements = vec![0.0; 1024];
/// columns.measure_touched([(17, 1e-3), (18, 2e-3)], &mut measurements);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Columns {
    n_measurements: usize,
    /// n_taxels + 1: where the entries of each taxel begin, and where the last end.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// A number of Φ that is not zero.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    measurement: u32,
    value: f64,
}

impl Projection {
    /// The same map by columns.
    ///
    /// # Panics
    /// If Φ has 2³² entries that are not zero, or more.
    pub fn columns(&self) -> Columns {
        let mut counts = vec![0_u64; self.n_taxels()];
        self.each_entry(|_, taxel, _| counts[taxel] += 1);
        let mut end = 0_u64;
        let mut starts = Vec::with_capacity(counts.len() + 1);
        for count in counts {
            starts.push(end as u32);
            end += count;
        }
        assert!(end <= u64::from(u32::MAX), "{end} entries");
        let mut entries = vec![Entry::default(); end as usize];
        let mut next = starts.clone();
        self.each_entry(|measurement, taxel, value| {
            let place = &mut next[taxel];
            entries[*place as usize] = Entry {
                measurement: measurement as u32,
                value,
            };
            *place += 1;
        });
        starts.push(end as u32);
        Columns {
            n_measurements: self.n_measurements(),
            starts,
            entries,
        }
    }
}

impl Columns {
    /// How many taxels a whole frame has.
    pub fn n_taxels(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many measurements there are.
    pub fn n_measurements(&self) -> usize {
        self.n_measurements
    }

    /// How many numbers of Φ are not zero.
    pub fn n_entries(&self) -> usize {
        self.entries.len()
    }

    /// How many taxels any measurement reads.
    pub fn n_read(&self) -> usize {
        let columns = self.starts.windows(2);
        columns.filter(|ends| ends[0] < ends[1]).count()
    }

    /// Bytes that it holds.
    pub fn n_bytes(&self) -> usize {
        size_of_val(&self.starts[..]) + size_of_val(&self.entries[..])
    }

    /// Measures a frame that is zero but for `touched` (taxel, value) into `measurements` (m), whatever was there; to rounding what
    /// [`Projection::measure`] says of the whole frame. Nothing is allocated.
    ///
    /// # Panics
    /// If there is no such taxel, or `measurements` is not m long.
    pub fn measure_touched(
        &self,
        touched: impl IntoIterator<Item = (usize, f64)>,
        measurements: &mut [f64],
    ) {
        assert_eq!(measurements.len(), self.n_measurements, "measurements");
        measurements.fill(0.0);
        for (taxel, value) in touched {
            let entries = self.starts[taxel] as usize..self.starts[taxel + 1] as usize;
            for entry in &self.entries[entries] {
                measurements[entry.measurement as usize] += entry.value * value;
            }
        }
    }
}
