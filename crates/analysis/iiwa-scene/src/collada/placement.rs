//! Transformations of nodes.

use super::document::{ColladaError, XmlElement, fault, numbers, title};

/// Affine map of a node into the frame of the scene: the upper three rows of its matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement([[f64; 4]; 3]);

impl Placement {
    pub(super) const IDENTITY: Self =
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// Returns the map that applies `inner` first.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let linear: f64 = (0..3).map(|k| self.0[i][k] * inner.0[k][j]).sum();
                if j == 3 { linear + self.0[i][3] } else { linear }
            })
        }))
    }

    pub(super) fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3])
    }

    /// Returns true if the map inverts the orientation of triangles.
    pub(super) fn is_mirrored(&self) -> bool {
        let [a, b, c] = self.0.map(|row| [row[0], row[1], row[2]]);
        dot(a, cross(b, c)) < 0.0
    }

    /// Map with these columns and this translation.
    fn of_columns(columns: [[f64; 3]; 3], translation: [f64; 3]) -> Self {
        let [x, y, z] = columns;
        Self(std::array::from_fn(|i| [x[i], y[i], z[i], translation[i]]))
    }

    /// Reads a transformation of a node; `None` for other elements.
    pub(super) fn read(element: XmlElement<'_>) -> Result<Option<Self>, ColladaError> {
        let placement = match element.tag_name().name() {
            "matrix" => {
                let rows: [f64; 16] = exactly(element)?;
                if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
                    let message =
                        "the last row of <matrix> is not 0 0 0 1, which cannot be applied";
                    return Err(fault(element, message));
                }
                Self(std::array::from_fn(|i| std::array::from_fn(|j| rows[4 * i + j])))
            }
            "translate" => Self::of_columns(Self::IDENTITY.columns(), exactly(element)?),
            "scale" => {
                let [x, y, z]: [f64; 3] = exactly(element)?;
                Self::of_columns([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], [0.0; 3])
            }
            "rotate" => rotation(element)?,
            "lookat" => looking(element)?,
            "skew" => return Err(not_applied(element)),
            _ => return Ok(None),
        };
        Ok(Some(placement))
    }

    fn columns(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|j| self.0.map(|row| row[j]))
    }
}

/// Error for content that would move or deform a shape in a way that is not supported.
pub(super) fn not_applied(element: XmlElement<'_>) -> ColladaError {
    let owner = element.parent_element().map(title).unwrap_or_default();
    let message = format!(
        "{} in {owner} cannot be applied: write the mesh as STL or OBJ, or without it",
        title(element)
    );
    fault(element, message)
}

/// Rotation about an axis through the origin, by an angle in degrees.
fn rotation(element: XmlElement<'_>) -> Result<Placement, ColladaError> {
    let [x, y, z, degrees]: [f64; 4] = exactly(element)?;
    if degrees == 0.0 {
        return Ok(Placement::IDENTITY);
    }
    let [x, y, z] =
        unit([x, y, z]).ok_or_else(|| fault(element, "the axis of <rotate> has zero length"))?;
    let (sin, cos) = exact_sin_cos(degrees);
    let rest = 1.0 - cos;
    let columns = [
        [cos + x * x * rest, y * x * rest + z * sin, z * x * rest - y * sin],
        [x * y * rest - z * sin, cos + y * y * rest, z * y * rest + x * sin],
        [x * z * rest + y * sin, y * z * rest - x * sin, cos + z * z * rest],
    ];
    Ok(Placement::of_columns(columns, [0.0; 3]))
}

/// Returns sine and cosine; exact for multiples of 90 degrees.
fn exact_sin_cos(degrees: f64) -> (f64, f64) {
    let turned = degrees.rem_euclid(360.0);
    if turned % 90.0 != 0.0 {
        return degrees.to_radians().sin_cos();
    }
    if turned == 90.0 {
        (1.0, 0.0)
    } else if turned == 180.0 {
        (0.0, -1.0)
    } else if turned == 270.0 {
        (-1.0, 0.0)
    } else {
        (0.0, 1.0)
    }
}

/// Frame at an eye point, with -z towards the point of interest and y on the side of the up axis.
fn looking(element: XmlElement<'_>) -> Result<Placement, ColladaError> {
    let [ex, ey, ez, px, py, pz, ux, uy, uz]: [f64; 9] = exactly(element)?;
    let frame = unit([ex - px, ey - py, ez - pz]).and_then(|z| {
        let x = unit(cross([ux, uy, uz], z))?;
        Some([x, cross(z, x), z])
    });
    let columns = frame.ok_or_else(|| {
        fault(
            element,
            "<lookat> has no direction: two points are equal, or the up axis is along it",
        )
    })?;
    Ok(Placement::of_columns(columns, [ex, ey, ez]))
}

fn exactly<const N: usize>(element: XmlElement<'_>) -> Result<[f64; N], ColladaError> {
    let found = numbers(element)?;
    <[f64; N]>::try_from(found).map_err(|found| {
        let tag = element.tag_name().name();
        fault(element, format!("<{tag}> has {} numbers; it must have {N}", found.len()))
    })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(vector, vector).sqrt();
    (length.is_normal()).then(|| vector.map(|value| value / length))
}
