#include "solve/stable_step.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

namespace floe {
namespace {

using Vector = Eigen::VectorXd;

/// M^-1/2 K M^-1/2 and M^-1/2 C M^-1/2 on vectors of this rank's share of mass-weighted
/// coordinates.
class Operators {
 public:
  static constexpr int n = Spatial::unknowns;
  using Rates = Force<Spatial>::Rates;

  Operators(const Model<Spatial>& model, const State<Spatial>& state)
      : model_(model),
        part_(model.part()),
        base_(state),
        moved_(state),
        at_base_(static_cast<std::size_t>(part_.local)),
        forward_(at_base_),
        backward_(at_base_) {
    // Forces without the velocities of the moment: C is the derivative to them.
    for (std::size_t b = 0; b < static_cast<std::size_t>(part_.local); ++b)
      std::fill_n(base_.record(b) + Spatial::velocity, 9, 0.0);
    moved_ = base_;
    for (const auto& force : model.forces()) {
      bound_.stiffness += force->own_rates().stiffness;
      bound_.damping += force->own_rates().damping;
    }
    evaluate(base_, at_base_);
  }

  int evaluations() const { return evaluations_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(part_.owned) * n; }

  double dot(const Vector& a, const Vector& b) const {
    const double mine = a.dot(b);
    double all = 0;
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, part_.comm);
    return all;
  }

  /// World components of body b from mass-weighted ones along its principal axes, prescribed ones
  /// left out.
  std::array<double, 6> unweighted(const Vector& z, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    const double mass = std::sqrt(model_.inertial_mass()[b]);
    const Point3& inertia = part_.bodies.inertia[b];
    const auto i = static_cast<Eigen::Index>(body) * n;
    const Vec3<double> turn =
        axes(b).to_world({z[i + 3] / std::sqrt(inertia[0]), z[i + 4] / std::sqrt(inertia[1]),
                          z[i + 5] / std::sqrt(inertia[2])});
    std::array<double, 6> x{z[i] / mass, z[i + 1] / mass, z[i + 2] / mass, turn.x, turn.y, turn.z};
    for (std::size_t k = 0; k < 6; ++k) {
      if ((model_.prescribed()[b] >> k & 1U) != 0) x[k] = 0;
    }
    return x;
  }

  /// Stiffness and damping times z. Steps of the differences are 1e-6 of the length scale and of a
  /// radian.
  void apply(const Vector& z, Vector& stiffness, Vector& damping) {
    double mine = 0, largest = 0;
    for (std::int32_t b = 0; b < part_.owned; ++b) {
      const auto x = unweighted(z, b);
      for (std::size_t k = 0; k < 6; ++k)
        mine = std::max(mine, std::abs(x[k]) / (k < 3 ? model_.length_scale() : 1.0));
    }
    MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
    const double step = largest > 0 ? 1e-6 / largest : 0.0;
    displace(z, step, 0);
    evaluate(moved_, forward_);
    displace(z, -step, 0);
    evaluate(moved_, backward_);
    stiffness = weighted(forward_, backward_, step > 0 ? -0.5 / step : 0.0);
    displace(z, 0, 1);
    evaluate(moved_, forward_);
    damping = weighted(forward_, at_base_, -1.0);
    stiffness += bound_.stiffness * z;
    damping += bound_.damping * z;
  }
  /// Bounds of the forces whose differences are not taken.
  const Rates& bound() const { return bound_; }

 private:
  void evaluate(const State<Spatial>& state, Wrenches<Spatial>& wrenches) {
    std::fill(wrenches.values.begin(), wrenches.values.end(), 0.0);
    for (const auto& force : model_.forces()) {
      if (force->own_rates().stiffness == 0) force->add(state, wrenches);
    }
    ++evaluations_;
  }
  Triad<double> axes(std::size_t b) const {
    const auto [w, x, y, z] = part_.bodies.orientation[b];
    return triad(product(normalised(rotation(base_, b)), Quat<double>{w, x, y, z}));
  }

