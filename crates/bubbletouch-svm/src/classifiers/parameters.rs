//! Hyper-parameters that only some kinds of classifiers use. Setting one for another kind is an error.

use crate::classifiers::ClassifierKind;

/// Hyper-parameter that only some kinds of classifiers use.
pub struct Parameter {
    /// Keys of `[recognition]` that set the hyper-parameter. The options of `bubbletouch classify` have the same names.
    pub keys: &'static [&'static str],
    /// Function that returns whether a kind of classifier uses the hyper-parameter.
    pub is_used: fn(ClassifierKind) -> bool,
}

/// All hyper-parameters that only some kinds of classifiers use.
pub const PARAMETERS: [Parameter; 8] = [
    Parameter {
        keys: &["tolerance"],
        is_used: ClassifierKind::has_c,
    },
    Parameter {
        keys: &["c", "c_grid"],
        is_used: ClassifierKind::has_c,
    },
    Parameter {
        keys: &["gamma", "gamma_grid"],
        is_used: ClassifierKind::has_gamma,
    },
    Parameter {
        keys: &["degree", "coef0"],
        is_used: |kind| kind.about().has_degree,
    },
    Parameter {
        keys: &["multiclass", "solver", "solver_memory_gib"],
        is_used: |kind| kind.about().kernel.is_some(),
    },
    Parameter {
        keys: &["n_neighbours"],
        is_used: |kind| kind.about().has_neighbours,
    },
    Parameter {
        keys: &["n_trees"],
        is_used: |kind| kind.about().has_trees,
    },
    Parameter {
        keys: &["max_depth"],
        is_used: |kind| kind.about().has_depth,
    },
];

impl Parameter {
    /// Returns the study names of the classifiers that use the hyper-parameter, such as `linear_svm or rbf_svm`.
    pub fn users(&self) -> String {
        let all = ClassifierKind::ALL.iter().zip(ClassifierKind::NAMES);
        let users = all.filter(|(kind, _)| (self.is_used)(**kind));
        let names: Vec<&str> = users.map(|(_, (name, _))| *name).collect();
        names.join(" or ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_has_users_and_no_classifier_uses_all() {
        for parameter in &PARAMETERS {
            assert!(!parameter.users().is_empty(), "{:?}", parameter.keys);
        }
        let users = |key: &str| {
            let found = PARAMETERS.iter().find(|one| one.keys.contains(&key));
            found.unwrap().users()
        };
        assert_eq!(users("degree"), "polynomial_svm");
        assert_eq!(users("max_depth"), "random_forest");
        assert_eq!(users("gamma"), "rbf_svm or laplacian_svm or polynomial_svm");
    }
}
