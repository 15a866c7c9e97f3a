//! The page of a study of recognition.

use crate::error::Result;
use crate::report::answer::Answer;
use crate::report::csv_tables::{LIMITS_FILE, TABLE_FILES};
use crate::report::drawing::escape;
use crate::report::headlines::{confused_table, published_table, variance_table};
use crate::report::page::about::ReportPage;
use crate::report::page::choices::choices_html;
use crate::report::page::frame::{Page, Section, sentences_html};
use crate::report::page::picture::{Picture, Pictures, figures};
use crate::report::page::provenance::provenance_html;
use crate::report::page::study_data::StudyData;
use crate::report::page::tables::{limits_html, summary_html, times_html, too_few_trials};
use crate::report::page::touches::touches_html;
use crate::study::table::Tables;
use std::fmt::Write;

/// Letters of pictures for readers without script, at most: a study of thousands of cells has megabytes of them.
const MOST_PICTURES: usize = 800_000;

/// The page.
///
/// # Errors
/// A sample touch that nobody can draw.
pub fn page(about: &ReportPage, tables: &Tables, pictures: &Pictures) -> Result<String> {
    let mut page = Page {
        name: about.name.clone(),
        question: about.question.clone(),
        expected: about.expected.clone(),
        foot: foot(about),
        is_old: true,
        ..Page::default()
    };
    let Some(answer) = Answer::of(tables) else {
        page.add(Section::new(
            "answer",
            "Answer",
            "<p>No cell has been computed.</p>",
        ));
        page.add(limits(about, tables));
        page.add(again(about));
        return Ok(page.html());
    };
    let data = StudyData::of(tables, &answer);
    let is_live = data.is_some();
    page.data = data.map(|data| data.json());
    page.add(Section::new(
        "answer",
        "Answer",
        sentences_html(&answer.sentences()),
    ));
    page.add(Section::new(
        "choices",
        "What to choose",
        choices_html(tables, &answer),
    ));
    page.sections
        .extend(published_table(tables).map(|table| table.section("published")));
    for section in charts(tables, pictures, is_live) {
        page.add(section);
    }
    page.add(Section::new("touches", "Sample touches", gallery(about)?));
    page.add(cells(tables, &answer, is_live));
    page.add(confusion(pictures, is_live));
    page.sections
        .extend(confused_table(tables).map(|table| table.section("confused")));
    page.sections
        .extend(variance_table(tables).map(|table| table.section("variance")));
    page.add(Section::new(
        "settings",
        "Settings",
        settings_html(about, &answer),
    ));
    page.add(limits(about, tables));
    page.add(Section::new("times", "Times", times_html(about, tables)));
    if let Some(manifest) = &about.manifest {
        page.add(Section::new(
            "provenance",
            "Provenance",
            provenance_html(manifest),
        ));
    }
    page.add(again(about));
    Ok(page.html())
}

/// What a script fills, and what stands there without one.
fn live(name: &str, is_live: bool, without: &str) -> String {
    match is_live {
        true => format!("<div id=\"{name}-live\"></div><noscript>{without}</noscript>"),
        false => without.to_owned(),
    }
}

fn charts(tables: &Tables, pictures: &Pictures, is_live: bool) -> [Section; 2] {
    let (shown, n_left_out) = light_enough(&pictures.charts);
    let mut without = figures(shown);
    let n_more = pictures.n_more_charts + n_left_out;
    if n_more > 0 {
        let _ = write!(
            without,
            "<p>{n_more} more charts lie beside this page: accuracy_by_….svg.</p>"
        );
    }
    let accuracy = "<p class=\"quiet\">Points are means over trials; intervals are 95 % Wilson intervals at the test decisions of one trial.</p>";
    let accuracy = match without.is_empty() && !is_live {
        true => String::new(),
        false => {
            let live = live("accuracy", is_live, &without);
            format!("{accuracy}{live}{}", not_drawn(&pictures.left_out))
        }
    };
    let without = figures(&pictures.times);
    let times = match tables.pareto.is_empty() || (without.is_empty() && !is_live) {
        true => String::new(),
        false => live("pareto", is_live, &without),
    };
    [
        Section::new("accuracy", "Accuracy", accuracy),
        Section::new("pareto", "Accuracy against time", times),
    ]
}

