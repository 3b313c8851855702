#include "lattice/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "lattice/permute.h"

namespace floe {
namespace {

/// Returns the bodies by their places across a direction in plan; nothing where strips along it
/// would be less than four bodies wide.
std::vector<std::int32_t> order_across(const std::vector<Point3>& places,
                                       const Vec3<double>& strips, int ranks) {
  constexpr double narrowest = 4;
  const double size = std::hypot(strips.x, strips.y);
  if (size == 0) return {};
  std::vector<double> across;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Point2 low{infinite, infinite}, high{-infinite, -infinite};  // along the strips, across them
  for (const Point3& p : places) {
    const double x = (strips.x * p.x + strips.y * p.y) / size,
                 y = (strips.x * p.y - strips.y * p.x) / size;
    across.push_back(y);
    low = {std::min(low[0], x), std::min(low[1], y)};
    high = {std::max(high[0], x), std::max(high[1], y)};
  }
  const double wide = high[1] - low[1],
               body = std::sqrt((high[0] - low[0]) * wide / static_cast<double>(places.size()));
  if (!(wide / ranks > narrowest * body)) return {};
  std::vector<std::int32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return item(across, a) < item(across, b);
  });
  return order;
}

/// Cuts an order of bodies in parts of equal numbers.
std::vector<std::int32_t> cut_by_number(const std::vector<std::int32_t>& order, int ranks) {
  const auto n = static_cast<std::int64_t>(order.size());
  std::vector<std::int32_t> owner(order.size());
  for (int r = 0; r < ranks; ++r) {
    for (std::int64_t k = n * r / ranks; k < n * (r + 1) / ranks; ++k)
      item(owner, item(order, k)) = r;
  }
  return owner;
}

/// Cuts an order of bodies in parts of equal loads: a body goes where the middle of its load lies.
/// Every part has a body at least.
std::vector<std::int32_t> cut_by_load(const std::vector<std::int32_t>& order,
                                      const std::vector<double>& loads, int ranks) {
  const auto n = static_cast<std::int64_t>(order.size());
  const double all = std::accumulate(loads.begin(), loads.end(), 0.0);
  std::vector<std::int32_t> owner(order.size());
  double before = 0;
  std::int64_t last = -1;
  for (std::int64_t k = 0; k < n; ++k) {
    const double load = item(loads, item(order, k));
    const auto wanted = static_cast<std::int64_t>(ranks * ((before + 0.5 * load) / all));
    before += load;
    const std::int64_t least = std::max<std::int64_t>({last, ranks - (n - k), 0});
    last = std::clamp(wanted, least, std::max(least, last + 1));
    item(owner, item(order, k)) = static_cast<std::int32_t>(last);
  }
  return owner;
}

/// Takes the vertices and faces away from bodies that no water reaches: forces see shapes for the
/// water only.
void empty_dry(Shapes& shapes, const std::vector<std::uint8_t>& dry) {
  if (shapes.empty()) return;
  Shapes kept;
  for (std::size_t b = 0; b < dry.size(); ++b) {
    const auto first = static_cast<std::int32_t>(kept.vertices.size());
    for (std::int32_t v = shapes.vertex_of[b]; v < shapes.vertex_of[b + 1] && dry[b] == 0; ++v)
      kept.vertices.push_back(item(shapes.vertices, v));
    for (std::int32_t f = shapes.face_of[b]; f < shapes.face_of[b + 1] && dry[b] == 0; ++f) {
      for (std::int32_t c = item(shapes.corner_of, f); c < item(shapes.corner_of, f + 1); ++c)
        kept.corners.push_back(item(shapes.corners, c) - shapes.vertex_of[b] + first);
      kept.corner_of.push_back(static_cast<std::int32_t>(kept.corners.size()));
    }
    kept.face_of.push_back(static_cast<std::int32_t>(kept.corner_of.size()) - 1);
    kept.vertex_of.push_back(static_cast<std::int32_t>(kept.vertices.size()));
  }
  shapes = std::move(kept);
}

}  // namespace

