#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "lattice/pieces.h"
#include "model/model.h"

namespace floe {
namespace {

using Row = Eigen::Matrix<double, 1, 6>;

/// Orthonormal columns of six entries. Columns from `count` on are zero.
struct Basis {
  Eigen::Matrix<double, 6, 6> columns = Eigen::Matrix<double, 6, 6>::Zero();
  int count = 0;
};

/// A connected piece. row() gives how the unknowns of its bodies depend on the coefficients (t, r
/// radius) of a rigid motion of the piece.
class Piece {
 public:
  Piece(const Lattice& lattice, std::vector<std::int32_t> bodies, double gyration)
      : lattice_(lattice), bodies_(std::move(bodies)) {
    for (const std::int32_t b : bodies_) centre_ += position(b);
    centre_ /= static_cast<double>(bodies_.size());
    for (const std::int32_t b : bodies_)
      radius_ = std::max(radius_, (position(b) - centre_).norm());
    radius_ = std::max(radius_, gyration);
    gyration_ = gyration;
  }

  /// Change of component k (0..5) of a body, rotations as lengths, per unit of each coefficient.
  Row row(std::int32_t body, int k) const {
    Row r = Row::Zero();
    if (k >= 3) {
      r[k] = gyration_ / radius_;
      return r;
    }
    r[k] = 1;
    const Eigen::Vector3d arm = (position(body) - centre_) / radius_;
    const int a = (k + 1) % 3, b = (k + 2) % 3;  // (w x arm)_k = w_a arm_b - w_b arm_a
    r[3 + a] = arm[b];
    r[3 + b] = -arm[a];
    return r;
  }

  const std::vector<std::int32_t>& bodies() const { return bodies_; }
  Point3 centre() const { return {centre_.x(), centre_.y(), centre_.z()}; }
  double radius() const { return radius_; }

