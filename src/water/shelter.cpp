#include "water/shelter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/lattice/state.h"

namespace floe {
namespace {

/// Bodies move by less than this part of the distance until faces are found anew.
constexpr double share = 0.1;
/// Speed that bodies at rest may reach until then [m/s], for a distance of 1 m: that of a fall
/// through it, sqrt(g 1 m).
constexpr double fall = 3.13;

Vec3<double> corner(const Shapes& shapes, std::int32_t c) {
  return item(shapes.vertices, item(shapes.corners, c));
}

}  // namespace

std::vector<Vec3<double>> face_normals(const Shapes& shapes) {
  std::vector<Vec3<double>> normals;
  for (std::size_t f = 0; f + 1 < shapes.corner_of.size(); ++f) {
    Vec3<double> twice{};
    const Vec3<double> first = corner(shapes, shapes.corner_of[f]);
    for (std::int32_t c = shapes.corner_of[f] + 1; c + 1 < shapes.corner_of[f + 1]; ++c)
      twice = twice + cross(corner(shapes, c) - first, corner(shapes, c + 1) - first);
    normals.push_back((1 / length(twice)) * twice);
  }
  return normals;
}

Shelter::Shelter(const Part& part, double distance) : part_(part), distance_(distance) {
  gather_shapes();
  normal_ = face_normals(shapes_);
  for (std::size_t f = 0; f + 1 < shapes_.corner_of.size(); ++f) {
    Vec3<double> sum{};
    for (std::int32_t c = shapes_.corner_of[f]; c < shapes_.corner_of[f + 1]; ++c)
      sum = sum + corner(shapes_, c);
    middle_.push_back((1.0 / (shapes_.corner_of[f + 1] - shapes_.corner_of[f])) * sum);
  }
  const auto bodies = static_cast<std::size_t>(shapes_.bodies());
  for (std::size_t b = 0; b < bodies; ++b) {
    double radius = 0;
    for (std::int32_t v = shapes_.vertex_of[b]; v < shapes_.vertex_of[b + 1]; ++v)
      radius = std::max(radius, length(item(shapes_.vertices, v)));
    radius_.push_back(radius);
  }
  choose_large();
  poses_.resize(bodies);
  cells_.reserve(bodies);
  const std::size_t faces =
      part.owned > 0
          ? static_cast<std::size_t>(part.shapes.face_of[static_cast<std::size_t>(part.owned)])
          : 0;
  joined_.assign(faces, 0);
  near_.assign(faces, 0);
  gather_poses(State<Spatial>(static_cast<std::size_t>(part.local)));
  join_faces();
  if (renews()) find_near();
}

/// The few bodies that are far larger than the mean are in no cell: cells of their size would hold
/// too many of the others.
void Shelter::choose_large() {
  constexpr double far_larger = 4;
  double sum = 0;
  const auto bodies = static_cast<double>(
      std::count_if(radius_.begin(), radius_.end(), [](double radius) { return radius > 0; }));
  for (const double radius : radius_) sum += radius;
  for (std::size_t b = 0; b < radius_.size(); ++b) {
    if (radius_[b] * bodies > far_larger * sum)
      large_.push_back(static_cast<std::int32_t>(b));
    else
      widest_ = std::max(widest_, radius_[b]);
  }
}

/// Gives every rank the shapes of all bodies.
void Shelter::gather_shapes() {
  std::vector<double> mine;
  const Shapes& own = part_.shapes;
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    mine.push_back(part_.global[b]);
    mine.push_back(own.vertex_of[b + 1] - own.vertex_of[b]);
    for (std::int32_t v = own.vertex_of[b]; v < own.vertex_of[b + 1]; ++v) {
      const Point3& p = item(own.vertices, v);
      mine.insert(mine.end(), {p.x, p.y, p.z});
    }
    mine.push_back(own.face_of[b + 1] - own.face_of[b]);
    for (std::int32_t f = own.face_of[b]; f < own.face_of[b + 1]; ++f) {
      const std::int32_t begin = item(own.corner_of, f), end = item(own.corner_of, f + 1);
      mine.push_back(end - begin);
      for (std::int32_t c = begin; c < end; ++c)
        mine.push_back(item(own.corners, c) - own.vertex_of[b]);
    }
  }
  const std::vector<double> all = all_gathered(mine, part_.comm);
  std::vector<std::size_t> start(static_cast<std::size_t>(part_.global_bodies));
  for (std::size_t k = 0; k < all.size();) {
    start[static_cast<std::size_t>(all[k])] = k + 1;
    k += 2 + 3 * static_cast<std::size_t>(all[k + 1]);
    const auto faces = static_cast<std::size_t>(all[k++]);
    for (std::size_t f = 0; f < faces; ++f) k += 1 + static_cast<std::size_t>(all[k]);
  }
  for (std::size_t k : start) {
    const std::int32_t base = shapes_.vertex_of.back();
    const auto number = [&] { return static_cast<std::int32_t>(all[k++]); };
    const std::int32_t vertices = number();
    for (std::int32_t v = 0; v < vertices; ++v, k += 3)
      shapes_.vertices.push_back({all[k], all[k + 1], all[k + 2]});
    shapes_.vertex_of.push_back(base + vertices);
    const std::int32_t faces = number();
    for (std::int32_t f = 0; f < faces; ++f) {
      const std::int32_t corners = number();
      for (std::int32_t c = 0; c < corners; ++c) shapes_.corners.push_back(base + number());
      shapes_.corner_of.push_back(static_cast<std::int32_t>(shapes_.corners.size()));
    }
    shapes_.face_of.push_back(shapes_.face_of.back() + faces);
  }
}