  void displace(const Vector& z, double by, double velocity) {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      const auto x = unweighted(z, body);
      double* r = moved_.record(b);
      std::copy_n(base_.record(b), Spatial::record, r);
      for (std::size_t k = 0; k < 3; ++k) r[k] += by * x[k];
      const Vec3<double> turn{by * x[3], by * x[4], by * x[5]};
      Quat<double> q = rotation(base_, b);
      if (model_.kinematics() == Kinematics::linear) {
        q = {1, q.x + 0.5 * turn.x, q.y + 0.5 * turn.y, q.z + 0.5 * turn.z};
      } else {
        q = product(exp_rotation(turn), q);
      }
      r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
      for (std::size_t k = 0; k < 6; ++k)
        r[static_cast<std::size_t>(Spatial::velocity) + k] = velocity * x[k];
    }
    part_.ghosts.update(moved_.records, Spatial::record);
  }

  /// factor M^-1/2 (a - b), prescribed components left out.
  Vector weighted(const Wrenches<Spatial>& a, const Wrenches<Spatial>& b, double factor) const {
    Vector y(size());
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto index = static_cast<std::size_t>(body);
      std::array<double, 6> f{};
      for (std::size_t k = 0; k < 6; ++k) {
        if ((model_.prescribed()[index] >> k & 1U) == 0)
          f[k] = factor * (a.of(index)[k] - b.of(index)[k]);
      }
      const Vec3<double> moment = axes(index).to_local({f[3], f[4], f[5]});
      const double mass = std::sqrt(model_.inertial_mass()[index]);
      const Point3& inertia = part_.bodies.inertia[index];
      const auto i = static_cast<Eigen::Index>(body) * n;
      y[i] = f[0] / mass, y[i + 1] = f[1] / mass, y[i + 2] = f[2] / mass;
      y[i + 3] = moment.x / std::sqrt(inertia[0]), y[i + 4] = moment.y / std::sqrt(inertia[1]);
      y[i + 5] = moment.z / std::sqrt(inertia[2]);
    }
    return y;
  }

  const Model<Spatial>& model_;
  const Part& part_;
  State<Spatial> base_, moved_;
  Wrenches<Spatial> at_base_, forward_, backward_;
  Rates bound_;
  int evaluations_ = 0;
};

/// A trial vector with its images.
struct Trial {
  Vector z, k, c;
  void scale(double s) { z *= s, k *= s, c *= s; }
  void add(double s, const Trial& other) { z += s * other.z, k += s * other.k, c += s * other.c; }
};

/// Largest eigenvalue of dt^2 K + 2 dt C in a small orthonormal space, with its vector.
std::pair<double, Vector> largest(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c, double dt) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dt * dt * k + 2 * dt * c);
  return {solver.eigenvalues()[k.rows() - 1], solver.eigenvectors().col(k.rows() - 1)};
}

