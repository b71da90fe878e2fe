//! Layout: panels in a grid, legends above them, margins for numbers and labels.

use super::axis::{Axis, x_extent, y_extent};
use super::label::{shorten, width, wrap};
use super::{Colour, Dash, Figure, Panel, Series};

pub(super) const TITLE_PX: f64 = 16.0;
pub(super) const SUBTITLE_PX: f64 = 12.5;
pub(super) const PANEL_TITLE_PX: f64 = 13.0;
pub(super) const LABEL_PX: f64 = 12.5;
pub(super) const TICK_PX: f64 = 12.0;
pub(super) const LEGEND_PX: f64 = 12.0;
/// Margin around the figure, px.
pub(super) const MARGIN: f64 = 10.0;
/// Gap between neighbouring panels, px.
const GUTTER: f64 = 22.0;
const STACK_GAP: f64 = 10.0;
/// Width of a legend sample, and gap after an entry, px.
pub(super) const SAMPLE: f64 = 20.0;
const ENTRY_GAP: f64 = 16.0;

/// Width of a figure for narrow windows, px: at most the content of a page in a window of 390 px.
const NARROW_PX: f64 = 340.0;

/// Rectangle in px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) w: f64,
    pub(super) h: f64,
}

impl Rect {
    pub(super) fn overlaps(&self, other: &Rect) -> bool {
        self.x < other.x + other.w
            && other.x < self.x + self.w
            && self.y < other.y + other.h
            && other.y < self.y + self.h
    }

    pub(super) fn contains(&self, other: &Rect) -> bool {
        other.x >= self.x
            && other.y >= self.y
            && other.x + other.w <= self.x + self.w
            && other.y + other.h <= self.y + self.h
    }
}

/// Legend entry with its sample.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) colour: Colour,
    pub(super) sample: Sample,
    /// Index of the series in the panel.
    pub(super) series: usize,
    /// Left end of the sample and baseline of the text, px.
    pub(super) x: f64,
    pub(super) y: f64,
}

pub(super) enum Sample {
    Line(Dash, f64),
    Band,
    Points(f64),
}

/// Panel with its position.
pub(super) struct Placed<'a> {
    pub(super) panel: &'a Panel,
    /// Rectangle of the plot area, px.
    pub(super) plot: Rect,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) right: Option<Axis>,
    pub(super) title: Option<(f64, f64)>,
    pub(super) legend: Vec<Entry>,
    /// Left edge of the column of the rotated label, px.
    pub(super) label_x: f64,
    pub(super) right_label_x: f64,
}

/// Layout of the whole figure.
pub(super) struct Layout<'a> {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) title: Vec<String>,
    pub(super) subtitle: Vec<String>,
    pub(super) panels: Vec<Placed<'a>>,
}

struct Column {
    left: f64,
    right: f64,
}

