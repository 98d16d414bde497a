//! The frames of a film, read one after the other, for formats that name faces and fields once.

use super::WriteError;
use crate::io::result::{Field, Frame, ResultReader};

/// Some frames of a result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Film<'a> {
    pub(super) result: &'a ResultReader,
    indices: &'a [usize],
    /// The format, for messages.
    format: &'static str,
}

impl<'a> Film<'a> {
    /// # Panics
    /// No frames.
    pub(super) fn new(
        result: &'a ResultReader,
        indices: &'a [usize],
        format: &'static str,
    ) -> Self {
        assert!(!indices.is_empty(), "a film has at least one frame");
        Self {
            result,
            indices,
            format,
        }
    }

    /// Number of frames.
    pub(super) fn len(&self) -> usize {
        self.indices.len()
    }

    /// Calls `each` with every frame, in order; all have the fields of the first, by name.
    pub(super) fn visit(
        &self,
        mut each: impl FnMut(&Frame) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let mut names: Option<[Vec<String>; 2]> = None;
        for &index in self.indices {
            let frame = self.result.frame(index)?;
            let found =
                [&frame.vertex_fields, &frame.face_fields].map(|fields| field_names(fields));
            if *names.get_or_insert_with(|| found.clone()) != found {
                return Err(WriteError::ChangingFields {
                    frame: index,
                    format: self.format,
                });
            }
            each(&frame)?;
        }
        Ok(())
    }

    /// As [`Film::visit`], for formats that hold the faces once: a film whose faces burn away is refused, one frame is not.
    pub(super) fn visit_same_faces(
        &self,
        mut each: impl FnMut(&Frame) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        self.visit(|frame| {
            if frame.topology.is_some() && self.len() > 1 {
                return Err(WriteError::ChangingFaces {
                    format: self.format,
                });
            }
            each(frame)
        })
    }
}

fn field_names(fields: &[Field]) -> Vec<String> {
    fields.iter().map(|field| field.name.clone()).collect()
}
