//! Which rows are recognised when all problems vote.
//!
//! One-vs-one elects the class with most votes. A row that its own class wins in each of that class's problems is recognised,
//! whatever the others say: every other class has lost one. A row whose own class has lost some is not, if another class has
//! lost fewer. The class that the own one lost to is asked first, and none further than it has lost too many; whether to the
//! own one is asked before the others, as most have.

use crate::recognition::svm::Multiclass;
use crate::recognition::svm::cross_validation::judgement::Judgement;
use crate::recognition::svm::gram::class_columns::Products;
use crate::recognition::svm::linalg::scalar::Scalar;

impl<T: Scalar> Judgement<'_, T> {
    /// Rows of a class that are recognised, by C; `write_row` writes the kernel values of a [doubtful](Self::doubtful) row with
    /// all.
    pub fn n_right(
        &self,
        class: usize,
        mut write_row: impl FnMut(usize, &mut Vec<T>),
    ) -> Vec<usize> {
        let mut n_right = vec![0; self.lost.ncols()];
        let (mut all, mut values) = (Vec::new(), Vec::new());
        for at in self.of_class(class) {
            let (row, lost) = (self.rows[at].0, self.lost.row(at));
            if self.is_doubtful(at) {
                write_row(row, &mut all);
                self.columns.spread(&all, &mut values);
            }
            let mut is_right = false;
            for (number, (&lost, n_right)) in lost.iter().zip(&mut n_right).enumerate() {
                is_right = match lost {
                    _ if self.is_as_before(at, number) => is_right,
                    _ if self.multiclass != Multiclass::OneVsOne => {
                        largest(self, number, &values) == class
                    }
                    (0, _) => true,
                    lost => is_elected(self, number, &values, (class, lost)),
                };
                *n_right += usize::from(is_right);
            }
        }
        n_right
    }

    /// Whether the first of two classes wins, which may come after the second.
    #[inline(always)]
    fn wins(&self, number: usize, values: &[T], (first, second): (usize, usize)) -> bool {
        let (positive, negative) = (first.min(second), first.max(second));
        let solved = &self.problems[self.pair(positive, negative)][number];
        let own = self.columns.of_class(positive, values);
        let (left, right) = self.beta[solved.beta.clone()].split_at(own.len());
        let others = self.columns.of_class(negative, values);
        let mut products = Products::new();
        products.add(own, left);
        products.add(others, right);
        (products.sum().wide() > solved.rho) == (first == positive)
    }
}

/// Whether a class has most votes on a row, of equals as the first, given the kernel values with it, in how many problems it
/// loses and one that it loses to.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn is_elected<T: Scalar>(
    judgement: &Judgement<T>,
    number: usize,
    values: &[T],
    (own, (n_lost, rival)): (usize, (usize, usize)),
) -> bool {
    let classes = &judgement.classes[..];
    for at in 0..=classes.len() {
        let class = if at == 0 { rival } else { classes[at - 1] };
        // Which would have as many votes, and come first, or more.
        let n_allowed = if class < own { n_lost } else { n_lost - 1 };
        if class == own || (at > 0 && class == rival) {
            continue;
        }
        let others = classes.iter().filter(|&&other| other != own);
        let mut n_lost = 0;
        for &other in std::iter::once(&own).chain(others) {
            if other != class && !judgement.wins(number, values, (class, other)) {
                n_lost += 1;
                if n_lost > n_allowed {
                    break;
                }
            }
        }
        if n_lost <= n_allowed {
            return false;
        }
    }
    true
}

/// The class with the largest decision value on a row, of equals the first.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn largest<T: Scalar>(judgement: &Judgement<T>, number: usize, values: &[T]) -> usize {
    let (mut largest, mut winner) = (f64::NEG_INFINITY, 0);
    for &class in &judgement.classes {
        let solved = &judgement.problems[class][number];
        let beta = &judgement.beta[solved.beta.clone()];
        let mut products = Products::new();
        products.add(values, beta);
        let value = products.sum().wide() - solved.rho;
        if value > largest {
            (largest, winner) = (value, class);
        }
    }
    winner
}
