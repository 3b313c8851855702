#include "solve/stable_step.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <sstream>

namespace floe {
namespace {

using Vector = Eigen::VectorXd;

/// M^-1/2 K M^-1/2 and M^-1/2 C M^-1/2 on vectors of this rank's share of mass-weighted
/// coordinates.
template <class Space>
class Operators {
 public:
  static constexpr int n = Space::unknowns;
  using Components = std::array<double, static_cast<std::size_t>(n)>;
  using Rates = typename Force<Space>::Rates;

  Operators(const Model<Space>& model, const State<Space>& state)
      : model_(model),
        part_(model.part()),
        base_(state),
        moving_(state),
        moved_(state),
        at_rest_(static_cast<std::size_t>(part_.local)),
        forward_(at_rest_),
        backward_(at_rest_) {
    for (std::int32_t b = 0; b < part_.owned; ++b) roots_.push_back(roots(b));
    // Stiffness without the velocities of the moment, so that dashpots have no part in it.
    double fastest2 = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(part_.local); ++b) {
      double* v = base_.record(b) + Space::velocity;
      const Vec3<double> speed = velocity(base_, b);
      fastest2 = std::max(fastest2, floe::dot(speed, speed));
      std::fill_n(v, Space::record - Space::velocity, 0.0);
    }
    MPI_Allreduce(MPI_IN_PLACE, &fastest2, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
    speed_ = std::sqrt(fastest2);
    if (speed_ < slow) moving_ = base_;
    moved_ = base_;
    for (const auto& force : model.forces()) {
      bound_.stiffness += force->own_rates().stiffness;
      bound_.damping += force->own_rates().damping;
    }
    evaluate(base_, at_rest_);
  }

  int evaluations() const { return evaluations_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(part_.owned) * n; }

  double dot(const Vector& a, const Vector& b) const {
    const double mine = a.dot(b);
    double all = 0;
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, part_.comm);
    return all;
  }

  /// World components of body b from mass-weighted ones, those of rotations along its principal
  /// axes; prescribed ones left out.
  Components unweighted(const Vector& z, std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    const auto i = static_cast<Eigen::Index>(body) * n;
    const Components& root = roots_[b];
    Components x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = z[i + static_cast<Eigen::Index>(k)] / root[k];
    turn<true>(b, x);
    for (std::size_t k = 0; k < x.size(); ++k) {
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
      for (std::size_t k = 0; k < x.size(); ++k)
        mine = std::max(mine,
                        std::abs(x[k]) / (k < Space::translations ? model_.length_scale() : 1.0));
    }
    MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE, MPI_MAX, part_.comm);
    const double step = largest > 0 ? 1e-6 / largest : 0.0;
    displace(z, step, 0);
    evaluate(moved_, forward_);
    displace(z, -step, 0);
    evaluate(moved_, backward_);
    stiffness = weighted(forward_, backward_, step > 0 ? -0.5 / step : 0.0);
    difference_damping(z, step, damping);
    stiffness += bound_.stiffness * z;
    damping += bound_.damping * z;
  }
  /// Bounds of the forces whose differences are not taken.
  const Rates& bound() const { return bound_; }

 private:
  /// \param step  of displacements that are 1e-6 of the length scale and of a radian
  void difference_damping(const Vector& z, double step, Vector& damping) {
    if (speed_ < slow || step == 0) {
      displace(z, 0, 1);
      evaluate(moved_, forward_);
      damping = weighted(forward_, at_rest_, -1.0);
      return;
    }
    // About the velocities of the moment, on which quadratic drag depends: by 1e-3 of them to
    // either side, or the images of a search's vectors would not be those of one linear map.
    const double change = 1e3 * step * speed_ / model_.length_scale();
    displace(z, 0, change);
    evaluate(moved_, forward_);
    displace(z, 0, -change);
    evaluate(moved_, backward_);
    damping = weighted(forward_, backward_, -0.5 / change);
  }

