//! Every row of a table is a point of its charts, or is counted on them.

use crate::command::says;
use crate::report_synthetic::{
    about, add_headlines, configuration, each, noise_cells, quickstart_cells, tables, write_all,
};
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::report::chart::{draw, omitted, places};
use bubbletouch::report::comparison::changes::changes;
use bubbletouch::studies::recognition::charts::{answers, charts, read_tables, tables_of, words};
use bubbletouch::study::table::{Configuration, Limit};
use bubbletouch::table::{ChartSpec, Table};

/// Returns configurations of a linear SVM with three values of C, and of a k-nearest-neighbours classifier without C.
fn with_k_nearest() -> Vec<Configuration> {
    let mut all = vec![configuration(); 4];
    for (one, c) in all.iter_mut().zip([0.1, 1.0, 10.0]) {
        one.c = Some(c);
    }
    (all[3].classifier, all[3].c) = (ClassifierKind::KNearest, None);
    all
}

#[test]
fn a_classifier_without_c_has_its_point_beside_an_svm_over_c() {
    let made = tables_of(&tables(with_k_nearest(), 3, 24)).unwrap();
    let specs = charts(&made, None);
    let accuracy = specs.iter().filter(|spec| spec.y == "accuracy");
    let accuracy: Vec<&ChartSpec> = accuracy.collect();
    let svg = |spec| draw(spec, &made).unwrap().svg("");
    let all = svg(accuracy[0]);
    assert_eq!(places(accuracy[0], &made).unwrap().len(), 4);
    says(&all, &["linear SVM", "k nearest", "0.1", "10"]);
    assert_eq!(omitted(accuracy[0], &made).unwrap(), "");
    let over_c = accuracy.iter().find(|spec| spec.x == "c").unwrap();
    let said = svg(over_c);
    says(&said, &["3 of 4 rows are drawn; 1 has no C."]);
    assert!(
        said.contains("linear") && !said.contains("nearest"),
        "{said}"
    );
}

#[test]
fn charts_of_accuracies_stand_together() {
    let configurations = each(noise_cells(), [16, 64, 256], |one, measurements| {
        (one.measurements, one.ratio) = (measurements, 4096.0 / measurements as f64);
    });
    let made = tables_of(&tables(configurations, 3, 24)).unwrap();
    let is_accuracy = |spec: &ChartSpec| spec.name.starts_with("accuracy_by");
    let mut specs = charts(&made, Some(true));
    assert_eq!(specs.remove(1).name, "pareto_prediction");
    let drawn: Vec<bool> = specs.iter().take(24).map(is_accuracy).collect();
    let n_changes = drawn.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(drawn[0] && n_changes == 1, "{drawn:?}");
}

#[test]
fn touches_that_met_nothing_are_in_the_last_lines_and_among_the_first_answers() {
    let mut typed = tables(quickstart_cells(), 3, 24);
    let limit = |count| Limit {
        limit: "touches that met nothing".to_owned(),
        count,
        total: 9120,
        meaning: "their frames hold no contact".to_owned(),
    };
    typed.limits = vec![limit(0)];
    let none = tables_of(&typed).unwrap();
    assert!(!words(&none, 90).contains("met nothing"));
    typed.limits = vec![limit(456)];
    let some = tables_of(&typed).unwrap();
    let said = words(&some, 90);
    let last = said.trim_end().rsplit("\n\n").next().unwrap();
    assert_eq!(said.matches("met nothing").count(), 1);
    assert!(
        last.starts_with("456 of 9120 touches that met nothing (5 %)"),
        "{last}"
    );
    let answers = answers(&some);
    let place = answers.iter().position(|said| said.contains("met nothing"));
    assert!(place.is_some_and(|place| place <= 2), "{answers:?}");
}

#[test]
fn the_object_of_a_confused_pair_is_said_though_all_pairs_have_the_same() {
    let mut typed = tables(quickstart_cells(), 3, 24);
    typed.confused.truncate(2);
    for pair in &mut typed.confused {
        pair.object = "hand".to_owned();
    }
    let said = words(&tables_of(&typed).unwrap(), 90);
    let (_, pairs) = said.split_once("Most frequent confusions").unwrap();
    assert_eq!(pairs.matches("hand").count(), 2, "{pairs}");
}

#[test]
fn headings_of_the_terminal_break_between_words_alone() {
    let made = tables_of(&tables(quickstart_cells(), 3, 24)).unwrap();
    for width in [60, 70, 80, 90, 100, 120] {
        let said = words(&made, width);
        let (table, _) = said.split_once("----").unwrap();
        for word in ["compression", "accuracy"] {
            let counts = [word, &word[..word.len() - 1]].map(|part| table.matches(part).count());
            assert_eq!(counts[0], counts[1], "{said}");
        }
    }
}

#[test]
fn an_edit_of_any_entry_of_any_table_is_found_by_comparing() {
    let dir = tempfile::tempdir().unwrap();
    let (kept, edited) = (dir.path().join("kept"), dir.path().join("edited"));
    let mut typed = tables(quickstart_cells(), 2, 3);
    add_headlines(&mut typed);
    for folder in [&kept, &edited] {
        write_all(folder, &typed, &about()).unwrap();
    }
    let first = read_tables(&kept).unwrap();
    let is_same = |second: &[Table]| {
        let (tables, changed) = changes(&first, second);
        let mut tables = tables.iter();
        changed.is_empty() && tables.all(|table| table.n_first_only + table.n_second_only == 0)
    };
    assert!(is_same(&read_tables(&edited).unwrap()));
    let mut n_edits = 0;
    let is_file = |table: &&Table| table.n_rows > 0 && !table.csv.is_empty();
    for table in first.iter().filter(is_file) {
        let path = edited.join(table.file);
        let text = std::fs::read_to_string(&path).unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let head = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        for (place, column) in table.columns.iter().enumerate() {
            // The numbers of configurations are names, so other numbers in all rows are no difference.
            if column.name == "configuration" {
                continue;
            }
            let mut writer = csv::Writer::from_path(&path).unwrap();
            writer.write_record(&head).unwrap();
            for (number, row) in rows.iter().enumerate() {
                let entries = row.iter().enumerate().map(|(at, entry)| {
                    let is_edited = number + 1 == rows.len() && at == place;
                    let is_number = table.numbers(&column.name).is_some();
                    match (is_edited, entry.parse::<f64>()) {
                        (false, _) => entry.to_owned(),
                        (true, Ok(value)) => (value + 1.0).to_string(),
                        (true, Err(_)) if entry.is_empty() && is_number => "7".to_owned(),
                        (true, Err(_)) => "edited".to_owned(),
                    }
                });
                writer.write_record(entries).unwrap();
            }
            drop(writer);
            // A table with an impossible entry, such as an accuracy of 1.5, is refused.
            let is_missed = read_tables(&edited).is_ok_and(|second| is_same(&second));
            assert!(!is_missed, "{}: {}", table.file, column.name);
            n_edits += 1;
        }
        std::fs::write(&path, text).unwrap();
    }
    assert!(n_edits > 100, "{n_edits}");
}
