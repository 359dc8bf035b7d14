//! The report: one page that opens without a network and reads well on a phone. It shows nothing that is not in the table,
//! and says of each figure where ([`super::check`]).

use super::cell::Cell;
use super::columns::{self, significant};
use super::plot::{Drawing, Ink, chart, svg};
use super::store::{Folder, Results};
use super::{html_pictures as pictures, pick};
use svg::escape;

/// Digits of a count: all.
const WHOLE: i32 = 0;
/// Bytes in what memory is shown in.
const MIB: f64 = 1_048_576.;

/// A page of results; its pictures are those in the folder.
pub fn page(results: &Results, folder: &Folder) -> String {
    let page = Page { results, rows: columns::rows(results), folder };
    let scenes = scenes(results);
    let links: String =
        scenes.iter().map(|s| format!("<a href=\"#s{}\">{}</a>\n", s[0], escape(&page.title(s)))).collect();
    let sections: String = scenes.iter().map(|s| page.section(s)).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>pdss: error against run time</title>\n\
         <style>{}{}</style></head>\n<body>\n{}<nav>{links}</nav>\n{}{sections}{}</body></html>\n",
        svg::colours(":root"),
        include_str!("report.css"),
        page.head(),
        page.summary(&scenes),
        page.foot(),
    )
}

/// The plots of each scene with their names: error against time, or what a sweep shows.
pub fn plots(results: &Results) -> Vec<(String, Drawing)> {
    let mut plots = Vec::new();
    for scene in scenes(results) {
        let first = &results.cells[scene[0]];
        let plain: String =
            first.scene.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '-' }).collect();
        match &first.sweep {
            Some(axis) => {
                let names = ["time", "error"].map(|what| format!("plot-{plain}-{axis}-{what}"));
                plots.extend(names.into_iter().zip(super::sweep::charts(results, &scene)));
            }
            None => plots.push((format!("plot-{plain}"), time_error(results, &scene))),
        }
    }
    plots
}

/// The plots alone.
pub fn drawings(plots: &[(String, Drawing)]) -> Vec<Drawing> {
    plots.iter().map(|(_, drawing)| drawing.clone()).collect()
}

fn time_error(results: &Results, scene: &[usize]) -> Drawing {
    let method = |row: usize| results.cells[row].method.clone();
    chart::draw(results, &results.cells[scene[0]].scene, scene, chart::TIME_ERROR, |row| (method(row), method(row)))
}

/// The rows of each scene, in order; a sweep's scenes are one.
fn scenes(results: &Results) -> Vec<Vec<usize>> {
    let mut scenes: Vec<Vec<usize>> = Vec::new();
    for (row, cell) in results.cells.iter().enumerate() {
        let same = |s: &&mut Vec<usize>| {
            let first = &results.cells[s[0]];
            (&first.scene, &first.sweep) == (&cell.scene, &cell.sweep)
        };
        match scenes.iter_mut().find(same) {
            Some(scene) => scene.push(row),
            None => scenes.push(vec![row]),
        }
    }
    scenes
}

struct Page<'a> {
    results: &'a Results,
    rows: Vec<Vec<String>>,
    folder: &'a Folder,
}

