use super::*;

fn series(name: &str, points: &[[f64; 2]]) -> Series {
    Series {
        name: name.into(),
        points: points.to_vec(),
        ..Series::default()
    }
}

fn panel(style: Style, series: Vec<Series>) -> Panel {
    Panel {
        name: "energy".into(),
        unit: "J".into(),
        style,
        series,
        weight: 1.0,
        if_empty: "no values".into(),
        ..Panel::default()
    }
}

fn chart(panels: Vec<Panel>) -> Chart {
    Chart {
        title: "a < b & c".into(),
        x_label: "time [s]".into(),
        x_range: (0.0, 2.0),
        panels,
        ..Chart::default()
    }
}

const RISING: [[f64; 2]; 3] = [[0.5, 1.0], [1.0, 2.0], [2.0, 4.0]];

#[test]
fn a_curve_goes_from_corner_to_corner_in_its_colour() {
    let chart = chart(vec![panel(
        Style::Lines,
        vec![series("a", &RISING), series("b", &[[1.0, -4.0]])],
    )]);
    let image = chart.to_image(600, 400).unwrap();
    let blue = |x: u32, y: u32| {
        image
            .pixel(x, y)
            .is_some_and(|[r, _, b]| b > r.saturating_add(60))
    };
    let columns: Vec<u32> = (0..450).filter(|&x| (0..360).any(|y| blue(x, y))).collect();
    assert!(columns.len() > 200, "{}", columns.len());
    let height = |x: u32| (0..360).find(|&y| blue(x, y)).unwrap();
    assert!(
        height(columns[columns.len() - 2]) + 50 < height(columns[1]),
        "it rises"
    );
}

#[test]
fn a_stack_has_layers_of_its_values() {
    let layers = vec![
        series("low", &[[1.0, 1.0], [2.0, 1.0]]),
        series("high", &[[1.0, 1.0], [2.0, 3.0]]),
    ];
    let areas: Vec<Vec<[f64; 2]>> =
        layout::marks(&chart(vec![panel(Style::Stack, layers)]), (600, 400))
            .into_iter()
            .filter_map(|mark| match mark {
                Mark::Area { points, .. } if points.len() == 8 => Some(points),
                _ => None,
            })
            .collect();
    assert_eq!(areas.len(), 2);
    let thickness = |area: &[[f64; 2]], step: usize| area[7 - 2 * step][1] - area[2 * step][1];
    let unit = thickness(&areas[0], 0);
    assert!(unit > 10.0);
    for (area, step, value) in [(0, 1, 1.0), (1, 0, 1.0), (1, 1, 3.0)] {
        assert!(
            (thickness(&areas[area], step) / unit - value).abs() < 1e-9,
            "{area} {step}"
        );
    }
    // The first step begins at 0, as long before its end as the second.
    assert!((areas[0][0][0] - (2.0 * areas[0][1][0] - areas[0][3][0])).abs() < 1e-9);
}

#[test]
fn odd_values_are_gaps_and_nothing_is_told_in_words() {
    let odd = [
        [0.0, f64::NAN],
        [0.5, 1.0],
        [1.0, f64::INFINITY],
        [1.5, -1.0],
        [2.0, 0.0],
    ];
    for style in [Style::Lines, Style::LogLines, Style::Stack] {
        for points in [&odd[..], &odd[..2], &odd[..1], &[]] {
            let panels = vec![panel(style, vec![series("a", points), series("b", points)])];
            let text = chart(panels.clone()).to_svg(300, 200).unwrap();
            assert!(
                !text.contains("NaN") && !text.contains("inf"),
                "{style:?} {points:?}"
            );
            let has_values = points.iter().any(|point| point[1].is_finite());
            let is_empty_stack = style == Style::Stack && !points.is_empty();
            assert_eq!(
                text.contains("no values"),
                !has_values && !is_empty_stack,
                "{style:?} {points:?}"
            );
            chart(panels).to_image(300, 200).unwrap();
        }
    }
    assert!(
        chart(vec![])
            .to_svg(10, 10)
            .unwrap()
            .contains("a &lt; b &amp; c")
    );
    assert!(chart(vec![]).to_svg(0, 10).is_err() && chart(vec![]).to_image(10, 99_999).is_err());
}

