//! A drawing as SVG: inside a page, whose colours it takes, or alone.

use super::{Anchor, Drawing, Ink, METHODS, Mark};
use std::fmt::Write as _;

/// Text that stands for itself in markup.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Colours by day and by night, as CSS variables of everything inside `root`.
pub fn colours(root: &str) -> String {
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    let methods: String = METHODS.iter().enumerate().map(|(i, (_, rgb))| format!("--m{i}:{};", hex(*rgb))).collect();
    let ink = |ink: Ink| hex(ink.rgb());
    format!(
        "{root}{{--paper:#fff;--text:{};--grid:{};--front:{};{methods}}}\n\
         @media(prefers-color-scheme:dark){{{root}{{--paper:#16181b;--text:#e4e4e4;--grid:#33373c;--front:#5a6068;}}}}\n",
        ink(Ink::Text),
        ink(Ink::Grid),
        ink(Ink::Front)
    )
}

fn variable(ink: Ink) -> String {
    match ink {
        Ink::Text => "var(--text)".to_owned(),
        Ink::Grid => "var(--grid)".to_owned(),
        Ink::Front => "var(--front)".to_owned(),
        Ink::Method(i) => format!("var(--m{i})"),
    }
}

/// As an element of a page that has [`colours`].
pub fn inline(drawing: &Drawing) -> String {
    let [w, h] = drawing.size;
    format!("<svg viewBox=\"0 0 {w} {h}\" role=\"img\">\n{}</svg>\n", body(drawing))
}

/// As a file of its own.
pub fn alone(drawing: &Drawing) -> String {
    let [w, h] = drawing.size;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\">\n\
         <style>{}text{{font-family:system-ui,sans-serif;fill:var(--text)}}</style>\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"var(--paper)\"/>\n{}</svg>\n",
        colours("svg"),
        body(drawing)
    )
}

fn body(drawing: &Drawing) -> String {
    let mut out = String::new();
    for mark in &drawing.marks {
        // Writing to a string does not fail.
        let _ = match mark {
            Mark::Line { points, ink, width } => {
                let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
                writeln!(
                    out,
                    "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>",
                    points.join(" "),
                    variable(*ink)
                )
            }
            Mark::Dot { at: [x, y], radius, ink, ringed, row, x: across, y: up, title } => {
                let ring = if *ringed { "var(--text)" } else { "var(--paper)" };
                writeln!(
                    out,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{}\" stroke=\"{ring}\" stroke-width=\"1.5\" \
                     data-r=\"{row}\" data-x=\"{}:{}\" data-y=\"{}:{}\"><title>{}</title></circle>",
                    variable(*ink),
                    across.0,
                    across.1,
                    up.0,
                    up.1,
                    escape(title)
                )
            }
            Mark::Words { at: [x, y], text, size, anchor, tick, upright } => {
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let class = if *tick { " class=\"tick\"" } else { "" };
                let turn = if *upright { format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"") } else { String::new() };
                writeln!(
                    out,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{class}{turn}>{}</text>",
                    escape(text)
                )
            }
        };
    }
    out
}
