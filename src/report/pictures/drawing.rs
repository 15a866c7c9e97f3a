//! Vector drawing: text, lines and areas at pixel positions, written as SVG or PNG.
//!
//! The crate kuva provides the primitives, the font and both writers. The complete plots of kuva are not used for two reasons. First, they place ticks at
//! powers of ten, but a sweep needs ticks at its own values. Second, the plots number clip paths per process, so that equal tables could give different bytes.

use crate::error::Result;
use crate::report::pictures::{INK, PAPER, Picture, Rgb, unfit};
use bubbletouch_sim::raster::pixels::darken;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
pub use kuva::render::render::TextAnchor as Align;
use kuva::render::render::{PathData, Primitive, Scene, TextSpan, build_path};

/// Number of image pixels per drawing pixel in the rendering by the library kuva, before averaging over blocks of 2 × 2 pixels.
///
/// kuva renders rotated text and slanted lines with jagged edges. At a scale of 4 they are smooth; at a smaller scale they are not.
const FINE: u32 = 4;

/// Position (x, y) in a drawing, pixels to the right of and below the top left corner.
pub type Point = (f64, f64);

/// Axis-aligned rectangle of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge of the rectangle, pixels.
    pub x: f64,
    /// Top edge of the rectangle, pixels.
    pub y: f64,
    /// Width of the rectangle, pixels.
    pub width: f64,
    /// Height of the rectangle, pixels.
    pub height: f64,
}

impl Area {
    /// Creates an area from its top left corner and its width and height in pixels.
    pub const fn new((x, y): Point, (width, height): (f64, f64)) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    /// Creates an area from its centre and its width and height in pixels.
    pub const fn around((x, y): Point, (width, height): (f64, f64)) -> Self {
        Self::new((x - 0.5 * width, y - 0.5 * height), (width, height))
    }

    /// Returns whether two areas have common points.
    pub fn overlaps(&self, other: &Self) -> bool {
        let apart = |a: f64, width: f64, b: f64, other: f64| a + width <= b || b + other <= a;
        !apart(self.x, self.width, other.x, other.width)
            && !apart(self.y, self.height, other.y, other.height)
    }

    /// Returns the point at a fraction of the area's width (from the left) and a fraction of its height (from below).
    pub fn at(&self, across: f64, up: f64) -> Point {
        (
            self.x + across * self.width,
            self.y + (1.0 - up) * self.height,
        )
    }
}

/// Style of a text: size, colour, alignment and rotation.
#[derive(Clone, Copy, Debug)]
pub struct TextStyle {
    /// Font size, pixels.
    pub size: u32,
    /// Colour of the text.
    pub colour: Rgb,
    /// Alignment of the text: whether the given position is its start, middle or end.
    pub align: Align,
    /// Clockwise rotation about the given position, degrees.
    pub angle: f64,
}

impl TextStyle {
    /// Creates the style of horizontal, left-aligned text in the standard text colour.
    pub const fn new(size: u32) -> Self {
        Self {
            size,
            colour: INK,
            align: Align::Start,
            angle: 0.0,
        }
    }

    /// Returns the text style with the given alignment.
    pub const fn align(self, align: Align) -> Self {
        Self { align, ..self }
    }

    /// Sets the colour of the text.
    pub const fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }

    /// Sets the clockwise rotation of the text, degrees.
    pub const fn angle(self, angle: f64) -> Self {
        Self { angle, ..self }
    }
}

/// Style of a line: colour, width and dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub colour: Rgb,
    /// Width of the line, pixels.
    pub width: f64,
    /// Lengths of the dashes and of the gaps between them, pixels; `None` for a solid line.
    pub dash: Option<(u32, u32)>,
}

impl Stroke {
    /// Creates the style of a solid line.
    pub const fn new(colour: Rgb, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: None,
        }
    }
}

/// Number of different marker shapes, which distinguish lines without colours.
pub const N_MARKERS: usize = 8;

/// Vector drawing on a white background.
#[derive(Clone)]
pub struct Drawing {
    /// Width of the drawing, pixels.
    pub width: f64,
    /// Height of the drawing, pixels.
    pub height: f64,
    elements: Vec<Primitive>,
}