/// The dt at which that eigenvalue is 4, by bisection: it grows with dt.
double critical(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c, double guess) {
  double low = 0, high = guess;
  while (largest(k, c, high).first < 4) {
    low = high;
    high *= 2;
  }
  for (int it = 0; it < 60 && high - low > 1e-13 * high; ++it) {
    const double middle = 0.5 * (low + high);
    (largest(k, c, middle).first < 4 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The body that moves most in a mode, and whether it moves or turns.
std::string describe(const Operators& a, const Model<Spatial>& model, const Vector& z) {
  struct {
    double value = -1;
    int rank = 0;
  } mine, best;
  Eigen::Index at = 0;
  for (Eigen::Index b = 0; b < a.size() / Operators::n; ++b) {
    const double share = z.segment<6>(b * Operators::n).squaredNorm();
    if (share > mine.value) {
      mine.value = share;
      at = b;
    }
  }
  const MPI_Comm comm = model.part().comm;
  MPI_Comm_rank(comm, &mine.rank);
  MPI_Allreduce(&mine, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  std::array<double, 5> facts{};
  if (best.rank == mine.rank) {
    const auto b = static_cast<std::size_t>(at);
    const auto v = z.segment<6>(at * Operators::n);
    const Point3& x = model.part().bodies.position[b];
    facts = {static_cast<double>(model.part().global[b]), x[0], x[1], x[2],
             v.head<3>().squaredNorm() < v.tail<3>().squaredNorm() ? 1.0 : 0.0};
  }
  MPI_Bcast(facts.data(), 5, MPI_DOUBLE, best.rank, comm);
  std::ostringstream text;
  text << (facts[4] > 0.5 ? "turning" : "shifting") << " of body " << static_cast<long>(facts[0])
       << " at (" << facts[1] << ", " << facts[2] << ", " << facts[3] << ")";
  return text.str();
}

}  // namespace

StableStep stable_step(const Model<Spatial>& model, const State<Spatial>& state) {
  Operators a(model, state);
  const auto make = [&](Vector z) {
    Trial t{std::move(z), {}, {}};
    a.apply(t.z, t.k, t.c);
    return t;
  };
  // The same start on any number of ranks: by global index.
  Vector start(a.size());
  for (std::int32_t b = 0; b < model.part().owned; ++b) {
    std::minstd_rand random(
        static_cast<unsigned>(model.part().global[static_cast<std::size_t>(b)]) + 1U);
    random.discard(3);
    for (int k = 0; k < Operators::n; ++k)
      start[b * Operators::n + k] =
          static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()) - 0.5;
  }
  start /= std::sqrt(a.dot(start, start));
  Trial x = make(std::move(start));
  Trial direction;
  StableStep result;
  double dt = 0;
  constexpr int most = 400;
  constexpr double converged = 1e-6;  // relative change of dt, three times in a row
  int quiet = 0;
  for (int it = 0; it < most && quiet < 3; ++it) {
    const double kx = a.dot(x.z, x.k), cx = a.dot(x.z, x.c);
    if (it == 0) {
      if (kx <= 0 && cx <= 0) {
        result.dt = std::numeric_limits<double>::infinity();  // nothing acts
        return result;
      }
      // dt^2 k + 2 dt c = 4
      dt = kx > 0 ? (std::sqrt(cx * cx + 4 * kx) - cx) / kx : 2 / cx;
    }
    std::vector<Trial> space;
    space.push_back(x);
    const auto orthonormal = [&](Trial t) {
      for (int pass = 0; pass < 2; ++pass) {
        for (const Trial& s : space) t.add(-a.dot(s.z, t.z), s);
        const double norm = std::sqrt(a.dot(t.z, t.z));
        if (norm < 1e-12) return;
        t.scale(1 / norm);
      }
      space.push_back(std::move(t));
    };
    Vector residual = dt * dt * x.k + 2 * dt * x.c;
    residual -= a.dot(x.z, residual) * x.z;
    const double norm = std::sqrt(a.dot(residual, residual));
    if (norm < 1e-12) break;
    residual /= norm;
    orthonormal(make(std::move(residual)));
    if (direction.z.size() > 0) orthonormal(direction);

    const auto m = static_cast<Eigen::Index>(space.size());
    Eigen::MatrixXd k(m, m), c(m, m);
    for (Eigen::Index r = 0; r < m; ++r) {
      for (Eigen::Index s = 0; s <= r; ++s) {
        const Trial &u = space[static_cast<std::size_t>(r)],
                    &v = space[static_cast<std::size_t>(s)];
        k(r, s) = k(s, r) = 0.5 * (a.dot(u.z, v.k) + a.dot(v.z, u.k));
        c(r, s) = c(s, r) = 0.5 * (a.dot(u.z, v.c) + a.dot(v.z, u.c));
      }
    }
    const double next = critical(k, c, dt);
    const Vector y = largest(k, c, next).second;
    direction = space[1];
    direction.scale(y[1]);
    if (m > 2) direction.add(y[2], space[2]);
    x = space[0];
    x.scale(y[0]);
    x.add(1, direction);
    const double size = std::sqrt(a.dot(x.z, x.z));
    x.scale(1 / size);
    quiet = std::abs(next - dt) < converged * dt ? quiet + 1 : 0;
    dt = next;
  }
  result.dt = dt;
  result.omega = std::sqrt(std::max(0.0, a.dot(x.z, x.k)));
  result.decay = a.dot(x.z, x.c);
  result.evaluations = a.evaluations();
  result.limit = describe(a, model, x.z);
  if (dt * dt * a.bound().stiffness + 2 * dt * a.bound().damping > 2)  // more than half of 4
    result.limit = "contacts that may come";
  return result;
}

}  // namespace floe
