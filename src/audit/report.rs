//! Page, files and terminal text of an audit.

use crate::audit::checks::CHECKS;
use crate::audit::finding::{ALPHA, Finding, Verdict};
use crate::audit::run::Audit;
use crate::audit::tables::{answers, by_verdict};
use crate::engine::program::PROGRAM;
use crate::error::Result;
use crate::report::folder::{NamedFile, table_files};
use crate::report::page::{Section, StudyAbout, png_element};
use crate::report::pictures::drawing::escape;
use crate::report::study_folder::{Beyond, Found, NamedPicture, files_with};
use crate::report::terminal::paragraph;
use crate::table::short_number;

/// Names of the files of an audit that are always written, for the list of owned files.
pub const AUDIT_FILES: &[&str] = &[
    "report.html",
    "findings.csv",
    "accuracy_by_split.csv",
    "confounds.csv",
    "classes.csv",
    "levels.csv",
    "rows.csv",
    "taxels.csv",
    "accuracy_by_split.svg",
    "confounds.svg",
    "levels.svg",
    "classes.svg",
    "taxels.png",
    "near_duplicates.png",
    "doubtful_labels.png",
];

/// Returns the tables, charts, pictures and the page of an audit. `name` is the name of the data, and `command` is the command line that reproduces the files.
///
/// # Errors
/// If a chart cannot be drawn.
pub fn audit_files(audit: Audit, name: &str, command: &str) -> Result<Vec<NamedFile>> {
    let about = StudyAbout {
        name: format!("Audit of {name}"),
        question: "Can these data carry a claim about recognition?".to_owned(),
        program: PROGRAM.to_owned(),
        command: command.to_owned(),
        wall_s: f64::NAN,
        ..StudyAbout::default()
    };
    let answers = answers(&audit.findings);
    let found = Found {
        tables: &audit.tables,
        charts: &audit.charts,
        answers: &answers[..1],
    };
    let shown: Vec<&str> = audit.charts.iter().map(|chart| &chart.name[..]).collect();
    let drawn: Vec<&str> = audit
        .pictures
        .iter()
        .map(|picture| &picture.name[..])
        .collect();
    let findings = findings_html(&audit.findings, &shown, &drawn);
    let beyond = || {
        Ok(Beyond {
            first_sections: vec![Section::new("findings", "Findings", findings)],
            sections: vec![Section::new(
                "frames",
                "Pictures",
                pictures_html(&audit.pictures),
            )],
            ..Beyond::default()
        })
    };
    let mut files = table_files(&audit.tables);
    files.extend(files_with(&about, &found, beyond)?);
    let pictures = audit.pictures.into_iter();
    files.extend(pictures.map(|picture| (picture.name + ".png", picture.png)));
    Ok(files)
}

/// Returns pictures as HTML, each with its title below.
fn pictures_html(pictures: &[NamedPicture]) -> String {
    let figures = pictures.iter().map(|picture| {
        let image = png_element(&picture.png, picture.size, &picture.title);
        let (name, title) = (escape(&picture.name), escape(&picture.title));
        format!("<figure id=\"picture-{name}\">{image}<figcaption class=\"quiet\">{title}.</figcaption></figure>")
    });
    figures.collect()
}

/// Returns the findings as HTML, faults first. `charts` and `pictures` are the names of the charts and pictures on the page.
fn findings_html(findings: &[Finding], charts: &[&str], pictures: &[&str]) -> String {
    let rows = by_verdict(findings);
    let cards = rows.iter().map(|finding| {
        let (class, word) = match finding.verdict {
            Verdict::Fault => ("fault", "Fault"),
            Verdict::Note => ("note", "Note"),
            Verdict::Passed => ("passed", "Passed"),
            Verdict::NotChecked => ("unchecked", "Not checked"),
        };
        let title = title_of(finding);
        let p = match finding.p_holm {
            Some(p) => format!(" <span class=\"quiet\">p = {}</span>", short_number(p)),
            None => String::new(),
        };
        let advice = match &finding.advice[..] {
            "" => String::new(),
            advice => format!("<p><b>What to do:</b> {}</p>", escape(advice)),
        };
        let link = match finding.picture {
            _ if finding.verdict > Verdict::Note => String::new(),
            name if charts.contains(&name) => {
                format!("<p class=\"quiet\"><a href=\"#chart-{name}\">Chart</a></p>")
            }
            name if pictures.contains(&name) => {
                format!("<p class=\"quiet\"><a href=\"#picture-{name}\">Picture</a></p>")
            }
            _ => String::new(),
        };
        format!(
            "<article class=\"finding {class}\"><h3><span class=\"verdict\">{word}</span> {}{p}</h3><p>{}</p>{advice}{link}</article>",
            escape(&title),
            escape(&finding.sentence)
        )
    });
    let cards: String = cards.collect();
    format!(
        "<p class=\"quiet\">The p-values of all tests are corrected together (Holm), so that faultless data show a fault with a probability of at most {} %.</p>{cards}",
        short_number(100.0 * ALPHA)
    )
}

/// Returns the title of a finding: the title of its check, and its subject.
fn title_of(finding: &Finding) -> String {
    let check = CHECKS.iter().find(|check| check.name == finding.check);
    let title = check.map_or("", |check| check.title);
    match &finding.subject[..] {
        "" => title.to_owned(),
        subject => format!("{title}: {subject}"),
    }
}

/// Returns the text of an audit for the terminal, wrapped at `width` characters. The text contains faults and notes with advice, then the names of the other
/// checks.
pub fn audit_text(findings: &[Finding], width: usize) -> String {
    let mut text = paragraph(&answers(findings)[0], width);
    for finding in by_verdict(findings) {
        if finding.verdict > Verdict::Note {
            break;
        }
        let word = match finding.verdict {
            Verdict::Fault => "FAULT",
            _ => "Note",
        };
        let p = finding
            .p_holm
            .map_or(String::new(), |p| format!(" (p = {})", short_number(p)));
        let said = format!(
            "{word}: {}{p}. {} {}",
            title_of(finding),
            finding.sentence,
            finding.advice
        );
        text += &paragraph(said.trim(), width);
    }
    for (verdict, words) in [
        (Verdict::Passed, "Passed"),
        (Verdict::NotChecked, "Not checked"),
    ] {
        let names = findings.iter().filter(|finding| finding.verdict == verdict);
        let names: Vec<String> = names.map(title_of).collect();
        if !names.is_empty() {
            text += &paragraph(&format!("{words}: {}.", names.join("; ")), width);
        }
    }
    text
}
