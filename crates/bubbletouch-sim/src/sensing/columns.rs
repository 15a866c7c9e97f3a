//! Column storage of Φ: the cost of measuring is proportional to the number of touched taxels.

use super::projection::Projection;

/// Projection y = Φx with Φ stored by columns, which measures a frame from its touched taxels only.
///
/// The memory is 4 bytes per taxel and 16 bytes per nonzero entry of Φ. For m measurements of n taxels, scrambled blocks have 32 m entries, very sparse rows
/// m√n, averages n, and dense ensembles m n.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Ensemble, Projection};
/// use bubbletouch_sim::world::ImageShape;
///
/// let seed = Seed::new(2018).named("projection");
/// let projection = Projection::new(Ensemble::Sbhe, ImageShape { ny: 300, nx: 400 }, 1024, &seed)?;
/// let columns = projection.columns();
/// let mut measurements = vec![0.0; 1024];
/// columns.measure_touched([(17, 1e-3), (18, 2e-3)], &mut measurements);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Columns {
    n_measurements: usize,
    /// Index of the first matrix entry of each taxel, followed by the total number of entries: n_taxels + 1 values.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// Nonzero entry of the matrix Φ of a projection.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    measurement: u32,
    value: f64,
}

impl Projection {
    /// Returns this projection with its matrix stored by columns.
    ///
    /// # Panics
    /// If Φ has 2³² or more nonzero entries.
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
    /// Returns the number of taxels of a whole frame.
    pub fn n_taxels(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the number of measurements.
    pub fn n_measurements(&self) -> usize {
        self.n_measurements
    }

    /// Returns the number of nonzero entries of the matrix Φ.
    pub fn n_entries(&self) -> usize {
        self.entries.len()
    }

    /// Returns the number of taxels that at least one measurement depends on.
    pub fn n_read(&self) -> usize {
        let columns = self.starts.windows(2);
        columns.filter(|ends| ends[0] < ends[1]).count()
    }

    /// Returns the memory that the stored matrix uses, bytes.
    pub fn n_bytes(&self) -> usize {
        size_of_val(&self.starts[..]) + size_of_val(&self.entries[..])
    }

    /// Measures a frame that is zero except for `touched` (taxel, value), and overwrites `measurements` (m). The result equals the measurements of the whole
    /// frame up to rounding. The function allocates no memory.
    ///
    /// # Panics
    /// If a taxel does not exist, or `measurements` does not have length m.
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