impl Page<'_> {
    fn cell(&self, row: usize) -> &Cell {
        &self.results.cells[row]
    }

    fn text(&self, row: usize, column: &str) -> &str {
        let at = columns::position(column);
        at.and_then(|at| self.rows.get(row)?.get(at)).map_or("", String::as_str)
    }

    /// A figure of the table, divided by a unit, to some digits; a dash where there is none.
    fn figure(&self, row: usize, column: &str, digits: i32, unit: Option<f64>) -> String {
        let value = self.text(row, column).parse::<f64>();
        let Ok(value) = value else { return "–".to_owned() };
        // A count has no digits to spare.
        let count = unit.is_none() && digits == WHOLE;
        let shown =
            if count { self.text(row, column).to_owned() } else { significant(value / unit.unwrap_or(1.), digits) };
        let unit = unit.map_or(String::new(), |u| format!(" data-k=\"{u}\""));
        format!("<data data-r=\"{row}\" data-c=\"{column}\"{unit} value=\"{value}\">{shown}</data>")
    }

    fn title(&self, scene: &[usize]) -> String {
        let cell = self.cell(scene[0]);
        cell.sweep.as_ref().map_or(cell.scene.clone(), |axis| format!("{}, {axis} swept", cell.scene))
    }

    fn head(&self) -> String {
        let c = &self.results.context;
        let whole = |column: &str| self.figure(0, column, WHOLE, None);
        let watched = if c.validation { " The validation layers were on: these times are of them, too." } else { "" };
        format!(
            "<h1>Error against run time</h1>\n<p>Each way to light what light travels through, at each of its qualities: how long a \
             frame takes, and how far it is from a converged answer.{watched}</p>\n\
             <p class=\"small\">{} ({}); {}; {}; profile {}. Timed at {} by {}, errors at {} by {}; {} rounds of {} frames in \
             turns, {} clock.</p>\n",
            escape(&c.device),
            escape(&c.driver),
            escape(&c.host),
            escape(&c.code),
            escape(&c.profile),
            whole("width"),
            whole("height"),
            whole("error_width"),
            whole("error_height"),
            whole("rounds"),
            whole("frames_per_round"),
            c.clock,
        )
    }

    /// One line a scene: the floor, the rightest, and ours against the best rival.
    fn summary(&self, scenes: &[Vec<usize>]) -> String {
        let mut out = String::from(
            "<h2>In short</h2>\n<p>Nothing scatters in <i>lambert</i>: its error is what there is to gain. Ratios below one are ours: of \
             the time spent on scattering against the first screen-space rival that is as right, and of the error against the \
             rightest rival that spends no more.</p>\n<div class=\"wide\"><table><tr><th>scene</th><th>lambert</th>\
             <th class=\"left\">least error</th><th>error</th><th>ms</th><th class=\"left\">ours, rightest</th><th>error</th>\
             <th>time / rival</th><th>error / rival</th></tr>\n",
        );
        for scene in scenes.iter().filter(|s| self.cell(s[0]).sweep.is_none()) {
            let least = |keep: &dyn Fn(&Cell) -> bool| {
                let known =
                    scene.iter().filter(|r| keep(self.cell(**r))).filter_map(|r| Some((*r, self.cell(*r).point()?.1)));
                known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
            };
            let floor = least(&|c| c.method == "lambert");
            let best = least(&|_| true);
            let ours = least(&|c| super::front::OURS.contains(&c.method.as_str()));
            let named = |row: Option<usize>| row.map_or("–".to_owned(), |r| self.named(r));
            let figure =
                |row: Option<usize>, column: &str| row.map_or("–".to_owned(), |r| self.figure(r, column, 3, None));
            out += &format!(
                "<tr><td>{}</td><td>{}</td><td class=\"left\">{}</td><td>{}</td><td>{}</td><td class=\"left\">{}</td><td>{}</td>\
                 <td>{}</td><td>{}</td></tr>\n",
                escape(&self.title(scene)),
                figure(floor, "rmse"),
                named(best),
                figure(best, "rmse"),
                figure(best, "frame_ms"),
                named(ours),
                figure(ours, "rmse"),
                figure(ours, "time_over_rival"),
                figure(ours, "error_over_rival"),
            );
        }
        out + "</table></div>\n"
    }

    /// A method's dot, its name, its quality.
    fn named(&self, row: usize) -> String {
        let cell = self.cell(row);
        let dot = match Ink::of(&cell.method) {
            Ink::Method(i) => format!("<span class=\"key\" style=\"background:var(--m{i})\"></span>"),
            _ => String::new(),
        };
        format!("{dot}{} {}", cell.method, cell.quality)
    }

    fn section(&self, scene: &[usize]) -> String {
        let first = self.cell(scene[0]);
        let about = format!(
            "<h2 id=\"s{}\">{}</h2>\n<p>{}; {} triangles, {} lights; truth is known to {}.</p>\n",
            scene[0],
            escape(&self.title(scene)),
            escape(&first.why),
            self.figure(scene[0], "triangles", WHOLE, None),
            self.figure(scene[0], "lights", WHOLE, None),
            self.figure(scene[0], "truth_rms", 2, None),
        );
        let body = if first.sweep.is_some() {
            let charts: String = super::sweep::charts(self.results, scene).iter().map(svg::inline).collect();
            format!(
                "<div class=\"pair\">{charts}</div>\n<details><summary>all figures</summary>{}</details>\n",
                self.table(scene)
            )
        } else {
            let drawing = time_error(self.results, scene);
            format!(
                "<div class=\"chart\">{}</div>\n{}{}",
                svg::inline(&drawing),
                self.table(scene),
                self.pictures(scene)
            )
        };
        about + &body
    }

    fn table(&self, scene: &[usize]) -> String {
        let swept = self.cell(scene[0]).sweep.clone();
        let head = swept.as_ref().map_or(String::new(), |axis| format!("<th>{axis}</th>"));
        let mut out = format!(
            "<div class=\"wide\"><table><tr><th>method</th>{head}<th>ms</th><th>scattering</th><th>rms</th><th>FLIP</th>\
             <th>silhouette</th><th>terminator</th><th>shadow edge</th><th>concave</th><th>MiB</th></tr>\n"
        );
        let mut refused = String::new();
        for &row in scene {
            if let Some(why) = &self.cell(row).refused {
                refused += &format!("<p class=\"small\">{}: {}</p>\n", self.named(row), escape(why));
                continue;
            }
            let class = if self.results.standing[row].front { " class=\"front\"" } else { "" };
            out += &format!("<tr{class}><td>{}</td>", self.named(row));
            if swept.is_some() {
                out += &format!("<td>{}</td>", self.figure(row, "sweep_value", 3, None));
            }
            for column in [
                "frame_ms",
                "scatter_ms",
                "rmse",
                "flip",
                "rmse_silhouette",
                "rmse_terminator",
                "rmse_shadow_edge",
                "rmse_concave",
            ] {
                out += &format!("<td>{}</td>", self.figure(row, column, 3, None));
            }
            out += &format!("<td>{}</td></tr>\n", self.figure(row, "memory_bytes", 3, Some(MIB)));
        }
        out + "</table>" + &refused + "</div>\n"
    }

    /// Windows at equal time and at equal error, and the maps of whole pictures.
    fn pictures(&self, scene: &[usize]) -> String {
        let Some(own) = pick::reference(self.results, scene) else { return String::new() };
        let [whole, window] = pictures::truth(self.folder, self.cell(own));
        let truth = |picture: &str| format!("<figure>{picture}<figcaption>truth</figcaption></figure>\n");
        let caption = |row: usize, more: &str| {
            let (ms, rms) = (self.figure(row, "frame_ms", 3, None), self.figure(row, "rmse", 3, None));
            format!("<figcaption>{}<br>{ms} ms, rms {rms}{more}</figcaption>", self.named(row))
        };
        let strip = |rows: Vec<(usize, bool)>, miss: &str| -> String {
            let figure = |(row, hit): (usize, bool)| {
                let more = if hit { String::new() } else { format!("; {miss}") };
                format!("<figure>{}{}</figure>\n", pictures::windows(self.folder, self.cell(row)), caption(row, &more))
            };
            format!(
                "<div class=\"strip\">{}{}</div>\n",
                truth(&window),
                rows.into_iter().map(figure).collect::<String>()
            )
        };
        let maps: String = pick::qualities_alike(self.results, scene, own)
            .into_iter()
            .map(|row| format!("<figure>{}{}</figure>\n", pictures::map(self.folder, self.cell(row)), caption(row, "")))
            .collect();
        format!(
            "<h3>At equal time</h3>\n<p>What each method shows within the time of {}, and its errors, white at {}.</p>\n{}\
             <details><summary>At equal error</summary>\n<p>The fastest setting of each method that is as right.</p>\n{}</details>\n\
             <details><summary>Where the errors are</summary>\n<div class=\"strip\">{}{maps}</div></details>\n",
            self.named(own),
            self.figure(own, "map_white", 3, None),
            strip(pick::at_equal_time(self.results, scene, own), "it has nothing as fast"),
            strip(pick::at_equal_error(self.results, scene, own), "it has nothing as right"),
            truth(&whole),
        )
    }

    fn foot(&self) -> String {
        "<h2>How to read this</h2>\n<p><b>ms</b>: median of a whole frame, from before its submit to after its fence on the wall \
         clock, or first stamp to last on the device's. Cells of a scene took turns, so that a slow minute is everybody's. \
         <b>scattering</b>: the frame less lambert's of the same quality in the same round. <b>rms</b>: root mean square over pixels and \
         channels of diffuse exitance, full light being about one, against a surface integral in double precision; then the same inside \
         bands. Below what truth is known to, an error is no result. <b>FLIP</b>: the tone-mapped pictures as the eye sees \
         them. <b>Bold, ringed</b>: on the Pareto front, nothing of the scene is both as fast and as right. Every figure of this page is \
         in results.csv, unrounded.</p>\n"
            .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::check::{Sheet, check};
    use crate::compare::front::tests::results;

    fn sample() -> Result<(String, Sheet), Box<dyn std::error::Error>> {
        let directory = tempfile::tempdir()?;
        let results = results();
        Ok((page(&results, &Folder::open(directory.path())?), Sheet::read(&columns::csv(&results))))
    }

    #[test]
    fn every_figure_of_the_page_is_in_the_table_and_a_changed_one_is_caught() -> Result<(), Box<dyn std::error::Error>>
    {
        let (page, sheet) = sample()?;
        let figures = check(&page, &sheet).map_err(|wrong| wrong.join("\n"))?;
        println!("{figures} figures");
        assert!(figures > 60, "{figures}");
        // The twins: another digit in a figure, in a point, and in the prose.
        for (from, to) in
            [(">0.0100</data>", ">0.0101</data>"), ("rmse:0.0080", "rmse:0.0081"), ("Nothing scatters", "42 scatter")]
        {
            assert!(page.contains(from), "{from}");
            assert!(check(&page.replacen(from, to, 1), &sheet).is_err(), "{to}");
        }
        Ok(())
    }

    #[test]
    fn the_page_needs_nothing_else_and_says_what_was_refused() -> Result<(), Box<dyn std::error::Error>> {
        let (page, _) = sample()?;
        for outside in ["http:", "https:", "<script", "src=\"/", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(page.contains("name=\"viewport\"") && page.contains("prefers-color-scheme:dark"));
        assert!(page.contains("no coordinates") && page.contains("driver 1, &lt;new&gt;"));
        Ok(())
    }
}
