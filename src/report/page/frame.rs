//! Common parts of all pages: head, question, table of contents, sections and footer.

use crate::report::pictures::escape;
use crate::report::study_folder::StudyAbout;

/// JavaScript files of the page. The file `elements.js` comes first, because the other scripts use it.
const SCRIPT: [&str; 3] = [
    include_str!("script/elements.js"),
    include_str!("script/charts.js"),
    include_str!("script/tables.js"),
];

/// Section of an HTML page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Anchor by which links refer to the section; letters and hyphens only.
    pub id: &'static str,
    /// Heading of the section.
    pub title: &'static str,
    /// HTML of the section below its heading. Sections with an empty body are omitted.
    pub body: String,
}

impl Section {
    /// Creates a section of a page with an anchor, a heading and HTML below the heading.
    pub fn new(id: &'static str, title: &'static str, body: String) -> Self {
        Self { id, title, body }
    }

    fn html(&self) -> String {
        let Self { id, title, body } = self;
        let class = match *id {
            "answer" => " class=\"found\"",
            _ => "",
        };
        format!(
            "<section id=\"{id}\" aria-labelledby=\"{id}-title\"{class}>\n<h2 id=\"{id}-title\">{title}</h2>\n{body}\n</section>\n"
        )
    }
}

/// Returns an HTML page with the metadata of a study and the given sections. The HTML of the footer is `foot`. Sections without a body are omitted.
pub(crate) fn html(about: &StudyAbout, sections: &[Section], foot: &str) -> String {
    let sections = sections.iter().filter(|section| !section.body.is_empty());
    let paragraph = |class: &str, before: &str, text: &str| match text {
        "" => String::new(),
        text => format!("<p class=\"{class}\">{before}{}</p>", escape(text)),
    };
    let link =
        |Section { id, title, .. }: &Section| format!("<li><a href=\"#{id}\">{title}</a></li>");
    format!(
        include_str!("page.html"),
        style = include_str!("page.css"),
        name = escape(&about.name),
        question = paragraph("question", "", &about.question),
        expected = paragraph("quiet", "Expected: ", &about.expected),
        contents = sections.clone().map(link).collect::<String>(),
        sections = sections.clone().map(Section::html).collect::<String>(),
        foot = foot,
        script = SCRIPT.join("\n"),
    )
}

/// Returns an HTML entry of a definition list with the given name and value. The name is HTML, the value is plain text.
pub(crate) fn definition(name: &str, value: &str) -> String {
    let class = match value.len() > 60 {
        true => " class=\"long\"",
        false => "",
    };
    let value = escape(value);
    format!("<div{class}><dt>{name}</dt><dd>{value}</dd></div>")
}

/// Returns sentences as an HTML list; empty if there are no sentences.
pub(crate) fn sentences_html(sentences: &[String]) -> String {
    let items = sentences.iter();
    let items = items.map(|sentence| format!("<li>{}</li>", unbroken(sentence)));
    match items.collect::<String>() {
        items if items.is_empty() => items,
        items => format!("<ul>{items}</ul>"),
    }
}

/// Returns a sentence as HTML without line breaks between a number and its unit or sign.
pub(crate) fn unbroken(text: &str) -> String {
    let parts = [" mm", " %", " = ", " ms"];
    parts.iter().fold(escape(text), |text, part| {
        text.replace(part, &part.replace(' ', "\u{a0}"))
    })
}

/// Returns an HTML element that contains a PNG file and shows it with the given width and height in pixels. The title is the text for screen readers.
pub(crate) fn png_element(png: &[u8], (width, height): (usize, usize), title: &str) -> String {
    let (data, title) = (base64(png), escape(title));
    format!(
        r#"<img src="data:image/png;base64,{data}" width="{width}" height="{height}" alt="{title}">"#
    )
}

/// Returns an HTML `<figure>` with the given attributes, which contains an `<svg>` or `<img>` element.
pub(crate) fn figure(attributes: &str, element: &str, title: &str) -> String {
    let title = escape(title);
    format!("<figure {attributes} tabindex=\"0\" aria-label=\"{title}\">{element}</figure>")
}

/// Encodes bytes as base64 (RFC 4648) with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() {
                char::from(letter)
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_agrees_with_the_examples_of_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
