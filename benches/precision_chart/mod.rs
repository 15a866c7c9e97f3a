//! Chart of single against double precision: error above, speed-up below, by the radius of the spheres.

use super::Row;
use bubbletouch::report::colours::{GRID, INK, LINES};
use bubbletouch::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};

const WIDTH: f64 = 760.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 18.0;
/// Largest allowed error, metres.
const ALLOWED: f64 = 1e-8;

/// Panel of the chart: a quantity against the radius, on a logarithmic or linear scale.
struct Panel {
    area: Area,
    /// Ends of the y axis; logarithms on a logarithmic scale.
    y: (f64, f64),
    is_log: bool,
}

impl Panel {
    fn x(&self, radius: f64) -> f64 {
        let (low, high) = (-3.0, 1.0);
        self.area.x + self.area.width * (radius.log10() - low) / (high - low)
    }

    fn y(&self, value: f64) -> f64 {
        let value = if self.is_log { value.log10() } else { value };
        let share = (value - self.y.0) / (self.y.1 - self.y.0);
        self.area.y + self.area.height * (1.0 - share.clamp(0.0, 1.0))
    }

    fn draw(&self, drawing: &mut Drawing, title: &str, ticks: &[(f64, String)]) {
        let (left, right) = (self.area.x, self.area.x + self.area.width);
        let (top, bottom) = (self.area.y, self.area.y + self.area.height);
        for (value, text) in ticks {
            let y = self.y(*value);
            drawing.line((left, y), (right, y), Stroke::new(GRID, 1.0));
            let style = TextStyle::new(12).align(Align::End);
            drawing.text((left - 8.0, y + 4.0), text, style);
        }
        for power in -3..=1 {
            let x = self.x(10f64.powi(power));
            drawing.line((x, top), (x, bottom), Stroke::new(GRID, 1.0));
            let text = ["1 mm", "1 cm", "10 cm", "1 m", "10 m"][(power + 3) as usize];
            let style = TextStyle::new(12).align(Align::Middle);
            drawing.text((x, bottom + 18.0), text, style);
        }
        drawing.frame(self.area, Stroke::new(INK, 1.0));
        let style = TextStyle::new(13).align(Align::Middle).angle(-90.0);
        drawing.text((16.0, 0.5 * (top + bottom)), title, style);
    }

    fn lines(&self, drawing: &mut Drawing, rows: &[Row], value: fn(&Row) -> f64) {
        for (line, (n, depth, _)) in SERIES.into_iter().enumerate() {
            let of = rows.iter().filter(|row| (row.n, row.depth) == (n, depth));
            let places: Vec<(f64, f64)> = of
                .map(|row| (self.x(row.radius_m), self.y(value(row))))
                .collect();
            if places.len() > 1 {
                drawing.polyline(&places, Stroke::new(LINES[line], 2.0));
            }
            for place in places {
                drawing.marker(line, place, 4.5, LINES[line]);
            }
        }
    }
}

/// Number of taxels along a side, depth, and display names of both.
const SERIES: [(usize, &str, &str); 4] = [
    (64, "light", "64 × 64 taxels, up to 3 mm deep"),
    (64, "middle", "64 × 64 taxels, to the middle of the spheres"),
    (512, "light", "512 × 512 taxels, up to 3 mm deep"),
    (
        512,
        "middle",
        "512 × 512 taxels, to the middle of the spheres",
    ),
];

pub fn draw(rows: &[Row]) -> Drawing {
    let mut drawing = Drawing::new(WIDTH, 700.0);
    let title = "A press in singles (f32) beside one in doubles (f64), on one core";
    drawing.bold_text((LEFT, 26.0), title, TextStyle::new(16));
    for (line, (.., name)) in SERIES.into_iter().enumerate() {
        let at = (
            LEFT + 340.0 * (line % 2) as f64,
            50.0 + 20.0 * (line / 2) as f64,
        );
        drawing.marker(line, (at.0 + 6.0, at.1 - 4.0), 4.5, LINES[line]);
        drawing.text((at.0 + 20.0, at.1), name, TextStyle::new(12));
    }
    let panel = |y, height, ends, is_log| Panel {
        area: Area {
            x: LEFT,
            y,
            width: WIDTH - LEFT - RIGHT,
            height,
        },
        y: ends,
        is_log,
    };
    let errors = panel(88.0, 300.0, (-11.0, -2.0), true);
    let powers = (-11..=-2).map(|power| (10f64.powi(power), power_of_ten(power)));
    errors.draw(
        &mut drawing,
        "largest error, m",
        &powers.collect::<Vec<_>>(),
    );
    let (left, right) = (errors.area.x, errors.area.x + errors.area.width);
    let allowed = errors.y(ALLOWED);
    drawing.line((left, allowed), (right, allowed), Stroke::new(INK, 1.5));
    let style = TextStyle::new(12).align(Align::End);
    drawing.text((right - 6.0, allowed - 5.0), "allowed", style);
    errors.lines(&mut drawing, rows, |row| row.error_max_m);
    let gains = panel(424.0, 210.0, (0.0, 4.0), false);
    let ticks: Vec<_> = (0..=4)
        .map(|gain| (f64::from(gain), format!("{gain} ×")))
        .collect();
    gains.draw(&mut drawing, "time in doubles over singles", &ticks);
    gains.lines(&mut drawing, rows, |row| row.gain);
    let middle = 0.5 * (left + right);
    let style = TextStyle::new(13).align(Align::Middle);
    drawing.text((middle, 680.0), "radius of the spheres", style);
    drawing
}

fn power_of_ten(power: i32) -> String {
    let digits: String = power
        .abs()
        .to_string()
        .chars()
        .map(|digit| {
            ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize - '0' as usize]
        })
        .collect();
    format!("10⁻{digits}")
}
