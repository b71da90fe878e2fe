//! Three-vectors and 3×3 rotations on plain arrays.
//!
//! The realtime pass uses plain arrays, which have no panic path and no generic dispatch, and whose indices are
//! visible to the optimiser. Matrices are row-major, `R[row][column]`.

/// Vector of three components.
pub type Vec3 = [f64; 3];
/// A 3×3 matrix, row-major.
pub type Mat3 = [[f64; 3]; 3];

/// The identity matrix.
pub const IDENTITY: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// `a + b`.
#[inline(always)]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a − b`.
#[inline(always)]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the product `k a`.
#[inline(always)]
pub(crate) fn scale(a: Vec3, k: f64) -> Vec3 {
    [a[0] * k, a[1] * k, a[2] * k]
}

/// `a · b`.
#[inline(always)]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`.
#[inline(always)]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Returns the rotated vector `R a`.
#[inline(always)]
pub(crate) fn rotate(r: &Mat3, a: Vec3) -> Vec3 {
    [dot(r[0], a), dot(r[1], a), dot(r[2], a)]
}

/// Returns the inversely rotated vector `Rᵀ a`.
#[inline(always)]
pub(crate) fn rotate_back(r: &Mat3, a: Vec3) -> Vec3 {
    [
        r[0][0] * a[0] + r[1][0] * a[1] + r[2][0] * a[2],
        r[0][1] * a[0] + r[1][1] * a[1] + r[2][1] * a[2],
        r[0][2] * a[0] + r[1][2] * a[1] + r[2][2] * a[2],
    ]
}

/// Returns the matrix product `A B`.
pub(crate) fn mul(a: &Mat3, b: &Mat3) -> Mat3 {
    let mut out = [[0.0; 3]; 3];
    for (out_row, a_row) in out.iter_mut().zip(a) {
        for k in 0..3 {
            out_row[k] = a_row[0] * b[0][k] + a_row[1] * b[1][k] + a_row[2] * b[2][k];
        }
    }
    out
}

/// Returns the transpose `Aᵀ`.
pub(crate) fn transpose(a: &Mat3) -> Mat3 {
    [
        [a[0][0], a[1][0], a[2][0]],
        [a[0][1], a[1][1], a[2][1]],
        [a[0][2], a[1][2], a[2][2]],
    ]
}

/// `A + k B`.
pub(crate) fn add_scaled(a: &Mat3, b: &Mat3, k: f64) -> Mat3 {
    let mut out = *a;
    for (out_row, b_row) in out.iter_mut().zip(b) {
        for (o, v) in out_row.iter_mut().zip(b_row) {
            *o += k * v;
        }
    }
    out
}

/// Length of `a`.
pub(crate) fn norm(a: Vec3) -> f64 {
    libm::sqrt(dot(a, a))
}

/// Rotation of URDF's roll, pitch, yaw: `Rz(yaw) Ry(pitch) Rx(roll)`.
pub fn rotation_from_rpy(rpy: Vec3) -> Mat3 {
    let (sr, cr) = libm::sincos(rpy[0]);
    let (sp, cp) = libm::sincos(rpy[1]);
    let (sy, cy) = libm::sincos(rpy[2]);
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Rotation whose third column is the unit vector `z`: it takes local z to `z`.
///
/// Which way the other two axes point does not matter to the dynamics; the coordinate axis
/// least aligned with `z` is chosen, which keeps the cross product well conditioned.
pub(crate) fn rotation_with_z(z: Vec3) -> Mat3 {
    // The three axes along ±x, ±y, ±z are most URDFs: keep their entries exactly 0 and ±1.
    let mut least = 0;
    for k in 1..3 {
        if z[k].abs() < z[least].abs() {
            least = k;
        }
    }
    let mut seed = [0.0; 3];
    seed[least] = 1.0;
    let y = cross(z, seed);
    let y = scale(y, 1.0 / norm(y)); // norm ≥ sqrt(2/3): `seed` is the least aligned axis
    let x = cross(y, z);
    transpose(&[x, y, z])
}

/// Inertia matrix of a point mass at `r`: `m (r·r 1 − r rᵀ)`.
pub(crate) fn point_inertia(m: f64, r: Vec3) -> Mat3 {
    let d = m * dot(r, r);
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for k in 0..3 {
            out[i][k] = -m * r[i] * r[k];
        }
        out[i][i] += d;
    }
    out
}

/// Rotation by `angle` about the unit vector `axis` (Rodrigues).
#[cfg(feature = "urdf")]
pub(crate) fn rotation_about(axis: Vec3, angle: f64) -> Mat3 {
    let (s, c) = libm::sincos(angle);
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for k in 0..3 {
            out[i][k] = (1.0 - c) * axis[i] * axis[k];
        }
        out[i][i] += c;
    }
    let [x, y, z] = axis;
    out[0][1] -= s * z;
    out[0][2] += s * y;
    out[1][0] += s * z;
    out[1][2] -= s * x;
    out[2][0] -= s * y;
    out[2][1] += s * x;
    out
}
