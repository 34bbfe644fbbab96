//! A surface of polygons, and the two formats in which programs exchange it.

use nalgebra::Vector3;
use std::fmt::Write;

/// A closed surface: corners in metres, and polygons by places of corners, counterclockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// The corners.
    pub corners: Vec<Vector3<f64>>,
    /// The polygons.
    pub polygons: Vec<Vec<usize>>,
}

impl SurfaceMesh {
    /// The surface as a file of Wavefront OBJ: a line `v` a corner, a line `f` a polygon, counted from one.
    pub fn obj(&self) -> String {
        let mut text = String::new();
        for corner in &self.corners {
            let _ = writeln!(text, "v {} {} {}", corner.x, corner.y, corner.z);
        }
        for polygon in &self.polygons {
            let places: Vec<String> = polygon.iter().map(|place| (place + 1).to_string()).collect();
            let _ = writeln!(text, "f {}", places.join(" "));
        }
        text
    }

    /// The surface as a PLY file (Stanford) in text, with corners in doubles.
    pub fn ply(&self) -> String {
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment corners in metres\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement \
             face {}\nproperty list uint uint vertex_indices\nend_header\n",
            self.corners.len(),
            self.polygons.len()
        );
        for corner in &self.corners {
            let _ = writeln!(text, "{} {} {}", corner.x, corner.y, corner.z);
        }
        for polygon in &self.polygons {
            let places: Vec<String> = polygon.iter().map(usize::to_string).collect();
            let _ = writeln!(text, "{} {}", polygon.len(), places.join(" "));
        }
        text
    }

    /// The volume within, computed in doubles, in m^3.
    pub fn volume(&self) -> f64 {
        let fan = |polygon: &Vec<usize>| -> f64 {
            let Some((&first, rest)) = polygon.split_first() else { return 0.0 };
            let apex = &self.corners[first];
            rest.windows(2).map(|pair| apex.dot(&self.corners[pair[0]].cross(&self.corners[pair[1]]))).sum()
        };
        self.polygons.iter().map(fan).sum::<f64>() / 6.0
    }

    /// Each edge once, by the lesser place first.
    pub fn edges(&self) -> Vec<[usize; 2]> {
        let around = |polygon: &Vec<usize>| -> Vec<[usize; 2]> {
            let next = polygon.iter().cycle().skip(1);
            polygon.iter().zip(next).map(|(a, b)| [*a.min(b), *a.max(b)]).collect()
        };
        let mut edges: Vec<[usize; 2]> = self.polygons.iter().flat_map(around).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: the corner of a cube with edges of length one has the volume 1/6, four corners and six edges.
    #[test]
    fn a_tetrahedron_is_written() {
        let corners = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let polygons = vec![vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]];
        let mesh = SurfaceMesh { corners, polygons };
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-16);
        assert_eq!(mesh.edges().len(), 6);
        let obj = mesh.obj();
        assert_eq!(obj.lines().filter(|line| line.starts_with("v ")).count(), 4);
        assert_eq!(obj.lines().last(), Some("f 2 3 4"));
        let ply = mesh.ply();
        let body: Vec<&str> = ply.lines().skip_while(|line| *line != "end_header").skip(1).collect();
        assert_eq!((body.len(), body[1], body[7]), (8, "1 0 0", "3 1 2 3"));
    }
}