std::vector<std::int32_t> owners_by_load(const std::vector<Point3>& places,
                                         const std::vector<double>& loads, int ranks,
                                         const Vec3<double>& strips) {
  if (static_cast<std::size_t>(ranks) > places.size())
    throw InputError("mpiexec: " + std::to_string(ranks) + " ranks are more than the " +
                     std::to_string(places.size()) + " bodies of the scene");
  std::vector<std::int32_t> order = order_across(places, strips, ranks);
  if (order.empty()) order = hilbert_order(places);
  return loads.empty() ? cut_by_number(order, ranks) : cut_by_load(order, loads, ranks);
}

std::int32_t Part::local_index(std::int32_t global_body) const {
  return item(local_of_, global_body);
}

std::vector<std::int32_t> Part::localise(const std::vector<std::int32_t>& global_set) const {
  std::vector<std::int32_t> here;
  for (const std::int32_t body : global_set) {
    if (local_index(body) >= 0) here.push_back(local_index(body));
  }
  return here;
}

Part partition(const Lattice& lattice, MPI_Comm comm, const Vec3<double>& strips) {
  return partition(lattice, comm, owners_by_load(lattice.bodies.position, {}, size(comm), strips));
}

Part partition(const Lattice& lattice, MPI_Comm comm, const std::vector<std::int32_t>& owner) {
  const Timed timed(Event::partition);
  const int me = rank(comm), ranks = size(comm);
  const std::int32_t n = lattice.bodies.size();
  // Each rank's bodies are numbered in global order, rank after rank: local index and PETSc's block
  // row.
  std::vector<std::int32_t> count(static_cast<std::size_t>(ranks) + 1, 0), index(owner.size());
  for (std::size_t b = 0; b < owner.size(); ++b)
    index[b] = count[static_cast<std::size_t>(owner[b]) + 1]++;
  std::partial_sum(count.begin(), count.end(), count.begin());

  Part part;
  part.comm = comm;
  part.global_bodies = n;
  part.global_beams = lattice.beams.size();
  part.local_of_.assign(owner.size(), -1);
  for (std::int32_t b = 0; b < n; ++b) {
    if (item(owner, b) == me) part.global.push_back(b);
  }
  part.owned = static_cast<std::int32_t>(part.global.size());

  std::vector<std::int32_t> beams, ghosts;
  for (std::int32_t m = 0; m < lattice.beams.size(); ++m) {
    const auto [i, j] = item(lattice.beams.bodies, m);
    const bool own_i = item(owner, i) == me, own_j = item(owner, j) == me;
    if (!own_i && !own_j) continue;
    beams.push_back(m);
    part.counts_here.push_back(own_i);
    if (!own_i) ghosts.push_back(i);
    if (!own_j) ghosts.push_back(j);
  }
  std::sort(ghosts.begin(), ghosts.end(), [&](std::int32_t a, std::int32_t b) {
    return std::pair(item(owner, a), a) < std::pair(item(owner, b), b);
  });
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  std::vector<std::int32_t> ghost_owner, ghost_index;
  for (const std::int32_t b : ghosts) {
    ghost_owner.push_back(item(owner, b));
    ghost_index.push_back(item(index, b));
  }
  part.shapes = pick(lattice.shapes, part.global);
  if (!lattice.bodies.dry.empty()) empty_dry(part.shapes, pick(lattice.bodies.dry, part.global));
  part.global.insert(part.global.end(), ghosts.begin(), ghosts.end());
  part.local = static_cast<std::int32_t>(part.global.size());
  for (std::int32_t k = 0; k < part.local; ++k) {
    const auto b = static_cast<std::size_t>(item(part.global, k));
    part.local_of_[b] = k;
    part.row.push_back(item(count, owner[b]) + index[b]);
  }

  part.bodies = pick(lattice.bodies, part.global);
  part.beams = pick(lattice.beams, beams);
  for (auto& pair : part.beams.bodies)
    pair = {part.local_index(pair[0]), part.local_index(pair[1])};
  part.global_beam = std::move(beams);
  part.ghosts = Ghosts(comm, part.owned, ghost_owner, ghost_index);
  return part;
}

}  // namespace floe
