//! Whether a report says only what its table says. Every figure of the page names its row and column; every other number on
//! it has to be a word of the table's.

use super::columns::significant;
use std::collections::{BTreeMap, HashSet};

/// A table, read back.
pub struct Sheet {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    words: HashSet<String>,
}

impl Sheet {
    /// Reads RFC 4180.
    pub fn read(csv: &str) -> Sheet {
        let mut rows: Vec<Vec<String>> = vec![vec![String::new()]];
        let mut quoted = false;
        for c in csv.chars() {
            let row = rows.len() - 1;
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => rows[row].push(String::new()),
                '\n' if !quoted => rows.push(vec![String::new()]),
                '\r' if !quoted => {}
                c => rows[row].last_mut().map_or((), |cell| cell.push(c)),
            }
        }
        rows.retain(|r| r.iter().any(|c| !c.is_empty()));
        let header = if rows.is_empty() { Vec::new() } else { rows.remove(0) };
        let texts = rows.iter().flatten().filter(|t| t.parse::<f64>().is_err());
        let words = texts.flat_map(|t| numbers(t)).collect();
        Sheet { header, rows, words }
    }

    fn cell(&self, row: &str, column: &str) -> Option<&str> {
        let column = self.header.iter().position(|h| h == column)?;
        self.rows.get(row.parse::<usize>().ok()?)?.get(column).map(String::as_str)
    }
}

/// Holds a page to a table: how many figures were found there, or what was not.
///
/// # Errors
/// One line for each number of the page that the table does not have.
pub fn check(html: &str, sheet: &Sheet) -> Result<usize, Vec<String>> {
    let (mut figures, mut wrong) = (0, Vec::new());
    // Elements that are open: name, attributes.
    let mut open: Vec<(String, BTreeMap<String, String>)> = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        text(&rest[..start], &open, sheet, &mut figures, &mut wrong);
        rest = &rest[start + 1..];
        let Some(end) = rest.find('>') else { break };
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            while open.pop().is_some_and(|(n, _)| n != name.trim()) {}
        } else if !tag.starts_with('!') {
            let name = tag.split([' ', '\n', '/']).next().unwrap_or_default().to_owned();
            let attributes = attributes(tag);
            dot(&attributes, sheet, &mut figures, &mut wrong);
            if name == "style" {
                // Its text has no mark-up.
                rest = rest.find("</style>").map_or("", |i| &rest[i + 8..]);
            } else if !(tag.ends_with('/') || ["meta", "img", "br", "link", "hr"].contains(&name.as_str())) {
                open.push((name, attributes));
            }
        }
    }
    if wrong.is_empty() { Ok(figures) } else { Err(wrong) }
}

/// Holds a run of text to the table.
fn text(
    text: &str,
    open: &[(String, BTreeMap<String, String>)],
    sheet: &Sheet,
    figures: &mut usize,
    wrong: &mut Vec<String>,
) {
    let class = |c: &str| open.iter().any(|(_, a)| a.get("class").is_some_and(|x| x == c));
    if text.trim().is_empty() || class("tick") {
        return;
    }
    if let Some((_, a)) = open.last().filter(|(name, _)| name == "data") {
        *figures += 1;
        let attribute = |name: &str| a.get(name).map_or("", String::as_str);
        let there = sheet.cell(attribute("data-r"), attribute("data-c"));
        if !there.is_some_and(|value| shows(text.trim(), attribute("data-k"), value)) {
            wrong.push(format!(
                "{text:?} for {} of row {}, which is {there:?}",
                attribute("data-c"),
                attribute("data-r")
            ));
        }
        return;
    }
    for number in numbers(text) {
        if !sheet.words.contains(&number) {
            wrong.push(format!("{number:?} in {:?}", text.trim()));
        }
    }
}

/// Holds a point of a plot to the table.
fn dot(a: &BTreeMap<String, String>, sheet: &Sheet, figures: &mut usize, wrong: &mut Vec<String>) {
    for axis in ["data-x", "data-y"] {
        let Some((row, (column, text))) = a.get("data-r").zip(a.get(axis).and_then(|x| x.split_once(':'))) else {
            continue;
        };
        *figures += 1;
        if sheet.cell(row, column) != Some(text) {
            wrong.push(format!("a point at {column} {text} of row {row}"));
        }
    }
}

/// Whether a shown number is the table's value, divided by a unit where there is one, to the digits shown.
fn shows(shown: &str, unit: &str, value: &str) -> bool {
    if unit.is_empty() && shown == value {
        return true;
    }
    let unit = if unit.is_empty() { Some(1.) } else { unit.parse::<f64>().ok() };
    let (Some(unit), Ok(value), Ok(_)) = (unit, value.parse::<f64>(), shown.parse::<f64>()) else { return false };
    // A rounding of it: at some number of digits it reads the same.
    (1..=9).any(|digits| significant(value / unit, digits) == shown)
}

/// The numbers in a text, as they are written.
fn numbers(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut number = String::new();
    for c in text.chars().chain([' ']) {
        if c.is_ascii_digit() || (c == '.' && !number.is_empty()) {
            number.push(c);
        } else if !number.is_empty() {
            found.push(std::mem::take(&mut number).trim_end_matches('.').to_owned());
        }
    }
    found
}

fn attributes(tag: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut rest = tag;
    while let Some((before, after)) = rest.split_once("=\"") {
        let Some((value, next)) = after.split_once('"') else { break };
        let name = before.rsplit([' ', '\n']).next().unwrap_or_default();
        found.insert(name.to_owned(), value.to_owned());
        rest = next;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const CSV: &str = "scene,device,rmse,bytes\n\"a, 2\",\"card 4090, 256 bits\",0.0109876,3145728\nb,,0.25,1048576\n";

    fn judge(html: &str) -> Result<usize, Vec<String>> {
        check(html, &Sheet::read(CSV))
    }

    #[test]
    fn figures_are_found_rounded_or_in_units() {
        let page = "<!doctype html><style>p{margin:7px}</style><p>On card 4090 and 256.</p>\
            <data data-r=\"0\" data-c=\"rmse\">0.0110</data> <data data-r=\"1\" data-c=\"rmse\">0.25</data>\
            <data data-r=\"0\" data-c=\"bytes\" data-k=\"1048576\">3</data>\
            <svg><text class=\"tick\">99</text><circle data-r=\"0\" data-x=\"rmse:0.0109876\" data-y=\"bytes:3145728\"/></svg>";
        assert_eq!(judge(page), Ok(5));
    }

    #[test]
    fn what_the_table_does_not_say_is_caught() {
        for page in [
            "<p>31 % faster</p>",
            "<data data-r=\"0\" data-c=\"rmse\">0.0111</data>",
            "<data data-r=\"1\" data-c=\"rmse\">0.0110</data>",
            "<data data-r=\"0\" data-c=\"speed\">0.0110</data>",
            "<data data-r=\"9\" data-c=\"rmse\">0.0110</data>",
            "<data data-r=\"0\" data-c=\"bytes\" data-k=\"1024\">3</data>",
            "<data data-r=\"0\" data-c=\"rmse\">good</data>",
            "<svg><circle data-r=\"0\" data-x=\"rmse:0.0109\" data-y=\"bytes:3145728\"/></svg>",
            "<svg><text class=\"tick\">9</text><text>9</text></svg>",
        ] {
            assert!(judge(page).is_err(), "{page}");
        }
    }
}