/// Finds the two faces that each beam joins: those that face each other best at rest. A beam
/// between bodies of which no two faces face each other joins none.
void Shelter::join_faces() {
  constexpr double facing = -0.9;  // cosine between the two normals
  for (const auto& [a, b] : part_.beams.bodies) {
    const std::array<std::int32_t, 2> local{a, b};
    const std::array<std::int32_t, 2> pair{item(part_.global, a), item(part_.global, b)};
    std::array<std::int32_t, 2> best{-1, -1};
    double least = std::numeric_limits<double>::infinity();
    const Pose &pa = item(poses_, pair[0]), &pb = item(poses_, pair[1]);
    const double size = item(radius_, pair[0]) + item(radius_, pair[1]);
    for (std::int32_t f = item(shapes_.face_of, pair[0]); f < item(shapes_.face_of, pair[0] + 1);
         ++f) {
      const Vec3<double> nf = rotate(pa.axes, item(normal_, f)),
                         cf = pa.at + rotate(pa.axes, item(middle_, f));
      for (std::int32_t g = item(shapes_.face_of, pair[1]); g < item(shapes_.face_of, pair[1] + 1);
           ++g) {
        const Vec3<double> ng = rotate(pb.axes, item(normal_, g)),
                           gap = (1 / size) * (pb.at + rotate(pb.axes, item(middle_, g)) - cf);
        if (dot(nf, ng) > facing) continue;
        const double miss = dot(nf + ng, nf + ng) + dot(gap, gap);
        if (miss < least) least = miss, best = {f, g};
      }
    }
    if (best[0] < 0) continue;
    for (std::size_t end = 0; end < 2; ++end) {
      if (local[end] >= part_.owned) continue;
      const std::int32_t face =
          best[end] - item(shapes_.face_of, pair[end]) + item(part_.shapes.face_of, local[end]);
      ++item(joined_, face);
      joints_.push_back({pair, face});
    }
  }
  std::sort(joints_.begin(), joints_.end(), [](const Joint& x, const Joint& y) {
    return std::pair(x.pair, x.face) < std::pair(y.pair, y.face);
  });
}