#[test]
fn thousands_of_points_become_as_many_as_there_are_pixels_and_keep_their_peaks() {
    let mut points: Vec<[f64; 2]> = (0..50_000)
        .map(|k| [2.0 * f64::from(k) / 5e4, f64::from(k % 7)])
        .collect();
    points[31_234][1] = 100.0;
    let line = vec![panel(Style::Lines, vec![series("a", &points)])];
    let text = chart(line).to_svg(600, 400).unwrap();
    assert!(text.len() < 100_000, "{} bytes", text.len());
    let marks = layout::marks(
        &chart(vec![panel(Style::Lines, vec![series("a", &points)])]),
        (600, 400),
    );
    let top = marks.iter().filter_map(|mark| match mark {
        Mark::Line { points, .. } if points.len() > 100 => {
            Some(points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min))
        }
        _ => None,
    });
    // The peak of 100 stands 6 % under the frame, far above the others at 6.
    assert!(top.fold(f64::INFINITY, f64::min) < 90.0);
    let stack = chart(vec![panel(Style::Stack, vec![series("a", &points)])]);
    assert!(stack.to_svg(600, 400).unwrap().len() < 100_000);
}

#[test]
fn words_do_not_overlap() {
    let names = [
        "gravity", "membrane", "bending", "kinetic", "contact", "friction", "clamps",
    ];
    let all: Vec<Series> = names.iter().map(|name| series(name, &RISING)).collect();
    let panels =
        [Style::Lines, Style::Stack, Style::LogLines].map(|style| panel(style, all.clone()));
    let typeface = crate::font::Typeface::load();
    for sides in [(1200, 900), (600, 400), (400, 800)] {
        let boxes: Vec<(String, [f64; 4])> = layout::marks(&chart(panels.to_vec()), sides)
            .into_iter()
            .filter_map(|mark| match mark {
                Mark::Words {
                    text,
                    at: [x, y],
                    anchor,
                    size,
                    ..
                } => {
                    let width = f64::from(typeface.width(&text, size as f32));
                    let left = match anchor {
                        Anchor::Start => x,
                        Anchor::Middle => x - 0.5 * width,
                        Anchor::End => x - width,
                    };
                    // Figures and small letters: 0.75 em high.
                    Some((text, [left, y - 0.75 * size, left + width, y]))
                }
                _ => None,
            })
            .collect();
        for (i, (a, [left, top, right, bottom])) in boxes.iter().enumerate() {
            assert!(
                *left >= 0.0 && *right <= f64::from(sides.0) && *bottom <= f64::from(sides.1),
                "{a}"
            );
            for (b, other) in &boxes[..i] {
                let apart = *right <= other[0]
                    || other[2] <= *left
                    || *bottom <= other[1]
                    || other[3] <= *top;
                assert!(apart, "'{a}' and '{b}' overlap at {sides:?}");
            }
        }
    }
}

