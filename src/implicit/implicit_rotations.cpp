#include "implicit/implicit_rotations.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace floe {
namespace {

using Vector = ImplicitRotations<Spatial>::Vector;
using Matrix = ImplicitRotations<Spatial>::Matrix;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Matrix skew(const Vector& a) {
  Matrix s;
  s << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return s;
}

Quat<double> rotation_of(const double* record) {
  const double* q = record + Spatial::rotation;
  return {q[0], q[1], q[2], q[3]};
}

Matrix matrix_of(const Quat<double>& q) {
  const Triad<double> t = triad(q);
  Matrix r;
  r << t.e1.x, t.e2.x, t.e3.x, t.e1.y, t.e2.y, t.e3.y, t.e1.z, t.e2.z, t.e3.z;
  return r;
}

/// T(theta): maps a change of theta to the spin, in the frame in which a rotation exp(theta)
/// starts.
Matrix tangent_map(const Vector& theta) {
  const double angle2 = theta.squaredNorm(), angle = std::sqrt(angle2);
  // Below 0.01 rad the next terms of the series are below 1e-15.
  const bool small = angle < 1e-2;
  const double first = small ? 0.5 - angle2 / 24 + angle2 * angle2 / 720
                             : (1 - std::cos(angle)) / angle2,
               second = small ? 1.0 / 6 - angle2 / 120 + angle2 * angle2 / 5040
                              : (angle - std::sin(angle)) / (angle2 * angle);
  const Matrix s = skew(theta);
  return Matrix::Identity() + first * s + second * s * s;
}

TurnFrame frame_of(const Matrix& rows, const Matrix& columns) {
  TurnFrame frame{};
  Eigen::Map<RowMajor>(frame.rows.data()) = rows;
  Eigen::Map<RowMajor>(frame.columns.data()) = columns;
  return frame;
}

Matrix symmetric_part(const Matrix& a) { return 0.5 * (a + a.transpose()); }

}  // namespace

ImplicitRotations<Spatial>::ImplicitRotations(const Model<Spatial>& model)
    : model_(model),
      frames_(static_cast<std::size_t>(model.part().local), Frame::body),
      reference_(static_cast<std::size_t>(model.part().owned)) {
  const Part& part = model.part();
  constexpr std::uint8_t rotations = 0b111000;
  for (std::size_t b = 0; b < frames_.size(); ++b) {
    if (model.kinematics() == Kinematics::linear) {
      frames_[b] = Frame::small;
    } else if ((model.prescribed()[b] & rotations) != 0) {
      frames_[b] = Frame::world;
    }
  }
  for (std::size_t b = 0; b < reference_.size(); ++b) {
    const auto [w, x, y, z] = part.bodies.orientation[b];
    const Matrix axes = matrix_of({w, x, y, z});
    const Point3& principal = part.bodies.inertia[b];
    at_rest_.emplace_back(axes * Vector(principal.x, principal.y, principal.z).asDiagonal() *
                          axes.transpose());
  }
}

void ImplicitRotations<Spatial>::take(std::size_t b, const Vector& u, const Vector& v,
                                      double* record) const {
  double* q = record + Spatial::rotation;
  if (frames_[b] == Frame::small) {
    q[0] = 1;
    for (int k = 0; k < 3; ++k) q[1 + k] = 0.5 * u[k];
  } else {
    const Vector theta = increment(b, u);
    const Quat<double> turn = exp_rotation({theta[0], theta[1], theta[2]});
    const Quat<double>& from = reference_[b].q;
    const Quat<double> now =
        normalised(frames_[b] == Frame::body ? product(from, turn) : product(turn, from));
    q[0] = now.w, q[1] = now.x, q[2] = now.y, q[3] = now.z;
  }
  const Vector omega = to_world(b, record, v),
               momentum = to_world(b, record, inertia(b, record) * v);
  for (int k = 0; k < 3; ++k) {
    record[Spatial::angular_velocity + k] = omega[k];
    record[Spatial::angular_momentum + k] = momentum[k];
  }
}

void ImplicitRotations<Spatial>::rebase(std::size_t b, const Vector& u, const double* record) {
  if (frames_[b] != Frame::small) reference_[b] = {rotation_of(record), u};
}

std::vector<double> ImplicitRotations<Spatial>::references() const {
  std::vector<double> values;
  for (const auto& [q, u] : reference_)
    values.insert(values.end(), {q.w, q.x, q.y, q.z, u[0], u[1], u[2]});
  return values;
}

