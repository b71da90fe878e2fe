//! Figures: drawing and errors. The PNGs are saved in the target folder's `tmp` for inspection.

use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel, PngError};
use std::path::Path;

fn time_s(n: usize, end_s: f64) -> Vec<f64> {
    (0..n).map(|i| end_s * i as f64 / (n - 1) as f64).collect()
}

/// Staircase motion of the paper with an offset of 10 mrad from 12 s on: three stacked panels.
fn stacked() -> Figure {
    let t = time_s(2000, 40.0);
    let q: Vec<f64> = t
        .iter()
        .map(|t| {
            let step = (t / 8.0).floor();
            let ease = ((t - 8.0 * step) / 1.5).min(1.0);
            std::f64::consts::FRAC_PI_8 * (step + ease * ease * (3.0 - 2.0 * ease)).min(4.0)
        })
        .collect();
    let tau: Vec<f64> = q.iter().map(|q| -3.6 * q.sin()).collect();
    let spring: Vec<f64> = t
        .iter()
        .zip(&tau)
        .map(|(t, tau)| if *t > 12.0 { tau + 0.4 } else { *tau })
        .collect();
    let delta: Vec<f64> = t
        .iter()
        .map(|&t| match t {
            t if t < 0.8 || (20.0..21.0).contains(&t) => f64::NAN,
            t => 0.4 * (9.0 * t).sin() * (1.3 * t).cos() + if t > 12.0 { 10.0 } else { 0.0 },
        })
        .collect();
    let shifted = |d: f64| delta.iter().map(|v| v + d).collect::<Vec<f64>>();
    Figure::new("shoulder_pitch")
        .subtitle("Offset of the motor position, matched comparison, observer gain 20 1/s; the recording misses 20 to 21 s.")
        .size(720.0, 620.0)
        .panel(
            Panel::new("Offset", "", "offset (mrad)")
                .band(Band::new("smallest to largest", t.clone(), shifted(-1.1), shifted(0.9)))
                .line(Line::new("mean of interval", t.clone(), delta.clone()))
                .reference(10.0, "injected 10 mrad")
                .event(12.0, "injected")
                .span(20.0, 21.0, "gap")
                .y_right("elongation (mm)", 0.03)
                .x_range(0.0, 40.0)
                .weight(1.4),
        )
        .panel(
            Panel::new("Torque", "", "torque (N·m)")
                .line(Line::new("observed τ_{el}", t.clone(), tau).colour(Colour::Blue))
                .line(
                    Line::new("spring K(θ − q)", t.clone(), spring)
                        .colour(Colour::Orange)
                        .dash(Dash::Dashed),
                )
                .x_range(0.0, 40.0),
        )
        .panel(
            Panel::new("Motion", "time (s)", "q (rad)")
                .line(Line::new("", t, q).colour(Colour::Black))
                .x_range(0.0, 40.0)
                .weight(0.8),
        )
}

/// Three panels side by side with large and small numbers.
fn side_by_side() -> Figure {
    let t = time_s(300, 12.0);
    let wave = |a: f64, w: f64| t.iter().map(|t| a * (w * t).sin()).collect::<Vec<f64>>();
    let mut figure =
        Figure::new("Estimated offset on the paper's motion, with and without model error")
            .columns(3)
            .size(1000.0, 320.0);
    for (title, scale) in [
        ("(a) no model error", 1e-6),
        ("(b) K + 20 %", 15.1),
        ("(c) M, C, g − 10 %", 4.2e7),
    ] {
        figure = figure.panel(
            Panel::new(title, "time (s)", "offset (mrad)")
                .line(Line::new("0.010 rad", t.clone(), wave(scale, 1.0)))
                .line(
                    Line::new("0.015 rad", t.clone(), wave(1.3 * scale, 1.0))
                        .colour(Colour::Orange),
                )
                .line(
                    Line::new("difference", t.clone(), wave(0.3 * scale, 1.0))
                        .colour(Colour::Green)
                        .dash(Dash::Dotted)
                        .step(),
                ),
        );
    }
    figure
}

