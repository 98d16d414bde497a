//! Values on the faces that are shown.

use super::simulation::Simulation;

impl Simulation {
    /// Values on the faces of all parts; zero on obstacles: largest principal Green strain, bending energy density
    /// [J/m²], mean curvature [1/m], mean curvature at rest [1/m]; of what burns temperature [K] and mass ratio,
    /// of Bézier shells strain and bending.
    pub fn face_fields(&self) -> Vec<(&'static str, Vec<f32>)> {
        let shells = &self.system.space.shells;
        let obstacles = self.parts().iter().filter(|part| part.is_obstacle);
        let on_obstacles: usize = obstacles.map(|part| part.faces.len()).sum();
        let of_others = match &self.bezier {
            Some(body) => Some(body.face_fields()),
            None if self.burning.is_empty() => None,
            None => Some(self.burning_fields()),
        };
        if let Some(fields) = of_others {
            return (fields.into_iter())
                .map(|(name, mut values)| {
                    values.extend(std::iter::repeat_n(0.0, on_obstacles));
                    (name, values)
                })
                .collect();
        }
        let q = &self.state.q;
        let gather = |value: &dyn Fn(usize, usize) -> f64| -> Vec<f32> {
            let shown = |s: usize| match self.heated.of_shell(s) {
                Some(burning) => burning.surface().face_triangles.clone(),
                None => (0..shells[s].mesh.num_faces() as u32).collect(),
            };
            let on_shells =
                (0..shells.len()).flat_map(|s| shown(s).into_iter().map(move |f| (s, f)));
            on_shells
                .map(|(s, f)| value(s, f as usize) as f32)
                .chain(std::iter::repeat_n(0.0, on_obstacles))
                .collect()
        };
        let mut fields = vec![
            ("strain", gather(&|s, f| shells[s].largest_strain(f, q))),
            (
                "bending_energy_density",
                gather(&|s, f| self.bending_density(s, f)),
            ),
            (
                "mean_curvature",
                gather(&|s, f| shells[s].mean_curvature(f, q)),
            ),
            (
                "rest_curvature",
                gather(&|s, f| 0.5 * (shells[s].rest_forms[f].x + shells[s].rest_forms[f].y)),
            ),
        ];
        if !self.heated.is_empty() {
            fields.extend(self.heated_fields().map(|(name, mut values)| {
                values.extend(std::iter::repeat_n(0.0, on_obstacles));
                (name, values)
            }));
        }
        fields
    }

    /// Bending energy per unit area of a face [J/m²] by the shown directors.
    fn bending_density(&self, shell: usize, face: usize) -> f64 {
        let part = &self.system.space.shells[shell];
        let form = part.second_form(face, &self.state.q) - part.rest_forms[face];
        part.section.bend(face, &form).density
    }
}
