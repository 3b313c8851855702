#include "stability/stable_step.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <sstream>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/files/log.h"
#include "stability/difference_operators.h"

namespace floe {
namespace {

using Vector = Eigen::VectorXd;

/// A trial vector z and its images k = K z, c = C z.
struct Trial {
  Vector z, k, c;  ///< c is empty if no force damps
  /// Rounding of the images, as a multiple of that of images that were measured at unit length.
  double error = 1;
  void scale(double s) { z *= s, k *= s, c *= s, error *= std::abs(s); }
  void add(double s, const Trial& other) {
    z += s * other.z, k += s * other.k, c += s * other.c;
    error = std::hypot(error, s * other.error);
  }
  Vector image(const Weights& weights) const {
    if (c.size() == 0) return weights.stiffness * k;
    return weights.stiffness * k + weights.damping * c;
  }
};

/// Returns the largest eigenvalue of w_k K + w_c C in a small orthonormal space, and its vector.
std::pair<double, Vector> largest(const Eigen::MatrixXd& k, const Eigen::MatrixXd& c,
                                  const Weights& weights) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(weights.stiffness * k +
                                                              weights.damping * c);
  return {solver.eigenvalues()[k.rows() - 1], solver.eigenvectors().col(k.rows() - 1)};
}

/// Search for leapfrog's stable step: the dt at which the largest eigenvalue of dt^2 K + 2 dt C is
/// 4.
class CriticalStep {
 public:
  /// Starts from a vector with x.Kx and x.Cx; false if no force acts on the vector.
  bool begin(double k, double c) {
    if (k <= 0 && c <= 0) return false;
    value_ = k > 0 ? (std::sqrt(c * c + 4 * k) - c) / k : 2 / c;  // dt^2 k + 2 dt c = 4
    return true;
  }
  double value() const { return value_; }
  double size() const { return value_; }
  Weights weights() const { return weights(value_); }
  /// Solves for dt in a small space, by bisection, since the eigenvalue grows with dt.
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

/// Search for the largest eigenvalue of given weights.
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
  static constexpr double smallest = 1e-3;  // for weights that make eigenvalues of about 1
  Weights weights_;
  double value_ = 0;
};

/// Describes the body that moves most in a mode, and whether it shifts or turns.
template <class Space>
std::string describe(const Operators<Space>& a, const Model<Space>& model, const Vector& z) {
  constexpr int n = Space::unknowns;
  const MPI_Comm comm = model.part().comm;
  RankedValue mine{-1, rank(comm)};
  Eigen::Index at = 0;
  for (Eigen::Index b = 0; b < a.size() / n; ++b) {
    const double share = z.segment<n>(b * n).squaredNorm();
    if (share > mine.value) {
      mine.value = share;
      at = b;
    }
  }
  const RankedValue best = largest_of_ranks(mine, comm);
  std::array<double, 5> facts{};
  if (best.index == mine.index) {
    const auto b = static_cast<std::size_t>(at);
    const auto v = z.segment<n>(at * n);
    const Point3& x = model.part().bodies.position[b];
    facts = {static_cast<double>(model.part().global[b]), x[0], x[1], x[2],
             v.template head<Space::translations>().squaredNorm() <
                     v.template tail<n - Space::translations>().squaredNorm()
                 ? 1.0
                 : 0.0};
  }
  broadcast(facts, comm, best.index);
  std::ostringstream text;
  text << (facts[4] > 0.5 ? "turning" : "shifting") << " of body " << static_cast<long>(facts[0])
       << " at (" << facts[1] << ", " << facts[2] << ", " << facts[3] << ")";
  return text.str();
}

/// Random vector that depends on global indices, so that it is the same on any number of ranks.
template <class Space>
Vector random_vector(const Operators<Space>& a, const Part& part) {
  constexpr int n = Space::unknowns;
  Vector start(a.size());
  for (std::int32_t b = 0; b < part.owned; ++b) {
    std::minstd_rand random(static_cast<unsigned>(item(part.global, b)) + 1U);
    random.discard(3);
    for (int k = 0; k < n; ++k)
      start[b * n + k] =
          static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()) - 0.5;
  }
  return start;
}