fn save(figure: &Figure, name: &str) -> Vec<u8> {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let png = figure.png(2.0).expect("a figure of ordinary size");
    std::fs::write(dir.join(format!("{name}.svg")), figure.svg()).expect("target/tmp is writable");
    std::fs::write(dir.join(format!("{name}.png")), &png).expect("target/tmp is writable");
    png
}

#[test]
fn png_has_requested_size() {
    for (figure, name, size) in [
        (stacked(), "stacked", (1440u32, 1240u32)),
        (side_by_side(), "side_by_side", (2000, 640)),
    ] {
        let png = save(&figure, name);
        assert_eq!(&png[1..4], b"PNG");
        let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert_eq!((number(16), number(20)), size);
    }
}

#[test]
fn png_has_text_without_installed_fonts() {
    // The same figure without text must give different pixels, because glyphs are drawn.
    let with = Figure::new("offset of the elbow").size(300.0, 120.0);
    let without = Figure::new("").size(300.0, 120.0);
    assert_ne!(with.png(1.0).unwrap(), without.png(1.0).unwrap());
}

#[test]
fn figure_output_is_deterministic() {
    assert_eq!(stacked().svg(), stacked().svg());
    assert_eq!(
        side_by_side().png(1.0).unwrap(),
        side_by_side().png(1.0).unwrap()
    );
}

#[test]
fn text_shifts_are_numbers_in_user_units() {
    for figure in [stacked(), subscripted()] {
        let svg = figure.svg();
        assert!(svg.contains("<tspan dy="), "{svg}");
        for unit in ["em\"", "%\"", "baseline-shift", "₀", "ₑ"] {
            assert!(!svg.contains(unit), "{unit}");
        }
        // In each text the shifts of a subscript and of the words after it cancel.
        for text in svg.split("<text ").skip(1) {
            let shifts = text.split(" dy=\"").skip(1);
            let shifts: Vec<f64> = shifts
                .map(|s| s.split('"').next().unwrap().parse().expect("a number"))
                .collect();
            for pair in shifts.chunks_exact(2) {
                assert_eq!(pair[0] + pair[1], 0.0, "{text}");
            }
        }
    }
}

/// Subscripts in a title, labels and the legend.
fn subscripted() -> Figure {
    let x = vec![0.0, 1.0];
    Figure::new("Slope m_{E} of the rope").panel(
        Panel::new("K_{I} = 25 1/s", "t_{0} (s)", "δ_{e} (mrad)").line(Line::new(
            "δ_{e} of the elbow",
            x.clone(),
            x,
        )),
    )
}

#[test]
fn lines_of_cycle_differ_without_colour() {
    let x = vec![0.0, 1.0];
    let mut panel = Panel::new("", "x", "y");
    for (i, dash) in Dash::CYCLE.into_iter().enumerate() {
        let y = vec![i as f64; 2];
        let line = Line::new(format!("line {i}"), x.clone(), y).colour(Colour::CYCLE[i]);
        panel = panel.line(line.dash(dash));
    }
    let figure = Figure::new("dashes").panel(panel);
    save(&figure, "dashes");
    let svg = figure.svg();
    // A key of the legend, and the line itself, have the same pattern.
    let patterns = |class: &str| -> Vec<String> {
        let start = format!("<g class=\"{class}\"");
        let groups = svg.split(&start).skip(1);
        let pattern = |group: &str| {
            let group = group.split("</g>").next().unwrap();
            let dashes = group.split("stroke-dasharray=\"").nth(1);
            dashes.map_or(String::new(), |d| d.split('"').next().unwrap().into())
        };
        groups.map(pattern).collect()
    };
    let lines = patterns("line");
    assert_eq!(lines, patterns("key"));
    assert_eq!(lines.len(), Colour::CYCLE.len());
    let different: std::collections::HashSet<&String> = lines.iter().collect();
    assert_eq!(different.len(), lines.len(), "{lines:?}");
}