/// Computes the layout of a figure; invalid sizes are replaced by the minimum size.
pub(super) fn arrange(figure: &Figure) -> Layout<'_> {
    let size = |v: f64, least: f64| {
        if v.is_finite() {
            v.clamp(least, 2e4)
        } else {
            least
        }
    };
    let (total_w, total_h) = (size(figure.width_px, 120.0), size(figure.height_px, 80.0));
    let room = total_w - 2.0 * MARGIN;
    let title = wrap(&figure.title, 1.06 * TITLE_PX, room);
    let subtitle = wrap(&figure.subtitle, SUBTITLE_PX, room);
    let mut top = MARGIN
        + title.len() as f64 * (TITLE_PX + 5.0)
        + subtitle.len() as f64 * (SUBTITLE_PX + 4.0);
    if !title.is_empty() || !subtitle.is_empty() {
        top += 6.0;
    }

    let columns = figure.columns.max(1).min(figure.panels.len().max(1));
    let rows: Vec<&[Panel]> = figure.panels.chunks(columns).collect();
    let cell_w = (room - GUTTER * (columns - 1) as f64) / columns as f64;

    // Fixed heights of every row: title and legend above, numbers and label below.
    let largest = |of: &dyn Fn(&Panel) -> f64| -> Vec<f64> {
        let rows = rows.iter();
        rows.map(|row| row.iter().map(of).fold(0.0, f64::max))
            .collect()
    };
    let heads = largest(&|p| head_height(p, cell_w));
    let feet = largest(&foot_height);
    let weights = largest(&weight);
    let fixed: f64 =
        heads.iter().chain(&feet).sum::<f64>() + STACK_GAP * rows.len().saturating_sub(1) as f64;
    let free = (total_h - top - MARGIN / 2.0 - fixed).max(24.0 * rows.len() as f64);
    let all = weights.iter().sum::<f64>();
    let heights: Vec<f64> = weights.iter().map(|w| free * w / all).collect();

    // Vertical axes come first, because their numbers determine the margins of a column.
    let mut axes = Vec::new();
    for (i, panel) in figure.panels.iter().enumerate() {
        let x = x_extent(panel);
        let y = y_extent(panel, x);
        let count = (heights[i / columns] / 27.0).clamp(3.0, 7.0) as usize;
        let left = Axis::new(y.0, y.1, count).named(&panel.y_names, |_, _| true);
        let right = panel
            .y_right
            .as_ref()
            .filter(|r| r.factor.is_finite() && r.factor != 0.0)
            .map(|r| {
                let mut axis = Axis::new(left.low * r.factor, left.high * r.factor, count);
                // Identical range as on the left, also with a negative factor.
                axis.low = left.low * r.factor;
                axis.high = left.high * r.factor;
                axis
            });
        axes.push((x, left, right));
    }
    let margins: Vec<Column> = (0..columns)
        .map(|c| {
            let of_column = || axes.iter().skip(c).step_by(columns);
            let mut labelled = figure.panels.iter().skip(c).step_by(columns);
            let labelled = labelled.any(|p| !p.y_label.is_empty());
            let left = of_column().map(|(_, y, _)| number_width(y));
            let right = of_column().filter_map(|(_, _, r)| Some(number_width(r.as_ref()?)));
            let (left, right) = (left.fold(0.0, f64::max), right.fold(0.0, f64::max));
            // Zooming shows more digits.
            let numbers = left.max(width("0.00", TICK_PX)) + 8.0;
            Column {
                left: numbers + if labelled { LABEL_PX + 7.0 } else { 0.0 },
                right: if right > 0.0 {
                    right + 8.0 + LABEL_PX + 7.0
                } else {
                    12.0
                },
            }
        })
        .collect();

    let mut panels = Vec::new();
    for (i, (x, y, right)) in axes.into_iter().enumerate() {
        let (row, column) = (i / columns, i % columns);
        let cell_x = MARGIN + (cell_w + GUTTER) * column as f64;
        let row_y = top
            + (0..row)
                .map(|r| heads[r] + heights[r] + feet[r] + STACK_GAP)
                .sum::<f64>();
        let margin = &margins[column];
        let plot = Rect {
            x: cell_x + margin.left,
            y: row_y + heads[row],
            w: (cell_w - margin.left - margin.right).max(24.0),
            h: heights[row],
        };
        let panel = &figure.panels[i];
        let (title, legend) = head(panel, cell_x, cell_w, plot.y);
        panels.push(Placed {
            panel,
            plot,
            x: x_axis(x, plot.w, &panel.x_names),
            y,
            right,
            title,
            legend,
            label_x: cell_x,
            right_label_x: cell_x + cell_w,
        });
    }
    Layout {
        width: total_w,
        height: total_h,
        title,
        subtitle,
        panels,
    }
}

/// Returns the figure for a narrow window: one panel per row, with the plot heights of the wide layout.
pub(super) fn narrow(figure: &Figure, wide: &Layout<'_>) -> Figure {
    let mut narrow = Figure {
        width_px: NARROW_PX,
        columns: 1,
        ..figure.clone()
    };
    // A panel without a label shared that of the panel below it, which is no longer its neighbour.
    let columns = figure.columns.max(1);
    for i in (columns..figure.panels.len()).rev().filter(|_| columns > 1) {
        if narrow.panels[i - columns].x_label.is_empty() {
            narrow.panels[i - columns].x_label = narrow.panels[i].x_label.clone();
        }
    }
    for (panel, placed) in narrow.panels.iter_mut().zip(&wide.panels) {
        panel.weight = placed.plot.h;
    }
    let plots = |layout: &Layout<'_>| layout.panels.iter().map(|p| p.plot.h).sum::<f64>();
    narrow.height_px += plots(wide) - plots(&arrange(&narrow));
    narrow
}

