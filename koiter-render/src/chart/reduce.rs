//! Fewer points where a pixel has many.

/// Pieces of a curve without gaps, in pixels; of the points in one column of pixels only first, lowest, highest and last
/// are kept, which look the same.
pub(super) fn pieces(points: impl Iterator<Item = Option<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for point in points {
        match (point, pieces.last_mut()) {
            (Some(point), Some(piece)) => piece.push(point),
            _ => pieces.push(Vec::new()),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces.iter().map(|piece| thinned(piece)).collect()
}

fn thinned(piece: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for column in piece.chunk_by(|a, b| a[0].floor() == b[0].floor()) {
        if column.len() <= 4 {
            kept.extend(column);
            continue;
        }
        let by_height = |a: &&usize, b: &&usize| column[**a][1].total_cmp(&column[**b][1]);
        let numbers: Vec<usize> = (0..column.len()).collect();
        let lowest = numbers.iter().min_by(by_height).copied().unwrap_or(0);
        let highest = numbers.iter().max_by(by_height).copied().unwrap_or(0);
        let mut chosen = vec![0, lowest, highest, column.len() - 1];
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|number| column[number]));
    }
    kept
}

/// Stairs of a stack: x where each step ends [pixels], with the layers' means over the steps that end in one column.
pub(super) fn columns(ends: &[f64], layers: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let numbers: Vec<usize> = (0..ends.len()).collect();
    let groups: Vec<&[usize]> = numbers
        .chunk_by(|&a, &b| ends[a].floor() == ends[b].floor())
        .collect();
    let mean = |layer: &Vec<f64>, group: &&[usize]| {
        let sum: f64 = group
            .iter()
            .map(|&number| layer[number])
            .filter(|value| value.is_finite())
            .sum();
        sum / group.len() as f64
    };
    let ends = groups
        .iter()
        .filter_map(|group| group.last().map(|&last| ends[last]))
        .collect();
    let layers = layers
        .iter()
        .map(|layer| groups.iter().map(|group| mean(layer, group)).collect())
        .collect();
    (ends, layers)
}
