//! A drawing: text, lines and areas at pixel positions, written as SVG and as PNG.
//!
//! kuva carries the primitives, the font and both writers. Its ready-made plots are not used: they put ticks at powers of
//! ten where a sweep needs them at its own values, and number their clip paths per process, so that the same table would
//! not always be the same bytes.

use crate::error::Result;
use crate::report::colours::{INK, PAPER, Rgb};
use crate::report::picture::Picture;
use crate::report::raster::ToRaster;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor, TextSpan, build_path};

/// A place in a drawing, pixels from the top left corner: `(x, y)`.
pub type Point = (f64, f64);

/// An axis-aligned area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge, pixels.
    pub x: f64,
    /// Top edge, pixels.
    pub y: f64,
    /// Pixels across.
    pub width: f64,
    /// Pixels down.
    pub height: f64,
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Font size, pixels.
    pub size: u32,
    /// Colour.
    pub colour: Rgb,
    /// What stands at the given place.
    pub align: Align,
    /// Clockwise turn about the given place, degrees.
    pub angle: f64,
}

impl TextStyle {
    /// Level, left-aligned text in the ink colour.
    pub const fn new(size: u32) -> Self {
        Self {
            size,
            colour: INK,
            align: Align::Start,
            angle: 0.0,
        }
    }

    /// The same with another alignment.
    pub const fn align(self, align: Align) -> Self {
        Self { align, ..self }
    }

    /// The same in another colour.
    pub const fn colour(self, colour: Rgb) -> Self {
        Self { colour, ..self }
    }

    /// The same, turned.
    pub const fn angle(self, angle: f64) -> Self {
        Self { angle, ..self }
    }
}

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: Rgb,
    /// Width, pixels.
    pub width: f64,
    /// Pixels on and off, or an unbroken line.
    pub dash: Option<(u32, u32)>,
}

impl Stroke {
    /// An unbroken line.
    pub const fn new(colour: Rgb, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: None,
        }
    }
}

/// Shapes that mark the points of a line, so that colour alone never tells lines apart.
pub const N_MARKERS: usize = 8;

/// A drawing on white paper.
pub struct Drawing {
    scene: Scene,
}

