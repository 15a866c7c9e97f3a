//! Page, pictures, files and terminal text of an audit.

use crate::audit::claim::Claim;
use crate::audit::context::Context;
use crate::audit::finding::{ALPHA, Finding, Verdict, by_verdict};
use crate::audit::readings::TaxelState;
use crate::audit::run::Audit;
use crate::engine::provenance::PROGRAM;
use crate::error::Result;
use crate::report::folder::{NamedFile, table_files};
use crate::report::page::{Section, StudyAbout, png_element};
use crate::report::pictures::colours::heat;
use crate::report::pictures::drawing::escape;
use crate::report::pictures::picture::Picture;
use crate::report::study_folder::{Beyond, Found, NamedPicture, files_with};
use crate::report::terminal::paragraph;
use crate::table::short_number;
use bubbletouch_sim::raster::Rgb;

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

/// Largest width and height of the pictures of a row, pixels.
const WIDTH: usize = 450;
/// Maximum number of pairs of frames in a picture.
const MAX_PAIRS: usize = 4;
/// Space between two frames, pixels.
const GAP: usize = 8;

/// Draws the pictures of an audit.
///
/// # Errors
/// If a picture cannot be encoded.
pub fn pictures(
    context: &Context,
    claim: &Claim,
    states: &[TaxelState],
) -> Result<Vec<NamedPicture>> {
    let n_taxels = context.taxels.len();
    // Without a grid, the taxels of the list are arranged in a rectangle.
    let columns = (n_taxels as f64).sqrt().ceil() as usize;
    let shape = context
        .data
        .grid
        .unwrap_or((n_taxels.div_ceil(columns), columns));
    let mut pictures = vec![taxel_picture(context, states, shape)?];
    let copies = claim.copies.iter().map(|set| [set.rows[0], set.rows[1]]);
    let nearest = |touch: usize| context.near.neighbours[touch][0];
    let doubtful = claim.doubtful.iter().map(|doubtful| doubtful.touch);
    let doubtful = doubtful.map(|touch| [touch, nearest(touch)]);
    let rows: [(&str, &str, Vec<[usize; 2]>); 2] = [
        (
            "copies",
            "Copies: each pair shows a touch and its copy",
            copies.take(MAX_PAIRS).collect(),
        ),
        (
            "doubtful_labels",
            "Labels to look at: each pair shows a touch and its nearest touch, of another class",
            doubtful.take(MAX_PAIRS).collect(),
        ),
    ];
    let named = |touch: &usize| {
        let class = context.data.classes.get(context.labels[*touch]);
        class.map_or_else(|| touch.to_string(), |class| format!("{touch} ({class})"))
    };
    for (name, title, pairs) in rows {
        if !pairs.is_empty() {
            let said = pairs
                .iter()
                .map(|pair| pair.each_ref().map(named).join(" and "));
            let said = said.collect::<Vec<_>>().join(", ");
            let title = format!("{title}; touches, from the top: {said}");
            let panels = pairs.into_iter().flatten();
            let panels: Vec<_> = panels.map(|touch| colours_of(context, touch)).collect();
            pictures.push(draw((name, &title), shape, &panels)?);
        }
    }
    Ok(pictures)
}

/// Draws the mean reading of each taxel; faulty taxels are coloured.
fn taxel_picture(
    context: &Context,
    states: &[TaxelState],
    shape: (usize, usize),
) -> Result<NamedPicture> {
    let means = context.taxels.iter().map(|taxel| taxel.mean);
    let least = means.clone().fold(f64::INFINITY, f64::min);
    let largest = means.clone().fold(f64::NEG_INFINITY, f64::max);
    let range = (largest - least).max(f64::MIN_POSITIVE);
    let taxels = means.zip(states).zip(&context.n_missing);
    let colours = taxels.map(|((mean, state), n_missing)| match state {
        _ if *n_missing > 0 => [0, 158, 115],
        TaxelState::Constant => [0, 114, 178],
        TaxelState::Stuck => [213, 94, 0],
        TaxelState::Equal => [204, 121, 167],
        TaxelState::Working => [(235.0 - 150.0 * (mean - least) / range) as u8; 3],
    });
    let title = "Taxels: dark is a high mean reading; blue is constant, orange stuck for some time, pink equal to another, green has missing readings";
    draw(("taxels", title), shape, &[colours.collect()])
}

/// Returns the colours of the mean frame of a touch, as deviations from the medians of the taxels.
fn colours_of(context: &Context, touch: usize) -> Vec<Rgb> {
    let readings = context.means.row(touch);
    let away = readings.iter().zip(&context.taxels);
    let away: Vec<f64> = away.map(|(x, taxel)| (x - taxel.median).abs()).collect();
    let largest = away.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    away.iter().map(|x| heat(x / largest)).collect()
}

/// Draws rectangles of coloured taxels, two side by side, each taxel as a square. Row 0 of a grid is at the bottom.
fn draw(
    (name, title): (&str, &str),
    (rows, columns): (usize, usize),
    panels: &[Vec<Rgb>],
) -> Result<NamedPicture> {
    let n_across = panels.len().min(2);
    let n_down = panels.len().div_ceil(n_across);
    let side = (WIDTH / n_across / columns).min(WIDTH / rows).clamp(1, 24);
    let (wide, high) = (columns * side + GAP, rows * side + GAP);
    let size = (n_across * wide - GAP, n_down * high - GAP);
    let mut rgb = vec![255; 3 * size.0 * size.1];
    for (panel, colours) in panels.iter().enumerate() {
        let (left, top) = (panel % n_across * wide, panel / n_across * high);
        for (taxel, colour) in colours.iter().enumerate() {
            let (row, column) = (taxel / columns, taxel % columns);
            let y = top + (rows - 1 - row) * side;
            for y in y..y + side {
                let start = 3 * (y * size.0 + left + column * side);
                let pixels = &mut rgb[start..start + 3 * side];
                let pixels = pixels.chunks_exact_mut(3);
                pixels.for_each(|pixel| pixel.copy_from_slice(colour));
            }
        }
    }
    let picture = Picture {
        width: size.0,
        height: size.1,
        rgb,
    };
    Ok(NamedPicture {
        name: name.to_owned(),
        title: title.to_owned(),
        png: picture.png()?,
        size,
    })
}