  void evaluate(const State<Space>& state, Wrenches<Space>& wrenches) {
    std::fill(wrenches.values.begin(), wrenches.values.end(), 0.0);
    for (const auto& force : model_.forces()) {
      if (force->own_rates().stiffness == 0) force->add(state, wrenches);
    }
    ++evaluations_;
  }
  /// Rotation components from a body's principal axes to the world, or the other way. In the plane
  /// they are one and the same.
  template <bool to_world>
  void turn(std::size_t b, Components& x) const {
    if constexpr (std::is_same_v<Space, Spatial>) {
      const auto [w, qx, qy, qz] = part_.bodies.orientation[b];
      const Triad<double> axes =
          triad(product(normalised(rotation(base_, b)), Quat<double>{w, qx, qy, qz}));
      const Vec3<double> t{x[3], x[4], x[5]};
      const Vec3<double> turned = to_world ? axes.to_world(t) : axes.to_local(t);
      x[3] = turned.x, x[4] = turned.y, x[5] = turned.z;
    }
  }
  /// Square roots of the masses and of the moments of inertia.
  Components roots(std::int32_t body) const {
    const auto b = static_cast<std::size_t>(body);
    Components root;
    root.fill(std::sqrt(model_.inertial_mass()[b]));
    if constexpr (std::is_same_v<Space, Spatial>) {
      for (std::size_t k = 0; k < 3; ++k) root[3 + k] = std::sqrt(part_.bodies.inertia[b][k]);
    } else {
      root[2] = std::sqrt(inertia_about(part_.bodies, body, {0, 0, 1}));
    }
    return root;
  }
  /// Turns the rotation of a record.
  void turn_record(std::size_t b, const Components& x, double by, double* r) const {
    if constexpr (std::is_same_v<Space, Spatial>) {
      const Vec3<double> spin{by * x[3], by * x[4], by * x[5]};
      Quat<double> q = rotation(base_, b);
      if (model_.kinematics() == Kinematics::linear) {
        q = {1, q.x + 0.5 * spin.x, q.y + 0.5 * spin.y, q.z + 0.5 * spin.z};
      } else {
        q = product(exp_rotation(spin), q);
      }
      r[3] = q.w, r[4] = q.x, r[5] = q.y, r[6] = q.z;
    } else {
      r[Space::rotation] += by * x[2];
    }
  }

  void displace(const Vector& z, double by, double speed) {
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto b = static_cast<std::size_t>(body);
      const Components x = unweighted(z, body);
      double* r = moved_.record(b);
      std::copy_n(base_.record(b), Space::record, r);
      for (std::size_t k = 0; k < Space::translations; ++k) r[k] += by * x[k];
      turn_record(b, x, by, r);
      constexpr auto at = static_cast<std::size_t>(Space::velocity);
      for (std::size_t k = 0; k < x.size(); ++k)
        r[at + k] = speed != 0 ? moving_.record(b)[at + k] + speed * x[k] : 0.0;
    }
    part_.ghosts.update(moved_.records, Space::record);
  }

  /// factor M^-1/2 (a - b), prescribed components left out.
  Vector weighted(const Wrenches<Space>& a, const Wrenches<Space>& b, double factor) const {
    Vector y(size());
    for (std::int32_t body = 0; body < part_.owned; ++body) {
      const auto index = static_cast<std::size_t>(body);
      Components f{};
      for (std::size_t k = 0; k < f.size(); ++k) {
        if ((model_.prescribed()[index] >> k & 1U) == 0)
          f[k] = factor * (a.of(index)[k] - b.of(index)[k]);
      }
      turn<false>(index, f);
      for (std::size_t k = 0; k < f.size(); ++k)
        y[static_cast<Eigen::Index>(body) * n + static_cast<Eigen::Index>(k)] =
            f[k] / roots_[index][k];
    }
    return y;
  }

  const Model<Space>& model_;
  const Part& part_;
  static constexpr double slow = 1e-6;  // [m/s]: no quadratic drag to speak of
  State<Space> base_, moving_, moved_;
  Wrenches<Space> at_rest_, forward_, backward_;
  double speed_ = 0;
  Rates bound_;
  std::vector<Components> roots_;  ///< of owned bodies
  int evaluations_ = 0;
};

