//! Page of a study of any kind.

use super::frame::{Section, definition, figure, html, png_element, sentences_html, unbroken};
use super::table::table_html;
use crate::engine::provenance::Manifest;
use crate::report::advice::{AdviceQuery, Candidates};
use crate::report::pictures::escape;
use crate::report::study_folder::{Beyond, ChartFormat, Found, NamedPicture, StudyAbout};
use crate::spelling::counted;
use crate::table::{ChartSpec, Table, short_number};

/// Maximum size of all charts on a page together, bytes. With a larger value, the page is slow; with a smaller value, charts of some hundred points become
/// links.
const MAX_CHART_BYTES: usize = 1_200_000;
/// Maximum size of a table with charts on a page, bytes. With a larger value, the page is slow; with a smaller value, tooltips of charts have no rows.
const MAX_TABLE_BYTES: usize = 1_200_000;
/// Maximum size of a table without charts on a page, bytes; its file has all rows.
const MAX_OTHER_BYTES: usize = 40_000;

/// Parts of a study's HTML page that are neither tables nor answers.
#[derive(Default)]
pub(crate) struct Beside {
    /// Charts as SVG files that contain the data of their marks, in the order of the chart specifications.
    pub charts: Vec<String>,
    /// Names of the charts that were not drawn because there are too many.
    pub left_out: Vec<String>,
    /// Additional content of the page: pictures that are not charts, and sections, which come before the tables.
    pub beyond: Beyond,
}

/// Returns the page of a study as HTML.
pub(crate) fn page(about: &StudyAbout, found: &Found, beside: &Beside) -> String {
    let pictures = beside.beyond.pictures.iter().map(picture_html).collect();
    // The first screen holds the first sentence and the first two charts.
    let (first, others) = found.answers.split_at(found.answers.len().min(1));
    let first = first.iter();
    let first = first.map(|first| format!("<p class=\"answer\">{}</p>", unbroken(first)));
    let mut sections = vec![Section::new("answer", "Answer", first.collect())];
    sections.extend_from_slice(&beside.beyond.first_sections);
    sections.extend([
        Section::new("charts", "Charts", charts_html(about, found, beside)),
        Section::new("more", "Further findings", sentences_html(others)),
        Section::new("choices", "What to choose", choices_html(found)),
        Section::new("pictures", "Pictures", pictures),
    ]);
    sections.extend_from_slice(&beside.beyond.sections);
    let provenance = about.manifest.as_ref().map(provenance_html);
    sections.extend([
        Section::new("tables", "Tables", tables_html(found)),
        Section::new("provenance", "Provenance", provenance.unwrap_or_default()),
        Section::new("again", "Make it again", again(about)),
    ]);
    html(about, &sections, &foot(about, found.tables))
}

fn picture_html(picture: &NamedPicture) -> String {
    let title = &picture.title;
    let image = png_element(&picture.png, picture.size, title);
    let caption = format!("<figcaption>{}</figcaption>", escape(title));
    figure("class=\"card\"", &(image + &caption), title)
}

/// Returns the charts as HTML; charts that are too large for the page become links to their files.
fn charts_html(about: &StudyAbout, found: &Found, beside: &Beside) -> String {
    let mut bytes = 0;
    let ending = match about.chart_format {
        ChartFormat::Png => "png",
        ChartFormat::Svg | ChartFormat::Both => "svg",
    };
    let place = |(chart, svg): (&ChartSpec, &String)| {
        let (name, title) = (escape(&chart.name), escape(&chart.title));
        let heading = format!("<h3 class=\"unseen\" id=\"chart-{name}\">{title}</h3>");
        if bytes + svg.len() > MAX_CHART_BYTES {
            return format!(
                "{heading}<p>The chart “{title}” has too many points for a page: <a href=\"{name}.{ending}\">{name}.{ending}</a>.</p>"
            );
        }
        bytes += svg.len();
        let table = found.tables.iter().find(|table| table.file == chart.table);
        let words = |name: &str| {
            let column = table.and_then(|table| table.column(name));
            column.map_or_else(String::new, |(column, _)| escape(&column.words))
        };
        let kind = match chart.mark.fill().is_some() {
            true => "card chart tiles",
            false => "card chart",
        };
        let attributes = format!(
            "class=\"{kind}\" data-table=\"{}\" data-x=\"{}\" data-y=\"{}\"",
            escape(chart.table),
            words(&chart.x),
            words(&chart.y)
        );
        heading + &figure(&attributes, svg, &chart.title)
    };
    let charts = found.charts.iter().zip(&beside.charts).map(place);
    charts.collect::<String>() + &not_drawn(&beside.left_out)
}