impl Drawing {
    /// Creates an empty drawing of the given size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Self {
            width: width.ceil(),
            height: height.ceil(),
            elements: Vec::new(),
        }
    }

    /// Draws one line of text with its baseline at the position `at`.
    pub fn text(&mut self, at: Point, text: &str, style: TextStyle) {
        self.elements.push(Primitive::Text {
            x: snap(at.0),
            y: snap(at.1),
            content: literal(text),
            size: style.size,
            anchor: style.align,
            rotate: (style.angle != 0.0).then_some(style.angle),
            bold: false,
            color: Some(colour(style.colour)),
        });
    }

    /// Draws one line of horizontal bold text.
    pub fn bold_text(&mut self, at: Point, text: &str, style: TextStyle) {
        let mut span = TextSpan::plain(visible(text));
        span.bold = true;
        self.elements.push(Primitive::RichText {
            x: snap(at.0),
            y: snap(at.1),
            spans: vec![span],
            size: style.size,
            anchor: style.align,
            color: Some(colour(style.colour)),
        });
    }

    /// Draws a straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// Draws a line through several points.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke) {
        self.elements.push(Primitive::PolyLine {
            points: points.iter().map(|&(x, y)| (snap(x), snap(y))).collect(),
            stroke: colour(stroke.colour),
            stroke_width: stroke.width,
            stroke_dasharray: stroke.dash.map(|(on, off)| format!("{on} {off}")),
        });
    }

    /// Draws a filled polygon with an opacity from 0 to 1.
    pub fn polygon(&mut self, points: &[Point], fill: Rgb, opacity: f64) {
        let corners: Vec<Point> = points.iter().map(|&(x, y)| (snap(x), snap(y))).collect();
        self.elements.push(Primitive::Path(Box::new(PathData {
            d: build_path(&corners) + "Z",
            fill: Some(colour(fill)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: (opacity < 1.0).then_some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// Draws a filled rectangle without a border.
    pub fn area(&mut self, area: Area, fill: Rgb) {
        self.elements.push(Primitive::Rect {
            x: snap(area.x),
            y: snap(area.y),
            width: snap(area.width),
            height: snap(area.height),
            fill: colour(fill),
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
    }

    /// Draws the border of a rectangle.
    pub fn frame(&mut self, area: Area, stroke: Stroke) {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
        let corners = corners.map(|(across, up)| area.at(across, up));
        self.polyline(&corners, stroke);
    }

    /// Draws a filled marker at a point; `radius` is in pixels. The shape of the marker depends on the index of the line. A white rim separates the marker from
    /// the background.
    pub fn marker(&mut self, line: usize, at: Point, radius: f64, fill: Rgb) {
        for (radius, fill) in [(radius + 1.2, PAPER), (radius, fill)] {
            match line % N_MARKERS {
                0 => self.disc(at, radius, fill),
                shape => self.polygon(&marker_outline(shape, at, radius), fill, 1.0),
            }
        }
    }

    /// Draws a filled disc; `radius` is in pixels.
    pub fn disc(&mut self, at: Point, radius: f64, fill: Rgb) {
        self.elements.push(Primitive::Circle {
            cx: snap(at.0),
            cy: snap(at.1),
            r: snap(radius),
            fill: colour(fill),
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }

    /// Draws elements inside an SVG group with `data-` attributes. The group is only written by `svg_with_data`.
    pub fn group<'n>(
        &mut self,
        data: impl IntoIterator<Item = (&'n str, String)>,
        draw: impl FnOnce(&mut Self),
    ) {
        let attributes = data.into_iter();
        let attributes =
            attributes.map(|(name, value)| format!("data-{name}=\"{}\"", escape(&value)));
        self.elements.push(Primitive::GroupStart {
            transform: None,
            title: None,
            extra_attrs: Some(attributes.collect::<Vec<_>>().join(" ")),
        });
        draw(self);
        self.elements.push(Primitive::GroupEnd);
    }

    /// Returns the drawing as an SVG file that scales to the width of its container. The label for screen readers is `title`.
    pub fn svg(&self, title: &str) -> String {
        let is_drawn = |element: &&Primitive| {
            !matches!(element, Primitive::GroupStart { .. } | Primitive::GroupEnd)
        };
        let elements = self.elements.iter().filter(is_drawn);
        self.svg_of(elements.cloned().collect(), title)
    }

    /// Returns the drawing as an SVG file with groups and `data-` attributes, which scripts of the page use.
    pub fn svg_with_data(&self, title: &str) -> String {
        self.svg_of(self.elements.clone(), title)
    }

    fn svg_of(&self, elements: Vec<Primitive>, title: &str) -> String {
        let plain = SvgBackend::default().render_scene(&self.scene(elements));
        let opening = r#"<svg xmlns="http://www.w3.org/2000/svg""#;
        let scaled = format!(
            r#"{opening} viewBox="0 0 {} {}" role="img" aria-label="{}""#,
            self.width,
            self.height,
            escape(title)
        );
        plain.replacen(opening, &scaled, 1) + "\n"
    }

    /// Returns the drawing as a PNG file with two image pixels for each pixel of the drawing.
    ///
    /// # Errors
    /// If the drawing cannot be rendered.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.picture()?.png()
    }

    /// Renders the drawing with two image pixels for each pixel of the drawing, in about 0.1 s.
    ///
    /// # Errors
    /// If the drawing cannot be rendered.
    pub fn picture(&self) -> Result<Picture> {
        Ok(self.pixels(FINE)?.halved())
    }

    /// Renders the drawing with `scale` image pixels for each pixel of the drawing.
    pub(crate) fn pixels(&self, scale: u32) -> Result<Picture> {
        let mut elements = self.elements.clone();
        for element in &mut elements {
            if let Primitive::PolyLine {
                stroke_dasharray: Some(dashes),
                ..
            } = element
            {
                // kuva scales all lengths except the dashes.
                let lengths = dashes.split(' ').filter_map(|n| n.parse::<u32>().ok());
                let lengths: Vec<String> = lengths.map(|n| (n * scale).to_string()).collect();
                *dashes = lengths.join(" ");
            }
        }
        let png = kuva::RasterBackend::new()
            .with_scale(scale as f32)
            .render_scene(&self.scene(elements));
        Picture::of_png(&png.map_err(unfit)?)
    }

    fn scene(&self, elements: Vec<Primitive>) -> Scene {
        let mut scene = Scene::new(self.width, self.height);
        scene.background_color = Some(colour(PAPER).to_svg_string());
        scene.font_family = Some("DejaVu Sans, Verdana, sans-serif".to_owned());
        scene.elements = elements;
        scene
    }
}

/// Escapes the characters that have a special meaning in HTML and SVG.
pub fn escape(text: &str) -> String {
    let is_forbidden = |letter: char| letter.is_control() && !matches!(letter, '\n' | '\t');
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
        .replace(is_forbidden, " ")
}

/// Escapes `$` in a text, because the rendering library kuva parses `$…$` as mathematics.
fn literal(text: &str) -> String {
    visible(text).replace('$', "\\$")
}

/// Replaces control characters in a text by spaces: XML forbids most of them, and they are invisible.
fn visible(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Rounds a coordinate to a quarter of a pixel, which makes SVG files smaller without visible differences.
fn snap(position: f64) -> f64 {
    (position * 4.0).round() / 4.0
}

fn colour([r, g, b]: Rgb) -> Color {
    Color::Rgb(r, g, b)
}

/// Returns the corners of a marker with the given shape, centre and radius. The shapes are: square, triangle up, diamond, triangle down, pentagon, hexagon, and
/// a star with four points.
fn marker_outline(shape: usize, (x, y): Point, radius: f64) -> Vec<Point> {
    let (corners, turn, scale) = match shape {
        1 => (4, 45.0, 1.25),
        2 => (3, -90.0, 1.4),
        3 => (4, 0.0, 1.3),
        4 => (3, 90.0, 1.4),
        5 => (5, -90.0, 1.2),
        6 => (6, 0.0, 1.2),
        _ => (8, 0.0, 1.7),
    };
    let corner = |number: i32| {
        let angle = (turn + 360.0 * f64::from(number) / f64::from(corners)).to_radians();
        let is_inwards = corners == 8 && number % 2 == 1;
        let radius = scale * radius * if is_inwards { 0.45 } else { 1.0 };
        (x + radius * angle.cos(), y + radius * angle.sin())
    };
    (0..corners).map(corner).collect()
}

impl Picture {
    /// Draws a drawing of equal size onto the picture. White areas of the drawing leave the picture unchanged.
    pub(crate) fn print(&mut self, drawing: &Drawing) -> Result<()> {
        darken(&mut self.rgb, &drawing.pixels(1)?.rgb);
        Ok(())
    }
}
