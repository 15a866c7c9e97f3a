//! Transposition of several rows at once.

/// Number of rows that are transposed together: a cache line of f32.
const TILE: usize = 16;

/// Writes rows of equal length as matrix columns: value `j` of row `i` is written to `j · stride + i`.
pub(crate) fn write_columns<T: Copy>(rows: &[&[T]], to: &mut [T], stride: usize) {
    let (tiles, last) = rows.as_chunks::<TILE>();
    for (number, tile) in tiles.iter().enumerate() {
        write_tile(tile, &mut to[number * TILE..], stride);
    }
    let first = rows.len() - last.len();
    for (i, row) in last.iter().enumerate() {
        for (j, &value) in row.iter().enumerate() {
            to[j * stride + first + i] = value;
        }
    }
}

fn write_tile<T: Copy>(rows: &[&[T]; TILE], to: &mut [T], stride: usize) {
    let n = rows[0].len();
    let mut columns = *rows;
    for i in 0..TILE {
        columns[i] = &rows[i][..n];
    }
    for j in 0..n {
        let to = &mut to[j * stride..][..TILE];
        for i in 0..TILE {
            to[i] = columns[i][j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns_and_what_is_between_is_left_alone() {
        for (n, m) in [(0, 3), (1, 1), (16, 5), (20, 17), (35, 40)] {
            let values: Vec<usize> = (0..n * m).collect();
            let rows: Vec<&[usize]> = values.chunks_exact(m).collect();
            let stride = n + 2;
            let mut to = vec![usize::MAX; m * stride];
            write_columns(&rows, &mut to, stride);
            for (at, &value) in to.iter().enumerate() {
                let (j, i) = (at / stride, at % stride);
                let expected = if i < n { i * m + j } else { usize::MAX };
                assert_eq!(value, expected, "{n} {m}: {i} {j}");
            }
        }
    }
}
