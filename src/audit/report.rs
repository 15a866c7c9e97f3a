//! Page, files and terminal text of an audit.

use crate::audit::finding::{ALPHA, Finding, Verdict, by_verdict};
use crate::audit::run::Audit;
use crate::engine::program::PROGRAM;
use crate::error::Result;
use crate::report::folder::{NamedFile, table_files};
use crate::report::page::{Section, StudyAbout, png_element};
use crate::report::pictures::drawing::escape;
use crate::report::study_folder::{Beyond, Found, NamedPicture, files_with};
use crate::report::terminal::paragraph;
use crate::table::short_number;

/// What no audit of arrays can find.
const BEYOND: &str = "Arrays cannot show whether features were selected or scaled on all touches before the split, or whether a method was chosen by the accuracy of the test set.";

/// Names of the files of an audit that are always written, for the list of owned files.
pub const AUDIT_FILES: &[&str] = &[
    "report.html",
    "findings.csv",
    "accuracy_by_split.csv",
    "sources.csv",
    "levels.csv",
    "rows.csv",
    "taxels.csv",
    "accuracy_by_split.svg",
    "sources.svg",
    "levels.svg",
    "taxels.png",
    "copies.png",
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
    let found = Found {
        tables: &audit.tables,
        charts: &audit.charts,
        answers: &audit.sentences,
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
        let p = match &finding.p_text()[..] {
            "" => String::new(),
            p => format!(" <span class=\"quiet\">{}</span>", escape(p)),
        };
        let advice = match &finding.advice[..] {
            "" => String::new(),
            advice => format!("<p><b>What to do:</b> {}</p>", escape(advice)),
        };
        let link = match finding.picture {
            _ if finding.verdict == Verdict::Passed => String::new(),
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
            escape(&finding.title()),
            escape(&finding.sentence)
        )
    });
    let cards: String = cards.collect();
    format!(
        "<p class=\"quiet\">The p-values of all tests are corrected together (Holm), so that faultless data show a fault with a probability of at most {} %. {BEYOND}</p>{cards}",
        short_number(100.0 * ALPHA)
    )
}

/// Returns the text of an audit for the terminal, wrapped at `width` characters. The text contains the sentences on the claim, the findings with advice, and
/// the names of the checks that passed.
pub fn audit_text(audit: &Audit, width: usize) -> String {
    let sentences = audit.sentences.iter();
    let mut text: String = sentences
        .map(|sentence| paragraph(sentence, width))
        .collect();
    let findings = by_verdict(&audit.findings);
    for finding in findings
        .iter()
        .filter(|finding| finding.verdict != Verdict::Passed)
    {
        let word = match finding.verdict {
            Verdict::Fault => "FAULT",
            Verdict::NotChecked => "Not checked",
            _ => "Note",
        };
        let p = match &finding.p_text()[..] {
            "" => String::new(),
            p => format!(" ({p})"),
        };
        let said = format!(
            "{word}: {}{p}. {} {}",
            finding.title(),
            finding.sentence,
            finding.advice
        );
        text += &paragraph(said.trim(), width);
    }
    let passed = findings
        .iter()
        .filter(|finding| finding.verdict == Verdict::Passed);
    let passed: Vec<String> = passed.map(|finding| finding.title()).collect();
    text + &paragraph(&format!("Passed: {}.", passed.join("; ")), width)
}