 private:
  Eigen::Vector3d position(std::int32_t b) const {
    const Point3& x = item(lattice_.bodies.position, b);
    return {x.x, x.y, x.z};
  }
  const Lattice& lattice_;
  std::vector<std::int32_t> bodies_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double radius_ = 0, gyration_ = 0;
};

/// Returns an orthonormal basis of the rigid motions that neither boundaries nor water hold.
Basis null_space(const Piece& piece, std::span<const std::uint8_t> held,
                 std::span<const std::uint8_t> floating) {
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  bool floats = false;
  for (const std::int32_t b : piece.bodies()) {
    for (int k = 0; k < 6; ++k) {
      if ((item(held, b) >> k & 1U) == 0) continue;
      const Row row = piece.row(b, k);
      gram += row.transpose() * row;
    }
    floats = floats || (!floating.empty() && item(floating, b) != 0);
  }
  if (floats) {
    for (const int k : {2, 3, 4}) gram(k, k) += static_cast<double>(piece.bodies().size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(gram);
  const double largest = solver.eigenvalues()[5];
  // Relative to squares: supports 1e-7 of the piece's size apart still hold the piece.
  constexpr double relative_zero = 1e-14;
  Basis basis;
  for (; basis.count < 6 && solver.eigenvalues()[basis.count] <= relative_zero * largest;
       ++basis.count)
    basis.columns.col(basis.count) = solver.eigenvectors().col(basis.count);
  return basis;
}

/// Pins one unknown per free motion: in each turn the unknown that the remaining motions move most.
void choose_pins(const Piece& piece, Basis basis, std::span<const std::uint8_t> held,
                 std::span<const std::uint8_t> avoid, std::vector<Pin>& pins) {
  // An avoided body is taken only where no other unknown moves nearly as much.
  constexpr double avoidance = 1e-6;
  while (basis.count > 0) {
    double best = 0;
    Pin pin{-1, 0};
    for (const std::int32_t b : piece.bodies()) {
      const auto body = static_cast<std::size_t>(b);
      for (int k = 0; k < 6; ++k) {
        if ((held[body] >> k & 1U) != 0) continue;
        const Row moved = piece.row(b, k) * basis.columns;
        double size2 = moved.dot(moved);
        if (!avoid.empty() && avoid[body] != 0) size2 *= avoidance;
        // The margin picks the first of equal unknowns, whatever the rounding.
        if (size2 > best * (1 + 1e-9)) {
          best = size2;
          pin = {b, k};
        }
      }
    }
    pins.push_back(pin);
    // Keep the motions that leave the pinned unknown at rest: a Householder reflection gathers all
    // motion of the pinned unknown in the first column, which is dropped.
    Row v = piece.row(pin.body, pin.component) * basis.columns;
    v[0] += std::copysign(std::sqrt(v.dot(v)), v[0]);
    const Eigen::Matrix<double, 6, 6> turned =
        basis.columns - (basis.columns * v.transpose()) * (2 / v.dot(v) * v);
    basis.columns.setZero();
    for (int m = 1; m < basis.count; ++m) basis.columns.col(m - 1) = turned.col(m);
    --basis.count;
  }
}

}  // namespace

FreeMotions free_motions(const Lattice& lattice, std::span<const std::uint8_t> held,
                         std::span<const std::uint8_t> floating,
                         std::span<const std::uint8_t> avoid) {
  FreeMotions free;
  free.piece = connected_pieces(lattice);
  std::map<std::int32_t, std::vector<std::int32_t>> pieces;
  for (std::size_t b = 0; b < free.piece.size(); ++b)
    pieces[free.piece[b]].push_back(static_cast<std::int32_t>(b));
  for (auto& [first, bodies] : pieces) {
    const auto b = static_cast<std::size_t>(first);
    const double gyration = std::sqrt(lattice.bodies.inertia[b][0] / lattice.bodies.mass[b]);
    const Piece piece(lattice, std::move(bodies), gyration);
    const Basis basis = null_space(piece, held, floating);
    for (int m = 0; m < basis.count; ++m) {
      FreeMotion motion{first, piece.centre(), piece.radius(), {}};
      for (int k = 0; k < 6; ++k) item(motion.coefficients, k) = basis.columns(k, m);
      free.motions.push_back(motion);
    }
    if (basis.count > 0) choose_pins(piece, basis, held, avoid, free.pins);
  }
  return free;
}

template <class Space>
void require_balance(const Model<Space>& model, const Lattice& lattice, const FreeMotions& free,
                     double time) {
  if (free.motions.empty()) return;
  const Part& part = model.part();
  State<Space> rest(static_cast<std::size_t>(part.local));
  rest.set_time(time);
  Wrenches<Space> wrenches(static_cast<std::size_t>(part.local));
  model.evaluate(rest, wrenches);

  // Work of the loads on the six rigid motions of each piece, and the sum of its absolute values,
  // the size against which the net work is compared.
  std::map<std::int32_t, std::size_t> slot;
  for (const FreeMotion& m : free.motions) slot.emplace(m.piece, slot.size());
  std::vector<const FreeMotion*> first(slot.size(), nullptr);
  for (const FreeMotion& m : free.motions) first[slot.at(m.piece)] = &m;
  std::vector<double> work(slot.size() * 12, 0.0);
  for (std::int32_t local = 0; local < part.owned; ++local) {
    const std::int32_t body = item(part.global, local);
    const auto found = slot.find(item(free.piece, body));
    if (found == slot.end()) continue;
    const FreeMotion& motion = *first[found->second];
    const std::array<double, 6> w = components_of(wrenches, static_cast<std::size_t>(local));
    const Vec3<double> arm = item(lattice.bodies.position, body) - motion.centre;
    const Vec3<double> moment = cross(arm, Vec3<double>{w[0], w[1], w[2]});
    const std::array<double, 6> share{w[0],
                                      w[1],
                                      w[2],
                                      (w[3] + moment.x) / motion.radius,
                                      (w[4] + moment.y) / motion.radius,
                                      (w[5] + moment.z) / motion.radius};
    for (std::size_t k = 0; k < 6; ++k) {
      work[12 * found->second + k] += share[k];
      work[12 * found->second + 6 + k] += std::abs(share[k]);
    }
  }
  sum_over_ranks(std::span(work), part.comm);

  for (const FreeMotion& m : free.motions) {
    const double* sums = &work[12 * slot.at(m.piece)];
    double net = 0, size = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      net += m.coefficients[k] * sums[k];
      size += std::abs(m.coefficients[k]) * sums[6 + k];
    }
    constexpr double rounding = 1e-9;
    if (std::abs(net) <= rounding * size) continue;
    const auto largest =
        std::max_element(m.coefficients.begin(), m.coefficients.end(),
                         [](double a, double b) { return std::abs(a) < std::abs(b); });
    constexpr std::array<const char*, 6> names{"translation along x", "translation along y",
                                               "translation along z", "rotation about x",
                                               "rotation about y",    "rotation about z"};
    throw InputError(std::string("boundary: nothing holds ") +
                     item(names, largest - m.coefficients.begin()) + " of the piece with body " +
                     std::to_string(m.piece) +
                     ", but the loads push it; prescribe that motion with `fix`");
  }
}

template void require_balance(const Model<Spatial>&, const Lattice&, const FreeMotions&, double);
template void require_balance(const Model<Planar>&, const Lattice&, const FreeMotions&, double);

}  // namespace floe