/// Which charts have no file, and how they get one.
fn not_drawn(left_out: &[String]) -> String {
    let (Some(first), Some(last)) = (left_out.first(), left_out.last()) else {
        return String::new();
    };
    format!(
        "<p class=\"quiet\">Of the files of charts only the first are drawn. {} more, from {} to {}, are left out; with script this page shows \
         every cell, and <code>bubbletouch report FOLDER --all-charts</code> draws all files.</p>",
        left_out.len(),
        escape(first),
        escape(last)
    )
}

/// The first pictures, as many as are not too heavy, and how many are left out.
fn light_enough(pictures: &[Picture]) -> (&[Picture], usize) {
    let mut letters = 0;
    let fits = |picture: &&Picture| {
        letters += picture.element.len();
        letters <= MOST_PICTURES
    };
    let n = pictures.iter().take_while(fits).count();
    (&pictures[..n], pictures.len() - n)
}

fn gallery(about: &ReportPage) -> Result<String> {
    match about.gallery.is_empty() {
        true => about.snapshots.iter().map(touches_html).collect(),
        false => about.gallery.iter().map(touches_html).collect(),
    }
}

fn cells(tables: &Tables, answer: &Answer, is_live: bool) -> Section {
    let too_few = too_few_trials(tables).map_or(String::new(), |words| format!(" {words}"));
    let note = format!(
        "<p class=\"quiet\">“As good”: the mean accuracy lies within the interval of the best cell of the same condition. “To the best” and \
         p: a t-test paired over trials, corrected for their overlap; p (Holm) is corrected for the number of cells too.{too_few}</p>"
    );
    let table = live("cells", is_live, &summary_html(tables, answer));
    Section::new("cells", "All cells", format!("{note}{table}"))
}

fn confusion(pictures: &Pictures, is_live: bool) -> Section {
    let without = figures(&pictures.confusion);
    let body = match &pictures.confusion {
        Some(_) if is_live => format!(
            "<p class=\"quiet\">Rows were touched, columns are what they were taken for; darkness grows with the square root of the share. \
             The arrow keys go from field to field; a row’s name brings what it is confused with to the front.</p>{}",
            live("confusion", true, &without)
        ),
        _ => without,
    };
    Section::new("confusion", "What was taken for what", body)
}

fn settings_html(about: &ReportPage, answer: &Answer) -> String {
    let settings = answer.settings();
    let mut html = String::from("<dl>");
    for (name, value) in &about.settings {
        let class = match value.len() > 60 {
            true => " class=\"long\"",
            false => "",
        };
        let (name, value) = (escape(name), escape(value));
        let _ = write!(html, "<div{class}><dt>{name}</dt><dd>{value}</dd></div>");
    }
    let swept = settings
        .varying
        .iter()
        .map(|levels| (levels, " <span class=\"tag\">swept</span>"));
    let fixed = settings.fixed.iter().map(|levels| (levels, ""));
    for (levels, mark) in swept.chain(fixed) {
        let values: Vec<String> = levels.values.iter().map(|v| escape(&v.label)).collect();
        let _ = write!(
            html,
            "<div><dt>{}{mark}</dt><dd>{}</dd></div>",
            levels.heading(),
            values.join(", ")
        );
    }
    html + "</dl>"
}

fn limits(about: &ReportPage, tables: &Tables) -> Section {
    Section::new("limits", "Limits", limits_html(about, tables))
}

fn again(about: &ReportPage) -> Section {
    let body = match about.command.is_empty() {
        true => String::new(),
        false => format!("<pre><code>{}</code></pre>", escape(&about.command)),
    };
    Section::new("again", "Make it again", body)
}

fn foot(about: &ReportPage) -> String {
    format!(
        "<p>{}. The tables behind this page lie beside it: {}, {LIMITS_FILE}. Times differ from run to run; all else does not.</p>",
        escape(&about.program),
        TABLE_FILES.join(", ")
    )
}