/// A trial vector with its images.
struct Trial {
  Vector z, k, c;
  void scale(double s) { z *= s, k *= s, c *= s; }
  void add(double s, const Trial& other) { z += s * other.z, k += s * other.k, c += s * other.c; }
};

/// Largest eigenvalue of w_k K + w_c C in a small orthonormal space, with its vector.
std::pair<double, Vector> largest(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c,
                                  const Weights& weights) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(weights.stiffness * k +
                                                              weights.damping * c);
  return {solver.eigenvalues()[k.rows() - 1], solver.eigenvectors().col(k.rows() - 1)};
}

/// Leapfrog's search: the dt at which the largest eigenvalue of dt^2 K + 2 dt C is 4.
class CriticalStep {
 public:
  /// From a vector with x.Kx and x.Cx; false if nothing acts on it.
  bool begin(double k, double c) {
    if (k <= 0 && c <= 0) return false;
    value_ = k > 0 ? (std::sqrt(c * c + 4 * k) - c) / k : 2 / c;  // dt^2 k + 2 dt c = 4
    return true;
  }
  double value() const { return value_; }
  double size() const { return value_; }
  Weights weights() const { return weights(value_); }
  /// In a small space, by bisection: the eigenvalue grows with dt.
  void improve(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c) {
    double low = 0, high = value_;
    while (largest(k, c, weights(high)).first < 4) {
      low = high;
      high *= 2;
    }
    for (int it = 0; it < 60 && high - low > 1e-13 * high; ++it) {
      const double middle = 0.5 * (low + high);
      (largest(k, c, weights(middle)).first < 4 ? low : high) = middle;
    }
    value_ = 0.5 * (low + high);
  }

 private:
  static Weights weights(double dt) { return {dt * dt, 2 * dt}; }
  double value_ = 0;
};

/// The largest eigenvalue of given weights.
class Extreme {
 public:
  explicit Extreme(const Weights& weights) : weights_(weights) {}
  bool begin(double k, double c) {
    value_ = weights_.stiffness * k + weights_.damping * c;
    return true;
  }
  double value() const { return value_; }
  double size() const { return std::max(std::abs(value_), smallest); }
  Weights weights() const { return weights_; }
  void improve(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c) {
    value_ = largest(k, c, weights_).first;
  }

 private:
  static constexpr double smallest = 1e-3;  // with weights that make sizes of about 1
  Weights weights_;
  double value_ = 0;
};

/// The body that moves most in a mode, and whether it moves or turns.
template <class Space>
std::string describe(const Operators<Space>& a, const Model<Space>& model, const Vector& z) {
  constexpr int n = Space::unknowns;
  struct {
    double value = -1;
    int rank = 0;
  } mine, best;
  Eigen::Index at = 0;
  for (Eigen::Index b = 0; b < a.size() / n; ++b) {
    const double share = z.segment<n>(b * n).squaredNorm();
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
    const auto v = z.segment<n>(at * n);
    const Point3& x = model.part().bodies.position[b];
    facts = {static_cast<double>(model.part().global[b]), x[0], x[1], x[2],
             v.template head<Space::translations>().squaredNorm() <
                     v.template tail<n - Space::translations>().squaredNorm()
                 ? 1.0
                 : 0.0};
  }
  MPI_Bcast(facts.data(), 5, MPI_DOUBLE, best.rank, comm);
  std::ostringstream text;
  text << (facts[4] > 0.5 ? "turning" : "shifting") << " of body " << static_cast<long>(facts[0])
       << " at (" << facts[1] << ", " << facts[2] << ", " << facts[3] << ")";
  return text.str();
}

/// The same vector on any number of ranks: by global index.
template <class Space>
Vector random_vector(const Operators<Space>& a, const Part& part) {
  constexpr int n = Space::unknowns;
  Vector start(a.size());
  for (std::int32_t b = 0; b < part.owned; ++b) {
    std::minstd_rand random(static_cast<unsigned>(part.global[static_cast<std::size_t>(b)]) + 1U);
    random.discard(3);
    for (int k = 0; k < n; ++k)
      start[b * n + k] =
          static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()) - 0.5;
  }
  return start;
}

