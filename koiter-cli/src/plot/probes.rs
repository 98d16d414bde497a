//! Panels of what the probes measured: one a quantity.

use std::path::Path;

use koiter::scene::SceneFile;
use koiter::scene::spec::ProbeQuantity;
use koiter_render::{Panel, Series, Style};

/// Quantities in the order of the panels, with names and units.
const QUANTITIES: [(ProbeQuantity, &str, &str); 9] = [
    (ProbeQuantity::Displacement, "displacement", "m"),
    (ProbeQuantity::Position, "position", "m"),
    (ProbeQuantity::Highest, "highest point", "m"),
    (ProbeQuantity::Lowest, "lowest point", "m"),
    (ProbeQuantity::Distortion, "distortion", "m"),
    (ProbeQuantity::Velocity, "velocity", "m/s"),
    (ProbeQuantity::Reaction, "force on a constraint", "N"),
    (ProbeQuantity::Energy, "energy", "J"),
    (ProbeQuantity::LoadFactor, "load factor", ""),
];

/// The panels of a result folder; none where nothing was measured.
pub(super) fn panels(folder: &Path, scene_text: &str) -> Vec<Panel> {
    let Ok(table) = std::fs::read_to_string(folder.join("probes.csv")) else {
        return Vec::new();
    };
    // The text is that of a scene that ran; one of a later version may have keys that are not known here.
    let Ok(scene) = SceneFile::parse("scene", scene_text, &[]) else {
        return Vec::new();
    };
    let measured: Vec<(&str, ProbeQuantity)> = (scene.spec.probe.iter())
        .map(|probe| (probe.name.as_str(), probe.quantity))
        .collect();
    of_table(&table, &measured)
}

fn of_table(table: &str, measured: &[(&str, ProbeQuantity)]) -> Vec<Panel> {
    let mut lines = table.lines().map(|line| line.split(','));
    let Some(heading) = lines.next() else {
        return Vec::new();
    };
    // Of a run that goes on the last row may be half written: what is no number is a gap.
    let rows: Vec<Vec<f64>> = lines
        .map(|fields| {
            fields
                .map(|field| field.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    let columns: Vec<(usize, &str)> = heading.enumerate().skip(1).collect();
    let is_of = |column: &str, probe: &str| {
        let rest = column.strip_prefix(probe);
        rest.is_some_and(|rest| matches!(rest, "" | ".x" | ".y" | ".z"))
    };
    let panel = |&(quantity, name, unit): &(ProbeQuantity, &str, &str)| {
        let of_quantity = |column: &str| {
            let mut probes = measured
                .iter()
                .filter(|(_, measured)| *measured == quantity);
            probes.any(|(probe, _)| is_of(column, probe))
        };
        let series: Vec<Series> = (columns.iter())
            .filter(|(_, column)| of_quantity(column))
            .map(|(place, column)| Series {
                name: column.replace('_', " "),
                points: (rows.iter())
                    .filter_map(|row| Some([*row.first()?, *row.get(*place)?]))
                    .collect(),
                ..Series::default()
            })
            .collect();
        (!series.is_empty()).then(|| Panel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            style: Style::Lines,
            series,
            weight: 1.8,
            if_empty: "no figures".to_owned(),
            ..Panel::default()
        })
    };
    QUANTITIES.iter().filter_map(panel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_quantity_has_a_panel_with_the_columns_of_its_probes() {
        let table =
            "time,tip,force.x,force.y,force.z,tip_speed\n0,0,1,2,3,4\n0.1,-0.2,1,2,3,5\n0.2,-0";
        let measured = [
            ("tip", ProbeQuantity::Displacement),
            ("force", ProbeQuantity::Reaction),
            ("tip_speed", ProbeQuantity::Velocity),
        ];
        let panels = of_table(table, &measured);
        let names: Vec<&str> = panels.iter().map(|panel| panel.name.as_str()).collect();
        assert_eq!(names, ["displacement", "velocity", "force on a constraint"]);
        assert_eq!(panels[2].series.len(), 3);
        assert_eq!(panels[0].series[0].points[1], [0.1, -0.2]);
        assert_eq!(panels[1].series[0].name, "tip speed");
        assert_eq!(panels[1].series[0].points.len(), 2);
        assert!(of_table("", &measured).is_empty());
    }
}