void ImplicitRotations<Spatial>::set_references(std::span<const double> values) {
  for (std::size_t b = 0; b < reference_.size(); ++b) {
    const double* r = &values[b * reference_size];
    reference_[b] = {{r[0], r[1], r[2], r[3]}, {r[4], r[5], r[6]}};
  }
}

Vector ImplicitRotations<Spatial>::to_frame(std::size_t b, const double* record,
                                            const Vector& world) const {
  if (frames_[b] != Frame::body) return world;
  return matrix_of(rotation_of(record)).transpose() * world;
}

Vector ImplicitRotations<Spatial>::to_world(std::size_t b, const double* record,
                                            const Vector& frame) const {
  if (frames_[b] != Frame::body) return frame;
  return matrix_of(rotation_of(record)) * frame;
}

/// J in the frame of the body's unknowns.
Matrix ImplicitRotations<Spatial>::inertia(std::size_t b, const double* record) const {
  if (frames_[b] != Frame::world) return at_rest_[b];
  const Matrix r = matrix_of(rotation_of(record));
  return r * at_rest_[b] * r.transpose();
}

Vector ImplicitRotations<Spatial>::inertia_moment(std::size_t b, const double* record,
                                                  const Vector& v, const Vector& a) const {
  const Matrix j = inertia(b, record);
  if (frames_[b] == Frame::small) return j * a;
  return j * a + v.cross(j * v);
}

Vector ImplicitRotations<Spatial>::acceleration(std::size_t b, const double* record,
                                                const Vector& v, const Vector& moment,
                                                Vector a) const {
  Matrix j = inertia(b, record);
  Vector right = moment;
  if (frames_[b] != Frame::small) right -= v.cross(j * v);
  for (int k = 0; k < 3; ++k) {
    if ((model_.prescribed()[b] >> (3 + k) & 1U) == 0) continue;
    const double scale = at_rest_[b].trace();  // rows in units of inertia
    j.row(k) = scale * Eigen::RowVector3d::Unit(k);
    right[k] = scale * a[k];
  }
  const Vector solved = j.partialPivLu().solve(right);
  for (int k = 0; k < 3; ++k) {
    if ((model_.prescribed()[b] >> (3 + k) & 1U) == 0) a[k] = solved[k];
  }
  return a;
}

double ImplicitRotations<Spatial>::kinetic(std::size_t b, const double* record,
                                           const Vector& v) const {
  return 0.5 * v.dot(inertia(b, record) * v);
}

TurnFrame ImplicitRotations<Spatial>::frame(std::size_t b, const double* record,
                                            const Vector& theta, bool symmetric) const {
  if (frames_[b] != Frame::body)
    return frame_of(Matrix::Identity(), symmetric ? Matrix::Identity() : tangent_map(theta));
  const Matrix e = matrix_of(rotation_of(record));
  return frame_of(e.transpose(), symmetric ? e : e * tangent_map(-theta));
}

TurnFrame ImplicitRotations<Spatial>::velocity_frame(std::size_t b, const double* record,
                                                     const Vector& theta, double by_velocity,
                                                     bool symmetric) const {
  if (frames_[b] != Frame::body) return frame_of(Matrix::Identity(), Matrix::Identity());
  const Matrix e = matrix_of(rotation_of(record));
  if (symmetric) return frame_of(e.transpose(), e);
  const Vector omega = Eigen::Map<const Vector>(record + Spatial::angular_velocity);
  return frame_of(e.transpose(), e - skew(omega) * e * tangent_map(-theta) / by_velocity);
}

Matrix ImplicitRotations<Spatial>::tangent(std::size_t b, const double* record, const Vector& theta,
                                           const Vector& v, const Vector& a, const Vector& moment,
                                           double by_velocity, double by_acceleration,
                                           bool symmetric) const {
  const Matrix j = inertia(b, record);
  if (frames_[b] == Frame::small) return by_acceleration * j;
  const Vector spin = j * v;
  const Matrix gyroscopic = by_velocity * (skew(v) * j - skew(spin));
  Matrix all = by_acceleration * j;
  if (symmetric) return all + symmetric_part(gyroscopic);
  all += gyroscopic;
  if (frames_[b] == Frame::body) return all - skew(moment) * tangent_map(-theta);
  // delta J = [phi] J - J [phi]
  const Matrix turning = j * skew(a) - skew(j * a) + skew(v) * (j * skew(v) - skew(spin));
  return all + turning * tangent_map(theta);
}

}  // namespace floe
