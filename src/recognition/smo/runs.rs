//! Columns of a matrix, copied as few pieces.

/// Columns that follow each other, by their first and how many: copied at once.
pub(crate) struct Runs(Vec<(usize, usize)>);

impl Runs {
    /// Of columns in the order in which they are wanted.
    pub fn new(columns: &[usize]) -> Self {
        let runs = columns.chunk_by(|a, b| a + 1 == *b);
        Self(runs.map(|run| (run[0], run.len())).collect())
    }

    /// Copies the columns of a row side by side; gives what is left of `to`.
    pub fn copy<'a, T: Copy>(&self, from: &[T], mut to: &'a mut [T]) -> &'a mut [T] {
        for &(first, n) in &self.0 {
            let (now, later) = to.split_at_mut(n);
            now.copy_from_slice(&from[first..first + n]);
            to = later;
        }
        to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_come_in_the_order_asked_and_the_rest_is_left_alone() {
        let from: Vec<usize> = (0..10).collect();
        let columns = [4, 5, 6, 0, 9, 1, 2];
        let mut to = vec![77; 9];
        assert_eq!(Runs::new(&columns).copy(&from, &mut to), [77, 77]);
        assert_eq!(to[..7], columns);
    }
}