/// Finds the top mode of the combination that `search` weights, by locally optimal conjugate
/// gradients; empty if no force acts.
template <class Space>
std::optional<Trial> top_mode(Operators<Space>& a, Vector start, auto& search) {
  const auto make = [&](Vector z) {
    Trial t{std::move(z), {}, {}};
    a.apply(t.z, t.k, t.c);
    return t;
  };
  const auto along = [&](const Trial& u, const Trial& v) {
    return a.is_damped() ? a.dot(u.z, v.c) : 0.0;
  };
  start /= std::sqrt(a.dot(start, start));
  Trial x = make(std::move(start));
  Trial direction;
  constexpr int most = 400;
  Progress progress("stable step", 0);
  constexpr double converged = 1e-6;  // relative change of the value, three times in a row
  // The images of a direction that lies almost in the space of the others would be the rounding of
  // differences of forces, enlarged to a rate without any force behind it. Without rounding a
  // residual is at right angles to the last space, so only a search that has arrived loses such a
  // direction, or one whose start was far from the mode.
  constexpr double most_error = 1e3;
  int quiet = 0;
  for (int it = 0; it < most && quiet < 3; ++it) {
    if (it > 0) progress.update(it, "iteration " + std::to_string(it));
    if (it == 0 && !search.begin(a.dot(x.z, x.k), along(x, x))) return {};
    // Trials are moved, never copied: each takes 144 bytes per body.
    std::vector<Trial> space;
    space.reserve(3);
    space.push_back(std::move(x));
    const auto orthonormal = [&](Trial t) {
      for (int pass = 0; pass < 2; ++pass) {
        for (const Trial& s : space) t.add(-a.dot(s.z, t.z), s);
        const double norm = std::sqrt(a.dot(t.z, t.z));
        if (norm < 1e-12) return;
        t.scale(1 / norm);
      }
      if (t.error > most_error) return;
      space.push_back(std::move(t));
    };
    const Weights weights = search.weights();
    Vector residual = space[0].image(weights);
    const double size_of_image = std::sqrt(a.dot(residual, residual));
    residual -= a.dot(space[0].z, residual) * space[0].z;
    const double norm = std::sqrt(a.dot(residual, residual));
    // Images are differences, at best as exact as this. A model of few modes (one damped body among
    // others at rest) is through at once, and what is left is rounding.
    constexpr double rounding = 1e-10;
    if (norm < std::max(1e-12, rounding * size_of_image)) {
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
        const Trial &u = item(space, r), &v = item(space, s);
        k(r, s) = k(s, r) = 0.5 * (a.dot(u.z, v.k) + a.dot(v.z, u.k));
        c(r, s) = c(s, r) = 0.5 * (along(u, v) + along(v, u));
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
  result.decay = (a.is_damped() ? a.dot(mode->z, mode->c) : 0.0);
  result.evaluations = a.evaluations();
  result.limit = describe(a, model, mode->z);
  const auto& bound = a.bound();
  if (dt * dt * bound.stiffness > 2) result.limit = "contacts that may come";  // more than half
  if (result.dt * bound.damping > 2) {
    result.dt = 2 / bound.damping;
    result.limit = "dashpots of contacts that may come";
  }
  return result;
}

VibrationMode extreme_mode(const Model<Spatial>& model, const State<Spatial>& state,
                           const Weights& weights, const VibrationMode* start) {
  Operators<Spatial> a(model, state);
  Extreme search(weights);
  // A small random part is added, since the start may be the mode of other weights.
  Vector first = random_vector(a, model.part());
  first *= 0.1 / std::sqrt(a.dot(first, first));
  if (start) first += start->shape;
  const auto mode = top_mode(a, std::move(first), search);
  if (!mode) return {};
  return {
      search.value(),  a.dot(mode->z, mode->k),     (a.is_damped() ? a.dot(mode->z, mode->c) : 0.0),
      a.evaluations(), describe(a, model, mode->z), mode->z};
}

template StableStep stable_step(const Model<Spatial>&, const State<Spatial>&);
template StableStep stable_step(const Model<Planar>&, const State<Planar>&);

}  // namespace floe
