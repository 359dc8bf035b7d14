//! Log-log charts: what is drawn, as a list of marks that [`svg`] writes and [`raster`] paints.

pub mod chart;
pub mod raster;
pub mod svg;

/// What a mark is drawn with; a page decides what that looks like by day and by night.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Words and frames.
    Text,
    /// Lines that help to read.
    Grid,
    /// The Pareto front.
    Front,
    /// A method's own colour, by its place in [`METHODS`].
    Method(usize),
}

/// The colour of each method: told apart by people who see colours otherwise, too, on light and on dark.
pub const METHODS: [(&str, [u8; 3]); 9] = [
    ("lambert", [128, 128, 128]),
    ("wrap", [150, 128, 84]),
    ("preintegrated", [86, 180, 233]),
    ("texture-space", [204, 153, 0]),
    ("gaussians", [0, 158, 115]),
    ("separable", [204, 121, 167]),
    ("burley", [150, 90, 200]),
    ("pdss", [0, 114, 200]),
    ("moments", [222, 94, 0]),
];

impl Ink {
    /// A method's ink; text's for a method without one.
    pub fn of(method: &str) -> Ink {
        METHODS.iter().position(|m| m.0 == method).map_or(Ink::Text, Ink::Method)
    }

    /// By day.
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Ink::Text => [34, 34, 34],
            Ink::Grid => [216, 216, 216],
            Ink::Front => [170, 170, 170],
            Ink::Method(i) => METHODS.get(i).map_or([34; 3], |m| m.1),
        }
    }
}

/// Where a text is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
    /// At its end.
    End,
}

/// One thing that is drawn; x to the right, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line through points.
    Line {
        /// Points.
        points: Vec<[f64; 2]>,
        /// Colour.
        ink: Ink,
        /// Width.
        width: f64,
    },
    /// A measured point.
    Dot {
        /// Where.
        at: [f64; 2],
        /// Radius.
        radius: f64,
        /// Colour.
        ink: Ink,
        /// A ring around it: on the front.
        ringed: bool,
        /// Row of the table, and column and text of both coordinates there.
        row: usize,
        /// Column and text of x.
        x: (&'static str, String),
        /// Column and text of y.
        y: (&'static str, String),
        /// What it is, for people who point at it.
        title: String,
    },
    /// Words.
    Words {
        /// Baseline at the anchor.
        at: [f64; 2],
        /// They.
        text: String,
        /// Height of a line.
        size: f64,
        /// Where they are held.
        anchor: Anchor,
        /// The scale's, not a result.
        tick: bool,
        /// Turned to read upwards.
        upright: bool,
    },
}

/// A finished drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Width and height.
    pub size: [f64; 2],
    /// In order, later ones on top.
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// Several in a grid of so many columns.
    pub fn grid(all: &[Drawing], columns: usize) -> Drawing {
        let cell = all.iter().fold([0f64; 2], |m, d| [m[0].max(d.size[0]), m[1].max(d.size[1])]);
        let columns = columns.clamp(1, all.len().max(1));
        let mut grid = Drawing {
            size: [cell[0] * columns as f64, cell[1] * all.len().div_ceil(columns) as f64],
            marks: Vec::new(),
        };
        for (i, drawing) in all.iter().enumerate() {
            let by = [cell[0] * (i % columns) as f64, cell[1] * (i / columns) as f64];
            grid.marks.extend(drawing.marks.iter().cloned().map(|m| m.moved(by)));
        }
        grid
    }
}

impl Mark {
    fn moved(mut self, by: [f64; 2]) -> Mark {
        let shift = |p: &mut [f64; 2]| *p = [p[0] + by[0], p[1] + by[1]];
        match &mut self {
            Mark::Line { points, .. } => points.iter_mut().for_each(shift),
            Mark::Dot { at, .. } | Mark::Words { at, .. } => shift(at),
        }
        self
    }
}