void Shelter::gather_poses(const State<Spatial>& state) {
  std::vector<double> mine;
  mine.reserve(static_cast<std::size_t>(part_.owned) * 9);
  for (std::size_t b = 0; b < static_cast<std::size_t>(part_.owned); ++b) {
    const Vec3<double> at = part_.bodies.position[b] + displacement(state, b);
    const auto [w, x, y, z] = part_.bodies.orientation[b];
    const Quat<double> q = normalised(product(rotation(state, b), Quat<double>{w, x, y, z}));
    const Vec3<double> v = velocity(state, b), turn = angular_velocity(state, b);
    const double speed = length(v) + length(turn) * item(radius_, part_.global[b]);
    mine.insert(mine.end(), {static_cast<double>(part_.global[b]), at.x, at.y, at.z, q.w, q.x, q.y,
                             q.z, speed});
  }
  const std::vector<double> all = all_gathered(mine, part_.comm);
  fastest_ = 0;
  for (std::size_t k = 0; k + 8 < all.size(); k += 9) {
    poses_[static_cast<std::size_t>(all[k])] = {{all[k + 1], all[k + 2], all[k + 3]},
                                                {all[k + 4], all[k + 5], all[k + 6], all[k + 7]}};
    fastest_ = std::max(fastest_, all[k + 8]);
  }
}

/// A cell is as wide as two of the widest bodies and the distance, so bodies that are near are in
/// neighbouring cells.
std::int64_t Shelter::cell_of(const Vec3<double>& at, int dx, int dy, int dz) const {
  const double width = 2 * widest_ + distance_;
  const auto index = [&](double x, int d) {
    constexpr double most = 1 << 20;
    return static_cast<std::int64_t>(std::clamp(std::floor(x / width) + d, -most, most - 1) + most);
  };
  return (index(at.x, dx) << 42) | (index(at.y, dy) << 21) | index(at.z, dz);
}

void Shelter::sort_cells() {
  cells_.clear();
  for (std::size_t b = 0; b < poses_.size(); ++b)
    if (radius_[b] > 0 && radius_[b] <= widest_)
      cells_.emplace_back(cell_of(poses_[b].at, 0, 0, 0), static_cast<std::int32_t>(b));
  std::sort(cells_.begin(), cells_.end());
}

/// Whether the ray from a point along a unit vector is in another body somewhere on its first
/// distance_.
bool Shelter::hits(std::int32_t other, const Vec3<double>& from, const Vec3<double>& along) const {
  const Pose& pose = item(poses_, other);
  const Vec3<double> gap = pose.at - from;
  const double reach = item(radius_, other) + distance_;
  if (dot(gap, gap) > reach * reach) return false;
  const Triad<double> axes = triad(pose.axes);
  const Vec3<double> start = axes.to_local(-gap), step = axes.to_local(along);
  double enters = -std::numeric_limits<double>::infinity(), leaves = -enters;
  for (std::int32_t f = item(shapes_.face_of, other); f < item(shapes_.face_of, other + 1); ++f) {
    const Vec3<double>& n = item(normal_, f);
    const double height = dot(n, start - corner(shapes_, item(shapes_.corner_of, f)));
    const double rate = dot(n, step);
    if (rate == 0) {
      if (height > 0) return false;
    } else if (rate < 0) {
      enters = std::max(enters, -height / rate);
    } else {
      leaves = std::min(leaves, -height / rate);
    }
  }
  return enters <= leaves && leaves > 0 && enters <= distance_;
}

bool Shelter::any_near(std::int32_t body, const Vec3<double>& from,
                       const Vec3<double>& along) const {
  for (const std::int32_t other : large_)
    if (other != body && hits(other, from, along)) return true;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        const std::int64_t cell = cell_of(from, dx, dy, dz);
        for (auto c = std::lower_bound(cells_.begin(), cells_.end(), std::pair{cell, 0});
             c != cells_.end() && c->first == cell; ++c) {
          if (c->second != body && hits(c->second, from, along)) return true;
        }
      }
    }
  }
  return false;
}

