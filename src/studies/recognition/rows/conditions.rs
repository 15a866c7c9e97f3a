//! Grouping of configurations by condition (external settings, such as noise), and selection of the best configuration under each condition.

use crate::studies::prelude::*;
use crate::studies::recognition::rows::Configuration;
use crate::table::{Columns, Role};

/// Returns a table with the settings of the given configurations, without scores.
///
/// # Errors
/// If a configuration cannot be written as a row of a table.
pub fn settings_of(configurations: &[&Configuration]) -> Result<Table> {
    let axes = configurations
        .first()
        .map(|configuration| configuration.variant.values.iter());
    let axes = axes.into_iter().flatten();
    let axes = axes.map(|axis| axis.column.clone().optional());
    let columns = Configuration::columns().into_iter().chain(axes).collect();
    File::<Configuration>::new("configurations.csv", "Configurations", "")
        .of_columns(columns, configurations)
}

/// Returns the indices of the configurations under each condition, which is a combination of external settings such as noise. The conditions are in the order
/// of first occurrence.
///
/// # Errors
/// If [`settings_of`] fails.
pub fn by_condition<'a>(
    configurations: impl IntoIterator<Item = &'a Configuration>,
) -> Result<Vec<Vec<usize>>> {
    let configurations = settings_of(&configurations.into_iter().collect::<Vec<_>>())?;
    Ok(configurations.groups(
        &configurations.of_role(Role::Condition),
        0..configurations.n_rows,
    ))
}

/// Returns the index of the highest accuracy; if several are equal, the first index. Returns `None` if there are no accuracies.
pub fn most_accurate(accuracies: impl IntoIterator<Item = (usize, f64)>) -> Option<usize> {
    let better = |best: (usize, f64), other: (usize, f64)| match other.1 > best.1 {
        true => other,
        false => best,
    };
    let best = accuracies.into_iter().reduce(better);
    best.map(|(place, _)| place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::sensor_errors::TestSensor;
    use crate::studies::recognition::rows::configuration::tests::configuration;

    #[test]
    fn cells_that_differ_in_choices_alone_share_a_condition() {
        let mut configurations = vec![configuration(); 6];
        configurations[1].measurements = 16;
        configurations[2].noise_std = 0.0;
        configurations[3].smoothing_mm = 4.0;
        for configuration in &mut configurations {
            configuration.test_sensor = Some(TestSensor::SameSkin);
        }
        configurations[4].test_sensor = Some(TestSensor::AnotherSkin);
        let alike = by_condition(&configurations).unwrap();
        assert_eq!(alike, [vec![0, 1, 3, 5], vec![2], vec![4]]);
    }
}