#[test]
fn gaps_split_lines_and_bands() {
    let x = vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let y = vec![1.0, 2.0, f64::NAN, 2.0, 1.0, f64::INFINITY, 3.0];
    let svg = Figure::new("")
        .panel(Panel::new("", "s", "m").line(Line::new("", x, y)))
        .svg();
    let line = svg
        .lines()
        .find(|l| l.contains("stroke-width=\"1.5\""))
        .expect("the line is drawn");
    assert_eq!(line.matches('M').count(), 2, "{line}");
    assert!(svg.contains("h0\""), "the lone point is a dot: {svg}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn hostile_text_is_escaped() {
    let name = "</text><script>alert('x')</script>\u{0}&\"";
    let figure = Figure::new(name).subtitle(name).panel(
        Panel::new(name, name, name)
            .line(Line::new(name, vec![0.0, 1.0], vec![0.0, 1.0]))
            .event(0.5, name)
            .reference(0.5, name)
            .note(0.2, 0.2, name),
    );
    assert!(!figure.svg().contains("<script"));
    figure.png(1.0).expect("still well-formed");
}

#[test]
fn degenerate_data_is_drawn_without_panic() {
    let degenerate = [
        (vec![], vec![]),
        (vec![0.0], vec![f64::NAN]),
        (vec![f64::NAN; 3], vec![f64::NAN; 3]),
        (vec![1.0; 5], vec![7.0; 5]),
        (vec![0.0, 1e308], vec![-1e308, 1e308]),
        (vec![5.0, 1.0, 3.0], vec![1.0, 2.0, 3.0]),
    ];
    for (x, y) in degenerate {
        let panel = Panel::new("degenerate", "x", "y")
            .line(Line::new("line", x.clone(), y.clone()))
            .band(Band::new("band", x, y.clone(), y))
            .event(f64::NAN, "never")
            .reference(f64::INFINITY, "nowhere")
            .span(f64::NAN, 2.0, "nowhere");
        let figure = Figure::new("degenerate").panel(panel);
        assert!(!figure.svg().contains("NaN"));
        figure.png(1.0).expect("drawn");
    }
    for (w, h) in [(0.0, 0.0), (f64::NAN, -5.0), (1e9, 100.0)] {
        stacked().size(w, h).svg();
    }
}

#[test]
fn long_series_is_reduced_and_keeps_extremes() {
    let t = time_s(400_000, 1000.0);
    let y: Vec<f64> = (0..t.len())
        .map(|i| {
            if i == 123_456 {
                9.0
            } else {
                (i as f64 * 0.7).sin()
            }
        })
        .collect();
    let svg = Figure::new("")
        .panel(Panel::new("", "time (s)", "y").line(Line::new("", t, y)))
        .svg();
    assert!(svg.len() < 60_000, "{} bytes", svg.len());
    let spike_free = Figure::new("").panel(
        Panel::new("", "time (s)", "y")
            .y_range(-1.5, 9.5)
            .line(Line::new("", vec![0.0], vec![0.0])),
    );
    assert!(spike_free.svg().len() < svg.len());
    assert!(svg.contains(">8</text>"), "the axis reaches to the spike");
}

#[test]
fn png_of_invalid_size_returns_error() {
    for scale in [0.0, -1.0, f64::NAN, 1e6] {
        let error = stacked().png(scale).unwrap_err();
        assert!(matches!(error, PngError::Size { .. }), "{scale}");
        assert!(error.to_string().contains("pixels"), "{error}");
    }
}

#[test]
fn figure_format_follows_file_extension() {
    let folder = std::env::temp_dir().join(format!("sinew-figure-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let read = |name: &str| {
        stacked().write(&folder.join(name)).unwrap();
        std::fs::read(folder.join(name)).unwrap()
    };
    assert_eq!(read("a.svg"), stacked().svg().into_bytes());
    assert_eq!(read("a.png"), stacked().png(2.0).unwrap());
    let error = stacked()
        .write(&folder.join("a.pdf"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("a.pdf") && error.contains(".svg or .png"),
        "{error}"
    );
    assert!(!folder.join("a.pdf").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}