impl Drawing {
    /// An empty drawing of a size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        let mut scene = Scene::new(width.ceil(), height.ceil());
        scene.background_color = Some(colour(PAPER).to_svg_string());
        scene.font_family = Some("DejaVu Sans, Verdana, sans-serif".to_owned());
        Self { scene }
    }

    /// Pixels across.
    pub fn width(&self) -> f64 {
        self.scene.width
    }

    /// Pixels down.
    pub fn height(&self) -> f64 {
        self.scene.height
    }

    /// One line of text whose baseline runs through `at`.
    pub fn text(&mut self, at: Point, text: &str, style: TextStyle) {
        self.scene.add(Primitive::Text {
            x: snap(at.0),
            y: snap(at.1),
            content: literal(text),
            size: style.size,
            anchor: anchor(style.align),
            rotate: (style.angle != 0.0).then_some(style.angle),
            bold: false,
            color: Some(colour(style.colour)),
        });
    }

    /// One line of level, bold text.
    pub fn bold_text(&mut self, at: Point, text: &str, style: TextStyle) {
        let mut span = TextSpan::plain(visible(text));
        span.bold = true;
        self.scene.add(Primitive::RichText {
            x: snap(at.0),
            y: snap(at.1),
            spans: vec![span],
            size: style.size,
            anchor: anchor(style.align),
            color: Some(colour(style.colour)),
        });
    }

    /// A straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.scene.add(Primitive::Line {
            x1: snap(from.0),
            y1: snap(from.1),
            x2: snap(to.0),
            y2: snap(to.1),
            stroke: colour(stroke.colour),
            stroke_width: stroke.width,
            stroke_dasharray: stroke.dash.map(|(on, off)| format!("{on} {off}")),
        });
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke) {
        self.scene.add(Primitive::PolyLine {
            points: points.iter().map(|&(x, y)| (snap(x), snap(y))).collect(),
            stroke: colour(stroke.colour),
            stroke_width: stroke.width,
            stroke_dasharray: stroke.dash.map(|(on, off)| format!("{on} {off}")),
        });
    }

    /// A filled polygon; opacity from 0 to 1.
    pub fn polygon(&mut self, points: &[Point], fill: Rgb, opacity: f64) {
        let corners: Vec<Point> = points.iter().map(|&(x, y)| (snap(x), snap(y))).collect();
        self.scene.add(Primitive::Path(Box::new(PathData {
            d: build_path(&corners) + "Z",
            fill: Some(colour(fill)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: (opacity < 1.0).then_some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// A filled area without a border.
    pub fn area(&mut self, area: Area, fill: Rgb) {
        self.scene.add(Primitive::Rect {
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

    /// The border of an area.
    pub fn frame(&mut self, area: Area, stroke: Stroke) {
        let (left, top) = (area.x, area.y);
        let (right, bottom) = (area.x + area.width, area.y + area.height);
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        for side in corners.windows(2) {
            self.line(side[0], side[1], stroke);
        }
    }

    /// The marker of a line's number, filled, of a radius in pixels, with a white rim that parts it from what lies below.
    pub fn marker(&mut self, line: usize, at: Point, radius: f64, fill: Rgb) {
        if line.is_multiple_of(N_MARKERS) {
            for (r, fill) in [(radius + 1.0, PAPER), (radius, fill)] {
                self.scene.add(Primitive::Circle {
                    cx: snap(at.0),
                    cy: snap(at.1),
                    r,
                    fill: colour(fill),
                    fill_opacity: None,
                    stroke: None,
                    stroke_width: None,
                });
            }
            return;
        }
        self.polygon(&marker_outline(line, at, radius + 1.4), PAPER, 1.0);
        self.polygon(&marker_outline(line, at, radius), fill, 1.0);
    }

    /// The drawing as an SVG file that scales to the width it is given; `title` is read aloud by screen readers.
    pub fn svg(&self, title: &str) -> String {
        let plain = SvgBackend::default().render_scene(&self.scene);
        let opening = r#"<svg xmlns="http://www.w3.org/2000/svg""#;
        let scaled = format!(
            r#"{opening} viewBox="0 0 {} {}" role="img" aria-label="{}""#,
            self.scene.width,
            self.scene.height,
            escape(title)
        );
        plain.replacen(opening, &scaled, 1) + "\n"
    }

    /// The drawing as a PNG file with two picture elements a pixel.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.picture()?.png()
    }

    /// The drawing as pixels, two a pixel of its own each way.
    pub fn picture(&self) -> Result<Picture> {
        self.to_raster().picture()
    }

    /// The same, to be made elsewhere.
    pub(super) fn to_raster(&self) -> ToRaster {
        ToRaster::new(&self.scene)
    }
}

/// Text with the letters escaped that mean something in HTML and SVG.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            control if control.is_control() && !matches!(control, '\n' | '\t') => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

/// kuva reads `$…$` as mathematics; an object's name is never that.
fn literal(text: &str) -> String {
    visible(text).replace('$', "\\$")
}

/// The text with spaces for control characters: XML forbids most of them, and none has a picture.
fn visible(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// A quarter of a pixel is finer than the eye, and keeps the numbers in SVG files short.
fn snap(position: f64) -> f64 {
    (position * 4.0).round() / 4.0
}

fn colour([r, g, b]: Rgb) -> Color {
    Color::Rgb(r, g, b)
}

fn anchor(align: Align) -> TextAnchor {
    match align {
        Align::Start => TextAnchor::Start,
        Align::Middle => TextAnchor::Middle,
        Align::End => TextAnchor::End,
    }
}

/// Corners of a regular polygon: square, triangle up, diamond, triangle down, pentagon, hexagon; then a star of four points.
fn marker_outline(line: usize, (x, y): Point, radius: f64) -> Vec<Point> {
    let (corners, turn, scale) = match line % N_MARKERS {
        1 => (4, 45.0, 1.25),
        2 => (3, -90.0, 1.4),
        3 => (4, 0.0, 1.3),
        4 => (3, 90.0, 1.4),
        5 => (5, -90.0, 1.2),
        6 => (6, 0.0, 1.2),
        _ => (8, 0.0, 1.7),
    };
    let is_star = corners == 8;
    (0..corners)
        .map(|corner| {
            let angle = (turn + 360.0 * f64::from(corner) / f64::from(corners)).to_radians();
            let inwards = if is_star && corner % 2 == 1 {
                0.45
            } else {
                1.0
            };
            (
                x + scale * inwards * radius * angle.cos(),
                y + scale * inwards * radius * angle.sin(),
            )
        })
        .collect()
}