/// Returns an HTML sentence that states which charts were not drawn and how to draw them.
fn not_drawn(left_out: &[String]) -> String {
    let (Some(first), Some(last)) = (left_out.first(), left_out.last()) else {
        return String::new();
    };
    format!(
        "<p class=\"quiet\">Only the first charts are drawn. {} more, from {} to {}, are left out; <code>bubbletouch report FOLDER --all-charts</code> \
         draws their files, and the tables below hold their rows.</p>",
        left_out.len(),
        escape(first),
        escape(last)
    )
}

/// Returns all tables as HTML. Large tables are truncated to their first rows.
fn tables_html(found: &Found) -> String {
    let place = |table: &Table| {
        let is_charted = found.charts.iter().any(|chart| chart.table == table.file);
        let room = if is_charted {
            MAX_TABLE_BYTES
        } else {
            MAX_OTHER_BYTES
        };
        let made = (table.n_rows > 0).then(|| table_html(table, room));
        let (file, title, n) = (escape(table.file), escape(table.title), table.n_rows);
        let body = match &made {
            None => "<p>No rows.</p>".to_owned(),
            Some(made) if made.n_rows == n => made.html.clone(),
            Some(made) => {
                let whole = match table.csv.is_empty() {
                    true => "the tables of which it is made, beside this page, have all".to_owned(),
                    false => format!("<a href=\"{file}\">{file}</a> beside this page has all"),
                };
                format!(
                    "<p>The first {} of {n} rows; {whole}.</p>{}",
                    made.n_rows, made.html
                )
            }
        };
        // A table that is derived from others has no file.
        let name = match table.csv.is_empty() {
            true => String::new(),
            false => format!("{file}. "),
        };
        let times = match table.repeats {
            true => "",
            false => " Times differ from run to run.",
        };
        let note = escape(&table.note);
        format!("<h3>{title}</h3><p class=\"quiet\">{name}{note}{times}</p>{body}")
    };
    found.tables.iter().map(place).collect()
}

fn again(about: &StudyAbout) -> String {
    let took = match about.wall_s {
        s if s.is_finite() => format!(
            "<p>The run took {} s from start to end.</p>",
            short_number(s)
        ),
        _ => String::new(),
    };
    match &about.command[..] {
        "" => took,
        command => format!("{took}<pre><code>{}</code></pre>", escape(command)),
    }
}

fn foot(about: &StudyAbout, tables: &[Table]) -> String {
    let files = tables.iter().filter(|table| !table.csv.is_empty());
    let files: Vec<&str> = files.map(|table| table.file).collect();
    format!(
        "<p>{}. The tables behind this page lie beside it: {}. Times differ from run to run; all else does not.</p>",
        escape(&about.program),
        escape(&files.join(", "))
    )
}

/// Returns an HTML table of the best choices. For each condition, the table lists the choices that are better than all choices of equal or
/// lower cost. The HTML is empty if no table has choices with costs.
fn choices_html(found: &Found) -> String {
    let Ok(offers) = Candidates::new(found.tables, &AdviceQuery::default()) else {
        return String::new();
    };
    let (table, value) = (offers.table, offers.value);
    if !table.compares_choices() {
        return String::new();
    }
    format!(
        "<p class=\"quiet\">The Pareto front of “{}”: each row reaches its {} for the least {}. Each condition of the world has a front of its own. \
         <code>bubbletouch advise</code> selects a row by a value, a budget or another cost.</p>{}",
        escape(table.title),
        escape(&value.words),
        escape(&offers.cost.words),
        table_html(&offers.front_table(), MAX_OTHER_BYTES).html
    )
}

/// Returns the provenance as HTML: program, machine, times and hashes.
fn provenance_html(manifest: &Manifest) -> String {
    let Manifest { program, cpu, .. } = manifest;
    let [cores, threads] = [(manifest.cores, "core"), (manifest.threads, "thread")]
        .map(|(number, one)| counted(number, one));
    let rows = [
        ("Program", format!("{program}, commit {}", manifest.commit)),
        (
            "Built",
            format!("{} for {}", manifest.rustc, manifest.target),
        ),
        ("Machine", format!("{cpu}, {cores}, {threads} used")),
        (
            "Run (UTC)",
            format!("{} to {}", manifest.started, manifest.ended),
        ),
        (
            "Work items",
            format!(
                "{}; {} were finished before this run, {} failed",
                manifest.n_configurations, manifest.n_finished_before, manifest.n_failed
            ),
        ),
        ("Seed", manifest.seed.to_string()),
        ("Hash of the sources", manifest.source.clone()),
        ("SHA-256 of study.toml", manifest.study_sha256.clone()),
    ];
    let rows = rows.iter().map(|(name, value)| definition(name, value));
    format!(
        "<dl>{}</dl><p class=\"quiet\">manifest.json lists the hashes of all tables and objects, and the methods of intervals and p-values.</p>",
        rows.collect::<String>()
    )
}
