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
    let cards = by_verdict(findings).into_iter().map(|finding| {
        let advice = match &finding.advice[..] {
            "" => String::new(),
            advice => format!("<p><b>What to do:</b> {}</p>", escape(advice)),
        };
        let places = [("chart", "Chart", charts), ("picture", "Picture", pictures)];
        let place = places.iter().find(|place| place.2.contains(&&finding.picture[..]));
        let place = place.filter(|_| finding.verdict != Verdict::Passed);
        let link = place.map_or(String::new(), |(kind, word, _)| {
            format!("<p class=\"quiet\"><a href=\"#{kind}-{}\">{word}</a></p>", finding.picture)
        });
        format!(
            "<article class=\"finding {}\"><h3><span class=\"verdict\">{}</span> {} <span class=\"quiet\">{}</span></h3><p>{}</p>{advice}{link}</article>",
            finding.verdict.word(),
            finding.verdict.words(),
            escape(&finding.title()),
            escape(&finding.p_text()),
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
    let (passed, found): (Vec<&Finding>, _) = by_verdict(&audit.findings)
        .into_iter()
        .partition(|finding| finding.verdict == Verdict::Passed);
    let found = found.into_iter().map(|finding: &Finding| {
        let p = match &finding.p_text()[..] {
            "" => String::new(),
            p => format!(" ({p})"),
        };
        let (word, title) = (finding.verdict.words(), finding.title());
        let said = format!(
            "{word}: {title}{p}. {} {}",
            finding.sentence, finding.advice
        );
        said.trim().to_owned()
    });
    let passed: Vec<String> = passed.into_iter().map(Finding::title).collect();
    let passed = format!("Passed: {}.", passed.join("; "));
    let all = audit.sentences.iter().cloned().chain(found).chain([passed]);
    all.map(|text| paragraph(&text, width)).collect()
}