#[test]
fn panels_beside_each_other_have_axes_of_their_own_and_signs_at_points() {
    let marked = |name: &str, marker, color| Series {
        marker: Some(marker),
        color: Some(color),
        ..series(name, &[[10.0, 1e-1], [100.0, 1e-2], [1000.0, 1e-3]])
    };
    let colors = [[1, 2, 3], [4, 5, 6]];
    let panels = colors.map(|color| {
        let both = [Marker::Circle, Marker::Cross].map(|sign| marked("a", sign, color));
        panel(Style::LogLines, both.to_vec())
    });
    let chart = Chart {
        x_range: (10.0, 1000.0),
        x_is_log: true,
        arrangement: Arrangement::Beside,
        ..chart(panels.to_vec())
    };
    let marks = layout::marks(&chart, (1200, 600));
    let span = |wanted: [u8; 3]| {
        let lines = marks.iter().filter_map(|mark| match mark {
            Mark::Line { points, color, .. } if *color == wanted => Some(points),
            _ => None,
        });
        let ends: Vec<f64> = lines.flatten().map(|point| point[0]).collect();
        // Equal factors are equal distances.
        assert!(
            (ends[1] - 0.5 * (ends[0] + ends[2])).abs() < 1e-9,
            "{ends:?}"
        );
        (ends[0], ends[2])
    };
    let [left, right] = colors.map(span);
    assert!(left.0 < left.1 && left.1 < right.0 && right.0 < right.1);
    let signs = |wanted: [u8; 3]| {
        let areas = marks.iter();
        areas
            .filter(|mark| matches!(mark, Mark::Area { color, .. } if *color == wanted))
            .count()
    };
    // Three points and the legend, for two curves.
    assert_eq!(colors.map(signs), [8, 8]);
}

#[test]
fn numbers_of_things_have_whole_ticks() {
    let few = Series {
        points: vec![[5.0, 1.0], [10.0, 2.0]],
        ..Series::default()
    };
    let labels = |is_count: bool| {
        let panel = Panel {
            is_count,
            ..panel(Style::Stack, vec![few.clone()])
        };
        let chart = Chart {
            x_range: (0.0, 10.0),
            ..chart(vec![panel])
        };
        chart.to_svg(400, 300).unwrap()
    };
    assert!(labels(false).contains(">1.5<"));
    assert!(labels(true).contains(">1<") && !labels(true).contains(">1.5<"));
}

#[test]
fn curves_on_each_other_and_signs_around_them_are_all_seen() {
    let points = [[1.0, 1.0], [2.0, 2.0]];
    let with = |marker, line, color| Series {
        marker,
        line,
        color: Some(color),
        ..series("a", &points)
    };
    let colors = [[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12]];
    let all = vec![
        with(Some(Marker::Star), Line::Solid, colors[0]),
        with(Some(Marker::Star), Line::Solid, colors[1]),
        with(Some(Marker::Ring), Line::None, colors[2]),
        with(None, Line::Guide, colors[3]),
    ];
    let marks = layout::marks(&chart(vec![panel(Style::Lines, all)]), (800, 600));
    let line_widths = |wanted: [u8; 3]| -> Vec<f64> {
        let lines = marks.iter().filter_map(|mark| match mark {
            Mark::Line { width, color, .. } if *color == wanted => Some(*width),
            _ => None,
        });
        lines.collect()
    };
    let sign_width = |wanted: [u8; 3]| {
        let signs = marks.iter().filter_map(|mark| match mark {
            Mark::Area { points, color } if *color == wanted => Some(points),
            _ => None,
        });
        let span = |points: &Vec<[f64; 2]>| {
            let xs = points.iter().map(|point| point[0]);
            xs.clone().fold(f64::MIN, f64::max) - xs.fold(f64::MAX, f64::min)
        };
        signs.map(span).next().unwrap()
    };
    assert!(line_widths(colors[0])[0] > line_widths(colors[1])[0]);
    assert!(sign_width(colors[0]) > sign_width(colors[1]));
    // Two points and the legend: rings are outlines, and nothing joins them.
    assert_eq!(line_widths(colors[2]).len(), 3);
    // Behind the curves, and thinner.
    assert!(line_widths(colors[3])[0] < line_widths(colors[1])[0]);
}

#[test]
fn panels_can_be_made_to_have_the_same_axis() {
    let labels = |include: Vec<f64>| {
        let panel = Panel {
            include,
            ..panel(
                Style::LogLines,
                vec![series("a", &[[1.0, 0.5], [2.0, 0.2]])],
            )
        };
        chart(vec![panel]).to_svg(400, 300).unwrap()
    };
    assert!(!labels(Vec::new()).contains("10⁻³"));
    assert!(labels(vec![1e-3]).contains("10⁻³"));
}