/// Locally optimal conjugate gradients for the top mode of what `search` weights; empty if nothing
/// acts.
template <class Space>
std::optional<Trial> top_mode(Operators<Space>& a, Vector start, auto& search) {
  const auto make = [&](Vector z) {
    Trial t{std::move(z), {}, {}};
    a.apply(t.z, t.k, t.c);
    return t;
  };
  start /= std::sqrt(a.dot(start, start));
  Trial x = make(std::move(start));
  Trial direction;
  constexpr int most = 400;
  constexpr double converged = 1e-6;  // relative change of the value, three times in a row
  int quiet = 0;
  for (int it = 0; it < most && quiet < 3; ++it) {
    if (it == 0 && !search.begin(a.dot(x.z, x.k), a.dot(x.z, x.c))) return {};
    std::vector<Trial> space;  // trials are moved about, never copied: each is 144 bytes per body
    space.reserve(3);
    space.push_back(std::move(x));
    const auto orthonormal = [&](Trial t) {
      for (int pass = 0; pass < 2; ++pass) {
        for (const Trial& s : space) t.add(-a.dot(s.z, t.z), s);
        const double norm = std::sqrt(a.dot(t.z, t.z));
        if (norm < 1e-12) return;
        t.scale(1 / norm);
      }
      space.push_back(std::move(t));
    };
    const Weights weights = search.weights();
    Vector residual = weights.stiffness * space[0].k + weights.damping * space[0].c;
    residual -= a.dot(space[0].z, residual) * space[0].z;
    const double norm = std::sqrt(a.dot(residual, residual));
    if (norm < 1e-12) {
      x = std::move(space[0]);
      break;
    }
    residual /= norm;
    orthonormal(make(std::move(residual)));
    if (direction.z.size() > 0) orthonormal(std::move(direction));

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
    const double before = search.value();
    search.improve(k, c);
    const Vector y = largest(k, c, search.weights()).second;
    direction = std::move(space[1]);
    direction.scale(y[1]);
    if (m > 2) direction.add(y[2], space[2]);
    x = std::move(space[0]);
    x.scale(y[0]);
    x.add(1, direction);
    const double size = std::sqrt(a.dot(x.z, x.z));
    x.scale(1 / size);
    quiet = std::abs(search.value() - before) < converged * search.size() ? quiet + 1 : 0;
  }
  return x;
}

}  // namespace

template <class Space>
StableStep stable_step(const Model<Space>& model, const State<Space>& state) {
  Operators<Space> a(model, state);
  CriticalStep search;
  StableStep result;
  const auto mode = top_mode(a, random_vector(a, model.part()), search);
  if (!mode) {
    result.dt = std::numeric_limits<double>::infinity();
    return result;
  }
  const double dt = search.value();
  result.dt = dt;
  result.omega = std::sqrt(std::max(0.0, a.dot(mode->z, mode->k)));
  result.decay = a.dot(mode->z, mode->c);
  result.evaluations = a.evaluations();
  result.limit = describe(a, model, mode->z);
  if (dt * dt * a.bound().stiffness + 2 * dt * a.bound().damping > 2)  // more than half of 4
    result.limit = "contacts that may come";
  return result;
}

VibrationMode extreme_mode(const Model<Spatial>& model, const State<Spatial>& state,
                           const Weights& weights, const VibrationMode* start) {
  Operators<Spatial> a(model, state);
  Extreme search(weights);
  // A little of everything beside the mode to start from, which may be another's.
  Vector first = random_vector(a, model.part());
  first *= 0.1 / std::sqrt(a.dot(first, first));
  if (start) first += start->shape;
  const auto mode = top_mode(a, std::move(first), search);
  return {search.value(),  a.dot(mode->z, mode->k),     a.dot(mode->z, mode->c),
          a.evaluations(), describe(a, model, mode->z), mode->z};
}

template StableStep stable_step(const Model<Spatial>&, const State<Spatial>&);
template StableStep stable_step(const Model<Planar>&, const State<Planar>&);

}  // namespace floe
