// The pair list: eligibility, neighbours, and the histories of the pairs that stay in the list.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/union_find.h"
#include "contact/broad_phase.h"
#include "contact/contacts.h"
#include "contact/separation.h"

namespace floe {
namespace {

/// The least extent of a polyhedron along the normals of its faces [m]; infinite without vertices.
double least_width(std::span<const Vec3<double>> vertices, std::span<const HalfSpace> planes) {
  double least = std::numeric_limits<double>::infinity();
  if (vertices.empty()) return least;
  for (const HalfSpace& plane : planes) {
    double low = plane.offset;
    for (const Vec3<double>& r : vertices) low = std::min(low, dot(plane.normal, r));
    least = std::min(least, plane.offset - low);
  }
  return least;
}

/// Area of all faces of a body and of the largest one [m^2].
std::array<double, 2> face_areas(const Shapes& shapes, std::int32_t body) {
  const auto b = static_cast<std::size_t>(body);
  std::array<double, 2> areas{};
  for (auto f = static_cast<std::size_t>(shapes.face_of[b]);
       f < static_cast<std::size_t>(shapes.face_of[b + 1]); ++f) {
    const auto at = [&](std::int32_t c) {
      const Point3& p =
          shapes.vertices[static_cast<std::size_t>(shapes.corners[static_cast<std::size_t>(c)])];
      return Vec3<double>{p[0], p[1], p[2]};
    };
    const std::int32_t begin = shapes.corner_of[f];
    Vec3<double> twice{};
    for (std::int32_t c = begin + 1; c + 1 < shapes.corner_of[f + 1]; ++c)
      twice = twice + cross(at(c) - at(begin), at(c + 1) - at(begin));
    areas[0] += 0.5 * length(twice);
    areas[1] = std::max(areas[1], 0.5 * length(twice));
  }
  return areas;
}

}  // namespace

Contacts::Contacts(const Shapes& shapes, std::span<const double> masses,
                   std::vector<std::array<std::int32_t, 2>> joined, const ContactOptions& options,
                   std::vector<Obstacle> obstacles)
    : shapes_(shapes),
      joined_(std::move(joined)),
      options_(options),
      obstacles_(std::move(obstacles)),
      at_rest_(options.initial_overlap == InitialOverlap::stress_free),
      obstacles_at_(obstacles_.size()),
      on_obstacle_(obstacles_.size()) {
  for (std::int32_t b = 0; b < shapes_.bodies(); ++b) {
    const auto body = static_cast<std::size_t>(b);
    add_solid(b, masses[body]);
    const auto [all, widest] = face_areas(shapes_, b);
    surface_.push_back(all);
    widest_.push_back(widest);
    faces_.push_back(shapes_.face_of[body + 1] - shapes_.face_of[body]);
  }
  // The reach lasts a few hundred steps of slow bodies without listing many more pairs.
  constexpr double part_of_radius = 0.15;
  double mean = 0;
  for (const Solid& s : solids_) mean += s.radius / static_cast<double>(solids_.size());
  reach_ = part_of_radius * mean;
  for (const Solid& s : solids_) thinnest_ = std::min(thinnest_, s.width);
  for (const Obstacle& o : obstacles_) {
    obstacle_radius_.push_back(o.radius());
    obstacle_width_.push_back(least_width(o.vertices, o.planes));
    thinnest_ = std::min(thinnest_, obstacle_width_.back());
  }
  find_pieces();
}

void Contacts::add_solid(std::int32_t body, double mass) {
  const auto b = static_cast<std::size_t>(body);
  const auto first_vertex = static_cast<std::int32_t>(vertices_.size());
  const auto first_plane = static_cast<std::int32_t>(planes_.size());
  double radius = 0;
  for (auto v = static_cast<std::size_t>(shapes_.vertex_of[b]);
       v < static_cast<std::size_t>(shapes_.vertex_of[b + 1]); ++v) {
    const Point3& p = shapes_.vertices[v];
    vertices_.push_back({p[0], p[1], p[2]});
    radius = std::max(radius, length(vertices_.back()));
  }
  append_half_spaces(shapes_, body, planes_);
  solids_.push_back({first_vertex, static_cast<std::int32_t>(vertices_.size()) - first_vertex,
                     first_plane, static_cast<std::int32_t>(planes_.size()) - first_plane,
                     std::cbrt(volume_properties(shapes_, body).volume), mass, radius, 0});
  solids_.back().width = least_width(vertices(body), planes(body));
}

std::span<const Vec3<double>> Contacts::vertices(std::int32_t body) const {
  if (body < 0) return obstacles_[static_cast<std::size_t>(-1 - body)].vertices;
  const Solid& s = solids_[static_cast<std::size_t>(body)];
  return {vertices_.data() + s.first_vertex, static_cast<std::size_t>(s.vertices)};
}

std::span<const HalfSpace> Contacts::planes(std::int32_t body) const {
  if (body < 0) return obstacles_[static_cast<std::size_t>(-1 - body)].planes;
  const Solid& s = solids_[static_cast<std::size_t>(body)];
  return {planes_.data() + s.first_plane, static_cast<std::size_t>(s.planes)};
}

Contacts::Placed Contacts::at_time(std::int32_t obstacle, double position, double motion) const {
  const Obstacle& o = obstacles_[static_cast<std::size_t>(-1 - obstacle)];
  return {o.point + o.motion.way(position), triad(o.motion.turn(position)), o.motion.rate(motion),
          o.motion.spin(motion)};
}

void Contacts::release(std::array<std::int32_t, 2> pair) {
  if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  const auto at = std::lower_bound(joined_.begin(), joined_.end(), pair);
  if (at == joined_.end() || *at != pair) return;  // released before
  joined_.erase(at);
  released_.push_back(pair);
  changed_ = true;
}

/// Finds the pieces that beams join (named by their smallest body), and the bodies on the surfaces
/// of pieces: those that have fewer beams than a prism has sides, or that have lost a beam.
void Contacts::find_pieces() {
  const auto n = static_cast<std::size_t>(shapes_.bodies());
  std::vector<std::int32_t> beams(n, 0);
  UnionFind pieces(n);
  for (const auto& [a, b] : joined_) {
    ++beams[static_cast<std::size_t>(a)];
    ++beams[static_cast<std::size_t>(b)];
    pieces.unite(a, b);
  }
  piece_ = pieces.representatives();
  pieces_ = 0;
  for (std::size_t b = 0; b < n; ++b) pieces_ += piece_[b] == static_cast<std::int32_t>(b) ? 1 : 0;
  outer_.resize(n);
  for (std::size_t b = 0; b < n; ++b) outer_[b] = beams[b] < faces_[b] - 2 ? 1 : 0;
  for (const auto& [a, b] : released_)
    outer_[static_cast<std::size_t>(a)] = outer_[static_cast<std::size_t>(b)] = 1;
}

/// Bodies of different pieces may touch. Bodies of one piece may touch if both are on its surface
/// and no beam joins them.
bool Contacts::may_touch(std::int32_t a, std::int32_t b) const {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if (piece_[i] != piece_[j]) return true;
  return on_surface(a) && on_surface(b) &&
         !std::binary_search(joined_.begin(), joined_.end(), BodyPair{a, b});
}

void Contacts::build(std::span<const Pose> poses, std::span<const std::uint8_t> here, double time) {
  if (changed_) find_pieces();
  std::vector<Placed> placed;
  placed.reserve(poses.size());
  for (const Pose& p : poses) placed.push_back({p.x, triad(p.q)});
  pairs_.clear();
  list_bodies(placed, here);
  list_obstacles(placed, here, time);
  std::sort(pairs_.begin(), pairs_.end(),
            [](const Pair& p, const Pair& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  taken_on_.clear();
  find_involved();
  take_histories();
  some_newly_eligible_ =
      std::any_of(pairs_.begin(), pairs_.end(), [](const Pair& p) { return p.newly_eligible; });
  active_.clear();
  changed_ = first_ = false;
}

void Contacts::find_involved() {
  involved_.clear();
  for (const std::vector<Pair>* list : {&pairs_, &taken_on_}) {
    for (const Pair& p : *list) {
      involved_.push_back(p.a);
      if (p.b >= 0) involved_.push_back(p.b);
    }
  }
  std::sort(involved_.begin(), involved_.end());
  involved_.erase(std::unique(involved_.begin(), involved_.end()), involved_.end());
  const auto slot = [&](std::int32_t body) {
    return static_cast<std::int32_t>(std::lower_bound(involved_.begin(), involved_.end(), body) -
                                     involved_.begin());
  };
  for (std::vector<Pair>* list : {&pairs_, &taken_on_}) {
    for (Pair& p : *list) {
      p.slot_a = slot(p.a);
      p.slot_b = p.b >= 0 ? slot(p.b) : -1;
    }
  }
  placed_.resize(involved_.size());
  placed_before_ = false;
}

std::vector<BodyPair> Contacts::offload(std::size_t count) {
  std::vector<BodyPair> keys;
  for (std::size_t k = histories_.size() - std::min(count, histories_.size());
       k < histories_.size(); ++k) {
    keys.push_back({histories_[k].a, histories_[k].b});
    pairs_[static_cast<std::size_t>(histories_[k].pair)].offloaded = true;
  }
  return keys;
}

void Contacts::take_on(std::span<const BodyPair> pairs) {
  taken_on_.clear();
  for (const auto& [a, b] : pairs) taken_on_.push_back({a, b, -1, -1, false, false, false, {}, 0});
  find_involved();
}

void Contacts::list_bodies(std::span<const Placed> placed, std::span<const std::uint8_t> here) {
  std::vector<Vec3<double>> centres;
  centres.reserve(placed.size());
  for (const Placed& p : placed) centres.push_back(p.x);
  std::vector<BodyPair> near;
  std::vector<double> radii;
  radii.reserve(solids_.size());
  for (const Solid& s : solids_) radii.push_back(s.radius);
  if (pieces_ == 1) {  // an intact sheet: only bodies on its surface may touch
    for (std::int32_t b = 0; b < shapes_.bodies(); ++b) {
      if (!on_surface(b)) radii[static_cast<std::size_t>(b)] = -1;
    }
  }
  near_pairs(centres, radii, reach_, here, near);
  for (const auto& [a, b] : near) {
    if (may_touch(a, b))
      list(a, b, placed[static_cast<std::size_t>(a)], placed[static_cast<std::size_t>(b)],
           here[static_cast<std::size_t>(a)] != 0);
  }
}

void Contacts::list_obstacles(std::span<const Placed> placed, std::span<const std::uint8_t> here,
                              double time) {
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(obstacles_.size()); ++k) {
    const Placed at = at_time(-1 - k, time, time);
    for (std::int32_t b = 0; b < static_cast<std::int32_t>(placed.size()); ++b) {
      const auto body = static_cast<std::size_t>(b);
      if (here[body] == 0) continue;
      const Vec3<double> x = at.axes.to_local(placed[body].x - at.x);
      const auto beyond = [&](const HalfSpace& h) {
        return dot(h.normal, x) - h.offset > solids_[body].radius + reach_;
      };
      const auto sides = planes(-1 - k);
      if (std::none_of(sides.begin(), sides.end(), beyond)) list(b, -1 - k, placed[body], at, true);
    }
  }
}

bool Contacts::obstacle_listed() const {
  return std::any_of(pairs_.begin(), pairs_.end(), [](const Pair& p) { return p.b < 0; });
}

/// Lists a pair unless its gap exceeds the reach.
void Contacts::list(std::int32_t a, std::int32_t b, const Placed& at_a, const Placed& at_b,
                    bool counted) {
  const bool newly_eligible = at_rest_ || (changed_ && !first_);
  Pair pair{a, b, -1, -1, counted, newly_eligible, false, at_a.x - at_b.x, 0};
  const double size = length(pair.axis);
  pair.axis = size > 0 ? (1 / size) * pair.axis : Vec3<double>{0, 0, 1};
  if (b < 0 && vertices(b).empty()) pair.axis = planes(b)[0].normal;
  constexpr int tries = 20;
  if (gap(pair, at_a, at_b, tries) <= reach_) pairs_.push_back(pair);
}

/// Assigns the histories of the previous list, or of a checkpoint, to the pairs of the new list.
/// Both are sorted by pair.
void Contacts::take_histories() {
  next_histories_.clear();
  std::size_t at = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    Pair& p = pairs_[k];
    while (at < histories_.size() &&
           (histories_[at].a < p.a || (histories_[at].a == p.a && histories_[at].b < p.b)))
      ++at;
    if (at == histories_.size() || histories_[at].a != p.a || histories_[at].b != p.b) continue;
    p.newly_eligible = false;
    next_histories_.push_back({p.a, p.b, static_cast<std::int32_t>(k), histories_[at].memory});
  }
  std::swap(histories_, next_histories_);
}

std::vector<double> Contacts::history() const {
  std::vector<double> rows;
  for (const PairWithHistory& r : histories_) {
    if (r.pair >= 0 && !pairs_[static_cast<std::size_t>(r.pair)].counted) continue;
    const PairHistory& m = r.memory;
    rows.insert(rows.end(), {static_cast<double>(r.a), static_cast<double>(r.b), m.plastic, m.shear,
                             m.tangential.x, m.tangential.y, m.tangential.z});
  }
  return rows;
}

void Contacts::restore(std::span<const double> rows, bool changed) {
  pairs_.clear();
  histories_.clear();
  changed_ = true;
  first_ = !changed;
  at_rest_ = false;
  for (std::size_t k = 0; k + width <= rows.size(); k += width) {
    const auto r = rows.subspan(k, width);
    histories_.push_back({static_cast<std::int32_t>(r[0]),
                          static_cast<std::int32_t>(r[1]),
                          -1,
                          {r[2], r[3], {r[4], r[5], r[6]}}});
  }
}

Contacts::Rates Contacts::rates() const {
  // L of the partner with the stiffest contacts: the smallest body, or 0 for an obstacle.
  double smallest = obstacles_.empty() ? std::numeric_limits<double>::max() : 0.0;
  for (const Solid& s : solids_) smallest = std::min(smallest, 0.5 * s.size);
  double most = 0;
  for (std::size_t b = 0; b < solids_.size(); ++b) {
    const Solid& s = solids_[b];
    const double k = options_.young / (0.5 * s.size + smallest);
    const double reference = s.size * s.size;
    const double steeper =
        options_.law == ContactLaw::potential ? std::max(1.0, widest_[b] / reference) : 1.0;
    most = std::max(most, 2 * k * steeper * surface_[b] / s.mass);
  }
  return {most, 4 * options_.damping_ratio * std::sqrt(most)};
}

}  // namespace floe