void Shelter::find_near() {
  sort_cells();
  for (std::int32_t b = 0; b < part_.owned; ++b) {
    const std::int32_t body = item(part_.global, b);
    const Pose& pose = item(poses_, body);
    const Triad<double> axes = triad(pose.axes);
    const std::int32_t offset = item(part_.shapes.face_of, b) - item(shapes_.face_of, body);
    for (std::int32_t f = item(shapes_.face_of, body); f < item(shapes_.face_of, body + 1); ++f) {
      item(near_, f + offset) = item(joined_, f + offset) == 0 &&
                                any_near(body, pose.at + axes.to_world(item(middle_, f)),
                                         axes.to_world(item(normal_, f)));
    }
  }
}

void Shelter::after_step(const State<Spatial>& state) {
  if (!renews() || state.time < next_) return;
  gather_poses(state);
  find_near();
  next_ = state.time + share * distance_ / (2 * fastest_ + fall * std::sqrt(distance_));
}

void Shelter::release(std::span<const std::array<std::int32_t, 2>> pairs) {
  std::vector<std::int32_t> mine;
  for (const auto& pair : pairs) mine.insert(mine.end(), pair.begin(), pair.end());
  const std::vector<std::int32_t> all = all_gathered(mine, part_.comm);
  for (std::size_t k = 0; k + 1 < all.size(); k += 2) {
    const std::array<std::int32_t, 2> pair{std::min(all[k], all[k + 1]),
                                           std::max(all[k], all[k + 1])};
    const auto at =
        std::lower_bound(joints_.begin(), joints_.end(), pair,
                         [](const Joint& joint, const auto& p) { return joint.pair < p; });
    for (auto j = at; j != joints_.end() && j->pair == pair; ++j) {
      --item(joined_, j->face);
      // The two bodies still touch; they are looked at again in time.
      if (renews() && item(joined_, j->face) == 0) item(near_, j->face) = 1;
    }
    joints_.erase(at, std::find_if(at, joints_.end(),
                                   [&](const Joint& joint) { return joint.pair != pair; }));
  }
}

void Shelter::persist(Archive& archive) {
  // A row of a body: for each of its faces joined + 2 near, four faces in a number.
  constexpr std::int32_t packed = 4;
  std::int32_t most = 0;
  for (std::int32_t b = 0; b < shapes_.bodies(); ++b)
    most = std::max(most, item(shapes_.face_of, b + 1) - item(shapes_.face_of, b));
  const std::int32_t width = (most + packed - 1) / packed;
  std::vector<std::int32_t> bodies;
  std::vector<double> rows(static_cast<std::size_t>(part_.owned * width), 0.0);
  const auto each = [&](auto&& work) {
    for (std::int32_t b = 0; b < part_.owned; ++b) {
      const std::int32_t first = item(part_.shapes.face_of, b);
      for (std::int32_t f = first; f < item(part_.shapes.face_of, b + 1); ++f)
        work(f, item(rows, b * width + (f - first) / packed), 8 * ((f - first) % packed));
    }
  };
  for (std::int32_t b = 0; b < part_.owned; ++b) bodies.push_back(b);
  each([&](std::int32_t f, double& number, std::int32_t shift) {
    number += std::ldexp(item(joined_, f) + 128.0 * item(near_, f), shift);
  });
  archive.common("shelter_next", next_);
  archive.rows("sheltered", bodies, rows, width);
  if (!archive.loading()) return;
  each([&](std::int32_t f, double& number, std::int32_t shift) {
    const auto bits = static_cast<std::uint64_t>(std::clamp(number, 0.0, 0x1p32 - 1)) >>
                      static_cast<unsigned>(shift);
    item(joined_, f) = bits & 0x7fU;
    item(near_, f) = bits >> 7U & 1U;
  });
}

}  // namespace floe