fn weight(panel: &Panel) -> f64 {
    if panel.weight.is_finite() && panel.weight > 0.0 {
        panel.weight
    } else {
        1.0
    }
}

fn number_width(axis: &Axis) -> f64 {
    let widths = axis.ticks.iter().map(|&t| width(&axis.number(t), TICK_PX));
    widths.fold(0.0, f64::max)
}

/// Returns the number of ticks with room for their labels.
fn x_axis(range: (f64, f64), plot_w: f64, names: &[(f64, String)]) -> Axis {
    if !names.is_empty() {
        let axis = Axis::new(range.0, range.1, 2);
        let px = plot_w / (axis.high - axis.low);
        return axis.named(names, |taken, name| {
            taken.iter().all(|other| {
                let words = 0.5 * (width(&other.1, TICK_PX) + width(&name.1, TICK_PX));
                px * (other.0 - name.0).abs() > words + 14.0
            })
        });
    }
    let mut count = (plot_w / 45.0).clamp(2.0, 10.0) as usize;
    loop {
        let axis = Axis::new(range.0, range.1, count);
        let room = plot_w / (axis.ticks.len().max(2) - 1) as f64;
        if number_width(&axis) + 12.0 < room || count <= 1 {
            return axis;
        }
        count -= 1;
    }
}

fn foot_height(panel: &Panel) -> f64 {
    if panel.x_label.is_empty() {
        6.0
    } else {
        TICK_PX + 8.0 + LABEL_PX + 7.0
    }
}

fn head_height(panel: &Panel, cell_w: f64) -> f64 {
    let lines = entries(panel, 0.0, cell_w).1;
    if lines == 0 {
        4.0
    } else {
        lines as f64 * (LEGEND_PX + 6.0) + 4.0
    }
}

/// Arranges title and legend of a panel whose plot area starts at `plot_y`.
fn head(panel: &Panel, x: f64, w: f64, plot_y: f64) -> (Option<(f64, f64)>, Vec<Entry>) {
    let (mut legend, lines) = entries(panel, x, w);
    let first = plot_y - 8.0 - lines.saturating_sub(1) as f64 * (LEGEND_PX + 6.0);
    for entry in &mut legend {
        entry.y = first + entry.y * (LEGEND_PX + 6.0);
    }
    let title = (!panel.title.is_empty()).then_some((x, first));
    (title, legend)
}

/// Arranges the legend entries with `x` set and `y` as line number; also returns the number of header lines.
fn entries(panel: &Panel, x: f64, w: f64) -> (Vec<Entry>, usize) {
    let mut entries: Vec<Entry> = Vec::new();
    let title_w = if panel.title.is_empty() {
        0.0
    } else {
        1.06 * width(&panel.title, PANEL_TITLE_PX) + ENTRY_GAP + 4.0
    };
    // The legend is placed next to the title if it fits there, otherwise on separate lines.
    let whole: f64 = panel
        .series
        .iter()
        .map(Series::name)
        .filter(|name| !name.is_empty())
        .map(|name| SAMPLE + 5.0 + width(name, LEGEND_PX) + ENTRY_GAP)
        .sum();
    let next_to_title = title_w + whole - ENTRY_GAP <= w;
    let mut line = usize::from(!next_to_title && title_w > 0.0);
    let mut at = if next_to_title { x + title_w } else { x };
    for (index, series) in panel.series.iter().enumerate() {
        // A figure can be narrower than a name.
        let name = shorten(series.name(), LEGEND_PX, w - SAMPLE - 5.0).unwrap_or_default();
        let sample = match series {
            Series::Line(l) => Sample::Line(l.dash, l.width_px),
            Series::Band(_) => Sample::Band,
            Series::Points(p) => Sample::Points(p.size_px),
        };
        if name.is_empty() {
            continue;
        }
        let entry_w = SAMPLE + 5.0 + width(&name, LEGEND_PX);
        if at > x && at + entry_w > x + w && !next_to_title {
            line += 1;
            at = x;
        }
        entries.push(Entry {
            name,
            colour: series.colour(),
            sample,
            series: index,
            x: at,
            y: line as f64,
        });
        at += entry_w + ENTRY_GAP;
    }
    let lines = match (entries.is_empty(), panel.title.is_empty()) {
        (true, true) => 0,
        (true, false) => 1,
        _ => line + 1,
    };
    (entries, lines)
}
